/* Compensated sums: a day of small increments loses nothing that a second would keep.
 *
 * Life cycle: set, then any number of adds. All members are private; a copy of the struct is a checkpoint.
 */
#ifndef GW_SUM_H
#define GW_SUM_H

#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The sum is value - excess. */
typedef struct {
    gw_real_t value;
    gw_real_t excess;
} gw_sum_t;

/* The sum with this value and no rounding error. */
gw_sum_t gw_sum_of(gw_real_t value);
/* sum + increment; both finite. */
gw_sum_t gw_sum_add(gw_sum_t sum, gw_real_t increment);
/* For angles: sum + increment modulo one turn, its value in [-pi, pi). |increment| <= GW_ANGLE_MAX. */
gw_sum_t gw_sum_add_angle(gw_sum_t sum, gw_real_t increment_rad);
/* The sum, its value kept within [-limit, limit]. */
gw_sum_t gw_sum_limit(gw_sum_t sum, gw_real_t limit);
/* minuend - sum, with the sum's full precision. */
gw_real_t gw_sum_subtract_from(gw_real_t minuend, gw_sum_t sum);
bool gw_sum_invariant_holds(gw_sum_t sum);

#ifdef __cplusplus
}
#endif

#endif
