// Quantities that the equations need often and that are constant during a run.
#pragma once

#include "base.hpp"

namespace giveway::plant {

template <class T> struct Derived {
    T rail_x, rail_y;                         // unit vector of travel, world frame
    T origin_x, origin_y;                     // nose centre at s = 0, c = 0, world frame
    T plate_x, plate_y;                       // unit outward vector of a robot-mounted plate, base frame
    math::Divisor<T> carriage_mass;           // slider without a plate that moves on its own
    math::Divisor<T> roller_plastic_fraction; // of a bristle's force, in which it slips more and more
    // Of rollers one by one: from one to the next (rad); of a barrel along its roller's axis the radius (m), and how
    // far outside the wheel's axle its centre is (m); see level_of_rollers().
    T roller_pitch, barrel_radius, barrel_offset, roller_level;
    T rope_pretension_length; // ext0
    T downhill_x, downhill_y; // gravity along the floor, world frame, m/s2
    T floor_gravity;          // gravity across it
    T imu_cos, imu_sin;       // direction of the accelerometer's x axis, base frame
    T wheel_half_length;      // of a wheel's section at the contact's height, along its rolling direction
    Factors3<T> base_inertia; // without a bumper plate
    std::array<T, max_outline_vertices> edge_x, edge_y, edge_length; // unit direction from vertex i to i + 1
};

// The barrel's radius at an angle past its middle, from the roller's own axis.
template <class T, int Wheels> T barrel(const Parameters<T, Wheels> &p, T barrel_radius, T angle) {
    return p.roller_radius - barrel_radius * (T(1.0) - math::sincos(angle).cos);
}

// A factor on the friction of (28), so that it is the mean over a roller, whose friction is inverse to its radius.
template <class T, int Wheels> T level_of_rollers(const Parameters<T, Wheels> &p, T half_pitch, T barrel_radius) {
    constexpr int parts = 256; // of Simpson's rule
    T mean = T(0.0);
    for (int i = 0; i <= parts; ++i) {
        const double weight = i == 0 || i == parts ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
        mean =
            mean + T(weight / (3.0 * parts)) / barrel(p, barrel_radius, T(i / static_cast<double>(parts)) * half_pitch);
    }
    return T(1.0) / (mean * p.roller_radius);
}

template <class T, int Wheels> Derived<T> derive(const Parameters<T, Wheels> &p) {
    Derived<T> d{};
    const auto rail = math::sincos(p.slider_direction);
    d.rail_x = rail.cos;
    d.rail_y = rail.sin;
    d.origin_x = p.slider_target_x - rail.cos * (p.slider_run_up + p.contact_nose_radius);
    d.origin_y = p.slider_target_y - rail.sin * (p.slider_run_up + p.contact_nose_radius);
    const auto mount = math::sincos(p.bumper_mount_azimuth);
    d.plate_x = mount.cos;
    d.plate_y = mount.sin;
    const T slider_mass = p.slider_mass;
    d.carriage_mass = (p.has_plate() && !p.plate_on_robot()) ? slider_mass - p.bumper_plate_mass : slider_mass;
    d.roller_plastic_fraction = T(1.0) - p.roller_elastic_fraction;
    if (p.roller_arrangement == RollerArrangement::discrete) {
        d.roller_pitch = T(6.283185307179586 / (static_cast<double>(p.roller_rows) * p.roller_per_row));
        const T half = T(0.5) * d.roller_pitch;
        d.barrel_offset = p.roller_radius_dip / (T(1.0) - math::sincos(half).cos);
        d.barrel_radius = p.wheel_radius - d.barrel_offset;
        d.roller_level = level_of_rollers(p, half, d.barrel_radius);
    }
    d.rope_pretension_length = T(p.rope_hanging_mass) * T(gravity_mps2) / p.rope_stiffness;
    const auto imu = math::sincos(p.imu_azimuth);
    d.imu_cos = imu.cos;
    d.imu_sin = imu.sin;
    const auto slope = math::sincos(p.floor_slope);
    const auto falling = math::sincos(p.floor_azimuth);
    d.downhill_x = T(gravity_mps2) * slope.sin * falling.cos;
    d.downhill_y = T(gravity_mps2) * slope.sin * falling.sin;
    d.floor_gravity = T(gravity_mps2) * slope.cos;
    d.wheel_half_length = math::sqrt(
        math::max(T(0.0), math::square(T(p.wheel_radius)) - math::square(p.contact_height - p.wheel_radius)));
    d.base_inertia = base_inertia(p).factors();
    for (int i = 0; i < p.outline_count; ++i) {
        const int next = (i + 1 == p.outline_count) ? 0 : i + 1;
        const T dx = p.outline_x[next] - p.outline_x[i];
        const T dy = p.outline_y[next] - p.outline_y[i];
        d.edge_length[i] = math::sqrt(dx * dx + dy * dy);
        d.edge_x[i] = dx / d.edge_length[i];
        d.edge_y[i] = dy / d.edge_length[i];
    }
    return d;
}

} // namespace giveway::plant
