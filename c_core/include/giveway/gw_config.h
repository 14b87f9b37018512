/* Every configuration field: its name, and the inclusive range that init checks.
 *
 * The names are those of the FMU's parameters. gw_config_limit gives the row of a field; tests walk the same table.
 */
#ifndef GW_CONFIG_H
#define GW_CONFIG_H

#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum {
    GW_FIELD_NONE = 0,
    GW_FIELD_CONTROLLER_PERIOD,
    GW_FIELD_GEOMETRY_WHEEL_RADIUS,
    GW_FIELD_GEOMETRY_ROLLER_RADIUS,
    GW_FIELD_GEOMETRY_WHEEL_DISTANCE,
    GW_FIELD_GEOMETRY_WHEEL_SLOT,
    GW_FIELD_GEOMETRY_AZIMUTH,
    GW_FIELD_BASE_MASS,
    GW_FIELD_BASE_YAW_INERTIA,
    GW_FIELD_BASE_WHEEL_INERTIA,
    GW_FIELD_BASE_ROLLER_INERTIA,
    GW_FIELD_FRICTION_COULOMB_TORQUE,
    GW_FIELD_FRICTION_TANH_SLOPE,
    GW_FIELD_SENSOR_CHECK_TORQUE_LIMIT,
    GW_FIELD_SENSOR_CHECK_STALE_TICKS_MAX,
    GW_FIELD_SENSOR_CHECK_ENCODER_JUMP,
    GW_FIELD_SENSOR_CHECK_RECOVER_TICKS,
    GW_FIELD_ESTIMATOR_VELOCITY_SOURCE,
    GW_FIELD_ESTIMATOR_ACCELERATION_SOURCE,
    GW_FIELD_ESTIMATOR_TORQUE_NOISE,
    GW_FIELD_ESTIMATOR_RATE_CUTOFF,
    GW_FIELD_ESTIMATOR_DRIVETRAIN_STIFFNESS,
    GW_FIELD_ESTIMATOR_ENCODER_COUNTS,
    GW_FIELD_ESTIMATOR_AVERAGE_WINDOW,
    GW_FIELD_ESTIMATOR_REST_SPEED,
    GW_FIELD_ESTIMATOR_CREEP_SPEED,
    GW_FIELD_ESTIMATOR_REST_TICKS,
    GW_FIELD_ESTIMATOR_TARE_TICKS,
    GW_FIELD_ESTIMATOR_RETARE_TICKS,
    GW_FIELD_ESTIMATOR_TARE_VARIATION,
    GW_FIELD_ESTIMATOR_FRICTION_MODEL,
    GW_FIELD_ESTIMATOR_PRESLIDING_STIFFNESS,
    GW_FIELD_ESTIMATOR_PRESLIDING_DAMPING,
    GW_FIELD_ESTIMATOR_STRIBECK_SPEED,
    GW_FIELD_ESTIMATOR_ELASTIC_FRACTION,
    GW_FIELD_CONTACT_MINIMUM_FORCE,
    GW_FIELD_OUTLINE_COUNT,
    GW_FIELD_OUTLINE_X,
    GW_FIELD_OUTLINE_Y,
    GW_FIELD_OUTLINE_CONVEX,
    GW_FIELD_DETECTOR_KIND,
    GW_FIELD_DETECTOR_FORCE_THRESHOLD,
    GW_FIELD_DETECTOR_IMPULSE_THRESHOLD,
    GW_FIELD_DETECTOR_LEAK_REST,
    GW_FIELD_DETECTOR_LEAK_CREEP,
    GW_FIELD_DETECTOR_LEAK_MOTION,
    GW_FIELD_DETECTOR_RELEASE_FORCE,
    GW_FIELD_DETECTOR_BLANKING_TICKS,
    GW_FIELD_ADMITTANCE_KIND,
    GW_FIELD_ADMITTANCE_MASS,
    GW_FIELD_ADMITTANCE_DAMPING,
    GW_FIELD_ADMITTANCE_ESCAPE_IMPULSE,
    GW_FIELD_ADMITTANCE_SPEED_LIMIT,
    GW_FIELD_ADMITTANCE_ACCELERATION_LIMIT,
    GW_FIELD_ADMITTANCE_FINISH_SPEED,
    GW_FIELD_REFERENCE_FOLLOW_GAIN,
    GW_FIELD_REFERENCE_SPEED_LIMIT,
    GW_FIELD_REFERENCE_ACCELERATION_LIMIT,
    GW_FIELD_REFERENCE_YAW_RATE_LIMIT,
    GW_FIELD_REFERENCE_YAW_ACCELERATION_LIMIT,
    GW_FIELD_REFERENCE_REJOIN_SPEED,
    GW_FIELD_REFERENCE_FINISH_SPEED,
    GW_FIELD_SUPERVISOR_SETTLED_SPEED,
    GW_FIELD_SUPERVISOR_SETTLED_TICKS,
    GW_FIELD_SUPERVISOR_AFTER_SETTLED,
    GW_FIELD_SUPERVISOR_REJOIN_DISTANCE,
    GW_FIELD_SUPERVISOR_REJOIN_ANGLE,
    GW_FIELD_SERVO_PERIOD,
    GW_FIELD_SERVO_KP,
    GW_FIELD_SERVO_KD,
    GW_FIELD_SERVO_TORQUE_LIMIT,
    GW_FIELD_SERVO_TORQUE_RATE_LIMIT,
    GW_FIELD_SERVO_ENCODER_COUNTS,
    GW_FIELD_SERVO_DERIVATIVE_CUTOFF,
    GW_FIELD_SERVO_STALE_TICKS_MAX,
    GW_FIELD_COUNT
} gw_config_field_t;

