/* Settings of the paper's robot replaced one by one, then any inputs: samples, plans, requests. */
#include "bytes.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static gw_controller_config_t take_config(bytes_t *from)
{
    bytes_t bytes = *from;
    gw_controller_config_t config;
    gw_controller_config_trikey(&config);
    const uint32_t replaced = take_count(&bytes);
    if ((replaced & 1U) != 0U) {
        GW_CONTROLLER_FIELDS(TAKE, config.)
        GW_GEOMETRY_FIELDS(TAKE, config.geometry.)
    }
    if ((replaced & 2U) != 0U) {
        GW_INERTIA_FIELDS(TAKE, config.base.)
        GW_FRICTION_FIELDS(TAKE, config.friction.)
    }
    if ((replaced & 4U) != 0U) {
        GW_SENSOR_CHECK_FIELDS(TAKE, config.sensor_check.)
    }
    if ((replaced & 8U) != 0U) {
        GW_ESTIMATOR_FIELDS(TAKE, config.estimator.)
        GW_PRESLIDING_FIELDS(TAKE, config.estimator.presliding.)
        GW_MOTOR_FIELDS(TAKE, config.estimator.motor.)
    }
    if ((replaced & 16U) != 0U) {
        GW_ADMITTANCE_FIELDS(TAKE, config.admittance.)
        GW_ESCAPE_FIELDS(TAKE, config.admittance.)
        GW_TIP_FIELDS(TAKE, config.admittance.tip.)
    }
    if ((replaced & 32U) != 0U) {
        GW_CONTACT_FIELDS(TAKE, config.contact.)
    }
    if ((replaced & 128U) != 0U) {
        GW_DETECTOR_FIELDS(TAKE, config.detector.)
        GW_CHANNELS_FIELDS(TAKE, config.channels.)
        GW_FOLLOWER_FIELDS(TAKE, config.channels.follower.)
    }
    if ((replaced & 256U) != 0U) {
        GW_REFERENCE_FIELDS(TAKE, config.reference.)
        GW_SUPERVISOR_FIELDS(TAKE, config.supervisor.)
    }
    if ((replaced & 512U) != 0U) {
        GW_IMU_FIELDS(TAKE, config.imu.)
    }
    /* Few ticks each, so that an input of some 60 sees all modes. */
    config.sensor_check.recover_ticks = 1U + (replaced >> 28U);
    config.estimator.tare_ticks = (replaced >> 24U) & 3U;
    config.estimator.rest_ticks = 1U + ((replaced >> 20U) & 15U);
    config.estimator.retare_ticks = 1U + ((replaced >> 18U) & 3U);
    config.supervisor.settled_ticks = 1U + ((replaced >> 14U) & 15U);
    config.detector.blanking_ticks = (replaced >> 12U) & 3U;
    config.estimator.friction_model = (replaced >> 11U) & 1U;
    config.admittance.kind = (replaced >> 16U) % 3U;
    config.detector.kind = (replaced >> 19U) % 3U;
    config.imu.use = (replaced >> 10U) & 1U;
    config.imu.tare_ticks = 1U + ((replaced >> 21U) & 3U);
    if (config.imu.use == 1U) {
        config.estimator.acceleration_source = GW_SOURCE_IMU;
    }
    config.drives_enabled = (replaced & 64U) == 0U;
    *from = bytes;
    return config;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static gw_controller_t controller;
    bytes_t bytes = {data, size};
    const gw_controller_config_t config = take_config(&bytes);
    gw_config_error_t error;
    if (gw_controller_init(&controller, &config, &error) != GW_STATUS_OK) {
        DEMAND(error.field != GW_FIELD_NONE);
        return 0;
    }
    DEMAND(gw_controller_invariant_holds(&controller));
    uint32_t counter = 0U;
    int32_t count = 0;
    while (bytes.left > 0U) {
        gw_controller_input_t input;
        gw_controller_output_t output;
        const uint32_t requests = take_count(&bytes);
        counter += ((requests & 1U) != 0U) ? 0U : 1U;
        count = (int32_t)((uint32_t)count + ((requests >> 8U) & 63U));
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            input.sensor.torque_nm[i] = take_value(&bytes, (gw_real_t)10.0);
            input.sensor.encoder_count[i] = ((requests & 2U) != 0U) ? take_integer(&bytes) : count;
        }
        input.sensor.counter = counter;
        input.sensor.present = (requests & 12U) != 12U;
        input.plan.pose.x_m = take_value(&bytes, GW_ONE);
        input.plan.pose.y_m = take_value(&bytes, GW_ONE);
        input.plan.pose.theta_rad = take_value(&bytes, GW_ONE);
        input.plan.twist.vx_mps = take_value(&bytes, GW_ONE);
        input.plan.twist.vy_mps = take_value(&bytes, GW_ONE);
        input.plan.twist.omega_radps = take_value(&bytes, GW_ONE);
        input.plan.acceleration.ax_mps2 = take_value(&bytes, GW_ONE);
        input.plan.acceleration.ay_mps2 = GW_ZERO;
        input.plan.acceleration.alpha_radps2 = GW_ZERO;
        input.stop_request = (requests & 0x70U) == 0x70U;
        input.tare_request = (requests & 0x80U) != 0U;
        for (uint32_t i = 0U; i < GW_IMU_AXES; i++) {
            input.imu.specific_force_mps2[i] = take_value(&bytes, (gw_real_t)10.0);
        }
        input.imu.yaw_rate_radps = take_value(&bytes, GW_ONE);
        input.imu.counter = counter;
        input.imu.present = (requests & 0xC000U) != 0xC000U;
        /* The same for some ticks: the channels take their first mean over 60. */
        for (uint32_t held = requests >> 27U; held < 32U; held++) {
            const gw_status_t status = gw_controller_step(&controller, &input, &output);
            const bool bad = (status >= GW_STATUS_SENSOR_MISSING) && (status <= GW_STATUS_SENSOR_RECOVERING);
            DEMAND(gw_controller_invariant_holds(&controller));
            for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
                DEMAND(gw_in_range(output.command.angle_rad[i], -GW_PI, GW_PI));
                DEMAND(gw_is_finite(output.command.speed_radps[i]));
                DEMAND((!bad) || (output.command.speed_radps[i] == GW_ZERO));
            }
            DEMAND(gw_wrench_is_valid(output.estimate) && gw_wrench_is_valid(output.detection_wrench));
            DEMAND(gw_is_finite(output.contact.lever_arm_sigma_m) && gw_is_finite(output.detection_statistic));
            DEMAND(gw_is_finite(output.reference_pose.x_m) && gw_is_finite(output.reference_pose.y_m));
            counter += ((requests & 1U) != 0U) ? 0U : 1U;
            input.sensor.counter = counter;
            input.imu.counter = counter;
        }
    }
    return 0;
}
