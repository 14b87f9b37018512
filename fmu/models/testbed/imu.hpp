// Accelerometer and gyro of the robot, a small MEMS part on its body: vibration of the structure, the part's low-pass
// filter, scale, bias, noise, range, delay and lost samples.
#pragma once

#include <array>
#include <cstdint>

#include "delay_line.hpp"
#include "noise.hpp"
#include "sensors.hpp"

namespace giveway::testbed {

inline constexpr int imu_axes = 2; // along the floor

struct ImuOptions {
    bool present;
    std::uint32_t seed;
    std::array<double, imu_axes> acceleration_bias_mps2, acceleration_scale;
    double acceleration_noise_mps2, gyro_bias_radps, gyro_scale, gyro_noise_radps;
    double vibration_mps2, vibration_growth_s_per_rad; // rms at rest; its relative growth with the wheels' speed
    double vibration_frequency_hz, vibration_damping;
    double bandwidth_hz; // 0: no filter
    double range_mps2, gyro_range_radps;
    int delay_cycles;
    double dropout; // share of lost samples
    double period_s;
};

// Without errors, at the instant of the sample: neither an average over the cycle nor a difference.
struct ImuTruth {
    std::array<double, imu_axes> specific_force_mps2; // along the sensor's axes
    double yaw_rate_radps;
    double wheel_speed_radps; // mean magnitude
};

struct ImuSample {
    std::array<double, imu_axes> acceleration_mps2;
    double yaw_rate_radps;
    std::int32_t counter;
};

// The noise of a sample before scaling: channels after those of the torque sensors. Acceleration, yaw rate, vibration.
inline constexpr std::uint32_t imu_first_channel = wheel_count;
using ImuDeviates = std::array<double, 2 * imu_axes + 1>;
inline ImuDeviates imu_deviates(const ImuOptions &options, std::int64_t cycle) {
    ImuDeviates found{};
    for (std::uint32_t i = 0; i < found.size(); ++i) {
        found[i] = math::normal(options.seed, imu_first_channel + i, static_cast<std::uint64_t>(cycle));
    }
    return found;
}
inline constexpr std::uint32_t imu_dropout_channel = imu_first_channel + ImuDeviates{}.size();

// A resonance driven by white noise, of unit variance: a mass on a spring at sampling instants.
class Resonance {
public:
    // `earlier`, `before`: deviates that make its first two values.
    void start(double angular_frequency_radps, double damping, double period_s, double earlier, double before) {
        const double decay = math::exp(-damping * angular_frequency_radps * period_s);
        const double turn = angular_frequency_radps * math::sqrt(1.0 - damping * damping) * period_s;
        last_gain_ = 2.0 * decay * math::sincos(turn).cos;
        earlier_gain_ = -decay * decay;
        const double correlation = last_gain_ / (1.0 - earlier_gain_); // of two neighbours
        drive_ = math::sqrt((1.0 + earlier_gain_) * ((1.0 - earlier_gain_) - last_gain_ * correlation));
        earlier_ = earlier;
        last_ = correlation * earlier + math::sqrt(1.0 - correlation * correlation) * before;
    }
    double step(double deviate) {
        const double now = last_gain_ * last_ + earlier_gain_ * earlier_ + drive_ * deviate;
        earlier_ = last_;
        last_ = now;
        return now;
    }

private:
    double last_gain_ = 0.0, earlier_gain_ = 0.0, drive_ = 0.0;
    double last_ = 0.0, earlier_ = 0.0;
};

// Plain data: a copy is a checkpoint.
class Imu {
public:
    // Before the start the robot moved as at the start.
    void start(const ImuOptions &options, const ImuTruth &truth) {
        options_ = options;
        if (!options_.present) {
            return;
        }
        const double omega = 6.283185307179586 * options_.vibration_frequency_hz;
        cycle_ = -options_.delay_cycles - 1;
        const ImuDeviates earlier = imu_deviates(options_, cycle_ - 2);
        const ImuDeviates before = imu_deviates(options_, cycle_ - 1);
        for (std::size_t axis = 0; axis < imu_axes; ++axis) {
            vibration_[axis].start(omega, options_.vibration_damping, options_.period_s, earlier[vibration(axis)],
                                   before[vibration(axis)]);
        }
        passed_ = options_.bandwidth_hz > 0.0
                      ? 1.0 - math::exp(-6.283185307179586 * options_.bandwidth_hz * options_.period_s)
                      : 1.0;
        filtered_ = {truth.specific_force_mps2[0], truth.specific_force_mps2[1], truth.yaw_rate_radps};
        std::array<ImuSample, max_delay_cycles + 1> history{};
        const int length = options_.delay_cycles + 1;
        for (int i = 0; i < length; ++i, ++cycle_) {
            history[static_cast<std::size_t>(i)] = take_sample(truth, imu_deviates(options_, cycle_));
        }
        arrived_ = history[0];
        line_.start(options_.delay_cycles,
                    [&](int cycles_ago) { return history[static_cast<std::size_t>(length - cycles_ago)]; });
    }

    [[nodiscard]] const ImuOptions &options() const { return options_; }

    // Once per bus cycle, if it is present: takes a sample and returns the latest that has arrived.
    ImuSample sample(const ImuTruth &truth) { return sample(truth, imu_deviates(options_, cycle_)); }
    // The same, with the imu_deviates() of the coming cycle drawn elsewhere.
    ImuSample sample(const ImuTruth &truth, const ImuDeviates &drawn) {
        const ImuSample arriving = line_.exchange(take_sample(truth, drawn));
        const bool lost =
            options_.dropout > 0.0 &&
            math::uniform(options_.seed, imu_dropout_channel, static_cast<std::uint64_t>(cycle_)) < options_.dropout;
        ++cycle_;
        if (!lost) {
            arrived_ = arriving;
        }
        return arrived_;
    }

private:
    static constexpr std::size_t vibration(std::size_t axis) { return imu_axes + 1 + axis; } // its deviate

    ImuSample take_sample(const ImuTruth &truth, const ImuDeviates &drawn) {
        const double shaking =
            options_.vibration_mps2 * (1.0 + options_.vibration_growth_s_per_rad * truth.wheel_speed_radps);
        const auto filter = [&](std::size_t i, double value) {
            filtered_[i] += passed_ * (value - filtered_[i]);
            return filtered_[i];
        };
        ImuSample sample{};
        for (std::size_t axis = 0; axis < imu_axes; ++axis) {
            const double force =
                filter(axis, truth.specific_force_mps2[axis] + shaking * vibration_[axis].step(drawn[vibration(axis)]));
            sample.acceleration_mps2[axis] =
                math::clamp(options_.acceleration_scale[axis] * force + options_.acceleration_bias_mps2[axis] +
                                options_.acceleration_noise_mps2 * drawn[axis],
                            -options_.range_mps2, options_.range_mps2);
        }
        sample.yaw_rate_radps = math::clamp(options_.gyro_scale * filter(imu_axes, truth.yaw_rate_radps) +
                                                options_.gyro_bias_radps + options_.gyro_noise_radps * drawn[imu_axes],
                                            -options_.gyro_range_radps, options_.gyro_range_radps);
        sample.counter = static_cast<std::int32_t>(static_cast<std::uint32_t>(cycle_ + max_delay_cycles + 1));
        return sample;
    }

    ImuOptions options_{};
    std::array<Resonance, imu_axes> vibration_{};
    double passed_ = 1.0;
    std::array<double, imu_axes + 1> filtered_{};
    DelayLine<ImuSample> line_;
    ImuSample arrived_{};
    std::int64_t cycle_ = 0;
};

} // namespace giveway::testbed
