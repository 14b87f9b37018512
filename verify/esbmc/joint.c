/* Any state within the invariant, any bits as geometry, displacement, yaw and speed: the invariant is kept, and the
 * commands are angles of that state. */
#include "contracts.h"

#include "gw_joint.c"
#include "gw_sum.c"

int main(void)
{
    gw_joint_t joint;
    gw_joint_command_t command;
    gw_kinematics_t kinematics;
    gw_wheels_t angle_rad;
    const gw_pose_t displacement = {nondet_float(), nondet_float(), nondet_float()};
    const gw_rotation_t yaw = {nondet_float(), nondet_float()};
    const gw_twist_t twist = {nondet_float(), nondet_float(), nondet_float()};
    for (unsigned int i = 0U; i < GW_WHEEL_COUNT; i++) {
        joint.angle_rad[i].value = nondet_float();
        joint.angle_rad[i].excess = nondet_float();
        kinematics.radial[i].x = nondet_float();
        kinematics.radial[i].y = nondet_float();
        angle_rad.wheel[i] = nondet_float();
    }
    kinematics.wheel_distance_m = nondet_float();
    kinematics.per_wheel_radius = nondet_float();
    joint.placed = nondet_bool();
    __ESBMC_assume(gw_joint_invariant_holds(&joint));
    if (nondet_bool()) {
        gw_joint_place(&joint, &angle_rad);
        __ESBMC_assert(gw_joint_invariant_holds(&joint), "placing keeps the invariant");
    }
    gw_joint_step(&joint, &kinematics, displacement, nondet_float(), yaw, twist, &command);
    __ESBMC_assert(gw_joint_invariant_holds(&joint), "a step keeps the invariant");
    for (unsigned int i = 0U; i < GW_WHEEL_COUNT; i++) {
        __ESBMC_assert(gw_in_range(command.angle_rad[i], -GW_PI, GW_PI), "an angle is commanded");
    }
    return 0;
}
