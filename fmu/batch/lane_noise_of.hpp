// lane_noise for N lanes. Included by one file per width.
#pragma once

#include <cstring>

#include "lane_noise.hpp"
#include "lanes_noise.hpp"

namespace giveway::batch {

template <int N> void lane_noise_of(const std::uint64_t *seeds, int channels, std::int64_t tick, double *rows) {
    typename math::Lanes<N>::Bits key;
    std::memcpy(&key, seeds, sizeof key);
    for (int channel = 0; channel < channels; ++channel) {
        math::normal<N>(key, static_cast<std::uint32_t>(channel), static_cast<std::uint64_t>(tick))
            .store(rows + channel * N);
    }
}

} // namespace giveway::batch
