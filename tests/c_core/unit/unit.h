/* The harness of the unit tests: counts tests, prints failures, ends with "N passed, N failed".
 *
 * It needs only a printf, so that the same tests run on a PC and on the microcontroller.
 */
#ifndef UNIT_H
#define UNIT_H

#include "giveway/giveway.h"

typedef void (*unit_test_t)(void);

/* A constant of the real type. */
#define R(x) ((gw_real_t)(x))
#define UNIT_COUNT_OF(table) ((uint32_t)(sizeof(table) / sizeof((table)[0])))

/* A macro, because it has to know its place. */
#define CHECK(condition) unit_check((condition), #condition, __FILE__, __LINE__)
#define CHECK_NEAR(actual, expected, tolerance) \
    unit_check_near((actual), (expected), (tolerance), #actual, __FILE__, __LINE__)
#define CHECK_STATUS(actual, expected) \
    unit_check_equal((int32_t)(actual), (int32_t)(expected), #actual, __FILE__, __LINE__)

/* Relative tolerance of a quantity computed with about twenty roundings: 4500 ulp in double and 84 ulp in float. To be
 * multiplied by the magnitude of the largest term. */
#if (GW_REAL_DOUBLE == 1)
#define ROUNDING ((gw_real_t)1e-12)
#define ULP DBL_EPSILON
#else
#define ROUNDING ((gw_real_t)1e-5)
#define ULP FLT_EPSILON
#endif

/* Runs a test; it fails if a check in it fails. */
void unit_run(const char *name, unit_test_t test);
/* Names the row of a table that the next checks are about. */
void unit_row(uint32_t row);
/* Prints the closing line; true if nothing failed. */
bool unit_close(void);

void unit_check(bool holds, const char *text, const char *file, int32_t line);
void unit_check_near(gw_real_t actual, gw_real_t expected, gw_real_t tolerance, const char *text, const char *file,
                     int32_t line);
void unit_check_equal(int32_t actual, int32_t expected, const char *text, const char *file, int32_t line);

/* Values that no constant expression gives. */
gw_real_t unit_nan(void);
gw_real_t unit_infinity(void);
/* The next larger and the next smaller number of the real type; x finite. */
gw_real_t unit_above(gw_real_t x);
gw_real_t unit_below(gw_real_t x);

/* The suites, one per module. */
void suite_admittance(void);
void suite_balance(void);
void suite_channels(void);
void suite_channels_use(void);
void suite_config(void);
void suite_contact(void);
void suite_controller(void);
void suite_controller_faults(void);
void suite_detector(void);
void suite_estimator(void);
void suite_fast_channel(void);
void suite_follower(void);
void suite_friction(void);
void suite_gear(void);
void suite_imu(void);
void suite_imu_use(void);
void suite_init(void);
void suite_joint(void);
void suite_kinematics(void);
void suite_lowpass(void);
void suite_math(void);
void suite_model_covariance(void);
void suite_motor(void);
void suite_moving_average(void);
void suite_nominal(void);
void suite_planar_covariance(void);
void suite_presliding(void);
void suite_rate_filter(void);
void suite_reference(void);
void suite_sensor_check(void);
void suite_servo(void);
void suite_slip(void);
void suite_ripple(void);
void suite_slow_channel(void);
void suite_sum(void);
void suite_supervisor(void);
void suite_tare(void);
void suite_tip(void);
void suite_wrench(void);

#endif
