// Variables of the FMU -> parameters of plant and drives, and the checks that relate several of them.
#pragma once

#include <algorithm>
#include <cstdio>

#include "bumper_relations.hpp"
#include "drives.hpp"
#include "imu.hpp"
#include "initial_state.hpp"
#include "model.hpp"
#include "testbed_plant_parameters.hpp"
#include "testbed_variables.hpp"

namespace giveway::testbed {

inline plant::Parameters<double> plant_parameters(const Variables &v) {
    plant::Parameters<double> p{};
    read_plant_parameters(v, p);
    const plant::Vector2<double> com = plant::mass_centre(p);
    for (int i = 0; i < wheel_count; ++i) {
        // A base that tips distributes its weight itself.
        const double share = p.base_tipping != 0 ? 1.0 : plant::static_load_share(p, i, com);
        const double load = share * v.base_mass / v.roller_nominal_mass;
        p.wheel_load[static_cast<std::size_t>(i)] = 1.0 + v.roller_load_growth * (load - 1.0);
    }
    p.wheel_traction.fill(1.0);
    // The parts that a horizontal cut at the contact's height meets; without wheels the body reaches to the floor.
    p.outline_body = !v.outline_wheels || v.contact_height >= v.outline_clearance ? 1 : 0;
    p.outline_wheels = v.outline_wheels && v.contact_height < 2.0 * v.wheel_radius ? 1 : 0;
    return p;
}

inline DriveOptions drive_options(const Variables &v) {
    DriveOptions o{};
    o.sensors.encoder_counts = v.electronics_encoder_counts;
    o.sensors.seed = static_cast<std::uint32_t>(v.electronics_seed);
    o.sensors.torque_noise_nm = v.electronics_torque_noise;
    o.sensors.torque_resolution_nm = v.electronics_torque_resolution;
    o.sensors.torque_range_nm = v.electronics_torque_range;
    o.sensors.torque_offset_nm = std::to_array(v.electronics_torque_offset);
    o.sensors.torque_gain = std::to_array(v.electronics_torque_gain);
    o.sensors.torque_drift_nm_per_s = std::to_array(v.electronics_torque_drift);
    o.sensors.encoder_phase = std::to_array(v.electronics_encoder_phase);
    o.kp_nm_per_rad = v.servo_kp;
    o.kd_nms_per_rad = v.servo_kd;
    o.torque_limit_nm = v.drivetrain_torque_limit;
    o.derivative_cutoff_hz = v.servo_derivative_cutoff;
    o.sensor_delay_cycles = v.electronics_sensor_delay;
    o.command_delay_cycles = v.electronics_command_delay;
    o.sensing = static_cast<Sensing>(v.drivetrain_sensing);
    return o;
}

inline constexpr double half_turn = 3.141592653589793;

// Within the lines between the wheels.
inline bool check_mass_centre(const Variables &v, Message &message) {
    for (int i = 0; i < wheel_count; ++i) {
        const plant::Side side = plant::side_after<wheel_count>(i);
        const double distance = side.cos * v.base_com_x + side.sin * v.base_com_y;
        const double line = plant::Azimuths<wheel_count>::side_distance * v.wheel_distance;
        if (distance >= line) {
            std::snprintf(message.text, sizeof message.text,
                          "base.com_x = %.9g, base.com_y = %.9g is not allowed: the robot falls over, as its centre of "
                          "mass is %.9g m towards a line between two wheels that is %.9g m away",
                          v.base_com_x, v.base_com_y, distance, line);
            return false;
        }
    }
    return true;
}

inline ImuOptions imu_options(const Variables &v) {
    ImuOptions o{};
    o.present = v.imu_present;
    o.seed = static_cast<std::uint32_t>(v.electronics_seed);
    o.acceleration_bias_mps2 = std::to_array(v.imu_acceleration_bias);
    o.acceleration_scale = std::to_array(v.imu_acceleration_scale);
    o.acceleration_noise_mps2 = v.imu_acceleration_noise;
    o.gyro_bias_radps = v.imu_gyro_bias;
    o.gyro_scale = v.imu_gyro_scale;
    o.gyro_noise_radps = v.imu_gyro_noise;
    o.vibration_mps2 = v.imu_vibration;
    o.vibration_growth_s_per_rad = v.imu_vibration_growth;
    o.vibration_frequency_hz = v.imu_vibration_frequency;
    o.vibration_damping = v.imu_vibration_damping;
    o.bandwidth_hz = v.imu_bandwidth;
    o.range_mps2 = v.imu_range;
    o.gyro_range_radps = v.imu_gyro_range;
    o.delay_cycles = v.imu_delay;
    o.dropout = v.imu_dropout;
    o.period_s = bus_period_s;
    return o;
}

// The shell has checked every single range; these rules relate several variables.
// Long because every rule names its variable and says what it may be.
inline bool check_relations(const Variables &v, Message &message) {
    const auto refuse = [&](const char *name, double value, const char *rule, double bound) {
        std::snprintf(message.text, sizeof message.text, "%s = %.9g is not allowed: it must be %s %.9g", name, value,
                      rule, bound);
        return false;
    };
    if (v.drivetrain_gear_stiction < v.drivetrain_gear_coulomb) {
        return refuse("drivetrain.gear_stiction", v.drivetrain_gear_stiction,
                      "at least drivetrain.gear_coulomb =", v.drivetrain_gear_coulomb);
    }
    if (v.bumper_kind != 0 && v.bumper_mount == 0 && v.bumper_plate_mass > 0.95 * v.slider_mass) {
        return refuse("bumper.plate_mass", v.bumper_plate_mass, "at most 0.95 slider.mass =", 0.95 * v.slider_mass);
    }
    if (v.contact_nose_shape == static_cast<int>(plant::NoseShape::edge) && v.bumper_kind != 0 && v.bumper_mount != 0) {
        return refuse("contact.nose_shape", v.contact_nose_shape,
                      "0, a disc, with a bumper on the robot: bumper.mount =", v.bumper_mount);
    }
    if (v.base_tipping && v.bumper_kind != 0 && v.bumper_mount != 0) {
        return refuse("bumper.mount", v.bumper_mount, "0, on the slider, where the base can tip: base.tipping =", 1.0);
    }
    plant::Parameters<double> p{};
    read_plant_parameters(v, p);
    if (!check_bumper(p, message) || !check_mass_centre(v, message)) {
        return false;
    }
    const double wheels_tilt_inertia = 0.5 * wheel_count * v.wheel_inertia;
    if (v.base_tilt_inertia <= wheels_tilt_inertia) {
        return refuse(
            "base.tilt_inertia", v.base_tilt_inertia,
            "greater than that of the wheels about their axles, half of wheel.inertia for each =", wheels_tilt_inertia);
    }
    if (v.roller_arrangement == static_cast<int>(plant::RollerArrangement::discrete)) {
        const int count = v.roller_rows * v.roller_per_row;
        if (count < 6) {
            return refuse("roller.per_row", v.roller_per_row,
                          "such that there are six rollers or more, in rows: roller.rows =", v.roller_rows);
        }
        const double versine = 1.0 - math::sincos(half_turn / count).cos;
        if (v.roller_radius_dip > v.wheel_radius * versine) {
            return refuse("roller.radius_dip", v.roller_radius_dip,
                          "at most that of a wheel with corners instead of rollers =", v.wheel_radius * versine);
        }
        const double lost = v.wheel_radius * versine - v.roller_radius_dip; // by a barrel from its middle to its end
        if (0.8 * v.roller_radius < lost) {
            return refuse("roller.radius", v.roller_radius,
                          "at least 1.25 times what a roller loses towards its end =", 1.25 * lost);
        }
        if (v.roller_row_distance * (v.roller_rows - 1) > v.wheel_distance) {
            return refuse("roller.row_distance", v.roller_row_distance,
                          "such that all rows are within wheel.distance =", v.wheel_distance);
        }
    }
    if (v.outline_wheels && v.outline_clearance > 2.0 * v.wheel_radius) {
        return refuse("outline.clearance", v.outline_clearance,
                      "at most the wheels' height, 2 wheel.radius =", 2.0 * v.wheel_radius);
    }
    const int count = v.outline_count;
    for (int edge = 0; edge < count; ++edge) {
        const int next = (edge + 1) % count;
        const double ex = v.outline_x[next] - v.outline_x[edge];
        const double ey = v.outline_y[next] - v.outline_y[edge];
        for (int i = 0; i < count; ++i) {
            const double left = ex * (v.outline_y[i] - v.outline_y[edge]) - ey * (v.outline_x[i] - v.outline_x[edge]);
            if (i != edge && i != next && !(left > 0.0)) {
                std::snprintf(message.text, sizeof message.text,
                              "outline.x[%d] = %.9g, outline.y[%d] = %.9g is not allowed: it must lie to the left of "
                              "the edge from vertex %d to %d "
                              "(convex, counter-clockwise, no three in a line)",
                              i, v.outline_x[i], i, v.outline_y[i], edge, next);
                return false;
            }
        }
    }
    return true;
}

} // namespace giveway::testbed
