// exp, expm1, log, tanh, sin and cos from arithmetic alone, so that every platform and every lane gives the same bits.
// Errors: a few units in the last place (tests/fmu/math compares them with long double libm).
#pragma once

#include "scalar.hpp"

namespace giveway::math {

namespace detail {

// (e^r - 1) for |r| <= ln(2)/2: Taylor series, truncation below 1e-17 of the result.
template <class T> T expm1_reduced(T r) {
    T p = T(1.0 / 87178291200.0); // 1/14!
    p = p * r + T(1.0 / 6227020800.0);
    p = p * r + T(1.0 / 479001600.0);
    p = p * r + T(1.0 / 39916800.0);
    p = p * r + T(1.0 / 3628800.0);
    p = p * r + T(1.0 / 362880.0);
    p = p * r + T(1.0 / 40320.0);
    p = p * r + T(1.0 / 5040.0);
    p = p * r + T(1.0 / 720.0);
    p = p * r + T(1.0 / 120.0);
    p = p * r + T(1.0 / 24.0);
    p = p * r + T(1.0 / 6.0);
    p = p * r + T(0.5);
    return r + r * r * p;
}

// Beyond these limits exp would overflow or lose bits in denormal numbers.
inline constexpr double exp_minimum = -708.0;
inline constexpr double exp_maximum = 709.0;
inline constexpr double log2_e = 1.4426950408889634;
// ln 2 in two parts; the first has 21 trailing zero bits, so k * ln2_high is exact for |k| <= 1100.
inline constexpr double ln2_high = 0x1.62e42fee00000p-1;
inline constexpr double ln2_low = 0x1.a39ef35793c76p-33;

} // namespace detail

// e^a; a is clamped to [-708, 709], where the result is a normal finite number.
template <class T> T exp(T a) {
    const T x = clamp(a, T(detail::exp_minimum), T(detail::exp_maximum));
    const T k = round(x * T(detail::log2_e));
    const T r = (x - k * T(detail::ln2_high)) - k * T(detail::ln2_low);
    return (detail::expm1_reduced(r) + T(1.0)) * exp2_integer(k);
}

// e^a - 1 without cancellation near 0; the same range as exp.
template <class T> T expm1(T a) {
    const T x = clamp(a, T(detail::exp_minimum), T(detail::exp_maximum));
    const T k = round(x * T(detail::log2_e));
    const T r = (x - k * T(detail::ln2_high)) - k * T(detail::ln2_low);
    const T scale = exp2_integer(k);
    return detail::expm1_reduced(r) * scale + (scale - T(1.0));
}

// Natural logarithm of a normal number in (0, 1e300]: a = 2^k m, ln m by the atanh series.
template <class T> T log(T a) {
    const Split<T> parts = split(a);
    const auto high = less(T(1.4142135623730951), parts.mantissa);
    const T m = select(high, T(0.5) * parts.mantissa, parts.mantissa);
    const T k = parts.exponent + select(high, T(1.0), T(0.0));
    const T s = (m - T(1.0)) / (m + T(1.0)); // |s| < 0.1716
    const T s2 = s * s;
    // 1/n as constants: the loop would divide.
    constexpr double inverse[] = {1.0 / 19.0, 1.0 / 17.0, 1.0 / 15.0, 1.0 / 13.0, 1.0 / 11.0,
                                  1.0 / 9.0,  1.0 / 7.0,  1.0 / 5.0,  1.0 / 3.0,  1.0};
    T p(1.0 / 21.0);
    for (const double coefficient : inverse) {
        p = p * s2 + T(coefficient);
    }
    return k * T(detail::ln2_high) + (k * T(detail::ln2_low) + T(2.0) * s * p);
}

// Odd, and exactly +-1 beyond |a| = 20.
template <class T> T tanh(T a) {
    const T magnitude = min(abs(a), T(20.0));
    const T e = expm1(T(-2.0) * magnitude);
    const T t = T(-1.0) * e / (e + T(2.0));
    return select(less(a, T(0.0)), T(-1.0) * t, t);
}

template <class T> struct SinCos {
    T sin, cos;
};

// For |a| < 1e5 rad.
template <class T> SinCos<T> sincos(T a) {
    const T n = round(a * T(0.63661977236758134)); // 2/pi
    // pi/2 in three parts, the first two with trailing zero bits.
    T r = a - n * T(0x1.921fb54400000p+0);
    r = r - n * T(0x1.0b4611a600000p-34);
    r = r - n * T(0x1.3198a2e037073p-69);
    const T r2 = r * r;
    T s = T(1.0 / 355687428096000.0); // 1/17!
    s = s * r2 - T(1.0 / 1307674368000.0);
    s = s * r2 + T(1.0 / 6227020800.0);
    s = s * r2 - T(1.0 / 39916800.0);
    s = s * r2 + T(1.0 / 362880.0);
    s = s * r2 - T(1.0 / 5040.0);
    s = s * r2 + T(1.0 / 120.0);
    s = s * r2 - T(1.0 / 6.0);
    s = r + r * r2 * s;
    T c = T(1.0 / 20922789888000.0); // 1/16!
    c = c * r2 - T(1.0 / 87178291200.0);
    c = c * r2 + T(1.0 / 479001600.0);
    c = c * r2 - T(1.0 / 3628800.0);
    c = c * r2 + T(1.0 / 40320.0);
    c = c * r2 - T(1.0 / 720.0);
    c = c * r2 + T(1.0 / 24.0);
    c = (T(1.0) - T(0.5) * r2) + r2 * r2 * c;
    // Quadrant n mod 4 in {-2, -1, 0, 1, 2}.
    const T quadrant = n - T(4.0) * round(n * T(0.25));
    const T distance = abs(quadrant);
    const auto odd = less(T(0.5), distance * (T(2.0) - distance)); // distance is 1
    const T sin_sign = select(odd, quadrant, T(1.0) - distance);
    const T cos_sign = select(odd, T(-1.0) * quadrant, T(1.0) - distance);
    return {sin_sign * select(odd, c, s), cos_sign * select(odd, s, c)};
}

// For the base's heading; lanes have their own version.
template <class T> SinCos<T> heading(const T &a) { return sincos(a); }

} // namespace giveway::math
