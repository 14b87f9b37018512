// The laws of bumpers, one struct each: all that is special to a kind. Guide, damper and stops are common to them
// (bumper.hpp).
//
// A law says
//   spring          force over compression and its rate that extends the bumper, and the energy stored
//   latch           what a magnet adds, where the law has one (`has_latch`)
//   rest_force, rest_stiffness  what presses the plate against its end stop at full extension, and its slope there
//   greatest_stiffness  the steepest slope of all these, which limits the fixed step
//   holds           true where a latch holds the plate at full extension without any travel, until it is pulled with
//                   `holding_force` beyond the spring's
//   is_latched      what an observer of the plate calls latched; for a law that holds its mode says so
#pragma once

#include <algorithm>
#include <concepts>

#include "state.hpp"

namespace giveway::plant {

// Extends the bumper, N; energy from full extension, J.
template <class T> struct LawForce {
    T force, stored;
};

struct PreloadedSpring {
    static constexpr bool has_latch = false;
    static constexpr bool holds = false;
    template <class T, int Wheels> static LawForce<T> spring(const Parameters<T, Wheels> &p, T c, T) {
        return {p.bumper_preload + p.bumper_spring_rate * c,
                p.bumper_preload * c + T(0.5) * p.bumper_spring_rate * c * c};
    }
    template <class T, int Wheels> static T rest_force(const Parameters<T, Wheels> &p) { return p.bumper_preload; }
    template <class T, int Wheels> static T rest_stiffness(const Parameters<T, Wheels> &p) {
        return p.bumper_spring_rate;
    }
    template <class T, int Wheels> static bool is_latched(const Parameters<T, Wheels> &, T) { return false; }
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

template <class Law>
concept BumperLaw = requires(const Parameters<double> &p, double c) {
    { Law::spring(p, c, c) } -> std::same_as<LawForce<double>>;
    { Law::rest_force(p) } -> std::convertible_to<double>;
    { Law::rest_stiffness(p) } -> std::convertible_to<double>;
    { Law::greatest_stiffness(p) } -> std::convertible_to<double>;
    { Law::is_latched(p, c) } -> std::same_as<bool>;
    requires !Law::has_latch || requires {
        { Law::latch(p, c) } -> std::same_as<LawForce<double>>;
    };
    requires !Law::holds || requires {
        { Law::holding_force(p) } -> std::convertible_to<double>;
    };
};

// use(law) for the present bumper, which has to have a plate.
template <class T, int Wheels, class Use> auto with_bumper_law(const Parameters<T, Wheels> &p, Use &&use) {
    const auto checked = [&use]<BumperLaw Law>(Law law) { return use(law); };
    switch (p.bumper_kind) {
    case BumperKind::magnetic:
        return p.bumper_latch_model == LatchModel::ideal ? checked(IdealLatch{}) : checked(MagneticLatch{});
    case BumperKind::none:
    case BumperKind::spring:
        break;
    }
    return checked(PreloadedSpring{});
}

template <class T, int Wheels> bool bumper_holds(const Parameters<T, Wheels> &p) {
    return with_bumper_law(p, [](auto law) { return decltype(law)::holds; });
}

// Additional holding force at full extension, beyond the spring; 0 without a hold.
template <class T, int Wheels> T bumper_holding_force(const Parameters<T, Wheels> &p) {
    return with_bumper_law(p, [&](auto law) -> T {
        if constexpr (decltype(law)::holds) {
            return law.holding_force(p);
        } else {
            return T(0.0);
        }
    });
}

// The pull at which the plate leaves full extension.
template <class T, int Wheels> T bumper_release_force(const Parameters<T, Wheels> &p) {
    return bumper_holding_force(p) + with_bumper_law(p, [&](auto law) -> T { return law.rest_force(p); });
}

// `held`: the mode of a law that holds.
template <class T, int Wheels> bool is_latched(const Parameters<T, Wheels> &p, T c, bool held) {
    return with_bumper_law(p, [&](auto law) { return decltype(law)::holds ? held : law.is_latched(p, c); });
}

} // namespace giveway::plant
