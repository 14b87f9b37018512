// The drivetrain of Fig. 6 behind the model interface, optionally with the servo of the drives.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <new>

#include "drivetrain_system.hpp"
#include "drivetrain_plant_parameters.hpp"
#include "drivetrain_variables.hpp"
#include "exchange.hpp"
#include "hybrid_integrator.hpp"
#include "integrated.hpp"
#include "model.hpp"
#include "servo_axis.hpp"
#include "state_archive.hpp"
#include "times.hpp"

namespace giveway::drivetrain {

namespace {

class Drivetrain final : public Model, public Equations {
public:
    Drivetrain() { set_start_values(v_); }

    void *variables() override { return &v_; }
    Equations *equations() override { return this; }

    void reset() override {
        v_ = {};
        set_start_values(v_);
        running_ = false;
    }

    // All members except those that resume() restores.
    template <class Archive> void archive(Archive &a) {
        a(v_);
        a(running_);
        if (!running_) {
            return;
        }
        if constexpr (std::is_same_v<Archive, StateWriter>) {
            checkpoint_ = integrator_.checkpoint();
            std::copy_n(integrator_.state(), checkpoint_state_.size(), checkpoint_state_.begin());
        }
        a(checkpoint_);
        a(checkpoint_state_);
        system_.archive(a);
        a(servo_);
        a(servo_torque_nm_);
        a(sampled_torque_nm_);
        a(start_time_s_);
        a(stored_at_start_j_);
        a(tick_);
        a(due_);
        a(now_s_);
        a(events_.last_s);
        a(events_.count);
        a(exchanging_);
    }

    std::size_t save_state(void *bytes) override { return save_archive(*this, bytes); }

    Status load_state(const void *bytes, std::size_t size, Message &message) override {
        const Status status = load_archive(*this, bytes, size, message);
        return status == Status::ok ? resume(message) : status;
    }

    Status initialise(double start_time_s, Message &message) override {
        if (v_.drivetrain_gear_stiction < v_.drivetrain_gear_coulomb) {
            std::snprintf(
                message.text, sizeof message.text,
                "drivetrain.gear_stiction = %.9g is not allowed: it must be at least drivetrain.gear_coulomb = %.9g",
                v_.drivetrain_gear_stiction, v_.drivetrain_gear_coulomb);
            return Status::error;
        }
        start_time_s_ = start_time_s;
        tick_ = 0;
        due_ = true;
        servo_torque_nm_ = 0.0;
        sampled_torque_nm_ = 0.0;
        now_s_ = 0.0;
        events_ = {};
        exchanging_ = false;
        const auto refused = servo_.start({v_.servo_kp, v_.servo_kd, v_.drivetrain_torque_limit,
                                           v_.servo_derivative_cutoff, v_.servo_encoder_counts, v_.servo_delay});
        if (refused.field != GW_FIELD_NONE) {
            std::snprintf(message.text, sizeof message.text, "%s = %.9g is not allowed: [%.9g, %.9g]",
                          gw_config_name(refused.field), static_cast<double>(refused.value),
                          static_cast<double>(refused.minimum), static_cast<double>(refused.maximum));
            return Status::error;
        }
        const double state[state_count] = {
            v_.start_motor_angle, v_.start_motor_speed, v_.start_load_angle, v_.start_load_speed, 0.0, 0.0};
        system_.start(parameters(), {v_.load_inertia, v_.load_viscous}, state);
        stored_at_start_j_ = system_.evaluate(state).stored;
        if (!integrator_.create(system_, 0.0, state, solver_options(v_, start_time_s_))) {
            return failure(integrator_, message);
        }
        running_ = true;
        write_outputs();
        return Status::ok;
    }

    Status step(double time_s, double step_size_s, Message &message) override {
        const double end_s = time_s + step_size_s - start_time_s_;
        change_torques();
        integrator_.restart(); // so that the state of a step needs no history of the integration
        if (!(v_.servo_enabled ? step_with_servo(end_s) : integrator_.advance(end_s))) {
            write_outputs(); // the last good state
            return failure(integrator_, message);
        }
        write_outputs();
        if (!std::isfinite(v_.energy_stored)) {
            std::snprintf(message.text, sizeof message.text, "the state is no longer finite at t = %.9g s",
                          time_s + step_size_s);
            return Status::error;
        }
        return Status::ok;
    }

    void set_time(double time_s) override {
        now_s_ = time_s - start_time_s_;
        exchanging_ = true;
    }
    double *states() override { return integrator_.state(); }

    void derivatives(double *values) override {
        follow_torques();
        system_.rhs(now_s_, states(), values);
    }

    void indicators(double *values) override {
        follow_torques();
        margins(system_, now_s_, states(), values);
    }

    Status update_events(EventUpdate &update, Message &message) override {
        // First the effects of the torques before this instant, then the new torques.
        if (!settle_now(update, message)) {
            return Status::error;
        }
        const double held_nm = servo_torque_nm_;
        if (v_.servo_enabled && !reach_tick(message)) {
            return Status::error;
        }
        update.discontinuity = update.discontinuity || servo_torque_nm_ != held_nm;
        change_torques();
        if (!settle_now(update, message)) {
            return Status::error;
        }
        update.has_next_time = v_.servo_enabled;
        update.next_time_s = start_time_s_ + static_cast<double>(tick_ + 1) / static_cast<double>(servo_rate_hz);
        return Status::ok;
    }

