// The noise of noise.hpp for several seeds side by side, with the same bits.
#pragma once

#include "lanes.hpp"
#include "noise.hpp"

namespace giveway::math {

namespace detail {

// A word is the low half of its lane; the high half is ignored.
template <int N>
std::array<typename Lanes<N>::Bits, 4> philox4x32_words(std::array<typename Lanes<N>::Bits, 4> counter,
                                                        std::array<typename Lanes<N>::Bits, 2> key) {
    using Register = typename Lanes<N>::Register;
    using Bits = typename Lanes<N>::Bits;
    const Bits none{};
    for (int round = 0; round < 10; ++round) {
        const Bits product0 = Register::multiply_words(none + 0xD2511F53LL, counter[0]);
        const Bits product1 = Register::multiply_words(none + 0xCD9E8D57LL, counter[2]);
        counter = {(product1 >> 32) ^ counter[1] ^ key[0], product1, (product0 >> 32) ^ counter[3] ^ key[1], product0};
        key[0] += 0x9E3779B9LL;
        key[1] += 0xBB67AE85LL;
    }
    return counter;
}

// A word w as (w + 1/2) / 2^32.
template <int N> Lanes<N> open_unit(typename Lanes<N>::Bits word) {
    using L = Lanes<N>;
    const auto bits = (word & 0xFFFFFFFFLL) | 0x4330000000000000LL; // 2^52 + w
    return (L::of(std::bit_cast<typename L::Numbers>(bits)) - L(0x1p52) + L(0.5)) * L(0x1p-32);
}

} // namespace detail

template <int N> Lanes<N> normal(typename Lanes<N>::Bits seeds, std::uint32_t channel, std::uint64_t tick) {
    using Bits = typename Lanes<N>::Bits;
    const Bits none{};
    const auto words = detail::philox4x32_words<N>({none + static_cast<std::int64_t>(tick & 0xFFFFFFFFU),
                                                    none + static_cast<std::int64_t>(tick >> 32U),
                                                    none + static_cast<std::int64_t>(channel), none},
                                                   {seeds, none + std::int64_t{detail::noise_key}});
    return detail::box_muller(detail::open_unit<N>(words[0]), detail::open_unit<N>(words[1]));
}

} // namespace giveway::math
