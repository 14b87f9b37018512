#include "lanes_checks_of.hpp"

void giveway::lanes_checks::operations_4(Report report) { operations<4>(report); }
void giveway::lanes_checks::plant_4(Report report) { plant_in_lanes<4>(report); }
