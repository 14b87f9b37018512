#include "giveway/gw_slow_channel.h"

#include "giveway/gw_math.h"
#include "giveway/gw_model_covariance.h"
#include "giveway/gw_planar_covariance.h"
#include "giveway/gw_ripple.h"

#if (GW_WITH_CHANNELS == 1)

/* Of the baseline at the beginning of a motion. */
#define UNSETTLED_TIME_S ((gw_real_t)0.5)
/* Times what the fast channel makes of rollers that hardly turn. */
#define PRESLIDING_DOUBT GW_TWO
/* Of the variance that is usual for rollers that each have all of their friction. With a quarter of it an alarm of this
 * channel stays in 1,520 s of a second simulator's drives, with this none; without 7. */
#define USUAL_SHARE GW_HALF
/* Residual and correction. */
#define FORCE_MAX_N ((gw_real_t)1.0e6)

void gw_slow_channel_init(gw_slow_channel_t *channel, const gw_channels_config_t *config,
                          const gw_channels_noise_t *noise)
{
    channel->share = gw_share_of(noise->period_s, config->slow_s);
    const gw_real_t interval_s = noise->period_s * (gw_real_t)GW_SLOW_TICKS;
    channel->settled_share = gw_share_of(interval_s, config->slow_baseline_s);
    channel->unsettled_share = gw_share_of(interval_s, UNSETTLED_TIME_S);
    channel->sliding_n = gw_min(noise->sliding_n, GW_BALANCE_MAX);
    gw_slow_channel_restart(channel);
}

void gw_slow_channel_restart(gw_slow_channel_t *channel)
{
    static const gw_balance_t no_balance = {0};
    static const gw_vector_t no_force = {0};
    channel->mean = no_balance;
    channel->baseline = no_balance;
    channel->force_n = no_force;
    channel->statistic = GW_ZERO;
}

bool gw_slow_channel_invariant_holds(const gw_slow_channel_t *channel)
{
    return (channel != NULL) && gw_in_range(channel->share, GW_ZERO, GW_HALF) &&
           gw_in_range(channel->sliding_n, GW_ZERO, GW_BALANCE_MAX) &&
           gw_in_range(channel->settled_share, GW_ZERO, GW_HALF) &&
           gw_in_range(channel->unsettled_share, GW_ZERO, GW_HALF) &&
           gw_balance_is_within(&channel->mean, GW_BALANCE_MAX) &&
           gw_balance_is_within(&channel->baseline, GW_BALANCE_MAX) && gw_within(channel->force_n.x, FORCE_MAX_N) &&
           gw_within(channel->force_n.y, FORCE_MAX_N) && gw_in_range(channel->statistic, GW_ZERO, GW_DISTANCE_MAX);
}

void gw_slow_channel_begin(gw_slow_channel_t *channel, const gw_balance_t *balance, gw_real_t share)
{
    gw_balance_approach(&channel->mean, balance, share);
}

void gw_slow_channel_step(gw_slow_channel_t *channel, const gw_balance_t *balance)
{
    gw_balance_approach(&channel->mean, balance, channel->share);
}

void gw_slow_channel_take_zero(gw_slow_channel_t *channel, gw_wrench_t step, gw_regime_t regime)
{
    channel->mean.residual = gw_balance_sum(channel->mean.residual, step);
    if (regime == GW_REGIME_REST) {
        channel->baseline = channel->mean;
    } else {
        channel->baseline.residual = gw_balance_sum(channel->baseline.residual, step);
    }
}

void gw_slow_channel_follow(gw_slow_channel_t *channel, bool settled)
{
    gw_balance_approach(&channel->baseline, &channel->mean,
                        settled ? channel->settled_share : channel->unsettled_share);
}

void gw_slow_channel_judge(gw_slow_channel_t *channel, const gw_channels_config_t *config,
                           const gw_kinematics_t *kinematics, const gw_follower_t *follower, gw_regime_t floor,
                           const gw_doubts_t *doubts)
{
    const gw_balance_t change = gw_balance_difference(&channel->mean, &channel->baseline);
    const gw_vector_t correction = gw_follower_correction(follower, kinematics, &change.model);
    gw_planar_covariance_t model_n2 = {GW_ZERO, GW_ZERO, GW_ZERO};
    channel->force_n.x = change.residual.force_x_n + correction.x;
    channel->force_n.y = change.residual.force_y_n + correction.y;
    if (floor != GW_REGIME_REST) {
        model_n2 = gw_model_covariance(config, kinematics, follower, &change.model, &channel->mean.model,
                                       channel->sliding_n, PRESLIDING_DOUBT * config->presliding);
        model_n2 = gw_ripple_added(USUAL_SHARE * doubts->usual2, kinematics, &channel->mean.model.friction_n, model_n2);
    }
    const gw_real_t floor_n = gw_force_floor(config->slow, floor);
    const gw_planar_spread_t spread =
        gw_planar_spread(gw_planar_raised(model_n2, doubts->rocking_n2 + doubts->gear_n2));
    channel->statistic = gw_planar_distance(&spread, floor_n * floor_n, channel->force_n);
}

void gw_slow_channel_teach(const gw_slow_channel_t *channel, const gw_kinematics_t *kinematics, gw_follower_t *follower,
                           bool along_y)
{
    /* cppcheck-suppress misra-c2012-9.3 ; DEV-01 a whole struct from a call */
    const gw_regressors_t regressors = gw_follower_regressors(kinematics, &channel->mean.model);
    const gw_vector_t residual_n = {channel->mean.residual.force_x_n, channel->mean.residual.force_y_n};
    gw_follower_learn(follower, &regressors, residual_n, along_y);
}

#endif
