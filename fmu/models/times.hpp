// What rounding does to an importer's times.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace giveway {

// A start time beyond this is refused: times are then so coarse that one could be taken for the servo tick beside it.
inline constexpr double greatest_start_time_s = 1e10;

// How far two values of one time, s, can lie apart that were added up in different orders.
inline double time_rounding(double time_s) { return 4.0 * std::numeric_limits<double>::epsilon() * std::fabs(time_s); }

// How far a time may be off a tick, in ticks of `rate_hz`, and still be that tick. Ticks are counted in integers; times
// are an importer's sums, and carry the rounding of their magnitude.
inline double tick_tolerance(double time_s, double rate_hz) { return std::max(1e-6, rate_hz * time_rounding(time_s)); }

} // namespace giveway
