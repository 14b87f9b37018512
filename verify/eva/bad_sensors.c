/* Bad sensors never cause motion: whenever the step reports bad sensors, all wheels are commanded speed zero. */
#include "parts.h"

static gw_controller_t controller;

static void part_init(void)
{
}

static void part_step(void)
{
    gw_controller_output_t output;
    const gw_controller_input_t input = {
        {{any_real(), any_real(), any_real()}, {any_int, any_int, any_int}, any_count, any_flag()},
        {{any_real(), any_real(), any_real()},
         {any_real(), any_real(), any_real()},
         {any_real(), any_real(), any_real()}},
        any_flag(),
        any_flag()};
    draw_controller(&controller);
    const gw_status_t status = gw_controller_step(&controller, &input, &output);
    if ((status >= GW_STATUS_SENSOR_MISSING) && (status <= GW_STATUS_SENSOR_RECOVERING)) {
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            demand_real(output.command.speed_radps[i], GW_ZERO, GW_ZERO);
        }
        demand_count((uint32_t)output.mode, (uint32_t)GW_MODE_FAULT, (uint32_t)GW_MODE_FAULT);
    }
}

static void part_refusals(void)
{
}
