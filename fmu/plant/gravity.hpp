#pragma once

namespace giveway::plant {

inline constexpr double gravity_mps2 = 9.81;

} // namespace giveway::plant
