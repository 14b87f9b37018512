// Rounding of an importer's times.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace giveway {

// A start time beyond this is refused: rounding could then shift a time to the neighbouring servo tick.
inline constexpr double greatest_start_time_s = 1e10;

// Largest difference, s, between two values of one time that were summed in different orders.
inline double time_rounding(double time_s) { return 4.0 * std::numeric_limits<double>::epsilon() * std::fabs(time_s); }

// Tolerance, in ticks of `rate_hz`, within which a time belongs to a tick. Ticks are integers; times are an importer's
// sums and are rounded according to their magnitude.
inline double tick_tolerance(double time_s, double rate_hz) { return std::max(1e-6, rate_hz * time_rounding(time_s)); }

} // namespace giveway
