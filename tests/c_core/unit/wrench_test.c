#include "unit.h"

static gw_kinematics_t made(void)
{
    const gw_geometry_config_t geometry = {R(0.1), R(0.01), R(0.25), {0U, 1U, 2U}, R(0.0)};
    gw_kinematics_t kinematics;
    CHECK_STATUS(gw_kinematics_init(&kinematics, &geometry), GW_STATUS_OK);
    return kinematics;
}

static void a_wrench_beyond_any_robot_is_not_valid(void)
{
    const gw_real_t beyond[] = {unit_above(GW_WRENCH_MAX), unit_below(-GW_WRENCH_MAX), unit_nan(), unit_infinity()};
    const gw_wrench_t most = {GW_WRENCH_MAX, -GW_WRENCH_MAX, GW_WRENCH_MAX};
    CHECK(gw_wrench_is_valid(most));
    for (uint32_t i = 0U; i < UNIT_COUNT_OF(beyond); i++) {
        const gw_wrench_t rows[3] = {
            {beyond[i], GW_ZERO, GW_ZERO}, {GW_ZERO, beyond[i], GW_ZERO}, {GW_ZERO, GW_ZERO, beyond[i]}};
        unit_row(i);
        for (uint32_t k = 0U; k < 3U; k++) {
            CHECK(!gw_wrench_is_valid(rows[k]));
        }
    }
}

/* (40): the difference between expected and sensed torques is the push. */
static void the_wrench_of_a_known_push_is_recovered(void)
{
    const gw_kinematics_t kinematics = made();
    const gw_wrench_t push = {R(17.0), R(-5.0), R(2.0)};
    const gw_wheels_t nominal = {{R(0.3), R(-0.1), R(0.2)}};
    const gw_wheels_t of_push = gw_kinematics_torques_of_wrench(&kinematics, push);
    gw_wheels_t sensed;
    for (uint32_t i = 0U; i < 3U; i++) {
        sensed.wheel[i] = nominal.wheel[i] - of_push.wheel[i];
    }
    const gw_wrench_t found = gw_wrench_external(&kinematics, &nominal, &sensed);
    CHECK_NEAR(found.force_x_n, push.force_x_n, R(20.0) * ROUNDING);
    CHECK_NEAR(found.force_y_n, push.force_y_n, R(20.0) * ROUNDING);
    CHECK_NEAR(found.torque_nm, push.torque_nm, R(10.0) * ROUNDING);
}

static void noise_of_the_torques_shows_in_the_wrench(void)
{
    const gw_kinematics_t kinematics = made();
    const gw_wrench_sigma_t sigma = gw_wrench_noise(&kinematics, R(0.1));
    CHECK_NEAR(sigma.force_n, R(1.22474487139158905), R(2.0) * ROUNDING);
    CHECK_NEAR(sigma.torque_nm, R(0.433012701892219323), ROUNDING);
}

void suite_wrench(void)
{
    unit_run("a_wrench_beyond_any_robot_is_not_valid", a_wrench_beyond_any_robot_is_not_valid);
    unit_run("the_wrench_of_a_known_push_is_recovered", the_wrench_of_a_known_push_is_recovered);
    unit_run("noise_of_the_torques_shows_in_the_wrench", noise_of_the_torques_shows_in_the_wrench);
}
