// Torque sensors and encoders of the drives: noise, offset, quantisation, saturation.
#pragma once

#include <array>
#include <cstdint>

#include "noise.hpp"
#include "plant_parameters.hpp"

namespace giveway::testbed {

inline constexpr int wheel_count = plant::table_wheels;
template <class Value> using PerWheel = std::array<Value, wheel_count>;

struct SensorOptions {
    std::int32_t encoder_counts; // per turn of the wheel axle
    std::uint32_t seed;
    double torque_noise_nm, torque_resolution_nm, torque_range_nm;
    PerWheel<double> torque_offset_nm, torque_gain, torque_drift_nm_per_s;
    PerWheel<double> encoder_phase; // counts at angle 0, [0, 1]
};

struct SensorSample {
    PerWheel<double> torque_nm;
    PerWheel<std::int32_t> encoder_counts;
    std::int32_t counter;
};

// Counts of the motor encoder, wrapping like a 32-bit counter.
inline std::int32_t encoder_count(const SensorOptions &options, std::size_t wheel, double angle_rad) {
    const double turns = angle_rad / 6.283185307179586;
    const double counts = turns * static_cast<double>(options.encoder_counts) + options.encoder_phase[wheel];
    auto whole = static_cast<std::int64_t>(counts);
    whole -= counts < static_cast<double>(whole) ? 1 : 0; // floor
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(whole));
}

// The noise of a sample before scaling: one standard normal deviate per torque sensor.
using Deviates = PerWheel<double>;
inline Deviates deviates(const SensorOptions &options, std::int64_t cycle) {
    Deviates found{};
    for (std::uint32_t wheel = 0; options.torque_noise_nm > 0.0 && wheel < found.size(); ++wheel) {
        found[wheel] = math::normal(options.seed, wheel, static_cast<std::uint64_t>(cycle));
    }
    return found;
}

// time_s: since the start.
inline double measured_torque(const SensorOptions &options, std::size_t wheel, double torque_nm, double time_s,
                              double deviate) {
    double value = options.torque_gain[wheel] * torque_nm + options.torque_offset_nm[wheel] +
                   options.torque_drift_nm_per_s[wheel] * time_s;
    if (options.torque_noise_nm > 0.0) {
        value += options.torque_noise_nm * deviate;
    }
    if (options.torque_resolution_nm > 0.0) {
        value = options.torque_resolution_nm * math::round(value / options.torque_resolution_nm);
    }
    return math::clamp(value, -options.torque_range_nm, options.torque_range_nm);
}

} // namespace giveway::testbed
