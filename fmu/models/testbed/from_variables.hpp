// Variables of the FMU -> parameters of plant and drives, and the checks that relate several of them.
#pragma once

#include <algorithm>
#include <cstdio>

#include "drives.hpp"
#include "initial_state.hpp"
#include "model.hpp"
#include "testbed_variables.hpp"

namespace giveway::testbed {

inline plant::Parameters<double> plant_parameters(const Variables& v) {
    plant::Parameters<double> p{};
    p.mass = v.base_mass;
    p.yaw_inertia = v.base_yaw_inertia;
    p.wheel_radius = v.wheel_radius;
    p.wheel_distance = v.wheel_distance;
    p.wheel_inertia = v.wheel_inertia;
    p.roller_radius = v.roller_radius;
    p.roller_inertia = v.roller_inertia;
    p.wheel_load = {1.0, 1.0, 1.0};
    p.wheel_traction = {1.0, 1.0, 1.0};
    p.tipping = v.base_tipping ? 1 : 0;
    p.tilt_inertia = v.base_tilt_inertia;
    p.com_height = v.base_com_height;
    p.floor_contact_stiffness = v.wheel_floor_stiffness;
    p.floor_contact_damping = v.wheel_floor_damping;
    p.grip_friction = v.wheel_grip_friction;
    p.grip_stiffness = v.wheel_grip_stiffness;
    p.grip_damping = v.wheel_grip_damping;
    p.push_height = v.push_height;
    p.roller_model = static_cast<plant::RollerModel>(v.roller_model);
    p.roller_torque = v.roller_coulomb_torque;
    p.roller_slope = v.roller_tanh_slope;
    std::copy_n(v.roller_presliding_stiffness, 3, p.roller_presliding_stiffness.begin());
    p.roller_presliding_damping = v.roller_presliding_damping;
    p.roller_stribeck_speed = v.roller_stribeck_speed;
    p.roller_elastic_fraction = v.roller_elastic_fraction;
    p.motor_inertia = v.drivetrain_motor_inertia;
    p.drivetrain_stiffness = v.drivetrain_stiffness;
    p.drivetrain_damping = v.drivetrain_damping;
    p.gear_coulomb = v.drivetrain_gear_coulomb;
    p.gear_stiction = v.drivetrain_gear_stiction;
    p.gear_viscous = v.drivetrain_gear_viscous;
    p.torque_limit = v.drivetrain_torque_limit;
    p.slider_present = v.slider_present ? 1 : 0;
    p.slider_mass = v.slider_mass;
    p.slider_friction = v.slider_friction;
    p.slider_friction_speed = v.slider_friction_speed;
    p.slider_damping = v.slider_damping;
    p.rail_direction = v.slider_direction;
    p.target_x = v.slider_target_x;
    p.target_y = v.slider_target_y;
    p.run_up = v.slider_run_up;
    p.wall_present = v.wall_present ? 1 : 0;
    p.wall_distance = v.wall_distance;
    p.wall_stiffness = v.wall_stiffness;
    p.wall_damping = v.wall_damping;
    p.rope_attached = v.rope_attached ? 1 : 0;
    p.hanging_mass = v.rope_hanging_mass;
    p.rope_stiffness = v.rope_stiffness;
    p.rope_damping = v.rope_damping;
    p.drop_height = v.rope_drop_height;
    p.floor_stiffness = v.rope_floor_stiffness;
    p.floor_damping = v.rope_floor_damping;
    p.bumper_kind = static_cast<plant::BumperKind>(v.bumper_kind);
    p.bumper_mount = static_cast<plant::BumperMount>(v.bumper_mount);
    p.latch_model = static_cast<plant::LatchModel>(v.bumper_latch_model);
    p.plate_mass = v.bumper_plate_mass;
    p.spring_rate = v.bumper_spring_rate;
    p.preload = v.bumper_preload;
    p.bumper_damping = v.bumper_damping;
    p.guide_friction = v.bumper_guide_friction;
    p.guide_friction_speed = v.bumper_guide_friction_speed;
    p.travel = v.bumper_travel;
    p.stop_stiffness = v.bumper_stop_stiffness;
    p.stop_damping = v.bumper_stop_damping;
    p.latch_force = v.bumper_latch_force;
    p.latch_gap = v.bumper_latch_gap;
    p.mount_x = v.bumper_mount_x;
    p.mount_y = v.bumper_mount_y;
    p.mount_azimuth = v.bumper_mount_azimuth;
    p.nose_shape = static_cast<plant::NoseShape>(v.contact_nose_shape);
    p.nose_radius = v.contact_nose_radius;
    p.contact_stiffness = v.contact_stiffness;
    p.contact_damping = v.contact_damping;
    p.contact_friction = v.contact_friction;
    p.contact_friction_speed = v.contact_friction_speed;
    p.contact_height = v.contact_height;
    // What a cut at the contact's height goes through; without wheels the body reaches to the floor.
    p.outline_body = !v.outline_wheels || v.contact_height >= v.outline_clearance ? 1 : 0;
    p.outline_wheels = v.outline_wheels && v.contact_height < 2.0 * v.wheel_radius ? 1 : 0;
    p.wheel_width = v.wheel_width;
    p.outline_count = v.outline_count;
    std::copy_n(v.outline_x, plant::max_outline_vertices, p.outline_x.begin());
    std::copy_n(v.outline_y, plant::max_outline_vertices, p.outline_y.begin());
    return p;
}

inline DriveOptions drive_options(const Variables& v) {
    DriveOptions o{};
    o.sensors.encoder_counts = v.electronics_encoder_counts;
    o.sensors.seed = static_cast<std::uint32_t>(v.electronics_seed);
    o.sensors.torque_noise_nm = v.electronics_torque_noise;
    o.sensors.torque_resolution_nm = v.electronics_torque_resolution;
    o.sensors.torque_range_nm = v.electronics_torque_range;
    std::copy_n(v.electronics_torque_offset, 3, o.sensors.torque_offset_nm.begin());
    o.kp_nm_per_rad = v.servo_kp;
    o.kd_nms_per_rad = v.servo_kd;
    o.torque_limit_nm = v.drivetrain_torque_limit;
    o.derivative_cutoff_hz = v.servo_derivative_cutoff;
    o.sensor_delay_cycles = v.electronics_sensor_delay;
    o.command_delay_cycles = v.electronics_command_delay;
    return o;
}

// The shell has checked every single range; these rules relate several variables.
inline bool check_relations(const Variables& v, Message& message) {
    const auto refuse = [&](const char* name, double value, const char* rule, double bound) {
        std::snprintf(message.text, sizeof message.text, "%s = %.9g is not allowed: it must be %s %.9g", name, value, rule, bound);
        return false;
    };
    if (v.drivetrain_gear_stiction < v.drivetrain_gear_coulomb) {
        return refuse("drivetrain.gear_stiction", v.drivetrain_gear_stiction, "at least drivetrain.gear_coulomb =", v.drivetrain_gear_coulomb);
    }
    if (v.bumper_kind != 0 && v.bumper_mount == 0 && v.bumper_plate_mass > 0.95 * v.slider_mass) {
        return refuse("bumper.plate_mass", v.bumper_plate_mass, "at most 0.95 slider.mass =", 0.95 * v.slider_mass);
    }
    if (v.contact_nose_shape == static_cast<int>(plant::NoseShape::edge) && v.bumper_kind != 0 && v.bumper_mount != 0) {
        return refuse("contact.nose_shape", v.contact_nose_shape, "0, a disc, with a bumper on the robot: bumper.mount =", v.bumper_mount);
    }
    if (v.base_tipping && v.bumper_kind != 0 && v.bumper_mount != 0) {
        return refuse("bumper.mount", v.bumper_mount, "0, on the slider, where the base can tip: base.tipping =", 1.0);
    }
    const double wheels_tilt_inertia = 1.5 * v.wheel_inertia;
    if (v.base_tilt_inertia <= wheels_tilt_inertia) {
        return refuse("base.tilt_inertia", v.base_tilt_inertia, "greater than that of the wheels about their axles, 1.5 wheel.inertia =", wheels_tilt_inertia);
    }
    if (v.outline_wheels && v.outline_clearance > 2.0 * v.wheel_radius) {
        return refuse("outline.clearance", v.outline_clearance, "at most the wheels' height, 2 wheel.radius =", 2.0 * v.wheel_radius);
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
                              "outline.x[%d] = %.9g, outline.y[%d] = %.9g is not allowed: it must lie to the left of the edge from vertex %d to %d "
                              "(convex, counter-clockwise, no three in a line)",
                              i, v.outline_x[i], i, v.outline_y[i], edge, next);
                return false;
            }
        }
    }
    return true;
}

} // namespace giveway::testbed
