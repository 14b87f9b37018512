// Lanes<N> against double: every operation that the plant uses, in every lane, bit for bit; and the plant itself.
// Included by one file per width.
#pragma once

#include <cmath>
#include <cstring>

#include "convert.hpp"
#include "lanes_checks.hpp"
#include "lanes_noise.hpp"
#include "random_cases.hpp"

namespace giveway::lanes_checks {

template <int N> struct Rows {
    double value[N];
    explicit Rows(math::Lanes<N> lanes) { lanes.store(value); }
};

// Numbers of every kind: signs, zeros, small, large, whole.
inline double number(unsigned index) {
    const double kinds[] = {0.0,     -0.0, 1.0,    -1.0,  0.5,    -2.5,   3.0,  1e-9,
                            -1e-300, 1e5,  -7.0e4, 709.0, -708.5, 1e-310, 20.0, -0.3465};
    const double fraction = static_cast<double>((index * 2654435761U) % 1000003U) / 1000003.0;
    return index % 3U == 0U ? kinds[(index / 3U) % 16U] : (fraction - 0.5) * (index % 3U == 1U ? 40.0 : 1e-3);
}

template <int N> void operations(Report report) {
    using L = math::Lanes<N>;
    for (unsigned index = 0; index < 3000U; ++index) {
        double a[N];
        double b[N];
        for (unsigned i = 0; i < N; ++i) {
            a[i] = number(index + i);
            b[i] = number(7U * index + 3U * i + 1U);
        }
        const L x = L::load(a);
        const L y = L::load(b);
        const auto expect = [&](const char *name, L lanes, auto scalar) {
            const Rows<N> found(lanes);
            for (int i = 0; i < N; ++i) {
                compare(report, name, found.value[i], scalar(a[i], b[i]), i);
            }
        };
        expect("+", x + y, [](double p, double q) { return p + q; });
        expect("-", x - y, [](double p, double q) { return p - q; });
        expect("*", x * y, [](double p, double q) { return p * q; });
        expect("/", x / math::select(math::less(math::abs(y), L(1e-300)), L(3.0), y),
               [](double p, double q) { return p / (math::abs(q) < 1e-300 ? 3.0 : q); });
        expect("min", math::min(x, y), [](double p, double q) { return math::min(p, q); });
        expect("max", math::max(x, y), [](double p, double q) { return math::max(p, q); });
        expect("abs", math::abs(x), [](double p, double) { return math::abs(p); });
        expect("sqrt", math::sqrt(math::abs(x)), [](double p, double) { return math::sqrt(math::abs(p)); });
        expect("round", math::round(x), [](double p, double) { return math::round(p); });
        expect("sign", math::sign(x), [](double p, double) { return math::sign(p); });
        expect("select", math::select(math::less(x, y), x, y), [](double p, double q) { return p < q ? p : q; });
        // Lanes have their own exp and tanh, identical in every width.
        expect("exp", math::exp(x), [](double p, double) { return math::exp(math::Lanes<1>(p)).value; });
        expect("expm1", math::expm1(x), [](double p, double) { return math::expm1(p); });
        expect("tanh", math::tanh(x), [](double p, double) { return math::tanh(math::Lanes<1>(p)).value; });
        expect("heading, sin", math::heading(x).sin,
               [](double p, double) { return math::heading(math::Lanes<1>(p)).sin.value; });
        expect("heading, cos", math::heading(x).cos,
               [](double p, double) { return math::heading(math::Lanes<1>(p)).cos.value; });
        expect("sin", math::sincos(x).sin, [](double p, double) { return math::sincos(p).sin; });
        expect("cos", math::sincos(x).cos, [](double p, double) { return math::sincos(p).cos; });
        const L positive = math::max(math::abs(x), L(1e-300));
        expect("log", math::log(positive), [](double p, double) { return math::log(math::max(math::abs(p), 1e-300)); });
        expect("where", math::where(math::less(x, y), [&] { return x / y; }),
               [](double p, double q) { return p < q ? p / q : 0.0; });
        bool some = false;
        for (int i = 0; i < N; ++i) {
            some = some || a[i] < b[i];
        }
        compare(report, "any", any(math::less(x, y)) ? 1.0 : 0.0, some ? 1.0 : 0.0, 0);
        expect("constant", L(-0.0), [](double, double) { return -0.0; });
    }
    // A one-sided element acts where it exists and is pressed; for double its mode decides.
    for (const double depth : {-1e-9, 0.0, 1e-9}) {
        for (const double mode : {0.0, 1.0}) {
            compare(report, "acting, lanes", Rows<N>(math::acting(L(mode), L(depth))).value[N - 1],
                    depth > 0.0 ? mode : 0.0, N - 1);
            compare(report, "acting, double", math::acting(mode, depth), mode, 0);
        }
    }
}

// How far exp, tanh and the heading's sine and cosine of lanes are from libm's: relative errors, for arguments over
// their range and close to 0.
template <int N> void own_functions(Report report) {
    using L = math::Lanes<N>;
    constexpr double bound = 1e-11; // lanes_elementary.hpp: 3e-12, and tanh takes a difference of two of them
    constexpr int count = 199'999;  // odd: no argument is 0, of which tanh keeps no sign
    for (int i = 0; i <= count; ++i) {
        const double wide = -700.0 + 1400.0 * (static_cast<double>(i) / count);
        const double near = 0.06 * wide;
        compare_close(report, "exp", Rows<N>(math::exp(L(wide))).value[N - 1], std::exp(wide), bound);
        compare_close(report, "exp", Rows<N>(math::exp(L(near))).value[N - 1], std::exp(near), bound);
        compare_close(report, "tanh", Rows<N>(math::tanh(L(near))).value[N - 1], std::tanh(near), bound);
        compare(report, "tanh is odd", Rows<N>(math::tanh(L(-near))).value[N - 1],
                -Rows<N>(math::tanh(L(near))).value[N - 1], N - 1);
    }
    constexpr double heading_bound =
        5e-13; // lanes_elementary.hpp: 4e-13; of sine and cosine themselves, not relative, hence the 2
    for (int i = 0; i <= count; ++i) {
        const double turns = -700.0 + 1400.0 * (static_cast<double>(i) / count);
        for (const double angle : {turns, 0.003 * turns, 140.0 * turns}) {
            const auto found = math::heading(L(angle));
            compare_close(report, "sine of a heading", 2.0 + Rows<N>(found.sin).value[N - 1], 2.0 + std::sin(angle),
                          heading_bound);
            compare_close(report, "cosine of a heading", 2.0 + Rows<N>(found.cos).value[N - 1], 2.0 + std::cos(angle),
                          heading_bound);
        }
    }
    compare(report, "sine of 0", Rows<N>(math::heading(L(0.0)).sin).value[0], 0.0, 0);
    compare(report, "cosine of 0", Rows<N>(math::heading(L(0.0)).cos).value[0], 1.0, 0);
    compare(report, "exp(0)", Rows<N>(math::exp(L(0.0))).value[0], 1.0, 0);
    compare(report, "tanh(0)", Rows<N>(math::tanh(L(0.0))).value[0], 0.0, 0);
    compare(report, "tanh saturates", Rows<N>(math::tanh(L(20.0))).value[0], 1.0, 0);
    compare(report, "tanh saturates", Rows<N>(math::tanh(L(-1e300))).value[0], -1.0, 0);
}

// The noise of a design, independent of its lane and its neighbours.
template <int N> void noise_in_lanes(Report report) {
    std::int64_t seeds[N];
    for (unsigned index = 0; index < 1000U; ++index) {
        for (unsigned i = 0; i < N; ++i) {
            seeds[i] = (index * 2654435761U + i * 977U) & 0xFFFFFFFFU;
        }
        typename math::Lanes<N>::Bits key;
        std::memcpy(&key, seeds, sizeof key);
        const std::uint64_t tick = index % 5U == 0U ? (1ULL << 32U) + index : index;
        const Rows<N> found(math::normal<N>(key, index % 3U, tick));
        for (int i = 0; i < N; ++i) {
            compare(report, "noise", found.value[i],
                    math::normal(static_cast<std::uint32_t>(seeds[i]), index % 3U, tick), i);
        }
    }
}

// A design of the plant gives the same bits in Lanes<1> and in every lane among other designs.
template <int N> void plant_in_lanes(Report report) {
    using L = math::Lanes<N>;
    using One = math::Lanes<1>;
    for (unsigned seed = 0; seed < 300U; ++seed) {
        const auto design = plant::random_cases::random_case<double>(seed);
        auto p = plant::convert<L>(design.p);
        auto x = plant::detail::converted<L>(design.x);
        const auto rate = plant::rhs(x, plant::convert<L>(design.u), plant::convert<L>(design.m), p, plant::derive(p));
        const auto p1 = plant::convert<One>(design.p);
        const auto one = plant::rhs(plant::detail::converted<One>(design.x), plant::convert<One>(design.u),
                                    plant::convert<One>(design.m), p1, plant::derive(p1));
        for (std::size_t state = 0; state < rate.size(); ++state) {
            const Rows<N> found(rate[state]);
            for (int i = 0; i < N; ++i) {
                compare(report, "a rate of the plant", found.value[i], one[state].value, i);
            }
        }
    }
}

} // namespace giveway::lanes_checks
