// Checks of Lanes<N>, compiled once per width for the processors that have it. They call report(what, found, expected,
// lane) for each wrong number.
#pragma once

#include <cmath>
#include <cstring>

namespace giveway::lanes_checks {

using Report = void (*)(const char *what, double found, double expected, int lane);

inline void compare(Report report, const char *what, double found, double expected, int lane) {
    if (std::memcmp(&found, &expected, sizeof found) != 0) {
        report(what, found, expected, lane);
    }
}

inline void compare_close(Report report, const char *what, double found, double expected, double relative) {
    if (!(std::fabs(found - expected) <= relative * std::fabs(expected))) {
        report(what, found, expected, 0);
    }
}

void operations_1(Report report);
void functions_1(Report report);
void operations_4(Report report);
void functions_4(Report report);
void operations_8(Report report);
void functions_8(Report report);
void plant_1(Report report);
void plant_4(Report report);
void plant_8(Report report);

} // namespace giveway::lanes_checks
