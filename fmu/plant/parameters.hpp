// Parameters of the plant, SI units; README.md of this folder has the equations.
#pragma once

#include <array>
#include <cstdint>

// Before any equation: `math::` names are looked up where a template is written, so every scalar type has to be known
// here.
#include "../math/dual.hpp"
#include "../math/lanes_elementary.hpp"

#include "plant_parameters.hpp"

namespace giveway::plant {

inline constexpr int wheel_count = 3;
inline constexpr int max_outline_vertices = 16;

// Wheel azimuths 0, 120, 240 deg in the base frame.
inline constexpr double half_sqrt3 = 0.8660254037844386;
inline constexpr std::array<double, wheel_count> wheel_cos = {1.0, -0.5, -0.5};
inline constexpr std::array<double, wheel_count> wheel_sin = {0.0, half_sqrt3, -half_sqrt3};

inline constexpr double gravity_mps2 = 9.81;

// Those of the testbed's variable table (models/testbed/variables.toml says what each is), and what follows from
// several of them.
template <class T> struct Parameters : TableParameters<T> {
    std::array<T, wheel_count> wheel_load;     // normal load over its nominal value; on a plane 1
    std::array<T, wheel_count> wheel_traction; // 1 on the floor, 0 lifted; on a plane 1
    // Parts of the outline at the contact's height: the body's polygon, the wheels.
    std::int32_t outline_body, outline_wheels;

    // The plate moves on its own only if there is one.
    [[nodiscard]] bool has_plate() const { return this->bumper_kind != BumperKind::none; }
    [[nodiscard]] bool plate_on_robot() const { return has_plate() && this->bumper_mount == BumperMount::robot; }
};

} // namespace giveway::plant
