#include "unit.h"

#define ROOT_3 R(1.73205080756887729)

static const gw_model_forces_t no_forces;

/* Wheels at 0, 120 and 240 degrees; no difference is possible but what the row says. */
static gw_planar_covariance_t of(const gw_channels_config_t *config, const gw_model_forces_t *change,
                                 const gw_model_forces_t *model, gw_real_t sliding_n)
{
    gw_geometry_config_t geometry;
    gw_kinematics_t kinematics;
    gw_follower_t follower;
    gw_geometry_config_trikey(&geometry);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        geometry.wheel_slot[i] = i;
    }
    geometry.azimuth_rad = GW_ZERO;
    CHECK_STATUS(gw_kinematics_init(&kinematics, &geometry), GW_STATUS_OK);
    gw_follower_init(&follower, &config->follower, R(0.008));
    return gw_model_covariance(config, &kinematics, &follower, change, model, sliding_n, config->presliding);
}

static gw_channels_config_t config_of(gw_real_t shape, gw_real_t presliding, gw_real_t wheel, gw_real_t mass)
{
    gw_channels_config_t config;
    gw_channels_config_trikey(&config);
    config.model_multiple = R(2.0);
    config.friction_shape = shape;
    config.presliding = presliding;
    config.follower.friction_common = GW_ZERO;
    config.follower.friction_wheel = wheel;
    config.follower.mass = mass;
    return config;
}

static void check(gw_planar_covariance_t actual, gw_real_t xx, gw_real_t xy, gw_real_t yy)
{
    CHECK_NEAR(actual.xx, xx, R(100.0) * ROUNDING);
    CHECK_NEAR(actual.xy, xy, R(100.0) * ROUNDING);
    CHECK_NEAR(actual.yy, yy, R(100.0) * ROUNDING);
}

/* k_m^2 = 4 times (0.25 + 0.5^2) 8^2 n n^T of the second wheel, n = (-1, sqrt 3)/2, and 0.5^2 M a (M a)^T. */
static void followed_and_shape_add_up(void)
{
    const gw_channels_config_t config = config_of(R(0.5), R(0.0), R(0.5), R(0.5));
    const gw_model_forces_t friction = {{{R(0.0), R(8.0), R(0.0)}}, {R(0.0), R(0.0)}, R(7.0)};
    const gw_model_forces_t inertia = {{{R(0.0), R(0.0), R(0.0)}}, {R(2.0), R(-4.0)}, R(7.0)};
    unit_row(0U);
    check(of(&config, &friction, &no_forces, R(50.0)), R(32.0), R(-32.0) * ROOT_3, R(96.0));
    unit_row(1U);
    check(of(&config, &inertia, &no_forces, R(50.0)), R(4.0), R(-8.0), R(16.0));
    unit_row(2U);
    check(of(&config, &no_forces, &friction, R(50.0)), R(0.0), R(0.0), R(0.0));
}

/* What is missing to full sliding, of the forces themselves: 4 * 0.5^2 (10^2 - f^2) n n^T for each wheel. */
static void a_roller_that_hardly_turns_may_be_anywhere(void)
{
    const gw_channels_config_t config = config_of(R(0.0), R(0.5), R(0.0), R(0.0));
    const struct {
        gw_model_forces_t model;
        gw_real_t sliding_n;
        gw_planar_covariance_t s;
    } rows[] = {
        /* all three: half their number times the unit matrix */
        {{{{R(0.0), R(0.0), R(0.0)}}, {R(0.0), R(0.0)}, R(0.0)}, R(10.0), {R(150.0), R(0.0), R(150.0)}},
        {{{{R(6.0), R(10.0), R(-10.0)}}, {R(0.0), R(0.0)}, R(0.0)}, R(10.0), {R(64.0), R(0.0), R(0.0)}},
        {{{{R(10.0), R(-8.0), R(10.0)}}, {R(0.0), R(0.0)}, R(0.0)}, R(10.0), {R(9.0), R(-9.0) * ROOT_3, R(27.0)}},
        /* more than sliding: nothing is missing */
        {{{{R(11.0), R(-11.0), R(12.0)}}, {R(0.0), R(0.0)}, R(0.0)}, R(10.0), {R(0.0), R(0.0), R(0.0)}},
        {{{{R(6.0), R(3.0), R(-1.0)}}, {R(0.0), R(0.0)}, R(0.0)}, R(0.0), {R(0.0), R(0.0), R(0.0)}},
    };
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        unit_row(i);
        check(of(&config, &no_forces, &rows[i].model, rows[i].sliding_n), rows[i].s.xx, rows[i].s.xy, rows[i].s.yy);
    }
}

/* 4 * 0.5^2 (10^2 - f f'), f' before the change, at least 0 and at most twice 10^2: friction that has just turned round
 * may lag behind, that which begins may have held anything before. */
static void a_roller_that_has_just_turned_round_may_lag_behind(void)
{
    const gw_channels_config_t config = config_of(R(0.0), R(0.5), R(0.0), R(0.0));
    const struct {
        gw_real_t friction_n;
        gw_real_t before_n;
        gw_real_t missing_n2;
    } rows[] = {{R(10.0), R(-10.0), R(200.0)}, {R(10.0), R(-2.0), R(120.0)}, {R(-10.0), R(-5.0), R(50.0)},
                {R(0.0), R(10.0), R(100.0)},   {R(11.0), R(10.0), R(0.0)},   {R(12.0), R(-12.0), R(200.0)}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        gw_model_forces_t model = no_forces;
        gw_model_forces_t change = no_forces;
        for (uint32_t k = 0U; k < GW_WHEEL_COUNT; k++) {
            model.friction_n.wheel[k] = rows[i].friction_n;
            change.friction_n.wheel[k] = rows[i].friction_n - rows[i].before_n;
        }
        unit_row(i);
        check(of(&config, &change, &model, R(10.0)), R(1.5) * rows[i].missing_n2, R(0.0), R(1.5) * rows[i].missing_n2);
        check(of(&config, &change, &model, R(0.0)), R(0.0), R(0.0), R(0.0));
    }
}

void suite_model_covariance(void)
{
    unit_run("followed_and_shape_add_up", followed_and_shape_add_up);
    unit_run("a_roller_that_hardly_turns_may_be_anywhere", a_roller_that_hardly_turns_may_be_anywhere);
    unit_run("a_roller_that_has_just_turned_round_may_lag_behind", a_roller_that_has_just_turned_round_may_lag_behind);
}
