#include "support.hpp"

namespace
{

TEST(Joint, WheelsFollowTheConstrainedJacobian)
{
    // (5) and (6) along random motions, against Eigen's integral of the same trapezoids.
    Random random(91);
    for (int trial = 0; trial < 60; ++trial) {
        const gw_geometry_config_t geometry = random_geometry(random, trial);
        gw_kinematics_t kinematics{};
        ASSERT_EQ(gw_kinematics_init(&kinematics, &geometry), GW_STATUS_OK);
        gw_joint_t joint{};
        gw_joint_init(&joint);
        EXPECT_FALSE(gw_joint_is_placed(&joint));
        Eigen::Vector3d angle = random_vector(random, 3.0);
        const gw_wheels_t start = wheels(angle);
        gw_joint_place(&joint, &start);
        EXPECT_TRUE(gw_joint_is_placed(&joint));
        double theta = static_cast<double>(real(random.uniform(-3.0, 3.0)));
        Eigen::Vector3d moved = Eigen::Vector3d::Zero();
        for (int i = 0; i < 2000; ++i) {
            const Eigen::Vector3d v = random_vector(random, 1.0);
            const Eigen::Vector3d d = rounded(v * 1e-3);
            const double end = static_cast<double>(real(theta + d(2)));
            moved += wheel_jacobian(geometry, end - d(2) / 2.0) * d;
            const Eigen::Vector3d speed = wheel_jacobian(geometry, end) * v;
            gw_joint_command_t command{};
            gw_joint_step(&joint, &kinematics, {real(d(0)), real(d(1)), real(d(2))}, real(end), gw_sincos(real(end)),
                          twist(v), &command);
            const double size = wheel_jacobian(geometry, end).cwiseAbs().maxCoeff();
            for (int w = 0; w < 3; ++w) {
                const double error = std::remainder(command.angle_rad[w] - angle(w) - moved(w), 2.0 * pi);
                // Yaw of a few radians is rounded at 2e-7 in float: a few 1e-10 of angle per tick, 2000 ticks.
                ASSERT_NEAR(error, 0.0, is_double ? 1e-12 * size * 3 : 2e-6 * size) << i;
                ASSERT_NEAR(command.speed_radps[w], speed(w), 10.0 * tolerance * size);
                ASSERT_GE(command.angle_rad[w], -GW_PI);
                ASSERT_LT(command.angle_rad[w], GW_PI);
            }
            theta = end;
        }
        EXPECT_TRUE(gw_joint_invariant_holds(&joint));
        gw_joint_command_t held{};
        gw_joint_hold(&joint, &held);
        for (int w = 0; w < 3; ++w) {
            EXPECT_EQ(held.angle_rad[w], joint.angle_rad[w].value);
            EXPECT_EQ(held.speed_radps[w], real(0));
        }
    }
    EXPECT_FALSE(gw_joint_invariant_holds(nullptr));
}

} // namespace
