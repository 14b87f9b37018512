// Every method on the same problems: events, switched inputs, stiffness, and failures that end with time, reason and
// the last good state.
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "hybrid_integrator.hpp"

namespace {

using giveway::solver::HybridIntegrator;
using giveway::solver::HybridSystem;
using giveway::solver::IntegratorOptions;
using giveway::solver::Method;

struct Smooth : HybridSystem {
    [[nodiscard]] int state_count() const override { return 1; }
    [[nodiscard]] int event_count() const override { return 0; }
    void indicators(double, const double *, double *) override {}
    void transition(double, double *, const int *) override {}
    [[nodiscard]] double absolute_tolerance(int) const override { return 1e-9; }
};

// x'' = -x, reversed with a loss at x = 0: half oscillations of half the amplitude each.
struct Pendulum final : HybridSystem {
    int impacts = 0;
    double last_impact_s = 0.0;
    double last_event_s = -1.0; // an impact, or the way back out of it
    [[nodiscard]] int state_count() const override { return 2; }
    [[nodiscard]] int event_count() const override { return 1; }
    void rhs(double, const double *x, double *rate) override {
        rate[0] = x[1];
        rate[1] = -x[0];
    }
    bool jacobian(double, const double *, double *matrix) override {
        matrix[0] = 0.0;
        matrix[1] = -1.0;
        matrix[2] = 1.0;
        matrix[3] = 0.0;
        return true;
    }
    void indicators(double, const double *x, double *value) override { value[0] = x[0]; }
    void transition(double time_s, double *x, const int *fired) override {
        last_event_s = time_s;
        if (fired[0] < 0) {
            x[0] = 0.0;
            x[1] *= -0.5;
            ++impacts;
            last_impact_s = time_s;
        }
    }
    [[nodiscard]] double absolute_tolerance(int) const override { return 1e-10; }
};

// x' = -rate (x - cos t) - sin t: x = cos t for any rate; the higher the rate, the stiffer.
struct Stiff final : Smooth {
    double decay = 1e6;
    void rhs(double t, const double *x, double *rate) override {
        rate[0] = -decay * (x[0] - std::cos(t)) - std::sin(t);
    }
    bool jacobian(double, const double *, double *matrix) override {
        matrix[0] = -decay;
        return true;
    }
};

// x' = x^2 from 1: infinite at t = 1.
struct Exploding final : Smooth {
    void rhs(double, const double *x, double *rate) override { rate[0] = x[0] * x[0]; }
    bool jacobian(double, const double *x, double *matrix) override {
        matrix[0] = 2.0 * x[0];
        return true;
    }
};

// x' = 1, y' = sqrt(0.5 - x): not a number beyond t = 0.5.
struct Ending final : Smooth {
    [[nodiscard]] int state_count() const override { return 2; }
    void rhs(double, const double *x, double *rate) override {
        rate[0] = 1.0;
        rate[1] = x[0] > 0.5 ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(0.5 - x[0]);
    }
    bool jacobian(double, const double *x, double *matrix) override {
        matrix[0] = 0.0;
        matrix[1] = x[0] < 0.5 ? -0.5 / std::sqrt(0.5 - x[0]) : 0.0;
        matrix[2] = 0.0;
        matrix[3] = 0.0;
        return true;
    }
};

struct WithoutJacobian final : Smooth {
    void rhs(double, const double *x, double *rate) override { rate[0] = -x[0]; }
};

class EveryMethod : public testing::TestWithParam<Method> {
protected:
    [[nodiscard]] static IntegratorOptions options(double tolerance) {
        return {.relative_tolerance = tolerance, .method = GetParam()};
    }
    [[nodiscard]] static bool mentions(const std::string &message, const std::string &part) {
        return message.find(part) != std::string::npos;
    }
};

INSTANTIATE_TEST_SUITE_P(Of, EveryMethod, testing::Values(Method::erk, Method::adams, Method::bdf),
                         [](const auto &parameter) { return giveway::solver::name(parameter.param); });

} // namespace

TEST_P(EveryMethod, LocatesEventsAndStartsFreshThere) {
    Pendulum pendulum;
    const double start[2] = {1.0, 0.0};
    HybridIntegrator integrator;
    ASSERT_TRUE(integrator.create(pendulum, 0.0, start, options(1e-9)));
    ASSERT_TRUE(integrator.advance(10.0));
    // Impacts at pi/2, then every half period of pi: the third at 2.5 pi = 7.85 s. A local error of 1e-9 in each of
    // some hundred steps.
    EXPECT_EQ(pendulum.impacts, 3);
    EXPECT_NEAR(pendulum.last_impact_s, 2.5 * M_PI, 3e-7);
    EXPECT_NEAR(integrator.state()[0], 0.125 * std::sin(10.0 - 2.5 * M_PI), 1e-7);
    EXPECT_EQ(integrator.time(), 10.0);
    EXPECT_GE(integrator.statistics().events, 3);
}

