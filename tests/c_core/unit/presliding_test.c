#include "unit.h"

#define PERIOD R(0.001)

/* Rollers that bear 0.2 N m/0.01 m = 20 N and deflect by 0.2 mm before they slide, elastically up to half of it. */
static const gw_geometry_config_t geometry = {R(0.1), R(0.01), R(0.25), {0U, 1U, 2U}, R(0.0)};
static const gw_friction_config_t friction = {R(0.2), R(0.4)};
static const gw_presliding_config_t config = {{R(1e5), R(1e5), R(1e5)}, R(100.0), R(0.01), R(0.5)};
static const gw_twist_t still = {R(0.0), R(0.0), R(0.0)};
static const gw_wheels_t no_torque = {{R(0.0), R(0.0), R(0.0)}};

static gw_kinematics_t kinematics;
static gw_rate_filter_constants_t constants;

static gw_presliding_t made(void)
{
    gw_presliding_t presliding;
    CHECK_STATUS(gw_kinematics_init(&kinematics, &geometry), GW_STATUS_OK);
    CHECK_STATUS(gw_rate_filter_constants(&constants, PERIOD, R(200.0), 1000000U, R(500.0)), GW_STATUS_OK);
    CHECK_STATUS(gw_presliding_init(&presliding, &config, &friction, &kinematics), GW_STATUS_OK);
    CHECK(gw_presliding_invariant_holds(&presliding));
    return presliding;
}

static gw_wheels_t step(gw_presliding_t *presliding, const int32_t counts[3], const gw_wheels_t *torque,
                        gw_twist_t twist)
{
    const gw_wheels_t friction_nm = gw_presliding_step(presliding, &kinematics, &constants, counts, torque, twist);
    CHECK(gw_presliding_invariant_holds(presliding));
    return friction_nm;
}

/* Counts of the wheels for a travel along x: wheel 0 does not turn, the others by -+sqrt(3)/2 x/r_w. */
static void counts_of(gw_real_t x_m, int32_t counts[3])
{
    const gw_real_t turned = (R(0.866025403784438647) * x_m) / R(0.1) / constants.rad_per_count;
    counts[0] = 0;
    counts[1] = (int32_t)((turned < GW_ZERO) ? (turned - GW_HALF) : (turned + GW_HALF)) * -1;
    counts[2] = -counts[1];
}

/* Moves along x in ticks of the given travel; returns the friction of the last tick. */
static gw_wheels_t moved(gw_presliding_t *presliding, gw_real_t from_m, gw_real_t to_m, uint32_t ticks,
                         gw_twist_t twist)
{
    gw_wheels_t friction_nm = no_torque;
    for (uint32_t i = 0U; i <= ticks; i++) {
        int32_t counts[3];
        counts_of(from_m + (((to_m - from_m) * (gw_real_t)i) / (gw_real_t)ticks), counts);
        friction_nm = step(presliding, counts, &no_torque, twist);
    }
    return friction_nm;
}

static void bad_arguments_are_refused(void)
{
    gw_presliding_t presliding = made();
    gw_presliding_config_t soft = config;
    gw_friction_config_t sticky = friction;
    soft.stiffness_n_per_m[2] = unit_nan();
    sticky.coulomb_torque_nm = R(-1.0);
    CHECK_STATUS(gw_presliding_init(NULL, &config, &friction, &kinematics), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_presliding_init(&presliding, NULL, &friction, &kinematics), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_presliding_init(&presliding, &config, NULL, &kinematics), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_presliding_init(&presliding, &config, &friction, NULL), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_presliding_init(&presliding, &soft, &friction, &kinematics), GW_STATUS_CONFIG_INVALID);
    CHECK_STATUS(gw_presliding_init(&presliding, &config, &sticky, &kinematics), GW_STATUS_CONFIG_INVALID);
}

