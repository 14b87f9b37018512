#include "giveway/gw_config.h"

#include "giveway/gw_math.h"

/* Both tables are in the order of gw_config_field_t. They are apart so that a program that prints no names has none. */

GW_SELDOM const gw_config_limit_t *gw_config_limit(gw_config_field_t field)
{
    static const gw_config_limit_t limits[GW_FIELD_COUNT] = {
        {(gw_real_t)0.0, (gw_real_t)0.0}, /* none */
        {(gw_real_t)0.0001, (gw_real_t)0.1}, /* controller.period */
        {(gw_real_t)0.005, (gw_real_t)1.0}, /* geometry.wheel_radius */
        {(gw_real_t)0.001, (gw_real_t)0.5}, /* geometry.roller_radius */
        {(gw_real_t)0.01, (gw_real_t)5.0}, /* geometry.wheel_distance */
        {(gw_real_t)0.0, (gw_real_t)2.0}, /* geometry.wheel_slot */
        {(gw_real_t)-3.2, (gw_real_t)3.2}, /* geometry.azimuth */
        {(gw_real_t)0.1, (gw_real_t)2000.0}, /* base.mass */
        {(gw_real_t)0.0001, (gw_real_t)10000.0}, /* base.yaw_inertia */
        {(gw_real_t)0.0, (gw_real_t)10.0}, /* base.wheel_inertia */
        {(gw_real_t)0.0, (gw_real_t)1.0}, /* base.roller_inertia */
        {(gw_real_t)0.0, (gw_real_t)100.0}, /* friction.coulomb_torque */
        {(gw_real_t)0.0, (gw_real_t)1000.0}, /* friction.tanh_slope */
        {(gw_real_t)0.1, (gw_real_t)10000.0}, /* sensor_check.torque_limit */
        {(gw_real_t)1.0, (gw_real_t)1000.0}, /* sensor_check.stale_ticks_max */
        {(gw_real_t)1.0, (gw_real_t)1000000.0}, /* sensor_check.encoder_jump */
        {(gw_real_t)1.0, (gw_real_t)100000.0}, /* sensor_check.recover_ticks */
        {(gw_real_t)0.0, (gw_real_t)1.0}, /* estimator.velocity_source */
        {(gw_real_t)0.0, (gw_real_t)2.0}, /* estimator.acceleration_source */
        {(gw_real_t)0.0, (gw_real_t)100.0}, /* estimator.torque_noise */
        {(gw_real_t)0.1, (gw_real_t)10000.0}, /* estimator.rate_cutoff */
        {(gw_real_t)0.0, (gw_real_t)10000000.0}, /* estimator.drivetrain_stiffness */
        {(gw_real_t)4.0, (gw_real_t)1000000.0}, /* estimator.encoder_counts */
        {(gw_real_t)1.0, (gw_real_t)1024.0}, /* estimator.average_window */
        {(gw_real_t)0.0, (gw_real_t)1.0}, /* estimator.rest_speed */
        {(gw_real_t)0.0, (gw_real_t)1.0}, /* estimator.creep_speed */
        {(gw_real_t)1.0, (gw_real_t)100000.0}, /* estimator.rest_ticks */
        {(gw_real_t)0.0, (gw_real_t)100000.0}, /* estimator.tare_ticks */
        {(gw_real_t)1.0, (gw_real_t)100000.0}, /* estimator.retare_ticks */
        {(gw_real_t)0.0, (gw_real_t)100.0}, /* estimator.tare_variation */
        {(gw_real_t)0.0, (gw_real_t)1.0}, /* estimator.friction_model */
        {(gw_real_t)10.0, (gw_real_t)10000000.0}, /* estimator.presliding_stiffness */
        {(gw_real_t)0.0, (gw_real_t)100000.0}, /* estimator.presliding_damping */
        {(gw_real_t)0.000001, (gw_real_t)1.0}, /* estimator.stribeck_speed */
        {(gw_real_t)0.0, (gw_real_t)0.99}, /* estimator.elastic_fraction */
        {(gw_real_t)0.001, (gw_real_t)1000.0}, /* contact.minimum_force */
        {(gw_real_t)3.0, (gw_real_t)16.0}, /* outline.count */
        {(gw_real_t)-10.0, (gw_real_t)10.0}, /* outline.x */
        {(gw_real_t)-10.0, (gw_real_t)10.0}, /* outline.y */
        {(gw_real_t)0.0, (gw_real_t)0.0}, /* outline */
        {(gw_real_t)0.0, (gw_real_t)1.0}, /* detector.kind */
        {(gw_real_t)0.01, (gw_real_t)10000.0}, /* detector.force_threshold */
        {(gw_real_t)0.001, (gw_real_t)1000.0}, /* detector.impulse_threshold */
        {(gw_real_t)0.0, (gw_real_t)1000.0}, /* detector.leak_rest */
        {(gw_real_t)0.0, (gw_real_t)1000.0}, /* detector.leak_creep */
        {(gw_real_t)0.0, (gw_real_t)1000.0}, /* detector.leak_motion */
        {(gw_real_t)0.0, (gw_real_t)10000.0}, /* detector.release_force */
        {(gw_real_t)0.0, (gw_real_t)100000.0}, /* detector.blanking_ticks */
        {(gw_real_t)0.0, (gw_real_t)1.0}, /* admittance.kind */
        {(gw_real_t)0.01, (gw_real_t)10000.0}, /* admittance.mass */
        {(gw_real_t)0.01, (gw_real_t)10000.0}, /* admittance.damping */
        {(gw_real_t)0.0, (gw_real_t)1000.0}, /* admittance.escape_impulse */
        {(gw_real_t)0.001, (gw_real_t)10.0}, /* admittance.speed_limit */
        {(gw_real_t)0.001, (gw_real_t)1000.0}, /* admittance.acceleration_limit */
        {(gw_real_t)0.0, (gw_real_t)1.0}, /* admittance.finish_speed */
        {(gw_real_t)0.0, (gw_real_t)100.0}, /* reference.follow_gain */
        {(gw_real_t)0.001, (gw_real_t)10.0}, /* reference.speed_limit */
        {(gw_real_t)0.001, (gw_real_t)1000.0}, /* reference.acceleration_limit */
        {(gw_real_t)0.001, (gw_real_t)100.0}, /* reference.yaw_rate_limit */
        {(gw_real_t)0.001, (gw_real_t)10000.0}, /* reference.yaw_acceleration_limit */
        {(gw_real_t)0.001, (gw_real_t)10.0}, /* reference.rejoin_speed */
        {(gw_real_t)0.0, (gw_real_t)1.0}, /* reference.finish_speed */
        {(gw_real_t)0.000001, (gw_real_t)1.0}, /* supervisor.settled_speed */
        {(gw_real_t)1.0, (gw_real_t)100000.0}, /* supervisor.settled_ticks */
        {(gw_real_t)0.0, (gw_real_t)1.0}, /* supervisor.after_settled */
        {(gw_real_t)0.00001, (gw_real_t)1.0}, /* supervisor.rejoin_distance */
        {(gw_real_t)0.0001, (gw_real_t)1.0}, /* supervisor.rejoin_angle */
        {(gw_real_t)0.00001, (gw_real_t)0.1}, /* servo.period */
        {(gw_real_t)0.0, (gw_real_t)1000000.0}, /* servo.kp */
        {(gw_real_t)0.0, (gw_real_t)100000.0}, /* servo.kd */
        {(gw_real_t)0.01, (gw_real_t)10000.0}, /* servo.torque_limit */
        {(gw_real_t)0.0, (gw_real_t)10000000.0}, /* servo.torque_rate_limit */
        {(gw_real_t)4.0, (gw_real_t)1000000.0}, /* servo.encoder_counts */
        {(gw_real_t)0.1, (gw_real_t)10000.0}, /* servo.derivative_cutoff */
        {(gw_real_t)1.0, (gw_real_t)100000.0}, /* servo.stale_ticks_max */
    };
    const uint32_t row = (uint32_t)field;
    return &limits[(row < (uint32_t)GW_FIELD_COUNT) ? row : 0U];
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

GW_SELDOM void gw_config_check_real(gw_config_error_t *error, gw_config_field_t field, uint32_t index, gw_real_t value)
{
    const gw_config_limit_t *const limit = gw_config_limit(field);
    gw_config_check_relation(error, field, index, value, limit->minimum, limit->maximum);
}

GW_SELDOM void gw_config_check_count(gw_config_error_t *error, gw_config_field_t field, uint32_t index, uint32_t value)
{
    /* No bound of a count exceeds 2^24, so rounding to the real type cannot bring one back into range. */
    gw_config_check_real(error, field, index, (gw_real_t)value);
}
