#include "giveway/gw_joint.h"

#include "giveway/gw_math.h"

void gw_joint_init(gw_joint_t *joint)
{
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        joint->angle_rad[i] = gw_sum_of(GW_ZERO);
    }
    joint->placed = false;
}

void gw_joint_place(gw_joint_t *joint, const gw_wheels_t *angle_rad)
{
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        joint->angle_rad[i] = gw_sum_of(gw_wrap_angle(angle_rad->wheel[i]));
    }
    joint->placed = true;
}

void gw_joint_step(gw_joint_t *joint, const gw_kinematics_t *kinematics, gw_pose_t displacement, gw_real_t theta_rad,
                   gw_rotation_t yaw, gw_twist_t twist, gw_joint_command_t *command)
{
    const gw_vector_t moved_m = {displacement.x_m, displacement.y_m};
    const gw_vector_t velocity_mps = {twist.vx_mps, twist.vy_mps};
    const gw_vector_t velocity = gw_rotate_back(yaw, velocity_mps);
    const gw_real_t rim_m = kinematics->wheel_distance_m * displacement.theta_rad;
    const gw_real_t rim_mps = kinematics->wheel_distance_m * twist.omega_radps;
    const gw_rotation_t mean_yaw = gw_sincos(theta_rad - (GW_HALF * displacement.theta_rad));
    const gw_vector_t moved = gw_rotate_back(mean_yaw, moved_m);
    const gw_real_t per_radius = kinematics->per_wheel_radius;
    GW_UNROLLED
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        const gw_vector_t n = kinematics->radial[i];
        const gw_real_t turned_rad = (gw_along_rolling(n, moved.x, moved.y) + rim_m) * per_radius;
        joint->angle_rad[i] = gw_sum_add_angle(joint->angle_rad[i], turned_rad);
        command->angle_rad[i] = joint->angle_rad[i].value;
        command->speed_radps[i] = (gw_along_rolling(n, velocity.x, velocity.y) + rim_mps) * per_radius;
    }
}

void gw_joint_hold(const gw_joint_t *joint, gw_joint_command_t *command)
{
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        command->angle_rad[i] = joint->angle_rad[i].value;
        command->speed_radps[i] = GW_ZERO;
    }
}

bool gw_joint_invariant_holds(const gw_joint_t *joint)
{
    bool holds = (joint != NULL);
    if (holds) {
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            const gw_real_t angle_rad = joint->angle_rad[i].value;
            holds = holds && gw_sum_invariant_holds(joint->angle_rad[i]) && gw_within(angle_rad, GW_PI);
        }
    }
    return holds;
}
