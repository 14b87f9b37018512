#include "parts.h"

static gw_servo_t servo;
static gw_servo_config_t config;

static void part_init(void)
{
    draw_servo_config(&config);
    demand_count((uint32_t)gw_servo_init(&servo, &config), 0U, 0U);
    hold_servo(&servo);
}

static void part_step(void)
{
    draw_servo(&servo);
    const gw_servo_input_t input = {any_real(), any_real(), any_flag(), any_flag(), any_int};
    gw_servo_output_t output;
    (void)gw_servo_step(&servo, &input, &output);
    hold_servo(&servo);
    demand_real(output.torque_nm, (gw_real_t)-1.0e4, (gw_real_t)1.0e4);
    demand_real(output.angle_error_rad, -PI_ROUNDED, PI_ROUNDED);
    demand_real(output.speed_radps, (gw_real_t)-1.0e6, (gw_real_t)1.0e6);
    (void)gw_servo_invariant_holds(&servo);
}

static void part_refusals(void)
{
    const gw_servo_input_t input = {any_real(), any_real(), any_flag(), any_flag(), any_int};
    gw_servo_output_t output;
    draw_servo_config(&config);
    config.period_s = draw_refused(GW_FIELD_SERVO_PERIOD);
    (void)gw_servo_init(any_flag() ? &servo : NULL, any_flag() ? &config : NULL);
    servo.initialised = false;
    (void)gw_servo_step(any_flag() ? &servo : NULL, any_flag() ? &input : NULL, any_flag() ? &output : NULL);
    disturb_servo(&servo);
    (void)gw_servo_invariant_holds(any_flag() ? &servo : NULL);
}
