// exp and tanh of lanes, which the plant asks for nine times in every stage of a step: to 1e-11 in place of the last place, a thousandth of
// what the steps themselves are off by, at half the operations and a quarter of the latency of those in elementary.hpp.
#pragma once

#include "elementary.hpp"
#include "lanes.hpp"

namespace giveway::math {

namespace detail {

// 2^a for |a| <= 1022: a whole number for the exponent, and a polynomial for what is left in [-1/2, 1/2], summed in pairs because a long chain of
// operations is what such a function costs. (2^f - 1) / f through eight Chebyshev points: exact at 0, elsewhere off by less than 3e-12.
template <int N> Lanes<N> exp2(Lanes<N> a) {
    using L = Lanes<N>;
    const L shift(6755399441055744.0); // 1.5 * 2^52: the sum carries the whole number in its lowest bits
    const L sum = a + shift;
    const L f = a - (sum - shift);
    const L f2 = f * f;
    const L low = (L(0.6931471805568324) + L(0.24022650695888503) * f) + (L(0.055504109063258665) + L(0.00961812913523617) * f) * f2;
    const L high = (L(0.0013333478473685394) + L(0.0001540347518650017) * f) + (L(1.5303700711372768e-05) + L(1.3250805525666974e-06) * f) * f2;
    const L power = L(1.0) + f * (low + high * (f2 * f2));
    const auto exponent = std::bit_cast<typename L::Bits>(sum.value) << 52;
    return L::of(std::bit_cast<typename L::Numbers>(std::bit_cast<typename L::Bits>(power.value) + exponent));
}

} // namespace detail

// e^a; a is clamped as for double.
template <int N> Lanes<N> exp(Lanes<N> a) {
    using L = Lanes<N>;
    return detail::exp2(clamp(a, L(detail::exp_minimum), L(detail::exp_maximum)) * L(detail::log2_e));
}

// Odd, and exactly +-1 beyond |a| = 20.
template <int N> Lanes<N> tanh(Lanes<N> a) {
    using L = Lanes<N>;
    const L e = detail::exp2(min(abs(a), L(20.0)) * L(2.0 * detail::log2_e));
    const L t = (e - L(1.0)) / (e + L(1.0));
    return select(less(a, L(0.0)), L(-1.0) * t, t);
}

} // namespace giveway::math
