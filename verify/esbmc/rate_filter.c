/* Any constants within the ranges of eva/states.inc, any state within the invariant, any count and valid torque, a
 * first rate of any bits: the invariant is kept. */
#include "nondet.h"
#include "giveway/gw_wrench.h"

int main(void)
{
    gw_rate_filter_constants_t constants;
    gw_rate_filter_t filter;
    const gw_real_t torque_nm = nondet_float();
    constants.period_s = nondet_float();
    constants.cutoff_radps = nondet_float();
    constants.decay = nondet_float();
    constants.rad_per_count = nondet_float();
    constants.compliance_rad_per_nm = nondet_float();
    filter.last_count = nondet_int();
    filter.last_torque_nm = nondet_float();
    filter.rate_radps = nondet_float();
    filter.derivative_radps2 = nondet_float();
    filter.started = nondet_bool();
    __ESBMC_assume(gw_in_range(constants.period_s, 0.0001F, 0.1F) &&
                   gw_in_range(constants.cutoff_radps, 0.1F, 10000.0F));
    __ESBMC_assume(gw_in_range(constants.decay, GW_ZERO, GW_ONE) &&
                   gw_in_range(constants.rad_per_count, 6.0e-6F, 1.6F));
    __ESBMC_assume(gw_in_range(constants.compliance_rad_per_nm, GW_ZERO, 1.1e6F));
    __ESBMC_assume(gw_rate_filter_invariant_holds(&filter));
    __ESBMC_assume(gw_in_range(torque_nm, -GW_TORQUE_MAX, GW_TORQUE_MAX));
    gw_rate_filter_presume(&filter, nondet_float());
    gw_rate_filter_step(&filter, &constants, nondet_int(), torque_nm);
    __ESBMC_assert(gw_rate_filter_invariant_holds(&filter), "a step keeps the invariant");
    return 0;
}
