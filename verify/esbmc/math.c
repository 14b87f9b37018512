/* The guards on which all other proofs rely, for arbitrary bits. */
#include "nondet.h"

int main(void)
{
    const gw_real_t x = nondet_float();
    const gw_real_t low = nondet_float();
    const gw_real_t high = nondet_float();
    const gw_real_t fraction = gw_fraction(x, low);
    __ESBMC_assert((fraction >= -GW_ONE) && (fraction <= GW_ONE), "a fraction is within [-1, 1]");
    __ESBMC_assert(!(x >= GW_ZERO) || (fraction >= GW_ZERO), "a fraction has the sign of its part");
    __ESBMC_assert(!gw_is_finite(x) || (x - x == GW_ZERO), "finite is finite");
    __ESBMC_assert(gw_is_finite(x) == gw_in_range(x, -GW_REAL_MAX, GW_REAL_MAX), "NaN and infinities are in no range");
    if (low <= high) {
        const gw_real_t clamped = gw_clamp(x, low, high);
        __ESBMC_assert((clamped >= low) && (clamped <= high), "clamped is within");
    }
    return 0;
}