TEST_P(EveryMethod, CountsOnFromACheckpointAndTellsTheLastEvent) {
    Pendulum pendulum;
    const double start[2] = {1.0, 0.0};
    HybridIntegrator integrator;
    ASSERT_TRUE(integrator.create(pendulum, 0.0, start, options(1e-6)));
    constexpr int rows = 100;
    for (int row = 1; row <= rows; ++row) {
        EXPECT_EQ(integrator.last_event_time(), pendulum.last_event_s);
        ASSERT_TRUE(integrator.advance(0.1 * row));
    }
    EXPECT_EQ(pendulum.impacts, 3);
    const auto counted = integrator.statistics();
    // Each row takes a step, and each step asks for the rate.
    EXPECT_GE(counted.steps, rows);
    EXPECT_LE(counted.steps, counted.rhs_calls);
    EXPECT_GE(counted.events, 3);

    const double state[2] = {integrator.state()[0], integrator.state()[1]};
    HybridIntegrator again;
    ASSERT_TRUE(again.resume(pendulum, integrator.checkpoint(), state, options(1e-6)));
    EXPECT_EQ(again.time(), integrator.time());
    EXPECT_EQ(again.last_event_time(), integrator.last_event_time());
    const auto resumed = again.statistics();
    EXPECT_EQ(resumed.steps, counted.steps);
    EXPECT_EQ(resumed.rhs_calls, counted.rhs_calls);
    EXPECT_EQ(resumed.jacobian_calls, counted.jacobian_calls);
    EXPECT_EQ(resumed.events, counted.events);
    ASSERT_TRUE(again.advance(20.0));
    const auto more = again.statistics();
    EXPECT_GT(more.steps, counted.steps);
    EXPECT_GT(more.rhs_calls, counted.rhs_calls);
    EXPECT_GT(more.events, counted.events);
    const bool has_jacobian = GetParam() == Method::bdf;
    EXPECT_EQ(counted.jacobian_calls > 0, has_jacobian);
    EXPECT_EQ(more.jacobian_calls > counted.jacobian_calls, has_jacobian);
}

TEST_P(EveryMethod, ConvergesWithItsTolerance) {
    double loose = 0.0;
    for (const double tolerance : {1e-5, 1e-9}) {
        Stiff system;
        system.decay = 10.0;
        const double start[1] = {0.0};
        HybridIntegrator integrator;
        ASSERT_TRUE(integrator.create(system, 0.0, start, options(tolerance)));
        ASSERT_TRUE(integrator.advance(2.0));
        const double error = std::fabs(integrator.state()[0] - (std::cos(2.0) - std::exp(-20.0)));
        EXPECT_LT(error, 20.0 * tolerance +
                             2e-9); // multistep methods hold local errors of 1 tolerance; the decay forgets old ones
        if (tolerance > 1e-6) {
            loose = error;
        } else {
            EXPECT_LT(error, 0.01 * loose);
        }
    }
}

TEST_P(EveryMethod, ForgetsItsHistoryWhenTold) {
    // The input of x' = u - x jumps every 10 ms. An integrator that kept its history would step over the jumps.
    struct Lag final : Smooth {
        double input = 0.0;
        void rhs(double, const double *x, double *rate) override { rate[0] = input - x[0]; }
        bool jacobian(double, const double *, double *matrix) override {
            matrix[0] = -1.0;
            return true;
        }
    } lag;
    const double start[1] = {0.0};
    HybridIntegrator integrator;
    ASSERT_TRUE(integrator.create(lag, 0.0, start, options(1e-8)));
    double exact = 0.0;
    for (int k = 0; k < 200; ++k) {
        lag.input = k % 2 == 0 ? 1.0 : -1.0;
        integrator.restart();
        ASSERT_TRUE(integrator.advance(0.01 * (k + 1)));
        exact = lag.input + (exact - lag.input) * std::exp(-0.01);
    }
    EXPECT_NEAR(integrator.state()[0], exact,
                200.0 * 2e-9); // 200 starts, each of a few absolute tolerances of 1e-9 at most
}

