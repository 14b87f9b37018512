#include "giveway/gw_sum.h"

#include "giveway/gw_math.h"

/* 2 pi less twice GW_PI: what the real type's pi leaves out. */
#if (GW_REAL_DOUBLE == 1)
#define TURN_REMAINDER ((gw_real_t)2.4492935982947063545e-16)
#else
#define TURN_REMAINDER ((gw_real_t)-1.7484556000744971323e-7)
#endif

/* The excess is at most half a unit in the last place of the value; this bounds it for values up to 1e10 in float, and
 * does so whatever the sum was before. */
#define EXCESS_MAX ((gw_real_t)1024.0)

gw_sum_t gw_sum_of(gw_real_t value)
{
    const gw_sum_t sum = {value, GW_ZERO};
    return sum;
}

gw_sum_t gw_sum_add(gw_sum_t sum, gw_real_t increment)
{
    gw_sum_t result;
    const gw_real_t corrected = increment - sum.excess;
    result.value = sum.value + corrected;
    result.excess = gw_clamp((result.value - sum.value) - corrected, -EXCESS_MAX, EXCESS_MAX);
    return result;
}

gw_sum_t gw_sum_add_angle(gw_sum_t sum, gw_real_t increment_rad)
{
    gw_sum_t result = gw_sum_add(sum, gw_wrap_angle(increment_rad));
    /* value -+ 2 GW_PI is exact; the excess takes up that 2 GW_PI is not quite a turn. */
    if (result.value >= GW_PI) {
        result.value -= GW_TWO * GW_PI;
        result.excess += TURN_REMAINDER;
    } else if (result.value < -GW_PI) {
        result.value += GW_TWO * GW_PI;
        result.excess -= TURN_REMAINDER;
    } else {
        /* within one turn */
    }
    result.value = gw_clamp(result.value, -GW_PI, GW_PI);
    return result;
}

gw_real_t gw_sum_subtract_from(gw_real_t minuend, gw_sum_t sum)
{
    return (minuend - sum.value) + sum.excess;
}

gw_sum_t gw_sum_limit(gw_sum_t sum, gw_real_t limit)
{
    gw_sum_t result = sum;
    result.value = gw_clamp(sum.value, -limit, limit);
    return result;
}

bool gw_sum_invariant_holds(gw_sum_t sum)
{
    return gw_is_finite(sum.value) && gw_in_range(sum.excess, -EXCESS_MAX, EXCESS_MAX);
}
