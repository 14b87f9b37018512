// The plant is written for any count of wheels: here for four, which no variable table has.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "from_variables.hpp"
#include "hybrid_integrator.hpp"
#include "plant_system.hpp"

namespace plant = giveway::plant;

template <> struct plant::Azimuths<4> { // 0, 90, 180, 270 deg
    static constexpr std::array<double, 4> cos = {1.0, 0.0, -1.0, 0.0};
    static constexpr std::array<double, 4> sin = {0.0, 1.0, 0.0, -1.0};
    static constexpr double side_distance = 0.7071067811865476;
};

namespace {

constexpr int wheels = 4;
using At = plant::Layout<wheels>;
using Parameters = plant::Parameters<double, wheels>;
using Inputs = plant::Inputs<double, wheels>;
using State = plant::TippingVector<double, wheels>;
using System = giveway::testbed::PlantSystemOf<wheels>;
using Motion = plant::InitialMotion<double, wheels>;

// Everything of the table's robot but its wheels' count; no slider.
Parameters robot() {
    giveway::testbed::Variables v{};
    giveway::testbed::set_start_values(v);
    const auto from = giveway::testbed::plant_parameters(v);
    Parameters p{};
    const auto copy = [](const char *, auto &into, const auto &value) {
        if constexpr (requires { into = value; }) {
            into = value;
        } else {
            into.fill(value[0]); // of each wheel
        }
    };
    plant::visit_parameters(copy, p, from);
    p.wheel_load.fill(1.0);
    p.wheel_traction.fill(1.0);
    p.outline_body = 1;
    p.outline_count = 4;
    p.outline_x = {0.25, 0.25, -0.25, -0.25};
    p.outline_y = {-0.25, 0.25, 0.25, -0.25};
    p.slider_present = 0;
    return p;
}

// Gears that give way to a push.
Parameters easy_robot() {
    Parameters p = robot();
    p.drivetrain_gear_coulomb = 0.1;
    p.drivetrain_gear_stiction = 0.1;
    return p;
}

struct Motions {
    State start, end;
    std::vector<int> events; // that happened
    plant::Outputs<double, wheels> outputs;
    double residual_j, in_play_j;
};

Motions run(const Parameters &p, const Motion &motion, const Inputs &inputs, double seconds) {
    struct Recorder final : giveway::solver::HybridSystem {
        System system;
        std::vector<int> events;
        [[nodiscard]] int state_count() const override { return system.state_count(); }
        [[nodiscard]] int event_count() const override { return system.event_count(); }
        void rhs(double t, const double *x, double *rate) override { system.rhs(t, x, rate); }
        void indicators(double t, const double *x, double *value) override { system.indicators(t, x, value); }
        void transition(double t, double *x, const int *fired) override {
            for (int i = 0; i < event_count(); ++i) {
                if (fired[i] != 0) {
                    events.push_back(i);
                }
            }
            system.transition(t, x, fired);
        }
        [[nodiscard]] double absolute_tolerance(int state) const override { return system.absolute_tolerance(state); }
    } recorder;
    Motions result{};
    recorder.system.start(p, motion, inputs, result.start);
    const double stored = recorder.system.outputs(result.start.data()).stored_energy;
    giveway::solver::HybridIntegrator integrator;
    EXPECT_TRUE(integrator.create(recorder, 0.0, result.start.data(), {.relative_tolerance = 1e-8}));
    EXPECT_TRUE(integrator.advance(seconds)) << integrator.error();
    std::copy_n(integrator.state(), recorder.state_count(), result.end.begin());
    result.events = recorder.events;
    result.outputs = recorder.system.outputs(integrator.state());
    const double work = result.end[At::work_in] - result.start[At::work_in];
    const double lost = result.end[At::dissipated] - result.start[At::dissipated];
    result.residual_j = work - lost - (result.outputs.stored_energy - stored);
    result.in_play_j = std::fabs(work) + std::fabs(lost) + std::fabs(result.outputs.stored_energy - stored);
    return result;
}

Inputs push(double newton, double direction_rad) {
    Inputs inputs{};
    inputs.push_force_x = newton * std::cos(direction_rad);
    inputs.push_force_y = newton * std::sin(direction_rad);
    return inputs;
}

bool happened(const Motions &run, int event) {
    return std::find(run.events.begin(), run.events.end(), event) != run.events.end();
}

} // namespace

