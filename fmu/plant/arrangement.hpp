// Rollers one by one: which of them is at the bottom, how the wheel rolls on it, and how the contact passes on.
#pragma once

#include "roller.hpp"

namespace giveway::plant {

// Where a wheel stands on its roller, and what follows from it.
template <class T> struct Rolling {
    Planar3<T> row;          // wheel speed of the base's twist
    T radius, slope;         // of the wheel there, m, and its derivative by the wheel's angle, m/rad
    T lever;                 // centre of the base to the contact, m
    T angle;                 // past the middle of the roller, rad
    TouchingRoller<T> touch; // the roller itself
};

template <class T, int Wheels> bool discrete(const Parameters<T, Wheels> &p) {
    return p.roller_arrangement == RollerArrangement::discrete;
}

namespace detail {

template <class T> T floor(T a) {
    const T nearest = math::round(a);
    return math::select(math::less(a, nearest), nearest - T(1.0), nearest);
}

// a modulo m for whole numbers with |a| < 2^49.
template <class T> T modulo(T a, double m) {
    const T rest = a - T(m) * floor(a / T(m));
    const T positive = math::select(math::less(rest, T(0.0)), rest + T(m), rest);
    return math::select(math::less(positive, T(m)), positive, positive - T(m));
}

// sin and 1 - cos of the small angles within a roller: below 0.6 rad to the last bit.
template <class T> struct SmallAngle {
    T sin, versine;
};
template <class T> SmallAngle<T> small_angle(T a) {
    const T s = a * a;
    const T one(1.0);
    const T sin_series =
        one -
        s * T(1.0 / 6.0) *
            (one - s * T(1.0 / 20.0) *
                       (one - s * T(1.0 / 42.0) *
                                  (one - s * T(1.0 / 72.0) * (one - s * T(1.0 / 110.0) * (one - s * T(1.0 / 156.0))))));
    const T versine_series =
        one -
        s * T(1.0 / 12.0) *
            (one - s * T(1.0 / 30.0) *
                       (one - s * T(1.0 / 56.0) *
                                  (one - s * T(1.0 / 90.0) * (one - s * T(1.0 / 132.0) * (one - s * T(1.0 / 182.0))))));
    return {a * sin_series, T(0.5) * s * versine_series};
}

// A number in (-1, 1) for each roller: whole numbers below 2^49 in floating point, exact in every scalar type.
template <class T> T scattered(T roller, int wheel, T seed) {
    constexpr double prime = 16777213.0; // the largest below 2^24
    T v = modulo(seed * T(69069.0) + roller * T(39916801.0) + T(1000003.0 * (wheel + 1)), prime);
    for (const double salt : {7919.0, 104729.0, 1299709.0}) {
        v = modulo(v * v + T(salt), prime);
    }
    return T(2.0 / prime) * (v + T(0.5)) - T(1.0);
}

} // namespace detail

// What depends on the roller at the bottom alone: kept as modes.
template <class T, int Wheels> void stand_on(const Parameters<T, Wheels> &p, Modes<T, Wheels> &m, int wheel, T roller) {
    m.roller[wheel] = roller;
    const double rows = p.roller_rows;
    const T row = detail::modulo(roller, rows);
    m.roller_offset[wheel] = (row - T(0.5 * (rows - 1.0))) * p.roller_row_distance;
    const T which = detail::modulo(roller, rows * p.roller_per_row);
    m.roller_friction[wheel] = T(1.0) + p.roller_friction_scatter * detail::scattered(which, wheel, p.roller_seed);
}

// `angle`: of the wheel, from its start on, past the vertical.
template <class T, int Wheels>
Rolling<T> rolling(const Parameters<T, Wheels> &p, const Derived<T> &d, const Modes<T, Wheels> &m, int wheel, T angle) {
    Rolling<T> r;
    r.angle = angle + p.roller_phase[wheel] - m.roller[wheel] * d.roller_pitch;
    const auto at = detail::small_angle(r.angle);
    r.radius = p.wheel_radius - d.barrel_offset * at.versine;
    r.slope = T(-1.0) * d.barrel_offset * at.sin;
    r.lever = p.wheel_distance + m.roller_offset[wheel];
    r.row = {T(-Azimuths<Wheels>::sin[wheel]) / r.radius, T(Azimuths<Wheels>::cos[wheel]) / r.radius,
             r.lever / r.radius};
    r.touch = {p.roller_radius - d.barrel_radius * at.versine, m.roller_friction[wheel] * d.roller_level};
    return r;
}

// The roller beside `roller` on which a wheel stands next, `angle` past its middle.
template <class T> T roller_after(T roller, T angle) { return roller + math::sign(angle); }

// Positive while the roller keeps the contact. The next one has it a little past the middle between both, so that it is
// not handed back at once.
template <class T> T hand_over_indicator(const Derived<T> &d, const Rolling<T> &r) {
    return T(0.5) * d.roller_pitch + T(1e-9) - math::abs(r.angle);
}

// Row of J_w with the arrangement that there is.
template <class T, int Wheels>
Planar3<T> wheel_row(const Parameters<T, Wheels> &p, const Derived<T> &d, const Modes<T, Wheels> &m, int wheel,
                     T angle) {
    return discrete(p) ? rolling(p, d, m, wheel, angle).row : wheel_row(p, wheel);
}

// steady_friction() with the arrangement that there is.
template <class T, int Wheels>
T steady_friction_now(const Parameters<T, Wheels> &p, const Derived<T> &d, const Modes<T, Wheels> &m, int wheel, T v,
                      T angle) {
    return discrete(p) ? steady_friction(p, wheel, v, rolling(p, d, m, wheel, angle).touch)
                       : steady_friction(p, wheel, v);
}

// Weight on a wheel of the planar base, which stands.
template <class T, int Wheels> T carried(const Parameters<T, Wheels> &p, const Derived<T> &d, int wheel) {
    const T share = static_load_share(p, wheel, mass_centre(p));
    return p.wheel_traction[wheel] * share * p.base_mass * d.floor_gravity * T(1.0 / Wheels);
}

template <class T, int Wheels, std::size_t N>
Inertia3<T> base_inertia(const Parameters<T, Wheels> &p, const std::array<Rolling<T>, N> &rollers) {
    Inertia3<T> inertia = body_inertia(p);
    for (int i = 0; i < Wheels; ++i) {
        inertia.add(p.wheel_traction[i] * p.wheel_inertia, rollers[i].row);
        inertia.add(p.wheel_traction[i] * p.roller_inertia, roller_row(p, i));
    }
    return inertia;
}

} // namespace giveway::plant
