#include "lane_noise_of.hpp"
#include "lane_plant_of.hpp"

giveway::batch::LanePlant *giveway::batch::new_lane_plant_8() { return new (std::nothrow) LanePlantOf<8>; }

void giveway::batch::lane_noise_8(const std::uint64_t *seeds, int channels, std::int64_t tick, double *rows) {
    lane_noise_of<8>(seeds, channels, tick, rows);
}
