#include "giveway/gw_moving_average.h"

#include "giveway/gw_math.h"
#include "giveway/gw_wrench.h"

static const gw_wrench_t no_wrench = {(gw_real_t)0.0, (gw_real_t)0.0, (gw_real_t)0.0};

/* Bound of a sum of valid wrenches, with room for its rounding. */
#define SUM_MAX ((gw_real_t)1.1e12)

static gw_real_t limited_sum(gw_real_t sum)
{
    return gw_limited(sum, SUM_MAX);
}

static gw_wrench_t plus(gw_wrench_t a, gw_wrench_t b)
{
    const gw_wrench_t sum = {limited_sum(a.force_x_n + b.force_x_n), limited_sum(a.force_y_n + b.force_y_n),
                             limited_sum(a.torque_nm + b.torque_nm)};
    return sum;
}

/* Not limited: a sample is added at once. */
static gw_wrench_t minus(gw_wrench_t a, gw_wrench_t b)
{
    const gw_wrench_t difference = {a.force_x_n - b.force_x_n, a.force_y_n - b.force_y_n, a.torque_nm - b.torque_nm};
    return difference;
}

GW_SELDOM gw_status_t gw_moving_average_init(gw_moving_average_t *average, uint32_t window)
{
    gw_status_t status = GW_STATUS_OK;
    if (average == NULL) {
        status = GW_STATUS_NULL_POINTER;
    } else {
        const bool in_range = (window >= 1U) && (window <= GW_MOVING_AVERAGE_CAPACITY);
        average->window = in_range ? window : 1U;
        for (uint32_t i = 0U; i < GW_MOVING_AVERAGE_CAPACITY; i++) {
            average->sample[i] = no_wrench;
        }
        gw_moving_average_reset(average);
        status = in_range ? GW_STATUS_OK : GW_STATUS_CONFIG_INVALID;
    }
    return status;
}

GW_SELDOM void gw_moving_average_reset(gw_moving_average_t *average)
{
    /* Old samples need not be erased: none is subtracted before it was overwritten. */
    average->window_sum = no_wrench;
    average->fresh_sum = no_wrench;
    average->index = 0U;
    average->count = 0U;
}

gw_status_t gw_moving_average_add(gw_moving_average_t *average, gw_wrench_t sample)
{
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
            sum = minus(sum, *place);
        }
        const gw_wrench_t valid = gw_wrench_limited(sample);
        *place = valid;
        average->window_sum = plus(sum, valid);
        average->fresh_sum = plus(average->fresh_sum, valid);
        average->index++;
        if (average->index >= average->window) {
            average->index = 0U;
            average->window_sum = average->fresh_sum;
            average->fresh_sum = no_wrench;
        }
    }
    return status;
}

GW_SELDOM bool gw_moving_average_invariant_holds(const gw_moving_average_t *average)
{
    bool holds = (average != NULL);
    if (holds) {
        holds = (average->window >= 1U) && (average->window <= GW_MOVING_AVERAGE_CAPACITY) &&
                (average->index < average->window) && (average->count <= average->window) &&
                gw_is_finite(gw_moving_average_mean(average).force_x_n) &&
                gw_is_finite(gw_moving_average_mean(average).force_y_n) &&
                gw_is_finite(gw_moving_average_mean(average).torque_nm);
    }
    return holds;
}
