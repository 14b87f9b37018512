// The angle of a vector against the C library's, in long double and in double.
#include "arctangent.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

using giveway::math::angle_of;

namespace {

// Far from 0 by what `size` says, as a power of two.
double random_number(std::mt19937_64 &random, int size) {
    std::uniform_real_distribution<double> fraction(-1.0, 1.0);
    std::uniform_int_distribution<int> exponent(-size, size);
    return std::ldexp(fraction(random), exponent(random));
}

TEST(Angle, IsTheRoundedOneInEveryQuarter) {
    std::mt19937_64 random(20161);
    for (int i = 0; i < 300000; ++i) {
        const double y = random_number(random, i % 40);
        const double x = random_number(random, i % 40);
        const long double exact = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
        const double found = angle_of(y, x);
        // Half a unit of the last place, and what the long double may be off itself: 2^-11 of it.
        const double unit = std::nextafter(std::fabs(found), 10.0) - std::fabs(found);
        ASSERT_LE(std::fabs(static_cast<double>(found - exact)), 0.501 * unit) << y << " " << x;
    }
}

TEST(Angle, IsHardlyEverAnotherThanThatOfTheCLibrary) {
    std::mt19937_64 random(40325);
    int others = 0;
    for (int i = 0; i < 300000; ++i) {
        const double y = random_number(random, 6);
        const double x = random_number(random, 6);
        others += angle_of(y, x) == std::atan2(y, x) ? 0 : 1;
    }
    EXPECT_LT(others, 600); // glibc 2.36 rounds 7 of 10,000 the other way
}

TEST(Angle, OfZerosAndExtremeNumbersIsThatOfTheCLibrary) {
    const double tiny = std::numeric_limits<double>::denorm_min();
    const double huge = std::numeric_limits<double>::max();
    for (const double y : {0.0, -0.0, 1.0, -1.0, tiny, -tiny, huge, -huge, 1e-310, 1e-200, 1e200}) {
        for (const double x : {0.0, -0.0, 1.0, -1.0, tiny, -tiny, huge, -huge, 1e-310, 1e-200, 1e200}) {
            const double found = angle_of(y, x);
            EXPECT_EQ(found, std::atan2(y, x)) << y << " " << x;
            EXPECT_EQ(std::signbit(found), std::signbit(y)) << y << " " << x;
        }
    }
}

TEST(Angle, OfWhatIsNotFiniteIsNone) {
    const double infinite = std::numeric_limits<double>::infinity();
    const double none = std::numeric_limits<double>::quiet_NaN();
    for (const double number : {infinite, -infinite, none}) {
        EXPECT_TRUE(std::isnan(angle_of(number, 1.0)));
        EXPECT_TRUE(std::isnan(angle_of(1.0, number)));
    }
}

} // namespace
