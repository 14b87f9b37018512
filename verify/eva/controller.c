#include "parts.h"

static gw_controller_t controller;
static gw_controller_config_t config;

static gw_controller_input_t any_input(void)
{
    const gw_controller_input_t input = {
        {{any_real(), any_real(), any_real()}, {any_int, any_int, any_int}, any_count, any_flag()},
        {{any_real(), any_real(), any_real()},
         {any_real(), any_real(), any_real()},
         {any_real(), any_real(), any_real()}},
        any_flag(),
        any_flag(),
        {{any_real(), any_real()}, any_real(), any_count, any_flag()}};
    return input;
}

static void part_init(void)
{
    static const gw_moving_average_t empty;
    gw_config_error_t error;
    draw_controller_config(&config);
    config.geometry.wheel_slot[0] = 1U; /* the slots: any in kinematics.c */
    config.geometry.wheel_slot[1] = 2U;
    config.geometry.wheel_slot[2] = 0U;
    disturb_controller(&controller);
    /* Whether an outline is convex, a gain fits the period and an acceleration is measured: these checks are called
     * twice with the same answer, which Eva cannot know. contact.c, reference.c and estimator.c prove the results of a
     * successful init of these three. */
    draw_contact(&controller.contact);
    draw_estimator(&controller.estimator);
    controller.estimator.average = empty; /* 1024 samples at once: Eva does not have to follow the loop over them */
    controller.estimator.average.window = draw_count(1U, GW_MOVING_AVERAGE_CAPACITY);
    draw_reference(&controller.reference);
    if (gw_controller_init(&controller, &config, any_flag() ? &error : NULL) == GW_STATUS_OK) {
        controller.contact.initialised = true;
        controller.reference.initialised = true;
        controller.estimator.initialised = true;
        hold_controller(&controller);
    }
}

static void hold_output(gw_controller_output_t *output)
{
    hold_joint_command(&output->command);
    hold_wrench(&output->estimate, (gw_real_t)1.1e12);
    hold_contact_estimate(&output->contact);
    demand_real(output->detection_statistic, GW_ZERO, (gw_real_t)1.8447e19);
    demand_count(output->detection_count, 0U, GW_TICK_MASK);
    demand_integer(output->detection_tick, -1, INT32_MAX);
    hold_wrench(&output->detection_wrench, GW_WRENCH_MAX);
    hold_contact_estimate(&output->detection_contact);
    demand_real(output->reference_pose.x_m, (gw_real_t)-1.0e5, (gw_real_t)1.0e5);
    demand_real(output->reference_pose.y_m, (gw_real_t)-1.0e5, (gw_real_t)1.0e5);
    demand_real(output->reference_pose.theta_rad, -PI_ROUNDED, PI_ROUNDED);
    hold_twist(&output->reference_twist);
    demand_count((uint32_t)output->mode, 0U, (uint32_t)GW_MODE_FAULT);
    demand_count(output->path_ticks, 0U, GW_TICK_MASK);
    demand_count(output->tick, 0U, GW_TICK_MASK);
}

static void part_step(void)
{
    static const gw_moving_average_t empty;
    /* no initial value: Eva then sees if a tick reads what only the previous tick has written */
    gw_controller_t controller;
    controller.estimator.average = empty; /* as in part_init */
    gw_controller_output_t output;
    const gw_controller_input_t input = any_input();
    draw_controller(&controller);
    (void)gw_controller_step(&controller, &input, &output);
    hold_controller(&controller);
    hold_output(&output);
    (void)gw_controller_invariant_holds(&controller);
}

static void part_refusals(void)
{
    gw_controller_output_t output;
    const gw_controller_input_t input = any_input();
    draw_controller_config(&config);
    config.period_s = draw_refused(GW_FIELD_CONTROLLER_PERIOD);
    (void)gw_controller_init(any_flag() ? &controller : NULL, any_flag() ? &config : NULL, NULL);
    controller.initialised = false;
    (void)gw_controller_step(any_flag() ? &controller : NULL, any_flag() ? &input : NULL, any_flag() ? &output : NULL);
    draw_controller(&controller);
    controller.initialised = any_flag();
    controller.reference.period_s = draw_real((gw_real_t)0.0001, GW_ONE);
    controller.detection_count = any_count;
    controller.detection_tick = any_int;
    controller.tick = any_count;
    (void)gw_controller_invariant_holds(any_flag() ? &controller : NULL);
}