TEST(FourWheels, RestingTorquesBalanceTheWrenchAndAskLeast) {
    const Parameters p = robot();
    for (const plant::Planar3<double> wrench :
         {plant::Planar3<double>{10.0, 0.0, 0.0}, {0.0, -7.0, 0.0}, {0.0, 0.0, 3.0}, {4.0, 9.0, -2.0}}) {
        const auto torque = plant::balancing_torques(p, wrench);
        plant::Planar3<double> sum{0.0, 0.0, 0.0};
        for (int i = 0; i < wheels; ++i) {
            sum = sum + torque[i] * plant::wheel_row(p, i);
        }
        EXPECT_NEAR(sum.x, wrench.x, 1e-13);
        EXPECT_NEAR(sum.y, wrench.y, 1e-13);
        EXPECT_NEAR(sum.z, wrench.z, 1e-13);
        // Torques that turn wheels against each other push nothing: the least have none of them.
        EXPECT_NEAR(torque[0] - torque[1] + torque[2] - torque[3], 0.0, 1e-15);
    }
}

TEST(FourWheels, StayAtRest) {
    const Motions still = run(robot(), Motion{}, Inputs{}, 0.5);
    EXPECT_EQ(still.end, still.start);
    EXPECT_TRUE(still.events.empty());
}

TEST(FourWheels, StartAsABodyThatCarriesItsWheels) {
    Parameters p = robot();
    p.roller_coulomb_torque = 0.0;
    const auto d = plant::derive(p);
    Inputs inputs = push(10.0, 0.7);
    inputs.push_point_y = 0.1;
    plant::StateVector<double, wheels> x{};
    plant::Modes<double, wheels> m{};
    const auto rate = plant::rhs(x, inputs, m, p, d);
    const double mass = p.base_mass + 2.0 * p.wheel_inertia / (p.wheel_radius * p.wheel_radius) +
                        2.0 * p.roller_inertia / (p.roller_radius * p.roller_radius);
    const double inertia = p.base_yaw_inertia + 4.0 * p.wheel_inertia * std::pow(p.wheel_distance / p.wheel_radius, 2);
    EXPECT_NEAR(rate[At::base_vx], inputs.push_force_x / mass, 1e-14);
    EXPECT_NEAR(rate[At::base_vy], inputs.push_force_y / mass, 1e-14);
    EXPECT_NEAR(rate[At::base_omega], -0.1 * inputs.push_force_x / inertia, 1e-14);
}

TEST(FourWheels, GoWhereTheyArePushed) {
    for (int eighth = 0; eighth < 8; ++eighth) {
        const double direction = eighth * 0.7853981633974483;
        const Motions pushed = run(easy_robot(), Motion{}, push(60.0, direction), 0.3);
        const double vx = pushed.end[At::base_vx];
        const double vy = pushed.end[At::base_vy];
        EXPECT_GT(std::hypot(vx, vy), 0.05);
        // By symmetry exactly there; the integrator's tolerance is 1e-8.
        EXPECT_NEAR(vy * std::cos(direction) - vx * std::sin(direction), 0.0, 1e-6);
        EXPECT_NEAR(pushed.end[At::base_theta], 0.0, 1e-6);
        EXPECT_TRUE(happened(pushed, At::event_gear) || happened(pushed, At::event_gear + 3));
        EXPECT_NEAR(pushed.residual_j, 0.0, 1e-5 * pushed.in_play_j);
    }
}

