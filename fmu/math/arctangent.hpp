// The angle of a vector, rounded correctly: the same bits on every platform, where mathematics libraries differ in the
// last one.
#pragma once

#include <cmath>
#include <limits>

namespace giveway::math {

namespace detail {

// A sum of two doubles that do not overlap: some 106 bits.
struct Pair {
    double high, low;
};

inline Pair sum_of(double a, double b) { // exact
    const double sum = a + b;
    const double part = sum - a;
    return {sum, (a - (sum - part)) + (b - part)};
}

inline Pair product_of(double a, double b) { // exact, of numbers that are neither huge nor tiny
    constexpr double splitter = 134217729.0; // 2^27 + 1
    const double a_high = splitter * a - (splitter * a - a);
    const double b_high = splitter * b - (splitter * b - b);
    const double a_low = a - a_high;
    const double b_low = b - b_high;
    const double product = a * b;
    return {product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

inline Pair operator+(Pair a, Pair b) {
    const Pair high = sum_of(a.high, b.high);
    const Pair low = sum_of(a.low, b.low);
    const Pair sum = sum_of(high.high, high.low + low.high);
    return sum_of(sum.high, sum.low + low.low);
}

inline Pair operator-(Pair a) { return {-a.high, -a.low}; }

inline Pair operator*(Pair a, Pair b) {
    const Pair product = product_of(a.high, b.high);
    return sum_of(product.high, product.low + (a.high * b.low + a.low * b.high));
}

inline Pair operator/(Pair a, Pair b) {
    const double first = a.high / b.high;
    const Pair rest = a + -(b * Pair{first, 0.0});
    const double second = rest.high / b.high;
    const Pair last = rest + -(b * Pair{second, 0.0});
    return sum_of(first, second) + Pair{last.high / b.high, 0.0};
}

inline constexpr Pair half_pi{0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};
inline constexpr Pair whole_pi{0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53};
// atan(k / 16)
inline constexpr Pair atan_sixteenths[17] = {
    {0x0.0p+0, 0x0.0p+0},
    {0x1.ff55bb72cfdeap-5, -0x1.c934d86d23f1dp-60},
    {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
    {0x1.7b97b4bce5b02p-3, 0x1.347b0b4f881cap-58},
    {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
    {0x1.362773707ebccp-2, -0x1.963a544b672d8p-57},
    {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
    {0x1.a64eec3cc23fdp-2, -0x1.24dec1b50b7ffp-56},
    {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
    {0x1.0657e94db30d0p-1, -0x1.d5b495f6349e6p-56},
    {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
    {0x1.345f01cce37bbp-1, 0x1.1021137c71102p-55},
    {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
    {0x1.5d58987169b18p-1, 0x1.0028e4bc5e7cap-57},
    {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
    {0x1.819d0b7158a4dp-1, -0x1.bf76229d3b917p-56},
    {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55},
};

// atan(smaller / larger) for 0 <= smaller <= larger.
inline Pair atan_of_fraction(double smaller, double larger) {
    const int nearest = static_cast<int>(smaller / larger * 16.0 + 0.5);
    const double known = nearest / 16.0;
    const Pair numerator = Pair{smaller, 0.0} + -product_of(known, larger);
    const Pair denominator = Pair{larger, 0.0} + product_of(known, smaller);
    const Pair rest = numerator / denominator; // |rest| <= 1/32
    const Pair square = rest * rest;
    Pair series{0.0, 0.0};
    for (int power = 23; power >= 1; power -= 2) { // the first one that is left out is below 2^-129
        series = Pair{1.0, 0.0} / Pair{static_cast<double>(power), 0.0} + -(square * series);
    }
    return atan_sixteenths[nearest] + rest * series;
}

} // namespace detail

// The angle of (x, y) in [-pi, pi]; of (0, 0) as the signs of the zeros have it. NaN unless both are finite.
inline double angle_of(double y, double x) {
    const double x_size = std::fabs(x);
    const double y_size = std::fabs(y);
    const bool steep = y_size > x_size;
    const double larger = steep ? y_size : x_size;
    if (std::isnan(x) || std::isnan(y) || larger > std::numeric_limits<double>::max()) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    detail::Pair angle{0.0, 0.0};
    if (larger > 0.0) {
        // Powers of two change no bit of the quotient and keep the products in range.
        const double scale = larger > 1.0 ? 0x1p-300 : larger < 0x1p-700 ? 0x1p900 : 0x1p300;
        const bool extreme = larger > 0x1p300 || larger < 0x1p-300;
        const double factor = extreme ? scale : 1.0;
        angle = detail::atan_of_fraction((steep ? x_size : y_size) * factor, larger * factor);
    }
    if (steep) {
        angle = detail::half_pi + -angle;
    }
    if (std::signbit(x)) {
        angle = detail::whole_pi + -angle;
    }
    return std::copysign(angle.high + angle.low, y);
}

} // namespace giveway::math
