// Parameters of the plant, SI units; README.md of this folder has the equations.
#pragma once

#include <array>
#include <cstdint>

// Included before any equation: `math::` names are looked up where a template is written, so every scalar type has to
// be known here.
#include "../math/dual.hpp"
#include "../math/lanes_elementary.hpp"

#include "gravity.hpp"
#include "plant_parameters.hpp"
#include "wheels.hpp"

namespace giveway::plant {

inline constexpr int max_outline_vertices = 16;

// Those of the testbed's variable table (models/testbed/variables.toml says what each is), and what follows from
// several of them. The count of wheels is an argument of all that depends on it; what is left out is the table's robot.
template <class T, int Wheels = table_wheels> struct Parameters : TableParameters<T, Wheels> {
    std::array<T, Wheels> wheel_load;     // roller friction over that at nominal load
    std::array<T, Wheels> wheel_traction; // 1 on the floor, 0 lifted; on a plane 1
    // Parts of the outline at the contact's height: the body's polygon, the wheels.
    std::int32_t outline_body, outline_wheels;

    // The plate moves on its own only if there is one.
    [[nodiscard]] bool has_plate() const { return this->bumper_kind != BumperKind::none; }
    [[nodiscard]] bool plate_on_robot() const { return has_plate() && this->bumper_mount == BumperMount::robot; }
};

} // namespace giveway::plant
