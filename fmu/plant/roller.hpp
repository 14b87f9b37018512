// Roller friction at the floor: elasto-plastic bristle, or tanh (28).
#pragma once

#include "state.hpp"

namespace giveway::plant {

template <class T> struct RollerForce {
    T force;           // on the base along -n_i, N
    T deflection_rate; // z', m/s
    T dissipation;     // W
};

// z' of an elasto-plastic bristle that slides past the floor at v and slips at `limit` (N).
template <class T> T bristle_rate(T v, T z, T stiffness, T limit, T elastic_fraction) {
    const T rho = stiffness * math::abs(z) / limit;
    const T y = math::clamp((rho - elastic_fraction) / (T(1.0) - elastic_fraction), T(0.0), T(1.0));
    const T sliding = math::select(math::less(T(0.0), z * v), y * y * (T(3.0) - T(2.0) * y), T(0.0));
    return v * (T(1.0) - sliding * rho);
}

// v: speed of the wheel along its axle, n_i . v, m/s; z: bristle deflection, m.
template <class T> RollerForce<T> roller_force(const Parameters<T>& p, int wheel, T v, T z) {
    const T coulomb = p.wheel_load[wheel] * p.roller_torque / p.roller_radius;
    const T speed = math::abs(v);
    const T steady = math::tanh(p.roller_slope * speed / p.roller_radius);
    if (p.roller_model == RollerModel::tanh) {
        const T force = math::select(math::less(v, T(0.0)), T(-1.0) * coulomb * steady, coulomb * steady);
        return {force, T(0.0), force * v};
    }
    const T stick = math::exp(T(-1.0) * math::square(v / p.roller_stribeck_speed));
    // The floor keeps rho finite for a wheel without load.
    const T limit = math::max(coulomb * (stick + (T(1.0) - stick) * steady), T(1e-9));
    const T sigma0 = p.roller_presliding_stiffness[wheel];
    const T rate = bristle_rate(v, z, sigma0, limit, p.roller_elastic_fraction);
    const T force = sigma0 * z + p.roller_presliding_damping * rate;
    return {force, rate, force * v - sigma0 * z * rate};
}

// Deflection in steady motion at speed v, where z' = 0 and the friction is that of (28).
template <class T> T steady_deflection(const Parameters<T>& p, int wheel, T v) {
    if (p.roller_model == RollerModel::tanh) {
        return T(0.0);
    }
    const T coulomb = p.wheel_load[wheel] * p.roller_torque / p.roller_radius;
    const T stick = math::exp(T(-1.0) * math::square(v / p.roller_stribeck_speed));
    const T limit = coulomb * (stick + (T(1.0) - stick) * math::tanh(p.roller_slope * math::abs(v) / p.roller_radius));
    return math::sign(v) * limit / p.roller_presliding_stiffness[wheel];
}

} // namespace giveway::plant
