/* Any configuration, any state within the invariant, any sample: the invariant is kept, and torques that are not finite
 * or exceed the limit are never called good. */
#include "nondet.h"

int main(void)
{
    gw_sensor_check_t check;
    gw_sensor_check_config_t config;
    gw_sensor_sample_t sample;
    config.torque_limit_nm = nondet_float();
    config.stale_ticks_max = nondet_uint();
    config.encoder_jump_counts = nondet_uint();
    config.recover_ticks = nondet_uint();
    if (gw_sensor_check_init(&check, &config) == GW_STATUS_OK) {
        __ESBMC_assert(gw_sensor_check_invariant_holds(&check), "init establishes the invariant");
        check.last_counter = nondet_uint();
        check.age_ticks = nondet_uint();
        check.recover_remaining = nondet_uint();
        check.counter_known = nondet_bool();
        check.encoder_known = nondet_bool();
        check.was_good = nondet_bool();
        bool good = true;
        for (unsigned int i = 0U; i < GW_WHEEL_COUNT; i++) {
            check.last_count[i] = nondet_int();
            sample.encoder_count[i] = nondet_int();
            sample.torque_nm[i] = nondet_float();
            good = good && (gw_abs(sample.torque_nm[i]) < config.torque_limit_nm);
        }
        sample.counter = nondet_uint();
        sample.present = nondet_bool();
        __ESBMC_assume(gw_sensor_check_invariant_holds(&check));
        const gw_status_t status = gw_sensor_check_step(&check, &sample);
        __ESBMC_assert(gw_sensor_check_invariant_holds(&check), "a step keeps the invariant");
        __ESBMC_assert((status != GW_STATUS_OK) || (good && sample.present), "bad sensors are never called good");
    }
    return 0;
}
