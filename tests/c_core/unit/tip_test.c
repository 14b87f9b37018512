#include "unit.h"

#define PERIOD R(0.001)
#define GRAVITY R(9.80665)

static gw_kinematics_t kinematics_of_trikey(void)
{
    gw_geometry_config_t geometry;
    gw_kinematics_t kinematics;
    gw_geometry_config_trikey(&geometry);
    CHECK_STATUS(gw_kinematics_init(&kinematics, &geometry), GW_STATUS_OK);
    return kinematics;
}

static gw_tip_t made(gw_real_t height, gw_real_t share, gw_real_t offset, gw_real_t slope)
{
    const gw_tip_config_t config = {height, share, offset, slope};
    const gw_kinematics_t kinematics = kinematics_of_trikey();
    gw_tip_t tip;
    gw_tip_init(&tip, &config, &kinematics);
    CHECK(gw_tip_invariant_holds(&tip));
    return tip;
}

static void trikey_has_no_limit(void)
{
    const gw_kinematics_t kinematics = kinematics_of_trikey();
    const gw_vector_t change = {R(-3.0), R(100.0)};
    gw_tip_config_t config;
    gw_config_error_t error;
    gw_tip_t tip;
    gw_tip_config_trikey(&config);
    gw_config_check_begin(&error);
    gw_tip_config_check(&config, &error);
    CHECK(error.field == GW_FIELD_NONE);
    gw_tip_init(&tip, &config, &kinematics);
    CHECK(gw_tip_share(&tip, change, PERIOD) == GW_ONE);
    CHECK(gw_tip_along(&tip, change, R(2.8)) == R(2.8));
}

/* Balance of the moments about two wheels: the load of the third one is zero at the limit, positive below it, and that
 * of the others is never negative. */
static void a_whole_share_takes_all_load_from_one_wheel(void)
{
    const gw_kinematics_t kinematics = kinematics_of_trikey();
    const gw_tip_t tip = made(R(0.414), GW_ONE, GW_ZERO, GW_ZERO);
    for (uint32_t degree = 0U; degree < 360U; degree++) {
        const gw_rotation_t rotation = gw_sincos((gw_real_t)degree * (GW_PI / R(180.0)));
        const gw_vector_t unit = {rotation.cosine, rotation.sine};
        const gw_real_t most = gw_tip_along(&tip, unit, R(100.0));
        gw_real_t least_load = GW_ONE;
        unit_row(degree);
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            const gw_vector_t n = kinematics.radial[i];
            const gw_real_t along = most * ((n.x * unit.x) + (n.y * unit.y));
            /* Over the weight: a third, less the moment m a h over the wheel's distance from the others, 3/2 R. */
            least_load = gw_min(least_load, (GW_ONE / R(3.0)) - ((along * R(0.414)) / (GRAVITY * R(1.5) * R(0.24))));
        }
        CHECK_NEAR(least_load, GW_ZERO, ROUNDING);
        /* The same limit as a share of a change in a tick. */
        const gw_vector_t change = {GW_TWO * most * PERIOD * unit.x, GW_TWO * most * PERIOD * unit.y};
        CHECK_NEAR(gw_tip_share(&tip, change, PERIOD), GW_HALF, ROUNDING);
        const gw_vector_t small = {R(0.99) * most * PERIOD * unit.x, R(0.99) * most * PERIOD * unit.y};
        CHECK(gw_tip_share(&tip, small, PERIOD) == GW_ONE);
    }
}

/* Towards a wheel the margin, away from it twice as much; never more than the other limit. */
static void the_limit_depends_on_the_direction(void)
{
    const gw_tip_t tip = made(R(0.4), GW_HALF, R(0.02), R(0.05));
    const gw_vector_t to_the_wheel = {R(1.0), R(0.0)};
    const gw_vector_t away = {R(-1.0), R(0.0)};
    const gw_vector_t nowhere = {R(0.0), R(0.0)};
    const gw_real_t margin = GW_HALF * GRAVITY * (((R(0.12) - R(0.02)) / R(0.4)) - R(0.05));
    CHECK_NEAR(gw_tip_along(&tip, to_the_wheel, R(100.0)), margin, ROUNDING);
    CHECK_NEAR(gw_tip_along(&tip, away, R(100.0)), GW_TWO * margin, GW_TWO * ROUNDING);
    CHECK(gw_tip_along(&tip, to_the_wheel, R(0.1)) == R(0.1));
    CHECK(gw_tip_along(&tip, nowhere, R(3.0)) == R(3.0));
}

/* A robot that would tip by standing there must still be able to stop; one that is flat has no limit that matters. */
static void the_margin_stays_within_bounds(void)
{
    CHECK(made(R(5.0), GW_ONE, GW_ONE, GW_HALF).margin_mps2 == R(0.05));
    CHECK(made(R(0.0000001), GW_ONE, GW_ZERO, GW_ZERO).margin_mps2 == R(1.0e6));
}

static void the_invariant_sees_every_member(void)
{
    const gw_tip_t good = made(R(0.414), GW_HALF, GW_ZERO, GW_ZERO);
    gw_tip_t bad[4];
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(bad); i++) {
        bad[i] = good;
    }
    bad[0].margin_mps2 = R(-0.1);
    bad[1].margin_mps2 = unit_nan();
    bad[2].radial[0].x = unit_above(GW_TWO);
    bad[3].radial[1].y = unit_nan();
    CHECK(!gw_tip_invariant_holds(NULL));
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(bad); i++) {
        unit_row(i);
        CHECK(!gw_tip_invariant_holds(&bad[i]));
    }
}

void suite_tip(void)
{
    unit_run("trikey_has_no_limit", trikey_has_no_limit);
    unit_run("a_whole_share_takes_all_load_from_one_wheel", a_whole_share_takes_all_load_from_one_wheel);
    unit_run("the_limit_depends_on_the_direction", the_limit_depends_on_the_direction);
    unit_run("the_margin_stays_within_bounds", the_margin_stays_within_bounds);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
