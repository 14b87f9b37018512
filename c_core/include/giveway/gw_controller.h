/* The whole 1 kHz step: sensors, plan and requests in; wheel references, estimate, detection, mode and status out.
 *
 * Life cycle: fill gw_controller_config_t (gw_controller_config_trikey: for the paper's robot), gw_controller_init,
 * then gw_controller_step once per period. All members of gw_controller_t are private; a copy of it is a checkpoint.
 *
 * The path clock counts the ticks in which the robot follows its plan. It stands still while the robot tares, reacts,
 * rejoins its path or is stopped, so the plan waits for the robot. A plan is a function of this clock, not of time.
 */
#ifndef GW_CONTROLLER_H
#define GW_CONTROLLER_H

#include "giveway/gw_admittance.h"
#include "giveway/gw_channels.h"
#include "giveway/gw_config.h"
#include "giveway/gw_contact.h"
#include "giveway/gw_detector.h"
#include "giveway/gw_estimator.h"
#include "giveway/gw_imu.h"
#include "giveway/gw_joint.h"
#include "giveway/gw_reference.h"
#include "giveway/gw_sensor_check.h"
#include "giveway/gw_supervisor.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    /* Control period, s, [0.0001, 0.1]. All tick counts below are in this period. */
    gw_real_t period_s;
    gw_geometry_config_t geometry;
    gw_inertia_config_t base;
    gw_friction_config_t friction;
    gw_sensor_check_config_t sensor_check;
    gw_estimator_config_t estimator;
    gw_contact_config_t contact;
    gw_detector_config_t detector;
#if (GW_WITH_CHANNELS == 1)
    gw_channels_config_t channels; /* read if detector.kind is GW_DETECTOR_CHANNELS, checked always */
#endif
    gw_admittance_config_t admittance;
    gw_reference_config_t reference;
    gw_supervisor_config_t supervisor;
#if (GW_WITH_CHANNELS == 1)
    gw_imu_config_t imu; /* read if estimator.acceleration_source is GW_SOURCE_IMU, checked always */
#endif
    /* False: the drives are never enabled; the robot estimates and detects only. */
    bool drives_enabled;
} gw_controller_config_t;

typedef struct {
    gw_sensor_sample_t sensor;
    /* The plan at path_ticks of the last output (0 before the first step) times the period. */
    gw_plan_t plan;
    bool stop_request;
    /* A rising edge asks for a new tare of the run; granted in TRACKING at planned rest and in SETTLED. */
    bool tare_request;
    /* Accelerometer and gyro, optional. */
    gw_imu_sample_t imu;
} gw_controller_input_t;

typedef struct {
    /* Wheel references for the drives. */
    gw_joint_command_t command;
    bool enable;
    /* Averaged external wrench and where it acts, base frame. */
    gw_wrench_t estimate;
    gw_contact_estimate_t contact;
    /* Detection: active from a hit until the detector is armed again. */
    bool detection_active;
    gw_real_t detection_statistic;
    /* Hits so far modulo 2^31, the tick of the last one (-1: none yet), its mean wrench and place. */
    uint32_t detection_count;
    int32_t detection_tick;
    gw_wrench_t detection_wrench;
    gw_contact_estimate_t detection_contact;
    /* Which channel noticed it: GW_CHANNEL_NONE, GW_CHANNEL_FAST or GW_CHANNEL_SLOW. */
    uint32_t detection_channel;
    /* The IMU can be trusted, and where the acceleration in the estimate comes from: GW_SOURCE_... */
    bool imu_trusted;
    uint32_t acceleration_source;
    /* Reference, world frame. */
    gw_pose_t reference_pose;
    gw_twist_t reference_twist;
    gw_mode_t mode;
    /* Ticks of the path clock and of the controller, modulo 2^31. */
    uint32_t path_ticks;
    uint32_t tick;
} gw_controller_output_t;

