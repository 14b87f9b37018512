#include "lane_plant_of.hpp"

giveway::batch::LanePlant* giveway::batch::new_lane_plant_4() { return new (std::nothrow) LanePlantOf<4>; }