/* 0.05 mm along roller 0's axis are 5 N at 1e5 N/m; rollers at 120 degrees move half as far, in the opposite direction.
 */
static void a_small_travel_is_elastic_and_reversible(void)
{
    gw_presliding_t presliding = made();
    gw_wheels_t torques = moved(&presliding, R(0.0), R(0.00005), 10U, still);
    /* A count is 0.6 um of travel, 0.06 N of force, 0.6 mN m at the roller. */
    CHECK_NEAR(torques.wheel[0], R(0.05), R(0.0007));
    CHECK_NEAR(torques.wheel[1], R(-0.025), R(0.0007));
    CHECK_NEAR(gw_presliding_elastic_torques(&presliding, &kinematics).wheel[0], torques.wheel[0], ROUNDING);
    torques = moved(&presliding, R(0.00005), R(0.0), 10U, still);
    CHECK_NEAR(torques.wheel[0], GW_ZERO, R(0.0007));
}

/* For any distance and any step length the roller carries at most 0.2 N m, in both directions. */
static void a_long_travel_ends_at_sliding_friction(void)
{
    const uint32_t ticks[] = {1U, 3U, 100U, 2000U};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(ticks); i++) {
        gw_presliding_t presliding = made();
        unit_row(i);
        CHECK_NEAR(moved(&presliding, R(0.0), R(0.01), ticks[i], still).wheel[0], R(0.2), R(0.002));
        CHECK_NEAR(moved(&presliding, R(0.01), R(-0.01), ticks[i], still).wheel[0], R(-0.2), R(0.002));
    }
}

/* Fast along the roller's axis the friction is that of (28): B_r tanh(alpha v/r_r), and the damping is in it. */
static void in_motion_it_is_the_friction_of_28(void)
{
    gw_presliding_t presliding = made();
    const gw_twist_t twist = {R(0.02), R(0.0), R(0.0)};
    const gw_wheels_t rates = gw_kinematics_roller_rates(&kinematics, twist);
    const gw_wheels_t expected = gw_friction_torques(&friction, &rates);
    const gw_wheels_t torques = moved(&presliding, R(0.0), R(0.02), 1000U, twist);
    /* exp(-4) of stiction is left at twice the Stribeck speed: 0.018 * (1 - 0.66) * 0.2 N m */
    CHECK_NEAR(torques.wheel[0], expected.wheel[0], R(0.002));
    CHECK(torques.wheel[0] > expected.wheel[0]);
}

/* Starting to move against the deflection: nothing slides during the return, so the full sigma1 v is felt. */
static void damping_is_felt_at_once(void)
{
    gw_presliding_t presliding = made();
    const gw_twist_t twist = {R(0.001), R(0.0), R(0.0)};
    const int32_t counts[3] = {0, 0, 0};
    CHECK_NEAR(step(&presliding, counts, &no_torque, twist).wheel[0], R(0.001), R(10.0) * ROUNDING);
}

/* A torque that twists the drivetrain by the angle that the encoders show: the rollers did not move. */
static void the_wind_up_of_the_drivetrain_is_taken_off(void)
{
    gw_presliding_t presliding = made();
    const gw_wheels_t torque = {
        {GW_ZERO, R(-1000.0) * constants.rad_per_count * R(500.0), R(1000.0) * constants.rad_per_count * R(500.0)}};
    const int32_t before[3] = {0, 0, 0};
    const int32_t after[3] = {0, -1000, 1000};
    (void)step(&presliding, before, &no_torque, still);
    CHECK_NEAR(step(&presliding, after, &torque, still).wheel[0], GW_ZERO, ROUNDING);
}

