#include <bit>
#include <cstring>

#include "support.hpp"

namespace {

// Error in units in the last place of the true value, floored at those of `smallest`.
double ulp_error(Real actual, long double truth, long double smallest = std::numeric_limits<Real>::min()) {
    const long double size = std::max(std::fabs(truth), smallest);
    const long double ulp = std::ldexp(1.0L, std::ilogb(size)) * static_cast<long double>(epsilon);
    return static_cast<double>(std::fabs(static_cast<long double>(actual) - truth) / ulp);
}

template <class Function> void sweep(double low, double high, int count, Function check) {
    for (int i = 0; i <= count; ++i) {
        check(real(low + (high - low) * i / count));
    }
}

TEST(Math, SquareRootIsCorrectlyRounded) {
    if constexpr (is_double) {
        Random random(1);
        for (int i = 0; i < 4'000'000; ++i) {
            const double x = std::bit_cast<double>(random.bits() & 0x7FFF'FFFF'FFFF'FFFFU);
            if (std::isfinite(x)) {
                ASSERT_EQ(static_cast<double>(gw_sqrt(real(x))), std::sqrt(x)) << x;
            }
        }
    } else {
        // Every float in [1, 4); other normal numbers are the same up to an exact power of 4.
        for (std::uint32_t bits = 0x3F80'0000U; bits < 0x4080'0000U; ++bits) {
            const float x = std::bit_cast<float>(bits);
            ASSERT_EQ(static_cast<float>(gw_sqrt(real(x))), std::sqrt(x)) << x;
        }
        for (std::uint32_t bits = 0; bits < 0x7F80'0000U; bits += 997U) {
            const float x = std::bit_cast<float>(bits);
            ASSERT_EQ(static_cast<float>(gw_sqrt(real(x))), std::sqrt(x)) << x;
        }
    }
    const Real smallest = std::numeric_limits<Real>::denorm_min();
    EXPECT_EQ(gw_sqrt(smallest), std::sqrt(smallest));
    EXPECT_EQ(gw_sqrt(GW_REAL_MAX), std::sqrt(GW_REAL_MAX));
    EXPECT_EQ(gw_sqrt(infinite), std::sqrt(GW_REAL_MAX));
    EXPECT_EQ(gw_sqrt(real(0)), real(0));
    EXPECT_EQ(gw_sqrt(real(-1)), real(0));
    EXPECT_EQ(gw_sqrt(not_a_number), real(0));
}

// A few roundings each: 4 ulp leaves no room for a wrong coefficient.
constexpr double few_ulp = 4.0;

TEST(Math, ExpAndExpm1) {
    const double low = is_double ? -707.0 : -87.0;
    const double high = is_double ? 709.0 : 88.0;
    sweep(low, high, 1'000'000, [](Real x) {
        ASSERT_LE(ulp_error(gw_exp(x), std::exp(static_cast<long double>(x))), few_ulp) << x;
    });
    sweep(-2.0, 2.0, 1'000'000, [](Real x) {
        ASSERT_LE(ulp_error(gw_exp(x), std::exp(static_cast<long double>(x))), few_ulp) << x;
        ASSERT_LE(ulp_error(gw_expm1(x), std::expm1(static_cast<long double>(x))), few_ulp) << x;
    });
    sweep(-50.0, high, 1'000'000, [](Real x) {
        ASSERT_LE(ulp_error(gw_expm1(x), std::expm1(static_cast<long double>(x))), few_ulp) << x;
    });
    EXPECT_EQ(gw_exp(real(0)), real(1));
    EXPECT_EQ(gw_exp(real(-1e5)), real(0));
    EXPECT_EQ(gw_exp(-infinite), real(0));
    EXPECT_EQ(gw_exp(real(1e5)), GW_REAL_MAX);
    EXPECT_EQ(gw_exp(infinite), GW_REAL_MAX);
    EXPECT_EQ(gw_exp(not_a_number), real(0));
    EXPECT_EQ(gw_expm1(real(-1e5)), real(-1));
    EXPECT_EQ(gw_expm1(-infinite), real(-1));
    EXPECT_EQ(gw_expm1(infinite), GW_REAL_MAX);
    EXPECT_EQ(gw_expm1(not_a_number), real(0));
}

TEST(Math, Tanh) {
    for (const double range : {1e-3, 0.5, 3.0, 25.0}) {
        sweep(-range, range, 1'000'000, [](Real x) {
            ASSERT_LE(ulp_error(gw_tanh(x), std::tanh(static_cast<long double>(x))), few_ulp) << x;
            ASSERT_LE(gw_abs(gw_tanh(x)), real(1)) << x;
            ASSERT_EQ(gw_tanh(-x), -gw_tanh(x)) << x;
        });
    }
    EXPECT_EQ(gw_tanh(real(1e6)), real(1));
    EXPECT_EQ(gw_tanh(-infinite), real(-1));
    EXPECT_EQ(gw_tanh(infinite), real(1));
    EXPECT_EQ(gw_tanh(not_a_number), real(0));
}

TEST(Math, SineAndCosine) {
    // Absolute, because the reduction's rounding is absolute: 1.5 ulp of 1.
    const auto check = [](Real x) {
        const gw_rotation_t r = gw_sincos(x);
        ASSERT_LE(std::fabs(r.sine - std::sin(static_cast<long double>(x))), 1.5L * epsilon) << x;
        ASSERT_LE(std::fabs(r.cosine - std::cos(static_cast<long double>(x))), 1.5L * epsilon) << x;
    };
    sweep(-7.0, 7.0, 1'000'000, check);
    sweep(-1e4, 1e4, 1'000'000, check);
    // Small angles keep their relative accuracy.
    sweep(1e-6, 0.7, 100'000, [](Real x) {
        ASSERT_LE(ulp_error(gw_sincos(x).sine, std::sin(static_cast<long double>(x))), few_ulp) << x;
    });
    for (const Real bad : {real(1.1e4), -infinite, infinite, not_a_number}) {
        EXPECT_EQ(gw_sincos(bad).sine, real(0));
        EXPECT_EQ(gw_sincos(bad).cosine, real(1));
    }
}

TEST(Math, Atan2) {
    Random random(2);
    for (int i = 0; i < 2'000'000; ++i) {
        const double scale = std::exp(random.uniform(-20.0, 20.0));
        const Real y = real(random.uniform(-1.0, 1.0));
        const Real x = real(random.uniform(-1.0, 1.0) * scale);
        const long double truth = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
        // Near +-pi and +-pi/2 the rounding of the constant adds half an ulp.
        ASSERT_LE(ulp_error(gw_atan2(y, x), truth, std::numeric_limits<Real>::min()), few_ulp) << y << " " << x;
    }
    EXPECT_EQ(gw_atan2(real(0), real(0)), real(0));
    EXPECT_EQ(gw_atan2(real(0), real(-1)), GW_PI);
    EXPECT_EQ(gw_atan2(real(1), infinite), real(0));
    EXPECT_EQ(gw_atan2(not_a_number, real(1)), real(0));
    EXPECT_EQ(gw_atan2(real(1), not_a_number), real(0));
}

TEST(Math, WrapAngle) {
    const long double turn = 2.0L * std::numbers::pi_v<long double>;
    const auto check = [turn](Real x) {
        const Real wrapped = gw_wrap_angle(x);
        ASSERT_GE(wrapped, -GW_PI) << x;
        ASSERT_LT(wrapped, GW_PI) << x;
        const long double turns = (static_cast<long double>(x) - wrapped) / turn;
        // Two roundings at the size of pi.
        ASSERT_LE(std::fabs(turns - std::round(turns)) * turn, 4.0L * epsilon) << x;
    };
    sweep(-1e4, 1e4, 2'000'000, check);
    for (int k = -1000; k <= 1000; ++k) {
        const Real edge = real(k * pi);
        for (const Real x : {edge, std::nextafter(edge, infinite), std::nextafter(edge, -infinite)}) {
            check(x);
        }
    }
    for (const Real bad : {real(1.1e4), -infinite, not_a_number}) {
        EXPECT_EQ(gw_wrap_angle(bad), real(0));
    }
}

TEST(Math, SelectionAndRanges) {
    EXPECT_TRUE(gw_is_finite(GW_REAL_MAX));
    EXPECT_TRUE(gw_is_finite(-GW_REAL_MAX));
    EXPECT_FALSE(gw_is_finite(infinite));
    EXPECT_FALSE(gw_is_finite(-infinite));
    EXPECT_FALSE(gw_is_finite(not_a_number));
    EXPECT_TRUE(gw_in_range(real(1), real(1), real(2)));
    EXPECT_TRUE(gw_in_range(real(2), real(1), real(2)));
    EXPECT_FALSE(gw_in_range(std::nextafter(real(2), infinite), real(1), real(2)));
    EXPECT_FALSE(gw_in_range(not_a_number, real(1), real(2)));
    EXPECT_EQ(gw_abs(real(-3)), real(3));
    EXPECT_EQ(gw_min(real(1), real(2)), real(1));
    EXPECT_EQ(gw_max(real(1), real(2)), real(2));
    EXPECT_EQ(gw_min(not_a_number, real(2)), real(2));
    EXPECT_EQ(gw_clamp(not_a_number, real(-1), real(1)), real(-1));
    EXPECT_EQ(gw_clamp(infinite, real(-1), real(1)), real(1));
}

TEST(Math, CountDifferenceWraps) {
    EXPECT_EQ(gw_count_difference(5, 3), 2);
    EXPECT_EQ(gw_count_difference(3, 5), -2);
    EXPECT_EQ(gw_count_difference(INT32_MIN, INT32_MAX), 1);
    EXPECT_EQ(gw_count_difference(INT32_MAX, INT32_MIN), -1);
    EXPECT_EQ(gw_count_difference(INT32_MIN, 0), INT32_MIN);
    Random random(3);
    for (int i = 0; i < 100'000; ++i) {
        const auto a = static_cast<std::int32_t>(random.bits());
        const auto step = static_cast<std::int32_t>(random.integer(-1'000'000'000, 1'000'000'000));
        const auto b = static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(step));
        ASSERT_EQ(gw_count_difference(b, a), step);
    }
}

