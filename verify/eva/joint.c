#include "parts.h"

static gw_joint_t joint;

static void part_init(void)
{
    gw_joint_init(&joint);
    hold_joint(&joint);
}

static void part_step(void)
{
    static gw_kinematics_t kinematics;
    static gw_reference_t reference;
    gw_joint_command_t command;
    gw_wheels_t angles = {{any_real(), any_real(), any_real()}};
    draw_joint(&joint);
    draw_kinematics(&kinematics);
    draw_reference(&reference);
    if (any_flag()) {
        gw_joint_place(&joint, &angles);
    }
    if (any_flag()) {
        gw_joint_step(&joint, &kinematics, reference.displacement, reference.theta_rad.value, reference.yaw,
                      reference.twist, &command);
    } else {
        gw_joint_hold(&joint, &command);
        for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
            demand_real(command.speed_radps[i], GW_ZERO, GW_ZERO);
        }
    }
    hold_joint(&joint);
    for (uint32_t i = 0U; i < GW_WHEEL_COUNT; i++) {
        demand_real(command.angle_rad[i], -PI_ROUNDED, PI_ROUNDED);
        demand_real(command.speed_radps[i], (gw_real_t)-1.2e6, (gw_real_t)1.2e6);
    }
    (void)gw_joint_is_placed(&joint);
    (void)gw_joint_invariant_holds(&joint);
}

static void part_refusals(void)
{
    disturb_joint(&joint);
    (void)gw_joint_invariant_holds(any_flag() ? &joint : NULL);
}
