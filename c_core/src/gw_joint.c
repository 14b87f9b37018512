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

static gw_wheels_t wheels_of(const gw_kinematics_t *kinematics, gw_real_t x, gw_real_t y, gw_real_t theta,
                             gw_rotation_t yaw)
{
    const gw_vector_t world = {x, y};
    const gw_vector_t base = gw_rotate_back(yaw, world);
    const gw_twist_t twist = {base.x, base.y, theta};
    return gw_kinematics_wheel_rates(kinematics, twist);
}

void gw_joint_step(gw_joint_t *joint, const gw_kinematics_t *kinematics, gw_pose_t displacement, gw_real_t theta_rad,
                   gw_rotation_t yaw, gw_twist_t twist, gw_joint_command_t *command)
{
    const gw_real_t mean_yaw_rad = theta_rad - (GW_HALF * displacement.theta_rad);
    /* cppcheck-suppress misra-c2012-9.3 ; DEV-01 a whole struct from a call */
    const gw_wheels_t turned =
        wheels_of(kinematics, displacement.x_m, displacement.y_m, displacement.theta_rad, gw_sincos(mean_yaw_rad));
    /* cppcheck-suppress misra-c2012-9.3 ; DEV-01 a whole struct from a call */
    const gw_wheels_t speed = wheels_of(kinematics, twist.vx_mps, twist.vy_mps, twist.omega_radps, yaw);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        joint->angle_rad[i] = gw_sum_add_angle(joint->angle_rad[i], turned.wheel[i]);
        command->angle_rad[i] = joint->angle_rad[i].value;
        command->speed_radps[i] = speed.wheel[i];
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
