/* Accelerometer and gyro, optional: the acceleration of the base's centre from what a part somewhere on the base shows.
 *
 * The part shows s = a - g + alpha x r + omega x (omega x r) along its own axes, where r is where it sits and g is
 * gravity along a floor that leans; each value times a scale, plus a bias. The bias is the mean over a while in which
 * the robot stands. What is left is a - (g - g_0): on a floor that leans the same that the tared torques balance.
 *
 * The three values pass a low-pass. alpha is what the low-passed yaw rate changes by in a tick, over the period.
 *
 * A result can be trusted if a bias is known and the samples were good for GW_IMU_RECOVER_TICKS: present, fresh (the
 * counter rises), finite, not saturated. Otherwise the result is zero.
 *
 * Life cycle: gw_imu_init, gw_imu_step per tick. All members are private.
 */
#ifndef GW_IMU_H
#define GW_IMU_H

#include "giveway/gw_config.h"
#include "giveway/gw_lowpass.h"
#include "giveway/gw_rate_filter.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GW_IMU_AXES 2U
/* Specific force along both axes, yaw rate. */
#define GW_IMU_SIGNALS 3U
/* Good samples before the result is trusted: the low-pass has forgotten what it started from. */
#define GW_IMU_RECOVER_TICKS 20U
/* No sensor shows more, m/s2 or rad/s: the limits of the configuration. */
#define GW_IMU_SHOWN_MAX ((gw_real_t)1.0e4)
/* Bounds of the result, m/s2 and rad/s2: what the shown values, the scales, the arm and the period allow. */
#define GW_IMU_ACCELERATION_MAX ((gw_real_t)1.0e10)

/* One sample as the bus delivers it. Any value is legal here; a struct of zeros means that there is no IMU. */
typedef struct {
    gw_real_t specific_force_mps2[GW_IMU_AXES];
    gw_real_t yaw_rate_radps;
    /* Advances with every sample; wraps. */
    uint32_t counter;
    /* False: there is no sample. */
    bool present;
} gw_imu_sample_t;

typedef struct {
    /* 0: there is none, samples are not looked at; 1: there is one; [0, 1]. */
    uint32_t use;
    /* Where it sits, base frame, m, [-2, 2]. */
    gw_real_t position_x_m;
    gw_real_t position_y_m;
    /* Direction of its x axis, base frame, rad, [-3.2, 3.2]. */
    gw_real_t angle_rad;
    /* Shown over true values of accelerometer and gyro, [0.5, 2]. */
    gw_real_t acceleration_scale;
    gw_real_t gyro_scale;
    /* Magnitudes from which they count as saturated, m/s2, [0.1, 10000], and rad/s, [0.01, 1000]. */
    gw_real_t acceleration_limit_mps2;
    gw_real_t yaw_rate_limit_radps;
    /* Standard deviations of one sample, m/s2, [0, 100], and rad/s, [0, 10]. */
    gw_real_t acceleration_noise_mps2;
    gw_real_t gyro_noise_radps;
    /* Vibration in motion, standard deviation on each axis, until it has been measured, m/s2, [0, 100]. */
    gw_real_t vibration_mps2;
    /* Ticks without a new sample after which it is stale, [1, 1000]. */
    uint32_t stale_ticks_max;
    /* Length of the tare of the bias, ticks, [1, 100000]. */
    uint32_t tare_ticks;
    /* Corner of the low-pass, rad/s, [0.1, 10000]. */
    gw_real_t cutoff_radps;
} gw_imu_config_t;

typedef struct {
    gw_imu_config_t config;
    gw_rotation_t mounting;
    gw_rate_filter_constants_t constants; /* of the low-pass: period, corner and decay count */
    gw_lowpass_t filter[GW_IMU_SIGNALS];
    gw_real_t zero[GW_IMU_SIGNALS];
    gw_real_t turning_radps2;       /* change of the low-passed yaw rate in the last tick, as shown */
    gw_real_t mean[GW_IMU_SIGNALS]; /* of the tare so far */
    gw_vector_t smooth_mps2[2];     /* what two low-passes leave: vibration is what they take away */
    gw_real_t shaking_mps2_2;       /* mean square of that on an axis */
    gw_real_t smooth_share;
    gw_real_t shaking_share;
    gw_real_t least_mps2_2; /* the sensor's own noise in it */
    uint32_t tare_count;    /* samples in the means */
    uint32_t good_ticks;    /* saturating at GW_IMU_RECOVER_TICKS */
    uint32_t last_counter;
    uint32_t age_ticks; /* ticks since the counter advanced, saturating */
    bool counter_known;
    bool tared;      /* in this stop */
    bool zero_known; /* ever */
    bool initialised;
} gw_imu_t;

typedef struct {
    /* Acceleration of the base's centre, base frame, low-passed. Zero unless trusted. */
    gw_acceleration_t acceleration;
    /* What another zero has changed in it in this tick. */
    gw_acceleration_t zero_step;
    bool trusted;
    /* Vibration in it, followed: mean square of what changes fast on an axis, (m/s2)^2. */
    gw_real_t shaking_mps2_2;
} gw_imu_output_t;

/* Standard deviations of the results' noise before the low-pass: of a component of the acceleration from the
 * accelerometer and from vibration, m/s2, and of the yaw rate, rad/s, whose derivative is alpha and, times the arm,
 * part of the acceleration. */
typedef struct {
    gw_real_t acceleration_mps2;
    gw_real_t vibration_mps2; /* a guess, in motion */
    gw_real_t yaw_rate_radps;
    gw_real_t arm_m;
    gw_real_t cutoff_radps;
} gw_imu_noise_t;

/* No IMU; numbers of a common MEMS part at the base's centre. Pointers not NULL in these two. */
void gw_imu_config_trikey(gw_imu_config_t *config);
GW_SMALL void gw_imu_config_check(const gw_imu_config_t *config, gw_config_error_t *error);
/* period: s, [0.0001, 0.1]. */
GW_SMALL gw_status_t gw_imu_init(gw_imu_t *imu, const gw_imu_config_t *config, gw_real_t period_s);
bool gw_imu_invariant_holds(const gw_imu_t *imu);
/* How noisy a trusted result is. Pointer not NULL. */
GW_SMALL gw_imu_noise_t gw_imu_noise(const gw_imu_t *imu);
/* One tick. at_rest: the robot stands, the bias may be taken. GW_STATUS_OK if the result is trusted, else the first of
 * GW_STATUS_SENSOR_MISSING (also without an IMU), ..._STALE, ..._NONFINITE, ..._SATURATED and ..._RECOVERING (too few
 * good samples yet, or no bias) that holds; the output is written unless it is NULL. */
gw_status_t gw_imu_step(gw_imu_t *imu, const gw_imu_sample_t *sample, bool at_rest, gw_imu_output_t *output);

#ifdef __cplusplus
}
#endif

#endif
