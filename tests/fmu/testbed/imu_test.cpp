// Accelerometer and gyro of the testbed: the part by itself against its definition, and on the robot against closed
// forms. What it feels is held against two other derivations in ../plant.
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "imu.hpp"
#include "model.hpp"
#include "testbed_variables.hpp"

namespace {

using namespace giveway::testbed;

constexpr int many = 100'000;

ImuOptions ideal_part() {
    ImuOptions o{};
    o.present = true;
    o.seed = 4711U;
    o.acceleration_scale = {1.0, 1.0};
    o.gyro_scale = 1.0;
    o.vibration_frequency_hz = 60.0;
    o.vibration_damping = 0.05;
    o.range_mps2 = 40.0;
    o.gyro_range_radps = 10.0;
    o.period_s = 1e-3;
    return o;
}

Imu started(const ImuOptions &options, const ImuTruth &truth = {}) {
    Imu imu;
    imu.start(options, truth);
    return imu;
}

double rms(const std::vector<double> &values) {
    double square = 0.0;
    for (const double value : values) {
        square += value * value;
    }
    return std::sqrt(square / static_cast<double>(values.size()));
}

} // namespace

TEST(Imu, WithoutErrorsItShowsTheInstant) {
    Imu imu = started(ideal_part());
    for (int k = 0; k < 10; ++k) {
        const auto sample = imu.sample({{1.0 * k, -2.0 * k}, 0.5 * k, 0.0});
        EXPECT_EQ(sample.acceleration_mps2[0], 1.0 * k);
        EXPECT_EQ(sample.acceleration_mps2[1], -2.0 * k);
        EXPECT_EQ(sample.yaw_rate_radps, 0.5 * k);
    }
}

TEST(Imu, ScaleBiasAndRange) {
    ImuOptions o = ideal_part();
    o.acceleration_scale = {1.01, 0.98};
    o.acceleration_bias_mps2 = {0.2, -0.1};
    o.gyro_scale = 0.99;
    o.gyro_bias_radps = 0.01;
    Imu imu = started(o);
    const auto sample = imu.sample({{3.0, -4.0}, 2.0, 0.0});
    EXPECT_EQ(sample.acceleration_mps2[0], 1.01 * 3.0 + 0.2);
    EXPECT_EQ(sample.acceleration_mps2[1], 0.98 * -4.0 - 0.1);
    EXPECT_EQ(sample.yaw_rate_radps, 0.99 * 2.0 + 0.01);
    const auto saturated = imu.sample({{300.0, -400.0}, -20.0, 0.0});
    EXPECT_EQ(saturated.acceleration_mps2[0], 40.0);
    EXPECT_EQ(saturated.acceleration_mps2[1], -40.0);
    EXPECT_EQ(saturated.yaw_rate_radps, -10.0);
}

TEST(Imu, EverySignalHasItsOwnNoise) {
    ImuOptions o = ideal_part();
    o.acceleration_noise_mps2 = 0.02;
    o.gyro_noise_radps = 0.001;
    Imu imu = started(o);
    std::vector<double> x, y, yaw;
    double together = 0.0;
    for (int k = 0; k < many; ++k) {
        const auto sample = imu.sample({});
        x.push_back(sample.acceleration_mps2[0]);
        y.push_back(sample.acceleration_mps2[1]);
        yaw.push_back(sample.yaw_rate_radps);
        together += x.back() * y.back();
    }
    const double error = 5.0 / std::sqrt(2.0 * many); // five standard errors
    EXPECT_NEAR(rms(x), 0.02, 0.02 * error);
    EXPECT_NEAR(rms(y), 0.02, 0.02 * error);
    EXPECT_NEAR(rms(yaw), 0.001, 0.001 * error);
    EXPECT_NEAR(together / many / (0.02 * 0.02), 0.0, 5.0 / std::sqrt(many));
}

TEST(Imu, ItsNoiseIsNotThatOfTheTorqueSensors) {
    const ImuOptions o = ideal_part();
    for (std::int64_t cycle = -3; cycle < 100; ++cycle) {
        const ImuDeviates found = imu_deviates(o, cycle);
        for (std::uint32_t i = 0; i < found.size(); ++i) {
            EXPECT_EQ(found[i], giveway::math::normal(4711U, 3U + i, static_cast<std::uint64_t>(cycle)));
        }
    }
}

