#include "lane_noise_of.hpp"
#include "lane_plant_of.hpp"

giveway::batch::LanePlant *giveway::batch::new_lane_plant_4() { return new (std::nothrow) LanePlantOf<4>; }

void giveway::batch::lane_noise_4(const std::uint64_t *seeds, int channels, std::int64_t tick, double *rows) {
    lane_noise_of<4>(seeds, channels, tick, rows);
}