typedef struct {
    gw_sensor_check_t sensor_check;
    gw_contact_t contact;
    gw_detector_t detector;
#if (GW_WITH_CHANNELS == 1)
    gw_channels_t channels;
    gw_channels_output_t contact_found;
    gw_contact_estimate_t contact_now; /* where it is while it lasts */
    gw_imu_t imu;
    gw_imu_output_t felt;
#endif
    gw_admittance_t admittance;
    gw_reference_t reference;
    gw_joint_t joint;
    gw_supervisor_t supervisor;
    gw_wrench_t detection_wrench;
    gw_contact_estimate_t detection_contact;
    uint32_t detection_count;
    int32_t detection_tick;
    uint32_t tick;
    gw_estimator_output_t estimate;
    gw_detector_output_t detection;
    bool drives_enabled;
    bool tare_request_before;
    bool on_plan; /* the reference was placed on the plan */
    bool turns;   /* the escape follows the direction as it becomes better; an interrupted one only comes to rest */
#if (GW_WITH_ESCAPE == 1)
    bool begins;        /* the reaction began with a hit, and not within another one */
    bool waits;         /* it brakes until the direction is sure */
    bool may_press;     /* the reaction began with a hit on the way: the robot may still move towards what it hit */
    bool may_be_pushed; /* it began with a hit, and the robot did not move towards it */
#endif
    bool initialised;
    gw_estimator_t estimator;
} gw_controller_t;

/* The paper's robot with the reflex that is recommended: measured motion and bristles, two channels, escape. What is
 * not linked (GW_WITH_CHANNELS, GW_WITH_ESCAPE in gw_types.h) is as in the paper. Pointer not NULL. */
void gw_controller_config_trikey(gw_controller_config_t *config);
/* The same robot with the paper's reflex: planned motion, impulse detector, frozen impulse. Pointer not NULL. */
void gw_controller_config_paper(gw_controller_config_t *config);
/* GW_STATUS_OK if every field is in range; else GW_STATUS_CONFIG_INVALID and the first bad field. Pointers not NULL. */
GW_SMALL gw_status_t gw_controller_config_check(const gw_controller_config_t *config, gw_config_error_t *error);
/* error may be NULL. After a refusal the controller answers every step with zero motion. */
GW_SMALL gw_status_t gw_controller_init(gw_controller_t *controller, const gw_controller_config_t *config,
                                        gw_config_error_t *error);
/* An output that means: do not move, drives off. Pointer not NULL. */
GW_SMALL void gw_controller_safe_output(gw_controller_output_t *output);
/* One control period. Call it once per period, soon after the sensors were sampled.
 *
 * Reads: the input, and the controller as the last step left it; no clock.
 * Writes: every member of the output, and the controller. The output is safe in every case.
 *
 * In this order: check the sensors; estimate the external wrench; detect a hit; choose the mode; move the reference
 * along the plan, along the escape or to a stop; map it to the wheels. A hit changes the references of the same tick.
 *
 * Returns GW_STATUS_OK, or the first of these that holds:
 *     GW_STATUS_NULL_POINTER, GW_STATUS_NOT_INITIALISED   the output is that of gw_controller_safe_output: drives off
 *     GW_STATUS_SENSOR_... , GW_STATUS_ENCODER_JUMP       bad sensors: mode FAULT, the last wheel angles at zero speed
 *     GW_STATUS_INPUT_INVALID                             the same, for torques or motions that no robot has
 *     GW_STATUS_PLAN_INVALID                              the plan is not used, the reference slows to a stop
 *     GW_STATUS_TARE_REFUSED                              otherwise as usual; the previous zero is kept
 *
 * Costs without channels and escape: at most 3,000 instructions on a Cortex-M4F, 4,000 with GW_FRICTION_BRISTLE, and
 * 512 bytes of stack; measured, and with everything on, see README.md. Loops run over the wheels and the outline's
 * vertices only: a step takes no longer after a day. */
gw_status_t gw_controller_step(gw_controller_t *controller, const gw_controller_input_t *input,
                               gw_controller_output_t *output);
/* True for every controller that init accepted, after any number of steps with any input. */
bool gw_controller_invariant_holds(const gw_controller_t *controller);

#ifdef __cplusplus
}
#endif

#endif
