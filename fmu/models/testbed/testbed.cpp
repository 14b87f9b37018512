// The testbed: plant, solver and drive electronics behind the model interface.
//
// Time runs in servo ticks of 0.5 ms. On arrival at a bus tick the sensors are sampled; on leaving it the command is
// read. So sensor outputs at the end of a step belong to that instant (minus the bus delay), and the command set before
// the next step acts from there on.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <new>

#include "exchange.hpp"
#include "hybrid_integrator.hpp"
#include "integrated.hpp"
#include "model.hpp"
#include "start.hpp"
#include "state_archive.hpp"
#include "testbed_variables.hpp"
#include "times.hpp"
#include "truth.hpp"

namespace giveway::testbed {

namespace {

class Testbed final : public Model, public Equations {
public:
    Testbed() { set_start_values(v_); }

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
            checkpoint_state_ = whole_state();
        }
        a(checkpoint_);
        a(checkpoint_state_);
        system_.archive(a);
        a(drives_);
        a(imu_);
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
        plant::TippingVector<double> state{};
        if (!start_run(v_, system_, state, drives_, imu_, stored_at_start_j_, message)) {
            return Status::error;
        }
        start_time_s_ = start_time_s;
        tick_ = 0;
        due_ = true;
        now_s_ = 0.0;
        events_ = {};
        exchanging_ = false;
        if (!integrator_.create(system_, 0.0, state.data(), solver_options(v_, start_time_s_))) {
            return failure(integrator_, message);
        }
        running_ = true;
        sample_sensors();
        write_outputs();
        return Status::ok;
    }