TEST_P(EveryMethod, SaysWhenAndWhyItStops) {
    Exploding exploding;
    const double start[1] = {1.0};
    HybridIntegrator integrator;
    auto with_clock = options(1e-6);
    with_clock.clock_start_s = 100.0;
    ASSERT_TRUE(integrator.create(exploding, 0.0, start, with_clock));
    EXPECT_FALSE(integrator.advance(2.0));
    const std::string message = integrator.error();
    EXPECT_NEAR(integrator.time(), 1.0, 1e-4); // the singularity, to the tolerance's reach
    EXPECT_TRUE(std::isfinite(integrator.state()[0]));
    EXPECT_GT(integrator.state()[0], 1e4);
    EXPECT_TRUE(mentions(message, giveway::solver::name(GetParam()))) << message;
    EXPECT_TRUE(mentions(message, "at t = 101") || mentions(message, "at t = 100.9999")) << message;
    EXPECT_TRUE(mentions(message, GetParam() == Method::erk ? "(ARK_" : "(CV_")) << message;
}

TEST_P(EveryMethod, EndsWithTheLastGoodState) {
    Ending ending;
    const double start[2] = {0.0, 0.0};
    HybridIntegrator integrator;
    ASSERT_TRUE(integrator.create(ending, 0.0, start, options(1e-6)));
    ASSERT_TRUE(integrator.advance(0.2));
    EXPECT_FALSE(integrator.advance(1.0));
    EXPECT_TRUE(mentions(integrator.error(), " at t = 0.")) << integrator.error();
    // The state belongs to the time (x = t; y is the integral), and neither to a trial that went wrong.
    EXPECT_GE(integrator.time(), 0.2);
    EXPECT_LE(integrator.time(), 0.5 + 1e-9);
    EXPECT_NEAR(integrator.state()[0], integrator.time(), 1e-12);
    const double left = 0.5 - integrator.time();
    EXPECT_NEAR(integrator.state()[1], (std::pow(0.5, 1.5) - std::pow(std::fabs(left), 1.5)) / 1.5, 1e-4);
    EXPECT_FALSE(integrator.advance(1.0));
}

TEST_P(EveryMethod, NamesTheStateThatIsNoNumber) {
    struct Driven final : Smooth {
        double input = 1.0;
        [[nodiscard]] int state_count() const override { return 2; }
        void rhs(double, const double *x, double *rate) override {
            rate[0] = -x[0];
            rate[1] = input - x[1];
        }
        bool jacobian(double, const double *, double *matrix) override {
            matrix[0] = matrix[3] = -1.0;
            matrix[1] = matrix[2] = 0.0;
            return true;
        }
    } driven;
    const double start[2] = {1.0, 0.0};
    HybridIntegrator integrator;
    ASSERT_TRUE(integrator.create(driven, 0.0, start, options(1e-6)));
    ASSERT_TRUE(integrator.advance(0.2));
    const double good[2] = {integrator.state()[0], integrator.state()[1]};
    driven.input = std::numeric_limits<double>::infinity();
    integrator.restart();
    EXPECT_FALSE(integrator.advance(1.0));
    EXPECT_TRUE(mentions(integrator.error(), "at t = 0.2 s: the rate of state 1 is not a finite number"))
        << integrator.error();
    EXPECT_EQ(integrator.time(), 0.2);
    EXPECT_EQ(integrator.state()[0], good[0]);
    EXPECT_EQ(integrator.state()[1], good[1]);
}

TEST(StiffSystem, IsEasyForBdfAlone) {
    const auto run = [](Method method) {
        Stiff stiff;
        const double start[1] = {1.0};
        HybridIntegrator integrator;
        EXPECT_TRUE(integrator.create(stiff, 0.0, start, {.method = method}));
        EXPECT_TRUE(integrator.advance(0.05)) << integrator.error();
        EXPECT_NEAR(integrator.state()[0], std::cos(0.05), 1e-5);
        return integrator.statistics();
    };
    const auto bdf = run(Method::bdf);
    const auto erk = run(Method::erk);
    const auto adams = run(Method::adams);
    // Stability holds an explicit step, and a fixed-point iteration, to about 3 time constants of 1 us.
    EXPECT_LT(bdf.steps, 100);
    EXPECT_GT(erk.steps, 10000);
    EXPECT_GT(adams.steps, 10000);
    // Newton with the system's own Jacobian, not with differences: CVODE would need one evaluation a column.
    EXPECT_GT(bdf.jacobian_calls, 0);
    EXPECT_EQ(erk.jacobian_calls, 0);
    EXPECT_EQ(adams.jacobian_calls, 0);
}

TEST(SystemWithoutJacobian, IsRefusedByBdf) {
    WithoutJacobian system;
    const double start[1] = {1.0};
    HybridIntegrator integrator;
    ASSERT_TRUE(integrator.create(system, 0.0, start, {.method = Method::bdf}));
    EXPECT_FALSE(integrator.advance(1.0));
    EXPECT_NE(std::string(integrator.error()).find("offers no Jacobian"), std::string::npos) << integrator.error();
    EXPECT_EQ(integrator.time(), 0.0);
    EXPECT_EQ(integrator.state()[0], 1.0);
}
