// One 2 kHz joint servo of the drives with its encoder, and a delay from reading to torque.
#pragma once

#include <cstdint>

#include "giveway/gw_servo.h"
#include "testbed/delay_line.hpp"
#include "testbed/sensors.hpp"

namespace giveway::drivetrain {

inline constexpr std::int64_t servo_rate_hz = 2000;
inline constexpr int servo_ticks_per_cycle = 2; // of the bus, which brings the reference

struct ServoOptions {
    double kp_nm_per_rad, kd_nms_per_rad, torque_limit_nm, derivative_cutoff_hz;
    std::int32_t encoder_counts;
    int delay_ticks;
};

class ServoAxis {
public:
    // Returns the servo's refusal, empty if there is none.
    gw_config_error_t start(const ServoOptions &options) {
        sensors_.encoder_counts = options.encoder_counts;
        gw_servo_config_t config{};
        config.period_s = 1.0F / static_cast<gw_real_t>(servo_rate_hz);
        config.kp_nm_per_rad = static_cast<gw_real_t>(options.kp_nm_per_rad);
        config.kd_nms_per_rad = static_cast<gw_real_t>(options.kd_nms_per_rad);
        config.torque_limit_nm = static_cast<gw_real_t>(options.torque_limit_nm);
        config.encoder_counts = static_cast<std::uint32_t>(options.encoder_counts);
        config.derivative_cutoff_hz = static_cast<gw_real_t>(options.derivative_cutoff_hz);
        config.stale_ticks_max = 20; // never reached: the reference comes every other tick
        gw_config_error_t error{};
        gw_servo_config_check(&config, &error);
        if (error.field == GW_FIELD_NONE) {
            (void)gw_servo_init(&servo_, &config);
            delayed_.start(options.delay_ticks, [](int) { return 0.0; });
        }
        return error;
    }

    // To be called every tick; returns the torque that acts from now on.
    double regulate(double motor_angle_rad, double reference_angle_rad, double reference_speed_radps,
                    bool reference_is_new) {
        gw_servo_input_t input{};
        input.angle_rad = static_cast<gw_real_t>(reference_angle_rad);
        input.speed_radps = static_cast<gw_real_t>(reference_speed_radps);
        input.reference_is_new = reference_is_new;
        input.enable = true;
        input.encoder_count = testbed::encoder_count(sensors_, 0, motor_angle_rad);
        gw_servo_output_t output{};
        (void)gw_servo_step(&servo_, &input, &output); // a bad reference holds the last angle
        return delayed_.exchange(static_cast<double>(output.torque_nm));
    }

private:
    testbed::SensorOptions sensors_{};
    gw_servo_t servo_{};
    testbed::DelayLine<double> delayed_;
};

} // namespace giveway::drivetrain
