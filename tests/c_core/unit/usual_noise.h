/* Sensors and a robot about as Trikey's, for the tests of the channels. */
#ifndef USUAL_NOISE_H
#define USUAL_NOISE_H

#include "unit.h"

#define PERIOD R(0.001)
#define SLIDING R(20.0)

static const gw_channels_noise_t usual = {
    .period_s = PERIOD,
    .cutoff_radps = R(200.0),
    .encoder_step_m = R(0.0001),
    .observed_step_m = R(0.0001),
    .twist_noise_m = R(0.00001),
    .force_noise_n = R(0.3),
    .sliding_n = SLIDING,
    .mass_kg = R(35.0),
    .yaw_inertia_kgm2 = R(1.5),
    .wheel_distance_m = R(0.25),
    .imu.acceleration_mps2 = R(0.02),
    .imu.vibration_mps2 = R(0.1),
    .imu.yaw_rate_radps = R(0.002),
    .imu.arm_m = R(0.2),
    .imu.cutoff_radps = R(1000.0),
};

#endif
