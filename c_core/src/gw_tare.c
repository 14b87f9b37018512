#include "giveway/gw_tare.h"

#include "giveway/gw_math.h"
#include "giveway/gw_wrench.h"

/* Bound of a sum of valid torques: GW_TORQUE_MAX times the longest tare. */
#define SUM_MAX ((gw_real_t)1.0e11)

void gw_tare_start(gw_tare_t *tare)
{
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        tare->sum_nm[i] = gw_sum_of(GW_ZERO);
        tare->lowest_nm[i] = GW_REAL_MAX;
        tare->highest_nm[i] = -GW_REAL_MAX;
    }
    tare->count = 0U;
}

gw_tare_progress_t gw_tare_add(gw_tare_t *tare, const gw_wheels_t *torque_nm, uint32_t samples, gw_real_t variation_nm,
                               gw_wheels_t *mean_nm)
{
    gw_tare_progress_t progress = GW_TARE_RUNNING;
    tare->count++;
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_real_t valid_nm = gw_limited(torque_nm->wheel[i], GW_TORQUE_MAX);
        tare->sum_nm[i] = gw_sum_limit(gw_sum_add(tare->sum_nm[i], valid_nm), SUM_MAX);
        tare->lowest_nm[i] = gw_min(tare->lowest_nm[i], valid_nm);
        tare->highest_nm[i] = gw_max(tare->highest_nm[i], valid_nm);
        if ((tare->highest_nm[i] - tare->lowest_nm[i]) > variation_nm) {
            progress = GW_TARE_REFUSED;
        }
    }
    if (progress == GW_TARE_REFUSED) {
        gw_tare_start(tare);
    } else if (tare->count >= samples) {
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            mean_nm->wheel[i] = gw_limited(tare->sum_nm[i].value / (gw_real_t)tare->count, GW_TORQUE_MAX);
        }
        gw_tare_start(tare);
        progress = GW_TARE_DONE;
    } else {
        /* more to come */
    }
    return progress;
}

bool gw_tare_invariant_holds(const gw_tare_t *tare)
{
    bool holds = (tare != NULL);
    if (holds) {
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            holds = holds && gw_sum_invariant_holds(tare->sum_nm[i]) &&
                    ((tare->count == 0U) || (tare->lowest_nm[i] <= tare->highest_nm[i]));
        }
    }
    return holds;
}
