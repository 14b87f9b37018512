#include "lanes_checks_of.hpp"

void giveway::lanes_checks::operations_8(Report report) { operations<8>(report); }
void giveway::lanes_checks::functions_8(Report report) {
    own_functions<8>(report);
    noise_in_lanes<8>(report);
}
void giveway::lanes_checks::plant_8(Report report) { plant_in_lanes<8>(report); }