TEST(Imu, VibrationIsAResonanceOfItsRmsThatGrowsWithTheWheels) {
    ImuOptions o = ideal_part();
    o.vibration_mps2 = 0.1;
    o.vibration_growth_s_per_rad = 0.5;
    for (const double wheel_speed : {0.0, 4.0}) {
        const ImuTruth truth{{0.0, 0.0}, 0.0, wheel_speed};
        Imu imu = started(o, truth);
        std::vector<double> x;
        for (int k = 0; k < 10 * many; ++k) {
            x.push_back(imu.sample(truth).acceleration_mps2[0]);
        }
        const double expected = 0.1 * (1.0 + 0.5 * wheel_speed);
        // Neighbouring values go together for 1/(damping w) = 53 samples: as many times fewer independent ones.
        EXPECT_NEAR(rms(x), expected, expected * 5.0 * std::sqrt(53.0 / (10.0 * many)));
        // Autocorrelation of a damped vibration: exp(-damping w t) (cos(w_d t) + damping/sqrt(1 - damping^2) sin) but
        // for what sampling leaves of it.
        const double omega = 2.0 * M_PI * 60.0;
        const double damped = omega * std::sqrt(1.0 - 0.05 * 0.05);
        for (const int lag : {4, 8, 17, 33}) {
            double product = 0.0;
            for (std::size_t k = 0; k + static_cast<std::size_t>(lag) < x.size(); ++k) {
                product += x[k] * x[k + static_cast<std::size_t>(lag)];
            }
            const double found = product / (rms(x) * rms(x) * static_cast<double>(x.size()));
            const double t = 1e-3 * lag;
            const double together = std::exp(-0.05 * omega * t) * (std::cos(damped * t) + 0.05 * std::sin(damped * t));
            EXPECT_NEAR(found, together, 0.03);
        }
    }
}

TEST(Imu, VibrationIsSteadyFromTheStart) {
    // Over many seeds, the first value has the rms of all later ones.
    ImuOptions o = ideal_part();
    o.vibration_mps2 = 1.0;
    std::vector<double> first;
    for (std::uint32_t seed = 0; seed < 4000U; ++seed) {
        o.seed = seed;
        first.push_back(started(o).sample({}).acceleration_mps2[0]);
    }
    EXPECT_NEAR(rms(first), 1.0, 5.0 / std::sqrt(2.0 * 4000.0));
}

TEST(Imu, TheFilterIsOfFirstOrder) {
    ImuOptions o = ideal_part();
    o.bandwidth_hz = 50.0;
    Imu imu = started(o);
    for (int k = 1; k < 50; ++k) {
        const auto sample = imu.sample({{2.0, 0.0}, -1.0, 0.0});
        const double expected = 1.0 - std::exp(-2.0 * M_PI * 50.0 * 1e-3 * k); // of a step held from a cycle before
        EXPECT_NEAR(sample.acceleration_mps2[0], 2.0 * expected, 1e-12);
        EXPECT_NEAR(sample.yaw_rate_radps, -expected, 1e-12);
    }
}

TEST(Imu, ASampleComesAfterItsDelayWithItsCounter) {
    for (const int delay : {0, 1, 5, max_delay_cycles}) {
        ImuOptions o = ideal_part();
        o.delay_cycles = delay;
        o.range_mps2 = 1000.0;
        Imu imu = started(o, {{-1.0, 0.0}, 0.0, 0.0});
        std::int32_t before = 0;
        for (int k = 0; k < 200; ++k) {
            const auto sample = imu.sample({{1.0 * k, 0.0}, 0.0, 0.0});
            EXPECT_EQ(sample.acceleration_mps2[0], k < delay ? -1.0 : 1.0 * (k - delay));
            if (k > 0) {
                EXPECT_EQ(sample.counter, before + 1);
            }
            before = sample.counter;
        }
    }
}

TEST(Imu, ALostSampleLeavesTheOneBefore) {
    ImuOptions o = ideal_part();
    o.dropout = 0.2;
    Imu imu = started(o);
    std::int32_t before = 0;
    int lost = 0;
    for (int k = 0; k < many; ++k) {
        const auto sample = imu.sample({{1.0 * k, 0.0}, 0.0, 0.0});
        const bool stays = k > 0 && sample.counter == before;
        lost += stays ? 1 : 0;
        if (k > 0 && !stays) {
            EXPECT_EQ(sample.acceleration_mps2[0], std::min(1.0 * k, 40.0));
        }
        before = sample.counter;
    }
    EXPECT_NEAR(lost, 0.2 * many, 5.0 * std::sqrt(0.2 * 0.8 * many));
}

namespace {

struct Robot {
    std::unique_ptr<giveway::Model> model{giveway::create_model()};
    giveway::Message message{};
    [[nodiscard]] Variables &v() const { return *static_cast<Variables *>(model->variables()); }
    void initialise() { ASSERT_EQ(model->initialise(0.0, message), giveway::Status::ok) << message.text; }
    void step_to(double end_s) {
        for (long long k = 0; k < std::llround(end_s * 1e3); ++k) {
            ASSERT_EQ(model->step(1e-3 * static_cast<double>(k), 1e-3, message), giveway::Status::ok) << message.text;
        }
    }
};

// Its part without errors.
void fit(Variables &v) {
    v.imu_present = true;
    v.imu_acceleration_noise = 0.0;
    v.imu_gyro_noise = 0.0;
    v.imu_vibration = 0.0;
    v.imu_vibration_growth = 0.0;
    v.imu_bandwidth = 0.0;
    v.imu_delay = 0;
    v.slider_present = false;
}

} // namespace