TEST(Math, Vectors) {
    Random random(4);
    for (int i = 0; i < 10'000; ++i) {
        const gw_vector_t v = {real(random.uniform(-9.0, 9.0)), real(random.uniform(-9.0, 9.0))};
        const gw_rotation_t r = gw_sincos(real(random.uniform(-3.0, 3.0)));
        const gw_vector_t back = gw_rotate_back(r, gw_rotate(r, v));
        ASSERT_NEAR(back.x, v.x, 10.0 * tolerance);
        ASSERT_NEAR(back.y, v.y, 10.0 * tolerance);
        const Real limit = real(random.uniform(0.0, 12.0));
        const gw_vector_t limited = gw_limit_length(v, limit);
        ASSERT_NEAR(std::hypot(limited.x, limited.y), std::min<double>(limit, std::hypot(v.x, v.y)), 10.0 * tolerance);
        ASSERT_NEAR(limited.x * v.y, limited.y * v.x, 100.0 * tolerance);
    }
}

TEST(Math, BrakingSpeedStopsAtTheGoal) {
    EXPECT_EQ(gw_braking_speed(real(2), real(0.001), real(0)), real(0));
    EXPECT_EQ(gw_braking_speed(real(2), real(0.001), real(-1)), real(0));
    for (const double start : {1.0, 0.1, 1e-3}) {
        double left = start;
        double speed = 0.0;
        for (int i = 0; i < 5000; ++i) {
            const double next = std::min(static_cast<double>(gw_braking_speed(real(2), real(0.001),
                                                                               real(left - 0.5e-3 * speed))),
                                         speed + 2e-3);
            ASSERT_GE(next, speed - 2e-3 * (1.0 + 1e-3) - 4.0 * epsilon) << i;
            left -= 0.5e-3 * (speed + next);
            speed = next;
            // The last tick is whole although the stop may need a part of it: at most a T^2/8 too far.
            ASSERT_GE(left, -2.0 * 1e-6 / 8.0 - 10.0 * epsilon * start) << i;
        }
        EXPECT_NEAR(left, 0.0, 1e-6);
    }
}

} // namespace
