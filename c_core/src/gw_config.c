#include "giveway/gw_config.h"

#include "giveway/gw_math.h"

/* Both tables are in the order of gw_config_field_t. They are apart so that a program that prints no names has none. */

/* The bounds that occur, so that a row of the table is two places among them: a quarter of the bytes of two floats where
 * enumerations are short, as on Arm. */
typedef enum {
    AT_MINUS_10,
    AT_MINUS_3_2,
    AT_0,
    AT_0_000001,
    AT_0_00001,
    AT_0_0001,
    AT_0_001,
    AT_0_005,
    AT_0_01,
    AT_0_1,
    AT_0_5,
    AT_0_99,
    AT_1,
    AT_2,
    AT_3,
    AT_3_2,
    AT_4,
    AT_5,
    AT_10,
    AT_16,
    AT_100,
    AT_1000,
    AT_1024,
    AT_2000,
    AT_10000,
    AT_100000,
    AT_1000000,
    AT_10000000,
    BOUND_COUNT
} bound_t;

typedef struct {
    bound_t minimum;
    bound_t maximum;
} row_t;

GW_SELDOM gw_config_limit_t gw_config_limit(gw_config_field_t field)
{
    static const gw_real_t bound[BOUND_COUNT] = {
        [AT_MINUS_10] = (gw_real_t)-10.0,
        [AT_MINUS_3_2] = (gw_real_t)-3.2,
        [AT_0] = (gw_real_t)0.0,
        [AT_0_000001] = (gw_real_t)0.000001,
        [AT_0_00001] = (gw_real_t)0.00001,
        [AT_0_0001] = (gw_real_t)0.0001,
        [AT_0_001] = (gw_real_t)0.001,
        [AT_0_005] = (gw_real_t)0.005,
        [AT_0_01] = (gw_real_t)0.01,
        [AT_0_1] = (gw_real_t)0.1,
        [AT_0_5] = (gw_real_t)0.5,
        [AT_0_99] = (gw_real_t)0.99,
        [AT_1] = (gw_real_t)1.0,
        [AT_2] = (gw_real_t)2.0,
        [AT_3] = (gw_real_t)3.0,
        [AT_3_2] = (gw_real_t)3.2,
        [AT_4] = (gw_real_t)4.0,
        [AT_5] = (gw_real_t)5.0,
        [AT_10] = (gw_real_t)10.0,
        [AT_16] = (gw_real_t)16.0,
        [AT_100] = (gw_real_t)100.0,
        [AT_1000] = (gw_real_t)1000.0,
        [AT_1024] = (gw_real_t)1024.0,
        [AT_2000] = (gw_real_t)2000.0,
        [AT_10000] = (gw_real_t)10000.0,
        [AT_100000] = (gw_real_t)100000.0,
        [AT_1000000] = (gw_real_t)1000000.0,
        [AT_10000000] = (gw_real_t)10000000.0,
    };
    static const row_t rows[GW_FIELD_COUNT] = {
        {AT_0, AT_0}, /* none */
        {AT_0_0001, AT_0_1}, /* controller.period */
        {AT_0_005, AT_1}, /* geometry.wheel_radius */
        {AT_0_001, AT_0_5}, /* geometry.roller_radius */
        {AT_0_01, AT_5}, /* geometry.wheel_distance */
        {AT_0, AT_2}, /* geometry.wheel_slot */
        {AT_MINUS_3_2, AT_3_2}, /* geometry.azimuth */
        {AT_0_1, AT_2000}, /* base.mass */
        {AT_0_0001, AT_10000}, /* base.yaw_inertia */
        {AT_0, AT_10}, /* base.wheel_inertia */
        {AT_0, AT_1}, /* base.roller_inertia */
        {AT_0, AT_100}, /* friction.coulomb_torque */
        {AT_0, AT_1000}, /* friction.tanh_slope */
        {AT_0_1, AT_10000}, /* sensor_check.torque_limit */
        {AT_1, AT_1000}, /* sensor_check.stale_ticks_max */
        {AT_1, AT_1000000}, /* sensor_check.encoder_jump */
        {AT_1, AT_100000}, /* sensor_check.recover_ticks */
        {AT_0, AT_1}, /* estimator.velocity_source */
        {AT_0, AT_2}, /* estimator.acceleration_source */
        {AT_0, AT_100}, /* estimator.torque_noise */
        {AT_0_1, AT_10000}, /* estimator.rate_cutoff */
        {AT_0, AT_10000000}, /* estimator.drivetrain_stiffness */
        {AT_4, AT_1000000}, /* estimator.encoder_counts */
        {AT_1, AT_1024}, /* estimator.average_window */
        {AT_0, AT_1}, /* estimator.rest_speed */
        {AT_0, AT_1}, /* estimator.creep_speed */
        {AT_1, AT_100000}, /* estimator.rest_ticks */
        {AT_0, AT_100000}, /* estimator.tare_ticks */
        {AT_1, AT_100000}, /* estimator.retare_ticks */
        {AT_0, AT_100}, /* estimator.tare_variation */
        {AT_0, AT_1}, /* estimator.friction_model */
        {AT_10, AT_10000000}, /* estimator.presliding_stiffness */
        {AT_0, AT_100000}, /* estimator.presliding_damping */
        {AT_0_000001, AT_1}, /* estimator.stribeck_speed */
        {AT_0, AT_0_99}, /* estimator.elastic_fraction */
        {AT_0_001, AT_1000}, /* contact.minimum_force */
        {AT_3, AT_16}, /* outline.count */
        {AT_MINUS_10, AT_10}, /* outline.x */
        {AT_MINUS_10, AT_10}, /* outline.y */
        {AT_0, AT_0}, /* outline */
        {AT_0, AT_1}, /* detector.kind */
        {AT_0_01, AT_10000}, /* detector.force_threshold */
        {AT_0_001, AT_1000}, /* detector.impulse_threshold */
        {AT_0, AT_1000}, /* detector.leak_rest */
        {AT_0, AT_1000}, /* detector.leak_creep */
        {AT_0, AT_1000}, /* detector.leak_motion */
        {AT_0, AT_10000}, /* detector.release_force */
        {AT_0, AT_100000}, /* detector.blanking_ticks */
        {AT_0, AT_1}, /* admittance.kind */
        {AT_0_01, AT_10000}, /* admittance.mass */
        {AT_0_01, AT_10000}, /* admittance.damping */
        {AT_0, AT_1000}, /* admittance.escape_impulse */
        {AT_0_001, AT_10}, /* admittance.speed_limit */
        {AT_0_001, AT_1000}, /* admittance.acceleration_limit */
        {AT_0, AT_1}, /* admittance.finish_speed */
        {AT_0, AT_100}, /* reference.follow_gain */
        {AT_0_001, AT_10}, /* reference.speed_limit */
        {AT_0_001, AT_1000}, /* reference.acceleration_limit */
        {AT_0_001, AT_100}, /* reference.yaw_rate_limit */
        {AT_0_001, AT_10000}, /* reference.yaw_acceleration_limit */
        {AT_0_001, AT_10}, /* reference.rejoin_speed */
        {AT_0, AT_1}, /* reference.finish_speed */
        {AT_0_000001, AT_1}, /* supervisor.settled_speed */
        {AT_1, AT_100000}, /* supervisor.settled_ticks */
        {AT_0, AT_1}, /* supervisor.after_settled */
        {AT_0_00001, AT_1}, /* supervisor.rejoin_distance */
        {AT_0_0001, AT_1}, /* supervisor.rejoin_angle */
        {AT_0_00001, AT_0_1}, /* servo.period */
        {AT_0, AT_1000000}, /* servo.kp */
        {AT_0, AT_100000}, /* servo.kd */
        {AT_0_01, AT_10000}, /* servo.torque_limit */
        {AT_0, AT_10000000}, /* servo.torque_rate_limit */
        {AT_4, AT_1000000}, /* servo.encoder_counts */
        {AT_0_1, AT_10000}, /* servo.derivative_cutoff */
        {AT_1, AT_100000}, /* servo.stale_ticks_max */
    };
    const uint32_t index = (uint32_t)field;
    const row_t row = rows[(index < (uint32_t)GW_FIELD_COUNT) ? index : 0U];
    const gw_config_limit_t limit = {bound[row.minimum], bound[row.maximum]};
    return limit;
}

