// Inertia of the base with its rolling wheels and rollers, and the 3x3 solve for its acceleration.
#pragma once

#include "parameters.hpp"
#include "vector2.hpp"

namespace giveway::plant {

// A motion or a wrench of the base: two components in base axes and one about z.
template <class T> struct Planar3 {
    T x, y, z;
    friend Planar3 operator+(Planar3 a, Planar3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend Planar3 operator*(T s, Planar3 a) { return {s * a.x, s * a.y, s * a.z}; }
};

template <class T> T dot(Planar3<T> a, Planar3<T> b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// Generalised direction of a force along the unit vector `axis` at `point`.
template <class T> Planar3<T> wrench_direction(Vector2<T> axis, Vector2<T> point) {
    return {axis.x, axis.y, cross(point, axis)};
}

// Rows of (15), (16) in the base frame.
template <class T, int Wheels> Planar3<T> wheel_row(const Parameters<T, Wheels> &p, int wheel) {
    return {T(-Azimuths<Wheels>::sin[wheel]) / p.wheel_radius, T(Azimuths<Wheels>::cos[wheel]) / p.wheel_radius,
            p.wheel_distance / p.wheel_radius};
}
template <class T, int Wheels> Planar3<T> roller_row(const Parameters<T, Wheels> &p, int wheel) {
    return {T(Azimuths<Wheels>::cos[wheel]) / p.roller_radius, T(Azimuths<Wheels>::sin[wheel]) / p.roller_radius,
            T(0.0)};
}

// L D L^T of a symmetric and positive definite matrix, without pivoting.
template <class T> struct Factors3 {
    math::Divisor<T> d1, d2, d3;
    T l21, l31, l32;

    [[nodiscard]] Planar3<T> solve(Planar3<T> f) const {
        const T y2 = f.y - l21 * f.x;
        const T y3 = f.z - l31 * f.x - l32 * y2;
        const T z = y3 / d3;
        const T y = y2 / d2 - l32 * z;
        return {f.x / d1 - l21 * y - l31 * z, y, z};
    }
};

template <class T> struct Inertia3 {
    T xx, xy, xz, yy, yz, zz;

    void add(T weight, Planar3<T> u) {
        xx = xx + weight * u.x * u.x;
        xy = xy + weight * u.x * u.y;
        xz = xz + weight * u.x * u.z;
        yy = yy + weight * u.y * u.y;
        yz = yz + weight * u.y * u.z;
        zz = zz + weight * u.z * u.z;
    }

    [[nodiscard]] Factors3<T> factors() const {
        const math::Divisor<T> d1 = xx;
        const T l21 = xy / d1;
        const T l31 = xz / d1;
        const math::Divisor<T> d2 = yy - l21 * xy;
        const T l32 = (yz - l31 * xy) / d2;
        return {d1, d2, zz - l31 * xz - l32 * (yz - l31 * xy), l21, l31, l32};
    }

    [[nodiscard]] Planar3<T> solve(Planar3<T> f) const { return factors().solve(f); }
    [[nodiscard]] T energy(Planar3<T> u) const {
        return T(0.5) * (xx * u.x * u.x + yy * u.y * u.y + zz * u.z * u.z) + xy * u.x * u.y + xz * u.x * u.z +
               yz * u.y * u.z;
    }
};

// From the wheels' centre to that of mass.
template <class T, int Wheels> Vector2<T> mass_centre(const Parameters<T, Wheels> &p) {
    return {p.base_com_x, p.base_com_y};
}

// The body, which includes the wheels' mass, about the wheels' centre.
template <class T, int Wheels> Inertia3<T> body_inertia(const Parameters<T, Wheels> &p) {
    const Vector2<T> com = mass_centre(p);
    return {p.base_mass,
            T(0.0),
            T(0.0) - p.base_mass * com.y,
            p.base_mass,
            p.base_mass * com.x,
            p.base_yaw_inertia + p.base_mass * dot(com, com)};
}

// Body, wheels and rollers, without a bumper plate.
template <class T, int Wheels> Inertia3<T> base_inertia(const Parameters<T, Wheels> &p) {
    Inertia3<T> inertia = body_inertia(p);
    for (int i = 0; i < Wheels; ++i) {
        inertia.add(p.wheel_traction[i] * p.wheel_inertia, wheel_row(p, i));
        inertia.add(p.wheel_traction[i] * p.roller_inertia, roller_row(p, i));
    }
    return inertia;
}

// What the wheel carries when the base stands, over an equal share of its weight; without more than three wheels the
// only answer. `centre`: where the weight acts, in base axes.
template <class T, int Wheels> T static_load_share(const Parameters<T, Wheels> &p, int wheel, Vector2<T> centre) {
    const Vector2<T> radial{T(Azimuths<Wheels>::cos[wheel]), T(Azimuths<Wheels>::sin[wheel])};
    return T(1.0) + T(2.0) * dot(radial, centre) / p.wheel_distance;
}

// The wheel torques that balance a wrench in base axes.
template <class T, int Wheels> std::array<T, Wheels> balancing_torques(const Parameters<T, Wheels> &p, Planar3<T> w) {
    std::array<T, Wheels> torque{};
    for (int i = 0; i < Wheels; ++i) {
        torque[i] = balancing_torque<Wheels, T>(i, p.wheel_radius, p.wheel_distance, w.x, w.y, w.z);
    }
    return torque;
}

} // namespace giveway::plant
