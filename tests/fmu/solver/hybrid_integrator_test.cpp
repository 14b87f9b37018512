// The integrator against closed forms: impact times of a bouncing ball, an oscillator with switched input, reported
// failures.
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "hybrid_integrator.hpp"

namespace {

using giveway::solver::HybridIntegrator;
using giveway::solver::HybridSystem;
using giveway::solver::IntegratorOptions;
using giveway::solver::Method;

constexpr double gravity = 9.81;

// Height and speed; the speed is reversed with restitution 0.5 at the floor.
struct Ball final : HybridSystem {
    int bounces = 0;
    double first_bounce_s = -1.0;
    [[nodiscard]] int state_count() const override { return 2; }
    [[nodiscard]] int event_count() const override { return 1; }
    void rhs(double, const double *x, double *rate) override {
        rate[0] = x[1];
        rate[1] = -gravity;
    }
    void indicators(double, const double *x, double *value) override { value[0] = x[0]; }
    void transition(double time_s, double *x, const int *fired) override {
        if (fired[0] < 0) {
            x[1] = -0.5 * x[1];
            first_bounce_s = bounces == 0 ? time_s : first_bounce_s;
            ++bounces;
        }
    }
    [[nodiscard]] double absolute_tolerance(int) const override { return 1e-9; }
};

// x'' = u - x, the input changed from outside.
struct Oscillator final : HybridSystem {
    double input = 0.0;
    [[nodiscard]] int state_count() const override { return 2; }
    [[nodiscard]] int event_count() const override { return 0; }
    void rhs(double, const double *x, double *rate) override {
        rate[0] = x[1];
        rate[1] = input - x[0];
    }
    void indicators(double, const double *, double *) override {}
    void transition(double, double *, const int *) override {}
    [[nodiscard]] double absolute_tolerance(int) const override { return 1e-9; }
};

// An event each microsecond of its clock.
struct Ticking final : HybridSystem {
    double next_s = 1e-6;
    [[nodiscard]] int state_count() const override { return 1; }
    [[nodiscard]] int event_count() const override { return 1; }
    void rhs(double, const double *, double *rate) override { rate[0] = 1.0; }
    void indicators(double, const double *x, double *value) override { value[0] = x[0] - next_s; }
    void transition(double, double *, const int *) override { next_s += 1e-6; }
    [[nodiscard]] double absolute_tolerance(int) const override { return 1e-9; }
};

} // namespace

TEST(HybridIntegrator, LocatesImpactsOfABouncingBall) {
    Ball ball;
    const double start[2] = {1.0, 0.0};
    HybridIntegrator integrator;
    // A crossing shows as a change of sign over a step: a step must not jump over a whole flight.
    IntegratorOptions options;
    options.maximum_step_s = 0.05;
    ASSERT_TRUE(integrator.create(ball, 0.0, start, options));
    ASSERT_TRUE(integrator.advance(1.2)) << integrator.error();
    const double fall = std::sqrt(2.0 / gravity);
    const double speed = gravity * fall;
    // Parabolas are integrated exactly; the remaining error is that of root finding, about 100 roundings of the step.
    EXPECT_NEAR(ball.first_bounce_s, fall, 1e-12);
    EXPECT_EQ(ball.bounces, 3); // impacts at fall * (1, 2, 2.5, 2.75 ..): three before 1.2 s = 2.66 fall
    const double since = 1.2 - 2.5 * fall;
    EXPECT_NEAR(integrator.state()[0], 0.125 * speed * since - 0.5 * gravity * since * since, 1e-11);
    EXPECT_EQ(integrator.statistics().events,
              2 * ball.bounces); // the floor is crossed downwards and, a rounding later, upwards
}

TEST(HybridIntegrator, StartsFreshWhenTheInputChanges) {
    Oscillator oscillator;
    const double start[2] = {0.0, 0.0};
    HybridIntegrator integrator;
    ASSERT_TRUE(integrator.create(oscillator, 0.0, start, IntegratorOptions{}));
    double position = 0.0;
    double speed = 0.0;
    constexpr double step = 1e-3;
    for (int k = 0; k < 5000; ++k) {
        oscillator.input = (k / 7) % 2 == 0 ? 1.0 : -0.4;
        integrator.restart();
        ASSERT_TRUE(integrator.advance(static_cast<double>(k + 1) * step));
        // Exact zero-order-hold step.
        const double next = oscillator.input + (position - oscillator.input) * std::cos(step) + speed * std::sin(step);
        speed = -(position - oscillator.input) * std::sin(step) + speed * std::cos(step);
        position = next;
    }
    // Fifth order: 1 ms of a 1 rad/s oscillator is (1e-3)^6/720 off, far below rounding; 5000 roundings of 1e-16
    // remain, whose signs differ (1e-14 is seen).
    EXPECT_NEAR(integrator.state()[0], position, 1e-13);
    EXPECT_NEAR(integrator.state()[1], speed, 1e-13);
    EXPECT_LT(integrator.statistics().steps, 5100); // one step per input: a restart does not fall back to tiny steps
}

TEST(HybridIntegrator, ConvergesWithItsTolerance) {
    double previous = 1.0;
    for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10}) {
        Oscillator oscillator;
        const double start[2] = {1.0, 0.0};
        HybridIntegrator integrator;
        ASSERT_TRUE(integrator.create(oscillator, 0.0, start,
                                      {.relative_tolerance = tolerance, .absolute_tolerance_scale = tolerance}));
        ASSERT_TRUE(integrator.advance(10.0));
        const double error = std::fabs(integrator.state()[0] - std::cos(10.0));
        EXPECT_LT(
            error,
            tolerance); // local errors of that size, damped by a controller that stays below it: 0.2 to 0.5 is seen
        EXPECT_LT(error, previous);
        previous = error;
    }
}

TEST(HybridIntegrator, StopsWhereEventsFollowEachOtherWithoutEnd) {
    Ticking ticking;
    const double start[1] = {0.0};
    HybridIntegrator integrator;
    ASSERT_TRUE(integrator.create(ticking, 0.0, start, IntegratorOptions{}));
    EXPECT_FALSE(integrator.advance(1.0));
    // 2001 events are allowed. There is no SUNDIALS code after the time, as SUNDIALS has not failed.
    EXPECT_EQ(integrator.statistics().events, 2001);
    EXPECT_STREQ(integrator.error(), "ERK stops: events follow each other without end at t = 0.002001 s");
}

TEST(HybridIntegrator, CountsFromZeroWhenItIsMadeAnew) {
    Oscillator oscillator;
    const double start[2] = {1.0, 0.0};
    HybridIntegrator integrator;
    ASSERT_TRUE(integrator.resume(oscillator, {0.0, 1e-3, -1.0, {5, 6, 7, 8}}, start, IntegratorOptions{}));
    EXPECT_EQ(integrator.statistics().steps, 5);
    EXPECT_EQ(integrator.statistics().events, 8);
    ASSERT_TRUE(integrator.create(oscillator, 0.0, start, IntegratorOptions{}));
    const giveway::solver::IntegratorStatistics counted = integrator.statistics();
    EXPECT_EQ(counted.steps, 0);
    EXPECT_EQ(counted.rhs_calls, 0);
    EXPECT_EQ(counted.jacobian_calls, 0);
    EXPECT_EQ(counted.events, 0);
}
