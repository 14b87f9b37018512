// exp and tanh of lanes, which the plant calls nine times in every stage of a step. They are exact to 1e-11 instead of
// the last place, a thousandth of the error of the steps, with half the operations and a quarter of the latency of
// those in elementary.hpp.
#pragma once

#include "elementary.hpp"
#include "lanes.hpp"

namespace giveway::math {

namespace detail {

// 2^a for |a| <= 1022: an integer for the exponent, and a polynomial for the remainder in [-1/2, 1/2], summed in pairs
// because a long chain of dependent operations is the main cost. (2^f - 1) / f through eight Chebyshev points: exact at
// 0, elsewhere off by less than 3e-12.
template <int N> Lanes<N> exp2(Lanes<N> a) {
    using L = Lanes<N>;
    const L shift(6755399441055744.0); // 1.5 * 2^52: the sum carries the whole number in its lowest bits
    const L sum = a + shift;
    const L f = a - (sum - shift);
    const L f2 = f * f;
    const L low = (L(0.6931471805568324) + L(0.24022650695888503) * f) +
                  (L(0.055504109063258665) + L(0.00961812913523617) * f) * f2;
    const L high = (L(0.0013333478473685394) + L(0.0001540347518650017) * f) +
                   (L(1.5303700711372768e-05) + L(1.3250805525666974e-06) * f) * f2;
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

// To 4e-13, for |a| < 1e5 rad. sincos() itself has to give the noise the same bits as for double.
template <int N> SinCos<Lanes<N>> heading(const Lanes<N> &a) {
    using L = Lanes<N>;
    using Bits = typename L::Bits;
    const L shift(6755399441055744.0);
    const L sum = a * L(0.63661977236758134) + shift; // the quadrant in its lowest bits
    const L n = sum - shift;
    const L r = (a - n * L(0x1.921fb54400000p+0)) -
                n * L(0x1.0b4611a626331p-34); // pi/2 in two parts, the first with trailing zero bits
    const L r2 = r * r;
    const L r4 = r2 * r2;
    const L s =
        (L(-1.0 / 6.0) + L(1.0 / 120.0) * r2) +
        ((L(-1.0 / 5040.0) + L(1.0 / 362880.0) * r2) + (L(-1.0 / 39916800.0) + L(1.0 / 6227020800.0) * r2) * r4) * r4;
    const L c = (L(1.0 / 24.0) - L(1.0 / 720.0) * r2) +
                ((L(1.0 / 40320.0) - L(1.0 / 3628800.0) * r2) + L(1.0 / 479001600.0) * r4) * r4;
    const L sin = r + (r * r2) * s;
    const L cos = (L(1.0) - L(0.5) * r2) + r4 * c;
    const auto quadrant = std::bit_cast<Bits>(sum.value);
    const LaneMask<N> odd{quadrant & 1};
    const auto negated = [](L b, Bits twos) {
        return L::of(std::bit_cast<typename L::Numbers>(std::bit_cast<Bits>(b.value) ^ ((twos & 2) << 62)));
    };
    return {negated(select(odd, cos, sin), quadrant), negated(select(odd, sin, cos), quadrant + 1)};
}

} // namespace giveway::math
