#include "unit.h"

#define PERIOD R(0.001)
#define COUNTS 8000U

static gw_rate_filter_constants_t made(gw_real_t stiffness)
{
    gw_rate_filter_constants_t constants;
    CHECK_STATUS(gw_rate_filter_constants(&constants, PERIOD, R(200.0), COUNTS, stiffness), GW_STATUS_OK);
    return constants;
}

static void constants_are_checked(void)
{
    gw_rate_filter_constants_t constants;
    CHECK_STATUS(gw_rate_filter_constants(NULL, PERIOD, R(200.0), COUNTS, R(600.0)), GW_STATUS_NULL_POINTER);
    CHECK_STATUS(gw_rate_filter_constants(&constants, R(0.0), R(200.0), COUNTS, R(600.0)), GW_STATUS_CONFIG_INVALID);
    CHECK_STATUS(gw_rate_filter_constants(&constants, PERIOD, R(0.0), COUNTS, R(600.0)), GW_STATUS_CONFIG_INVALID);
    CHECK_STATUS(gw_rate_filter_constants(&constants, PERIOD, R(200.0), 3U, R(600.0)), GW_STATUS_CONFIG_INVALID);
    CHECK_STATUS(gw_rate_filter_constants(&constants, PERIOD, R(200.0), COUNTS, R(-1.0)), GW_STATUS_CONFIG_INVALID);
}

static void a_stiffness_of_nearly_nothing_is_rigid(void)
{
    CHECK(made(R(0.0)).compliance_rad_per_nm == GW_ZERO);
    CHECK(made(R(1e-7)).compliance_rad_per_nm == GW_ZERO);
    CHECK(made(R(0.000001)).compliance_rad_per_nm == (GW_ONE / R(0.000001)));
    CHECK(made(R(500.0)).compliance_rad_per_nm == (GW_ONE / R(500.0)));
}

/* count + by for by > 0, with the wrap of a counter. */
static int32_t advanced(int32_t count, int32_t by)
{
    const int32_t left = INT32_MAX - ((count < 0) ? 0 : count);
    return (by <= left) ? (count + by) : (INT32_MIN + ((by - left) - 1));
}

/* Two counts per tick, across the wrap of the counter: 2 * 2 pi/8000/0.001 rad/s after many time constants. */
static void a_steady_rate_is_found(void)
{
    const gw_rate_filter_constants_t constants = made(R(0.0));
    gw_rate_filter_t filter;
    int32_t count = INT32_MAX - 401;
    gw_rate_filter_restart(&filter);
    CHECK(gw_rate_filter_invariant_holds(&filter));
    for (uint32_t i = 0U; i < 400U; i++) {
        gw_rate_filter_step(&filter, &constants, count, R(0.0));
        CHECK(gw_rate_filter_invariant_holds(&filter));
        count = advanced(count, 2);
    }
    CHECK(count < 0);
    CHECK_NEAR(filter.rate_radps, R(1.57079632679489662), R(2.0) * ROUNDING);
    /* The residue of the filter after 400 ms at 200 rad/s is e^-80. */
    CHECK_NEAR(filter.derivative_radps2, GW_ZERO, R(200.0) * ROUNDING);
}

/* The critically damped step: 1 - (1 + w t) e^(-w t) of the rate, at w t = 1. */
static void a_step_of_the_rate_is_followed_exactly(void)
{
    const gw_rate_filter_constants_t constants = made(R(0.0));
    gw_rate_filter_t filter;
    int32_t count = 0;
    gw_rate_filter_restart(&filter);
    gw_rate_filter_step(&filter, &constants, count, R(0.0));
    CHECK(filter.rate_radps == GW_ZERO);
    for (uint32_t i = 0U; i < 5U; i++) {
        count += 100;
        gw_rate_filter_step(&filter, &constants, count, R(0.0));
    }
    CHECK_NEAR(filter.rate_radps, R(78.5398163397448310) * R(0.26424111765711536), R(80.0) * ROUNDING);
}

/* A torque step that winds the spring up by one count's angle while the count advances by one: the wheel stood. */
static void the_wind_up_of_the_drivetrain_is_taken_off(void)
{
    const gw_rate_filter_constants_t constants = made(R(500.0));
    gw_rate_filter_t filter;
    const gw_real_t torque = R(500.0) * constants.rad_per_count;
    gw_rate_filter_restart(&filter);
    gw_rate_filter_step(&filter, &constants, 0, R(0.0));
    gw_rate_filter_step(&filter, &constants, 1, torque);
    CHECK_NEAR(filter.rate_radps, GW_ZERO, ROUNDING);
}

/* A robot that already moves when its filter starts: only before the first sample it is assumed to move as commanded.
 */
static void a_rate_may_be_presumed_before_the_first_sample(void)
{
    const gw_rate_filter_constants_t constants = made(R(0.0));
    gw_rate_filter_t filter;
    gw_rate_filter_restart(&filter);
    gw_rate_filter_presume(&filter, unit_nan());
    CHECK(filter.rate_radps == GW_ZERO);
    gw_rate_filter_presume(&filter, R(3.0));
    CHECK(filter.rate_radps == R(3.0));
    gw_rate_filter_step(&filter, &constants, 0, R(0.0));
    CHECK(filter.rate_radps == R(3.0));
    gw_rate_filter_presume(&filter, R(5.0));
    CHECK(filter.rate_radps == R(3.0));
    CHECK(gw_rate_filter_invariant_holds(&filter));
}

static void the_invariant_sees_every_member(void)
{
    gw_rate_filter_t filter;
    CHECK(!gw_rate_filter_invariant_holds(NULL));
    gw_rate_filter_restart(&filter);
    filter.last_torque_nm = unit_nan();
    CHECK(!gw_rate_filter_invariant_holds(&filter));
    gw_rate_filter_restart(&filter);
    filter.rate_radps = unit_infinity();
    CHECK(!gw_rate_filter_invariant_holds(&filter));
    gw_rate_filter_restart(&filter);
    filter.derivative_radps2 = unit_nan();
    CHECK(!gw_rate_filter_invariant_holds(&filter));
}

void suite_rate_filter(void)
{
    unit_run("constants_are_checked", constants_are_checked);
    unit_run("a_stiffness_of_nearly_nothing_is_rigid", a_stiffness_of_nearly_nothing_is_rigid);
    unit_run("a_steady_rate_is_found", a_steady_rate_is_found);
    unit_run("a_step_of_the_rate_is_followed_exactly", a_step_of_the_rate_is_followed_exactly);
    unit_run("the_wind_up_of_the_drivetrain_is_taken_off", the_wind_up_of_the_drivetrain_is_taken_off);
    unit_run("a_rate_may_be_presumed_before_the_first_sample", a_rate_may_be_presumed_before_the_first_sample);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
