// One collision, three integration methods: events, states and energy agree within the tolerance. The tolerances.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "from_variables.hpp"
#include "hybrid_integrator.hpp"
#include "plant_system.hpp"

namespace {

using giveway::solver::HybridIntegrator;
using giveway::solver::HybridSystem;
using giveway::solver::Method;
using giveway::testbed::PlantSystem;
using giveway::testbed::Variables;
namespace plant = giveway::plant;
using At = plant::Layout<>;

struct Event {
    int index, direction;
    double time_s;
};

// The plant with a log of its events.
class Recorder final : public HybridSystem {
public:
    PlantSystem system;
    std::vector<Event> events;
    [[nodiscard]] int state_count() const override { return system.state_count(); }
    [[nodiscard]] int event_count() const override { return system.event_count(); }
    void rhs(double t, const double *x, double *rate) override { system.rhs(t, x, rate); }
    bool jacobian(double t, const double *x, double *matrix) override { return system.jacobian(t, x, matrix); }
    void indicators(double t, const double *x, double *value) override { system.indicators(t, x, value); }
    void transition(double t, double *x, const int *fired) override {
        for (int i = 0; i < At::event_count; ++i) {
            if (fired[i] != 0) {
                events.push_back({i, fired[i], t});
            }
        }
        system.transition(t, x, fired);
    }
    [[nodiscard]] double absolute_tolerance(int state) const override { return system.absolute_tolerance(state); }
};

struct Collision {
    std::vector<Event> events;
    plant::StateVector<double> state;
    double residual_j;
};

// 0.5 s of a slider that hits the unpowered robot: contact, latch, rope, stops, gears that break away and stick again.
Collision collide(Method method, int bumper, int latch_model, double stiffness, double tolerance) {
    Variables v{};
    giveway::testbed::set_start_values(v);
    v.bumper_kind = bumper;
    v.bumper_latch_model = latch_model;
    v.contact_stiffness *= stiffness;
    v.bumper_stop_stiffness *= stiffness;
    Recorder recorder;
    plant::TippingVector<double> start{};
    recorder.system.start(giveway::testbed::plant_parameters(v),
                          {v.start_x, v.start_y, v.start_theta, 0.0, 0.0, 0.0, v.slider_speed}, {}, start);
    const double stored = recorder.system.outputs(start.data()).stored_energy;
    HybridIntegrator integrator;
    EXPECT_TRUE(integrator.create(
        recorder, 0.0, start.data(),
        {.relative_tolerance = tolerance, .absolute_tolerance_scale = tolerance / 1e-6, .method = method}));
    EXPECT_TRUE(integrator.advance(0.5)) << integrator.error();
    Collision run{recorder.events, {}, 0.0};
    std::copy_n(integrator.state(), At::state_count, run.state.begin());
    run.residual_j = run.state[At::work_in] - run.state[At::dissipated] -
                     (recorder.system.outputs(integrator.state()).stored_energy - stored);
    return run;
}

bool happened(const Collision &run, int index, int direction) {
    return std::any_of(run.events.begin(), run.events.end(),
                       [&](const Event &event) { return event.index == index && event.direction == direction; });
}

} // namespace

TEST(Tolerances, AreByTheUnitOfTheState) {
    const PlantSystem system;
    for (const int first : {At::motor_angle, At::wheel_angle, At::bristle, At::grip}) {
        EXPECT_EQ(system.absolute_tolerance(first + 2), 1e-9) << first; // m, rad
    }
    for (const int first : {At::motor_speed, At::wheel_spin}) {
        EXPECT_EQ(system.absolute_tolerance(first), 1e-8) << first; // rad/s
        EXPECT_EQ(system.absolute_tolerance(first + 2), 1e-8) << first;
    }
    EXPECT_EQ(system.absolute_tolerance(At::base_x), 1e-9);
    EXPECT_EQ(system.absolute_tolerance(At::slider_speed), 1e-8);
    EXPECT_EQ(system.absolute_tolerance(At::dissipated), 1e-7); // J
}

TEST(Methods, AgreeOnEveryEventAndTheEnd) {
    struct Bumper {
        int kind, latch_model;
    };
    for (const double stiffness : {1.0, 30.0}) {
        for (const Bumper bumper : {Bumper{0, 0}, Bumper{1, 0}, Bumper{2, 0}, Bumper{2, 1}}) {
            const Collision erk = collide(Method::erk, bumper.kind, bumper.latch_model, stiffness, 1e-8);
            EXPECT_TRUE(happened(erk, At::event_contact, 1));
            EXPECT_TRUE(happened(erk, At::event_contact, -1));
            EXPECT_TRUE(happened(erk, At::event_gear, -1)); // it breaks away
            EXPECT_EQ(happened(erk, At::event_end_stop, 1) || happened(erk, At::event_end_stop, -1),
                      bumper.kind != 0); // the plate moves
            for (const Method method : {Method::erk, Method::adams, Method::bdf}) {
                SCOPED_TRACE(testing::Message()
                             << giveway::solver::name(method) << ", bumper " << bumper.kind << ", latch "
                             << bumper.latch_model << ", stiffness times " << stiffness);
                const Collision run =
                    method == Method::erk ? erk : collide(method, bumper.kind, bumper.latch_model, stiffness, 1e-8);
                // 4 J are turned over in some 500 steps, each with a local error of 1e-8 of it.
                EXPECT_LT(std::fabs(run.residual_j), 5e-6);
                ASSERT_EQ(run.events.size(), erk.events.size());
                for (std::size_t i = 0; i < erk.events.size(); ++i) {
                    EXPECT_EQ(run.events[i].index, erk.events[i].index);
                    EXPECT_EQ(run.events[i].direction, erk.events[i].direction);
                    // Asked for: 10 us. Local errors of 1e-8 m/s and some 100 steps, at speeds whose changes of 0.5 m/s
                    // take 10 ms.
                    EXPECT_NEAR(run.events[i].time_s, erk.events[i].time_s, 2e-6) << "event " << i;
                }
                for (int i = 0; i < At::state_count; ++i) {
                    EXPECT_NEAR(run.state[static_cast<std::size_t>(i)], erk.state[static_cast<std::size_t>(i)], 2e-5)
                        << "state " << i; // 1e-8 in 2000 steps at most
                }
            }
        }
    }
}
