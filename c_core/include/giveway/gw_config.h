/* Every configuration field: its name, where it is kept, and the inclusive range that init checks. One table, from
 * which everything else follows: the enumeration below, gw_config_limit, gw_config_name, and what tests, proofs and
 * fuzzers walk through.
 */
#ifndef GW_CONFIG_H
#define GW_CONFIG_H

#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Kind, field, name, member, minimum, maximum; the units are in the headers of the modules. The names are those of the
 * FMU's parameters, whose ranges a test compares with these. No maximum of a count exceeds 2^24, so that float holds
 * every count exactly.
 *
 * One table per module. ROW is the name of a macro of six parameters, OF what stands before a member:
 * GW_DETECTOR_FIELDS(ROW, config->) writes config->kind. Kinds: REAL, COUNT (uint32_t), of each wheel WHEEL_REAL and
 * WHEEL_COUNT, of each vertex VERTEX_REAL (i counts the elements), and RULE, which relates several members.
 *
 * A field stands here, in the configuration of its module, and in that module's source: Trikey's value, the check, the
 * use. */
/* cppcheck-suppress-begin misra-c2012-20.7 ; DEV-02 ROW is the name of a macro, OF begins an expression */
#define GW_CONTROLLER_FIELDS(ROW, OF) \
    ROW(REAL, GW_FIELD_CONTROLLER_PERIOD, "controller.period", OF period_s, 0.0001, 0.1)

#define GW_GEOMETRY_FIELDS(ROW, OF) \
    ROW(REAL, GW_FIELD_GEOMETRY_WHEEL_RADIUS, "geometry.wheel_radius", OF wheel_radius_m, 0.005, 1) \
    ROW(REAL, GW_FIELD_GEOMETRY_ROLLER_RADIUS, "geometry.roller_radius", OF roller_radius_m, 0.001, 0.5) \
    ROW(REAL, GW_FIELD_GEOMETRY_WHEEL_DISTANCE, "geometry.wheel_distance", OF wheel_distance_m, 0.01, 5) \
    ROW(WHEEL_COUNT, GW_FIELD_GEOMETRY_WHEEL_SLOT, "geometry.wheel_slot", OF wheel_slot[i], 0, \
        GW_WHEELS - (gw_real_t)1) \
    ROW(REAL, GW_FIELD_GEOMETRY_AZIMUTH, "geometry.azimuth", OF azimuth_rad, -3.2, 3.2)

#define GW_INERTIA_FIELDS(ROW, OF) \
    ROW(REAL, GW_FIELD_BASE_MASS, "base.mass", OF mass_kg, 0.1, 2000) \
    ROW(REAL, GW_FIELD_BASE_YAW_INERTIA, "base.yaw_inertia", OF yaw_inertia_kgm2, 0.0001, 10000) \
    ROW(REAL, GW_FIELD_BASE_WHEEL_INERTIA, "base.wheel_inertia", OF wheel_inertia_kgm2, 0, 10) \
    ROW(REAL, GW_FIELD_BASE_ROLLER_INERTIA, "base.roller_inertia", OF roller_inertia_kgm2, 0, 1)

#define GW_FRICTION_FIELDS(ROW, OF) \
    ROW(REAL, GW_FIELD_FRICTION_COULOMB_TORQUE, "friction.coulomb_torque", OF coulomb_torque_nm, 0, 100) \
    ROW(REAL, GW_FIELD_FRICTION_TANH_SLOPE, "friction.tanh_slope", OF tanh_slope_s_per_rad, 0, 1000)

#define GW_SENSOR_CHECK_FIELDS(ROW, OF) \
    ROW(REAL, GW_FIELD_SENSOR_CHECK_TORQUE_LIMIT, "sensor_check.torque_limit", OF torque_limit_nm, 0.1, 10000) \
    ROW(COUNT, GW_FIELD_SENSOR_CHECK_STALE_TICKS_MAX, "sensor_check.stale_ticks_max", OF stale_ticks_max, 1, 1000) \
    ROW(COUNT, GW_FIELD_SENSOR_CHECK_ENCODER_JUMP, "sensor_check.encoder_jump", OF encoder_jump_counts, 1, 1000000) \
    ROW(COUNT, GW_FIELD_SENSOR_CHECK_RECOVER_TICKS, "sensor_check.recover_ticks", OF recover_ticks, 1, 100000)

