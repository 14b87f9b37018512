#include "parts.h"

static gw_estimator_t estimator;
static gw_estimator_config_t config;
static gw_geometry_config_t geometry;
static gw_inertia_config_t inertia;
static gw_friction_config_t friction;

static void draw_configs(void)
{
    draw_estimator_config(&config);
    draw_geometry_config(&geometry);
    draw_inertia_config(&inertia);
    draw_friction_config(&friction);
    geometry.wheel_slot[0] = 1U; /* the slots: any in kinematics.c */
    geometry.wheel_slot[1] = 2U;
    geometry.wheel_slot[2] = 0U;
}

static gw_estimator_input_t any_input(void)
{
    gw_estimator_input_t input = {
        {{any_real(), any_real(), any_real()}},
        {any_int, any_int, any_int},
        {any_real(), any_real(), any_real()},
        {any_real(), any_real(), any_real()},
        {{any_real(), any_real(), any_real()}, {any_real(), any_real(), any_real()}, any_flag(), any_real()}};
    return input;
}

static void part_init_succeeds(void)
{
    demand_count((uint32_t)gw_estimator_init(&estimator, &config, &geometry, &inertia, &friction,
                                             draw_setting(GW_FIELD_CONTROLLER_PERIOD)),
                 0U, 0U);
    gw_estimator_set_imu_cutoff(&estimator, draw_setting(GW_FIELD_IMU_CUTOFF));
    hold_estimator(&estimator);
}

/* Aligned is valid with a measured acceleration only, the IMU's or the encoders'. */
static void part_init(void)
{
    draw_configs();
    if (any_flag()) {
        config.aligned = 0U;
        part_init_succeeds();
    } else {
        config.acceleration_source = any_flag() ? GW_SOURCE_MEASURED : GW_SOURCE_IMU;
        part_init_succeeds();
    }
}

static void part_step(void)
{
    const gw_estimator_input_t input = any_input();
    gw_estimator_output_t output;
    gw_wheels_t torque_nm;
    draw_estimator(&estimator);
    draw_wheels(&torque_nm, GW_TORQUE_MAX);
    draw_wrench(&output.zero_step, ZERO_STEP_MAX); /* kept until the next change */
    gw_joint_command_t command;
    draw_joint_command(&command);
    const uint32_t kind = draw_count(0U, 4U);
    if (kind == 0U) {
        (void)gw_estimator_step(&estimator, &input, &output);
        hold_wrench(&output.mean, (gw_real_t)1.1e12);
        hold_wrench(&output.window_mean, (gw_real_t)1.1e12);
        hold_wrench(&output.zero_step, ZERO_STEP_MAX);
        hold_model_forces(&output.forces, GW_REAL_MAX);
        demand_real(output.gear_n2, GW_ZERO, (gw_real_t)1.0e12);
        demand_real(output.counted, GW_ZERO, GW_TWO);
    } else if (kind == 1U) {
        (void)gw_estimator_tare(&estimator, &torque_nm);
    } else if (kind == 2U) {
        gw_estimator_start_tare(&estimator);
    } else if (kind == 3U) {
        gw_estimator_tell_command(&estimator, &command, any_flag());
    } else {
        gw_estimator_restart(&estimator);
    }
    demand_real(gw_estimator_encoder_angle(&estimator, any_int), -PI_ROUNDED, PI_ROUNDED);
    hold_estimator(&estimator);
    (void)gw_estimator_invariant_holds(&estimator);
}

static void part_refusals(void)
{
    const gw_estimator_input_t input = any_input();
    gw_estimator_output_t output;
    draw_configs();
    if (any_flag()) {
        config.torque_noise_nm = draw_refused(GW_FIELD_ESTIMATOR_TORQUE_NOISE);
    } else {
        geometry.azimuth_rad = draw_refused(GW_FIELD_GEOMETRY_AZIMUTH);
    }
    (void)gw_estimator_init(any_flag() ? &estimator : NULL, any_flag() ? &config : NULL, &geometry, &inertia, &friction,
                            (gw_real_t)0.001);
    estimator.initialised = false;
    (void)gw_estimator_step(&estimator, &input, &output);
    disturb_estimator(&estimator);
    (void)gw_estimator_invariant_holds(any_flag() ? &estimator : NULL);
}
