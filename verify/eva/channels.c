/* gw_channels with gw_fast_channel and gw_slow_channel. */
#include "parts.h"

static gw_channels_t channels;
static gw_channels_config_t config;
static gw_kinematics_t kinematics;

/* What gw_controller makes of any valid configuration. */
static gw_channels_noise_t any_noise(void)
{
    gw_channels_noise_t noise;
    noise.period_s = draw_setting(GW_FIELD_CONTROLLER_PERIOD);
    noise.cutoff_radps = draw_setting(GW_FIELD_ESTIMATOR_RATE_CUTOFF);
    noise.encoder_step_m = draw_real(GW_ZERO, (gw_real_t)1.6);
    noise.observed_step_m = draw_real(GW_ZERO, (gw_real_t)1.6);
    noise.twist_noise_m = draw_real(GW_ZERO, (gw_real_t)1.2e8);
    noise.force_noise_n = draw_real(GW_ZERO, (gw_real_t)3.0e4);
    noise.mass_kg = draw_real((gw_real_t)0.1, (gw_real_t)2.2e6);
    noise.yaw_inertia_kgm2 = draw_real((gw_real_t)0.0001, (gw_real_t)3.1e7);
    noise.sliding_n = draw_real(GW_ZERO, (gw_real_t)1.1e5);
    noise.wheel_distance_m = draw_setting(GW_FIELD_GEOMETRY_WHEEL_DISTANCE);
    noise.imu.acceleration_mps2 = draw_real(GW_ZERO, (gw_real_t)200.0);
    noise.imu.vibration_mps2 = draw_setting(GW_FIELD_IMU_VIBRATION);
    noise.imu.yaw_rate_radps = draw_real(GW_ZERO, (gw_real_t)20.0);
    noise.imu.arm_m = draw_real(GW_ZERO, (gw_real_t)1.0e4); /* what Eva sees of a root */
    noise.imu.cutoff_radps = draw_setting(GW_FIELD_IMU_CUTOFF);
    return noise;
}

static void part_init(void)
{
    const gw_channels_noise_t noise = any_noise();
    draw_channels_config(&config);
    gw_channels_init(&channels, &config, &noise);
    hold_channels(&channels);
}

static void part_step(void)
{
    gw_channels_input_t input;
    gw_channels_output_t output;
    const gw_wrench_t wrench = {any_real(), any_real(), any_real()};
    gw_model_forces_t forces;
    gw_wrench_t zero_step;
    draw_model_forces(&forces, GW_REAL_MAX);
    draw_wrench(&zero_step, ZERO_STEP_MAX);
    input.wrench = &wrench;
    input.forces = &forces;
    input.zero_step = &zero_step;
    input.zero_changed = any_flag();
    input.regime = (gw_regime_t)draw_count(0U, (uint32_t)GW_REGIME_MOTION);
    input.turned = any_flag();
    input.counted = draw_real(GW_ZERO, GW_TWO);
    input.enabled = any_flag();
    input.reacting = any_flag();
    input.felt = any_flag();
    input.shaking_mps2_2 = draw_real(GW_ZERO, (gw_real_t)1.0e8);
    input.gear_n2 = draw_real(GW_ZERO, (gw_real_t)1.0e12);
    gw_wheels_t torque_nm;
    draw_wheels(&torque_nm, GW_TORQUE_MAX);
    input.torque_nm = &torque_nm;
    const gw_real_t fastest = (gw_real_t)1.0e9;
    const gw_twist_t twist = {draw_real(-fastest, fastest), draw_real(-fastest, fastest), draw_real(-fastest, fastest)};
    input.twist = &twist;
    draw_wrench(&output.mean_wrench, GW_WRENCH_MAX); /* written when it is refined, else kept */
    draw_vector(&output.push_n, GW_WRENCH_MAX);
    draw_channels(&channels);
    draw_kinematics(&kinematics);
    if (any_flag()) {
        gw_channels_restart(&channels);
    } else if (any_flag()) {
        gw_channels_resume(&channels);
    } else {
        gw_channels_step(&channels, &kinematics, &input, &output);
        demand_real(output.statistic, GW_ZERO, (gw_real_t)1.0e10);
        demand_count(output.channel, 0U, GW_CHANNEL_SLOW);
        hold_wrench(&output.mean_wrench, GW_WRENCH_MAX);
        hold_vector(&output.push_n, GW_WRENCH_MAX);
        hold_vector(&output.force_n, GW_WRENCH_MAX);
    }
    hold_channels(&channels);
    (void)gw_channels_invariant_holds(&channels);
}

static void part_refusals(void)
{
    disturb_channels(&channels);
    (void)gw_channels_invariant_holds(any_flag() ? &channels : NULL);
    (void)gw_fast_channel_invariant_holds(any_flag() ? &channels.fast : NULL);
    (void)gw_slow_channel_invariant_holds(any_flag() ? &channels.slow : NULL);
}