#define GW_ESTIMATOR_FIELDS(ROW, OF) \
    ROW(COUNT, GW_FIELD_ESTIMATOR_VELOCITY_SOURCE, "estimator.velocity_source", OF velocity_source, 0, 1) \
    ROW(COUNT, GW_FIELD_ESTIMATOR_ACCELERATION_SOURCE, "estimator.acceleration_source", OF acceleration_source, 0, \
        GW_ACCELERATION_SOURCE_MAX) \
    ROW(REAL, GW_FIELD_ESTIMATOR_TORQUE_NOISE, "estimator.torque_noise", OF torque_noise_nm, 0, 100) \
    ROW(REAL, GW_FIELD_ESTIMATOR_RATE_CUTOFF, "estimator.rate_cutoff", OF rate_cutoff_radps, 0.1, 10000) \
    ROW(REAL, GW_FIELD_ESTIMATOR_DRIVETRAIN_STIFFNESS, "estimator.drivetrain_stiffness", \
        OF drivetrain_stiffness_nm_per_rad, 0, 10000000) \
    ROW(COUNT, GW_FIELD_ESTIMATOR_ENCODER_COUNTS, "estimator.encoder_counts", OF encoder_counts, 4, 1000000) \
    ROW(COUNT, GW_FIELD_ESTIMATOR_AVERAGE_WINDOW, "estimator.average_window", OF average_window, 1, \
        GW_MOVING_AVERAGE_CAPACITY) \
    ROW(REAL, GW_FIELD_ESTIMATOR_REST_SPEED, "estimator.rest_speed", OF rest_speed_mps, 0, 1) \
    ROW(REAL, GW_FIELD_ESTIMATOR_CREEP_SPEED, "estimator.creep_speed", OF creep_speed_mps, 0, 1) \
    ROW(COUNT, GW_FIELD_ESTIMATOR_REST_TICKS, "estimator.rest_ticks", OF rest_ticks, 1, 100000) \
    ROW(COUNT, GW_FIELD_ESTIMATOR_TARE_TICKS, "estimator.tare_ticks", OF tare_ticks, 0, 100000) \
    ROW(COUNT, GW_FIELD_ESTIMATOR_RETARE_TICKS, "estimator.retare_ticks", OF retare_ticks, 1, 100000) \
    ROW(REAL, GW_FIELD_ESTIMATOR_TARE_VARIATION, "estimator.tare_variation", OF tare_variation_nm, 0, 100) \
    ROW(COUNT, GW_FIELD_ESTIMATOR_FRICTION_MODEL, "estimator.friction_model", OF friction_model, 0, 1) \
    ROW(COUNT, GW_FIELD_ESTIMATOR_ALIGNED, "estimator.aligned", OF aligned, 0, GW_ALIGNED_MAX)

#define GW_PRESLIDING_FIELDS(ROW, OF) \
    ROW(WHEEL_REAL, GW_FIELD_ESTIMATOR_PRESLIDING_STIFFNESS, "estimator.presliding_stiffness", \
        OF stiffness_n_per_m[i], 10, 10000000) \
    ROW(REAL, GW_FIELD_ESTIMATOR_PRESLIDING_DAMPING, "estimator.presliding_damping", OF damping_newton_s_per_m, 0, \
        100000) \
    ROW(REAL, GW_FIELD_ESTIMATOR_STRIBECK_SPEED, "estimator.stribeck_speed", OF stribeck_speed_mps, 0.000001, 1) \
    ROW(REAL, GW_FIELD_ESTIMATOR_ELASTIC_FRACTION, "estimator.elastic_fraction", OF elastic_fraction, 0, 0.99)

#define GW_GEAR_FIELDS(ROW, OF) \
    ROW(REAL, GW_FIELD_GEAR_COULOMB_TORQUE, "gear.coulomb_torque", OF coulomb_torque_nm, 0, 100) \
    ROW(REAL, GW_FIELD_GEAR_VISCOUS_DAMPING, "gear.viscous_damping", OF viscous_nms_per_rad, 0, 100) \
    ROW(REAL, GW_FIELD_GEAR_TANH_SLOPE, "gear.tanh_slope", OF tanh_slope_s_per_rad, 0, 1000) \
    ROW(REAL, GW_FIELD_GEAR_UNCERTAINTY, "gear.uncertainty", OF uncertainty, 0, 1)