    void write_outputs() override {
        const double *x = integrator_.state();
        const Evaluation e = system_.evaluate(x);
        v_.sensor_torque = e.sensed;
        v_.motor_angle = x[motor_angle];
        v_.motor_speed = x[motor_speed];
        v_.load_angle = x[load_angle];
        v_.load_speed = x[load_speed];
        v_.load_friction = e.friction;
        v_.gear_stuck = system_.stuck();
        v_.servo_torque = servo_torque_nm_;
        v_.sensor_motor_torque = sampled_torque_nm_;
        v_.energy_stored = e.stored - stored_at_start_j_;
        v_.energy_work_in = x[work_in];
        v_.energy_dissipated = x[dissipated];
        v_.energy_residual = v_.energy_work_in - v_.energy_dissipated - v_.energy_stored;
        write_statistics(v_, integrator_, events_, start_time_s_);
    }

private:
    // Time in ticks, `since_start_s` after the start; the start time may be much larger than that.
    [[nodiscard]] double rounding_at(double since_start_s) const {
        return tick_tolerance(std::max(std::fabs(start_time_s_ + since_start_s), std::fabs(start_time_s_)),
                              static_cast<double>(servo_rate_hz));
    }

    Status resume(Message &message) {
        if (running_ &&
            !integrator_.resume(system_, checkpoint_, checkpoint_state_.data(), solver_options(v_, start_time_s_))) {
            return failure(integrator_, message);
        }
        return Status::ok;
    }

    // Co-Simulation reads its torques at the start of a step.
    void follow_torques() {
        if (exchanging_) {
            system_.follow_torques(wanted_torques());
        }
    }

    bool settle_now(EventUpdate &update, Message &message) {
        return settle_events(system_, now_s_, states(), start_time_s_, events_, update, message);
    }

    // Processes the present tick, if there is one. The importer has to stop at each tick.
    bool reach_tick(Message &message) {
        const double now_ticks = now_s_ * static_cast<double>(servo_rate_hz);
        const double rounding_ticks = rounding_at(now_s_);
        if (!due_ && now_ticks >= static_cast<double>(tick_ + 1) - rounding_ticks) {
            ++tick_;
            due_ = true;
            sample_current();
        }
        if (now_ticks > static_cast<double>(tick_) + 1.0 - rounding_ticks) {
            std::snprintf(message.text, sizeof message.text,
                          "the event at t = %.9g s was passed over; it is now t = %.9g s",
                          start_time_s_ + static_cast<double>(tick_) / static_cast<double>(servo_rate_hz),
                          start_time_s_ + now_s_);
            return false;
        }
        if (due_) {
            leave_tick();
        }
        return true;
    }

    [[nodiscard]] plant::Parameters<double> parameters() const {
        plant::Parameters<double> p{};
        read_plant_parameters(v_, p);
        p.roller_coulomb_torque = v_.load_coulomb;
        p.roller_tanh_slope = v_.load_tanh_slope;
        return p;
    }

    [[nodiscard]] Torques wanted_torques() const { return {v_.motor_torque + servo_torque_nm_, v_.environment_torque}; }

    void change_torques() {
        const Torques wanted = wanted_torques();
        const Torques &now = system_.torques();
        if (wanted.motor != now.motor || wanted.environment != now.environment) {
            system_.set_torques(wanted, integrator_.state());
            integrator_.restart();
        }
    }

    // At each cycle of the bus, before the servo acts: the same in Co-Simulation, which gets there at the end of a
    // step, and for an importer that integrates.
    void sample_current() {
        if (tick_ % servo_ticks_per_cycle == 0) {
            sampled_torque_nm_ = servo_torque_nm_;
        }
    }

    void leave_tick() {
        due_ = false;
        servo_torque_nm_ = servo_.regulate(integrator_.state()[motor_angle], v_.servo_reference_angle,
                                           v_.servo_reference_speed, tick_ % servo_ticks_per_cycle == 0);
        change_torques();
    }

    bool step_with_servo(double end_s) {
        const double end_ticks = end_s * static_cast<double>(servo_rate_hz);
        const double rounding_ticks = rounding_at(end_s);
        while (static_cast<double>(tick_) < end_ticks - rounding_ticks) {
            if (due_) {
                leave_tick();
            }
            const auto next = tick_ + 1;
            const bool reaches = static_cast<double>(next) <= end_ticks + rounding_ticks;
            if (!integrator_.advance(reaches ? static_cast<double>(next) / static_cast<double>(servo_rate_hz)
                                             : end_s)) {
                return false;
            }
            if (!reaches) {
                break;
            }
            tick_ = next;
            due_ = true;
            sample_current();
        }
        return true;
    }

    Variables v_{};
    DrivetrainSystem system_;
    solver::HybridIntegrator integrator_;
    ServoAxis servo_;
    double servo_torque_nm_ = 0.0;
    double sampled_torque_nm_ = 0.0;
    double start_time_s_ = 0.0;
    double stored_at_start_j_ = 0.0;
    std::int64_t tick_ = 0; // servo ticks since the start
    bool due_ = true;       // the servo has yet to act at this tick
    // Model Exchange.
    double now_s_ = 0.0; // since the start
    ExchangedEvents events_;
    bool exchanging_ = false;
    // State.
    bool running_ = false; // initialised
    solver::Checkpoint checkpoint_{};
    std::array<double, state_count> checkpoint_state_{};
};

} // namespace

} // namespace giveway::drivetrain

giveway::Model *giveway::drivetrain::create_model() { return new (std::nothrow) Drivetrain; }
