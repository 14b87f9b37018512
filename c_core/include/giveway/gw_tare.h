/* The torques that the sensors show while nothing touches the robot: a mean over a quiet period.
 *
 * Refused if any torque varies by more than a limit within the period; the tare then starts anew.
 *
 * Life cycle: gw_tare_start, then gw_tare_add per tick until it is done. All members are private.
 */
#ifndef GW_TARE_H
#define GW_TARE_H

#include "giveway/gw_sum.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum { GW_TARE_RUNNING = 0, GW_TARE_DONE = 1, GW_TARE_REFUSED = 2 } gw_tare_progress_t;

typedef struct {
    gw_sum_t sum_nm[GW_WHEEL_COUNT];
    gw_real_t lowest_nm[GW_WHEEL_COUNT];
    gw_real_t highest_nm[GW_WHEEL_COUNT];
    uint32_t count;
} gw_tare_t;

/* Forgets all samples. Pointers not NULL here and below. */
GW_SMALL void gw_tare_start(gw_tare_t *tare);
/* Adds one finite sample. DONE at the given number of samples (at least 1) with the mean in *mean_nm, else mean_nm is
 * left alone. REFUSED: varied by more than variation_nm; started anew. */
GW_SMALL gw_tare_progress_t gw_tare_add(gw_tare_t *tare, const gw_wheels_t *torque_nm, uint32_t samples,
                                        gw_real_t variation_nm, gw_wheels_t *mean_nm);
bool gw_tare_invariant_holds(const gw_tare_t *tare);

#ifdef __cplusplus
}
#endif

#endif
