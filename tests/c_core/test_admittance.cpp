#include "support.hpp"

namespace {

constexpr double period = 0.001;

// Limits so wide that they never act, and no finish: the pure equations.
gw_admittance_config_t free_config(std::uint32_t kind) {
    gw_admittance_config_t c{};
    c.kind = kind;
    c.mass_kg = real(2.0);
    c.damping_newton_s_per_m = real(1.6);
    c.escape_impulse_newton_s = real(0.8);
    c.speed_limit_mps = real(10);
    c.acceleration_limit_mps2 = real(1000);
    c.finish_speed_mps = real(0);
    return c;
}

gw_admittance_config_t limited_config() {
    gw_controller_config_t config;
    gw_controller_config_trikey(&config);
    return config.admittance;
}

gw_admittance_t admittance_of(const gw_admittance_config_t &config) {
    gw_admittance_t a{};
    EXPECT_EQ(gw_admittance_init(&a, &config, real(period)), GW_STATUS_OK);
    return a;
}

gw_admittance_output_t step(gw_admittance_t &a, gw_vector_t force = {real(0), real(0)}) {
    gw_admittance_output_t out{};
    EXPECT_EQ(gw_admittance_step(&a, force, &out), GW_STATUS_OK);
    return out;
}

TEST(Admittance, FrozenImpulseIsTheClosedForm) {
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

TEST(Admittance, EndsAtExactlyImpulseOverDampingWithinItsLimits) {
    Random random(71);
    for (int trial = 0; trial < 200; ++trial) {
        auto config = limited_config();
        if (trial > 0) {
            config.mass_kg = real(random.uniform(0.5, 10.0));
            config.damping_newton_s_per_m = real(random.uniform(0.5, 8.0));
            config.escape_impulse_newton_s = real(random.uniform(0.1, 2.0));
            config.speed_limit_mps = real(random.uniform(0.05, 1.0));
            config.acceleration_limit_mps2 = real(random.uniform(0.3, 10.0));
        }
        auto a = admittance_of(config);
        const double angle = random.uniform(-pi, pi);
        ASSERT_EQ(gw_admittance_start(&a, {real(0), real(0)}, {real(std::cos(angle)), real(std::sin(angle))}),
                  GW_STATUS_OK);
        gw_sum_t x = gw_sum_of(real(0));
        gw_sum_t y = gw_sum_of(real(0));
        gw_vector_t before = {real(0), real(0)};
        int moving = 0;
        for (int i = 0; i < 60'000; ++i) {
            const auto out = step(a);
            x = gw_sum_add(x, out.displacement_m.x);
            y = gw_sum_add(y, out.displacement_m.y);
            const double speed = std::hypot(out.velocity_mps.x, out.velocity_mps.y);
            const double change = std::hypot(out.velocity_mps.x - before.x, out.velocity_mps.y - before.y);
            ASSERT_LE(speed, config.speed_limit_mps * (1.0 + 10.0 * epsilon));
            // The velocities themselves are rounded.
            ASSERT_LE(change, config.acceleration_limit_mps2 * period * (1.0 + 10.0 * epsilon) + 2.0 * epsilon);
            moving = speed > 0.0 ? i + 1 : moving;
            before = out.velocity_mps;
        }
        const double distance = config.escape_impulse_newton_s / config.damping_newton_s_per_m;
        EXPECT_NEAR(x.value, distance * std::cos(angle), 4.0 * epsilon * distance) << trial;
        EXPECT_NEAR(y.value, distance * std::sin(angle), 4.0 * epsilon * distance) << trial;
        EXPECT_LT(moving, 60'000) << "comes to rest in finite time";
        ASSERT_TRUE(gw_admittance_invariant_holds(&a));
        if (trial == 0) {
            EXPECT_NEAR(std::hypot(x.value, y.value), 0.5, 4.0 * epsilon);
            EXPECT_LT(moving, 6500);
        }
    }
}

TEST(Admittance, AMovingRobotIsTurnedRoundWithinItsAcceleration) {
    auto config = limited_config();
    auto a = admittance_of(config);
    ASSERT_EQ(gw_admittance_start(&a, {real(0.22), real(0.1)}, {real(-1), real(0)}), GW_STATUS_OK);
    double x = 0.0;
    double y = 0.0;
    const auto first = step(a);
    EXPECT_NEAR(std::hypot(first.velocity_mps.x - 0.22, first.velocity_mps.y - 0.1), 2.8e-3, 1e-6);
    x += first.displacement_m.x;
    y += first.displacement_m.y;
    for (int i = 0; i < 20'000; ++i) {
        const auto out = step(a);
        x += out.displacement_m.x;
        y += out.displacement_m.y;
    }
    EXPECT_NEAR(x, -0.5, 1e-5);
    EXPECT_NEAR(y, 0.0, 1e-5);
}

TEST(Admittance, LiveForceIsTheDifferentialEquation) {
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

TEST(Admittance, LiveForceKeepsItsLimits) {
    auto config = limited_config();
    config.kind = GW_ADMITTANCE_LIVE_FORCE;
    auto a = admittance_of(config);
    ASSERT_EQ(gw_admittance_start(&a, {real(0), real(0)}, {real(1), real(0)}), GW_STATUS_OK);
    Random random(73);
    gw_vector_t before = {real(0), real(0)};
    for (int i = 0; i < 5000; ++i) {
        const auto out = step(a, {real(random.uniform(-300, 300)), real(random.uniform(-300, 300))});
        ASSERT_LE(std::hypot(out.velocity_mps.x, out.velocity_mps.y), 0.5 * (1.0 + 10.0 * epsilon));
        ASSERT_LE(std::hypot(out.velocity_mps.x - before.x, out.velocity_mps.y - before.y),
                  2.8e-3 * (1.0 + 10.0 * epsilon) + 2.0 * epsilon);
        before = out.velocity_mps;
    }
}

TEST(Admittance, ZeroDirectionComesToRest) {
    auto a = admittance_of(limited_config());
    ASSERT_EQ(gw_admittance_start(&a, {real(0.1), real(0)}, {real(0), real(0)}), GW_STATUS_OK);
    double x = 0.0;
    for (int i = 0; i < 10'000; ++i) {
        x += step(a).displacement_m.x;
    }
    EXPECT_NEAR(x, 0.0, 1e-6);
    EXPECT_EQ(step(a).velocity_mps.x, real(0));
}

TEST(Admittance, Refusals) {
    auto a = admittance_of(limited_config());
    gw_admittance_output_t out{};
    for (const Real bad : {not_a_number, infinite, real(2e9)}) {
        EXPECT_EQ(gw_admittance_step(&a, {bad, real(0)}, &out), GW_STATUS_INPUT_INVALID);
        EXPECT_EQ(out.velocity_mps.x, real(0));
        EXPECT_EQ(gw_admittance_start(&a, {bad, real(0)}, {real(1), real(0)}), GW_STATUS_INPUT_INVALID);
        EXPECT_EQ(gw_admittance_start(&a, {real(0), real(0)}, {real(0), bad}), GW_STATUS_INPUT_INVALID);
    }
    EXPECT_EQ(gw_admittance_start(&a, {real(0), real(0)}, {real(1), real(1)}), GW_STATUS_INPUT_INVALID);
    gw_admittance_t raw{};
    EXPECT_EQ(gw_admittance_step(&raw, {real(0), real(0)}, &out), GW_STATUS_NOT_INITIALISED);
    EXPECT_EQ(gw_admittance_start(&raw, {real(0), real(0)}, {real(0), real(0)}), GW_STATUS_NOT_INITIALISED);
    EXPECT_EQ(gw_admittance_step(nullptr, {real(0), real(0)}, &out), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_admittance_step(&a, {real(0), real(0)}, nullptr), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_admittance_start(nullptr, {real(0), real(0)}, {real(0), real(0)}), GW_STATUS_NULL_POINTER);
    auto config = limited_config();
    EXPECT_EQ(gw_admittance_init(nullptr, &config, real(period)), GW_STATUS_NULL_POINTER);
    EXPECT_EQ(gw_admittance_init(&a, nullptr, real(period)), GW_STATUS_NULL_POINTER);
    config.mass_kg = real(0);
    EXPECT_EQ(gw_admittance_init(&a, &config, real(period)), GW_STATUS_CONFIG_INVALID);
    EXPECT_FALSE(gw_admittance_invariant_holds(&a));
    EXPECT_FALSE(gw_admittance_invariant_holds(nullptr));
}

} // namespace
