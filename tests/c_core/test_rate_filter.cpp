#include "support.hpp"

namespace {

gw_rate_filter_constants_t constants(double period, double cutoff, std::uint32_t counts, double stiffness) {
    gw_rate_filter_constants_t c{};
    EXPECT_EQ(gw_rate_filter_constants(&c, real(period), real(cutoff), counts, real(stiffness)), GW_STATUS_OK);
    return c;
}

// y'' = w^2 (u - y) - 2 w y' by classical Runge-Kutta in small steps, u held over each sample.
TEST(RateFilter, StepIsThatOfTheDifferentialEquation) {
    Random random(51);
    const double period = 0.001;
    const double cutoff = 200.0;
    const auto c = constants(period, cutoff, 100'000, 0.0);
    gw_rate_filter_t filter{};
    gw_rate_filter_restart(&filter);
    Eigen::Vector2d state = Eigen::Vector2d::Zero();
    std::int32_t count = 12345;
    gw_rate_filter_step(&filter, &c, count, real(0));
    for (int i = 0; i < 500; ++i) {
        const int moved = random.integer(-300, 300);
        count += moved;
        gw_rate_filter_step(&filter, &c, count, real(0));
        const double input = moved * 2.0 * pi / 100'000 / period;
        const auto slope = [&](const Eigen::Vector2d &y) {
            return Eigen::Vector2d(y(1), cutoff * cutoff * (input - y(0)) - 2.0 * cutoff * y(1));
        };
        constexpr int parts = 40;
        for (int k = 0; k < parts; ++k) {
            const double h = period / parts;
            const Eigen::Vector2d k1 = slope(state);
            const Eigen::Vector2d k2 = slope(state + h / 2 * k1);
            const Eigen::Vector2d k3 = slope(state + h / 2 * k2);
            const Eigen::Vector2d k4 = slope(state + h * k3);
            state += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
        }
        // Rates up to 19 rad/s, derivatives up to w times that; Runge-Kutta itself is good to 1e-11 here.
        ASSERT_NEAR(filter.rate_radps, state(0), is_double ? 1e-9 : 1e-4);
        ASSERT_NEAR(filter.derivative_radps2, state(1), is_double ? 1e-7 : 0.02);
    }
    EXPECT_TRUE(gw_rate_filter_invariant_holds(&filter));
}

TEST(RateFilter, ConstantAccelerationIsMeasured) {
    const double period = 0.001;
    const auto c = constants(period, 200.0, 1'000'000, 0.0);
    gw_rate_filter_t filter{};
    gw_rate_filter_restart(&filter);
    for (int i = 0; i < 2000; ++i) {
        const double t = i * period;
        gw_rate_filter_step(&filter, &c, static_cast<std::int32_t>(std::lround(0.5 * 30.0 * t * t * 1e6 / (2.0 * pi))),
                            real(0));
    }
    // One count per tick is 0.0063 rad/s; through two poles at 200 rad/s its jitter leaves 0.3 rad/s^2.
    EXPECT_NEAR(filter.derivative_radps2, 30.0, 0.5);
    // The rate lags by 2/w = 10 ms, and half a tick.
    EXPECT_NEAR(filter.rate_radps, 30.0 * (1.999 - 0.0105), 0.02);
}

TEST(RateFilter, DrivetrainTwistIsTakenOff) {
    // The motor turns while the wheel stands: all of it is twist.
    const double stiffness = 668.0;
    const auto c = constants(0.001, 100.0, 1'000'000, stiffness);
    gw_rate_filter_t filter{};
    gw_rate_filter_restart(&filter);
    for (int i = 0; i < 500; ++i) {
        const double torque = 5.0 * std::sin(0.02 * i);
        const auto count = static_cast<std::int32_t>(std::lround(torque / stiffness * 1e6 / (2.0 * pi)));
        gw_rate_filter_step(&filter, &c, count, real(torque));
        // Half a count of quantisation per tick, low-passed; the twist itself would be 0.15 rad/s.
        ASSERT_NEAR(filter.rate_radps, 0.0, 2e-3);
    }
}

TEST(RateFilter, CountsMayWrap) {
    const auto c = constants(0.001, 200.0, 8500, 668.0);
    gw_rate_filter_t plain{};
    gw_rate_filter_t wrapping{};
    gw_rate_filter_restart(&plain);
    gw_rate_filter_restart(&wrapping);
    for (int i = 0; i < 1000; ++i) {
        const std::uint32_t moved = static_cast<std::uint32_t>(7 * i);
        gw_rate_filter_step(&plain, &c, static_cast<std::int32_t>(moved), real(0.1));
        gw_rate_filter_step(&wrapping, &c, static_cast<std::int32_t>(0x7FFF'FC00U + moved), real(0.1));
        ASSERT_EQ(plain.rate_radps, wrapping.rate_radps);
        ASSERT_EQ(plain.derivative_radps2, wrapping.derivative_radps2);
    }
}

TEST(RateFilter, Refusals) {
    gw_rate_filter_constants_t c{};
    EXPECT_EQ(gw_rate_filter_constants(nullptr, real(0.001), real(1), 8500, real(0)), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_rate_filter_constants(&c, real(0), real(1), 8500, real(0)), GW_STATUS_CONFIG_INVALID);
    EXPECT_EQ(gw_rate_filter_constants(&c, real(0.001), not_a_number, 8500, real(0)), GW_STATUS_CONFIG_INVALID);
    EXPECT_EQ(gw_rate_filter_constants(&c, real(0.001), real(1), 3, real(0)), GW_STATUS_CONFIG_INVALID);
    EXPECT_EQ(gw_rate_filter_constants(&c, real(0.001), real(1), 8500, real(-1)), GW_STATUS_CONFIG_INVALID);
    EXPECT_FALSE(gw_rate_filter_invariant_holds(nullptr));
}

TEST(RateFilter, StartsAtThePresumedRate) {
    gw_rate_filter_constants_t constants{};
    ASSERT_EQ(gw_rate_filter_constants(&constants, real(0.001), real(200), 8500, real(668)), GW_STATUS_OK);
    gw_rate_filter_t filter{};
    gw_rate_filter_restart(&filter);
    gw_rate_filter_presume(&filter, real(1.5));
    gw_rate_filter_step(&filter, &constants, 0, real(0));
    EXPECT_EQ(filter.rate_radps, real(1.5));
    EXPECT_EQ(filter.derivative_radps2, real(0));
    gw_rate_filter_presume(&filter, real(7)); // it has started
    EXPECT_EQ(filter.rate_radps, real(1.5));
    for (const Real bad : {real(1000000.1), real(-1000000.1), not_a_number, infinite}) {
        gw_rate_filter_restart(&filter);
        gw_rate_filter_presume(&filter, bad);
        EXPECT_EQ(filter.rate_radps, real(0));
    }
    gw_rate_filter_presume(&filter, real(-1000000));
    EXPECT_EQ(filter.rate_radps, real(-1000000));
    EXPECT_TRUE(gw_rate_filter_invariant_holds(&filter));
}

} // namespace
