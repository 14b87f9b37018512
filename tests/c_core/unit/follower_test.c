#include "unit.h"

#define MASS GW_WHEEL_COUNT
#define INTERVAL R(0.016)
#define ROOT_3 R(1.73205080756887729)

static const gw_vector_t nothing = {R(0.0), R(0.0)};
static const gw_model_forces_t no_forces;

/* Wheels at 0, 120 and 240 degrees. */
static gw_kinematics_t kinematics(void)
{
    gw_geometry_config_t geometry;
    gw_kinematics_t made;
    gw_geometry_config_trikey(&geometry);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        geometry.wheel_slot[i] = i;
    }
    geometry.azimuth_rad = GW_ZERO;
    CHECK_STATUS(gw_kinematics_init(&made, &geometry), GW_STATUS_OK);
    return made;
}

static gw_follower_t of_config(const gw_follower_config_t *config)
{
    gw_follower_t follower;
    gw_follower_init(&follower, config, INTERVAL);
    CHECK(gw_follower_invariant_holds(&follower));
    return follower;
}

/* Standard deviations that are easy to follow; no drift. */
static gw_follower_t made(gw_real_t common, gw_real_t wheel, gw_real_t mass)
{
    const gw_follower_config_t config = {common, wheel, mass, GW_ZERO, GW_ZERO, R(5.0)};
    return of_config(&config);
}

static gw_model_forces_t forces(gw_real_t a, gw_real_t b, gw_real_t c, gw_real_t x, gw_real_t y)
{
    const gw_model_forces_t made_of = {{{a, b, c}}, {x, y}, R(1000.0)};
    return made_of;
}

static gw_regressors_t regressors_of(const gw_model_forces_t *at)
{
    const gw_kinematics_t robot = kinematics();
    return gw_follower_regressors(&robot, at);
}

static gw_vector_t correction_of(const gw_follower_t *follower, const gw_model_forces_t *at)
{
    const gw_kinematics_t robot = kinematics();
    return gw_follower_correction(follower, &robot, at);
}

/* First from x, then from y. */
static void learn(gw_follower_t *follower, const gw_model_forces_t *at, gw_vector_t residual_n)
{
    const gw_regressors_t regressors = regressors_of(at);
    gw_follower_learn(follower, &regressors, residual_n, false);
    CHECK(gw_follower_invariant_holds(follower));
    gw_follower_learn(follower, &regressors, residual_n, true);
    CHECK(gw_follower_invariant_holds(follower));
}

/* The residual of a robot with these differences: -(sum_i d_i n_i f_i + d_m M a). */
static gw_vector_t residual_of(const gw_real_t d[GW_FOLLOWED_COUNT], const gw_model_forces_t *at)
{
    const gw_wheels_t f = at->friction_n;
    const gw_vector_t residual = {
        -(((d[0] * f.wheel[0]) - (R(0.5) * ((d[1] * f.wheel[1]) + (d[2] * f.wheel[2])))) + (d[3] * at->inertia_n.x)),
        -(((R(0.5) * ROOT_3) * ((d[1] * f.wheel[1]) - (d[2] * f.wheel[2]))) + (d[3] * at->inertia_n.y))};
    return residual;
}

static void at_first_only_what_the_configuration_says_is_known(void)
{
    const gw_follower_t follower = made(R(0.5), R(0.25), R(0.125));
    const gw_model_forces_t some = forces(R(10.0), R(-20.0), R(30.0), R(40.0), R(-50.0));
    const gw_vector_t correction = correction_of(&follower, &some);
    for (uint32_t i = 0U; i < GW_FOLLOWED_COUNT; i++) {
        unit_row(i);
        CHECK(follower.difference[i] == GW_ZERO);
        for (uint32_t k = 0U; k < GW_FOLLOWED_COUNT; k++) {
            const gw_real_t own = (i == MASS) ? R(0.015625) : R(0.3125);
            const gw_real_t shared = ((i == MASS) || (k == MASS)) ? GW_ZERO : R(0.25);
            CHECK(follower.covariance[i][k] == ((i == k) ? own : shared));
        }
    }
    CHECK((correction.x == GW_ZERO) && (correction.y == GW_ZERO));
    CHECK(follower.drift_per_call == GW_ZERO);
    CHECK(follower.config.residual_n == R(5.0));
}

