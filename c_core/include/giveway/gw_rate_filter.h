/* Rate of a wheel and its derivative, from encoder counts.
 *
 * A critically damped second-order low-pass w^2/(s + w)^2 of the wheel's rate; its input is held over each sample,
 * its step is exact. Counts enter as wrapped differences, so a counter may wrap at any time.
 *
 * Life cycle: gw_rate_filter_init, then gw_rate_filter_step once per tick; gw_rate_filter_restart after a gap.
 * All members are private; a copy of the struct is a checkpoint.
 */
#ifndef GW_RATE_FILTER_H
#define GW_RATE_FILTER_H

#include "giveway/gw_math.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/* No wheel turns or accelerates faster. The limits keep the filter's state finite for any counts. */
#define GW_RATE_MAX ((gw_real_t)1.0e6)
#define GW_RATE_DERIVATIVE_MAX ((gw_real_t)1.0e10)

/* Constants shared by the three wheels. */
typedef struct {
    gw_real_t period_s;
    gw_real_t cutoff_radps;
    gw_real_t decay; /* e^(-w T) */
    gw_real_t rad_per_count;
    gw_real_t compliance_rad_per_nm; /* 1/k, or 0 for a rigid drivetrain */
} gw_rate_filter_constants_t;

typedef struct {
    int32_t last_count;
    gw_real_t last_torque_nm;
    gw_real_t rate_radps;
    gw_real_t derivative_radps2;
    bool started;
} gw_rate_filter_t;

/* Constants from checked configuration values: period [0.0001, 0.1] s, cutoff [0.1, 10000] rad/s, counts per turn
 * [4, 1000000], stiffness [0, 1e7] N m/rad (0: rigid). */
GW_SMALL gw_status_t gw_rate_filter_constants(gw_rate_filter_constants_t *constants, gw_real_t period_s,
                                              gw_real_t cutoff_radps, uint32_t counts_per_turn,
                                              gw_real_t stiffness_nm_per_rad);
/* Forgets the past: the next sample starts the filter at rate zero. Pointer not NULL. */
GW_SMALL void gw_rate_filter_restart(gw_rate_filter_t *filter);
/* The next sample starts a filter that has not started at this rate, unless that is more than 1e6 rad/s. */
static inline void gw_rate_filter_presume(gw_rate_filter_t *filter, gw_real_t rate_radps)
{
    if ((!filter->started) && gw_within(rate_radps, GW_RATE_MAX)) {
        filter->rate_radps = gw_limited(rate_radps, GW_RATE_MAX);
    }
}

/* How far a wheel turned, rad: its motor side by so many counts, less the change of the drivetrain's twist torque/k. */
static inline gw_real_t gw_rate_filter_turned(const gw_rate_filter_constants_t *constants, int32_t counts,
                                              gw_real_t torque_change_nm)
{
    return ((gw_real_t)counts * constants->rad_per_count) - (torque_change_nm * constants->compliance_rad_per_nm);
}

/* One tick. |torque| <= GW_TORQUE_MAX. */
static inline void gw_rate_filter_step(gw_rate_filter_t *filter, const gw_rate_filter_constants_t *constants,
                                       int32_t count, gw_real_t torque_nm)
{
    if (filter->started) {
        const gw_real_t turned_rad = gw_rate_filter_turned(constants, gw_count_difference(count, filter->last_count),
                                                           torque_nm - filter->last_torque_nm);
        const gw_real_t input = turned_rad / constants->period_s;
        /* Exact step of y'' = w^2 (u - y) - 2 w y' with u held. */
        const gw_real_t error = filter->rate_radps - input;
        const gw_real_t mixed = filter->derivative_radps2 + (constants->cutoff_radps * error);
        const gw_real_t derivative =
            constants->decay * (filter->derivative_radps2 - ((constants->cutoff_radps * constants->period_s) * mixed));
        filter->rate_radps =
            gw_limited(input + (constants->decay * (error + (constants->period_s * mixed))), GW_RATE_MAX);
        filter->derivative_radps2 = gw_limited(derivative, GW_RATE_DERIVATIVE_MAX);
    }
    filter->last_count = count;
    filter->last_torque_nm = torque_nm;
    filter->started = true;
}

bool gw_rate_filter_invariant_holds(const gw_rate_filter_t *filter);

#ifdef __cplusplus
}
#endif

#endif
