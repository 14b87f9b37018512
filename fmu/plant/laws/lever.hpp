// A preloaded spring behind a lever, whose inertia acts between plate and carrier.
#pragma once

#include "law.hpp"

namespace giveway::plant {

struct Lever : PlainLaw {
    static constexpr bool has_inertance = true;

    template <class T, int Wheels> [[gnu::noinline]] static LawForce<T> spring(const Parameters<T, Wheels> &p, T c) {
        const T travel = p.bumper_lever_ratio * c; // of the spring
        return {p.bumper_lever_ratio * (p.bumper_preload + p.bumper_spring_rate * travel),
                travel * (p.bumper_preload + T(0.5) * p.bumper_spring_rate * travel)};
    }
    template <class T, int Wheels> static T inertance(const Parameters<T, Wheels> &p) { return p.bumper_lever_mass; }
    template <class T, int Wheels> static T rest_force(const Parameters<T, Wheels> &p) {
        return p.bumper_lever_ratio * p.bumper_preload;
    }
    template <class T, int Wheels> static T rest_stiffness(const Parameters<T, Wheels> &p) {
        return p.bumper_spring_rate * math::square(p.bumper_lever_ratio);
    }

    static double greatest_stiffness(const Parameters<double> &p) { return rest_stiffness(p); }
};

} // namespace giveway::plant
