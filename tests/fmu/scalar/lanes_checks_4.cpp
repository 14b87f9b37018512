#include "lanes_checks_of.hpp"

void giveway::lanes_checks::operations_4(Report report) { operations<4>(report); }
void giveway::lanes_checks::functions_4(Report report) {
    own_functions<4>(report);
    noise_in_lanes<4>(report);
}
void giveway::lanes_checks::plant_4(Report report) { plant_in_lanes<4>(report); }
