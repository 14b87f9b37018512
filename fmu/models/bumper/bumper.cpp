// The bumper behind the model interface: motion of its two faces in, forces on them out.
//
// Co-Simulation extrapolates the faces with their velocities over a step, so that stops and latch act within a step and
// the force at its end is that of the predicted position.
#include <algorithm>
#include <array>
#include <cmath>
#include <new>

#include "bumper_system.hpp"
#include "bumper_plant_parameters.hpp"
#include "bumper_relations.hpp"
#include "bumper_variables.hpp"
#include "exchange.hpp"
#include "hybrid_integrator.hpp"
#include "integrated.hpp"
#include "model.hpp"
#include "state_archive.hpp"

namespace giveway::bumper {

namespace {

class Bumper final : public Model, public Equations {
public:
    Bumper() { set_start_values(v_); }

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
        a(start_time_s_);
        a(stored_at_start_j_);
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
        start_time_s_ = start_time_s;
        now_s_ = 0.0;
        events_ = {};
        exchanging_ = false;
        if (!check_bumper(parameters(), message)) {
            return Status::error;
        }
        system_.start(parameters());
        system_.set_faces(faces(), 0.0);
        stored_at_start_j_ = system_.force(0.0).stored;
        const double state[state_count] = {};
        if (!integrator_.create(system_, 0.0, state, solver_options(v_, start_time_s_))) {
            return failure(integrator_, message);
        }
        running_ = true;
        write_outputs_now();
        return Status::ok;
    }

    Status step(double time_s, double step_size_s, Message &message) override {
        system_.set_faces(faces(), integrator_.time());
        integrator_.restart();
        const bool advanced = integrator_.advance(time_s + step_size_s - start_time_s_);
        now_s_ = integrator_.time(); // time of the last good state, after a failure
        write_outputs_now();
        if (!advanced) {
            return failure(integrator_, message);
        }
        return Status::ok;
    }

    void set_time(double time_s) override {
        now_s_ = time_s - start_time_s_;
        exchanging_ = true;
    }
    double *states() override { return integrator_.state(); }

    void derivatives(double *values) override {
        follow_faces();
        system_.rhs(now_s_, states(), values);
    }

    void indicators(double *values) override {
        follow_faces();
        margins(system_, now_s_, states(), values);
    }

    void write_outputs() override {
        follow_faces();
        write_outputs_now();
    }

    Status update_events(EventUpdate &update, Message &message) override {
        // First the effects of the motion before this instant, then the new motion.
        if (!settle_events(system_, now_s_, states(), start_time_s_, events_, update, message)) {
            return Status::error;
        }
        system_.set_faces(faces(), now_s_);
        return Status::ok;
    }

private:
    Status resume(Message &message) {
        if (running_ &&
            !integrator_.resume(system_, checkpoint_, checkpoint_state_.data(), solver_options(v_, start_time_s_))) {
            return failure(integrator_, message);
        }
        return Status::ok;
    }

    // Co-Simulation extrapolates the faces itself.
    void follow_faces() {
        if (exchanging_) {
            system_.follow_faces(faces(), now_s_);
        }
    }

    [[nodiscard]] Faces faces() const {
        return {v_.carrier_position, v_.carrier_velocity, v_.plate_position, v_.plate_velocity};
    }

    [[nodiscard]] plant::Parameters<double> parameters() const {
        plant::Parameters<double> p{};
        read_plant_parameters(v_, p);
        return p;
    }

    void write_outputs_now() {
        const double *x = integrator_.state();
        const auto bumper = system_.force(now_s_);
        v_.carrier_force = -bumper.force;
        v_.plate_force = bumper.force;
        v_.compression = system_.compression(now_s_);
        v_.compression_rate = system_.compression_rate();
        v_.latched = system_.latched(now_s_);
        v_.end_stop = system_.end_stop();
        v_.bottom_stop = system_.bottom_stop();
        v_.energy_stored = bumper.stored - stored_at_start_j_;
        v_.energy_work_in = x[work_in];
        v_.energy_dissipated = x[dissipated];
        v_.energy_residual = v_.energy_work_in - v_.energy_dissipated - v_.energy_stored;
        write_statistics(v_, integrator_, events_, start_time_s_);
    }

    Variables v_{};
    BumperSystem system_;
    solver::HybridIntegrator integrator_;
    double start_time_s_ = 0.0;
    double stored_at_start_j_ = 0.0;
    double now_s_ = 0.0; // since the start
    // Model Exchange.
    ExchangedEvents events_;
    bool exchanging_ = false;
    // State.
    bool running_ = false; // initialised
    solver::Checkpoint checkpoint_{};
    std::array<double, state_count> checkpoint_state_{};
};

} // namespace

} // namespace giveway::bumper

giveway::Model *giveway::bumper::create_model() { return new (std::nothrow) Bumper; }
