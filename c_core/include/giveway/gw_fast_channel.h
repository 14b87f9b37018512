/* The fast channel of the detector: impacts.
 *
 * A baseline follows the balance of forces slowly, so friction, inertia and zeros that are wrong slowly do not matter.
 * The change from the baseline, less what is known of friction and mass, passes a bank of low-passes, short ones for
 * hard impacts and long ones for soft ones; the third is of second order and swings a little, which lets pulses of 10
 * to 30 ms pass it sooner. Each is compared with a covariance
 *
 *     S = (k_n^2 noise + floor^2 + r^2) I + k_m^2 M + h h^T
 *
 * where the noise of each low-pass is followed, with a little ripple of rollers that are not alike, and k_n is smaller
 * for the longer ones, M is what the model does not know of friction, rollers and mass with the forces of this tick,
 * and h is what the baseline holds of contacts that last: their end, a change against that, is no hit, and as it may
 * have turned, (x h)^2/|x|^2 I is added then, too; r is what the body does while it rocks, and in motion, where rollers
 * each have all of their friction, how the robot rings as a wheel that was stuck lets go: to any side, for 30 ms. The
 * moment has a variance of its own: in a turn a wheel's speed steps as it passes from one row of rollers to the other,
 * which encoders take for an acceleration. The channel trips if x^T S^-1 x > 1.
 *
 * With an IMU the noise is smaller and the shortest low-pass shorter. The vibration that it sees counts at once.
 *
 * Life cycle: gw_fast_channel_init, gw_fast_channel_restart, gw_fast_channel_begin for each tick of the first mean,
 * then gw_fast_channel_step per tick. All members of gw_fast_channel_t are private.
 */
#ifndef GW_FAST_CHANNEL_H
#define GW_FAST_CHANNEL_H

#include "giveway/gw_balance.h"
#include "giveway/gw_channels_config.h"
#include "giveway/gw_doubts.h"
#include "giveway/gw_follower.h"
#include "giveway/gw_kinematics.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GW_BANK_COUNT 4U
/* Where the acceleration in the balance comes from: noise and bank of their own. */
#define GW_BY_ENCODERS 0U
#define GW_BY_IMU 1U
#define GW_SENSOR_COUNT 2U
/* Largest change from the baseline, N and N m: two balances and what the follower corrects. */
#define GW_CHANGE_MAX ((gw_real_t)1.0e6)
#define GW_NOISE_SETS 3U /* at rest, slow or unsettled, in motion: as gw_regime_t */

typedef struct {
    gw_real_t bank_share[GW_SENSOR_COUNT][GW_BANK_COUNT];
    gw_real_t baseline_share;
    gw_real_t model_share;
    gw_real_t noise_share;
    gw_real_t held_keep;
    gw_real_t swing_share;         /* (w T)^2 of the low-pass of second order */
    gw_real_t swing_loss;          /* 2 zeta w T */
    gw_real_t sliding_n;           /* friction of a wheel whose rollers slide */
    gw_real_t moment_per_force_m2; /* variance of the moment's noise over that of the force's, of wheels that turn
                                      independently */
    gw_real_t gyro_noise_nm2[GW_SENSOR_COUNT][GW_BANK_COUNT]; /* what a gyro adds to that of the moment */
    gw_real_t least_noise_n2[GW_SENSOR_COUNT][GW_NOISE_SETS][GW_BANK_COUNT];
    gw_real_t noise_n2[GW_SENSOR_COUNT][GW_NOISE_SETS][GW_BANK_COUNT];
    gw_real_t count_n2[GW_BANK_COUNT];   /* what counts add that are taken as they are */
    gw_real_t counted;                   /* how many times of it now */
    gw_real_t row_kg2ps2[GW_BANK_COUNT]; /* variance of the force that steps between rows of rollers look like, over the
                                          * square of such a step */
    gw_real_t mass2_kg2;
    gw_real_t shaking_n2; /* the vibration that an IMU sees, as a force */
    uint32_t sensor;      /* GW_BY_ENCODERS or GW_BY_IMU */
    gw_balance_t baseline;
    gw_model_forces_t model; /* their change, smoothed */
    gw_wrench_t bank[GW_BANK_COUNT];
    gw_wrench_t swing;               /* what the low-pass of second order moves in a tick */
    gw_planar_covariance_t model_n2; /* k_m^2 M */
    gw_real_t moment_nm2;            /* likewise of the moment */
    gw_real_t rocking_n2;            /* variance of what the rocking body does */
    gw_real_t letting_go_n2;         /* square of what a stuck wheel may let go, times the share that is usual */
    gw_real_t row_m2ps2;             /* square of a step between rows, as encoders see it now */
    gw_real_t moment_noise_m2; /* variance of the moment's noise over that of the force's, as the wheels turn now */
    /* What the baseline holds of contacts, how sure nobody is of that, along the last one, and the share of the
     * baseline's motion that is put down to them. All fade after a contact. */
    gw_wrench_t held;
    gw_vector_t doubt_n;
    gw_real_t held_share;
    /* The force of an old contact in the baseline as it is now: what was left of it, and what the baseline has followed
     * of its growth and its end. Zero once that points to the other side. */
    gw_vector_t carried_n;
    uint32_t followed; /* the low-pass whose noise is followed in this tick */
} gw_fast_channel_t;

