/* Two-channel detector: a fast channel for impacts and a slow one for pushes, with thresholds from what the model does
 * not know.
 *
 * Fast: a baseline follows the residual of the force balance slowly, so friction, inertia and zeros that are wrong
 * slowly do not matter. The difference from the baseline passes a bank of low-passes, short ones for hard impacts and
 * long ones for soft ones. Slow: the residual itself, after a low-pass.
 *
 * Each is compared with its covariance: S = k_n^2 noise + k_m^2 (what the follower does not know of friction and mass,
 * through the same filters) + floor^2. It trips if x^T S^-1 x > 1. The noise of each low-pass is followed, too.
 *
 * From a trip to the end of the contact the baseline stands still: the contact force is the difference from it. The
 * contact is over when that has stayed within its uncertainty for 40 ticks; after rearm_ticks the detector is armed in
 * any case. What then is left of the contact, or could be, may end later without being taken for a hit from the other
 * side. The mean wrench of the hit is refined for
 * GW_REFINE_TICKS after the trip.
 *
 * Life cycle: gw_channels_init, gw_channels_step per tick, gw_channels_restart after a gap. All members are private.
 */
#ifndef GW_CHANNELS_H
#define GW_CHANNELS_H

#include "giveway/gw_config.h"
#include "giveway/gw_follower.h"
#include "giveway/gw_kinematics.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GW_CHANNEL_NONE 0U
#define GW_CHANNEL_FAST 1U
#define GW_CHANNEL_SLOW 2U

#define GW_BANK_COUNT 4U
#define GW_NOISE_SETS 3U /* at rest, slow or unsettled, in motion: as gw_regime_t */
#define GW_REFINE_TICKS 60U

/* Signals that pass every filter: force x, y and moment of the residual; friction of each wheel; inertial force x, y
 * and moment. */
#define GW_SIGNAL_FRICTION 3U
#define GW_SIGNAL_INERTIA (GW_SIGNAL_FRICTION + GW_WHEEL_COUNT)
#define GW_SIGNAL_COUNT (GW_SIGNAL_INERTIA + 3U)

typedef struct {
    gw_real_t value[GW_SIGNAL_COUNT];
} gw_signals_t;

/* A force for each regime, N. */
typedef struct {
    gw_real_t rest_n;
    gw_real_t creep_n;
    gw_real_t motion_n;
} gw_force_floors_t;

typedef struct {
    /* How many standard deviations of noise, and of what the follower does not know, a contact must exceed, [1, 100]
     * and [0, 100]. */
    gw_real_t noise_multiple;
    gw_real_t model_multiple;
    /* Time constants of the baseline, s, [0.01, 10], and of the slow channel, s, [0.005, 10]. */
    gw_real_t baseline_s;
    gw_real_t slow_s;
    /* Error of the friction's course that no factor explains, relative, [0, 1]. */
    gw_real_t friction_shape;
    /* What the configuration may be wrong by: yaw inertia, relative, [0, 1]; centre of mass, m, [0, 1]. */
    gw_real_t yaw_inertia;
    gw_real_t centre_of_mass_m;
    /* Arm of the wheels' forces that changes with the row of rollers, m, [0, 0.1]. */
    gw_real_t lever_m;
    /* Smallest force of the fast channel and of the slow one, in each regime, N, [0.01, 1000]. */
    gw_force_floors_t fast;
    gw_force_floors_t slow;
    /* Time for which the robot counts as unsettled after a contact or after creeping, ticks, [0, 100000]. */
    uint32_t settle_ticks;
    /* Shortest time from a trip to the next, ticks, [1, 100000]. */
    uint32_t lock_ticks;
    /* Time from a trip after which the detector is armed again even if the contact lasts, ticks, [1, 100000]. */
    uint32_t rearm_ticks;
    gw_follower_config_t follower;
} gw_channels_config_t;

