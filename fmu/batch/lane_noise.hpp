// Noise of several designs side by side.
#pragma once

#include <cstdint>

namespace giveway::batch {

// For channels 0 .. channels - 1 a row of standard normal deviates, one per design; the bits are those of
// math::normal(seeds[i], channel, tick).
using LaneNoise = void (*)(const std::uint64_t *seeds, int channels, std::int64_t tick, double *rows);

void lane_noise_1(const std::uint64_t *seeds, int channels, std::int64_t tick, double *rows);
void lane_noise_4(const std::uint64_t *seeds, int channels, std::int64_t tick, double *rows); // AVX2
void lane_noise_8(const std::uint64_t *seeds, int channels, std::int64_t tick, double *rows); // AVX-512 F, DQ and VL

} // namespace giveway::batch
