#include "lane_plant_of.hpp"

giveway::batch::LanePlant* giveway::batch::new_lane_plant_1() { return new (std::nothrow) LanePlantOf<1>; }
