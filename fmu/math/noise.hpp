// Counter-based noise: the value depends only on (seed, channel, tick), not on earlier draws, on every platform.
// Philox 4x32 with ten rounds (Salmon et al., SC11); normal deviates by Box and Muller.
#pragma once

#include <array>
#include <cstdint>

#include "elementary.hpp"

namespace giveway::math {

inline std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
    for (int round = 0; round < 10; ++round) {
        const std::uint64_t product0 = 0xD2511F53ULL * counter[0];
        const std::uint64_t product1 = 0xCD9E8D57ULL * counter[2];
        counter = {
            static_cast<std::uint32_t>(product1 >> 32U) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(product1),
            static_cast<std::uint32_t>(product0 >> 32U) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(product0)};
        key[0] += 0x9E3779B9U;
        key[1] += 0xBB67AE85U;
    }
    return counter;
}

namespace detail {

inline constexpr std::uint32_t noise_key = 0x67697665U;

// A standard normal deviate of two numbers in (0, 1).
template <class T> T box_muller(T u1, T u2) { return sqrt(T(-2.0) * log(u1)) * sincos(T(6.283185307179586) * u2).cos; }

} // namespace detail

// Standard normal deviate.
inline double normal(std::uint32_t seed, std::uint32_t channel, std::uint64_t tick) {
    const auto words =
        philox4x32({static_cast<std::uint32_t>(tick), static_cast<std::uint32_t>(tick >> 32U), channel, 0U},
                   {seed, detail::noise_key});
    const double u1 = (static_cast<double>(words[0]) + 0.5) * 0x1p-32; // in (0, 1)
    const double u2 = (static_cast<double>(words[1]) + 0.5) * 0x1p-32;
    return detail::box_muller(u1, u2);
}

// Evenly distributed in (0, 1).
inline double uniform(std::uint32_t seed, std::uint32_t channel, std::uint64_t tick) {
    const auto words =
        philox4x32({static_cast<std::uint32_t>(tick), static_cast<std::uint32_t>(tick >> 32U), channel, 0U},
                   {seed, detail::noise_key});
    return (static_cast<double>(words[0]) + 0.5) * 0x1p-32;
}

} // namespace giveway::math
