// What the plant's parameters choose among; the numbers are those of the variable tables.
#pragma once

#include <cstdint>

namespace giveway::plant {

enum class RollerModel : std::uint8_t { bristle = 0, tanh = 1 };
enum class BumperKind : std::uint8_t { none = 0, spring = 1, magnetic = 2 };
enum class BumperMount : std::uint8_t { slider = 0, robot = 1 };
enum class LatchModel : std::uint8_t { continuous = 0, ideal = 1 };
enum class NoseShape : std::uint8_t { disc = 0, edge = 1 };

} // namespace giveway::plant
