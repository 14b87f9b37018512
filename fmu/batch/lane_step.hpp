// The longest fixed step of a design, from its stiffest elements alone.
#pragma once

#include "bumper_laws.hpp"

namespace giveway::batch {

// Steps per servo tick of 0.5 ms that a design can have; a design that needs more runs event-exact.
inline constexpr int lane_steps[] = {1, 2, 4, 8, 16, 32};

// 0 if even the shortest step is too long. `impact_speed_mps`: at which the slider may hit.
int lane_steps_per_tick(const plant::Parameters<double> &p, double impact_speed_mps);

// The largest speed that the slider can reach before it hits, by its own speed and the hanging weight.
double greatest_impact_speed(const plant::Parameters<double> &p, double slider_speed_mps, double base_speed_mps);

} // namespace giveway::batch
