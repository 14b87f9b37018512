// Dual numbers: values equal those of double bit for bit, derivatives equal closed forms and finite differences.
#include <cmath>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "dual.hpp"

namespace {

namespace math = giveway::math;
using Dual2 = math::Dual<2>;

bool same_bits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// f, a template over its argument, at the random points of [low, high], against its derivative in closed form.
// 4 ulp of the derivative's own terms: `scale` says how large those are.
template <class F, class Slope> void check_function(F f, Slope slope, double low, double high, double scale) {
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> draw(low, high);
    for (int i = 0; i < 20000; ++i) {
        const double x = draw(generator);
        const Dual2 a(x, {1.0, -2.5});
        const Dual2 y = f(a);
        ASSERT_TRUE(same_bits(y.value, f(x))) << x;
        const double exact = slope(x);
        const double tolerance = 1e-15 * std::max(scale, 4.0 * std::fabs(exact));
        ASSERT_NEAR(y.derivative[0], exact, tolerance) << x;
        ASSERT_NEAR(y.derivative[1], -2.5 * exact, 2.5 * tolerance) << x;
        // Central differences of a smooth function: step^2 f'''/6 and rounding/step, both below 1e-8 of the function's
        // size.
        const double step = 1e-5 * std::min(1.0, std::fabs(x) + 1e-3);
        const double difference = (f(x + step) - f(x - step)) / ((x + step) - (x - step));
        ASSERT_NEAR(y.derivative[0], difference, 1e-7 * (std::fabs(exact) + std::fabs(f(x)) + scale)) << x;
    }
}

} // namespace

TEST(Dual, FollowsTheRulesOfArithmetic) {
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> draw(-5.0, 5.0);
    for (int i = 0; i < 20000; ++i) {
        const Dual2 a(draw(generator), {draw(generator), draw(generator)});
        const Dual2 b(draw(generator), {draw(generator), draw(generator)});
        const Dual2 sum = a + b;
        const Dual2 difference = a - b;
        const Dual2 product = a * b;
        const Dual2 quotient = a / b;
        ASSERT_TRUE(same_bits(sum.value, a.value + b.value));
        ASSERT_TRUE(same_bits(difference.value, a.value - b.value));
        ASSERT_TRUE(same_bits(product.value, a.value * b.value));
        ASSERT_TRUE(same_bits(quotient.value, a.value / b.value));
        for (std::size_t k = 0; k < 2; ++k) {
            const double da = a.derivative[k];
            const double db = b.derivative[k];
            ASSERT_EQ(sum.derivative[k], da + db);
            ASSERT_EQ(difference.derivative[k], da - db);
            ASSERT_EQ(product.derivative[k], da * b.value + a.value * db);
            // Five roundings in either form.
            const double size = std::fabs(da / b.value) + std::fabs(a.value * db / (b.value * b.value));
            ASSERT_NEAR(quotient.derivative[k], (da * b.value - a.value * db) / (b.value * b.value), 1e-15 * size);
        }
    }
}

TEST(Dual, DifferentiatesTheElementaryFunctions) {
    check_function([](auto x) { return math::exp(x); }, [](double x) { return std::exp(x); }, -20.0, 3.0, 0.0);
    check_function([](auto x) { return math::expm1(x); }, [](double x) { return std::exp(x); }, -3.0, 3.0, 1.0);
    check_function([](auto x) { return math::tanh(x); }, [](double x) { return 1.0 / (std::cosh(x) * std::cosh(x)); },
                   -25.0, 25.0, 1.0);
    check_function([](auto x) { return math::sincos(x).sin; }, [](double x) { return std::cos(x); }, -30.0, 30.0, 1.0);
    check_function([](auto x) { return math::sincos(x).cos; }, [](double x) { return -std::sin(x); }, -30.0, 30.0, 1.0);
    check_function([](auto x) { return math::sqrt(x); }, [](double x) { return 0.5 / std::sqrt(x); }, 0.01, 9.0, 0.0);
    check_function([](auto x) { return math::square(x); }, [](double x) { return 2.0 * x; }, -9.0, 9.0, 0.0);
    check_function([](auto x) { return math::abs(x); }, [](double x) { return x < 0.0 ? -1.0 : 1.0; }, -9.0, 9.0, 0.0);
}

TEST(Dual, TakesTheDerivativeOfTheChosenSide) {
    const Dual2 low(1.0, {10.0, 0.0});
    const Dual2 high(2.0, {0.0, 20.0});
    EXPECT_TRUE(math::less(low, high));
    EXPECT_FALSE(math::less(high, low));
    EXPECT_EQ(math::min(low, high).derivative[0], 10.0);
    EXPECT_EQ(math::min(high, low).derivative[0], 10.0);
    EXPECT_EQ(math::max(low, high).derivative[1], 20.0);
    EXPECT_EQ(math::max(high, low).derivative[1], 20.0);
    EXPECT_EQ(math::select(math::less(low, high), low, high).derivative[0], 10.0);
    EXPECT_EQ(math::select(math::less(high, low), low, high).derivative[1], 20.0);
    const auto clamped = [](double x) { return math::clamp(Dual2::variable(x, 0), Dual2(-1.0), Dual2(1.0)); };
    EXPECT_EQ(clamped(0.5).derivative[0], 1.0);
    EXPECT_EQ(clamped(1.5).derivative[0], 0.0);
    EXPECT_EQ(clamped(-1.5).derivative[0], 0.0);
    EXPECT_EQ(math::sign(Dual2(-3.0, {1.0, 1.0})).value, -1.0);
    EXPECT_EQ(math::sign(Dual2(-3.0, {1.0, 1.0})).derivative[0], 0.0);
    const Dual2 rounded = math::round(Dual2(2.7, {1.0, 1.0}));
    EXPECT_EQ(rounded.value, 3.0);
    EXPECT_EQ(rounded.derivative[0], 0.0);
}

TEST(Dual, StaysFiniteWhereADerivativeIsNot) {
    // The length of a vector that vanishes, times something.
    const Dual2 x = Dual2::variable(0.0, 0);
    const Dual2 y = Dual2::variable(0.0, 1);
    const Dual2 length = math::sqrt(x * x + y * y) * x;
    EXPECT_EQ(length.value, 0.0);
    EXPECT_EQ(length.derivative[0], 0.0);
    EXPECT_EQ(math::sqrt(x).derivative[0], 0.0);
    // Where exp stops growing, so does its derivative.
    EXPECT_EQ(math::exp(Dual2::variable(1e6, 0)).derivative[0], 0.0);
    EXPECT_EQ(math::expm1(Dual2::variable(-1e6, 0)).derivative[0], 0.0);
    EXPECT_EQ(math::tanh(Dual2::variable(1e6, 0)).derivative[0], 0.0);
}
