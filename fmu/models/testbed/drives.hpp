// The drive electronics of Fig. 3: a 2 kHz joint servo for each wheel, sensor sampling, and the bus with its latency in
// both directions.
#pragma once

#include <array>
#include <cstdint>

#include "delay_line.hpp"
#include "giveway/gw_servo.h"
#include "sensors.hpp"

namespace giveway::testbed {

inline constexpr std::int64_t servo_rate_hz = 2000;
inline constexpr int servo_ticks_per_cycle = 2;
inline constexpr double bus_period_s = 1e-3;

struct Command {
    PerWheel<double> wheel_angle_rad, wheel_speed_radps;
    bool enable;
};

// What a torque signal shows: the torque behind the gear, or the motor's, which its current is proportional to. The
// gear's friction stands between the two.
enum class Sensing : std::uint8_t { torque_sensor, motor_current };

struct DriveOptions {
    SensorOptions sensors;
    double kp_nm_per_rad, kd_nms_per_rad, torque_limit_nm, derivative_cutoff_hz;
    int sensor_delay_cycles, command_delay_cycles;
    Sensing sensing = Sensing::torque_sensor;
};

class Drives {
public:
    // Before the start the drives followed their reference: earlier cycles moved at the start's wheel speeds, driven by
    // motor_torque_nm. Returns the servo's refusal, empty if there is none.
    gw_config_error_t start(const DriveOptions &options, const PerWheel<double> &motor_angle_rad,
                            const PerWheel<double> &wheel_speed_radps, const PerWheel<double> &torque_nm,
                            const PerWheel<double> &motor_torque_nm, bool enable) {
        options_ = options;
        motor_torque_nm_ = enable ? motor_torque_nm : PerWheel<double>{};
        cycle_ = 0;
        gw_servo_config_t config{};
        config.period_s = 1.0F / static_cast<gw_real_t>(servo_rate_hz);
        config.kp_nm_per_rad = static_cast<gw_real_t>(options.kp_nm_per_rad);
        config.kd_nms_per_rad = static_cast<gw_real_t>(options.kd_nms_per_rad);
        config.torque_limit_nm = static_cast<gw_real_t>(options.torque_limit_nm);
        config.torque_rate_limit_nm_per_s = 0.0F;
        config.encoder_counts = static_cast<std::uint32_t>(options.sensors.encoder_counts);
        config.derivative_cutoff_hz = static_cast<gw_real_t>(options.derivative_cutoff_hz);
        config.stale_ticks_max = stale_ticks;
        gw_config_error_t error{};
        gw_servo_config_check(&config, &error);
        if (error.field != GW_FIELD_NONE) {
            return error;
        }
        for (auto &servo : servos_) {
            (void)gw_servo_init(&servo, &config);
        }
        commands_.start(options.command_delay_cycles, [&](int cycles_ago) {
            Command command{{}, wheel_speed_radps, enable};
            for (std::size_t i = 0; i < wheel_count; ++i) {
                command.wheel_angle_rad[i] = -wheel_speed_radps[i] * bus_period_s * static_cast<double>(cycles_ago);
            }
            return command;
        });
        samples_.start(options.sensor_delay_cycles, [&](int cycles_ago) {
            auto earlier = motor_angle_rad;
            for (std::size_t i = 0; i < wheel_count; ++i) {
                earlier[i] -= wheel_speed_radps[i] * bus_period_s * static_cast<double>(cycles_ago);
            }
            return take_sample(earlier, torque_nm, -cycles_ago, deviates(options_.sensors, -cycles_ago));
        });
        return error;
    }

    // Once per bus cycle, when its time is reached: samples the sensors and returns the controller's present inputs.
    // `torque_nm`: behind the gears. A current is that of the half millisecond before, as the servo acts afterwards.
    SensorSample sample(const PerWheel<double> &motor_angle_rad, const PerWheel<double> &torque_nm) {
        return sample(motor_angle_rad, torque_nm, deviates(options_.sensors, cycle_));
    }
    // The same, with the deviates() of the coming cycle drawn elsewhere.
    SensorSample sample(const PerWheel<double> &motor_angle_rad, const PerWheel<double> &torque_nm,
                        const Deviates &drawn) {
        const SensorSample now = take_sample(motor_angle_rad, torque_nm, cycle_, drawn);
        ++cycle_;
        return samples_.exchange(now);
    }

    // Once per bus cycle, after the controller's command arrived.
    void receive(const Command &command) {
        active_ = commands_.exchange(command);
        reference_is_new_ = true;
    }

    // To be called every servo tick: motor torques, from the drives' own undelayed encoders.
    PerWheel<double> regulate(const PerWheel<double> &motor_angle_rad) {
        PerWheel<double> torque{};
        for (std::size_t i = 0; i < wheel_count; ++i) {
            gw_servo_input_t input{};
            input.angle_rad = static_cast<gw_real_t>(active_.wheel_angle_rad[i]);
            input.speed_radps = static_cast<gw_real_t>(active_.wheel_speed_radps[i]);
            input.reference_is_new = reference_is_new_;
            input.enable = active_.enable;
            input.encoder_count = encoder_count(options_.sensors, i, motor_angle_rad[i]);
            gw_servo_output_t output{};
            (void)gw_servo_step(&servos_[i], &input, &output); // a bad reference holds the last angle
            torque[i] = static_cast<double>(output.torque_nm);
        }
        reference_is_new_ = false;
        motor_torque_nm_ = torque;
        return torque;
    }

    [[nodiscard]] const SensorOptions &sensors() const { return options_.sensors; }

private:
    static constexpr std::uint32_t stale_ticks = 20; // 10 ms without a command: hold

    [[nodiscard]] SensorSample take_sample(const PerWheel<double> &motor_angle_rad, const PerWheel<double> &torque_nm,
                                           std::int64_t cycle, const Deviates &drawn) const {
        const auto &felt_nm = options_.sensing == Sensing::motor_current ? motor_torque_nm_ : torque_nm;
        SensorSample sample{};
        for (std::size_t i = 0; i < wheel_count; ++i) {
            sample.torque_nm[i] =
                measured_torque(options_.sensors, i, felt_nm[i], bus_period_s * static_cast<double>(cycle), drawn[i]);
            sample.encoder_counts[i] = encoder_count(options_.sensors, i, motor_angle_rad[i]);
        }
        sample.counter = static_cast<std::int32_t>(static_cast<std::uint32_t>(cycle + max_delay_cycles));
        return sample;
    }

    DriveOptions options_{};
    PerWheel<gw_servo_t> servos_{};
    DelayLine<Command> commands_;
    DelayLine<SensorSample> samples_;
    Command active_{};
    PerWheel<double> motor_torque_nm_{}; // now
    std::int64_t cycle_ = 0;
    bool reference_is_new_ = false;
};

} // namespace giveway::testbed
