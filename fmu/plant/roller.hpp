// Roller friction at the floor: elasto-plastic bristle, or tanh (28).
#pragma once

#include "state.hpp"

namespace giveway::plant {

template <class T> struct RollerForce {
    T force;           // on the base along -n_i, N
    T deflection_rate; // z', m/s
    T dissipation;     // W
};

// z' of an elasto-plastic bristle that slides past the floor at v and slips at `limit` (N); plastic_fraction: 1 -
// elastic_fraction.
template <class T>
T bristle_rate(T v, T z, T stiffness, T limit, T elastic_fraction, const math::Divisor<T> &plastic_fraction) {
    const T rho = stiffness * math::abs(z) / limit;
    const T y = math::clamp((rho - elastic_fraction) / plastic_fraction, T(0.0), T(1.0));
    const T sliding = math::select(math::less(T(0.0), z * v), y * y * (T(3.0) - T(2.0) * y), T(0.0));
    return v * (T(1.0) - sliding * rho);
}

// One of the rollers of a wheel.
template <class T> struct TouchingRoller {
    T radius;   // where it touches the floor, m
    T friction; // torque over that of (28)
};

namespace detail {

template <class T, class Radius, int Wheels>
T steady_friction(const Parameters<T, Wheels> &p, T coulomb, const Radius &radius, T v) {
    const T steady = math::tanh(p.roller_tanh_slope * math::abs(v) / radius);
    if (p.roller_model == RollerModel::tanh) {
        return coulomb * steady;
    }
    const T stick = math::exp(T(-1.0) * math::square(v / p.roller_stribeck_speed));
    return coulomb * (stick + (T(1.0) - stick) * steady);
}

} // namespace detail

// Friction of a roller in steady motion at speed v (28); near rest a bristle holds up to the Coulomb friction.
template <class T, int Wheels> T steady_friction(const Parameters<T, Wheels> &p, int wheel, T v) {
    const T coulomb = p.roller_friction_scale[wheel] * p.wheel_load[wheel] * p.roller_coulomb_torque / p.roller_radius;
    return detail::steady_friction(p, coulomb, p.roller_radius, v);
}
template <class T, int Wheels>
T steady_friction(const Parameters<T, Wheels> &p, int wheel, T v, const TouchingRoller<T> &roller) {
    const T coulomb = p.roller_friction_scale[wheel] * p.wheel_load[wheel] * p.roller_coulomb_torque * roller.friction /
                      roller.radius;
    return detail::steady_friction(p, coulomb, roller.radius, v);
}

// v: speed of the wheel along its axle, n_i . v, m/s; z: bristle deflection, m; steady: steady_friction() at v, N.
template <class T, int Wheels>
RollerForce<T> roller_force(const Parameters<T, Wheels> &p, const math::Divisor<T> &plastic_fraction, int wheel, T v,
                            T z, T steady) {
    if (p.roller_model == RollerModel::tanh) {
        const T force = math::select(math::less(v, T(0.0)), T(-1.0) * steady, steady);
        return {force, T(0.0), force * v};
    }
    // The floor keeps rho finite for a wheel without load.
    const T limit = math::max(steady, T(1e-9));
    const T sigma0 = p.roller_presliding_stiffness[wheel];
    const T rate = bristle_rate(v, z, sigma0, limit, p.roller_elastic_fraction, plastic_fraction);
    const T force = sigma0 * z + p.roller_presliding_damping * rate;
    return {force, rate, force * v - sigma0 * z * rate};
}
template <class T, int Wheels> RollerForce<T> roller_force(const Parameters<T, Wheels> &p, int wheel, T v, T z) {
    return roller_force(p, math::Divisor<T>(T(1.0) - p.roller_elastic_fraction), wheel, v, z,
                        steady_friction(p, wheel, v));
}

// Deflection in steady motion at speed v, where z' = 0 and the friction is `steady`.
template <class T, int Wheels> T steady_deflection(const Parameters<T, Wheels> &p, int wheel, T v, T steady) {
    if (p.roller_model == RollerModel::tanh) {
        return T(0.0);
    }
    return math::sign(v) * steady / p.roller_presliding_stiffness[wheel];
}

} // namespace giveway::plant
