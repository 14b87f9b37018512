/* Decides that the robot is being hit.
 *
 * Force average: trips when the moving average of the force exceeds a threshold.
 * Impulse: s = I + F T; I = s max(0, 1 - F0 T/|s|); trips when |I| exceeds a threshold. The integral is that of the
 * force VECTOR, so noise cancels; a force below F0 never trips, however long it lasts. The moment shrinks in
 * proportion, so the contact can be located from the impulse itself.
 *
 * Hysteresis: after a trip the detector stays active, with its integral at zero, until the blanking time is over AND
 * the averaged force has fallen below the release force (or the caller says that the reaction is over). Then a new
 * hit trips it again.
 *
 * Life cycle: gw_detector_init, gw_detector_step per tick, gw_detector_clear when the meaning of the force changes
 * (a new zero), gw_detector_reset to forget everything. All members are private.
 */
#ifndef GW_DETECTOR_H
#define GW_DETECTOR_H

#include "giveway/gw_config.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GW_DETECTOR_FORCE_AVERAGE 0U
#define GW_DETECTOR_IMPULSE 1U
#define GW_DETECTOR_CHANNELS 2U /* not this module: gw_channels.h, which the controller asks instead */

typedef struct {
    /* GW_DETECTOR_FORCE_AVERAGE (0), GW_DETECTOR_IMPULSE (1) or GW_DETECTOR_CHANNELS (2). */
    uint32_t kind;
    /* Force average: trips above this force, N, [0.01, 10000]. */
    gw_real_t force_threshold_n;
    /* Impulse: trips above this impulse J, N s, [0.001, 1000]. */
    gw_real_t impulse_threshold_newton_s;
    /* Impulse: forgiven force F0 at rest, creeping and in motion, N, [0, 1000]. While creeping the force average
     * trips above leak_creep_n if that is more than its threshold. */
    gw_real_t leak_rest_n;
    gw_real_t leak_creep_n;
    gw_real_t leak_motion_n;
    /* Averaged force below which a tripped detector may trip again, N, [0, 10000]. The force average takes
     * force_threshold_n if that is smaller. */
    gw_real_t release_force_n;
    /* Time after a trip in which the detector cannot trip again, ticks, [0, 100000]. */
    uint32_t blanking_ticks;
} gw_detector_config_t;

typedef struct {
    /* The external wrench of this tick. */
    gw_wrench_t wrench;
    /* Its moving average over the whole window, for the force average, and over the samples held, for the release. */
    gw_wrench_t window_mean;
    gw_wrench_t mean;
    uint32_t mean_samples;
    /* Chooses F0. */
    gw_regime_t regime;
    /* False: hits are not looked for, and nothing is integrated. */
    bool enabled;
    /* True: the reaction is over, and a push that still lasts may trip again. */
    bool reaction_over;
} gw_detector_input_t;

typedef struct {
    /* True in the one step that trips. */
    bool tripped;
    /* True from the trip until the detector may trip again. */
    bool active;
    /* |I| in N s or the averaged force in N, as the kind says. */
    gw_real_t statistic;
    /* Mean wrench and number of the samples in the statistic. */
    gw_wrench_t mean_wrench;
    uint32_t samples;
} gw_detector_output_t;

typedef struct {
    gw_detector_config_t config;
    gw_real_t period_s;
    gw_real_t impulse_x_newton_s;
    gw_real_t impulse_y_newton_s;
    gw_real_t impulse_moment_nms;
    uint32_t samples;
    uint32_t ticks_since_trip;
    bool active;
    bool initialised;
} gw_detector_t;

/* The values of Trikey, the paper's robot. Pointers not NULL in these two. */
void gw_detector_config_trikey(gw_detector_config_t *config);
GW_SMALL void gw_detector_config_check(const gw_detector_config_t *config, gw_config_error_t *error);
/* period: s, [0.0001, 0.1]. */
GW_SMALL gw_status_t gw_detector_init(gw_detector_t *detector, const gw_detector_config_t *config, gw_real_t period_s);
bool gw_detector_invariant_holds(const gw_detector_t *detector);
/* Empties the integral; an active detector stays active. Pointer not NULL. */
void gw_detector_clear(gw_detector_t *detector);
/* Empties the integral and arms the detector. Pointer not NULL. */
GW_SMALL void gw_detector_reset(gw_detector_t *detector);
/* F0, N. */
static inline gw_real_t gw_detector_leak(const gw_detector_t *detector, gw_regime_t regime)
{
    gw_real_t leak_n = detector->config.leak_creep_n;
    if (regime == GW_REGIME_REST) {
        leak_n = detector->config.leak_rest_n;
    } else if (regime == GW_REGIME_MOTION) {
        leak_n = detector->config.leak_motion_n;
    } else {
        /* creeping */
    }
    return leak_n;
}

/* One tick. A wrench that is not gw_wrench_is_valid: GW_STATUS_INPUT_INVALID, no trip, state unchanged. */
gw_status_t gw_detector_step(gw_detector_t *detector, const gw_detector_input_t *input, gw_detector_output_t *output);

#ifdef __cplusplus
}
#endif

#endif
