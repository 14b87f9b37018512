// The step written with Eigen gives the results of the C library over the recorded collision; otherwise its cost would
// mean nothing.
#include "eigen_step.hpp"

#include <gtest/gtest.h>

extern "C" {
#include "recorded_collision.h"
}

namespace
{

// Both round differently: a few units in the last place of each quantity's size (measured: 6e-5 N of sums of 150 N,
// 2e-7 rad, 8e-7 rad/s of up to 8, 1e-6 m).
constexpr float wrench_n = 2e-4F, angle_rad = 1e-6F, speed_radps = 4e-6F, point_m = 5e-6F, direction_rad = 1e-5F;

TEST(EigenStep, DoesWhatTheLibraryDoesOverTheRecordedCollision)
{
    gw_controller_config_t config;
    recorded_collision_config(&config);
    static gw_controller_t library;
    ASSERT_EQ(gw_controller_init(&library, &config, nullptr), GW_STATUS_OK);
    eigen_step::Controller with_eigen(config);
    gw_controller_output_t expected;
    eigen_step::Output found;
    int reacting = 0, located = 0;
    for (uint32_t tick = 0; tick < RECORDED_TICKS; ++tick) {
        SCOPED_TRACE(tick);
        gw_controller_input_t input;
        recorded_collision_input(tick, &input);
        ASSERT_EQ(gw_controller_step(&library, &input, &expected), GW_STATUS_OK);
        with_eigen.step(input, found);
        ASSERT_EQ(found.mode, expected.mode);
        ASSERT_EQ(found.detection_tick, expected.detection_tick);
        ASSERT_EQ(found.detection_active, expected.detection_active);
        ASSERT_EQ(found.contact.valid, expected.contact.valid);
        ASSERT_EQ(found.contact.on_outline, expected.contact.on_outline);
        ASSERT_NEAR(found.wrench.x(), expected.estimate.force_x_n, wrench_n);
        ASSERT_NEAR(found.wrench.y(), expected.estimate.force_y_n, wrench_n);
        ASSERT_NEAR(found.wrench.z(), expected.estimate.torque_nm, wrench_n);
        for (int i = 0; i < 3; ++i) {
            ASSERT_NEAR(found.wheel_angle[i], expected.command.angle_rad[i], angle_rad);
            ASSERT_NEAR(found.wheel_speed[i], expected.command.speed_radps[i], speed_radps);
        }
        ASSERT_NEAR(found.contact.point.x(), expected.contact.point_m.x, point_m);
        ASSERT_NEAR(found.contact.point.y(), expected.contact.point_m.y, point_m);
        ASSERT_NEAR(found.contact.direction, expected.contact.direction_rad, direction_rad);
        ASSERT_NEAR(found.detection_contact.point.x(), expected.detection_contact.point_m.x, point_m);
        ASSERT_NEAR(found.detection_contact.point.y(), expected.detection_contact.point_m.y, point_m);
        reacting += expected.mode == GW_MODE_REACTING ? 1 : 0;
        located += expected.contact.valid ? 1 : 0;
    }
    EXPECT_GT(reacting, 300); // otherwise the escape was not compared
    EXPECT_GT(located, 100);
}

TEST(EigenStep, RefusesWhatItDoesNotCompute)
{
    gw_controller_config_t config;
    recorded_collision_config(&config);
    config.detector.kind = GW_DETECTOR_FORCE_AVERAGE;
    EXPECT_THROW(eigen_step::Controller{config}, std::invalid_argument);
}

} // namespace