GW_SELDOM const char *gw_config_name(gw_config_field_t field)
{
    static const char *const names[GW_FIELD_COUNT] = {
        "none",
        "controller.period",
        "geometry.wheel_radius",
        "geometry.roller_radius",
        "geometry.wheel_distance",
        "geometry.wheel_slot",
        "geometry.azimuth",
        "base.mass",
        "base.yaw_inertia",
        "base.wheel_inertia",
        "base.roller_inertia",
        "friction.coulomb_torque",
        "friction.tanh_slope",
        "sensor_check.torque_limit",
        "sensor_check.stale_ticks_max",
        "sensor_check.encoder_jump",
        "sensor_check.recover_ticks",
        "estimator.velocity_source",
        "estimator.acceleration_source",
        "estimator.torque_noise",
        "estimator.rate_cutoff",
        "estimator.drivetrain_stiffness",
        "estimator.encoder_counts",
        "estimator.average_window",
        "estimator.rest_speed",
        "estimator.creep_speed",
        "estimator.rest_ticks",
        "estimator.tare_ticks",
        "estimator.retare_ticks",
        "estimator.tare_variation",
        "estimator.friction_model",
        "estimator.presliding_stiffness",
        "estimator.presliding_damping",
        "estimator.stribeck_speed",
        "estimator.elastic_fraction",
        "contact.minimum_force",
        "outline.count",
        "outline.x",
        "outline.y",
        "outline (counter-clockwise, strictly convex)",
        "detector.kind",
        "detector.force_threshold",
        "detector.impulse_threshold",
        "detector.leak_rest",
        "detector.leak_creep",
        "detector.leak_motion",
        "detector.release_force",
        "detector.blanking_ticks",
        "admittance.kind",
        "admittance.mass",
        "admittance.damping",
        "admittance.escape_impulse",
        "admittance.speed_limit",
        "admittance.acceleration_limit",
        "admittance.finish_speed",
        "reference.follow_gain",
        "reference.speed_limit",
        "reference.acceleration_limit",
        "reference.yaw_rate_limit",
        "reference.yaw_acceleration_limit",
        "reference.rejoin_speed",
        "reference.finish_speed",
        "supervisor.settled_speed",
        "supervisor.settled_ticks",
        "supervisor.after_settled",
        "supervisor.rejoin_distance",
        "supervisor.rejoin_angle",
        "servo.period",
        "servo.kp",
        "servo.kd",
        "servo.torque_limit",
        "servo.torque_rate_limit",
        "servo.encoder_counts",
        "servo.derivative_cutoff",
        "servo.stale_ticks_max",
    };
    const uint32_t row = (uint32_t)field;
    return names[(row < (uint32_t)GW_FIELD_COUNT) ? row : 0U];
}

