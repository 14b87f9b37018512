// Sensors, bus delay and drives of the testbed, each against its definition.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "drives.hpp"

namespace {

using namespace giveway::testbed;

SensorOptions ideal_sensors() { return {8500, 1U, 0.0, 0.0, 28.0, {}, {1.0, 1.0, 1.0}, {}, {}}; }

// By Box and Muller with the C library's functions, from the generator that has published answers (tests/fmu/math).
double deviate_of(std::uint32_t seed, std::uint32_t wheel, std::int64_t cycle) {
    const auto tick = static_cast<std::uint64_t>(cycle);
    const auto words = giveway::math::philox4x32(
        {static_cast<std::uint32_t>(tick), static_cast<std::uint32_t>(tick >> 32U), wheel, 0U}, {seed, 0x67697665U});
    const double radius = std::sqrt(-2.0 * std::log((words[0] + 0.5) / 4294967296.0));
    return radius * std::cos(2.0 * M_PI * (words[1] + 0.5) / 4294967296.0);
}
constexpr double deviate_rounding = 1e-13; // of a deviate below 7, in logarithm, root and cosine

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
    EXPECT_EQ(encoder_count(o, 0U, 0.0), 0);
    EXPECT_EQ(encoder_count(o, 0U, 0.5 * count), 0);
    EXPECT_EQ(encoder_count(o, 0U, -0.5 * count), -1);
    EXPECT_EQ(encoder_count(o, 0U, 1000.5 * count), 1000);
    EXPECT_EQ(encoder_count(o, 0U, -1000.5 * count), -1001);
    EXPECT_EQ(encoder_count(o, 0U, (2147483647.0 + 1.5) * count), -2147483647 - 1);
}

TEST(Sensors, AnEncoderStandsAnywhereWithinACount) {
    SensorOptions o = ideal_sensors();
    const double count = 2.0 * M_PI / 8500.0;
    o.encoder_phase = {0.0, 0.25, 1.0};
    for (int i = -1000; i < 1000; ++i) {
        const double angle = (static_cast<double>(i) + 0.1) * 0.01 * count; // never on an edge
        for (std::size_t wheel = 0; wheel < 3; ++wheel) {
            const double exact = angle / count + o.encoder_phase[wheel];
            EXPECT_EQ(encoder_count(o, wheel, angle), static_cast<std::int32_t>(std::floor(exact)));
        }
    }
    EXPECT_EQ(encoder_count(o, 1U, 0.0), 0);
}

TEST(Sensors, TorqueHasAGainAndAZeroThatDrifts) {
    SensorOptions o = ideal_sensors();
    o.torque_offset_nm = {0.5, 0.0, 0.0};
    o.torque_gain = {1.03, 0.97, 1.0};
    o.torque_drift_nm_per_s = {0.0, 0.01, -0.02};
    EXPECT_EQ(measured_torque(o, 0U, 2.0, 100.0, 9.0), 1.03 * 2.0 + 0.5);
    EXPECT_EQ(measured_torque(o, 1U, 2.0, 100.0, 9.0), 0.97 * 2.0 + 1.0);
    EXPECT_EQ(measured_torque(o, 2U, 2.0, -1.0, 9.0), 2.02);
    o.torque_noise_nm = 0.1; // after the gain
    EXPECT_EQ(measured_torque(o, 0U, 2.0, 0.0, 3.0), 1.03 * 2.0 + 0.5 + 0.1 * 3.0);
}

TEST(Sensors, TorqueIsOffsetQuantisedAndSaturated) {
    SensorOptions o = ideal_sensors(); // no noise: a deviate counts for nothing
    EXPECT_EQ(measured_torque(o, 0U, 1.234, 0.0, 9.0), 1.234);
    o.torque_offset_nm = {0.0, 0.5, 0.0};
    EXPECT_EQ(measured_torque(o, 1U, 1.0, 0.0, 9.0), 1.5);
    o.torque_resolution_nm = 0.25;
    EXPECT_EQ(measured_torque(o, 0U, 1.3, 0.0, 9.0), 1.25);
    EXPECT_EQ(measured_torque(o, 0U, 1000.0, 0.0, 9.0), 28.0);
    EXPECT_EQ(measured_torque(o, 0U, -1000.0, 0.0, 9.0), -28.0);
}

