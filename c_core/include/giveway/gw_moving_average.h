/* Mean of the last 1 to GW_MOVING_AVERAGE_CAPACITY wrenches, in constant time and without drift.
 *
 * Two sums run: one over the window, one over the samples since the ring last wrapped. At every wrap the second,
 * which never saw a subtraction, replaces the first, so rounding errors live for one window at most.
 *
 * Life cycle: gw_moving_average_init, then adds; gw_moving_average_reset empties it. All members are private.
 */
#ifndef GW_MOVING_AVERAGE_H
#define GW_MOVING_AVERAGE_H

#include "giveway/gw_math.h"
#include "giveway/gw_types.h"
#include "giveway/gw_wrench.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    gw_wrench_t window_sum;
    gw_wrench_t fresh_sum;
    uint32_t window;
    uint32_t index;
    uint32_t count;
    gw_wrench_t sample[GW_MOVING_AVERAGE_CAPACITY]; /* last, so that the other members are cheap to address */
} gw_moving_average_t;

/* window: samples, [1, 1024]. */
GW_SMALL gw_status_t gw_moving_average_init(gw_moving_average_t *average, uint32_t window);
void gw_moving_average_reset(gw_moving_average_t *average);

/* Bound of a sum of valid wrenches, with room for its rounding. */
#define GW_WRENCH_SUM_MAX ((gw_real_t)1.1e12)

static inline gw_real_t gw_wrench_sum_limited(gw_real_t sum)
{
    return gw_limited(sum, GW_WRENCH_SUM_MAX);
}

static inline gw_wrench_t gw_wrench_sum(gw_wrench_t a, gw_wrench_t b)
{
    const gw_wrench_t sum = {gw_wrench_sum_limited(a.force_x_n + b.force_x_n),
                             gw_wrench_sum_limited(a.force_y_n + b.force_y_n),
                             gw_wrench_sum_limited(a.torque_nm + b.torque_nm)};
    return sum;
}

/* Not limited: the next operation, the addition of a sample, does that. */
static inline gw_wrench_t gw_wrench_difference(gw_wrench_t a, gw_wrench_t b)
{
    const gw_wrench_t difference = {a.force_x_n - b.force_x_n, a.force_y_n - b.force_y_n, a.torque_nm - b.torque_nm};
    return difference;
}

/* Adds one sample; one that is not gw_wrench_is_valid is refused with GW_STATUS_INPUT_INVALID. */
static inline gw_status_t gw_moving_average_add(gw_moving_average_t *average, gw_wrench_t sample)
{
    const gw_wrench_t nothing = {GW_ZERO, GW_ZERO, GW_ZERO};
    gw_status_t status = GW_STATUS_OK;
    if (average == NULL) {
        status = GW_STATUS_NULL_POINTER;
    } else if (!gw_wrench_is_valid(sample)) {
        status = GW_STATUS_INPUT_INVALID;
    } else {
        gw_wrench_t *const place = &average->sample[average->index];
        gw_wrench_t sum = average->window_sum;
        if (average->count < average->window) {
            average->count++;
        } else {
            sum = gw_wrench_difference(sum, *place);
        }
        const gw_wrench_t valid = gw_wrench_known_valid(sample);
        *place = valid;
        average->window_sum = gw_wrench_sum(sum, valid);
        average->fresh_sum = gw_wrench_sum(average->fresh_sum, valid);
        average->index++;
        if (average->index >= average->window) {
            average->index = 0U;
            average->window_sum = average->fresh_sum;
            average->fresh_sum = nothing;
        }
    }
    return status;
}

static inline gw_wrench_t gw_wrench_divided(gw_wrench_t a, gw_real_t divisor)
{
    const gw_wrench_t quotient = {a.force_x_n / divisor, a.force_y_n / divisor, a.torque_nm / divisor};
    return quotient;
}

/* Mean of the samples held (fewer than the window after a reset); zero if there are none. Pointers not NULL. */
static inline gw_wrench_t gw_moving_average_mean(const gw_moving_average_t *average)
{
    gw_wrench_t mean = {GW_ZERO, GW_ZERO, GW_ZERO};
    if (average->count > 0U) {
        mean = gw_wrench_divided(average->window_sum, (gw_real_t)average->count);
    }
    return mean;
}

/* Mean over the whole window, with zeros for samples that have not come yet. */
static inline gw_wrench_t gw_moving_average_window_mean(const gw_moving_average_t *average)
{
    return gw_wrench_divided(average->window_sum, (gw_real_t)average->window);
}

static inline uint32_t gw_moving_average_count(const gw_moving_average_t *average)
{
    return average->count;
}

bool gw_moving_average_invariant_holds(const gw_moving_average_t *average);

#ifdef __cplusplus
}
#endif

#endif
