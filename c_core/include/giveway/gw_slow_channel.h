/* The slow channel of the detector: pushes.
 *
 * The balance of forces, behind a low-pass and less what is known of friction and mass, is compared with a baseline of
 * seconds: at rest that is what was there when the zero was taken, in motion it follows slowly, so that a slope and a
 * zero that is wrong do not matter. S = floor^2 I + k_m^2 M, as in gw_fast_channel.h; at rest the floor alone. Friction
 * of rollers that hardly turn lasts longer than the channel's low-pass, which nothing but its size tells from a push:
 * it is doubted twice as much as in the fast channel. Of rollers that each have all of their friction half the variance
 * that is usual for them passes the low-pass. It trips if x^T S^-1 x > 1.
 *
 * Life cycle: gw_slow_channel_init, gw_slow_channel_restart, gw_slow_channel_begin for each tick of the first mean,
 * then gw_slow_channel_step per tick. All members of gw_slow_channel_t are private.
 */
#ifndef GW_SLOW_CHANNEL_H
#define GW_SLOW_CHANNEL_H

#include "giveway/gw_balance.h"
#include "giveway/gw_channels_config.h"
#include "giveway/gw_doubts.h"
#include "giveway/gw_follower.h"
#include "giveway/gw_kinematics.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GW_SLOW_TICKS 4U

typedef struct {
    gw_real_t share;
    gw_real_t sliding_n; /* friction of a wheel whose rollers slide */
    gw_balance_t mean;
    gw_real_t settled_share; /* of the baseline, between two calls of gw_slow_channel_follow */
    gw_real_t unsettled_share;
    gw_balance_t baseline;
    gw_vector_t force_n;
    gw_real_t statistic;
} gw_slow_channel_t;

/* The configuration was checked. Pointers not NULL here and below. */
GW_SMALL void gw_slow_channel_init(gw_slow_channel_t *channel, const gw_channels_config_t *config,
                                   const gw_channels_noise_t *noise);
GW_SMALL void gw_slow_channel_restart(gw_slow_channel_t *channel);
bool gw_slow_channel_invariant_holds(const gw_slow_channel_t *channel);
/* A tick of the first mean: share is 1/(n + 1) in the n-th. */
GW_SMALL void gw_slow_channel_begin(gw_slow_channel_t *channel, const gw_balance_t *balance, gw_real_t share);
void gw_slow_channel_step(gw_slow_channel_t *channel, const gw_balance_t *balance);
/* Another zero: the residual jumps by this. At rest what the channel holds now becomes the baseline. */
GW_SMALL void gw_slow_channel_take_zero(gw_slow_channel_t *channel, gw_wrench_t step, gw_regime_t regime);
/* The baseline follows, in motion without contact; to be called every GW_SLOW_TICKS. */
void gw_slow_channel_follow(gw_slow_channel_t *channel, bool settled);
/* Compares; every few ticks is enough. floor: of which regime the floor is. */
void gw_slow_channel_judge(gw_slow_channel_t *channel, const gw_channels_config_t *config,
                           const gw_kinematics_t *kinematics, const gw_follower_t *follower, gw_regime_t floor,
                           const gw_doubts_t *doubts);
/* The follower learns from the mean balance, in motion without contact, when all rollers slide: from its component
 * along y or along x. */
GW_SMALL void gw_slow_channel_teach(const gw_slow_channel_t *channel, const gw_kinematics_t *kinematics,
                                    gw_follower_t *follower, bool along_y);

#ifdef __cplusplus
}
#endif

#endif
