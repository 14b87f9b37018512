/* The external wrench at every tick: nominal torques, tares, rest or motion, (40), moving average.
 *
 * T|0, the torques without contact, depends on the regime:
 *     Rest: the planned speed was at most rest_speed for rest_ticks AND a quiet tare was taken at the end of that time.
 *     T|0 is that tare; with measured sources the model is added.
 *     Motion: T|0 is the model (38) plus the tare of the run.
 *     Creeping: slower than creep_speed, or just stopped. T|0 is as in motion, but the model is poor: stuck rollers
 *     stay deflected, while tanh(0) = 0. The detector therefore forgives more.
 * Coming to rest and leaving it empties the average.
 *
 * With bristles the deflection of stuck rollers is part of the model. A tare then takes as zero only that part of the
 * torques that the deflections do not explain. The deflections persist from motion to rest and back, so leaving rest
 * changes the estimate only by their error. At rest a push is seen whole: the part that the drivetrains feel and the
 * part that the rollers carry past them.
 *
 * Life cycle: gw_estimator_init; gw_estimator_tare per tick until done (at once if tare_ticks is 0); then
 * gw_estimator_step per tick; gw_estimator_restart after a gap in the samples. All members are private.
 */
#ifndef GW_ESTIMATOR_H
#define GW_ESTIMATOR_H

#include "giveway/gw_balance.h"
#include "giveway/gw_config.h"
#include "giveway/gw_gear.h"
#include "giveway/gw_imu.h"
#include "giveway/gw_kinematics.h"
#include "giveway/gw_lowpass.h"
#include "giveway/gw_motor.h"
#include "giveway/gw_moving_average.h"
#include "giveway/gw_nominal.h"
#include "giveway/gw_presliding.h"
#include "giveway/gw_rate_filter.h"
#include "giveway/gw_tare.h"
#include "giveway/gw_types.h"
#include "giveway/gw_wrench.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GW_SOURCE_PLANNED 0U
#define GW_SOURCE_MEASURED 1U
#define GW_SOURCE_ZERO 2U
#define GW_SOURCE_IMU 3U

#define GW_FRICTION_TANH 0U
#define GW_FRICTION_BRISTLE 1U

typedef struct {
    /* Velocity of the friction model: GW_SOURCE_PLANNED (0) or GW_SOURCE_MEASURED (1). */
    uint32_t velocity_source;
    /* Acceleration in (38): GW_SOURCE_PLANNED (0), GW_SOURCE_MEASURED (1), GW_SOURCE_ZERO (2), or GW_SOURCE_IMU (3)
     * while the IMU can be trusted, else as measured. */
    uint32_t acceleration_source;
    /* Standard deviation of one torque sample, N m, [0, 100]. */
    gw_real_t torque_noise_nm;
    /* Corner of the rate filters, rad/s, [0.1, 10000]. */
    gw_real_t rate_cutoff_radps;
    /* Stiffness between encoder and wheel, N m/rad, [0, 10000000]; 0: rigid. */
    gw_real_t drivetrain_stiffness_nm_per_rad;
    /* Encoder counts per turn of the wheel, [4, 1000000]. */
    uint32_t encoder_counts;
    /* Window of the moving average, samples, [1, 1024]. */
    uint32_t average_window;
    /* Planned speed, of the centre and of the wheels' circle, up to which the robot counts as standing, m/s, [0, 1]. */
    gw_real_t rest_speed_mps;
    /* Planned speed up to which the robot creeps, unless it is at rest, m/s, [0, 1]. */
    gw_real_t creep_speed_mps;
    /* Ticks of standing before the mode is rest, [1, 100000]. */
    uint32_t rest_ticks;
    /* Length of the tare of the run, ticks, [0, 100000]; 0: none, the sensors are taken to have no offset. */
    uint32_t tare_ticks;
    /* Length of the tare after each stop, ticks, [1, 100000]. */
    uint32_t retare_ticks;
    /* Largest variation of a torque within a tare, N m, [0, 100]. */
    gw_real_t tare_variation_nm;
    /* Friction of the rollers: GW_FRICTION_TANH (0), the paper's (28) at velocity_source, or GW_FRICTION_BRISTLE (1),
     * presliding at the measured motion. */
    uint32_t friction_model;
    /* 1: torques and friction pass the low-pass of the measured acceleration, so that no term of the balance comes
     * earlier than another; only with acceleration_source GW_SOURCE_MEASURED or GW_SOURCE_IMU, then the IMU's low-pass.
     * 0: as the paper, each as it comes. [0, 1]. */
    uint32_t aligned;
    /* Read by GW_FRICTION_BRISTLE only, checked always. */
    gw_presliding_config_t presliding;
    /* What the torque signals show beside the torque on the wheels: gears, or nothing. */
    gw_gear_config_t gear;
#if (GW_WITH_CHANNELS == 1)
    /* What is known of the motors, for finer angles than the encoders' counts. */
    gw_motor_config_t motor;
#endif
} gw_estimator_config_t;

