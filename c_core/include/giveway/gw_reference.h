/* The pose and velocity that the robot is told to have, in the world frame.
 *
 * Following: the plan's velocity plus a correction towards the plan's pose, limited in speed and acceleration; a smooth
 * plan is followed exactly. The reference moves by trapezoids and its position is a compensated sum.
 *
 * Life cycle: gw_reference_init, gw_reference_place, then one of follow, escape, brake or freeze per tick.
 * All members are private; a copy of the struct is a checkpoint. Pointers not NULL except in init.
 */
#ifndef GW_REFERENCE_H
#define GW_REFERENCE_H

#include "giveway/gw_config.h"
#include "giveway/gw_math.h"
#include "giveway/gw_sum.h"
#include "giveway/gw_tip.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    /* Correction speed per distance from the plan, 1/s, [0, 100]; times the period at most 0.5. */
    gw_real_t follow_gain_per_s;
    /* Limits on the path, m/s, [0.001, 10] and m/s^2, [0.001, 1000]. */
    gw_real_t speed_limit_mps;
    gw_real_t acceleration_limit_mps2;
    /* Limits of the yaw, rad/s, [0.001, 100] and rad/s^2, [0.001, 10000]. */
    gw_real_t yaw_rate_limit_radps;
    gw_real_t yaw_acceleration_limit_radps2;
    /* Speed limit while the path is rejoined, m/s, [0.001, 10]. */
    gw_real_t rejoin_speed_mps;
    /* Slowest speed back to the path, m/s, [0, 1]; that of the yaw is in proportion to its limit. 0: the path is
     * approached ever more slowly. */
    gw_real_t finish_speed_mps;
} gw_reference_config_t;

/* A planned state, world frame. */
typedef struct {
    gw_pose_t pose;
    gw_twist_t twist;
    gw_acceleration_t acceleration;
} gw_plan_t;

/* Bounds of a valid plan: m, m/s, rad/s, and m/s^2 or rad/s^2. */
#define GW_PLAN_POSITION_MAX ((gw_real_t)1.0e4)
#define GW_PLAN_SPEED_MAX ((gw_real_t)100.0)
#define GW_PLAN_YAW_RATE_MAX ((gw_real_t)1000.0)
#define GW_PLAN_ACCELERATION_MAX ((gw_real_t)1.0e4)

typedef struct {
    gw_reference_config_t config;
    gw_real_t period_s;
    gw_sum_t x_m;
    gw_sum_t y_m;
    gw_sum_t theta_rad;
    gw_twist_t twist;
    gw_acceleration_t acceleration;
    /* What the last tick moved. */
    gw_pose_t displacement;
    gw_rotation_t yaw; /* sine and cosine of theta */
#if (GW_WITH_ESCAPE == 1)
    gw_tip_t tip;
#endif
    bool initialised;
} gw_reference_t;

/* The values of Trikey, the paper's robot. Pointers not NULL in these two. */
void gw_reference_config_trikey(gw_reference_config_t *config);
GW_SMALL void gw_reference_config_check(const gw_reference_config_t *config, gw_real_t period_s,
                                        gw_config_error_t *error);
/* period: s, [0.0001, 0.1]. The reference starts at the origin, at rest. */
GW_SMALL gw_status_t gw_reference_init(gw_reference_t *reference, const gw_reference_config_t *config,
                                       gw_real_t period_s);
#if (GW_WITH_ESCAPE == 1)
/* The limit of the acceleration that tipping sets while a path is rejoined; without it there is none. */
GW_SMALL void gw_reference_set_tip(gw_reference_t *reference, const gw_tip_t *tip);
#endif
bool gw_reference_invariant_holds(const gw_reference_t *reference);
/* True if every number is finite, positions within 1e4 m, angles within 1e4 rad, speeds within 100 m/s and 1000 rad/s,
 * accelerations within 1e4. */
static inline bool gw_plan_is_valid(const gw_plan_t *plan)
{
    return gw_within(plan->pose.x_m, GW_PLAN_POSITION_MAX) && gw_within(plan->pose.y_m, GW_PLAN_POSITION_MAX) &&
           gw_within(plan->pose.theta_rad, GW_ANGLE_MAX) && gw_within(plan->twist.vx_mps, GW_PLAN_SPEED_MAX) &&
           gw_within(plan->twist.vy_mps, GW_PLAN_SPEED_MAX) &&
           gw_within(plan->twist.omega_radps, GW_PLAN_YAW_RATE_MAX) &&
           gw_within(plan->acceleration.ax_mps2, GW_PLAN_ACCELERATION_MAX) &&
           gw_within(plan->acceleration.ay_mps2, GW_PLAN_ACCELERATION_MAX) &&
           gw_within(plan->acceleration.alpha_radps2, GW_PLAN_ACCELERATION_MAX);
}

/* A plan that gw_plan_is_valid, as provers need to be told. Pointer not NULL. */
static inline gw_plan_t gw_plan_limited(const gw_plan_t *plan)
{
    const gw_plan_t result = {
        {gw_known_within(plan->pose.x_m, GW_PLAN_POSITION_MAX), gw_known_within(plan->pose.y_m, GW_PLAN_POSITION_MAX),
         gw_known_within(plan->pose.theta_rad, GW_ANGLE_MAX)},
        {gw_known_within(plan->twist.vx_mps, GW_PLAN_SPEED_MAX), gw_known_within(plan->twist.vy_mps, GW_PLAN_SPEED_MAX),
         gw_known_within(plan->twist.omega_radps, GW_PLAN_YAW_RATE_MAX)},
        {gw_known_within(plan->acceleration.ax_mps2, GW_PLAN_ACCELERATION_MAX),
         gw_known_within(plan->acceleration.ay_mps2, GW_PLAN_ACCELERATION_MAX),
         gw_known_within(plan->acceleration.alpha_radps2, GW_PLAN_ACCELERATION_MAX)}};
    return result;
}

/* Puts the reference on the plan without motion of the wheels. plan valid. moving: with the plan's velocity, within the
 * limits; else at rest. */
GW_SMALL void gw_reference_place(gw_reference_t *reference, const gw_plan_t *plan, bool moving);
/* Follows a valid plan, with its velocity (tracking) or only towards its pose, at rejoin speed (rejoining). */
GW_SMALL void gw_reference_follow(gw_reference_t *reference, const gw_plan_t *plan, bool rejoining);
/* Moves as the admittance says; the yaw rate goes to zero within its limit. */
void gw_reference_escape(gw_reference_t *reference, gw_vector_t displacement_m, gw_vector_t velocity_mps);
/* Slows to a stop within the limits. */
GW_SMALL void gw_reference_brake(gw_reference_t *reference);
/* Stops at once. */
void gw_reference_freeze(gw_reference_t *reference);
static inline gw_pose_t gw_reference_pose(const gw_reference_t *reference)
{
    const gw_pose_t pose = {reference->x_m.value, reference->y_m.value, reference->theta_rad.value};
    return pose;
}

/* Distance and angle (unsigned) from the plan's pose. */
static inline gw_real_t gw_reference_distance(const gw_reference_t *reference, const gw_plan_t *plan)
{
    const gw_vector_t error = {gw_sum_subtract_from(plan->pose.x_m, reference->x_m),
                               gw_sum_subtract_from(plan->pose.y_m, reference->y_m)};
    return gw_length(error);
}

static inline gw_real_t gw_reference_angle(const gw_reference_t *reference, const gw_plan_t *plan)
{
    return gw_abs(gw_wrap_angle(gw_sum_subtract_from(plan->pose.theta_rad, reference->theta_rad)));
}

#ifdef __cplusplus
}
#endif

#endif