#define GW_CONTACT_FIELDS(ROW, OF) \
    ROW(REAL, GW_FIELD_CONTACT_MINIMUM_FORCE, "contact.minimum_force", OF minimum_force_n, 0.001, 1000) \
    ROW(COUNT, GW_FIELD_OUTLINE_COUNT, "outline.count", OF vertex_count, 3, GW_OUTLINE_VERTEX_MAX) \
    ROW(VERTEX_REAL, GW_FIELD_OUTLINE_X, "outline.x", OF vertex_m[i].x, -10, 10) \
    ROW(VERTEX_REAL, GW_FIELD_OUTLINE_Y, "outline.y", OF vertex_m[i].y, -10, 10) \
    ROW(RULE, GW_FIELD_OUTLINE_CONVEX, "outline (counter-clockwise, strictly convex)", OF vertex_m, 0, 0)

#define GW_DETECTOR_FIELDS(ROW, OF) \
    ROW(COUNT, GW_FIELD_DETECTOR_KIND, "detector.kind", OF kind, 0, GW_DETECTOR_KIND_MAX) \
    ROW(REAL, GW_FIELD_DETECTOR_FORCE_THRESHOLD, "detector.force_threshold", OF force_threshold_n, 0.01, 10000) \
    ROW(REAL, GW_FIELD_DETECTOR_IMPULSE_THRESHOLD, "detector.impulse_threshold", OF impulse_threshold_newton_s, 0.001, \
        1000) \
    ROW(REAL, GW_FIELD_DETECTOR_LEAK_REST, "detector.leak_rest", OF leak_rest_n, 0, 1000) \
    ROW(REAL, GW_FIELD_DETECTOR_LEAK_CREEP, "detector.leak_creep", OF leak_creep_n, 0, 1000) \
    ROW(REAL, GW_FIELD_DETECTOR_LEAK_MOTION, "detector.leak_motion", OF leak_motion_n, 0, 1000) \
    ROW(REAL, GW_FIELD_DETECTOR_RELEASE_FORCE, "detector.release_force", OF release_force_n, 0, 10000) \
    ROW(COUNT, GW_FIELD_DETECTOR_BLANKING_TICKS, "detector.blanking_ticks", OF blanking_ticks, 0, 100000)

#if (GW_WITH_CHANNELS == 1)
#define GW_CHANNELS_FIELDS(ROW, OF) \
    ROW(REAL, GW_FIELD_CHANNELS_NOISE_MULTIPLE, "channels.noise_multiple", OF noise_multiple, 1, 100) \
    ROW(REAL, GW_FIELD_CHANNELS_IMU_NOISE_MULTIPLE, "channels.imu_noise_multiple", OF imu_noise_multiple, 1, 100) \
    ROW(REAL, GW_FIELD_CHANNELS_MODEL_MULTIPLE, "channels.model_multiple", OF model_multiple, 0, 100) \
    ROW(REAL, GW_FIELD_CHANNELS_BASELINE_TIME, "channels.baseline_time", OF baseline_s, 0.01, 10) \
    ROW(REAL, GW_FIELD_CHANNELS_SLOW_TIME, "channels.slow_time", OF slow_s, 0.005, 10) \
    ROW(REAL, GW_FIELD_CHANNELS_SLOW_BASELINE_TIME, "channels.slow_baseline_time", OF slow_baseline_s, 0.01, 100) \
    ROW(REAL, GW_FIELD_CHANNELS_FRICTION_SHAPE, "channels.friction_shape", OF friction_shape, 0, 1) \
    ROW(REAL, GW_FIELD_CHANNELS_PRESLIDING, "channels.presliding", OF presliding, 0, 1) \
    ROW(REAL, GW_FIELD_CHANNELS_YAW_INERTIA, "channels.yaw_inertia", OF yaw_inertia, 0, 1) \
    ROW(REAL, GW_FIELD_CHANNELS_CENTRE_OF_MASS, "channels.centre_of_mass", OF centre_of_mass_m, 0, 1) \
    ROW(REAL, GW_FIELD_CHANNELS_LEVER, "channels.lever", OF lever_m, 0, 0.1) \
    ROW(REAL, GW_FIELD_CHANNELS_ROCKING, "channels.rocking", OF rocking, 0, 10) \
    ROW(REAL, GW_FIELD_CHANNELS_ROCKING_TIME, "channels.rocking_time", OF rocking_s, 0.01, 10) \
    ROW(REAL, GW_FIELD_CHANNELS_GRIP, "channels.grip", OF grip, 0, 10) \
    ROW(REAL, GW_FIELD_CHANNELS_RIPPLE, "channels.ripple", OF ripple, 0, 1) \
    ROW(REAL, GW_FIELD_CHANNELS_FAST_REST, "channels.fast_rest", OF fast.rest_n, 0.01, 1000) \
    ROW(REAL, GW_FIELD_CHANNELS_FAST_CREEP, "channels.fast_creep", OF fast.creep_n, 0.01, 1000) \
    ROW(REAL, GW_FIELD_CHANNELS_FAST_MOTION, "channels.fast_motion", OF fast.motion_n, 0.01, 1000) \
    ROW(REAL, GW_FIELD_CHANNELS_SLOW_REST, "channels.slow_rest", OF slow.rest_n, 0.01, 1000) \
    ROW(REAL, GW_FIELD_CHANNELS_SLOW_CREEP, "channels.slow_creep", OF slow.creep_n, 0.01, 1000) \
    ROW(REAL, GW_FIELD_CHANNELS_SLOW_MOTION, "channels.slow_motion", OF slow.motion_n, 0.01, 1000) \
    ROW(COUNT, GW_FIELD_CHANNELS_SETTLE_TICKS, "channels.settle_ticks", OF settle_ticks, 0, 100000) \
    ROW(COUNT, GW_FIELD_CHANNELS_LOCK_TICKS, "channels.lock_ticks", OF lock_ticks, 1, 100000) \
    ROW(COUNT, GW_FIELD_CHANNELS_REARM_TICKS, "channels.rearm_ticks", OF rearm_ticks, 1, 100000)