    Status step(double time_s, double step_size_s, Message &message) override {
        const double end_s = time_s + step_size_s - start_time_s_;
        const double end_ticks = end_s * static_cast<double>(servo_rate_hz);
        const double rounding_ticks = rounding_at(end_s);
        change_push();
        integrator_.restart(); // so that the state of a step needs no history of the integration
        while (static_cast<double>(tick_) < end_ticks - rounding_ticks) {
            if (due_) {
                leave_tick();
            }
            const auto next = tick_ + 1;
            const bool reaches = static_cast<double>(next) <= end_ticks + rounding_ticks;
            const double until_s = reaches ? static_cast<double>(next) / static_cast<double>(servo_rate_hz) : end_s;
            if (!integrator_.advance(until_s)) {
                write_outputs(); // the last good state
                return failure(integrator_, message);
            }
            if (system_.overturned()) {
                write_outputs();
                return tell_overturned(start_time_s_ + integrator_.last_event_time(), message);
            }
            if (!reaches) {
                break;
            }
            tick_ = next;
            due_ = true;
            if (tick_ % servo_ticks_per_cycle == 0) {
                sample_sensors();
            }
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
        exchange_state_ = whole_state();
        exchanging_ = true;
    }
    // All states of the model description; without tipping, those after the planar ones are never read or changed.
    double *states() override {
        exchange_state_ = whole_state();
        return exchange_state_.data();
    }

    void derivatives(double *values) override {
        follow_push();
        std::fill_n(values, plant::Layout<>::tipping_state_count, 0.0);
        system_.rhs(now_s_, state(), values);
    }

    void indicators(double *values) override {
        follow_push();
        std::fill_n(values, plant::Layout<>::tipping_event_count, 1.0);
        margins(system_, now_s_, state(), values);
    }

    Status update_events(EventUpdate &update, Message &message) override {
        // First the effects of the inputs before this instant, then the tick and the new inputs.
        if (!settle_now(update, message) || !pass_tick(update, message)) {
            return Status::error;
        }
        system_.set_inputs(plant_inputs(v_, system_.inputs().motor_torque), state());
        if (!settle_now(update, message)) {
            return Status::error;
        }
        if (system_.overturned()) {
            return tell_overturned(start_time_s_ + now_s_, message);
        }
        update.has_next_time = true;
        update.next_time_s =
            start_time_s_ + static_cast<double>(due_ ? tick_ : tick_ + 1) / static_cast<double>(servo_rate_hz);
        return Status::ok;
    }

    void write_outputs() override {
        follow_push();
        const double *x = state();
        write_truth(v_, x, system_.outputs(x), system_.modes(), system_.parameters(), system_.inputs().motor_torque,
                    {start_time_s_, system_.first_contact_time()}, stored_at_start_j_);
        write_statistics(v_, integrator_, events_, start_time_s_);
    }

private:
    // Time in ticks, `since_start_s` after the start; the start time may be much larger than that.
    [[nodiscard]] double rounding_at(double since_start_s) const {
        return tick_tolerance(std::max(std::fabs(start_time_s_ + since_start_s), std::fabs(start_time_s_)),
                              static_cast<double>(servo_rate_hz));
    }

    Status resume(Message &message) {
        if (running_) {
            system_.derive();
            exchange_state_ = checkpoint_state_;
            if (!integrator_.resume(system_, checkpoint_, checkpoint_state_.data(),
                                    solver_options(v_, start_time_s_))) {
                return failure(integrator_, message);
            }
        }
        return Status::ok;
    }

    static Status tell_overturned(double time_s, Message &message) {
        std::snprintf(
            message.text, sizeof message.text,
            "the robot tips over: at t = %.9g s it leans by more than 15 deg, beyond which base.tipping has no model",
            time_s);
        return Status::error;
    }

    // The states that are integrated, by the importer or by us.
    double *state() { return exchanging_ ? exchange_state_.data() : integrator_.state(); }

    plant::TippingVector<double> whole_state() {
        plant::TippingVector<double> whole = exchange_state_;
        if (!exchanging_) {
            whole = {};
            std::copy_n(integrator_.state(), system_.state_count(), whole.begin());
        }
        return whole;
    }

    // Co-Simulation reads a push at the start of a step.
    void follow_push() {
        if (exchanging_) {
            system_.follow_inputs(plant_inputs(v_, system_.inputs().motor_torque));
        }
    }

    bool settle_now(EventUpdate &update, Message &message) {
        return settle_events(system_, now_s_, state(), start_time_s_, events_, update, message);
    }

    // The importer has to stop at each tick. At a bus tick the sensors are updated first, and the command in another
    // update, after the sensor values have been passed on.
    bool pass_tick(EventUpdate &update, Message &message) {
        const double now_ticks = now_s_ * static_cast<double>(servo_rate_hz);
        const double rounding_ticks = rounding_at(now_s_);
        if (!due_ && now_ticks >= static_cast<double>(tick_ + 1) - rounding_ticks) {
            ++tick_;
            due_ = true;
            if (tick_ % servo_ticks_per_cycle == 0) {
                sample_sensors();
                update.again = true;
            }
        }
        if (due_ && !update.again) {
            const auto held = system_.inputs().motor_torque;
            leave_tick();
            update.discontinuity = update.discontinuity || system_.inputs().motor_torque != held;
        }
        if (now_ticks > static_cast<double>(tick_) + 1.0 - rounding_ticks) {
            std::snprintf(message.text, sizeof message.text,
                          "the event at t = %.9g s was passed over; it is now t = %.9g s",
                          start_time_s_ + static_cast<double>(tick_) / static_cast<double>(servo_rate_hz),
                          start_time_s_ + now_s_);
            return false;
        }
        return true;
    }

    // A new push also acts from the start of a step that does not start on a tick.
    void change_push() {
        const auto &now = system_.inputs();
        if (v_.push_force_x != now.push_force_x || v_.push_force_y != now.push_force_y ||
            v_.push_point_x != now.push_point_x || v_.push_point_y != now.push_point_y) {
            system_.set_inputs(plant_inputs(v_, now.motor_torque), integrator_.state());
            integrator_.restart();
        }
    }

    void leave_tick() {
        due_ = false;
        if (tick_ % servo_ticks_per_cycle == 0) {
            drives_.receive(bus_command(v_));
        }
        system_.set_inputs(plant_inputs(v_, drives_.regulate(motor_angles(state()))), state());
        integrator_.restart();
    }

    void sample_sensors() {
        const auto truth = system_.outputs(state());
        write_sensors(v_, drives_.sample(motor_angles(state()), truth.wheel_torque));
        if (imu_.options().present) {
            write_imu(v_, imu_.sample(imu_truth(truth)));
        }
    }

    Variables v_{};
    PlantSystem system_;
    solver::HybridIntegrator integrator_;
    Drives drives_;
    Imu imu_;
    double start_time_s_ = 0.0;
    double stored_at_start_j_ = 0.0;
    std::int64_t tick_ = 0; // servo ticks since the start
    bool due_ = true;       // the servo has yet to act at this tick
    // Model Exchange.
    double now_s_ = 0.0; // since the start
    ExchangedEvents events_;
    bool exchanging_ = false;
    plant::TippingVector<double> exchange_state_{};
    // State.
    bool running_ = false; // initialised
    solver::Checkpoint checkpoint_{};
    plant::TippingVector<double> checkpoint_state_{};
};

} // namespace

} // namespace giveway::testbed

giveway::Model *giveway::testbed::create_model() { return new (std::nothrow) Testbed; }