TEST(Sensors, TorqueIsRoundedToTheNearestStep) {
    SensorOptions o = ideal_sensors();
    for (const double step_nm : {0.25, 0.1, 0.013}) {
        o.torque_resolution_nm = step_nm;
        for (int i = -2000; i <= 2000; ++i) {
            const double torque_nm = 1e-3 * i;
            const double found = measured_torque(o, 0U, torque_nm, 0.0, 0.0);
            EXPECT_NEAR(found / step_nm, std::nearbyint(found / step_nm), 1e-12); // a whole number of steps
            EXPECT_LE(std::fabs(found - torque_nm), 0.5 * step_nm * (1.0 + 1e-12)) << torque_nm; // the nearest
        }
    }
    o.torque_resolution_nm = 0.25;
    for (const auto &[torque_nm, expected] : {std::pair{1.4, 1.5},
                                              {1.3, 1.25},
                                              {-1.3, -1.25},
                                              {-1.4, -1.5},
                                              {0.124, 0.0},
                                              {-0.124, 0.0},
                                              {0.125, 0.0},
                                              {0.375, 0.5},
                                              {-0.375, -0.5}}) { // halves to even
        EXPECT_EQ(measured_torque(o, 0U, torque_nm, 0.0, 0.0), expected) << torque_nm;
    }
}

TEST(Sensors, EachWheelHasItsOwnNoise) {
    SensorOptions o = ideal_sensors();
    o.torque_noise_nm = 0.03;
    o.seed = 4711U;
    for (const std::int64_t cycle :
         {std::int64_t{-3}, std::int64_t{0}, std::int64_t{1}, std::int64_t{999}, std::int64_t{1} << 33}) {
        const Deviates found = deviates(o, cycle);
        for (std::uint32_t wheel = 0; wheel < 3U; ++wheel) {
            EXPECT_NEAR(found[wheel], deviate_of(4711U, wheel, cycle), deviate_rounding);
        }
    }
    o.torque_noise_nm = 0.0; // draws none
    EXPECT_EQ(deviates(o, 5), (Deviates{0.0, 0.0, 0.0}));
}

TEST(Sensors, TorqueNoiseHasItsStandardDeviation) {
    SensorOptions o = ideal_sensors();
    o.torque_noise_nm = 0.03;
    constexpr int count = 100'000;
    double square = 0.0;
    for (int cycle = 0; cycle < count; ++cycle) {
        square += std::pow(measured_torque(o, 2U, 0.0, 0.0, deviates(o, cycle)[2]), 2);
    }
    EXPECT_NEAR(std::sqrt(square / count), 0.03, 0.03 * 5.0 / std::sqrt(2.0 * count)); // five standard errors
}

