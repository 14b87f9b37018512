// Sensors, bus delay and drives of the testbed: each against what its definition says.
#include <cmath>

#include <gtest/gtest.h>

#include "drives.hpp"

namespace {

using namespace giveway::testbed;

SensorOptions ideal_sensors() { return {8500, 1U, 0.0, 0.0, 28.0, {0.0, 0.0, 0.0}}; }

} // namespace

TEST(DelayLine, HandsOutWhatWentInThatManyCyclesAgo) {
    for (const int delay : {0, 1, 2, 7, max_delay_cycles}) {
        DelayLine<int> line;
        line.start(delay, [](int ago) { return -ago; });
        for (int cycle = 0; cycle < 300; ++cycle) {
            EXPECT_EQ(line.exchange(cycle), cycle - delay);
        }
    }
}

TEST(Sensors, EncoderCountsAreTheFloorAndWrap) {
    const SensorOptions o = ideal_sensors();
    const double count = 2.0 * M_PI / 8500.0;
    EXPECT_EQ(encoder_count(o, 0.0), 0);
    EXPECT_EQ(encoder_count(o, 0.5 * count), 0);
    EXPECT_EQ(encoder_count(o, -0.5 * count), -1);
    EXPECT_EQ(encoder_count(o, 1000.5 * count), 1000);
    EXPECT_EQ(encoder_count(o, -1000.5 * count), -1001);
    EXPECT_EQ(encoder_count(o, (2147483647.0 + 1.5) * count), -2147483647 - 1);
}

TEST(Sensors, TorqueIsOffsetQuantisedAndSaturated) {
    SensorOptions o = ideal_sensors(); // no noise: a deviate counts for nothing
    EXPECT_EQ(measured_torque(o, 0U, 1.234, 9.0), 1.234);
    o.torque_offset_nm = {0.0, 0.5, 0.0};
    EXPECT_EQ(measured_torque(o, 1U, 1.0, 9.0), 1.5);
    o.torque_resolution_nm = 0.25;
    EXPECT_EQ(measured_torque(o, 0U, 1.3, 9.0), 1.25);
    EXPECT_EQ(measured_torque(o, 0U, 1000.0, 9.0), 28.0);
    EXPECT_EQ(measured_torque(o, 0U, -1000.0, 9.0), -28.0);
}

TEST(Sensors, TorqueNoiseHasItsStandardDeviation) {
    SensorOptions o = ideal_sensors();
    o.torque_noise_nm = 0.03;
    constexpr int count = 100'000;
    double square = 0.0;
    for (int cycle = 0; cycle < count; ++cycle) {
        square += std::pow(measured_torque(o, 2U, 0.0, deviates(o, cycle)[2]), 2);
    }
    EXPECT_NEAR(std::sqrt(square / count), 0.03, 0.03 * 5.0 / std::sqrt(2.0 * count)); // five standard errors
}

TEST(Drives, SampleIsDelayedByTheBusAndCounted) {
    DriveOptions o{ideal_sensors(), 200.0, 8.0, 20.0, 60.0, 3, 0};
    Drives drives;
    ASSERT_EQ(drives.start(o, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {1.0, 2.0, 3.0}, true).field, GW_FIELD_NONE);
    std::int32_t before = 0;
    for (int cycle = 0; cycle < 10; ++cycle) {
        const auto sample = drives.sample({0.0, 0.0, 0.0}, {10.0 + cycle, 0.0, 0.0});
        EXPECT_EQ(sample.torque_nm[0], cycle < 3 ? 1.0 : 10.0 + (cycle - 3));
        if (cycle > 0) {
            EXPECT_EQ(sample.counter, before + 1);
        }
        before = sample.counter;
    }
}

TEST(Drives, CommandReachesTheServoAfterTheBusDelay) {
    DriveOptions o{ideal_sensors(), 200.0, 0.0, 20.0, 60.0, 0, 2};
    Drives drives;
    ASSERT_EQ(drives.start(o, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, true).field, GW_FIELD_NONE);
    for (int cycle = 0; cycle < 5; ++cycle) {
        drives.receive({{0.05, 0.0, -0.05}, {0.0, 0.0, 0.0}, true});
        for (int tick = 0; tick < servo_ticks_per_cycle; ++tick) {
            const auto torque = drives.regulate({0.0, 0.0, 0.0});
            // Kp times the error; float rounding.
            EXPECT_NEAR(torque[0], cycle < 2 ? 0.0 : 10.0, 1e-5);
            EXPECT_NEAR(torque[2], cycle < 2 ? 0.0 : -10.0, 1e-5);
        }
    }
}

TEST(Drives, RefusesServoGainsOutOfRange) {
    DriveOptions o{ideal_sensors(), -1.0, 8.0, 20.0, 60.0, 1, 1};
    Drives drives;
    EXPECT_EQ(drives.start(o, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, true).field, GW_FIELD_SERVO_KP);
}
