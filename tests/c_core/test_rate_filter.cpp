#include "support.hpp"

namespace
{

gw_rate_filter_constants_t constants(double period, double cutoff, std::uint32_t counts, double stiffness)
{
    gw_rate_filter_constants_t c{};
    EXPECT_EQ(gw_rate_filter_constants(&c, real(period), real(cutoff), counts, real(stiffness)), GW_STATUS_OK);
    return c;
}

// y'' = w^2 (u - y) - 2 w y' by classical Runge-Kutta in small steps, u held over each sample.
TEST(RateFilter, StepIsThatOfTheDifferentialEquation)
{
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

TEST(RateFilter, ConstantAccelerationIsMeasured)
{
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

} // namespace
