// Checks of Lanes<N>, compiled once per width for the processors that have it. They call report(what, found, expected, lane) for each wrong number.
#pragma once

#include <cstring>

namespace giveway::lanes_checks {

using Report = void (*)(const char* what, double found, double expected, int lane);

inline void compare(Report report, const char* what, double found, double expected, int lane) {
    if (std::memcmp(&found, &expected, sizeof found) != 0) {
        report(what, found, expected, lane);
    }
}

void operations_1(Report report);
void operations_4(Report report);
void operations_8(Report report);
void plant_1(Report report);
void plant_4(Report report);
void plant_8(Report report);

} // namespace giveway::lanes_checks