/* Of a friction force f of wheel i: (c^2 + w^2) f^2 n n^T; of M a: m^2 (M a)(M a)^T; of two wheels besides
 * 2 c^2 f f' n n'^T. */
static void what_is_unknown_makes_the_force_uncertain(void)
{
    const struct {
        gw_model_forces_t at;
        gw_planar_covariance_t s;
    } rows[] = {
        {forces(R(4.0), R(0.0), R(0.0), R(0.0), R(0.0)), {R(5.0), R(0.0), R(0.0)}},
        {forces(R(0.0), R(8.0), R(0.0), R(0.0), R(0.0)), {R(5.0), R(-5.0) * ROOT_3, R(15.0)}},
        {forces(R(0.0), R(0.0), R(-8.0), R(0.0), R(0.0)), {R(5.0), R(5.0) * ROOT_3, R(15.0)}},
        {forces(R(0.0), R(0.0), R(0.0), R(16.0), R(-8.0)), {R(4.0), R(-2.0), R(1.0)}},
        /* 0.25 * 4 * 8 * (n0 n1^T + n1 n0^T) besides the two rows above */
        {forces(R(4.0), R(8.0), R(0.0), R(0.0), R(0.0)), {R(2.0), R(-1.0) * ROOT_3, R(15.0)}},
    };
    const gw_follower_t follower = made(R(0.5), R(0.25), R(0.125));
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        const gw_regressors_t regressors = regressors_of(&rows[i].at);
        const gw_planar_covariance_t s = gw_follower_uncertainty(&follower, &regressors);
        unit_row(i);
        CHECK_NEAR(s.xx, rows[i].s.xx, R(40.0) * ROUNDING);
        CHECK_NEAR(s.xy, rows[i].s.xy, R(40.0) * ROUNDING);
        CHECK_NEAR(s.yy, rows[i].s.yy, R(40.0) * ROUNDING);
    }
}

/* One unknown d = 0.1 sigma, h = -50 N, r = 5 N: variance 25 + 25, gain -0.01 per N. 10 N of residual are d = 0.1, and
 * half of the variance is left. */
static void one_measurement_is_weighed_against_what_was_known(void)
{
    const struct {
        gw_model_forces_t at;
        gw_vector_t residual;
        uint32_t which;
    } rows[] = {
        {forces(R(50.0), R(0.0), R(0.0), R(0.0), R(0.0)), {R(-10.0), R(0.0)}, 0U},
        {forces(R(0.0), R(0.0), R(0.0), R(50.0), R(0.0)), {R(-10.0), R(0.0)}, 3U},
        {forces(R(0.0), R(0.0), R(0.0), R(0.0), R(50.0)), {R(0.0), R(-10.0)}, 3U},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_follower_t follower = made(GW_ZERO, R(0.1), R(0.1));
        unit_row(i);
        learn(&follower, &rows[i].at, rows[i].residual);
        for (uint32_t k = 0U; k < GW_FOLLOWED_COUNT; k++) {
            const bool learned = (k == rows[i].which);
            CHECK_NEAR(follower.difference[k], learned ? R(0.1) : GW_ZERO, R(0.1) * ROUNDING);
            CHECK_NEAR(follower.covariance[k][k], learned ? R(0.005) : R(0.01), R(0.01) * ROUNDING);
        }
    }
}