#define GW_FOLLOWER_FIELDS(ROW, OF) \
    ROW(REAL, GW_FIELD_FOLLOWER_FRICTION_COMMON, "follower.friction_common", OF friction_common, 0, 1) \
    ROW(REAL, GW_FIELD_FOLLOWER_FRICTION_WHEEL, "follower.friction_wheel", OF friction_wheel, 0, 1) \
    ROW(REAL, GW_FIELD_FOLLOWER_MASS, "follower.mass", OF mass, 0, 1) \
    ROW(REAL, GW_FIELD_FOLLOWER_DRIFT, "follower.drift", OF drift_per_root_s, 0, 1) \
    ROW(REAL, GW_FIELD_FOLLOWER_OFFSET, "follower.offset", OF offset_n, 0, 30) \
    ROW(REAL, GW_FIELD_FOLLOWER_RESIDUAL, "follower.residual", OF residual_n, 0.1, 1000)

#define GW_MOTOR_FIELDS(ROW, OF) \
    ROW(REAL, GW_FIELD_MOTOR_INERTIA, "motor.inertia", OF inertia_kgm2, 0, 10) \
    ROW(REAL, GW_FIELD_MOTOR_COULOMB_TORQUE, "motor.coulomb_torque", OF coulomb_torque_nm, 0, 1000) \
    ROW(REAL, GW_FIELD_MOTOR_KP, "motor.kp", OF kp_nm_per_rad, 0, 1000000) \
    ROW(REAL, GW_FIELD_MOTOR_KD, "motor.kd", OF kd_nms_per_rad, 0, 100000) \
    ROW(REAL, GW_FIELD_MOTOR_TORQUE_LIMIT, "motor.torque_limit", OF torque_limit_nm, 0.01, 10000) \
    ROW(REAL, GW_FIELD_MOTOR_DERIVATIVE_CUTOFF, "motor.derivative_cutoff", OF derivative_cutoff_hz, 0.1, 10000) \
    ROW(COUNT, GW_FIELD_MOTOR_DELAY, "motor.delay", OF delay_ticks, 1, GW_MOTOR_DELAY_MAX) \
    ROW(REAL, GW_FIELD_MOTOR_CUTOFF, "motor.cutoff", OF cutoff_radps, 1, 1000)

