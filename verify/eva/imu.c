#include "parts.h"

static gw_imu_t imu;
static gw_imu_config_t config;

static gw_imu_sample_t any_sample(void)
{
    const gw_imu_sample_t sample = {{any_real(), any_real()}, any_real(), any_count, any_flag()};
    return sample;
}

static void part_init(void)
{
    draw_imu_config(&config);
    demand_count((uint32_t)gw_imu_init(&imu, &config, draw_setting(GW_FIELD_CONTROLLER_PERIOD)), 0U, 0U);
    hold_imu(&imu);
}

static void part_step(void)
{
    const gw_imu_sample_t sample = any_sample();
    gw_imu_output_t output;
    draw_imu(&imu);
    const gw_imu_noise_t noise = gw_imu_noise(&imu);
    demand_real(noise.acceleration_mps2, GW_ZERO, (gw_real_t)200.0);
    demand_real(noise.yaw_rate_radps, GW_ZERO, (gw_real_t)20.0);
    demand_real(noise.arm_m, GW_ZERO, (gw_real_t)1.0e4);
    (void)gw_imu_step(&imu, &sample, any_flag(), &output);
    hold_imu_output(&output);
    hold_imu(&imu);
    (void)gw_imu_invariant_holds(&imu);
}

static void part_refusals(void)
{
    const gw_imu_sample_t sample = any_sample();
    gw_imu_output_t output;
    draw_imu_config(&config);
    config.gyro_noise_radps = draw_refused(GW_FIELD_IMU_GYRO_NOISE);
    (void)gw_imu_init(any_flag() ? &imu : NULL, any_flag() ? &config : NULL, GW_ONE);
    imu.initialised = false;
    (void)gw_imu_step(any_flag() ? &imu : NULL, any_flag() ? &sample : NULL, any_flag(), any_flag() ? &output : NULL);
    disturb_imu(&imu);
    (void)gw_imu_invariant_holds(any_flag() ? &imu : NULL);
}
