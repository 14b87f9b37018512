/* Any configuration, any state within the invariant, any events: the invariant is kept, and bad sensors lead to FAULT.
 */
#include "nondet.h"

int main(void)
{
    gw_supervisor_t supervisor;
    gw_supervisor_config_t config;
    gw_supervisor_events_t events;
    config.settled_speed_mps = nondet_float();
    config.settled_ticks = nondet_uint();
    config.after_settled = nondet_uint();
    config.rejoin_distance_m = nondet_float();
    config.rejoin_angle_rad = nondet_float();
    if (gw_supervisor_init(&supervisor, &config) == GW_STATUS_OK) {
        __ESBMC_assert(gw_supervisor_invariant_holds(&supervisor), "init establishes the invariant");
        supervisor.mode = (gw_mode_t)(nondet_uint() % 7U);
        supervisor.resume = (gw_mode_t)(nondet_uint() % 7U);
        supervisor.quiet_ticks = nondet_uint();
        supervisor.path_ticks = nondet_uint();
        supervisor.tare_pending = nondet_bool();
        events.sensors_good = nondet_bool();
        events.stop_request = nondet_bool();
        events.tare_accepted = nondet_bool();
        events.tare_done = nondet_bool();
        events.hit = nondet_bool();
        events.quiet = nondet_bool();
        events.on_path = nondet_bool();
        events.plan_valid = nondet_bool();
        __ESBMC_assume(gw_supervisor_invariant_holds(&supervisor));
        const gw_mode_t mode = gw_supervisor_step(&supervisor, &events);
        __ESBMC_assert(gw_supervisor_invariant_holds(&supervisor), "a step keeps the invariant");
        __ESBMC_assert(events.sensors_good || (mode == GW_MODE_FAULT), "bad sensors lead to FAULT");
        __ESBMC_assert(mode == supervisor.mode, "the reported mode is the mode");
    }
    return 0;
}
