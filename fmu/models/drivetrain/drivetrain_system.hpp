// One actuator of Fig. 6 as seen by the solver. The element laws are the plant's; only the load is different: a
// separate inertia.
#pragma once

#include <cmath>

#include "drivetrain.hpp"
#include "exchange.hpp"
#include "roller.hpp"

namespace giveway::drivetrain {

enum StateIndex : int { motor_angle, motor_speed, load_angle, load_speed, work_in, dissipated, state_count };

struct Load {
    double inertia, viscous;
};

struct Torques {
    double motor, environment;
};

struct Evaluation {
    double sensed, net, friction, stored;
    double rate[state_count];
};

class DrivetrainSystem final : public ExchangeableSystem {
public:
    // `parameters`: the fields of drivetrain and roller friction. A roller of radius 1 m that turns the friction force
    // of (28) into B2.
    void start(const plant::Parameters<double> &parameters, const Load &load, const double *state) {
        parameters_ = parameters;
        parameters_.roller_model = plant::RollerModel::tanh;
        parameters_.roller_radius = 1.0;
        parameters_.wheel_load.fill(1.0);
        parameters_.roller_friction_scale.fill(1.0);
        parameters_.drivetrain_friction_scale.fill(1.0);
        load_ = load;
        torques_ = {};
        direction_ = math::sign(state[motor_speed]);
        release(state);
    }

    template <class Archive> void archive(Archive &a) {
        a(parameters_);
        a(load_);
        a(torques_);
        a(direction_);
    }

    void set_torques(const Torques &torques, const double *state) {
        torques_ = torques;
        release(state);
    }

    // In continuous time: a gear that breaks away waits for the following event.
    void follow_torques(const Torques &torques) { torques_ = torques; }

    [[nodiscard]] const Torques &torques() const { return torques_; }
    [[nodiscard]] bool stuck() const { return std::fabs(direction_) < 0.5; }

    [[nodiscard]] Evaluation evaluate(const double *x) const {
        const auto &p = parameters_;
        Evaluation e{};
        e.sensed = plant::sensed_torque(p, x[motor_angle], x[motor_speed], x[load_angle], x[load_speed]);
        e.net = plant::net_motor_torque(p, torques_.motor, e.sensed);
        const auto coulomb = plant::roller_force(p, 0, x[load_speed], 0.0);
        e.friction = coulomb.force + load_.viscous * x[load_speed];
        const double slip = x[motor_speed] - x[load_speed];
        const double wind_up = x[motor_angle] - x[load_angle];
        e.rate[motor_angle] = x[motor_speed];
        e.rate[motor_speed] = plant::motor_acceleration(p, 0, direction_, e.net, x[motor_speed]);
        e.rate[load_angle] = x[load_speed];
        e.rate[load_speed] = (e.sensed - e.friction + torques_.environment) / load_.inertia;
        e.rate[work_in] = (e.net + e.sensed) * x[motor_speed] + torques_.environment * x[load_speed];
        e.rate[dissipated] = plant::gear_dissipation(p, 0, direction_, x[motor_speed]) +
                             p.drivetrain_damping * slip * slip + e.friction * x[load_speed];
        e.stored = 0.5 * (p.drivetrain_motor_inertia * x[motor_speed] * x[motor_speed] +
                          load_.inertia * x[load_speed] * x[load_speed] + p.drivetrain_stiffness * wind_up * wind_up);
        return e;
    }

    [[nodiscard]] int state_count() const override { return drivetrain::state_count; }
    [[nodiscard]] int event_count() const override { return 1; }

    void rhs(double, const double *state, double *rate) override {
        const Evaluation e = evaluate(state);
        for (int i = 0; i < drivetrain::state_count; ++i) {
            rate[i] = e.rate[i];
        }
    }

    void indicators(double, const double *state, double *value) override {
        value[0] = plant::gear_indicator(parameters_, 0, direction_, evaluate(state).net, state[motor_speed]);
    }

    void transition(double, double *state, const int *fired) override {
        if (fired[0] >= 0) {
            return;
        }
        const double net = evaluate(state).net;
        // At the located break-away the net torque equals the stiction up to rounding: the gear slides in the direction
        // of the torque.
        direction_ = stuck() ? math::sign(net) : plant::gear_direction_from_rest(parameters_, 0, net);
        state[motor_speed] = 0.0;
    }

    [[nodiscard]] int side(int) const override { return 1; }
    [[nodiscard]] double hysteresis(int) const override {
        return stuck() ? 1e-8  // N m
                       : 1e-7; // rad/s
    }

    [[nodiscard]] double absolute_tolerance(int state) const override {
        switch (state) {
        case motor_angle:
        case load_angle:
            return 1e-9; // rad
        case motor_speed:
        case load_speed:
            return 1e-8; // rad/s
        default:
            return 1e-7; // J: accounts, which nothing else depends on
        }
    }

private:
    // A stuck gear breaks away at once if the net torque exceeds its stiction.
    void release(const double *state) {
        if (stuck()) {
            direction_ = plant::gear_direction_from_rest(parameters_, 0, evaluate(state).net);
        }
    }

    plant::Parameters<double> parameters_{};
    Load load_{};
    Torques torques_{};
    double direction_ = 0.0; // -1, 0 (stuck), +1
};

} // namespace giveway::drivetrain
