#include "parts.h"

static gw_reference_t reference;
static gw_reference_config_t config;

static gw_plan_t any_plan(void)
{
    const gw_plan_t plan = {{any_real(), any_real(), any_real()},
                            {any_real(), any_real(), any_real()},
                            {any_real(), any_real(), any_real()}};
    return plan;
}

static void part_init(void)
{
    draw_reference_config(&config);
    disturb_reference(&reference);
    if (gw_reference_init(&reference, &config, draw_setting(GW_FIELD_CONTROLLER_PERIOD)) == GW_STATUS_OK) {
        hold_reference(&reference); /* the gain fits the period */
    }
}

static void part_step(void)
{
    draw_reference(&reference);
    const gw_plan_t plan = any_plan();
    const gw_plan_t valid = gw_plan_limited(&plan);
    (void)gw_plan_is_valid(&plan);
    const uint32_t kind = draw_count(0U, 4U);
    if (kind == 0U) {
        gw_reference_place(&reference, &valid, any_flag());
    } else if (kind == 1U) {
        gw_reference_follow(&reference, &valid, any_flag());
    } else if (kind == 2U) {
        gw_vector_t displacement_m;
        gw_vector_t velocity_mps;
        draw_vector(&displacement_m, (gw_real_t)100.0); /* the outputs of an admittance */
        draw_vector(&velocity_mps, (gw_real_t)100.0);
        gw_reference_escape(&reference, displacement_m, velocity_mps);
    } else if (kind == 3U) {
        gw_reference_brake(&reference);
    } else {
        gw_reference_freeze(&reference);
    }
    hold_reference(&reference);
    demand_real(gw_reference_distance(&reference, &valid), GW_ZERO, (gw_real_t)1.0e6);
    demand_real(gw_reference_angle(&reference, &valid), GW_ZERO, PI_ROUNDED);
    demand_real(gw_reference_pose(&reference).x_m, (gw_real_t)-1.0e5, (gw_real_t)1.0e5);
    (void)gw_reference_invariant_holds(&reference);
}

static void part_refusals(void)
{
    draw_reference_config(&config);
    (void)gw_reference_init(any_flag() ? &reference : NULL, any_flag() ? &config : NULL,
                            draw_refused(GW_FIELD_CONTROLLER_PERIOD));
    reference.initialised = false;
    disturb_reference(&reference);
    (void)gw_reference_invariant_holds(any_flag() ? &reference : NULL);
}
