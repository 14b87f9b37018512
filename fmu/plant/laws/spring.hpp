// A preloaded spring, alone or with a magnet.
#pragma once

#include "law.hpp"

namespace giveway::plant {

struct PreloadedSpring : PlainLaw {
    template <class T, int Wheels> static LawForce<T> spring(const Parameters<T, Wheels> &p, T c) {
        return {p.bumper_preload + p.bumper_spring_rate * c,
                p.bumper_preload * c + T(0.5) * p.bumper_spring_rate * c * c};
    }
    template <class T, int Wheels> static T rest_force(const Parameters<T, Wheels> &p) { return p.bumper_preload; }
    template <class T, int Wheels> static T rest_stiffness(const Parameters<T, Wheels> &p) {
        return p.bumper_spring_rate;
    }
    static double greatest_stiffness(const Parameters<double> &p) { return p.bumper_spring_rate; }
};

// A magnet whose pull falls with the gap.
struct MagneticLatch : PreloadedSpring {
    static constexpr bool has_latch = true;
    template <class T, int Wheels> static LawForce<T> latch(const Parameters<T, Wheels> &p, T c) {
        const T gap = math::max(c, T(0.0));
        return {p.bumper_latch_force / math::square(T(1.0) + gap / p.bumper_latch_gap),
                p.bumper_latch_force *
                    math::select(math::less(T(0.0), c), p.bumper_latch_gap * gap / (p.bumper_latch_gap + gap), c)};
    }
    template <class T, int Wheels> static T rest_force(const Parameters<T, Wheels> &p) {
        return p.bumper_preload + p.bumper_latch_force;
    }
    template <class T, int Wheels> static bool is_latched(const Parameters<T, Wheels> &p, T c) {
        return c < p.bumper_latch_gap;
    }
    static double greatest_stiffness(const Parameters<double> &p) {
        return std::max<double>(p.bumper_spring_rate, 2.0 * p.bumper_latch_force / p.bumper_latch_gap);
    }
};

// The same without any reach: all of its pull at full extension, none beyond.
struct IdealLatch : PreloadedSpring {
    static constexpr bool holds = true;
    template <class T, int Wheels> static T holding_force(const Parameters<T, Wheels> &p) {
        return p.bumper_latch_force;
    }
};

} // namespace giveway::plant
