// The plant's data in another scalar type: what is a number in From becomes a constant in To.
// Every field is named; the compiler's warning about a missing initialiser keeps the lists complete.
#pragma once

#include "state.hpp"

namespace giveway::plant {

namespace detail {

template <class To, class From, std::size_t N> std::array<To, N> converted(const std::array<From, N>& from) {
    std::array<To, N> to{};
    for (std::size_t i = 0; i < N; ++i) {
        to[i] = To(from[i]);
    }
    return to;
}

} // namespace detail

template <class To, class From> Parameters<To> convert(const Parameters<From>& p) {
    return {
        .mass = To(p.mass),
        .yaw_inertia = To(p.yaw_inertia),
        .wheel_radius = To(p.wheel_radius),
        .wheel_distance = To(p.wheel_distance),
        .wheel_inertia = To(p.wheel_inertia),
        .roller_radius = To(p.roller_radius),
        .roller_inertia = To(p.roller_inertia),
        .wheel_load = detail::converted<To>(p.wheel_load),
        .wheel_traction = detail::converted<To>(p.wheel_traction),
        .tipping = p.tipping,
        .tilt_inertia = To(p.tilt_inertia),
        .com_height = To(p.com_height),
        .floor_contact_stiffness = To(p.floor_contact_stiffness),
        .floor_contact_damping = To(p.floor_contact_damping),
        .grip_friction = To(p.grip_friction),
        .grip_stiffness = To(p.grip_stiffness),
        .grip_damping = To(p.grip_damping),
        .push_height = To(p.push_height),
        .roller_model = p.roller_model,
        .roller_torque = To(p.roller_torque),
        .roller_slope = To(p.roller_slope),
        .roller_presliding_stiffness = detail::converted<To>(p.roller_presliding_stiffness),
        .roller_presliding_damping = To(p.roller_presliding_damping),
        .roller_stribeck_speed = To(p.roller_stribeck_speed),
        .roller_elastic_fraction = To(p.roller_elastic_fraction),
        .motor_inertia = To(p.motor_inertia),
        .drivetrain_stiffness = To(p.drivetrain_stiffness),
        .drivetrain_damping = To(p.drivetrain_damping),
        .gear_coulomb = To(p.gear_coulomb),
        .gear_stiction = To(p.gear_stiction),
        .gear_viscous = To(p.gear_viscous),
        .torque_limit = To(p.torque_limit),
        .slider_present = p.slider_present,
        .slider_mass = To(p.slider_mass),
        .slider_friction = To(p.slider_friction),
        .slider_friction_speed = To(p.slider_friction_speed),
        .slider_damping = To(p.slider_damping),
        .rail_direction = To(p.rail_direction),
        .target_x = To(p.target_x),
        .target_y = To(p.target_y),
        .run_up = To(p.run_up),
        .wall_present = p.wall_present,
        .wall_distance = To(p.wall_distance),
        .wall_stiffness = To(p.wall_stiffness),
        .wall_damping = To(p.wall_damping),
        .rope_attached = p.rope_attached,
        .hanging_mass = To(p.hanging_mass),
        .rope_stiffness = To(p.rope_stiffness),
        .rope_damping = To(p.rope_damping),
        .drop_height = To(p.drop_height),
        .floor_stiffness = To(p.floor_stiffness),
        .floor_damping = To(p.floor_damping),
        .bumper_kind = p.bumper_kind,
        .bumper_mount = p.bumper_mount,
        .latch_model = p.latch_model,
        .plate_mass = To(p.plate_mass),
        .spring_rate = To(p.spring_rate),
        .preload = To(p.preload),
        .bumper_damping = To(p.bumper_damping),
        .guide_friction = To(p.guide_friction),
        .guide_friction_speed = To(p.guide_friction_speed),
        .travel = To(p.travel),
        .stop_stiffness = To(p.stop_stiffness),
        .stop_damping = To(p.stop_damping),
        .latch_force = To(p.latch_force),
        .latch_gap = To(p.latch_gap),
        .mount_x = To(p.mount_x),
        .mount_y = To(p.mount_y),
        .mount_azimuth = To(p.mount_azimuth),
        .nose_shape = p.nose_shape,
        .nose_radius = To(p.nose_radius),
        .contact_stiffness = To(p.contact_stiffness),
        .contact_damping = To(p.contact_damping),
        .contact_friction = To(p.contact_friction),
        .contact_friction_speed = To(p.contact_friction_speed),
        .contact_height = To(p.contact_height),
        .outline_body = p.outline_body,
        .outline_wheels = p.outline_wheels,
        .wheel_width = To(p.wheel_width),
        .outline_count = p.outline_count,
        .outline_x = detail::converted<To>(p.outline_x),
        .outline_y = detail::converted<To>(p.outline_y),
    };
}

template <class To, class From> Derived<To> convert(const Derived<From>& d) {
    return {
        .rail_x = To(d.rail_x),
        .rail_y = To(d.rail_y),
        .origin_x = To(d.origin_x),
        .origin_y = To(d.origin_y),
        .plate_x = To(d.plate_x),
        .plate_y = To(d.plate_y),
        .carriage_mass = To(d.carriage_mass),
        .roller_plastic_fraction = To(d.roller_plastic_fraction),
        .rope_pretension_length = To(d.rope_pretension_length),
        .tip_rate = To(d.tip_rate),
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

template <class To, class From> Inputs<To> convert(const Inputs<From>& u) {
    return {
        .motor_torque = detail::converted<To>(u.motor_torque),
        .push_force_x = To(u.push_force_x),
        .push_force_y = To(u.push_force_y),
        .push_point_x = To(u.push_point_x),
        .push_point_y = To(u.push_point_y),
    };
}

template <class To, class From> Modes<To> convert(const Modes<From>& m) {
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
    };
}

} // namespace giveway::plant
