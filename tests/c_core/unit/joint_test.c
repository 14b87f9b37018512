#include "unit.h"

#define PERIOD R(0.001)

static gw_kinematics_t wheels(void)
{
    const gw_geometry_config_t geometry = {R(0.1), R(0.01), R(0.25), {0U, 1U, 2U}, R(0.0)};
    gw_kinematics_t kinematics;
    CHECK_STATUS(gw_kinematics_init(&kinematics, &geometry), GW_STATUS_OK);
    return kinematics;
}

static void the_first_angles_are_those_it_was_placed_at(void)
{
    const gw_wheels_t angles = {{R(0.5), R(-0.5), R(7.0)}};
    gw_joint_t joint;
    gw_joint_command_t command;
    gw_joint_init(&joint);
    CHECK(!gw_joint_is_placed(&joint));
    CHECK(gw_joint_invariant_holds(&joint));
    gw_joint_place(&joint, &angles);
    gw_joint_hold(&joint, &command);
    CHECK(gw_joint_is_placed(&joint));
    CHECK(gw_joint_invariant_holds(&joint));
    CHECK((command.angle_rad[0] == R(0.5)) && (command.angle_rad[1] == R(-0.5)));
    CHECK_NEAR(command.angle_rad[2], R(0.71681469282041353), R(4.0) * ULP);
    CHECK((command.speed_radps[0] == GW_ZERO) && (command.speed_radps[2] == GW_ZERO));
}

/* One turn of the base on the spot turns every wheel by R/r_w = 2.5 turns, so by half a turn once they are whole. */
static void a_turn_on_the_spot_turns_every_wheel_alike(void)
{
    const gw_kinematics_t kinematics = wheels();
    const gw_real_t yaw_step = GW_TWO * GW_PI / R(1000.0);
    const gw_pose_t displacement = {GW_ZERO, GW_ZERO, yaw_step};
    const gw_twist_t twist = {GW_ZERO, GW_ZERO, yaw_step / PERIOD};
    gw_joint_t joint;
    gw_joint_command_t command;
    gw_joint_init(&joint);
    for (uint32_t tick = 1U; tick <= 1000U; tick++) {
        const gw_real_t theta_rad = (gw_real_t)tick * yaw_step;
        gw_joint_step(&joint, &kinematics, displacement, theta_rad, gw_sincos(theta_rad), twist, &command);
        CHECK(gw_joint_invariant_holds(&joint));
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            CHECK_NEAR(command.speed_radps[i], R(2.5) * twist.omega_radps, R(20.0) * ROUNDING);
        }
    }
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        unit_row(i);
        CHECK_NEAR(gw_abs(command.angle_rad[i]), GW_PI, R(20.0) * ROUNDING);
    }
}

/* Straight ahead at a yaw of 90 degrees: along the base's -y axis, so wheel 0 turns by -x/r_w. */
static void displacements_are_in_the_world_frame(void)
{
    const gw_kinematics_t kinematics = wheels();
    const gw_pose_t displacement = {R(0.01), GW_ZERO, GW_ZERO};
    const gw_twist_t twist = {R(0.2), GW_ZERO, GW_ZERO};
    gw_joint_t joint;
    gw_joint_command_t command;
    gw_joint_init(&joint);
    gw_joint_step(&joint, &kinematics, displacement, GW_HALF * GW_PI, gw_sincos(GW_HALF * GW_PI), twist, &command);
    CHECK(gw_joint_invariant_holds(&joint));
    CHECK_NEAR(command.angle_rad[0], R(-0.1), ROUNDING);
    CHECK_NEAR(command.speed_radps[0], R(-2.0), R(2.0) * ROUNDING);
}

static void the_invariant_sees_every_member(void)
{
    gw_joint_t joint;
    CHECK(!gw_joint_invariant_holds(NULL));
    gw_joint_init(&joint);
    joint.angle_rad[2].excess = unit_nan();
    CHECK(!gw_joint_invariant_holds(&joint));
    gw_joint_init(&joint);
    joint.angle_rad[0].value = R(-3.2);
    CHECK(!gw_joint_invariant_holds(&joint));
    gw_joint_init(&joint);
    joint.angle_rad[1].value = R(3.2);
    CHECK(!gw_joint_invariant_holds(&joint));
}

void suite_joint(void)
{
    unit_run("the_first_angles_are_those_it_was_placed_at", the_first_angles_are_those_it_was_placed_at);
    unit_run("a_turn_on_the_spot_turns_every_wheel_alike", a_turn_on_the_spot_turns_every_wheel_alike);
    unit_run("displacements_are_in_the_world_frame", displacements_are_in_the_world_frame);
    unit_run("the_invariant_sees_every_member", the_invariant_sees_every_member);
}