/* What one wheel shows is expected of the others, too: c^2/(c^2 + w^2) of it. */
static void wheels_share_the_common_part(void)
{
    const gw_model_forces_t at = forces(R(50.0), R(0.0), R(0.0), R(0.0), R(0.0));
    const gw_vector_t residual = {R(-10.0), R(0.0)};
    gw_follower_t follower = made(R(0.08), R(0.06), R(0.1));
    learn(&follower, &at, residual);
    CHECK_NEAR(follower.difference[0], R(0.1), R(0.1) * ROUNDING);
    CHECK_NEAR(follower.difference[1], R(0.064), R(0.1) * ROUNDING);
    CHECK_NEAR(follower.difference[2], R(0.064), R(0.1) * ROUNDING);
    CHECK(follower.difference[MASS] == GW_ZERO);
    CHECK_NEAR(follower.covariance[0][1], R(0.0032), R(0.01) * ROUNDING);
    CHECK_NEAR(follower.covariance[1][2], R(0.0064) * (GW_ONE - R(0.32)), R(0.01) * ROUNDING);
}

/* A robot with other friction and mass, moving and accelerating in all directions: the differences are found, so the
 * correction is the residual with the other sign, and the uncertainty is small. */
static void the_differences_of_a_robot_are_found(void)
{
    const gw_real_t truth[GW_FOLLOWED_COUNT] = {R(0.3), R(0.15), R(-0.2), R(0.2)};
    gw_follower_t follower = made(R(0.3), R(0.2), R(0.3));
    gw_model_forces_t at = no_forces;
    for (uint32_t i = 0U; i < 400U; i++) {
        const gw_rotation_t turned = gw_sincos(R(0.7) * (gw_real_t)i);
        const gw_rotation_t along = gw_sincos(R(0.31) * (gw_real_t)i);
        at = forces(R(30.0) * turned.cosine, R(30.0) * turned.sine, R(20.0) * along.cosine, R(40.0) * along.sine,
                    R(40.0) * along.cosine);
        learn(&follower, &at, residual_of(truth, &at));
    }
    const gw_vector_t residual = residual_of(truth, &at);
    const gw_regressors_t regressors = regressors_of(&at);
    const gw_vector_t correction = correction_of(&follower, &at);
    const gw_planar_covariance_t left = gw_follower_uncertainty(&follower, &regressors);
    for (uint32_t i = 0U; i < GW_FOLLOWED_COUNT; i++) {
        unit_row(i);
        /* Of the first guess there is left what 400 measurements of 14 N (root mean square) with 5 N of noise leave of
         * a variance of 0.2^2: 5^2/(400 * 14^2 * 0.04), below 1 %. */
        CHECK_NEAR(follower.difference[i], truth[i], R(0.005));
    }
    CHECK_NEAR(correction.x, -residual.x, R(0.1));
    CHECK_NEAR(correction.y, -residual.y, R(0.1));
    CHECK((left.xx > GW_ZERO) && (left.xx < R(1.0)) && (left.yy > GW_ZERO) && (left.yy < R(1.0)));
}

static void a_small_acceleration_tells_nothing_of_the_mass(void)
{
    const gw_vector_t residual = {R(-4.0), R(-4.0)};
    const gw_model_forces_t rows[] = {forces(GW_ZERO, GW_ZERO, GW_ZERO, unit_below(R(8.0)), GW_ZERO),
                                      forces(GW_ZERO, GW_ZERO, GW_ZERO, GW_ZERO, R(-7.9)),
                                      forces(GW_ZERO, GW_ZERO, GW_ZERO, R(8.0), GW_ZERO),
                                      forces(GW_ZERO, GW_ZERO, GW_ZERO, R(6.0), R(6.0))};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_follower_t follower = made(R(0.3), R(0.2), R(0.3));
        unit_row(i);
        learn(&follower, &rows[i], residual);
        CHECK((follower.difference[MASS] != GW_ZERO) == (i >= 2U));
        CHECK((follower.covariance[MASS][MASS] < (R(0.3) * R(0.3))) == (i >= 2U));
    }
}

/* Friction and payload drift: while nothing is learned the variance grows by the square of the drift times the
 * interval, up to what was expected at first. */
