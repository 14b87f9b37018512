// The bumper: its law, and what all kinds have: damper, guide friction, stops.
#pragma once

#include "bumper_laws.hpp"

namespace giveway::plant {

template <class T> struct BumperForce {
    T force;       // extends the bumper, N
    T dissipation; // W
    T stored;      // J
};

// One-sided stop, Hunt-Crossley; depth > 0 presses.
template <class T> struct StopForce {
    T force, dissipation, stored;
};

template <class T> StopForce<T> stop_force(T engaged, T stiffness, T damping, T depth, T rate) {
    const T spring = math::acting(engaged, depth) * stiffness * depth;
    const T force = math::max(T(0.0), spring * (T(1.0) + damping * rate));
    return {force, (force - spring) * rate, T(0.5) * spring * depth};
}

template <class T, int Wheels>
BumperForce<T> bumper_force(const Parameters<T, Wheels> &p, const Modes<T, Wheels> &m, T c, T rate) {
    return with_bumper_forces(p, [&](auto law) {
        const LawForce<T> spring = law.spring(p, c);
        T loss = p.bumper_damping * rate + p.bumper_guide_friction * math::tanh(rate / p.bumper_guide_friction_speed);
        if constexpr (decltype(law)::has_drag) {
            loss = loss + law.drag(p, c, rate);
        }
        const auto end =
            stop_force(m.end_stop, p.bumper_stop_stiffness, p.bumper_stop_damping, T(-1.0) * c, T(-1.0) * rate);
        const auto bottom =
            stop_force(m.bottom_stop, p.bumper_stop_stiffness, p.bumper_stop_damping, c - p.bumper_travel, rate);
        T force = spring.force + loss - end.force + bottom.force;
        T stored = spring.stored + end.stored + bottom.stored;
        if constexpr (decltype(law)::has_latch) {
            const LawForce<T> latch = law.latch(p, c);
            force = force + latch.force;
            stored = stored + latch.stored;
        }
        return BumperForce<T>{force, loss * rate + end.dissipation + bottom.dissipation, stored};
    });
}

// Rest position of a free bumper's plate against its end stop. Without any force on it, too, the plate begins on that
// side: exactly at zero the end stop's event would not be seen.
template <class T, int Wheels> T resting_compression(const Parameters<T, Wheels> &p) {
    return with_bumper_law(p, [&](auto law) -> T {
        return math::min(T(-1.0) * law.rest_force(p) / (law.rest_stiffness(p) + p.bumper_stop_stiffness), T(-1e-9));
    });
}

} // namespace giveway::plant
