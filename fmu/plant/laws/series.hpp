// Two springs in series on one guide. The first is solid after its travel; the second may be held captive by a preload
// of its own. Up to three straight pieces.
#pragma once

#include "law.hpp"

namespace giveway::plant {

struct SpringsInSeries : PlainLaw {
    template <class T> struct Knees {
        T both;       // rate while both move
        T moves;      // where the second begins to move, m
        T first_ends; // where the first is solid, m
    };
    template <class T, int Wheels> static Knees<T> knees(const Parameters<T, Wheels> &p) {
        const T first = p.bumper_spring_rate;
        const T second = p.bumper_second_rate;
        const T moves = math::max(p.bumper_second_preload - p.bumper_preload, T(0.0)) / first;
        return {first * second / (first + second), moves,
                moves + (p.bumper_first_travel - moves) * (T(1.0) + first / second)};
    }

    template <class T, int Wheels> [[gnu::noinline]] static LawForce<T> spring(const Parameters<T, Wheels> &p, T c) {
        const Knees<T> k = knees(p);
        const T softer = k.both - p.bumper_spring_rate;
        const T stiffer = p.bumper_second_rate - k.both;
        const T with_second = math::max(c - k.moves, T(0.0));
        const T without_first = math::max(c - k.first_ends, T(0.0));
        return {p.bumper_preload + p.bumper_spring_rate * c + softer * with_second + stiffer * without_first,
                p.bumper_preload * c + T(0.5) * (p.bumper_spring_rate * c * c + softer * math::square(with_second) +
                                                 stiffer * math::square(without_first))};
    }
    template <class T, int Wheels> static T rest_force(const Parameters<T, Wheels> &p) { return p.bumper_preload; }
    template <class T, int Wheels> static T rest_stiffness(const Parameters<T, Wheels> &p) {
        return p.bumper_spring_rate;
    }

    static double greatest_stiffness(const Parameters<double> &p) {
        return std::max(p.bumper_spring_rate, p.bumper_second_rate);
    }
};

} // namespace giveway::plant
