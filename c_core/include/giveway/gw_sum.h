/* Compensated sums: a day of small increments loses nothing that a second would keep.
 *
 * Life cycle: set, then any number of adds. All members are private; a copy of the struct is a checkpoint.
 */
#ifndef GW_SUM_H
#define GW_SUM_H

#include "giveway/gw_math.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The sum is value - excess. */
typedef struct {
    gw_real_t value;
    gw_real_t excess;
} gw_sum_t;

/* The excess is at most half a unit in the last place of the value: for values up to 1e10 in float less than this. As a
 * limit it also holds after any input. */
#define GW_SUM_EXCESS_MAX ((gw_real_t)1024.0)

/* The sum with this value and no rounding error. */
static inline gw_sum_t gw_sum_of(gw_real_t value)
{
    const gw_sum_t sum = {value, GW_ZERO};
    return sum;
}

/* sum + increment; both finite. */
static inline gw_sum_t gw_sum_add(gw_sum_t sum, gw_real_t increment)
{
    gw_sum_t result;
    const gw_real_t corrected = increment - sum.excess;
    result.value = sum.value + corrected;
    result.excess = gw_limited((result.value - sum.value) - corrected, GW_SUM_EXCESS_MAX);
    return result;
}

/* The sum, at most a turn off, brought to [-pi, pi). */
GW_SMALL gw_sum_t gw_sum_within_turn(gw_sum_t sum);
/* For angles: sum + increment modulo one turn, its value in [-pi, pi). |increment| <= GW_ANGLE_MAX. */
static inline gw_sum_t gw_sum_add_angle(gw_sum_t sum, gw_real_t increment_rad)
{
    const gw_real_t almost_pi = (gw_real_t)3.0;
    /* The usual increment, that of a tick, is small. */
    const gw_real_t small =
        gw_within(increment_rad, GW_ONE) ? gw_known_within(increment_rad, GW_ONE) : gw_wrap_angle(increment_rad);
    gw_sum_t result = gw_sum_add(sum, small);
    if (gw_within(result.value, almost_pi)) {
        result.value = gw_known_within(result.value, almost_pi);
    } else {
        result = gw_sum_within_turn(result);
    }
    return result;
}

/* The sum, its value kept within [-limit, limit]; limit > 0. */
static inline gw_sum_t gw_sum_limit(gw_sum_t sum, gw_real_t limit)
{
    const gw_sum_t limited = {gw_limited(sum.value, limit), sum.excess};
    return limited;
}

/* minuend - sum, with the sum's full precision. */
static inline gw_real_t gw_sum_subtract_from(gw_real_t minuend, gw_sum_t sum)
{
    return (minuend - sum.value) + sum.excess;
}

bool gw_sum_invariant_holds(gw_sum_t sum);

#ifdef __cplusplus
}
#endif

#endif