/* Counts and torque right after a gap do not tell the travel; after settling the torque does. */
static void a_gap_keeps_the_deflection(void)
{
    gw_presliding_t presliding = made();
    const gw_wheels_t torque = {{GW_ZERO, R(3.0), R(-3.0)}};
    const int32_t far[3] = {0, 5000, -5000};
    const gw_wheels_t before = moved(&presliding, R(0.0), R(0.00005), 10U, still);
    gw_presliding_gap(&presliding);
    CHECK(step(&presliding, far, &torque, still).wheel[0] == before.wheel[0]);
    gw_presliding_gap(&presliding);
    gw_presliding_settle(&presliding, &no_torque);
    CHECK(step(&presliding, far, &torque, still).wheel[0] != before.wheel[0]);
}

/* Beyond a metre in a tick the sensors are wrong, and their values are ignored. */
static void an_impossible_travel_changes_nothing(void)
{
    gw_presliding_t presliding = made();
    const int32_t before[3] = {0, 0, 0};
    const int32_t after[3] = {0, -500000000, 500000000};
    (void)step(&presliding, before, &no_torque, still);
    CHECK(step(&presliding, after, &no_torque, still).wheel[0] == GW_ZERO);
}

/* A speed that lasts is felt by all wheels after as many ticks, and from then on as if each had every tick. */
static void wheels_may_take_turns(void)
{
    gw_presliding_t every_tick = made();
    gw_presliding_t in_turn = made();
    const gw_twist_t twist = {R(0.02), R(0.01), R(0.0)};
    const int32_t counts[3] = {0, 0, 0};
    gw_presliding_take_turns(&in_turn);
    (void)step(&every_tick, counts, &no_torque, twist);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        unit_row(i);
        CHECK(in_turn.bearable_now_n.wheel[i] == in_turn.bearable_n);
        (void)step(&in_turn, counts, &no_torque, twist);
        CHECK(in_turn.bearable_now_n.wheel[i] == every_tick.bearable_now_n.wheel[i]);
        CHECK(in_turn.bearable_now_n.wheel[i] < in_turn.bearable_n);
    }
    (void)step(&in_turn, counts, &no_torque, still);
    CHECK(in_turn.bearable_now_n.wheel[0] == in_turn.bearable_n);
    CHECK(in_turn.bearable_now_n.wheel[1] < in_turn.bearable_n);
}

static void the_invariant_sees_every_member(void)
{
    gw_presliding_t bad[9];
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(bad); i++) {
        bad[i] = made();
    }
    bad[0].config.elastic_fraction = R(1.0);
    bad[1].bearable_n = GW_ZERO;
    bad[2].deflection_m[1].value = R(0.001);
    bad[3].deflection_m[2].value = unit_nan();
    bad[4].deflection_m[0].excess = unit_nan();
    bad[5].last_torque_nm.wheel[2] = unit_infinity();
    bad[6].friction.tanh_slope_s_per_rad = R(-1.0);
    bad[7].turn = GW_WHEEL_COUNT;
    bad[8].bearable_now_n.wheel[1] = GW_ZERO;
    CHECK(!gw_presliding_invariant_holds(NULL));
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(bad); i++) {
        unit_row(i);
        CHECK(!gw_presliding_invariant_holds(&bad[i]));
    }
}

void suite_presliding(void)
{
    unit_run("bad_arguments_are_refused", bad_arguments_are_refused);
    unit_run("a_small_travel_is_elastic_and_reversible", a_small_travel_is_elastic_and_reversible);
    unit_run("a_long_travel_ends_at_sliding_friction", a_long_travel_ends_at_sliding_friction);
    unit_run("in_motion_it_is_the_friction_of_28", in_motion_it_is_the_friction_of_28);
    unit_run("damping_is_felt_at_once", damping_is_felt_at_once);
    unit_run("the_wind_up_of_the_drivetrain_is_taken_off", the_wind_up_of_the_drivetrain_is_taken_off);
    unit_run("a_gap_keeps_the_deflection", a_gap_keeps_the_deflection);
    unit_run("an_impossible_travel_changes_nothing", an_impossible_travel_changes_nothing);
    unit_run("wheels_may_take_turns", wheels_may_take_turns);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