static void what_was_learned_ages(void)
{
    const gw_follower_config_t config = {R(0.3), R(0.2), R(0.3), R(0.5), GW_ZERO, R(5.0)};
    const gw_model_forces_t at = forces(R(100.0), R(100.0), R(0.0), R(100.0), R(30.0));
    gw_follower_t follower = of_config(&config);
    CHECK_NEAR(follower.drift_per_call, R(0.004), R(0.004) * ROUNDING);
    learn(&follower, &no_forces, nothing);
    CHECK_NEAR(follower.covariance[0][0], R(0.13), R(0.13) * ROUNDING); /* nothing was learned: nothing ages */
    learn(&follower, &at, nothing);
    const gw_real_t wheel = follower.covariance[0][0];
    const gw_real_t mass = follower.covariance[MASS][MASS];
    CHECK((wheel < R(0.12)) && (mass < R(0.09)));
    learn(&follower, &no_forces, nothing);
    CHECK_NEAR(follower.covariance[0][0], wheel + R(0.008), ROUNDING); /* of two calls */
    CHECK_NEAR(follower.covariance[MASS][MASS], mass + R(0.008), ROUNDING);
    for (uint32_t i = 0U; i < 100U; i++) {
        learn(&follower, &no_forces, nothing);
    }
    CHECK(gw_in_range(follower.covariance[0][0], R(0.13) - ROUNDING, R(0.134) + ROUNDING));
    CHECK(gw_in_range(follower.covariance[1][1], R(0.13) - ROUNDING, R(0.134) + ROUNDING));
    CHECK(gw_in_range(follower.covariance[MASS][MASS], R(0.09) - ROUNDING, R(0.094) + ROUNDING));
}

static void a_difference_is_limited(void)
{
    const gw_model_forces_t at = forces(R(100.0), R(0.0), R(0.0), R(0.0), R(100.0));
    const gw_vector_t much = {R(-1000.0), R(1000.0)};
    const gw_vector_t opposite = {R(5000.0), R(-5000.0)};
    gw_follower_t follower = made(GW_ZERO, R(0.5), R(0.5));
    learn(&follower, &at, much);
    CHECK((follower.difference[0] == R(0.8)) && (follower.difference[MASS] == R(-0.8)));
    for (uint32_t i = 0U; i < 100U; i++) {
        learn(&follower, &at, opposite);
    }
    CHECK((follower.difference[0] == R(-0.8)) && (follower.difference[MASS] == R(0.8)));
}

/* Forces and residuals as large as the library takes, the smallest noise, and everything unknown. */
static void the_largest_forces_keep_the_invariant(void)
{
    const gw_follower_config_t config = {GW_ONE, GW_ONE, GW_ONE, GW_ONE, R(30.0), R(0.1)};
    const gw_real_t sizes[] = {R(1.0e9), R(-1.0e9), R(1.0e5), R(-3.0), GW_ZERO};
    gw_follower_t follower;
    gw_follower_init(&follower, &config, R(100.0)); /* even at such intervals the drift is limited */
    CHECK(gw_follower_invariant_holds(&follower));
    CHECK((follower.covariance[0][0] == GW_TWO) && (follower.drift_per_call == GW_TWO));
    for (uint32_t i = 0U; i < 3125U; i++) {
        const gw_model_forces_t at = forces(sizes[i % 5U], sizes[(i / 5U) % 5U], sizes[(i / 25U) % 5U],
                                            sizes[(i / 125U) % 5U], sizes[(i / 625U) % 5U]);
        const gw_vector_t residual = {sizes[(i + 1U) % 5U], sizes[(i / 3U) % 5U]};
        unit_row(i);
        learn(&follower, &at, residual);
        const gw_regressors_t regressors = regressors_of(&at);
        const gw_planar_covariance_t s = gw_follower_uncertainty(&follower, &regressors);
        const gw_vector_t correction = correction_of(&follower, &at);
        CHECK(gw_is_finite(s.xy) && gw_in_range(s.xx, GW_ZERO, R(2.0e20)) && gw_in_range(s.yy, GW_ZERO, R(2.0e20)));
        CHECK(gw_within(correction.x, R(4.0e9)) && gw_within(correction.y, R(4.0e9)));
    }
}

