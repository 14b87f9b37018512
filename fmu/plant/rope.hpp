// Rope over the pulley, hanging weight and the floor it lands on; rail friction of the slider.
#pragma once

#include "bumper.hpp"

namespace giveway::plant {

template <class T> struct RopeForces {
    T extension, tension, floor;
    T dissipation, stored; // gravity included
};

template <class T, int Wheels>
RopeForces<T> rope_forces(const Parameters<T, Wheels> &p, const Derived<T> &d, const Modes<T, Wheels> &m, T slider,
                          T slider_speed, T drop, T drop_speed) {
    if (p.rope_attached == 0) {
        return {T(-1.0), T(0.0), T(0.0), T(0.0), T(0.0)};
    }
    const T extension = d.rope_pretension_length + drop - slider;
    const T rate = drop_speed - slider_speed;
    const T taut = math::acting(m.rope_taut, extension);
    const T spring = taut * p.rope_stiffness * extension;
    const T tension = math::max(T(0.0), spring + taut * p.rope_damping * rate);
    const auto floor =
        stop_force(m.landed, p.rope_floor_stiffness, p.rope_floor_damping, drop - p.rope_drop_height, drop_speed);
    const T stored = T(0.5) * spring * extension + floor.stored - p.rope_hanging_mass * T(gravity_mps2) * drop;
    return {extension, tension, floor.force, (tension - spring) * rate + floor.dissipation, stored};
}

template <class T, int Wheels> T rail_friction(const Parameters<T, Wheels> &p, T speed) {
    return p.slider_friction * math::tanh(speed / p.slider_friction_speed) + p.slider_damping * speed;
}

} // namespace giveway::plant
