#include "rig.h"

gw_controller_config_t rig_config;
gw_controller_t rig_controller;
gw_controller_input_t rig_input;
gw_controller_output_t rig_output;

void rig_set_up(void)
{
    static const gw_controller_input_t nothing;
    gw_controller_config_paper(&rig_config);
    /* So light and smooth that moving it needs no torque: the sensors show only a push. */
    rig_config.base.mass_kg = R(0.1);
    rig_config.base.yaw_inertia_kgm2 = R(0.0001);
    rig_config.base.wheel_inertia_kgm2 = GW_ZERO;
    rig_config.base.roller_inertia_kgm2 = GW_ZERO;
    rig_config.friction.coulomb_torque_nm = GW_ZERO;
    rig_config.sensor_check.torque_limit_nm = R(20.0);
    rig_config.sensor_check.recover_ticks = 2U;
    rig_config.estimator.average_window = 4U;
    rig_config.estimator.rest_ticks = 10U;
    rig_config.estimator.tare_ticks = 4U;
    rig_config.estimator.retare_ticks = 4U;
    rig_config.estimator.tare_variation_nm = R(0.5);
    rig_config.detector.impulse_threshold_newton_s = R(0.5);
    rig_config.detector.leak_rest_n = R(1.0);
    rig_config.detector.leak_creep_n = R(40.0);
    rig_config.detector.leak_motion_n = R(3.0);
    rig_config.detector.release_force_n = R(6.0);
    rig_config.detector.blanking_ticks = 5U;
    rig_config.admittance.escape_impulse_newton_s = R(0.1) * rig_config.admittance.damping_newton_s_per_m; /* 0.1 m */
    rig_config.supervisor.settled_ticks = 3U;
    rig_input = nothing;
    rig_input.sensor.present = true;
}

void rig_begin(void)
{
    gw_config_error_t error;
    CHECK_STATUS(gw_controller_init(&rig_controller, &rig_config, &error), GW_STATUS_OK);
    CHECK_STATUS(error.field, GW_FIELD_NONE);
    CHECK(gw_controller_invariant_holds(&rig_controller));
    gw_controller_safe_output(&rig_output);
}

/* Outputs are always finite and within their limits. */
static void check_output(void)
{
    const gw_vector_t velocity = {rig_output.reference_twist.vx_mps, rig_output.reference_twist.vy_mps};
    const gw_vector_t force = {rig_output.estimate.force_x_n, rig_output.estimate.force_y_n};
    /* The reference and the admittance limit separately; both keep their limit to a few roundings. */
    const gw_real_t limit =
        gw_max(rig_config.reference.speed_limit_mps, rig_config.admittance.speed_limit_mps) * (GW_ONE + R(0.001));
    const gw_real_t wheel_limit =
        (limit + (rig_config.geometry.wheel_distance_m * rig_config.reference.yaw_rate_limit_radps)) /
        rig_config.geometry.wheel_radius_m;
    CHECK(gw_length(velocity) <= limit);
    CHECK(gw_is_finite(gw_length(force)) && gw_is_finite(rig_output.estimate.torque_nm));
    CHECK(gw_is_finite(rig_output.contact.point_m.x) && gw_is_finite(rig_output.contact.point_m.y));
    CHECK(gw_is_finite(rig_output.detection_statistic));
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        CHECK(gw_in_range(rig_output.command.angle_rad[i], -GW_PI, GW_PI));
        CHECK(gw_abs(rig_output.command.speed_radps[i]) <= (wheel_limit * (GW_ONE + R(0.001))));
    }
    CHECK(rig_output.mode == rig_controller.supervisor.mode);
}

gw_status_t rig_step(void)
{
    const gw_status_t status = gw_controller_step(&rig_controller, &rig_input, &rig_output);
    CHECK(gw_controller_invariant_holds(&rig_controller));
    check_output();
    return status;
}

void rig_tick(gw_status_t status)
{
    rig_input.sensor.counter++;
    CHECK_STATUS(rig_step(), status);
}

void rig_ticks(uint32_t count)
{
    for (uint32_t i = 0U; i < count; i++) {
        rig_tick(GW_STATUS_OK);
    }
}

void rig_until(gw_mode_t mode, uint32_t most)
{
    uint32_t i = 0U;
    while ((rig_output.mode != mode) && (i < most)) {
        rig_tick(GW_STATUS_OK);
        i++;
    }
    CHECK_STATUS(rig_output.mode, mode);
}

void rig_push(gw_real_t force_n)
{
    /* F_x = (t sqrt(3)/2 + t sqrt(3)/2)/r_w */
    const gw_real_t torque = (force_n * rig_config.geometry.wheel_radius_m) / R(1.73205080756887729);
    rig_input.sensor.torque_nm[0] = GW_ZERO;
    rig_input.sensor.torque_nm[1] = torque;
    rig_input.sensor.torque_nm[2] = -torque;
}

void rig_begin_with_a_push(gw_real_t force_n)
{
    rig_begin();
    rig_until(GW_MODE_TRACKING, 10U);
    rig_push(force_n);
    rig_until(GW_MODE_REACTING, 60U);
}
