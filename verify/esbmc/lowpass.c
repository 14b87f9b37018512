/* Any constants within the ranges of eva/states.inc, any state within the invariant, an input of any bits: value and
 * derivative stay within their limits. */
#include "nondet.h"
#include "giveway/gw_wrench.h"

int main(void)
{
    gw_rate_filter_constants_t constants;
    gw_lowpass_t filter;
    constants.period_s = nondet_float();
    constants.cutoff_radps = nondet_float();
    constants.decay = nondet_float();
    constants.rad_per_count = GW_ONE;
    constants.compliance_rad_per_nm = GW_ZERO;
    filter.value = nondet_float();
    filter.derivative = nondet_float();
    filter.started = nondet_bool();
    __ESBMC_assume(gw_in_range(constants.period_s, 0.0001F, 0.1F) &&
                   gw_in_range(constants.cutoff_radps, 0.1F, 10000.0F));
    __ESBMC_assume(gw_in_range(constants.decay, GW_ZERO, GW_ONE));
    __ESBMC_assume(gw_lowpass_invariant_holds(&filter, GW_TORQUE_MAX));
    const gw_real_t value = gw_lowpass_step(&filter, &constants, nondet_float(), GW_TORQUE_MAX);
    __ESBMC_assert(gw_lowpass_invariant_holds(&filter, GW_TORQUE_MAX), "a step keeps the invariant");
    __ESBMC_assert(gw_within(value, GW_TORQUE_MAX), "the output is within the limit");
    return 0;
}
