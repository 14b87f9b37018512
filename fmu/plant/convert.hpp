// The plant's data in another scalar type: numbers of type From become constants of type To.
// Where fields are named, the compiler's warning about a missing initialiser keeps the lists complete.
#pragma once

#include <type_traits>

#include "state.hpp"

namespace giveway::plant {

namespace detail {

template <class To, class From, std::size_t N> std::array<To, N> converted(const std::array<From, N> &from) {
    std::array<To, N> to{};
    for (std::size_t i = 0; i < N; ++i) {
        to[i] = To(from[i]);
    }
    return to;
}

} // namespace detail

template <class To, class From, int Wheels> Parameters<To, Wheels> convert(const Parameters<From, Wheels> &p) {
    Parameters<To, Wheels> to{};
    const auto number = [](const char *, auto &into, const auto &from) {
        using Into = std::remove_reference_t<decltype(into)>;
        if constexpr (std::is_integral_v<Into> || std::is_enum_v<Into>) {
            into = from;
        } else if constexpr (requires { from.begin(); }) {
            into = detail::converted<To>(from);
        } else {
            into = To(from);
        }
    };
    visit_parameters(number, to, p);
    to.wheel_load = detail::converted<To>(p.wheel_load);
    to.wheel_traction = detail::converted<To>(p.wheel_traction);
    to.outline_body = p.outline_body;
    to.outline_wheels = p.outline_wheels;
    return to;
}

template <class To, class From> Derived<To> convert(const Derived<From> &d) {
    return {
        .rail_x = To(d.rail_x),
        .rail_y = To(d.rail_y),
        .origin_x = To(d.origin_x),
        .origin_y = To(d.origin_y),
        .plate_x = To(d.plate_x),
        .plate_y = To(d.plate_y),
        .carriage_mass = To(d.carriage_mass),
        .roller_plastic_fraction = To(d.roller_plastic_fraction),
        .roller_pitch = To(d.roller_pitch),
        .barrel_radius = To(d.barrel_radius),
        .barrel_offset = To(d.barrel_offset),
        .roller_level = To(d.roller_level),
        .rope_pretension_length = To(d.rope_pretension_length),
        .downhill_x = To(d.downhill_x),
        .downhill_y = To(d.downhill_y),
        .floor_gravity = To(d.floor_gravity),
        .imu_cos = To(d.imu_cos),
        .imu_sin = To(d.imu_sin),
        .wheel_half_length = To(d.wheel_half_length),
        .base_inertia = {.d1 = To(d.base_inertia.d1),
                         .d2 = To(d.base_inertia.d2),
                         .d3 = To(d.base_inertia.d3),
                         .l21 = To(d.base_inertia.l21),
                         .l31 = To(d.base_inertia.l31),
                         .l32 = To(d.base_inertia.l32)},
        .edge_x = detail::converted<To>(d.edge_x),
        .edge_y = detail::converted<To>(d.edge_y),
        .edge_length = detail::converted<To>(d.edge_length),
    };
}

template <class To, class From, int Wheels> Inputs<To, Wheels> convert(const Inputs<From, Wheels> &u) {
    return {
        .motor_torque = detail::converted<To>(u.motor_torque),
        .push_force_x = To(u.push_force_x),
        .push_force_y = To(u.push_force_y),
        .push_point_x = To(u.push_point_x),
        .push_point_y = To(u.push_point_y),
    };
}

template <class To, class From, int Wheels> Modes<To, Wheels> convert(const Modes<From, Wheels> &m) {
    return {
        .gear_direction = detail::converted<To>(m.gear_direction),
        .contact = To(m.contact),
        .rope_taut = To(m.rope_taut),
        .end_stop = To(m.end_stop),
        .bottom_stop = To(m.bottom_stop),
        .latched = To(m.latched),
        .landed = To(m.landed),
        .walled = To(m.walled),
        .on_floor = detail::converted<To>(m.on_floor),
        .overturned = To(m.overturned),
        .roller = detail::converted<To>(m.roller),
        .roller_offset = detail::converted<To>(m.roller_offset),
        .roller_friction = detail::converted<To>(m.roller_friction),
    };
}

} // namespace giveway::plant
