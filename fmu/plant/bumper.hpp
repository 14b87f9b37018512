// Spring bumper with preload, guide friction, stops and the magnetic latch.
#pragma once

#include "state.hpp"

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

template <class T> BumperForce<T> bumper_force(const Parameters<T>& p, const Modes<T>& m, T c, T rate) {
    const T elastic = p.bumper_preload + p.bumper_spring_rate * c;
    const T loss = p.bumper_damping * rate + p.bumper_guide_friction * math::tanh(rate / p.bumper_guide_friction_speed);
    const auto end = stop_force(m.end_stop, p.bumper_stop_stiffness, p.bumper_stop_damping, T(-1.0) * c, T(-1.0) * rate);
    const auto bottom = stop_force(m.bottom_stop, p.bumper_stop_stiffness, p.bumper_stop_damping, c - p.bumper_travel, rate);
    T force = elastic + loss - end.force + bottom.force;
    T stored = p.bumper_preload * c + T(0.5) * p.bumper_spring_rate * c * c + end.stored + bottom.stored;
    if (p.has_continuous_latch()) {
        const T gap = math::max(c, T(0.0));
        force = force + p.bumper_latch_force / math::square(T(1.0) + gap / p.bumper_latch_gap);
        stored = stored + p.bumper_latch_force * math::select(math::less(T(0.0), c), p.bumper_latch_gap * gap / (p.bumper_latch_gap + gap), c);
    }
    return {force, loss * rate + end.dissipation + bottom.dissipation, stored};
}

} // namespace giveway::plant
