#include "parts.h"

static gw_supervisor_t supervisor;
static gw_supervisor_config_t config;

static gw_supervisor_events_t any_events(void)
{
    const gw_supervisor_events_t events = {any_flag(), any_flag(), any_flag(), any_flag(),
                                           any_flag(), any_flag(), any_flag(), any_flag()};
    return events;
}

static void part_init(void)
{
    draw_supervisor_config(&config);
    demand_count((uint32_t)gw_supervisor_init(&supervisor, &config), 0U, 0U);
    hold_supervisor(&supervisor);
}

static void part_step(void)
{
    draw_supervisor(&supervisor);
    const gw_supervisor_events_t events = any_events();
    //@ split supervisor.mode;
    demand_count((uint32_t)gw_supervisor_step(&supervisor, &events), 0U, (uint32_t)GW_MODE_FAULT);
    hold_supervisor(&supervisor);
    (void)gw_supervisor_invariant_holds(&supervisor);
}

static void part_refusals(void)
{
    const gw_supervisor_events_t events = any_events();
    draw_supervisor_config(&config);
    config.settled_speed_mps = draw_refused(GW_FIELD_SUPERVISOR_SETTLED_SPEED);
    (void)gw_supervisor_init(any_flag() ? &supervisor : NULL, any_flag() ? &config : NULL);
    supervisor.initialised = false;
    (void)gw_supervisor_step(any_flag() ? &supervisor : NULL, any_flag() ? &events : NULL);
    disturb_supervisor(&supervisor);
    (void)gw_supervisor_invariant_holds(any_flag() ? &supervisor : NULL);
}
