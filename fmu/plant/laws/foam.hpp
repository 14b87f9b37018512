// Foam: force over travel as the data sheet states it for slow loading, less on the way back, more with speed.
#pragma once

#include "law.hpp"

namespace giveway::plant {

struct Foam : PlainLaw {
    static constexpr bool has_drag = true;

    // Of slow loading: the cubic through 0 and the three forces of the data sheet, over compression per thickness.
    template <class T> struct Cubic {
        T first, second, third;
        T at(T x) const { return x * (first + x * (second + x * third)); }
        T slope(T x) const { return first + x * (T(2.0) * second + x * (T(3.0) * third)); }
        T integral(T x) const { return x * x * (T(0.5) * first + x * (T(1.0 / 3.0) * second + x * (T(0.25) * third))); }
    };
    template <class P> static auto loading(const P &p) {
        using T = std::remove_cvref_t<decltype(p.bumper_foam_force_25)>;
        const T f25 = p.bumper_foam_force_25;
        const T f50 = p.bumper_foam_force_50;
        const T f75 = p.bumper_foam_force_75;
        return Cubic<T>{T(12.0) * f25 - T(6.0) * f50 + T(4.0 / 3.0) * f75, T(32.0) * f50 - T(40.0) * f25 - T(8.0) * f75,
                        T(32.0) * (f25 - f50) + T(32.0 / 3.0) * f75};
    }
    // Foam does not stick: it presses or does nothing.
    template <class T, int Wheels> static T pressed(const Parameters<T, Wheels> &p, T c) {
        return math::max(c, T(0.0)) / p.bumper_foam_thickness;
    }

    template <class T, int Wheels> [[gnu::noinline]] static LawForce<T> spring(const Parameters<T, Wheels> &p, T c) {
        const T x = pressed(p, c);
        const T rest = T(1.0) - T(0.5) * p.bumper_foam_hysteresis;
        const auto curve = loading(p);
        return {rest * curve.at(x), rest * p.bumper_foam_thickness * curve.integral(x)};
    }
    template <class T, int Wheels> [[gnu::noinline]] static T drag(const Parameters<T, Wheels> &p, T c, T rate) {
        const T half = T(0.5) * p.bumper_foam_hysteresis;
        const T share = half * math::tanh(rate / p.bumper_foam_hysteresis_speed) + p.bumper_foam_rate_gain * rate;
        return loading(p).at(pressed(p, c)) * math::max(share, half - T(1.0));
    }
    template <class T, int Wheels> static T rest_force(const Parameters<T, Wheels> &) { return T(0.0); }
    template <class T, int Wheels> static T rest_stiffness(const Parameters<T, Wheels> &) { return T(0.0); }

    static double greatest_stiffness(const Parameters<double> &p) {
        const auto curve = loading(p);
        const double end = p.bumper_travel / p.bumper_foam_thickness;
        return std::max(curve.slope(0.0), curve.slope(end)) / p.bumper_foam_thickness;
    }
    static double greatest_damping(const Parameters<double> &p, double) {
        return loading(p).at(p.bumper_travel / p.bumper_foam_thickness) *
               (0.5 * p.bumper_foam_hysteresis / p.bumper_foam_hysteresis_speed + p.bumper_foam_rate_gain);
    }
};

} // namespace giveway::plant
