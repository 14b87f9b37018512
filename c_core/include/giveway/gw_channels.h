/* Two-channel detector: a fast channel for impacts and a slow one for pushes, with thresholds from what the model does
 * not know.
 *
 * Each compares a force with its covariance and trips if x^T S^-1 x > 1: gw_fast_channel.h, gw_slow_channel.h. What is
 * wrong about friction and mass is followed while nothing touches: gw_follower.h.
 *
 * From a trip to the end of the contact the baseline stands still: the contact force is the difference from it. The
 * contact is over when that has stayed within its uncertainty for 40 ticks; after rearm_ticks the detector is armed in
 * any case. The mean wrench of the hit is refined for GW_REFINE_TICKS after the trip. When the acceleration has another
 * sensor the baseline begins anew, unless a contact lasts.
 *
 * A robot that has stopped swings on its springs: the thresholds of rest hold once it has been calm for 250 ticks,
 * until then those of motion. The body of one that may lean rocks after every change of its acceleration and after
 * every contact: that adds r^2 I to the covariances, r a share of the change of M a, or of the contact's force, which
 * fades. When it swings back the wheels feel a force against the contact, which no contact makes: that counts more. The
 * end of a contact waits for the rocking.
 *
 * Life cycle: gw_channels_init, gw_channels_step per tick, gw_channels_restart or gw_channels_resume after a gap. All
 * members are private.
 */
#ifndef GW_CHANNELS_H
#define GW_CHANNELS_H

#include "giveway/gw_balance.h"
#include "giveway/gw_channels_config.h"
#include "giveway/gw_config.h"
#include "giveway/gw_fast_channel.h"
#include "giveway/gw_follower.h"
#include "giveway/gw_kinematics.h"
#include "giveway/gw_ripple.h"
#include "giveway/gw_slow_channel.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GW_CHANNEL_NONE 0U
#define GW_CHANNEL_FAST 1U
#define GW_CHANNEL_SLOW 2U

#define GW_REFINE_TICKS 60U

typedef struct {
    /* Residual of the force balance in this tick, and the model's forces in it; not NULL. */
    const gw_wrench_t *wrench;
    const gw_model_forces_t *forces;
    /* Another zero is used from this tick on, and the residual jumped by this; not NULL. */
    bool zero_changed;
    const gw_wrench_t *zero_step;
    gw_regime_t regime;
    /* An encoder has moved. */
    bool turned;
    /* Variance of what encoder counts add to the residual, over that of unobserved motors, [0, 2]: gw_motor.h. */
    gw_real_t counted;
    /* False: hits are not looked for. */
    bool enabled;
    /* The robot gives way. */
    bool reacting;
    /* The acceleration in the balance comes from an IMU, which sees this vibration, (m/s2)^2. */
    bool felt;
    gw_real_t shaking_mps2_2;
    /* Variance of a component of the force, from what gears may be wrong by, N^2, [0, 1e12]. */
    gw_real_t gear_n2;
    /* Measured, each component at most 1e9; not NULL. */
    const gw_twist_t *twist;
    /* Torques of the wheels, N m, each at most GW_TORQUE_MAX; not NULL. */
    const gw_wheels_t *torque_nm;
} gw_channels_input_t;

typedef struct {
    bool tripped;
    bool active;
    /* The mean wrench still becomes better; it has become better in this tick. */
    bool refining;
    bool refined;
    uint32_t channel; /* that tripped last */
    /* Root of x^T S^-1 x, the larger of both channels; trips above 1. */
    gw_real_t statistic;
    gw_wrench_t mean_wrench; /* kept until the next contact */
    /* What to give way to, kept likewise: the force of the mean wrench, or, where it is against a contact that the
     * baseline still holds, what is left of both; zero if that is little: then a push has ended. */
    gw_vector_t push_n;
    gw_vector_t force_n; /* difference from the baseline in this tick */
} gw_channels_output_t;

typedef struct {
    gw_channels_config_t config;
    gw_real_t period_s;
    gw_follower_t follower;
    gw_fast_channel_t fast;
    gw_slow_channel_t slow;
    gw_doubts_t doubts;
    gw_ripple_t ripple;
    gw_real_t rocking2; /* square of config.rocking; 0 if the robot cannot lean */
    gw_real_t rocking_keep;
    gw_real_t gear_keep;
    gw_wrench_t impulse; /* N s, N m s */
    uint32_t summed;     /* the low-pass whose forces are its impulse */
    gw_real_t impulse_s;
    bool began_in_motion; /* the contact did: the robot did not rest */
    uint32_t tick;        /* counts the ticks of the tasks that not every tick has */
    uint32_t ticks_since_trip;
    uint32_t ticks_since_release;
    uint32_t ticks_of_motion;
    uint32_t ticks_without_turn;
    uint32_t calm_ticks; /* at rest after a motion, or all that is asked for */
    uint32_t quiet_ticks;
    uint32_t warm_up_ticks;
    uint32_t channel;
    bool active;
} gw_channels_t;

/* The configuration was checked. Pointers not NULL here and below. */
GW_SMALL void gw_channels_init(gw_channels_t *channels, const gw_channels_config_t *config,
                               const gw_channels_noise_t *noise);
bool gw_channels_invariant_holds(const gw_channels_t *channels);
/* After gw_channels_init: the robot cannot lean, its body does not rock. */
GW_SMALL void gw_channels_stand_firm(gw_channels_t *channels);
/* Forgets signals and contact, keeps what was learned of the model and of the noise. */
GW_SMALL void gw_channels_restart(gw_channels_t *channels);
/* After a gap in the samples: as gw_channels_restart, unless a contact lasted before it. That one goes on until its
 * end: a baseline that began within it would take its end for a hit from the other side. */
GW_SMALL void gw_channels_resume(gw_channels_t *channels);
/* A contact has just begun, and of a robot that may lean only the encoders tell: above the centre of percussion a hit
 * throws the wheels towards what hits. */
bool gw_channels_are_unsure(const gw_channels_t *channels);
/* Nothing else was due in this tick: time for what not every tick needs. */
bool gw_channels_have_time(const gw_channels_t *channels);
/* One tick. The wrench is valid. */
void gw_channels_step(gw_channels_t *channels, const gw_kinematics_t *kinematics, const gw_channels_input_t *input,
                      gw_channels_output_t *output);

#ifdef __cplusplus
}
#endif

#endif