/* One row of the table. minimum and maximum are inclusive, in the unit that the field's comment gives. */
typedef struct {
    gw_real_t minimum;
    gw_real_t maximum;
} gw_config_limit_t;

/* The first field that a check refused; field is GW_FIELD_NONE if all are in range. index counts within an array.
 * Where a rule relates several fields, value is the value of the one that is named, and minimum and maximum are
 * what the others leave it; for GW_FIELD_OUTLINE_CONVEX they are 0 and index is the edge (from that vertex) with a vertex on its right; for a
 * slot that is taken twice the range is empty (1 to 0). */
typedef struct {
    gw_config_field_t field;
    uint32_t index;
    gw_real_t value;
    gw_real_t minimum;
    gw_real_t maximum;
} gw_config_error_t;

/* The row of a field; the row "none" for GW_FIELD_NONE and anything that is no field. */
gw_config_limit_t gw_config_limit(gw_config_field_t field);
/* Its name, "none" likewise. The names take 2.3 kB of flash, which a linker that drops unused sections gives back to
 * who does not call this. */
const char *gw_config_name(gw_config_field_t field);

/* error->field = GW_FIELD_NONE: start of a check. error is not NULL here and below. */
void gw_config_check_begin(gw_config_error_t *error);
/* Notes the field if value is outside its range (or NaN) and no field was noted before. */
void gw_config_check_real(gw_config_error_t *error, gw_config_field_t field, gw_real_t value);
void gw_config_check_count(gw_config_error_t *error, gw_config_field_t field, uint32_t value);
/* The same for an element of an array. */
void gw_config_check_element(gw_config_error_t *error, gw_config_field_t field, uint32_t index, gw_real_t value);
/* Notes the field if value is outside [minimum, maximum]: for a rule that relates several fields. */
void gw_config_check_relation(gw_config_error_t *error, gw_config_field_t field, uint32_t index, gw_real_t value,
                              gw_real_t minimum, gw_real_t maximum);

#ifdef __cplusplus
}
#endif

#endif
