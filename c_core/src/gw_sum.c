#include "giveway/gw_sum.h"

#include "giveway/gw_math.h"

/* 2 pi minus twice GW_PI: the rounding error of the real type's pi. */
#if (GW_REAL_DOUBLE == 1)
#define TURN_REMAINDER ((gw_real_t)2.4492935982947063545e-16)
#else
#define TURN_REMAINDER (-(gw_real_t)1.7484556000744971323e-7)
#endif

gw_sum_t gw_sum_within_turn(gw_sum_t sum)
{
    gw_sum_t result = sum;
    /* value -+ 2 GW_PI is exact; the excess takes up the difference between 2 GW_PI and a turn. */
    if (result.value >= GW_PI) {
        result.value -= GW_TWO * GW_PI;
        result.excess += TURN_REMAINDER;
    } else if (result.value < -GW_PI) {
        result.value += GW_TWO * GW_PI;
        result.excess -= TURN_REMAINDER;
    } else {
        /* within the turn, or NaN */
    }
    result.value = gw_limited(result.value, GW_PI); /* -pi if it is NaN */
    return result;
}

bool gw_sum_invariant_holds(gw_sum_t sum)
{
    return gw_is_finite(sum.value) && gw_within(sum.excess, GW_SUM_EXCESS_MAX);
}
