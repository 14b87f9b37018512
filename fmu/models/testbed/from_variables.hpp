// Variables of the FMU -> parameters of plant and drives, and the checks that relate several of them.
#pragma once

#include <algorithm>
#include <cstdio>

#include "drives.hpp"
#include "initial_state.hpp"
#include "model.hpp"
#include "testbed_plant_parameters.hpp"
#include "testbed_variables.hpp"

namespace giveway::testbed {

inline plant::Parameters<double> plant_parameters(const Variables &v) {
    plant::Parameters<double> p{};
    read_plant_parameters(v, p);
    p.wheel_load.fill(1.0);
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
    o.kp_nm_per_rad = v.servo_kp;
    o.kd_nms_per_rad = v.servo_kd;
    o.torque_limit_nm = v.drivetrain_torque_limit;
    o.derivative_cutoff_hz = v.servo_derivative_cutoff;
    o.sensor_delay_cycles = v.electronics_sensor_delay;
    o.command_delay_cycles = v.electronics_command_delay;
    return o;
}

// The shell has checked every single range; these rules relate several variables.
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
    const double wheels_tilt_inertia = 0.5 * wheel_count * v.wheel_inertia;
    if (v.base_tilt_inertia <= wheels_tilt_inertia) {
        return refuse(
            "base.tilt_inertia", v.base_tilt_inertia,
            "greater than that of the wheels about their axles, half of wheel.inertia for each =", wheels_tilt_inertia);
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