GW_SELDOM void gw_config_check_begin(gw_config_error_t *error)
{
    error->field = GW_FIELD_NONE;
    error->index = 0U;
    error->value = GW_ZERO;
    error->minimum = GW_ZERO;
    error->maximum = GW_ZERO;
}

GW_SELDOM void gw_config_check_relation(gw_config_error_t *error, gw_config_field_t field, uint32_t index, gw_real_t value,
                              gw_real_t minimum, gw_real_t maximum)
{
    if ((error->field == GW_FIELD_NONE) && (!gw_in_range(value, minimum, maximum))) {
        error->field = field;
        error->index = index;
        error->value = value;
        error->minimum = minimum;
        error->maximum = maximum;
    }
}

GW_SELDOM void gw_config_check_element(gw_config_error_t *error, gw_config_field_t field, uint32_t index, gw_real_t value)
{
    const gw_config_limit_t limit = gw_config_limit(field);
    gw_config_check_relation(error, field, index, value, limit.minimum, limit.maximum);
}

GW_SELDOM void gw_config_check_real(gw_config_error_t *error, gw_config_field_t field, gw_real_t value)
{
    gw_config_check_element(error, field, 0U, value);
}

GW_SELDOM void gw_config_check_count(gw_config_error_t *error, gw_config_field_t field, uint32_t value)
{
    /* No bound of a count exceeds 2^24, so rounding to the real type cannot bring one back into range. */
    gw_config_check_element(error, field, 0U, (gw_real_t)value);
}