#define GW_IMU_FIELDS(ROW, OF) \
    ROW(COUNT, GW_FIELD_IMU_USE, "imu.use", OF use, 0, 1) \
    ROW(REAL, GW_FIELD_IMU_X, "imu.x", OF position_x_m, -2, 2) \
    ROW(REAL, GW_FIELD_IMU_Y, "imu.y", OF position_y_m, -2, 2) \
    ROW(REAL, GW_FIELD_IMU_ANGLE, "imu.angle", OF angle_rad, -3.2, 3.2) \
    ROW(REAL, GW_FIELD_IMU_ACCELERATION_SCALE, "imu.acceleration_scale", OF acceleration_scale, 0.5, 2) \
    ROW(REAL, GW_FIELD_IMU_GYRO_SCALE, "imu.gyro_scale", OF gyro_scale, 0.5, 2) \
    ROW(REAL, GW_FIELD_IMU_ACCELERATION_LIMIT, "imu.acceleration_limit", OF acceleration_limit_mps2, 0.1, 10000) \
    ROW(REAL, GW_FIELD_IMU_YAW_RATE_LIMIT, "imu.yaw_rate_limit", OF yaw_rate_limit_radps, 0.01, 1000) \
    ROW(REAL, GW_FIELD_IMU_ACCELERATION_NOISE, "imu.acceleration_noise", OF acceleration_noise_mps2, 0, 100) \
    ROW(REAL, GW_FIELD_IMU_GYRO_NOISE, "imu.gyro_noise", OF gyro_noise_radps, 0, 10) \
    ROW(REAL, GW_FIELD_IMU_VIBRATION, "imu.vibration", OF vibration_mps2, 0, 100) \
    ROW(COUNT, GW_FIELD_IMU_STALE_TICKS_MAX, "imu.stale_ticks_max", OF stale_ticks_max, 1, 1000) \
    ROW(COUNT, GW_FIELD_IMU_TARE_TICKS, "imu.tare_ticks", OF tare_ticks, 1, 100000) \
    ROW(REAL, GW_FIELD_IMU_CUTOFF, "imu.cutoff", OF cutoff_radps, 0.1, 10000)
#else
#define GW_CHANNELS_FIELDS(ROW, OF)
#define GW_FOLLOWER_FIELDS(ROW, OF)
#define GW_MOTOR_FIELDS(ROW, OF)
#define GW_IMU_FIELDS(ROW, OF)
#endif

#define GW_ADMITTANCE_FIELDS(ROW, OF) \
    ROW(COUNT, GW_FIELD_ADMITTANCE_KIND, "admittance.kind", OF kind, 0, GW_ADMITTANCE_KIND_MAX) \
    ROW(REAL, GW_FIELD_ADMITTANCE_MASS, "admittance.mass", OF mass_kg, 0.01, 10000) \
    ROW(REAL, GW_FIELD_ADMITTANCE_DAMPING, "admittance.damping", OF damping_newton_s_per_m, 0.01, 10000) \
    ROW(REAL, GW_FIELD_ADMITTANCE_ESCAPE_IMPULSE, "admittance.escape_impulse", OF escape_impulse_newton_s, 0, 1000) \
    ROW(REAL, GW_FIELD_ADMITTANCE_SPEED_LIMIT, "admittance.speed_limit", OF speed_limit_mps, 0.001, 10) \
    ROW(REAL, GW_FIELD_ADMITTANCE_ACCELERATION_LIMIT, "admittance.acceleration_limit", OF acceleration_limit_mps2, \
        0.001, 1000) \
    ROW(REAL, GW_FIELD_ADMITTANCE_FINISH_SPEED, "admittance.finish_speed", OF finish_speed_mps, 0, 1)

#if (GW_WITH_ESCAPE == 1)
#define GW_ESCAPE_FIELDS(ROW, OF) \
    ROW(REAL, GW_FIELD_ADMITTANCE_SMOOTHING, "admittance.smoothing", OF smoothing_s, 0, 1) \
    ROW(REAL, GW_FIELD_ADMITTANCE_BRAKE_LIMIT, "admittance.brake_limit", OF brake_limit_mps2, 0, 1000) \
    ROW(REAL, GW_FIELD_ADMITTANCE_LEAD, "admittance.lead", OF lead_s, 0, 0.2) \
    ROW(REAL, GW_FIELD_ADMITTANCE_PUSH_SHARE, "admittance.push_share", OF push_share, 0, 5) \
    ROW(REAL, GW_FIELD_ADMITTANCE_AHEAD, "admittance.ahead", OF ahead_mps, 0, 10)