typedef struct {
    /* Residual of the force balance in this tick, and by how much it jumped because another zero is used from now. */
    gw_wrench_t wrench;
    gw_wrench_t zero_step;
    gw_model_forces_t forces;
    gw_real_t inertia_moment_nm;
    gw_regime_t regime;
    /* An encoder has moved. */
    bool turned;
    /* False: hits are not looked for. */
    bool enabled;
    /* The robot gives way. */
    bool reacting;
    /* The reaction is over: a push that still lasts may trip again. */
    bool reaction_over;
} gw_channels_input_t;

typedef struct {
    bool tripped;
    bool active;
    /* The mean wrench still becomes better. */
    bool refining;
    uint32_t channel; /* that tripped last */
    /* Root of x^T S^-1 x, the larger of both channels; trips above 1. */
    gw_real_t statistic;
    gw_wrench_t mean_wrench;
} gw_channels_output_t;

typedef struct {
    gw_channels_config_t config;
    gw_follower_t follower;
    gw_real_t period_s;
    gw_real_t bank_share[GW_BANK_COUNT];
    gw_real_t baseline_share;
    gw_real_t slow_share;
    gw_real_t noise_share;
    gw_real_t held_share;
    gw_real_t moment_per_force_m2; /* variance of the moment's noise over that of the force's */
    gw_real_t least_noise_n2[GW_NOISE_SETS][GW_BANK_COUNT];
    gw_real_t noise_n2[GW_NOISE_SETS][GW_BANK_COUNT];
    gw_signals_t baseline;
    gw_signals_t bank[GW_BANK_COUNT];
    gw_signals_t slow;
    gw_vector_t slow_zero_n;
    gw_vector_t held_n; /* what the baseline may still hold of the last contact: its end is no hit */
    gw_wrench_t impulse; /* N s, N m s */
    gw_real_t impulse_s;
    uint32_t ticks_since_trip;
    uint32_t ticks_since_release;
    uint32_t ticks_of_motion;
    uint32_t ticks_without_turn;
    uint32_t quiet_ticks;
    uint32_t warm_up_ticks;
    uint32_t learn_ticks;
    uint32_t channel;
    bool active;
} gw_channels_t;

/* What decides how noisy the residual is. */
typedef struct {
    gw_real_t period_s;
    gw_real_t cutoff_radps;
    gw_real_t encoder_step_m; /* of the floor under a wheel */
    gw_real_t twist_noise_m;  /* torque noise over the drivetrain's stiffness, at the floor */
    gw_real_t force_noise_n;  /* torque noise in one component of the force */
    gw_real_t mass_kg;
    gw_real_t yaw_inertia_kgm2;
    gw_real_t wheel_distance_m;
} gw_channels_noise_t;

/* The force that holds in a regime. */
static inline gw_real_t gw_force_floor(gw_force_floors_t floors, gw_regime_t regime)
{
    gw_real_t floor_n = floors.creep_n;
    if (regime == GW_REGIME_REST) {
        floor_n = floors.rest_n;
    } else if (regime == GW_REGIME_MOTION) {
        floor_n = floors.motion_n;
    } else {
        /* creeping */
    }
    return floor_n;
}

/* The values of Trikey, the paper's robot. Pointers not NULL in these two. */
void gw_channels_config_trikey(gw_channels_config_t *config);
void gw_channels_config_check(const gw_channels_config_t *config, gw_config_error_t *error);
/* The configuration was checked. Pointers not NULL here and below. */
void gw_channels_init(gw_channels_t *channels, const gw_channels_config_t *config, const gw_channels_noise_t *noise);
bool gw_channels_invariant_holds(const gw_channels_t *channels);
/* Forgets signals and contact, keeps what was learned of the model and of the noise. */
void gw_channels_restart(gw_channels_t *channels);
/* One tick. The wrench is valid. */
void gw_channels_step(gw_channels_t *channels, const gw_kinematics_t *kinematics, const gw_channels_input_t *input,
                      gw_channels_output_t *output);

#ifdef __cplusplus
}
#endif

#endif
