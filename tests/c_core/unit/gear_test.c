#include "unit.h"

static gw_gear_config_t gear_of(gw_real_t coulomb_nm, gw_real_t viscous)
{
    gw_gear_config_t config;
    gw_gear_config_none(&config);
    config.coulomb_torque_nm = coulomb_nm;
    config.viscous_nms_per_rad = viscous;
    config.tanh_slope_s_per_rad = R(10.0);
    return config;
}

static void without_friction_no_gear_is_sensed(void)
{
    const struct {
        gw_real_t coulomb_nm;
        gw_real_t viscous;
        bool sensed;
    } rows[] = {{GW_ZERO, GW_ZERO, false}, {R(0.01), GW_ZERO, true}, {GW_ZERO, R(0.01), true}, {R(0.3), R(0.02), true}};
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(rows); i++) {
        const gw_gear_config_t config = gear_of(rows[i].coulomb_nm, rows[i].viscous);
        unit_row(i);
        CHECK(gw_gear_is_sensed(&config) == rows[i].sensed);
    }
}

/* 0.4 tanh(10 rate) + 0.02 rate; a gear that turns is wrong by 0.3 of that, one that stands holds anything within
 * +-0.4, a variance of 0.4^2. */
static void friction_of_gears_is_added(void)
{
    const gw_gear_config_t config = gear_of(R(0.4), R(0.02));
    const gw_wheels_t rates = {{R(0.0), R(0.1), R(-20.0)}};
    gw_wheels_t torques = {{R(1.0), R(-1.0), R(2.0)}};
    const gw_real_t doubt_nm2 = gw_gear_add(&config, &rates, &torques);
    CHECK(torques.wheel[0] == R(1.0));
    CHECK_NEAR(torques.wheel[1], R(-0.69336233761769406), ROUNDING);
    CHECK_NEAR(torques.wheel[2], R(1.2), R(2.0) * ROUNDING);
    /* 0.16 + (0.3 * 0.30663766238230594)^2 + 0.16/cosh(1)^2 + (0.3 * 0.8)^2 */
    CHECK_NEAR(doubt_nm2, R(0.29325829369745987), R(0.1) * ROUNDING);
}

static void no_rate_makes_a_doubt_that_is_not_finite(void)
{
    gw_gear_config_t config = gear_of(R(100.0), R(100.0));
    const gw_wheels_t rates = {{R(1.0e6), R(-1.0e6), R(1.0e-30)}};
    gw_wheels_t torques = {{GW_ZERO, GW_ZERO, GW_ZERO}};
    config.tanh_slope_s_per_rad = R(1000.0);
    config.uncertainty = GW_ONE;
    CHECK(gw_in_range(gw_gear_add(&config, &rates, &torques), R(1.9e16), R(2.1e16)));
    CHECK(torques.wheel[0] == -torques.wheel[1]);
}

void suite_gear(void)
{
    unit_run("without_friction_no_gear_is_sensed", without_friction_no_gear_is_sensed);
    unit_run("friction_of_gears_is_added", friction_of_gears_is_added);
    unit_run("no_rate_makes_a_doubt_that_is_not_finite", no_rate_makes_a_doubt_that_is_not_finite);
}
