// A gas spring, or a pneumatic cushion: polytropic compression of the gas behind a piston.
#pragma once

#include "law.hpp"

namespace giveway::plant {

struct GasSpring : PlainLaw {
    // Beyond this share of the gas column the force no longer grows; bumpers stop before.
    static constexpr double greatest_share = 0.98;

    template <class T, int Wheels> [[gnu::noinline]] static LawForce<T> spring(const Parameters<T, Wheels> &p, T c) {
        const T pushed = math::min(c, T(greatest_share) * p.bumper_gas_length);
        const T z = T(-1.0) * math::log(T(1.0) - pushed / p.bumper_gas_length);
        const T enclosed = p.bumper_gas_force + p.bumper_gas_ambient_force;
        const T above =
            p.bumper_gas_exponent - T(1.0); // over the isothermal exponent, where the integral is a logarithm
        const T force = enclosed * math::exp(p.bumper_gas_exponent * z) - p.bumper_gas_ambient_force;
        const T work = math::select(math::less(above, T(1e-6)), z * (T(1.0) + T(0.5) * above * z),
                                    math::expm1(above * z) / math::max(above, T(1e-6)));
        return {force,
                enclosed * p.bumper_gas_length * work - p.bumper_gas_ambient_force * pushed + force * (c - pushed)};
    }
    template <class T, int Wheels> static T rest_force(const Parameters<T, Wheels> &p) { return p.bumper_gas_force; }
    template <class T, int Wheels> static T rest_stiffness(const Parameters<T, Wheels> &p) {
        return p.bumper_gas_exponent * (p.bumper_gas_force + p.bumper_gas_ambient_force) / p.bumper_gas_length;
    }

    static double greatest_stiffness(const Parameters<double> &p) {
        const double left = 1.0 - p.bumper_travel / p.bumper_gas_length;
        return rest_stiffness(p) * math::exp((p.bumper_gas_exponent + 1.0) * -math::log(left));
    }
};

} // namespace giveway::plant
