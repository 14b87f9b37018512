// What a law of a bumper has to say; bumper_laws.hpp has the list of them.
//
//   spring          the force that extends the bumper at rest, over its compression, and the energy stored, which is
//   the
//                   integral of that force: J from full extension
//   drag            the rest of the force, which comes with the rate and has its sign, so that it only ever dissipates
//                   (`has_drag`)
//   latch           what a magnet adds (`has_latch`)
//   rest_force, rest_stiffness  what presses the plate against its end stop at full extension, and its slope there
//   greatest_stiffness  the steepest slope of all these, which limits the fixed step
//   greatest_damping    the steepest slope of the drag over the rate, up to a speed; limits the fixed step, too
//   holds           true where a latch holds the plate at full extension without any travel, until it is pulled with
//                   `holding_force` beyond the spring's
//   is_latched      what an observer of the plate calls latched; for a law that holds its mode says so
//   inertance       between plate and carrier, kg: what a lever's inertia is to them (`has_inertance`)
#pragma once

#include <algorithm>
#include <concepts>

#include "../state.hpp"

namespace giveway::plant {

// Extends the bumper, N; energy from full extension, J.
template <class T> struct LawForce {
    T force, stored;
};

// What most laws do without.
struct PlainLaw {
    static constexpr bool has_drag = false;
    static constexpr bool has_latch = false;
    static constexpr bool has_inertance = false;
    static constexpr bool holds = false;
    template <class T, int Wheels> static bool is_latched(const Parameters<T, Wheels> &, T) { return false; }
    static double greatest_damping(const Parameters<double> &, double) { return 0.0; }
};

template <class Law>
concept BumperLaw = requires(const Parameters<double> &p, double c) {
    { Law::spring(p, c) } -> std::same_as<LawForce<double>>;
    { Law::rest_force(p) } -> std::convertible_to<double>;
    { Law::rest_stiffness(p) } -> std::convertible_to<double>;
    { Law::greatest_stiffness(p) } -> std::convertible_to<double>;
    { Law::greatest_damping(p, c) } -> std::convertible_to<double>;
    { Law::is_latched(p, c) } -> std::same_as<bool>;
    requires !Law::has_drag || requires {
        { Law::drag(p, c, c) } -> std::convertible_to<double>;
    };
    requires !Law::has_latch || requires {
        { Law::latch(p, c) } -> std::same_as<LawForce<double>>;
    };
    requires !Law::has_inertance || requires {
        { Law::inertance(p) } -> std::convertible_to<double>;
    };
    requires !Law::holds || requires {
        { Law::holding_force(p) } -> std::convertible_to<double>;
    };
};

} // namespace giveway::plant
