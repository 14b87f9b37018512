// The libm-free functions against long double libm, and the noise against its published answers and its moments.
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "noise.hpp"

namespace gm = giveway::math;

namespace {

constexpr double ulp = 2.220446049250313e-16;

// Dense and irregular: the step is not a dyadic number, so arguments have full mantissas.
template <class Check> void sweep(double low, double high, Check check) {
    constexpr int count = 400'000;
    for (int i = 0; i <= count; ++i) {
        check(low + (high - low) * (static_cast<double>(i) / count));
    }
}

double relative(double value, long double reference) {
    return reference == 0.0L
               ? std::fabs(value)
               : static_cast<double>(std::fabs((static_cast<long double>(value) - reference) / reference));
}

} // namespace

// Each bound is a few roundings: reduction, polynomial, scaling.
TEST(Elementary, ExpIsWithinTwoUlp) {
    double worst = 0.0;
    sweep(-700.0, 700.0,
          [&](double a) { worst = std::fmax(worst, relative(gm::exp(a), std::exp(static_cast<long double>(a)))); });
    EXPECT_LT(worst, 2.0 * ulp);
}

TEST(Elementary, Expm1KeepsRelativeAccuracyNearZero) {
    double worst = 0.0;
    sweep(-30.0, 30.0, [&](double a) {
        worst = std::fmax(worst, relative(gm::expm1(a), std::expm1(static_cast<long double>(a))));
        worst = std::fmax(worst, relative(gm::expm1(a * 1e-9), std::expm1(static_cast<long double>(a * 1e-9))));
    });
    EXPECT_LT(worst, 4.0 * ulp);
}

TEST(Elementary, TanhIsOddAccurateAndSaturates) {
    double worst = 0.0;
    sweep(-25.0, 25.0, [&](double a) {
        worst = std::fmax(worst, relative(gm::tanh(a), std::tanh(static_cast<long double>(a))));
        EXPECT_EQ(gm::tanh(-a), -gm::tanh(a));
    });
    EXPECT_LT(worst, 4.0 * ulp);
    EXPECT_EQ(gm::tanh(1e300), 1.0);
    EXPECT_EQ(gm::tanh(-1e300), -1.0);
}

TEST(Elementary, SinCosHoldOverManyTurns) {
    double worst = 0.0;
    const auto check = [&](double a) {
        const auto value = gm::sincos(a);
        worst = std::fmax(worst, static_cast<double>(std::fabs(value.sin - std::sin(static_cast<long double>(a)))));
        worst = std::fmax(worst, static_cast<double>(std::fabs(value.cos - std::cos(static_cast<long double>(a)))));
    };
    sweep(-7.0, 7.0, check);
    sweep(-1e5, 1e5, check);
    EXPECT_LT(worst, 2.0 * ulp); // absolute: both are at most 1
}

TEST(Elementary, LogIsAccurate) {
    double worst = 0.0;
    sweep(1e-10, 4.0, [&](double a) {
        worst = std::fmax(worst, std::fabs(gm::log(a) - static_cast<double>(std::log(static_cast<long double>(a)))));
    });
    EXPECT_LT(worst, 32.0 * ulp); // absolute; |log| reaches 23 here
}

TEST(Noise, PhiloxGivesItsPublishedAnswers) {
    const auto zero = gm::philox4x32({0, 0, 0, 0}, {0, 0});
    EXPECT_EQ(zero, (std::array<std::uint32_t, 4>{0x6627e8d5U, 0xe169c58dU, 0xbc57ac4cU, 0x9b00dbd8U}));
    const auto ones = gm::philox4x32({~0U, ~0U, ~0U, ~0U}, {~0U, ~0U});
    EXPECT_EQ(ones, (std::array<std::uint32_t, 4>{0x408f276dU, 0x41c83b0eU, 0xa20bc7c6U, 0x6d5451fdU}));
}

TEST(Noise, NormalDeviatesHaveTheRightMoments) {
    constexpr int count = 400'000;
    double sum = 0.0;
    double square = 0.0;
    double fourth = 0.0;
    double neighbour = 0.0;
    double before = 0.0;
    for (int i = 0; i < count; ++i) {
        const double z = gm::normal(5U, 2U, static_cast<std::uint64_t>(i));
        sum += z;
        square += z * z;
        fourth += z * z * z * z;
        neighbour += z * before;
        before = z;
    }
    // Five standard errors of each moment: 1, sqrt(2), sqrt(96) and 1 over sqrt(count).
    const double error = 5.0 / std::sqrt(static_cast<double>(count));
    EXPECT_NEAR(sum / count, 0.0, error);
    EXPECT_NEAR(square / count, 1.0, std::sqrt(2.0) * error);
    EXPECT_NEAR(fourth / count, 3.0, std::sqrt(96.0) * error);
    EXPECT_NEAR(neighbour / count, 0.0, error);
}

TEST(Noise, BelongsToSeedChannelAndTick) {
    EXPECT_EQ(gm::normal(1U, 0U, 77U), gm::normal(1U, 0U, 77U));
    EXPECT_NE(gm::normal(1U, 0U, 77U), gm::normal(2U, 0U, 77U));
    EXPECT_NE(gm::normal(1U, 0U, 77U), gm::normal(1U, 1U, 77U));
    EXPECT_NE(gm::normal(1U, 0U, 77U), gm::normal(1U, 0U, 78U));
    EXPECT_NE(gm::normal(1U, 0U, 77U), gm::normal(1U, 0U, 77U + (1ULL << 32U)));
}
