/* Configuration of the two-channel detector, gw_channels.h. */
#ifndef GW_CHANNELS_CONFIG_H
#define GW_CHANNELS_CONFIG_H

#include "giveway/gw_config.h"
#include "giveway/gw_follower.h"
#include "giveway/gw_imu.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A force for each regime, N. */
typedef struct {
    gw_real_t rest_n;
    gw_real_t creep_n;
    gw_real_t motion_n;
} gw_force_floors_t;

typedef struct {
    /* How many standard deviations of noise, and of what the follower does not know, a contact must exceed, [1, 100]
     * and [0, 100]. With encoders the longer low-passes take 0.89 of the first. */
    gw_real_t noise_multiple;
    gw_real_t model_multiple;
    /* The first of them with an IMU, whose noise has no tails as that of counts has, [1, 100]. */
    gw_real_t imu_noise_multiple;
    /* Time constants of the baseline, s, [0.01, 10], and of the slow channel, s, [0.005, 10]. */
    gw_real_t baseline_s;
    gw_real_t slow_s;
    /* Time constant of the slow channel's baseline in motion, s, [0.01, 100]. */
    gw_real_t slow_baseline_s;
    /* Error of the friction's course that no factor explains, relative, [0, 1]. */
    gw_real_t friction_shape;
    /* Error of the friction of rollers that hardly turn, as a share of what is missing to full sliding, [0, 1]. */
    gw_real_t presliding;
    /* What the configuration may be wrong by: yaw inertia, relative, [0, 1]; centre of mass, m, [0, 1]. */
    gw_real_t yaw_inertia;
    gw_real_t centre_of_mass_m;
    /* Arm of the wheels' forces that changes with the row of rollers, m, [0, 0.1]. */
    gw_real_t lever_m;
    /* What the body of a robot that may lean pushes and pulls while it rocks, as a share of the force that made it
     * rock, [0, 10], and the time constant with which that fades, s, [0.01, 10]. */
    gw_real_t rocking;
    gw_real_t rocking_s;
    /* Coefficient of friction between a wheel and the floor where it rolls, [0, 10]; 0: no wheel ever slips. */
    gw_real_t grip;
    /* What a wheel's friction varies by from roller to roller, until that has been followed, relative, [0, 1]. */
    gw_real_t ripple;
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

/* What decides how noisy the residual is. */
typedef struct {
    gw_real_t period_s;
    gw_real_t cutoff_radps;
    gw_real_t encoder_step_m;  /* of the floor under a wheel */
    gw_real_t observed_step_m; /* the same while the motors are observed between the counts */
    gw_real_t twist_noise_m;   /* torque noise over the drivetrain's stiffness, at the floor */
    gw_real_t force_noise_n;   /* torque noise in one component of the force */
    gw_real_t sliding_n;       /* friction of a wheel whose rollers slide */
    gw_real_t mass_kg;
    gw_real_t yaw_inertia_kgm2;
    gw_real_t wheel_distance_m;
    gw_imu_noise_t imu; /* instead of what the encoders add, while it is used */
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

/* What a low-pass takes over of its input in an interval; at most 0.5, so a time constant is no shorter than 1.44
 * intervals. */
GW_SMALL gw_real_t gw_share_of(gw_real_t interval_s, gw_real_t time_s);
/* The values of Trikey, the paper's robot. Pointers not NULL in these two. */
void gw_channels_config_trikey(gw_channels_config_t *config);
GW_SMALL void gw_channels_config_check(const gw_channels_config_t *config, gw_config_error_t *error);

#ifdef __cplusplus
}
#endif

#endif
