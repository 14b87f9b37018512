/* Prints the inputs of the golden sequence "controller.trikey", one line per tick, for the controller's FMU: torques,
 * encoders, counter, present, plan, stop request, tare request. Reals are printed as C99 hexadecimal floats, which are
 * exact. */
#include <inttypes.h>
#include <stdio.h>

#include "script.h"

static void print_reals(const gw_real_t *x, uint32_t count)
{
    for (uint32_t i = 0U; i < count; i++) {
        (void)printf("%a ", (double)x[i]);
    }
}

static void print_input(const gw_controller_input_t *input)
{
    const gw_plan_t *const plan = &input->plan;
    const gw_real_t planned[9] = {plan->pose.x_m,
                                  plan->pose.y_m,
                                  plan->pose.theta_rad,
                                  plan->twist.vx_mps,
                                  plan->twist.vy_mps,
                                  plan->twist.omega_radps,
                                  plan->acceleration.ax_mps2,
                                  plan->acceleration.ay_mps2,
                                  plan->acceleration.alpha_radps2};
    print_reals(input->sensor.torque_nm, GW_WHEEL_COUNT);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        (void)printf("%" PRId32 " ", input->sensor.encoder_count[i]);
    }
    (void)printf("%" PRIu32 " %d ", input->sensor.counter, input->sensor.present ? 1 : 0);
    print_reals(planned, 9U);
    (void)printf("%d %d\n", input->stop_request ? 1 : 0, input->tare_request ? 1 : 0);
}

int main(void)
{
    static gw_controller_t controller;
    static script_t script;
    gw_controller_config_t config;
    gw_controller_output_t output;
    gw_controller_config_paper(&config);
    (void)gw_controller_init(&controller, &config, NULL);
    gw_controller_safe_output(&output);
    script_begin(&script, &config, SCRIPT_TRIKEY_SEED, true);
    for (uint32_t tick = 0U; tick < SCRIPT_TICKS; tick++) {
        const gw_controller_input_t *const input = script_next(&script, &output);
        print_input(input);
        (void)gw_controller_step(&controller, input, &output);
    }
    return 0;
}
