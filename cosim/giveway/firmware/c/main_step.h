/* The robot's millisecond: sensors in, one step of the controller, drives out.
 *
 * robot_start once, then robot_every_period from the timer that fires every ROBOT_PERIOD_US. What your board has to do
 * for it are the four functions at the end; self_test.c has them for a recording, as a pattern. */
#ifndef MAIN_STEP_H
#define MAIN_STEP_H

#include "giveway/gw_controller.h"
#include "robot_config.h"

/* Sensors in their own numbers, in the order of the wheels: robot_config.h says what a count is. */
typedef struct {
    int32_t torque_count[GW_WHEEL_COUNT];  /* of the torque sensors, or of the motors' currents */
    int32_t encoder_count[GW_WHEEL_COUNT]; /* motor side, ROBOT_ENCODER_COUNTS per turn of the wheel; may wrap */
    uint32_t counter;                      /* one more with every new sample; may wrap */
    bool present;                          /* there is a sample */
    /* Accelerometer and gyro; all zero if there are none. */
    gw_real_t specific_force_mps2[GW_IMU_AXES];
    gw_real_t yaw_rate_radps;
    uint32_t imu_counter;
    bool imu_present;
} robot_sensors_t;

/* What each drive is told. */
typedef struct {
    gw_real_t angle_rad[GW_WHEEL_COUNT]; /* of the wheel, in [-pi, pi): the drive takes the nearest turn */
    gw_real_t speed_radps[GW_WHEEL_COUNT];
    bool enable; /* false: no torque */
} robot_drives_t;

/* A fault of the sensors that lasts longer switches the drives off, until robot_start is called again. */
#define ROBOT_FAULT_TICKS_MAX 200U

/* False: the configuration was refused (robot_refused says which field), and the drives stay off. */
bool robot_start(void);
const char *robot_refused(void);
/* One period: reads the sensors, makes a step, writes the drives. */
void robot_every_period(void);
/* The same in its parts: sensors to the controller's units, one step, and what the drives get of it. */
void robot_input(const robot_sensors_t *sensors, gw_controller_input_t *input);
gw_status_t robot_step(const gw_controller_input_t *input, gw_controller_output_t *output);
void robot_drives(gw_status_t status, const gw_controller_output_t *output, robot_drives_t *drives);
/* Of the last period, for a log. */
gw_status_t robot_status(void);
const gw_controller_output_t *robot_output(void);

/* Yours. Each returns soon: together with a step they have to be done within the period. */
void board_read_sensors(robot_sensors_t *sensors);
/* Where the robot should be at path_ticks periods of its path, world frame; a robot that stands still leaves it. */
void board_plan(uint32_t path_ticks, gw_plan_t *plan);
void board_requests(bool *stop, bool *tare);
void board_write_drives(const robot_drives_t *drives);

#endif
