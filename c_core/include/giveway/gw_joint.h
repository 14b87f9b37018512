/* From the base's reference to the wheels', (5) and (6).
 *
 * Wheel angles are compensated sums in [-pi, pi): after a day they are as fine as in the first second.
 *
 * Life cycle: gw_joint_init, gw_joint_place, gw_joint_step per tick. All members are private. Pointers not NULL.
 */
#ifndef GW_JOINT_H
#define GW_JOINT_H

#include "giveway/gw_kinematics.h"
#include "giveway/gw_sum.h"
#include "giveway/gw_types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    gw_sum_t angle_rad[GW_WHEEL_COUNT];
    bool placed;
} gw_joint_t;

typedef struct {
    gw_real_t angle_rad[GW_WHEEL_COUNT]; /* [-pi, pi) */
    gw_real_t speed_radps[GW_WHEEL_COUNT];
} gw_joint_command_t;

GW_SMALL void gw_joint_init(gw_joint_t *joint);
/* Starts from these wheel angles, rad. */
GW_SMALL void gw_joint_place(gw_joint_t *joint, const gw_wheels_t *angle_rad);
static inline bool gw_joint_is_placed(const gw_joint_t *joint)
{
    return joint->placed;
}

/* One tick: the base moves by displacement (m, m, rad) to yaw theta, whose gw_sincos is yaw, and then has this twist,
 * all in the world frame and finite. The displacement is mapped at the mean yaw, the twist at the final one. */
void gw_joint_step(gw_joint_t *joint, const gw_kinematics_t *kinematics, gw_pose_t displacement, gw_real_t theta_rad,
                   gw_rotation_t yaw, gw_twist_t twist, gw_joint_command_t *command);
/* The last angles at zero speed. */
void gw_joint_hold(const gw_joint_t *joint, gw_joint_command_t *command);
bool gw_joint_invariant_holds(const gw_joint_t *joint);

#ifdef __cplusplus
}
#endif

#endif
