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

// use(law) for the present bumper, which has to have a plate.
template <class T, int Wheels, class Use> auto with_bumper_law(const Parameters<T, Wheels> &p, Use &&use) {
    const auto checked = [&use]<BumperLaw Law>(Law law) { return use(law); };
    switch (p.bumper_kind) {
    case BumperKind::magnetic:
        return p.bumper_latch_model == LatchModel::ideal ? checked(IdealLatch{}) : checked(MagneticLatch{});
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
    case BumperKind::table:
        return checked(ForceTable{});
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