TEST(ImuOnTheRobot, IsThereOnlyIfPresent) {
    Robot robot;
    robot.v().slider_present = false;
    robot.initialise();
    robot.step_to(0.01);
    EXPECT_FALSE(robot.v().sensor_imu_present);
    EXPECT_EQ(robot.v().sensor_imu_counter, 0);
    EXPECT_EQ(robot.v().sensor_acceleration[0], 0.0);
    Robot fitted;
    fit(fitted.v());
    fitted.initialise();
    EXPECT_TRUE(fitted.v().sensor_imu_present);
    const std::int32_t first = fitted.v().sensor_imu_counter;
    fitted.step_to(0.01);
    EXPECT_EQ(fitted.v().sensor_imu_counter, first + 10);
}

TEST(ImuOnTheRobot, TurningPullsItOutwards) {
    Robot robot;
    fit(robot.v());
    robot.v().imu_x = 0.1;
    robot.v().imu_y = -0.2;
    robot.v().imu_azimuth = 0.5;
    robot.v().start_omega = 1.5;
    robot.initialise();
    // omega^2 towards the centre, in axes turned by 0.5; the start is steady.
    const double x = -1.5 * 1.5 * 0.1;
    const double y = 1.5 * 1.5 * 0.2;
    EXPECT_NEAR(robot.v().sensor_acceleration[0], std::cos(0.5) * x + std::sin(0.5) * y, 1e-9);
    EXPECT_NEAR(robot.v().sensor_acceleration[1], std::cos(0.5) * y - std::sin(0.5) * x, 1e-9);
    EXPECT_NEAR(robot.v().sensor_yaw_rate, 1.5, 1e-12);
}

TEST(ImuOnTheRobot, OnAFloorThatFallsItFeelsGravity) {
    for (const bool tipping : {false, true}) {
        Robot robot;
        fit(robot.v());
        robot.v().base_tipping = tipping;
        robot.v().floor_slope = 0.02;
        robot.v().floor_azimuth = 1.0;
        robot.v().start_theta = 0.3;
        robot.initialise();
        robot.step_to(0.5);
        // Held in place, it is pushed uphill. A base that tips leans by another 3e-4 rad.
        const double uphill = -9.81 * std::sin(0.02);
        const double tolerance = tipping ? 0.006 : 1e-6;
        EXPECT_NEAR(robot.v().sensor_acceleration[0], uphill * std::cos(1.0 - 0.3), tolerance);
        EXPECT_NEAR(robot.v().sensor_acceleration[1], uphill * std::sin(1.0 - 0.3), tolerance);
    }
}

TEST(ImuOnTheRobot, ShowsTheAccelerationOfTheInstant) {
    // A push of 300 N on a robot whose drives give way: what it shows summed up is the velocity (trapezoidal rule).
    Robot robot;
    Variables &v = robot.v();
    fit(v);
    v.command_enable = false;
    v.push_force_x = 300.0;
    robot.initialise();
    double sum = 0.5 * v.sensor_acceleration[0];
    EXPECT_GT(v.sensor_acceleration[0], 5.0); // 300 N on 34.7 kg and what rolls: already at the first sample
    for (int k = 0; k < 200; ++k) {
        ASSERT_EQ(robot.model->step(1e-3 * k, 1e-3, robot.message), giveway::Status::ok);
        sum += v.sensor_acceleration[0];
    }
    sum -= 0.5 * v.sensor_acceleration[0];
    EXPECT_GT(v.truth_vx, 0.2);
    // T^2/12 times the change of the jerk, 1e-7 of some 1e4 m/s3.
    EXPECT_NEAR(1e-3 * sum, v.truth_vx, 2e-3);
}

TEST(ImuOnTheRobot, GivesTheSameBitsFromASavedState) {
    std::vector<double> runs[2];
    for (const bool saved : {false, true}) {
        Robot robot;
        fit(robot.v());
        robot.v().imu_acceleration_noise = 0.01;
        robot.v().imu_vibration = 0.1;
        robot.v().imu_bandwidth = 100.0;
        robot.v().imu_delay = 3;
        robot.v().imu_dropout = 0.3;
        robot.initialise();
        for (int k = 0; k < 50; ++k) {
            if (saved && k == 20) {
                std::vector<unsigned char> bytes(robot.model->save_state(nullptr));
                robot.model->save_state(bytes.data());
                robot = Robot{};
                ASSERT_EQ(robot.model->load_state(bytes.data(), bytes.size(), robot.message), giveway::Status::ok);
            }
            ASSERT_EQ(robot.model->step(1e-3 * k, 1e-3, robot.message), giveway::Status::ok);
            runs[saved ? 1 : 0].push_back(robot.v().sensor_acceleration[1]);
        }
    }
    EXPECT_EQ(runs[0], runs[1]);
    EXPECT_GT(rms(runs[0]), 0.01);
}