TEST(FourWheels, RollOnSteadilyWhereTheyRolled) {
    const Parameters p = robot();
    const Motion motion{.x = 0.0,
                        .y = 0.0,
                        .theta = 0.4,
                        .vx = 0.2,
                        .vy = 0.1,
                        .omega = 0.0,
                        .slider_speed = 0.0,
                        .bristle_offset = {}};
    const auto d = plant::derive(p);
    plant::StateVector<double, wheels> x{};
    plant::Modes<double, wheels> m{};
    plant::initial_state(motion, Inputs{}, p, d, x, m);
    const auto rate = plant::rhs(x, Inputs{}, m, p, d);
    for (const int state : {At::base_vx, At::base_vy, At::base_omega}) {
        EXPECT_NEAR(rate[state], 0.0, 1e-12);
    }
}

TEST(FourWheels, AreHitByASlider) {
    Parameters p = easy_robot();
    p.slider_present = 1;
    p.rope_attached = 0;
    p.bumper_kind = plant::BumperKind::magnetic;
    p.slider_direction = 3.141592653589793;
    p.slider_target_x = 0.25;
    p.slider_target_y = 0.1;
    p.slider_run_up = 0.05;
    Motion motion{};
    motion.slider_speed = 0.5;
    const Motions hit = run(p, motion, Inputs{}, 0.6);
    EXPECT_TRUE(happened(hit, At::event_contact));
    EXPECT_TRUE(happened(hit, At::event_gear + 3));
    EXPECT_LT(hit.end[At::impulse_x], -1.0);
    EXPECT_LT(hit.end[At::base_x], -1e-3);
    EXPECT_GT(hit.end[At::base_theta], 0.0);
    EXPECT_NEAR(hit.residual_j, 0.0, 1e-5 * hit.in_play_j);
}

TEST(FourWheels, HaveTheJacobianOfTheirEquations) {
    Parameters p = easy_robot();
    Motion motion{};
    motion.vx = 0.2;
    motion.omega = 0.3;
    System system;
    State start{};
    system.start(p, motion, Inputs{}, start);
    for (int i = 0; i < wheels; ++i) {
        start[At::bristle + i] *= 0.9; // away from the kink where it slips fully
    }
    constexpr std::size_t count = At::state_count;
    std::vector<double> matrix(count * count);
    ASSERT_TRUE(system.jacobian(0.0, start.data(), matrix.data()));
    for (std::size_t column = 0; column < At::work_in; ++column) {
        const double h = 1e-7;
        State above = start;
        State below = start;
        above[column] += h;
        below[column] -= h;
        State up{};
        State down{};
        system.rhs(0.0, above.data(), up.data());
        system.rhs(0.0, below.data(), down.data());
        for (std::size_t row = 0; row < count; ++row) {
            const double slope = (up[row] - down[row]) / (2.0 * h);
            // Differences over 1e-7: rounding and curvature stay below 1e-5 of the largest entries.
            EXPECT_NEAR(matrix[column * count + row], slope, 1e-4 * (1.0 + std::fabs(slope))) << row << ' ' << column;
        }
    }
}

TEST(FourWheels, StandOnTheFloorAndTipOverTheirSides) {
    Parameters p = robot();
    p.base_tipping = 1;
    const Motions still = run(p, Motion{}, Inputs{}, 0.2);
    const double weight = p.base_mass * plant::gravity_mps2;
    for (const double load : still.outputs.wheel_load) {
        EXPECT_NEAR(load, 0.25 * weight, 1e-6 * weight);
    }
    EXPECT_NEAR(still.outputs.tip_margin, 1.0, 1e-9);
    // Over the side between wheels 0 and 1 at 45 deg, which is nearer than a wheel.
    const auto d = plant::derive(p);
    State lean = still.end;
    const double angle = 0.02;
    lean[At::base_roll] = -angle * std::sqrt(0.5);
    lean[At::base_pitch] = angle * std::sqrt(0.5);
    const auto stance = plant::stance<wheels>(lean, plant::Vector2<double>{0.0, 0.0});
    const double shift = p.base_com_height * angle / (p.wheel_distance * std::sqrt(0.5));
    EXPECT_NEAR(plant::tip_margin(stance, p, d, plant::Vector2<double>{0.0, 0.0}), 1.0 - shift, 1e-3 * shift);
}
