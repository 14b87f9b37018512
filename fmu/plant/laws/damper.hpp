// A plain damper with the spring that brings it back.
#pragma once

#include "spring.hpp"

namespace giveway::plant {

struct Damper : PreloadedSpring {
    static constexpr bool has_drag = true;

    template <class T, int Wheels> [[gnu::noinline]] static T drag(const Parameters<T, Wheels> &p, T, T rate) {
        const T way = math::select(math::less(rate, T(0.0)), p.bumper_damper_rebound, T(1.0));
        return way * (p.bumper_damper_rate + p.bumper_damper_square * math::abs(rate)) * rate;
    }

    static double greatest_damping(const Parameters<double> &p, double speed_mps) {
        return std::max(1.0, p.bumper_damper_rebound) *
               (p.bumper_damper_rate + 2.0 * p.bumper_damper_square * speed_mps);
    }
};

} // namespace giveway::plant
