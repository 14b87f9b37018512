#include <cstring>

#include "robot.hpp"

namespace
{

// A point on Trikey's outline and the directions that push into it.
struct Push {
    double x, y, direction;
};

std::vector<Push> pushes_from_all_sides(const gw_contact_config_t &outline, int per_edge)
{
    std::vector<Push> pushes;
    for (std::uint32_t i = 0; i < outline.vertex_count; ++i) {
        const auto &a = outline.vertex_m[i];
        const auto &b = outline.vertex_m[(i + 1) % outline.vertex_count];
        const double normal = std::atan2(static_cast<double>(b.x - a.x), -static_cast<double>(b.y - a.y));
        for (int k = 0; k < per_edge; ++k) {
            const double s = (k + 0.5) / per_edge;
            for (const double slant : {-1.1, -0.4, 0.0, 0.7, 1.2}) {
                pushes.push_back({a.x + s * (b.x - a.x), a.y + s * (b.y - a.y), normal + slant});
            }
        }
    }
    return pushes;
}

TEST(Controller, GivesWayToPushesFromAllSidesAndSaysWhere)
{
    Random random(131);
    const double threshold = GW_TRIKEY_DETECTOR_IMPULSE_THRESHOLD_NEWTON_S;
    int trial = 0;
    for (const auto &order : wheel_orders) {
        auto config = trikey_config();
        for (std::size_t i = 0; i < 3; ++i) {
            config.geometry.wheel_slot[i] = order[i];
        }
        for (const Push &push : pushes_from_all_sides(config.contact, 4)) {
            config.geometry.azimuth_rad = real(random.uniform(-3.0, 3.0));
            Robot robot(config, random_vector(random, 2.0));
            // Standing anywhere, with any heading.
            robot.input.plan.pose = {real(random.uniform(-5, 5)), real(random.uniform(-5, 5)),
                                     real(random.uniform(-3, 3))};
            robot.encoder_start = random.integer(-100'000, 100'000);
            robot.start();
            robot.run(30);
            const double force = random.uniform(8.0, 60.0);
            const Eigen::Vector3d wrench = push_at(push.x, push.y, force, push.direction);
            robot.run(20, wrench);
            // Recovered to 1e-9 (float: torques of up to 8 N m through 1/r_w).
            ASSERT_LE((vector(robot.output.estimate) - wrench).cwiseAbs().maxCoeff(), is_double ? 1e-9 : 2e-4);
            ASSERT_TRUE(robot.output.contact.valid);
            ASSERT_TRUE(robot.output.contact.on_outline);
            ASSERT_NEAR(robot.output.contact.point_m.x, push.x, is_double ? 1e-9 : 1e-4);
            ASSERT_NEAR(robot.output.contact.point_m.y, push.y, is_double ? 1e-9 : 1e-4);
            const Eigen::Vector2d along = wrench.head<2>().normalized();
            double distance = 0.0;
            int ticks_to_hit = 0;
            for (int i = 0; i < 1500; ++i) {
                const bool pushed = robot.output.detection_count == 0;
                ASSERT_EQ(robot.step(pushed ? wrench : Eigen::Vector3d(0, 0, 0)), GW_STATUS_OK);
                ticks_to_hit += pushed ? 1 : 0;
                const Eigen::Vector2d v = robot.commanded_twist().head<2>();
                // Never towards the push; sideways only by the rounding of the direction.
                ASSERT_GE(v.dot(along), 0.0) << i;
                ASSERT_LE(std::fabs(v.x() * along.y() - v.y() * along.x()), (is_double ? 1e-9 : 2e-5)) << i;
                distance += v.dot(along) * 1e-3;
                if (robot.output.detection_count == 1) {
                    ASSERT_GT(v.dot(along), 0.0) << i;
                }
            }
            ASSERT_EQ(robot.output.detection_count, 1U);
            // Impulse minus leak reaches J; the average already held 20 samples.
            ASSERT_NEAR(ticks_to_hit + 20, std::floor(threshold / ((force - 1.0) * 1e-3)) + 1, 1.0);
            ASSERT_NEAR(robot.output.detection_wrench.force_x_n, wrench(0), is_double ? 1e-9 : 1e-3);
            ASSERT_NEAR(robot.output.detection_wrench.torque_nm, wrench(2), is_double ? 1e-9 : 1e-3);
            ASSERT_NEAR(robot.output.detection_contact.point_m.x, push.x, is_double ? 1e-9 : 1e-4);
            ASSERT_NEAR(robot.output.detection_contact.point_m.y, push.y, is_double ? 1e-9 : 1e-4);
            ASSERT_GT(distance, 0.25);
            ASSERT_TRUE(gw_controller_invariant_holds(robot.controller.get()));
            ++trial;
        }
    }
    EXPECT_EQ(trial, 6 * 60);
}

TEST(Controller, TheEscapeIsHalfAMetreAndThePathIsRejoined)
{
    Robot robot(trikey_config());
    robot.start();
    robot.run(300);
    const std::uint32_t clock = robot.output.path_ticks;
    const Eigen::Vector3d wrench = push_at(-0.176, 0.1, 40.0, 0.3);
    while (robot.output.mode == GW_MODE_TRACKING) {
        ASSERT_EQ(robot.step(wrench), GW_STATUS_OK);
    }
    const std::uint32_t stopped_clock = robot.output.path_ticks;
    EXPECT_GT(stopped_clock, clock);
    double farthest = 0.0;
    std::vector<gw_mode_t> modes = {robot.output.mode};
    for (int i = 0; i < 20'000; ++i) {
        ASSERT_EQ(robot.step(), GW_STATUS_OK);
        const gw_pose_t pose = robot.output.reference_pose;
        farthest = std::max(farthest, std::hypot(static_cast<double>(pose.x_m), static_cast<double>(pose.y_m)));
        ASSERT_NEAR(pose.theta_rad, 0.0, 1e-7); // (3): the yaw stays
        if (robot.output.mode != modes.back()) {
            modes.push_back(robot.output.mode);
        }
        if (robot.output.mode != GW_MODE_TRACKING) {
            ASSERT_EQ(robot.output.path_ticks, stopped_clock);
        }
    }
    EXPECT_EQ(modes, (std::vector<gw_mode_t>{GW_MODE_REACTING, GW_MODE_SETTLED, GW_MODE_REJOINING, GW_MODE_TRACKING}));
    EXPECT_NEAR(farthest, 0.5, 4.0 * epsilon);
    EXPECT_GT(robot.output.path_ticks, stopped_clock);
    EXPECT_LT(std::hypot(robot.output.reference_pose.x_m, robot.output.reference_pose.y_m), 1e-3);
    EXPECT_EQ(robot.output.detection_count, 1U);
}

TEST(Controller, APushInMotionTurnsTheRobotRound)
{
    // 5.3: 0.22 m/s into an obstacle; and with the robot already moving when the controller starts.
    auto config = trikey_config();
    config.estimator.tare_ticks = 0;
    Robot robot(config);
    const auto plan_at = [&](std::uint32_t tick) {
        robot.input.plan.pose = {real(0.22e-3 * tick), real(0), real(0)};
        robot.input.plan.twist = {real(0.22), real(0), real(0)};
    };
    plan_at(0);
    robot.already_moving({static_cast<double>(real(0.22)), 0, 0});
    ASSERT_EQ(robot.step(), GW_STATUS_OK);
    EXPECT_EQ(robot.output.mode, GW_MODE_TRACKING);
    EXPECT_EQ(robot.output.reference_twist.vx_mps, real(0.22));
    for (int i = 0; i < 500; ++i) {
        plan_at(robot.output.path_ticks);
        ASSERT_EQ(robot.step(), GW_STATUS_OK);
        ASSERT_EQ(robot.output.detection_count, 0U);
    }
    const Eigen::Vector3d wrench = push_at(0.35, 0.0, 50.0, pi);
    while (robot.output.detection_count == 0) {
        plan_at(robot.output.path_ticks);
        ASSERT_EQ(robot.step(wrench), GW_STATUS_OK);
    }
    const double hit_at = static_cast<double>(robot.output.reference_pose.x_m);
    double before = robot.output.reference_twist.vx_mps;
    ASSERT_LT(before, 0.22);
    for (int i = 0; i < 8000; ++i) {
        ASSERT_EQ(robot.step(), GW_STATUS_OK);
        const double v = robot.output.reference_twist.vx_mps;
        ASSERT_LE(std::fabs(v - before), 2.8e-3 * (1.0 + 1e-5));
        before = v;
        if (robot.output.mode == GW_MODE_SETTLED) {
            break;
        }
    }
    EXPECT_EQ(robot.output.mode, GW_MODE_SETTLED);
    EXPECT_NEAR(robot.output.reference_pose.x_m, hit_at - 0.5, 2e-3); // the first tick of braking is before hit_at
}

TEST(Controller, LiveForceFollowsThePushAndStopsWithIt)
{
    auto config = trikey_config();
    config.admittance.kind = GW_ADMITTANCE_LIVE_FORCE;
    Robot robot(config);
    robot.start();
    const Eigen::Vector3d wrench = push_at(-0.176, 0.0, 12.0, 0.2);
    for (int i = 0; i < 1500; ++i) {
        ASSERT_EQ(robot.step(wrench), GW_STATUS_OK);
        ASSERT_GE(robot.commanded_twist().head<2>().dot(wrench.head<2>()), -1e-9) << i;
    }
    EXPECT_NEAR(robot.commanded_twist().head<2>().norm(), 0.5, 1e-3); // at its speed limit
    robot.run(25'000);
    EXPECT_EQ(robot.output.mode, GW_MODE_TRACKING);
}

TEST(Controller, APushThatStaysIsAnsweredAgainAfterTheEscape)
{
    Robot robot(trikey_config());
    robot.start();
    const Eigen::Vector3d wrench = push_at(-0.176, 0.0, 100.0, 0.0);
    for (int i = 0; i < 16'000; ++i) {
        ASSERT_EQ(robot.step(wrench), GW_STATUS_OK);
        ASSERT_GE(robot.commanded_twist()(0), -1e-9) << i;
    }
    EXPECT_GE(robot.output.detection_count, 2U);
}

TEST(Controller, TheCommandedSpeedBelongsToTheCommandedAngle)
{
    // On a circle, turning: the drives' feed-forward is the derivative of their reference.
    Robot robot(trikey_config());
    robot.start();
    std::array<double, 3> before{};
    std::array<double, 3> speed_before{};
    for (int i = 0; i < 20'000; ++i) {
        const double t = robot.output.path_ticks * 1e-3;
        const double w = 0.16 / 0.75;
        robot.input.plan.pose = {real(0.75 * std::sin(w * t)), real(0.75 - 0.75 * std::cos(w * t)), real(0.3 * t)};
        robot.input.plan.twist = {real(0.16 * std::cos(w * t)), real(0.16 * std::sin(w * t)), real(0.3)};
        robot.input.plan.acceleration = {real(-0.16 * w * std::sin(w * t)), real(0.16 * w * std::cos(w * t)), real(0)};
        ASSERT_EQ(robot.step(), GW_STATUS_OK);
        ASSERT_EQ(robot.output.detection_count, 0U) << i;
        for (std::size_t k = 0; k < 3; ++k) {
            const double angle = robot.output.command.angle_rad[k];
            const double speed = robot.output.command.speed_radps[k];
            if (i > 2) {
                const double moved = std::remainder(angle - before[k], 2.0 * pi);
                ASSERT_NEAR(moved, 0.5e-3 * (speed + speed_before[k]), is_double ? 1e-8 : 1e-6);
            }
            before[k] = angle;
            speed_before[k] = speed;
        }
    }
    EXPECT_NEAR(gw_reference_distance(&robot.controller->reference, &robot.input.plan), 0.0, 1e-4);
}

} // namespace
