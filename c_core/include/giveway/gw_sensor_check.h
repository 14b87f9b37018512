/* Refuses sensor samples that must not move the robot.
 *
 * Stale means that the sample counter stopped; equal values in a row are legal. After any fault the sensors must be
 * good for recover_ticks ticks before they count again.
 *
 * Life cycle: gw_sensor_check_init, gw_sensor_check_step per tick. All members are private.
 */
#ifndef GW_SENSOR_CHECK_H
#define GW_SENSOR_CHECK_H

#include "giveway/gw_config.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/* One sensor sample, as the bus delivers it. Any value is legal here. */
typedef struct {
    gw_real_t torque_nm[GW_WHEEL_COUNT];
    /* Motor side, as counts at the wheel axle; wraps. */
    int32_t encoder_count[GW_WHEEL_COUNT];
    /* Advances with every sample; wraps. */
    uint32_t counter;
    /* False: there is no sample. */
    bool present;
} gw_sensor_sample_t;

typedef struct {
    /* Torque magnitude from which the sensor counts as saturated, N m, [0.1, 10000]. */
    gw_real_t torque_limit_nm;
    /* Ticks without a new sample after which the sensors are stale, [1, 1000]. */
    uint32_t stale_ticks_max;
    /* Most counts that a wheel can turn in one tick, [1, 1000000]. */
    uint32_t encoder_jump_counts;
    /* Good ticks after a fault before the sensors count again, [1, 100000]. */
    uint32_t recover_ticks;
} gw_sensor_check_config_t;

typedef struct {
    gw_sensor_check_config_t config;
    int32_t last_count[GW_WHEEL_COUNT];
    uint32_t last_counter;
    uint32_t age_ticks; /* ticks since the counter advanced */
    uint32_t recover_remaining;
    bool counter_known;
    bool encoder_known;
    bool was_good;
    bool initialised;
} gw_sensor_check_t;

/* The values of Trikey, the paper's robot. Pointers not NULL in these two. */
void gw_sensor_check_config_trikey(gw_sensor_check_config_t *config);
GW_SMALL void gw_sensor_check_config_check(const gw_sensor_check_config_t *config, gw_config_error_t *error);
GW_SMALL gw_status_t gw_sensor_check_init(gw_sensor_check_t *check, const gw_sensor_check_config_t *config);
bool gw_sensor_check_invariant_holds(const gw_sensor_check_t *check);
/* One tick: GW_STATUS_OK, or the fault. Faults in order: missing, stale, non-finite, saturated, encoder jump. */
gw_status_t gw_sensor_check_step(gw_sensor_check_t *check, const gw_sensor_sample_t *sample);

#ifdef __cplusplus
}
#endif

#endif