#define GW_TIP_FIELDS(ROW, OF) \
    ROW(REAL, GW_FIELD_ADMITTANCE_TIP_HEIGHT, "admittance.tip_height", OF height_m, 0, 5) \
    ROW(REAL, GW_FIELD_ADMITTANCE_TIP_SHARE, "admittance.tip_share", OF share, 0.01, 1) \
    ROW(REAL, GW_FIELD_ADMITTANCE_TIP_OFFSET, "admittance.tip_offset", OF offset_m, 0, 1) \
    ROW(REAL, GW_FIELD_ADMITTANCE_TIP_SLOPE, "admittance.tip_slope", OF slope_rad, 0, 0.5)
#else
#define GW_ESCAPE_FIELDS(ROW, OF)
#define GW_TIP_FIELDS(ROW, OF)
#endif

#define GW_REFERENCE_FIELDS(ROW, OF) \
    ROW(REAL, GW_FIELD_REFERENCE_FOLLOW_GAIN, "reference.follow_gain", OF follow_gain_per_s, 0, 100) \
    ROW(REAL, GW_FIELD_REFERENCE_SPEED_LIMIT, "reference.speed_limit", OF speed_limit_mps, 0.001, 10) \
    ROW(REAL, GW_FIELD_REFERENCE_ACCELERATION_LIMIT, "reference.acceleration_limit", OF acceleration_limit_mps2, \
        0.001, 1000) \
    ROW(REAL, GW_FIELD_REFERENCE_YAW_RATE_LIMIT, "reference.yaw_rate_limit", OF yaw_rate_limit_radps, 0.001, 100) \
    ROW(REAL, GW_FIELD_REFERENCE_YAW_ACCELERATION_LIMIT, "reference.yaw_acceleration_limit", \
        OF yaw_acceleration_limit_radps2, 0.001, 10000) \
    ROW(REAL, GW_FIELD_REFERENCE_REJOIN_SPEED, "reference.rejoin_speed", OF rejoin_speed_mps, 0.001, 10) \
    ROW(REAL, GW_FIELD_REFERENCE_FINISH_SPEED, "reference.finish_speed", OF finish_speed_mps, 0, 1)

#define GW_SUPERVISOR_FIELDS(ROW, OF) \
    ROW(REAL, GW_FIELD_SUPERVISOR_SETTLED_SPEED, "supervisor.settled_speed", OF settled_speed_mps, 0.000001, 1) \
    ROW(COUNT, GW_FIELD_SUPERVISOR_SETTLED_TICKS, "supervisor.settled_ticks", OF settled_ticks, 1, 100000) \
    ROW(COUNT, GW_FIELD_SUPERVISOR_AFTER_SETTLED, "supervisor.after_settled", OF after_settled, 0, 1) \
    ROW(REAL, GW_FIELD_SUPERVISOR_REJOIN_DISTANCE, "supervisor.rejoin_distance", OF rejoin_distance_m, 0.00001, 1) \
    ROW(REAL, GW_FIELD_SUPERVISOR_REJOIN_ANGLE, "supervisor.rejoin_angle", OF rejoin_angle_rad, 0.0001, 1)

#define GW_SERVO_FIELDS(ROW, OF) \
    ROW(REAL, GW_FIELD_SERVO_PERIOD, "servo.period", OF period_s, 0.00001, 0.1) \
    ROW(REAL, GW_FIELD_SERVO_KP, "servo.kp", OF kp_nm_per_rad, 0, 1000000) \
    ROW(REAL, GW_FIELD_SERVO_KD, "servo.kd", OF kd_nms_per_rad, 0, 100000) \
    ROW(REAL, GW_FIELD_SERVO_TORQUE_LIMIT, "servo.torque_limit", OF torque_limit_nm, 0.01, 10000) \
    ROW(REAL, GW_FIELD_SERVO_TORQUE_RATE_LIMIT, "servo.torque_rate_limit", OF torque_rate_limit_nm_per_s, 0, 10000000) \
    ROW(COUNT, GW_FIELD_SERVO_ENCODER_COUNTS, "servo.encoder_counts", OF encoder_counts, 4, 1000000) \
    ROW(REAL, GW_FIELD_SERVO_DERIVATIVE_CUTOFF, "servo.derivative_cutoff", OF derivative_cutoff_hz, 0.1, 10000) \
    ROW(COUNT, GW_FIELD_SERVO_STALE_TICKS_MAX, "servo.stale_ticks_max", OF stale_ticks_max, 1, 100000)

