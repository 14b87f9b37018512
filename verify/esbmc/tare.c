/* Any state within the bounds of a tare, any bits as torque: bounds are kept, and a mean is a torque. */
#include "nondet.h"
#include "giveway/gw_wrench.h"

int main(void)
{
    gw_tare_t tare;
    gw_wheels_t torque_nm;
    gw_wheels_t mean_nm = {{GW_ZERO, GW_ZERO, GW_ZERO}};
    const unsigned int samples = nondet_uint();
    for (unsigned int i = 0U; i < GW_WHEEL_COUNT; i++) {
        torque_nm.wheel[i] = nondet_float();
        tare.sum_nm[i].value = nondet_float();
        tare.sum_nm[i].excess = nondet_float();
        __ESBMC_assume(gw_in_range(tare.sum_nm[i].value, -1.0e11F, 1.0e11F));
        tare.lowest_nm[i] = nondet_float();
        tare.highest_nm[i] = nondet_float();
    }
    tare.count = nondet_uint();
    for (unsigned int i = 0U; i < GW_WHEEL_COUNT; i++) {
        __ESBMC_assume(gw_in_range(tare.lowest_nm[i], -GW_TORQUE_MAX, GW_REAL_MAX));
        __ESBMC_assume(gw_in_range(tare.highest_nm[i], -GW_REAL_MAX, GW_TORQUE_MAX));
    }
    __ESBMC_assume(gw_tare_invariant_holds(&tare) && (tare.count < samples) && (samples <= 100000U));
    (void)gw_tare_add(&tare, &torque_nm, samples, nondet_float(), &mean_nm);
    __ESBMC_assert(gw_tare_invariant_holds(&tare), "a sample keeps the invariant");
    __ESBMC_assert(tare.count < samples, "a tare ends");
    for (unsigned int i = 0U; i < GW_WHEEL_COUNT; i++) {
        __ESBMC_assert(gw_in_range(mean_nm.wheel[i], -GW_TORQUE_MAX, GW_TORQUE_MAX), "a mean is a torque");
    }
    return 0;
}