/* What the channel finds in a tick. */
typedef struct {
    gw_wrench_t change;   /* from the baseline, corrected */
    gw_real_t statistic;  /* x^T S^-1 x of the low-pass that has the largest */
    uint32_t widest;      /* which it is */
    gw_real_t release;    /* the same of the low-pass that decides on the end of a contact, with a floor of its own */
    gw_real_t release_n2; /* variance there, along the axes, without M */
} gw_fast_found_t;

/* Time constant of a low-pass of the bank that is used now, s; j < GW_BANK_COUNT. Pointer not NULL. */
gw_real_t gw_fast_channel_time(const gw_fast_channel_t *channel, uint32_t j);
/* The configuration was checked. Pointers not NULL here and below. */
GW_SMALL void gw_fast_channel_init(gw_fast_channel_t *channel, const gw_channels_config_t *config,
                                   const gw_channels_noise_t *noise);
/* Forgets the balance and the last contact, keeps what was learned of the noise. */
GW_SMALL void gw_fast_channel_restart(gw_fast_channel_t *channel);
bool gw_fast_channel_invariant_holds(const gw_fast_channel_t *channel);
/* A tick of the baseline's first mean: share is 1/(n + 1) in the n-th. */
GW_SMALL void gw_fast_channel_begin(gw_fast_channel_t *channel, const gw_balance_t *balance, gw_real_t share);
/* The acceleration in the next balances comes from an IMU that sees this vibration, (m/s2)^2, or from encoders. */
void gw_fast_channel_feel(gw_fast_channel_t *channel, bool felt, gw_real_t shaking_mps2_2);
/* Before each step: variance of what counts add, over that of unobserved motors, [0, 2]. */
void gw_fast_channel_count(gw_fast_channel_t *channel, gw_real_t counted);
/* What the model may be wrong by from now on; every second tick is enough. */
void gw_fast_channel_doubt(gw_fast_channel_t *channel, const gw_channels_config_t *config,
                           const gw_kinematics_t *kinematics, const gw_follower_t *follower,
                           const gw_balance_t *balance, gw_regime_t regime, const gw_doubts_t *doubts);
/* Is the force below this share of the smallest that counts at rest, squared? */
bool gw_fast_channel_is_calm(const gw_fast_channel_t *channel, const gw_channels_config_t *config, gw_real_t share);
/* One tick, in a regime. quiet: nothing touches, the noise may be followed. */
void gw_fast_channel_step(gw_fast_channel_t *channel, const gw_channels_config_t *config,
                          const gw_kinematics_t *kinematics, const gw_follower_t *follower, const gw_balance_t *balance,
                          gw_regime_t regime, bool quiet, gw_fast_found_t *found);
/* Moves the baseline towards this balance. */
void gw_fast_channel_follow(gw_fast_channel_t *channel, const gw_balance_t *balance);
/* Another zero: the residual jumps by this. adopt: what the widest low-pass holds becomes part of the baseline. */
GW_SMALL void gw_fast_channel_take_zero(gw_fast_channel_t *channel, gw_wrench_t step, bool adopt);
/* A contact in this direction, a unit vector or zero, is over, or it lasts so long that the next one is waited for:
 * what is left of it becomes part of the baseline, and is held against its end: along the direction, or all if it
 * lasts. */
GW_SMALL void gw_fast_channel_release(gw_fast_channel_t *channel, const gw_balance_t *balance,
                                      const gw_fast_found_t *found, gw_vector_t direction, bool lasts);

#ifdef __cplusplus
}
#endif

#endif