/* All fields of gw_controller_config_t. */
#define GW_CONTROLLER_CONFIG_FIELDS(ROW, OF) \
    GW_CONTROLLER_FIELDS(ROW, OF) \
    GW_GEOMETRY_FIELDS(ROW, OF geometry.) \
    GW_INERTIA_FIELDS(ROW, OF base.) \
    GW_FRICTION_FIELDS(ROW, OF friction.) \
    GW_SENSOR_CHECK_FIELDS(ROW, OF sensor_check.) \
    GW_ESTIMATOR_FIELDS(ROW, OF estimator.) \
    GW_PRESLIDING_FIELDS(ROW, OF estimator.presliding.) \
    GW_GEAR_FIELDS(ROW, OF estimator.gear.) \
    GW_CONTACT_FIELDS(ROW, OF contact.) \
    GW_DETECTOR_FIELDS(ROW, OF detector.) \
    GW_CHANNELS_FIELDS(ROW, OF channels.) \
    GW_FOLLOWER_FIELDS(ROW, OF channels.follower.) \
    GW_ADMITTANCE_FIELDS(ROW, OF admittance.) \
    GW_ESCAPE_FIELDS(ROW, OF admittance.) \
    GW_TIP_FIELDS(ROW, OF admittance.tip.) \
    GW_REFERENCE_FIELDS(ROW, OF reference.) \
    GW_SUPERVISOR_FIELDS(ROW, OF supervisor.) \
    GW_IMU_FIELDS(ROW, OF imu.) \
    GW_MOTOR_FIELDS(ROW, OF estimator.motor.)

/* All there are. */
#define GW_CONFIG_FIELDS(ROW) \
    ROW(NONE, GW_FIELD_NONE, "none", none, 0, 0) \
    GW_CONTROLLER_CONFIG_FIELDS(ROW, controller.) \
    GW_SERVO_FIELDS(ROW, servo.)
/* cppcheck-suppress-end misra-c2012-20.7 */

#define GW_CONFIG_FIELD_OF_ROW(kind, field, name, member, minimum, maximum) field,

/* The fields, in the order of the table. */
typedef enum { GW_CONFIG_FIELDS(GW_CONFIG_FIELD_OF_ROW) GW_FIELD_COUNT } gw_config_field_t;

/* One row of the table. minimum and maximum are inclusive, in the unit that the field's comment gives. */
typedef struct {
    gw_real_t minimum;
    gw_real_t maximum;
} gw_config_limit_t;

/* The first field that a check refused; field is GW_FIELD_NONE if all are in range. index counts within an array.
 * Some rules relate several fields; value is then that of the field that is named, and minimum and maximum are the
 * range that the other fields leave for it. A slot that is taken twice has the empty range from 1 to 0. For
 * GW_FIELD_OUTLINE_CONVEX the range is 0 to 0, and the edge that starts at vertex index has a vertex on its right. */
typedef struct {
    gw_config_field_t field;
    uint32_t index;
    gw_real_t value;
    gw_real_t minimum;
    gw_real_t maximum;
} gw_config_error_t;

/* The row of a field; the row "none" for GW_FIELD_NONE and anything that is no field. */
GW_SMALL gw_config_limit_t gw_config_limit(gw_config_field_t field);
/* Its name, "none" likewise. The names take 2.1 kB of flash in programs that call this, and none in others if the
 * linker drops unused sections. */
const char *gw_config_name(gw_config_field_t field);

/* error->field = GW_FIELD_NONE: start of a check. error is not NULL here and below. */
GW_SMALL void gw_config_check_begin(gw_config_error_t *error);
/* Notes the field if value is outside its range (or NaN) and no field was noted before. */
GW_SMALL void gw_config_check_real(gw_config_error_t *error, gw_config_field_t field, gw_real_t value);
GW_SMALL void gw_config_check_count(gw_config_error_t *error, gw_config_field_t field, uint32_t value);
/* The same for an element of an array. */
GW_SMALL void gw_config_check_element(gw_config_error_t *error, gw_config_field_t field, uint32_t index,
                                      gw_real_t value);
/* Notes the field if value is outside [minimum, maximum]: for a rule that relates several fields. */
GW_SMALL void gw_config_check_relation(gw_config_error_t *error, gw_config_field_t field, uint32_t index,
                                       gw_real_t value, gw_real_t minimum, gw_real_t maximum);

#ifdef __cplusplus
}
#endif

#endif
