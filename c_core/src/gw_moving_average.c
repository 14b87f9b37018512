#include "giveway/gw_moving_average.h"

#include "giveway/gw_math.h"
#include "giveway/gw_wrench.h"

static const gw_wrench_t no_wrench = {0};

gw_status_t gw_moving_average_init(gw_moving_average_t *average, uint32_t window)
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

void gw_moving_average_reset(gw_moving_average_t *average)
{
    /* Old samples need not be erased: none is subtracted before it was overwritten. */
    average->window_sum = no_wrench;
    average->fresh_sum = no_wrench;
    average->index = 0U;
    average->count = 0U;
}

bool gw_moving_average_invariant_holds(const gw_moving_average_t *average)
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
