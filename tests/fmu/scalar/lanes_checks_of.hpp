// Lanes<N> against double: every operation that the plant uses, in every lane, bit for bit; and the plant itself.
// Included by one file per width.
#pragma once

#include <cstring>

#include "convert.hpp"
#include "elementary.hpp"
#include "lanes_checks.hpp"
#include "random_cases.hpp"

namespace giveway::lanes_checks {

template <int N> struct Rows {
    double value[N];
    explicit Rows(math::Lanes<N> lanes) { lanes.store(value); }
};

// Numbers of every kind: signs, zeros, small, large, whole.
inline double number(unsigned index) {
    const double kinds[] = {0.0, -0.0, 1.0, -1.0, 0.5, -2.5, 3.0, 1e-9, -1e-300, 1e5, -7.0e4, 709.0, -708.5, 1e-310, 20.0, -0.3465};
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
        const auto expect = [&](const char* name, L lanes, auto scalar) {
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
        expect("exp", math::exp(x), [](double p, double) { return math::exp(p); });
        expect("expm1", math::expm1(x), [](double p, double) { return math::expm1(p); });
        expect("tanh", math::tanh(x), [](double p, double) { return math::tanh(p); });
        expect("sin", math::sincos(x).sin, [](double p, double) { return math::sincos(p).sin; });
        expect("cos", math::sincos(x).cos, [](double p, double) { return math::sincos(p).cos; });
        expect("constant", L(-0.0), [](double, double) { return -0.0; });
    }
    // A one-sided element acts where it exists and is pressed; for double its mode decides.
    for (const double depth : {-1e-9, 0.0, 1e-9}) {
        for (const double mode : {0.0, 1.0}) {
            compare(report, "acting, lanes", Rows<N>(math::acting(L(mode), L(depth))).value[N - 1], depth > 0.0 ? mode : 0.0, N - 1);
            compare(report, "acting, double", math::acting(mode, depth), mode, 0);
        }
    }
}

// A design of the plant gives the same bits in Lanes<1> and, with others beside it, in every lane.
template <int N> void plant_in_lanes(Report report) {
    using L = math::Lanes<N>;
    using One = math::Lanes<1>;
    for (unsigned seed = 0; seed < 300U; ++seed) {
        const auto design = plant::random_cases::random_case<double>(seed);
        auto p = plant::convert<L>(design.p);
        auto x = plant::detail::converted<L>(design.x);
        const auto rate = plant::rhs(x, plant::convert<L>(design.u), plant::convert<L>(design.m), p, plant::derive(p));
        const auto p1 = plant::convert<One>(design.p);
        const auto one = plant::rhs(plant::detail::converted<One>(design.x), plant::convert<One>(design.u), plant::convert<One>(design.m), p1,
                                    plant::derive(p1));
        for (std::size_t state = 0; state < rate.size(); ++state) {
            const Rows<N> found(rate[state]);
            for (int i = 0; i < N; ++i) {
                compare(report, "a rate of the plant", found.value[i], one[state].value, i);
            }
        }
    }
}

} // namespace giveway::lanes_checks
