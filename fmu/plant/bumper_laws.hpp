// The laws of bumpers: a file each in laws/, and laws/law.hpp says what a law is. Guide, damper and stops are common to
// them (bumper.hpp).
#pragma once

#include "laws/damper.hpp"
#include "laws/foam.hpp"
#include "laws/gas.hpp"
#include "laws/lever.hpp"
#include "laws/series.hpp"
#include "laws/spring.hpp"
#include "laws/table.hpp"

namespace giveway::plant {

namespace detail {

template <class T, int Wheels, class Use> auto with_further_law(const Parameters<T, Wheels> &p, Use &&use) {
    const auto checked = [&use]<BumperLaw Law>(Law law) { return use(law); };
    switch (p.bumper_kind) {
    case BumperKind::foam:
        return checked(Foam{});
    case BumperKind::gas:
        return checked(GasSpring{});
    case BumperKind::damper:
        return checked(Damper{});
    case BumperKind::series:
        return checked(SpringsInSeries{});
    case BumperKind::lever:
        return checked(Lever{});
    default:
        return checked(ForceTable{});
    }
}

template <class T, int Wheels, class Use> auto with_first_law(const Parameters<T, Wheels> &p, Use &&use) {
    const auto checked = [&use]<BumperLaw Law>(Law law) { return use(law); };
    if (p.bumper_kind == BumperKind::magnetic) {
        return p.bumper_latch_model == LatchModel::ideal ? checked(IdealLatch{}) : checked(MagneticLatch{});
    }
    return checked(PreloadedSpring{});
}

} // namespace detail

// The laws beside spring and magnet as one, whose forces are computed apart from the equations that call it: they are
// large, and few bumpers have them.
struct FurtherLaw : PlainLaw {
    static constexpr bool has_drag = true;
    template <class T, int Wheels> [[gnu::noinline]] static LawForce<T> spring(const Parameters<T, Wheels> &p, T c) {
        return detail::with_further_law(p, [&](auto law) { return law.spring(p, c); });
    }
    template <class T, int Wheels> [[gnu::noinline]] static T drag(const Parameters<T, Wheels> &p, T c, T rate) {
        return detail::with_further_law(p, [&](auto law) -> T {
            if constexpr (decltype(law)::has_drag) {
                return law.drag(p, c, rate);
            } else {
                return T(0.0);
            }
        });
    }
};

template <class T, int Wheels> bool has_further_law(const Parameters<T, Wheels> &p) {
    return p.bumper_kind > BumperKind::magnetic;
}

// use(law) for the forces of the present bumper, which has to have a plate.
template <class T, int Wheels, class Use> auto with_bumper_forces(const Parameters<T, Wheels> &p, Use &&use) {
    return has_further_law(p) ? use(FurtherLaw{}) : detail::with_first_law(p, use);
}

// use(law) for all else that a law says.
template <class T, int Wheels, class Use> auto with_bumper_law(const Parameters<T, Wheels> &p, Use &&use) {
    return has_further_law(p) ? detail::with_further_law(p, use) : detail::with_first_law(p, use);
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

// Between plate and carrier: a force on both that is this times the rate's rate.
template <class T, int Wheels> T bumper_inertance(const Parameters<T, Wheels> &p) {
    return with_bumper_law(p, [&](auto law) -> T {
        if constexpr (decltype(law)::has_inertance) {
            return law.inertance(p);
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
