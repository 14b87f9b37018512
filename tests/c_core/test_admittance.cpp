#include "support.hpp"

namespace
{

constexpr double period = 0.001;

// Limits so wide that they never act, and no finish: the pure equations.
gw_admittance_config_t free_config(std::uint32_t kind)
{
    gw_admittance_config_t c{};
    c.kind = kind;
    c.mass_kg = real(2.0);
    c.damping_newton_s_per_m = real(1.6);
    c.escape_impulse_newton_s = real(0.8);
    c.speed_limit_mps = real(10);
    c.acceleration_limit_mps2 = real(1000);
    c.finish_speed_mps = real(0);
    c.tip.share = real(0.5); // of no limit
    return c;
}

gw_admittance_t admittance_of(const gw_admittance_config_t &config)
{
    gw_admittance_t a{};
    EXPECT_EQ(gw_admittance_init(&a, &config, real(period)), GW_STATUS_OK);
    return a;
}

gw_admittance_output_t step(gw_admittance_t &a, gw_vector_t force = {real(0), real(0)})
{
    gw_admittance_output_t out{};
    EXPECT_EQ(gw_admittance_step(&a, force, &out), GW_STATUS_OK);
    return out;
}

TEST(Admittance, FrozenImpulseIsTheClosedForm)
{
    // (2): x = p/B (1 - exp(-B t/M)), v(0+) = p/M = 0.4 m/s, time constant 1.25 s.
    auto config = free_config(GW_ADMITTANCE_FROZEN_IMPULSE);
    auto a = admittance_of(config);
    const gw_vector_t u = {real(0.6), real(-0.8)};
    ASSERT_EQ(gw_admittance_start(&a, {real(0), real(0)}, u), GW_STATUS_OK);
    double x = 0.0;
    double y = 0.0;
    for (int i = 1; i <= 20'000; ++i) {
        const auto out = step(a);
        x += out.displacement_m.x;
        y += out.displacement_m.y;
        const double t = i * period;
        const double moved = 0.5 * -std::expm1(-0.8 * t);
        ASSERT_NEAR(x, 0.6 * moved, 0.5 * tolerance) << i;
        ASSERT_NEAR(y, -0.8 * moved, 0.5 * tolerance) << i;
        ASSERT_NEAR(out.velocity_mps.x, 0.6 * 0.4 * std::exp(-0.8 * t), 0.4 * tolerance) << i;
    }
}

TEST(Admittance, LiveForceIsTheDifferentialEquation)
{
    // (1) with a force held over each tick, by Runge-Kutta in small steps.
    Random random(72);
    auto a = admittance_of(free_config(GW_ADMITTANCE_LIVE_FORCE));
    ASSERT_EQ(gw_admittance_start(&a, {real(0.1), real(-0.05)}, {real(1), real(0)}), GW_STATUS_OK);
    double x = 0.0;
    double v = static_cast<double>(real(0.1));
    double found_x = 0.0;
    for (int i = 0; i < 3000; ++i) {
        const Real force = real(i < 500 ? random.uniform(-5.0, 5.0) : 0.0);
        const auto out = step(a, {force, real(0)});
        found_x += out.displacement_m.x;
        constexpr int parts = 10;
        for (int k = 0; k < parts; ++k) {
            const double h = period / parts;
            const auto slope = [&](double speed) { return (force - 1.6 * speed) / 2.0; };
            const double k1 = slope(v);
            const double k2 = slope(v + h / 2 * k1);
            const double k3 = slope(v + h / 2 * k2);
            const double k4 = slope(v + h * k3);
            const double next = v + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
            // Simpson with the cubic Hermite midpoint.
            const double middle = (v + next) / 2 + h / 8 * (slope(v) - slope(next));
            x += h / 6 * (v + 4 * middle + next);
            v = next;
        }
        ASSERT_NEAR(out.velocity_mps.x, v, tolerance) << i;
        ASSERT_NEAR(found_x, x, tolerance) << i;
    }
}

} // namespace
