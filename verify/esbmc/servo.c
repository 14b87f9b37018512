/* Any configuration, any state within the invariant and the ranges of eva/states.inc, any input: the invariant is kept,
 * the torque is within its limit, zero unless enabled, and the outputs are finite. */
#include "contracts.h"

#include "gw_servo.c"
#include "gw_sum.c"

int main(void)
{
    gw_servo_t servo;
    gw_servo_output_t output;
    const gw_servo_input_t input = {nondet_float(), nondet_float(), nondet_bool(), nondet_bool(), nondet_int()};
    servo.config.period_s = nondet_float();
    servo.config.kp_nm_per_rad = nondet_float();
    servo.config.kd_nms_per_rad = nondet_float();
    servo.config.torque_limit_nm = nondet_float();
    servo.config.torque_rate_limit_nm_per_s = nondet_float();
    servo.config.encoder_counts = nondet_uint();
    servo.config.derivative_cutoff_hz = nondet_float();
    servo.config.stale_ticks_max = nondet_uint();
    servo.rad_per_count = nondet_float();
    servo.count_rate = nondet_float();
    servo.filter_gain = nondet_float();
    servo.torque_step_nm = nondet_float();
    servo.desired_rad.value = nondet_float();
    servo.desired_rad.excess = nondet_float();
    servo.desired_speed_radps = nondet_float();
    servo.speed_radps = nondet_float();
    servo.torque_nm = nondet_float();
    servo.last_count = nondet_int();
    servo.position_count = nondet_int();
    servo.reference_age = nondet_uint();
    servo.reference_status = (gw_status_t)nondet_uint();
    servo.started = nondet_bool();
    servo.initialised = true;
    __ESBMC_assume(gw_in_range(servo.rad_per_count, 6.0e-6F, 1.6F) && gw_in_range(servo.count_rate, 6.0e-5F, 1.6e5F));
    __ESBMC_assume(gw_in_range(servo.torque_step_nm, GW_ZERO, 1.0e6F));
    __ESBMC_assume(gw_servo_invariant_holds(&servo));
    (void)gw_servo_step(&servo, &input, &output);
    __ESBMC_assert(gw_servo_invariant_holds(&servo), "a step keeps the invariant");
    __ESBMC_assert(gw_in_range(output.torque_nm, -servo.config.torque_limit_nm, servo.config.torque_limit_nm),
                   "the torque is within its limit");
    __ESBMC_assert(input.enable || (output.torque_nm == GW_ZERO), "no torque unless enabled");
    __ESBMC_assert(gw_in_range(output.angle_error_rad, -GW_PI, GW_PI), "the error is an angle");
    __ESBMC_assert(gw_is_finite(output.speed_radps), "the speed is a number");
    return 0;
}
