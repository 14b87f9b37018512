/* The motion that gives way, (1)-(4), in the world frame.
 *
 * Frozen impulse: at a hit the robot aims at x_inf = x + (p/B) u and goes there as v = (B/M) (x_inf - x): without
 * limits exactly (2) with p as the impulse; with limits it still ends at exactly p/B. The last part is covered at the
 * finish speed, because the exponential tail of (2) would keep the robot creeping for seconds.
 * Live force: (1), M v' + B v = F, with the force of each tick.
 * Escape: the frozen impulse for a robot that must neither rock nor press. Its velocity never turns against the push:
 * one that it had is braked, and a goal that it has passed moves on. Two low-passes keep the acceleration from exciting
 * the robot on its wheels. As long as it moves towards what it hit it brakes at once and harder: what is clamped is in
 * more danger than the wheels, and the push holds those down that braking lifts. The first two are exact for an input
 * held over the tick. Speed and acceleration vectors are limited in length, and the acceleration by gw_tip.
 *
 * Life cycle: gw_admittance_init; gw_admittance_start at a hit; gw_admittance_step per tick. All members are private.
 */
#ifndef GW_ADMITTANCE_H
#define GW_ADMITTANCE_H

#include "giveway/gw_config.h"
#include "giveway/gw_sum.h"
#include "giveway/gw_tip.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

#define GW_ADMITTANCE_FROZEN_IMPULSE 0U
#define GW_ADMITTANCE_LIVE_FORCE 1U
#define GW_ADMITTANCE_ESCAPE 2U

typedef struct {
    /* GW_ADMITTANCE_FROZEN_IMPULSE (0), GW_ADMITTANCE_LIVE_FORCE (1) or GW_ADMITTANCE_ESCAPE (2). */
    uint32_t kind;
    /* M_des, kg, [0.01, 10000]. */
    gw_real_t mass_kg;
    /* B_des, N s/m, [0.01, 10000]. */
    gw_real_t damping_newton_s_per_m;
    /* p, N s, [0, 1000]. */
    gw_real_t escape_impulse_newton_s;
    /* Longest velocity, m/s, [0.001, 10]. */
    gw_real_t speed_limit_mps;
    /* Longest acceleration, m/s^2, [0.001, 1000]. */
    gw_real_t acceleration_limit_mps2;
    /* Frozen impulse and escape: slowest speed towards the goal, m/s, [0, 1]; 0: the endless tail of (2). */
    gw_real_t finish_speed_mps;
#if (GW_WITH_ESCAPE == 1)
    /* Escape: time constant of each of the two low-passes of the velocity, s, [0, 1]. */
    gw_real_t smoothing_s;
    /* Escape: deceleration past the low-passes, m/s^2, [0, 1000]: of a velocity towards a push as long as it is felt,
     * and of one that waits for the robot. */
    gw_real_t brake_limit_mps2;
    /* Reaction of any kind: this time, s, [0, 0.2], times the acceleration is added to the commanded speeds, at most
     * the speed limit in each component. The inertia that a wheel moves over the servo's kd lets the robot follow
     * without lag. */
    gw_real_t lead_s;
    /* Escape: as long as a push is felt, the acceleration away from it grows by this share, [0, 5], of what the push
     * would give a free robot of its mass. */
    gw_real_t push_share;
    /* Escape: the velocity is at most this, m/s, [0, 10], above the robot's along the push as soon as that is not felt
     * any more; 0: however much. A servo that has to catch up pulls harder than tipping allows. */
    gw_real_t ahead_mps;
    gw_tip_config_t tip;
#endif
} gw_admittance_config_t;

#define GW_SMOOTH_COUNT 2U

typedef struct {
    gw_admittance_config_t config;
    gw_real_t period_s;
    gw_real_t decay;      /* e^(-B T/M) */
    gw_real_t approach;   /* 1 - decay, without cancellation */
    gw_real_t rate_per_s; /* B/M */
    gw_vector_t goal_m;   /* displacement aimed at since the start */
    gw_sum_t moved_x_m;   /* displacement made since the start */
    gw_sum_t moved_y_m;
    gw_vector_t velocity_mps;
#if (GW_WITH_ESCAPE == 1)
    gw_tip_t tip;
    gw_rotation_t yaw;      /* of the base */
    gw_vector_t away;       /* direction of the hit, */
    gw_vector_t first;      /* and as it was at its start */
    gw_real_t smooth_share; /* of each low-pass in a tick */
    gw_vector_t smooth_mps[GW_SMOOTH_COUNT];
#endif
    bool initialised;
} gw_admittance_t;

typedef struct {
    /* Velocity at the end of the tick and displacement over it. */
    gw_vector_t velocity_mps;
    gw_vector_t displacement_m;
} gw_admittance_output_t;

/* The values of Trikey, the paper's robot. Pointers not NULL in these two. */
void gw_admittance_config_trikey(gw_admittance_config_t *config);
GW_SMALL void gw_admittance_config_check(const gw_admittance_config_t *config, gw_config_error_t *error);
/* period: s, [0.0001, 0.1]. */
GW_SMALL gw_status_t gw_admittance_init(gw_admittance_t *admittance, const gw_admittance_config_t *config,
                                        gw_real_t period_s);
bool gw_admittance_invariant_holds(const gw_admittance_t *admittance);
/* A hit: from the present velocity along the unit vector direction; (0, 0) means: come to rest here.
 * Velocity and direction finite, at most 100 m/s and length 1.01; else GW_STATUS_INPUT_INVALID, state unchanged. */
gw_status_t gw_admittance_start(gw_admittance_t *admittance, gw_vector_t velocity_mps, gw_vector_t direction);
/* A better estimate of the direction of the hit, a unit vector: what was moved so far counts. An escape of a
 * robot that cannot lean takes none that is more than 60 degrees from that of its start. Pointer not NULL. */
void gw_admittance_redirect(gw_admittance_t *admittance, gw_vector_t direction);
#if (GW_WITH_ESCAPE == 1)
/* The limit of the acceleration that tipping sets; and where the base faces now. Pointers not NULL. */
GW_SMALL void gw_admittance_set_tip(gw_admittance_t *admittance, const gw_tip_t *tip);
void gw_admittance_face(gw_admittance_t *admittance, gw_rotation_t yaw);
/* Before a step of the escape, as long as the contact lasts: brakes a velocity towards the push. No effect on other
 * kinds. Pointer not NULL. */
GW_SMALL void gw_admittance_brake(gw_admittance_t *admittance);
/* Likewise, instead of it, for a robot that does not move towards the push: accelerates away from it, past the first
 * low-pass, at most to the speed of (2). What exceeds the floor of the felt force, |F| at most 1e9 N, counts; mass
 * above 0. If nothing does, or nothing touches the robot any more, the escape waits for the robot, whose velocity is at
 * most 1e9 m/s in each component; with a brake limit of 0 it gets no faster, but is not slowed down. Both in the base
 * frame. No effect on other kinds. Pointer not NULL. */
GW_SMALL void gw_admittance_yield(gw_admittance_t *admittance, gw_vector_t force_n, gw_real_t floor_n,
                                  gw_real_t mass_kg, gw_vector_t robot_mps);
#endif
/* One tick. force is used by live force only. A force beyond 1e9 N or not finite:
 * GW_STATUS_INPUT_INVALID, output zero, state unchanged. */
gw_status_t gw_admittance_step(gw_admittance_t *admittance, gw_vector_t force_n, gw_admittance_output_t *output);

#ifdef __cplusplus
}
#endif

#endif