/* A matrix that rounding has made none of variances: no division by what is not positive, no negative variance. */
static void a_matrix_that_is_no_covariance_does_no_harm(void)
{
    const gw_model_forces_t two = forces(R(100.0), R(100.0), R(0.0), R(0.0), R(0.0));
    const gw_model_forces_t sideways = forces(R(0.0), R(100.0), R(100.0), R(0.0), R(0.0));
    const gw_vector_t residual = {R(-10.0), R(0.0)};
    gw_follower_t follower = made(R(0.1), R(0.1), R(0.1));
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            follower.covariance[i][k] = (i == k) ? R(0.01) : R(1.0);
        }
    }
    const gw_regressors_t of_two = regressors_of(&two);
    const gw_regressors_t of_sideways = regressors_of(&sideways);
    CHECK(gw_follower_uncertainty(&follower, &of_two).xx == GW_ZERO);
    CHECK(gw_follower_uncertainty(&follower, &of_sideways).yy == GW_ZERO);
    /* The gain is -(0.01 * 100 - 100 * 0.5) = 49, so h P h^T is negative, and r^2 = 25 stands for the variance. */
    learn(&follower, &two, residual);
    CHECK(follower.difference[0] == R(-0.8));
    CHECK(follower.covariance[0][0] == GW_ZERO);
}

static void the_invariant_sees_every_member(void)
{
    const gw_follower_t good = made(R(0.3), R(0.2), R(0.3));
    gw_follower_t bad[5];
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(bad); i++) {
        bad[i] = good;
    }
    bad[0].config.friction_common = unit_above(GW_ONE);
    bad[1].config.residual_n = unit_nan();
    bad[2].drift_per_call = R(-0.001);
    bad[3].drift_per_call = unit_above(GW_TWO);
    bad[4].drift_per_call = unit_nan();
    CHECK(!gw_follower_invariant_holds(NULL));
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(bad); i++) {
        unit_row(i);
        CHECK(!gw_follower_invariant_holds(&bad[i]));
    }
    for (uint32_t i = 0U; i < GW_FOLLOWED_COUNT; i++) {
        gw_follower_t one = good;
        unit_row(10U + i);
        one.difference[i] = unit_above(R(0.8));
        CHECK(!gw_follower_invariant_holds(&one));
        one = good;
        one.difference[i] = unit_nan();
        CHECK(!gw_follower_invariant_holds(&one));
        one = good;
        one.covariance[i][i] = R(-1.0e-9);
        CHECK(!gw_follower_invariant_holds(&one));
        for (uint32_t k = 0U; k < GW_FOLLOWED_COUNT; k++) {
            one = good;
            one.covariance[i][k] = unit_above(GW_TWO);
            CHECK(!gw_follower_invariant_holds(&one));
            one.covariance[i][k] = unit_nan();
            CHECK(!gw_follower_invariant_holds(&one));
        }
    }
}

void suite_follower(void)
{
    unit_run("at_first_only_what_the_configuration_says_is_known", at_first_only_what_the_configuration_says_is_known);
    unit_run("what_is_unknown_makes_the_force_uncertain", what_is_unknown_makes_the_force_uncertain);
    unit_run("one_measurement_is_weighed_against_what_was_known", one_measurement_is_weighed_against_what_was_known);
    unit_run("wheels_share_the_common_part", wheels_share_the_common_part);
    unit_run("the_differences_of_a_robot_are_found", the_differences_of_a_robot_are_found);
    unit_run("a_small_acceleration_tells_nothing_of_the_mass", a_small_acceleration_tells_nothing_of_the_mass);
    unit_run("what_was_learned_ages", what_was_learned_ages);
    unit_run("a_difference_is_limited", a_difference_is_limited);
    unit_run("the_largest_forces_keep_the_invariant", the_largest_forces_keep_the_invariant);
    unit_run("a_matrix_that_is_no_covariance_does_no_harm", a_matrix_that_is_no_covariance_does_no_harm);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
