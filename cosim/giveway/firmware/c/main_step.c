#include "main_step.h"

static gw_controller_t controller;
static gw_controller_output_t last_output;
static gw_status_t last_status = GW_STATUS_NOT_INITIALISED;
static gw_config_error_t refused;
static uint32_t fault_ticks;
static bool switched_off = true;

bool robot_start(void)
{
    gw_controller_safe_output(&last_output);
    last_status = gw_controller_init(&controller, &robot_config, &refused);
    fault_ticks = 0U;
    switched_off = (last_status != GW_STATUS_OK);
    return !switched_off;
}

const char *robot_refused(void)
{
    return gw_config_name(refused.field);
}

/* Torque that the drivetrain delivers to its wheel, N m. If a wheel turns or pushes the other way round on your robot,
 * change the signs of its torque and of its encoder here, both of them. */
static gw_real_t torque_nm(int32_t count)
{
#if (ROBOT_SENSES_CURRENT == 1)
    const gw_real_t current_a = (gw_real_t)count * ROBOT_AMPERE_PER_COUNT;
    return current_a * ROBOT_TORQUE_NM_PER_AMPERE;
#else
    return (gw_real_t)count * ROBOT_TORQUE_NM_PER_COUNT;
#endif
}

void robot_input(const robot_sensors_t *sensors, gw_controller_input_t *input)
{
    static const gw_controller_input_t standing = {0};
    *input = standing;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        input->sensor.torque_nm[i] = torque_nm(sensors->torque_count[i]);
        /* The controller takes counts, so that a robot that drives for days loses nothing. The angle of the motor is
         * count * 2 pi / ROBOT_ENCODER_COUNTS. */
        input->sensor.encoder_count[i] = sensors->encoder_count[i];
    }
    input->sensor.counter = sensors->counter;
    input->sensor.present = sensors->present;
    for (uint32_t i = 0U; i < GW_IMU_AXES; i++) {
        input->imu.specific_force_mps2[i] = sensors->specific_force_mps2[i];
    }
    input->imu.yaw_rate_radps = sensors->yaw_rate_radps;
    input->imu.counter = sensors->imu_counter;
    input->imu.present = sensors->imu_present;
}

gw_status_t robot_step(const gw_controller_input_t *input, gw_controller_output_t *output)
{
    return gw_controller_step(&controller, input, output);
}

/* True for what the wheels are held still for: the sensors cannot be used. */
static bool is_fault(gw_status_t status)
{
    switch (status) {
    case GW_STATUS_SENSOR_MISSING:
    case GW_STATUS_SENSOR_STALE:
    case GW_STATUS_SENSOR_NONFINITE:
    case GW_STATUS_SENSOR_SATURATED:
    case GW_STATUS_ENCODER_JUMP:
    case GW_STATUS_SENSOR_RECOVERING:
    case GW_STATUS_INPUT_INVALID:
        return true;
    default:
        return false;
    }
}

void robot_drives(gw_status_t status, const gw_controller_output_t *output, robot_drives_t *drives)
{
    /* The output is safe in every case: with bad sensors the last angles at zero speed, so that the wheels hold. Who
     * cannot feel for long should not hold for ever: then the drives are switched off. A refused plan
     * (GW_STATUS_PLAN_INVALID) slows the robot down, a refused tare (GW_STATUS_TARE_REFUSED) changes nothing: both are
     * worth a line in a log. */
    fault_ticks = is_fault(status) ? (fault_ticks + 1U) : 0U;
    if ((fault_ticks > ROBOT_FAULT_TICKS_MAX) || (status == GW_STATUS_NOT_INITIALISED) ||
        (status == GW_STATUS_NULL_POINTER)) {
        switched_off = true;
    }
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        drives->angle_rad[i] = output->command.angle_rad[i];
        drives->speed_radps[i] = switched_off ? (gw_real_t)0 : output->command.speed_radps[i];
    }
    drives->enable = output->enable && !switched_off;
}

void robot_every_period(void)
{
    robot_sensors_t sensors = {0};
    gw_controller_input_t input;
    robot_drives_t drives;

    board_read_sensors(&sensors);
    robot_input(&sensors, &input);
    board_plan(last_output.path_ticks, &input.plan);
    board_requests(&input.stop_request, &input.tare_request);
    last_status = robot_step(&input, &last_output);
    robot_drives(last_status, &last_output, &drives);
    board_write_drives(&drives);
}

gw_status_t robot_status(void)
{
    return last_status;
}

const gw_controller_output_t *robot_output(void)
{
    return &last_output;
}