typedef struct {
    gw_estimator_config_t config;
    gw_kinematics_t kinematics;
    gw_nominal_t nominal;
    gw_rate_filter_constants_t rate_constants;
    gw_rate_filter_t rate[GW_WHEEL_COUNT];
    gw_presliding_t presliding;
    gw_tare_t run_tare;
    gw_tare_t stop_tare;
    gw_wheels_t run_zero_nm;
    gw_wheels_t rest_zero_nm;
    gw_wrench_sigma_t sigma; /* of one sample */
    uint32_t slow_ticks;     /* ticks of standing, saturating */
#if (GW_WITH_CHANNELS == 1)
    gw_rate_filter_constants_t imu_constants; /* of the low-pass that the IMU's acceleration has passed */
    gw_motor_t motor;
    gw_lowpass_t aligned_torque[GW_WHEEL_COUNT];
    gw_lowpass_t aligned_friction[GW_WHEEL_COUNT];
    gw_wrench_t last_wrench; /* what a change of the acceleration's source is compared with */
    uint32_t last_source;    /* of the acceleration */
#endif
    bool rest;
    bool initialised;
    gw_moving_average_t average;
} gw_estimator_t;

typedef struct {
    gw_wheels_t torque_nm;
    int32_t encoder_count[GW_WHEEL_COUNT];
    /* Planned motion at the time of the sample, along the base's axes. */
    gw_twist_t planned_twist;
    gw_acceleration_t planned_acceleration;
#if (GW_WITH_CHANNELS == 1)
    gw_imu_output_t imu; /* all zero: none */
#endif
} gw_estimator_input_t;

typedef struct {
    gw_wrench_t wrench;      /* of this tick */
    gw_wrench_t mean;        /* over the samples held */
    gw_wrench_t window_mean; /* over the whole window */
    uint32_t mean_samples;
    gw_wrench_sigma_t sigma; /* of wrench; that of a mean of n is sqrt(n) smaller */
    gw_wheels_t nominal_nm;  /* T|0 */
    gw_real_t gear_n2;       /* variance of a component of the force, from what the gears may be wrong by; 0 at rest */
    gw_twist_t measured_twist;
    gw_regime_t regime;
    bool zero_changed; /* the robot came to rest or left it, or the acceleration has another source or zero */
    uint32_t acceleration_source; /* the one that was used: GW_SOURCE_... */
#if (GW_WITH_CHANNELS == 1)
    gw_wrench_t zero_step; /* by how much the wrench jumped when the zero changed; kept until the next change */
    gw_wheels_t torque_nm; /* that was sensed, with its zero */
    /* The model's forces in the balance. */
    gw_model_forces_t forces;
    bool turned;       /* an encoder has moved since the last sample */
    gw_real_t counted; /* of gw_motor_step; 0 if the motors are not known */
#endif
} gw_estimator_output_t;

/* The values of Trikey, the paper's robot. Pointers not NULL in these two. */
void gw_estimator_config_trikey(gw_estimator_config_t *config);
GW_SMALL void gw_estimator_config_check(const gw_estimator_config_t *config, gw_config_error_t *error);
GW_SMALL gw_status_t gw_estimator_init(gw_estimator_t *estimator, const gw_estimator_config_t *config,
                                       const gw_geometry_config_t *geometry, const gw_inertia_config_t *inertia,
                                       const gw_friction_config_t *friction, gw_real_t period_s);
bool gw_estimator_invariant_holds(const gw_estimator_t *estimator);
/* Starts a new tare of the run; the old zero stays in use until it is done. Pointers not NULL here and below. */
GW_SMALL void gw_estimator_start_tare(gw_estimator_t *estimator);
/* One tick of the tare of the run, standing still. DONE: this torque is the zero, the mode is rest. */
GW_SMALL gw_tare_progress_t gw_estimator_tare(gw_estimator_t *estimator, const gw_wheels_t *torque_nm);
/* Filters and average start afresh after a gap; zeros and mode stay. */
GW_SMALL void gw_estimator_restart(gw_estimator_t *estimator);
/* The IMU's acceleration has passed a low-pass of this corner: what is aligned with it passes the same. After init. */
GW_SMALL void gw_estimator_set_imu_cutoff(gw_estimator_t *estimator, gw_real_t cutoff_radps);
/* One tick. Input that is not finite or larger than any robot's, or a wrench that is not gw_wrench_is_valid:
 * GW_STATUS_INPUT_INVALID, wrench zero, filters and average start afresh. */
gw_status_t gw_estimator_step(gw_estimator_t *estimator, const gw_estimator_input_t *input,
                              gw_estimator_output_t *output);
/* What is sent to the drives in this tick. enabled: their servos follow it. */
void gw_estimator_tell_command(gw_estimator_t *estimator, const gw_joint_command_t *command, bool enabled);
/* Angle of the motor side of a wheel from its count, rad, [-pi, pi). */
GW_SMALL gw_real_t gw_estimator_encoder_angle(const gw_estimator_t *estimator, int32_t count);

#ifdef __cplusplus
}
#endif

#endif