TEST(Drives, SampleIsDelayedByTheBusAndCounted) {
    DriveOptions o{ideal_sensors(), 200.0, 8.0, 20.0, 60.0, 3, 0};
    Drives drives;
    ASSERT_EQ(drives.start(o, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {1.0, 2.0, 3.0}, {}, true).field, GW_FIELD_NONE);
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

TEST(Drives, SampleIsOfEachWheelsOwnTorqueNoiseOffsetAndEncoder) {
    DriveOptions o{ideal_sensors(), 200.0, 8.0, 20.0, 60.0, 0, 0};
    o.sensors.seed = 7U;
    o.sensors.torque_noise_nm = 0.1;
    o.sensors.torque_offset_nm = {0.01, -0.02, 0.03};
    Drives drives;
    ASSERT_EQ(drives.start(o, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {}, true).field, GW_FIELD_NONE);
    const double count = 2.0 * M_PI / 8500.0;
    for (int cycle = 0; cycle < 5; ++cycle) {
        const auto sample = drives.sample({10.5 * count, -20.5 * count, 30.5 * count}, {1.0, 2.0, 3.0});
        for (std::uint32_t wheel = 0; wheel < 3U; ++wheel) {
            const double expected =
                1.0 + wheel + o.sensors.torque_offset_nm[wheel] + 0.1 * deviate_of(7U, wheel, cycle);
            EXPECT_NEAR(sample.torque_nm[wheel], expected, 0.1 * deviate_rounding + 1e-15);
        }
        EXPECT_EQ(sample.encoder_counts, (std::array<std::int32_t, 3>{10, -21, 30}));
    }
}

TEST(Drives, ACurrentIsThatBeforeTheServoActs) {
    DriveOptions o{ideal_sensors(), 200.0, 0.0, 20.0, 60.0, 1, 0, Sensing::motor_current};
    o.sensors.torque_gain = {2.0, 1.0, 1.0};
    o.sensors.torque_resolution_nm = 0.5;
    Drives drives;
    const std::array<double, 3> held{0.3, 1.2, -0.8};
    ASSERT_EQ(drives.start(o, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {7.0, 7.0, 7.0}, held, true).field, GW_FIELD_NONE);
    using Torques = std::array<double, 3>;
    std::vector<Torques> found;
    for (int cycle = 0; cycle < 3; ++cycle) { // the torques behind the gears count for nothing
        found.push_back(drives.sample({0.0, 0.0, 0.0}, {9.0, 9.0, 9.0}).torque_nm);
        drives.receive({{0.01 * (cycle + 1), 0.0, 0.0}, {0.0, 0.0, 0.0}, true});
        EXPECT_NEAR(drives.regulate({0.0, 0.0, 0.0})[0], 2.0 * (cycle + 1), 1e-5); // float rounding
    }
    // One cycle late; that of the start twice, then that of the first cycle's servo. Gain, then quantum.
    EXPECT_EQ(found, (std::vector<Torques>{{0.5, 1.0, -1.0}, {0.5, 1.0, -1.0}, {4.0, 0.0, 0.0}}));
    ASSERT_EQ(drives.start(o, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {7.0, 7.0, 7.0}, held, false).field, GW_FIELD_NONE);
    EXPECT_EQ(drives.sample({0.0, 0.0, 0.0}, {9.0, 9.0, 9.0}).torque_nm, (Torques{0.0, 0.0, 0.0})); // no power
}

TEST(Drives, BeforeTheStartTheWheelsTurnedAtTheirSpeed) {
    DriveOptions o{ideal_sensors(), 200.0, 0.0, 20.0, 60.0, 3, 2};
    const double count = 2.0 * M_PI / 8500.0;
    const std::array<double, 3> speed{100e3 * count, 0.0, -50e3 * count}; // counts per second
    Drives drives;
    ASSERT_EQ(drives.start(o, {0.5 * count, 0.5 * count, 0.5 * count}, speed, {0.0, 0.0, 0.0}, {}, true).field,
              GW_FIELD_NONE);
    for (int cycle = 0; cycle < 3; ++cycle) {
        const int ago = 3 - cycle;
        const auto sample = drives.sample({0.0, 0.0, 0.0}, {0.0, 0.0, 0.0});
        EXPECT_EQ(sample.encoder_counts, (std::array<std::int32_t, 3>{-100 * ago, 0, 50 * ago}));
    }
    for (int cycle = 0; cycle < 2; ++cycle) {
        drives.receive({{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, true});
        const int ago = 2 - cycle;
        // Kp times the reference's angle, which equalled the wheel's angle then; float rounding.
        EXPECT_NEAR(drives.regulate({0.0, 0.0, 0.0})[2], 200.0 * 50.0 * count * ago, 1e-5);
    }
}

TEST(Drives, WithoutDelayACommandActsAndASampleComesAtOnce) {
    DriveOptions o{ideal_sensors(), 200.0, 0.0, 20.0, 60.0, 0, 0};
    Drives drives;
    ASSERT_EQ(drives.start(o, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {}, true).field, GW_FIELD_NONE);
    for (int cycle = 1; cycle < 5; ++cycle) {
        EXPECT_EQ(drives.sample({0.0, 0.0, 0.0}, {1.0 * cycle, 0.0, 0.0}).torque_nm[0], cycle);
        drives.receive({{0.01 * cycle, 0.0, 0.0}, {0.0, 0.0, 0.0}, true});
        EXPECT_NEAR(drives.regulate({0.0, 0.0, 0.0})[0], 2.0 * cycle, 1e-5); // Kp times the angle; float rounding
    }
}

TEST(Drives, BetweenCommandsTheReferenceMovesOnAndThenStops) {
    DriveOptions o{ideal_sensors(), 200.0, 0.0, 20.0, 60.0, 0, 0};
    Drives drives;
    ASSERT_EQ(drives.start(o, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {}, true).field, GW_FIELD_NONE);
    constexpr double angle_rad = 0.01;
    constexpr double speed_radps = 2.0;
    constexpr double tick_s = 1.0 / servo_rate_hz;
    for (int cycle = 0; cycle < 3; ++cycle) { // each command starts from its own angle
        drives.receive({{angle_rad, 0.0, 0.0}, {speed_radps, 0.0, 0.0}, true});
        for (int tick = 0; tick < servo_ticks_per_cycle; ++tick) {
            EXPECT_NEAR(drives.regulate({0.0, 0.0, 0.0})[0], 200.0 * (angle_rad + speed_radps * tick_s * tick), 1e-5);
        }
    }
    // 10 ms after the last command, at the twentieth tick without one, it holds.
    for (int tick = servo_ticks_per_cycle; tick < 60; ++tick) {
        const double moved_s = tick_s * std::min(tick, 19);
        EXPECT_NEAR(drives.regulate({0.0, 0.0, 0.0})[0], 200.0 * (angle_rad + speed_radps * moved_s), 1e-4)
            << tick; // twenty sums in float
    }
}

TEST(Drives, CommandReachesTheServoAfterTheBusDelay) {
    DriveOptions o{ideal_sensors(), 200.0, 0.0, 20.0, 60.0, 0, 2};
    Drives drives;
    ASSERT_EQ(drives.start(o, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {}, true).field, GW_FIELD_NONE);
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
    EXPECT_EQ(drives.start(o, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {}, true).field, GW_FIELD_SERVO_KP);
}
