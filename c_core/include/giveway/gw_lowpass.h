/* A critically damped second-order low-pass w^2/(s + w)^2, the one that gw_rate_filter puts the wheels' rates through:
 * terms of a balance that all pass it stay aligned in time.
 *
 * Life cycle: gw_lowpass_restart, then gw_lowpass_step once per tick. All members are private.
 */
#ifndef GW_LOWPASS_H
#define GW_LOWPASS_H

#include "giveway/gw_math.h"
#include "giveway/gw_rate_filter.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    gw_real_t value;
    gw_real_t derivative;
    bool started;
} gw_lowpass_t;

/* Forgets the past: the filter starts at its next input. Pointer not NULL. */
static inline void gw_lowpass_restart(gw_lowpass_t *filter)
{
    filter->value = GW_ZERO;
    filter->derivative = GW_ZERO;
    filter->started = false;
}

/* One tick; the input is held over it. limit > 0; input and output are kept within it, whatever the input is. */
static inline gw_real_t gw_lowpass_step(gw_lowpass_t *filter, const gw_rate_filter_constants_t *constants,
                                        gw_real_t input, gw_real_t limit)
{
    if (filter->started) {
        /* Exact step of y'' = w^2 (u - y) - 2 w y'. */
        const gw_real_t error = filter->value - input;
        const gw_real_t mixed = filter->derivative + (constants->cutoff_radps * error);
        const gw_real_t derivative =
            constants->decay * (filter->derivative - ((constants->cutoff_radps * constants->period_s) * mixed));
        filter->value = gw_limited(input + (constants->decay * (error + (constants->period_s * mixed))), limit);
        filter->derivative = gw_limited(derivative, GW_RATE_DERIVATIVE_MAX);
    } else {
        filter->value = gw_limited(input, limit);
        filter->derivative = GW_ZERO;
        filter->started = true;
    }
    return filter->value;
}

/* Pointer not NULL. */
static inline bool gw_lowpass_invariant_holds(const gw_lowpass_t *filter, gw_real_t limit)
{
    return gw_within(filter->value, limit) && gw_within(filter->derivative, GW_RATE_DERIVATIVE_MAX);
}

#ifdef __cplusplus
}
#endif

#endif
