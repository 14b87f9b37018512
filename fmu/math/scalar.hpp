// The operations that the plant may use on its scalar type T, for T = double.
//
// A scalar type offers + - * /, comparisons through less(), and the functions below. There is no conversion to bool:
// a comparison gives a mask, and only select() reads it, so a vector of designs takes every path at once.
#pragma once

#include <bit>
#include <cstdint>

namespace giveway::math {

using Mask = bool;

inline Mask less(double a, double b) { return a < b; }
inline double select(Mask mask, double if_true, double if_false) { return mask ? if_true : if_false; }
inline double min(double a, double b) { return a < b ? a : b; }
inline double max(double a, double b) { return a > b ? a : b; }
inline double abs(double a) { return std::bit_cast<double>(std::bit_cast<std::uint64_t>(a) & ~(1ULL << 63U)); }
// The square root instruction is correctly rounded on every target: no libm call.
inline double sqrt(double a) { return __builtin_sqrt(a); }

// Nearest integer (ties to even) for |a| < 2^51, by the rounding of an addition.
inline double round(double a) {
    constexpr double shift = 6755399441055744.0; // 1.5 * 2^52
    return (a + shift) - shift;
}

// 2^k for an integral k in [-1022, 1023].
inline double exp2_integer(double k) {
    return std::bit_cast<double>(static_cast<std::uint64_t>(static_cast<std::int64_t>(k) + 1023) << 52U);
}

// a = 2^exponent * mantissa with the mantissa in [1, 2), of a normal number above 0.
template <class T> struct Split {
    T exponent, mantissa;
};
inline Split<double> split(double a) {
    const auto bits = std::bit_cast<std::uint64_t>(a);
    return {static_cast<double>(static_cast<std::int64_t>(bits >> 52U) - 1023),
            std::bit_cast<double>((bits & 0x000FFFFFFFFFFFFFULL) | 0x3FF0000000000000ULL)};
}

// A constant divisor: lanes store its inverse, as a multiplication is much cheaper.
template <class T> struct DivisorOf {
    using Type = T;
};
template <class T> using Divisor = typename DivisorOf<T>::Type;

template <class T> T clamp(T a, T low, T high) { return max(low, min(a, high)); }

// -1, 0 or +1.
template <class T> T sign(T a) { return select(less(T(0.0), a), T(1.0), select(less(a, T(0.0)), T(-1.0), T(0.0))); }

template <class T> T square(T a) { return a * a; }

// Whether a one-sided element (contact, stop, rope) acts, 1 or 0. Its mode decides, as an integrator with root finding
// changes it at depth = 0. Lanes have no root finding and also check the depth.
template <class T> T acting(T mode, T) { return mode; }

// of(), whose result is used only where `needed`. Lanes skip it if no design needs it, and give 0 where a design does
// not.
template <class M, class Of> auto where(M, Of of) { return of(); }

} // namespace giveway::math
