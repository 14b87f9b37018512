// Arrangement of the wheels around the base: the only place with their azimuths.
#pragma once

#include <array>

namespace giveway::plant {

// Of wheels spread evenly, wheel 0 ahead, the others counter-clockwise: cos and sin of their azimuths, and the distance
// of the line between two neighbours from the base's centre, over that of the wheels. Another count of wheels is one
// more specialisation.
template <int Wheels> struct Azimuths;

template <> struct Azimuths<3> { // 0, 120, 240 deg
    static constexpr double half_sqrt3 = 0.8660254037844386;
    static constexpr std::array<double, 3> cos = {1.0, -0.5, -0.5};
    static constexpr std::array<double, 3> sin = {0.0, half_sqrt3, -half_sqrt3};
    static constexpr double side_distance = 0.5;
};

// Outward unit vector across the line from a wheel to the next.
struct Side {
    double cos, sin;
};
template <int Wheels> constexpr Side side_after(int wheel) {
    using A = Azimuths<Wheels>;
    const int next = wheel + 1 == Wheels ? 0 : wheel + 1;
    const double length = 2.0 * A::side_distance;
    return {(A::cos[wheel] + A::cos[next]) / length, (A::sin[wheel] + A::sin[next]) / length};
}

// Wheel torque that balances a force (in base axes) and a moment about the centre: a row of J_w^-T, the closed form of
// (15); of more than three wheels the share that asks least of them.
template <int Wheels, class T> T balancing_torque(int wheel, T radius, T distance, T force_x, T force_y, T moment) {
    using A = Azimuths<Wheels>;
    return radius * (T(2.0 / Wheels) * (T(A::cos[wheel]) * force_y - T(A::sin[wheel]) * force_x) +
                     moment / (T(static_cast<double>(Wheels)) * distance));
}

} // namespace giveway::plant
