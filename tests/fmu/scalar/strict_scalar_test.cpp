// The plant compiles for a scalar that has no comparison operators and no conversion to bool, so no branch on T can
// hide in it, and gives the same bits as with double: lanes and derivatives rely on this.
#include <cstring>

#include <gtest/gtest.h>

#include "elementary.hpp"

namespace giveway::math {

struct StrictMask {
    bool value;
};

struct Strict {
    double value;
    Strict() : value(0.0) {}
    explicit Strict(double v) : value(v) {}
    friend Strict operator+(Strict a, Strict b) { return Strict(a.value + b.value); }
    friend Strict operator-(Strict a, Strict b) { return Strict(a.value - b.value); }
    friend Strict operator*(Strict a, Strict b) { return Strict(a.value * b.value); }
    friend Strict operator/(Strict a, Strict b) { return Strict(a.value / b.value); }
};

inline StrictMask less(Strict a, Strict b) { return {a.value < b.value}; }
inline Strict select(StrictMask m, Strict a, Strict b) { return m.value ? a : b; }
inline Strict min(Strict a, Strict b) { return Strict(min(a.value, b.value)); }
inline Strict max(Strict a, Strict b) { return Strict(max(a.value, b.value)); }
inline Strict abs(Strict a) { return Strict(abs(a.value)); }
inline Strict sqrt(Strict a) { return Strict(sqrt(a.value)); }
inline Strict round(Strict a) { return Strict(round(a.value)); }
inline Strict exp2_integer(Strict a) { return Strict(exp2_integer(a.value)); }
inline Split<Strict> split(Strict a) {
    const auto parts = split(a.value);
    return {Strict(parts.exponent), Strict(parts.mantissa)};
}

} // namespace giveway::math

#include "random_cases.hpp"

namespace {

using giveway::math::Strict;
using namespace giveway::plant;
using giveway::plant::random_cases::random_case;
using giveway::plant::random_cases::random_tipping_case;

template <std::size_t N>
void expect_same_bits(const std::array<double, N> &a, const std::array<Strict, N> &b, unsigned seed) {
    static_assert(sizeof(Strict) == sizeof(double));
    EXPECT_EQ(std::memcmp(a.data(), b.data(), sizeof a), 0) << "case " << seed;
}

} // namespace

TEST(StrictScalar, GivesTheBitsOfDouble) {
    for (unsigned seed = 0; seed < 2000U; ++seed) {
        auto a = random_case<double>(seed);
        auto b = random_case<Strict>(seed);
        expect_same_bits(rhs(a.x, a.u, a.m, a.p, a.d), rhs(b.x, b.u, b.m, b.p, b.d), seed);
        expect_same_bits(event_indicators(a.x, a.u, a.m, a.p, a.d), event_indicators(b.x, b.u, b.m, b.p, b.d), seed);
        const auto outputs_a = outputs(a.x, a.u, a.m, a.p, a.d);
        const auto outputs_b = outputs(b.x, b.u, b.m, b.p, b.d);
        EXPECT_EQ(std::memcmp(&outputs_a, &outputs_b, sizeof outputs_a), 0) << "case " << seed;
        transition(a.x, a.u, a.m, a.fired, a.p, a.d);
        transition(b.x, b.u, b.m, b.fired, b.p, b.d);
        expect_same_bits(a.x, b.x, seed);
        EXPECT_EQ(std::memcmp(&a.m, &b.m, sizeof a.m), 0) << "case " << seed;
        initial_state<double>({0.1, 0.2, 0.3, 0.1, -0.2, 0.4, 0.5}, a.u, a.p, a.d, a.x, a.m);
        initial_state<Strict>(
            {Strict(0.1), Strict(0.2), Strict(0.3), Strict(0.1), Strict(-0.2), Strict(0.4), Strict(0.5)}, b.u, b.p, b.d,
            b.x, b.m);
        expect_same_bits(a.x, b.x, seed);
    }
}

TEST(StrictScalar, GivesTheBitsOfDoubleWhereTheBaseTips) {
    for (unsigned seed = 0; seed < 2000U; ++seed) {
        auto [a, xa, fired_a] = random_tipping_case<double>(seed);
        auto [b, xb, fired_b] = random_tipping_case<Strict>(seed);
        expect_same_bits(rhs(xa, a.u, a.m, a.p, a.d), rhs(xb, b.u, b.m, b.p, b.d), seed);
        expect_same_bits(event_indicators(xa, a.u, a.m, a.p, a.d), event_indicators(xb, b.u, b.m, b.p, b.d), seed);
        const auto outputs_a = outputs(xa, a.u, a.m, a.p, a.d);
        const auto outputs_b = outputs(xb, b.u, b.m, b.p, b.d);
        EXPECT_EQ(std::memcmp(&outputs_a, &outputs_b, sizeof outputs_a), 0) << "case " << seed;
        transition(xa, a.u, a.m, fired_a, a.p, a.d);
        transition(xb, b.u, b.m, fired_b, b.p, b.d);
        expect_same_bits(xa, xb, seed);
        EXPECT_EQ(std::memcmp(&a.m, &b.m, sizeof a.m), 0) << "case " << seed;
        initial_state<double>({0.1, 0.2, 0.3, 0.1, -0.2, 0.4, 0.5}, a.u, a.p, a.d, xa, a.m);
        initial_state<Strict>(
            {Strict(0.1), Strict(0.2), Strict(0.3), Strict(0.1), Strict(-0.2), Strict(0.4), Strict(0.5)}, b.u, b.p, b.d,
            xb, b.m);
        expect_same_bits(xa, xb, seed);
        accept_inputs(xa, a.u, a.m, a.p, a.d);
        accept_inputs(xb, b.u, b.m, b.p, b.d);
        EXPECT_EQ(std::memcmp(&a.m, &b.m, sizeof a.m), 0) << "case " << seed;
    }
}
