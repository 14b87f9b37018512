#include "parts.h"

static gw_motor_t motor;
static gw_motor_config_t config;
static gw_rate_filter_constants_t constants;

static void part_init(void)
{
    draw_motor_config(&config);
    draw_rate_constants(&constants);
    gw_motor_init(
        &motor, &config, &constants,
        draw_count(lowest_count(GW_FIELD_ESTIMATOR_ENCODER_COUNTS), highest_count(GW_FIELD_ESTIMATOR_ENCODER_COUNTS)));
    hold_motor(&motor);
    (void)gw_motor_is_known(&motor);
    gw_motor_config_none(&config);
    hold_motor_config(&config);
}

static void part_step(void)
{
    const int32_t counts[GW_WHEEL_COUNT] = {any_int, any_int, any_int};
    gw_wheels_t torque_nm;
    gw_joint_command_t command;
    gw_real_t counted;
    draw_motor(&motor);
    draw_wheels(&torque_nm, GW_TORQUE_MAX);
    draw_joint_command(&command);
    if (any_flag()) {
        gw_motor_restart(&motor);
    } else if (any_flag()) {
        gw_motor_command(&motor, &command, any_flag());
    } else {
        gw_wheels_t twist_nm = gw_motor_step(&motor, counts, &torque_nm, &counted);
        hold_wheels(&twist_nm, GW_TORQUE_MAX);
        demand_real(counted, GW_ZERO, GW_TWO);
    }
    hold_motor(&motor);
    (void)gw_motor_invariant_holds(&motor);
}

static void part_refusals(void)
{
    disturb_motor(&motor);
    (void)gw_motor_invariant_holds(any_flag() ? &motor : NULL);
}
