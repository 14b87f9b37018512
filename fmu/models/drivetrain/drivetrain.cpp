// The drivetrain of Fig. 6 behind the model interface; by choice with the servo of the drives beside it.
#include <cmath>
#include <cstdio>
#include <new>

#include "drivetrain_system.hpp"
#include "drivetrain_variables.hpp"
#include "hybrid_integrator.hpp"
#include "model.hpp"
#include "servo_axis.hpp"

namespace giveway::drivetrain {

namespace {

class Drivetrain final : public Model {
public:
    Drivetrain() { set_start_values(v_); }

    void* variables() override { return &v_; }

    void reset() override {
        v_ = {};
        set_start_values(v_);
    }

    Status initialise(double start_time_s, Message& message) override {
        if (v_.drivetrain_gear_stiction < v_.drivetrain_gear_coulomb) {
            std::snprintf(message.text, sizeof message.text,
                          "drivetrain.gear_stiction = %.9g is not allowed: it must be at least drivetrain.gear_coulomb = %.9g",
                          v_.drivetrain_gear_stiction, v_.drivetrain_gear_coulomb);
            return Status::error;
        }
        start_time_s_ = start_time_s;
        tick_ = 0;
        due_ = true;
        servo_torque_nm_ = 0.0;
        const auto refused = servo_.start({v_.servo_kp, v_.servo_kd, v_.drivetrain_torque_limit, v_.servo_derivative_cutoff,
                                           v_.servo_encoder_counts, v_.servo_delay});
        if (refused.field != GW_FIELD_NONE) {
            std::snprintf(message.text, sizeof message.text, "%s = %.9g is not allowed: [%.9g, %.9g]", gw_config_limit(refused.field)->name,
                          static_cast<double>(refused.value), static_cast<double>(refused.minimum), static_cast<double>(refused.maximum));
            return Status::error;
        }
        const double state[state_count] = {v_.start_motor_angle, v_.start_motor_speed, v_.start_load_angle, v_.start_load_speed, 0.0, 0.0};
        system_.start(parameters(), {v_.load_inertia, v_.load_viscous}, state);
        stored_at_start_j_ = system_.evaluate(state).stored;
        const solver::IntegratorOptions options{v_.solver_relative_tolerance, v_.solver_absolute_scale, v_.solver_maximum_step};
        if (!integrator_.create(system_, 0.0, state, options)) {
            std::snprintf(message.text, sizeof message.text, "%s", integrator_.error());
            return Status::error;
        }
        write_outputs();
        return Status::ok;
    }

    Status step(double time_s, double step_size_s, Message& message) override {
        const double end_s = time_s + step_size_s - start_time_s_;
        change_torques();
        if (!(v_.servo_enabled ? step_with_servo(end_s) : integrator_.advance(end_s))) {
            std::snprintf(message.text, sizeof message.text, "%s", integrator_.error());
            return Status::error;
        }
        write_outputs();
        if (!std::isfinite(v_.energy_stored)) {
            std::snprintf(message.text, sizeof message.text, "the state is no longer finite at t = %.9g s", time_s + step_size_s);
            return Status::error;
        }
        return Status::ok;
    }

private:
    [[nodiscard]] plant::Parameters<double> parameters() const {
        plant::Parameters<double> p{};
        p.motor_inertia = v_.drivetrain_motor_inertia;
        p.drivetrain_stiffness = v_.drivetrain_stiffness;
        p.drivetrain_damping = v_.drivetrain_damping;
        p.gear_coulomb = v_.drivetrain_gear_coulomb;
        p.gear_stiction = v_.drivetrain_gear_stiction;
        p.gear_viscous = v_.drivetrain_gear_viscous;
        p.torque_limit = v_.drivetrain_torque_limit;
        p.roller_torque = v_.load_coulomb;
        p.roller_slope = v_.load_tanh_slope;
        return p;
    }

    [[nodiscard]] Torques wanted_torques() const { return {v_.motor_torque + servo_torque_nm_, v_.environment_torque}; }

    void change_torques() {
        const Torques wanted = wanted_torques();
        const Torques& now = system_.torques();
        if (wanted.motor != now.motor || wanted.environment != now.environment) {
            system_.set_torques(wanted, integrator_.state());
            integrator_.restart();
        }
    }

    void leave_tick() {
        due_ = false;
        servo_torque_nm_ = servo_.regulate(integrator_.state()[motor_angle], v_.servo_reference_angle, v_.servo_reference_speed,
                                           tick_ % servo_ticks_per_cycle == 0);
        change_torques();
    }

    // Ticks are counted in integers; a master's times carry rounding, far below a millionth of a tick.
    bool step_with_servo(double end_s) {
        const double end_ticks = end_s * static_cast<double>(servo_rate_hz);
        constexpr double rounding_ticks = 1e-6;
        while (static_cast<double>(tick_) < end_ticks - rounding_ticks) {
            if (due_) {
                leave_tick();
            }
            const auto next = tick_ + 1;
            const bool reaches = static_cast<double>(next) <= end_ticks + rounding_ticks;
            if (!integrator_.advance(reaches ? static_cast<double>(next) / static_cast<double>(servo_rate_hz) : end_s)) {
                return false;
            }
            if (!reaches) {
                break;
            }
            tick_ = next;
            due_ = true;
        }
        return true;
    }

    void write_outputs() {
        const double* x = integrator_.state();
        const Evaluation e = system_.evaluate(x);
        v_.sensor_torque = e.sensed;
        v_.motor_angle = x[motor_angle];
        v_.motor_speed = x[motor_speed];
        v_.load_angle = x[load_angle];
        v_.load_speed = x[load_speed];
        v_.load_friction = e.friction;
        v_.gear_stuck = system_.stuck();
        v_.servo_torque = servo_torque_nm_;
        v_.energy_stored = e.stored - stored_at_start_j_;
        v_.energy_work_in = x[work_in];
        v_.energy_dissipated = x[dissipated];
        v_.energy_residual = v_.energy_work_in - v_.energy_dissipated - v_.energy_stored;
        const auto statistics = integrator_.statistics();
        v_.events = static_cast<std::int32_t>(statistics.events);
        v_.last_event_time = statistics.events == 0 ? -1.0 : start_time_s_ + integrator_.last_event_time();
        v_.solver_steps = static_cast<std::int32_t>(statistics.steps);
        v_.solver_rhs_calls = static_cast<std::int32_t>(statistics.rhs_calls);
    }

    Variables v_{};
    DrivetrainSystem system_;
    solver::HybridIntegrator integrator_;
    ServoAxis servo_;
    double servo_torque_nm_ = 0.0;
    double start_time_s_ = 0.0;
    double stored_at_start_j_ = 0.0;
    std::int64_t tick_ = 0; // servo ticks since the start
    bool due_ = true;       // the servo has yet to act at this tick
};

} // namespace

} // namespace giveway::drivetrain

giveway::Model* giveway::drivetrain::create_model() { return new (std::nothrow) Drivetrain; }
