/* The joint servo inside a drive: proportional-derivative, at 2 kHz, one per wheel.
 *
 * The reference (wrapped angle, speed) comes more slowly than the servo runs and is extrapolated in between. The angle
 * enters as encoder counts, which may wrap; the speed is a first-order low-pass of their differences.
 * A reference that is not finite, or none for stale_ticks_max ticks: the last angle is held at zero speed.
 *
 * Life cycle: gw_servo_init, gw_servo_step per tick. All members are private; a copy of the struct is a checkpoint.
 */
#ifndef GW_SERVO_H
#define GW_SERVO_H

#include "giveway/gw_config.h"
#include "giveway/gw_sum.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    /* Servo period, s, [0.00001, 0.1]. */
    gw_real_t period_s;
    /* Gains, N m/rad, [0, 1000000] and N m s/rad, [0, 100000]. */
    gw_real_t kp_nm_per_rad;
    gw_real_t kd_nms_per_rad;
    /* Torque saturation, N m, [0.01, 10000]. */
    gw_real_t torque_limit_nm;
    /* Fastest change of torque, N m/s, [0, 10000000]; 0: no limit. */
    gw_real_t torque_rate_limit_nm_per_s;
    /* Encoder counts per turn of the wheel, [4, 1000000]. */
    uint32_t encoder_counts;
    /* Corner frequency of the speed filter, Hz, [0.1, 10000]. */
    gw_real_t derivative_cutoff_hz;
    /* Ticks without a new reference after which the last angle is held, [1, 100000]. */
    uint32_t stale_ticks_max;
} gw_servo_config_t;

typedef struct {
    /* Desired wheel angle, rad, |angle| <= GW_ANGLE_MAX, and speed, rad/s. */
    gw_real_t angle_rad;
    gw_real_t speed_radps;
    /* True in the tick in which a new reference arrived. */
    bool reference_is_new;
    /* False: torque is zero. */
    bool enable;
    int32_t encoder_count;
} gw_servo_input_t;

typedef struct {
    gw_real_t torque_nm;
    /* Desired less measured angle, wrapped, rad; measured speed, rad/s. */
    gw_real_t angle_error_rad;
    gw_real_t speed_radps;
} gw_servo_output_t;

typedef struct {
    gw_servo_config_t config;
    gw_real_t rad_per_count;
    gw_real_t count_rate; /* rad/s of one count per tick */
    gw_real_t filter_gain;
    gw_real_t torque_step_nm;
    gw_sum_t desired_rad;
    gw_real_t desired_speed_radps;
    gw_real_t speed_radps;
    gw_real_t torque_nm;
    int32_t last_count;
    int32_t position_count; /* measured angle in counts, [0, encoder_counts) */
    uint32_t reference_age;
    gw_status_t reference_status;
    bool started;
    bool initialised;
} gw_servo_t;

GW_SMALL void gw_servo_config_check(const gw_servo_config_t *config, gw_config_error_t *error);
GW_SMALL gw_status_t gw_servo_init(gw_servo_t *servo, const gw_servo_config_t *config);
bool gw_servo_invariant_holds(const gw_servo_t *servo);
/* One tick. GW_STATUS_REFERENCE_INVALID or _STALE: the torque holds the last angle. Before the first reference the
 * first measured angle is held. Torque is zero if the servo is not initialised or not enabled. */
GW_SMALL gw_status_t gw_servo_step(gw_servo_t *servo, const gw_servo_input_t *input, gw_servo_output_t *output);

#ifdef __cplusplus
}
#endif

#endif
