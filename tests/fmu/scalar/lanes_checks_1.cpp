#include "lanes_checks_of.hpp"

void giveway::lanes_checks::operations_1(Report report) { operations<1>(report); }
void giveway::lanes_checks::functions_1(Report report) {
    own_functions<1>(report);
    noise_in_lanes<1>(report);
}
void giveway::lanes_checks::plant_1(Report report) { plant_in_lanes<1>(report); }
