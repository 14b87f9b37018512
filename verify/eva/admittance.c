#include "parts.h"

static gw_admittance_t admittance;
static gw_admittance_config_t config;

static gw_vector_t any_vector(void)
{
    const gw_vector_t vector = {any_real(), any_real()};
    return vector;
}

static void part_init(void)
{
    draw_admittance_config(&config);
    const gw_real_t period_s = draw_setting(GW_FIELD_CONTROLLER_PERIOD);
    demand_count((uint32_t)gw_admittance_init(&admittance, &config, period_s), 0U, 0U);
    hold_admittance(&admittance);
}

static void part_step(void)
{
    gw_admittance_output_t output;
    draw_admittance(&admittance);
    const uint32_t kind = draw_count(0U, 4U);
    if (kind == 0U) {
        (void)gw_admittance_start(&admittance, any_vector(), any_vector());
    } else if (kind == 1U) {
        gw_vector_t direction;
        draw_vector(&direction, (gw_real_t)1.01);
        gw_admittance_redirect(&admittance, direction);
    } else if (kind == 2U) {
        gw_admittance_brake(&admittance);
    } else if (kind == 3U) {
        gw_vector_t force_n;
        gw_vector_t robot_mps;
        draw_vector(&force_n, (gw_real_t)2.0e9); /* twice what is allowed, here and below */
        draw_vector(&robot_mps, (gw_real_t)2.0e9);
        gw_admittance_yield(&admittance, force_n, draw_real(GW_ZERO, (gw_real_t)1000.0),
                            draw_real((gw_real_t)0.0999, (gw_real_t)2.2e6), robot_mps);
    } else {
        (void)gw_admittance_step(&admittance, any_vector(), &output);
        hold_vector(&output.velocity_mps, (gw_real_t)100.0);
        hold_vector(&output.displacement_m, (gw_real_t)100.0);
    }
    hold_admittance(&admittance);
    (void)gw_admittance_invariant_holds(&admittance);
}

static void part_refusals(void)
{
    gw_admittance_output_t output;
    draw_admittance_config(&config);
    (void)gw_admittance_init(any_flag() ? &admittance : NULL, any_flag() ? &config : NULL,
                             draw_refused(GW_FIELD_CONTROLLER_PERIOD));
    admittance.initialised = false;
    (void)gw_admittance_start(any_flag() ? &admittance : NULL, any_vector(), any_vector());
    (void)gw_admittance_step(any_flag() ? &admittance : NULL, any_vector(), any_flag() ? &output : NULL);
    disturb_admittance(&admittance);
    (void)gw_admittance_invariant_holds(any_flag() ? &admittance : NULL);
}
