#include "parts.h"

static gw_detector_t detector;
static gw_detector_config_t config;

static gw_wrench_t any_wrench(void)
{
    const gw_wrench_t wrench = {any_real(), any_real(), any_real()};
    return wrench;
}

static gw_detector_input_t any_input(void)
{
    const gw_detector_input_t input = {
        any_wrench(), any_wrench(), any_wrench(), any_count, (gw_regime_t)draw_count(0U, (uint32_t)GW_REGIME_MOTION),
        any_flag(),   any_flag()};
    return input;
}

static void part_init(void)
{
    draw_detector_config(&config);
    const gw_real_t period_s = draw_setting(GW_FIELD_CONTROLLER_PERIOD);
    demand_count((uint32_t)gw_detector_init(&detector, &config, period_s), 0U, 0U);
    hold_detector(&detector);
}

static void part_step(void)
{
    draw_detector(&detector);
    const gw_detector_input_t input = any_input();
    gw_detector_output_t output;
    (void)gw_detector_step(&detector, &input, &output);
    hold_detector(&detector);
    hold_wrench(&output.mean_wrench, GW_WRENCH_MAX);
    demand_real(output.statistic, GW_ZERO, (gw_real_t)1.8447e19);
    (void)gw_detector_invariant_holds(&detector);
}

static void part_refusals(void)
{
    const gw_detector_input_t input = any_input();
    gw_detector_output_t output;
    draw_detector_config(&config);
    (void)gw_detector_init(any_flag() ? &detector : NULL, any_flag() ? &config : NULL,
                           draw_refused(GW_FIELD_CONTROLLER_PERIOD));
    detector.initialised = false;
    (void)gw_detector_step(any_flag() ? &detector : NULL, any_flag() ? &input : NULL, any_flag() ? &output : NULL);
    disturb_detector(&detector);
    (void)gw_detector_invariant_holds(any_flag() ? &detector : NULL);
}
