// The plant as seen by the solver: state and indicators as plain arrays, modes constant between events.
#pragma once

#include <algorithm>

#include "exchange.hpp"
#include "initial_state.hpp"
#include "jacobian.hpp"
#include "outputs.hpp"

namespace giveway::testbed {

template <int Wheels> class PlantSystemOf final : public ExchangeableSystem {
    using At = plant::Layout<Wheels>;

public:
    // `state` has room for the states of a base that tips; without tipping the rest of it is zero.
    void start(const plant::Parameters<double, Wheels> &parameters, const plant::InitialMotion<double, Wheels> &motion,
               const plant::Inputs<double, Wheels> &inputs, plant::TippingVector<double, Wheels> &state) {
        parameters_ = parameters;
        derive();
        inputs_ = inputs;
        state = {};
        if (tips()) {
            plant::initial_state(motion, inputs_, parameters_, derived_, state, modes_);
        } else {
            plant::StateVector<double, Wheels> planar{};
            plant::initial_state(motion, inputs_, parameters_, derived_, planar, modes_);
            std::copy(planar.begin(), planar.end(), state.begin());
        }
        first_contact_time_s_ = modes_.contact > 0.5 ? 0.0 : -1.0;
    }

    template <class Archive> void archive(Archive &a) {
        a(parameters_);
        a(inputs_);
        a(modes_);
        a(first_contact_time_s_);
    }
    // Computes the values that follow from the parameters, after these were loaded.
    void derive() {
        derived_ = plant::derive(parameters_);
        evaluation_ = {};
        jacobian_.set_parameters(parameters_, derived_);
    }

    void set_inputs(const plant::Inputs<double, Wheels> &inputs, const double *state) {
        inputs_ = inputs;
        with_state(state, [&](const auto &x) { plant::accept_inputs(x, inputs_, modes_, parameters_, derived_); });
    }

    // In continuous time: a gear that breaks away waits for the following event.
    void follow_inputs(const plant::Inputs<double, Wheels> &inputs) { inputs_ = inputs; }

    [[nodiscard]] bool tips() const { return parameters_.base_tipping != 0; }
    // The model ends here: the base is about to fall over.
    [[nodiscard]] bool overturned() const { return modes_.overturned > 0.5; }
    [[nodiscard]] const plant::Modes<double, Wheels> &modes() const { return modes_; }
    [[nodiscard]] const plant::Parameters<double, Wheels> &parameters() const { return parameters_; }
    [[nodiscard]] const plant::Inputs<double, Wheels> &inputs() const { return inputs_; }
    [[nodiscard]] double first_contact_time() const { return first_contact_time_s_; }
    [[nodiscard]] plant::Outputs<double, Wheels> outputs(const double *state) const {
        plant::Outputs<double, Wheels> result{};
        with_state(state, [&](const auto &x) { result = plant::outputs(x, inputs_, modes_, parameters_, derived_); });
        return result;
    }

    [[nodiscard]] int state_count() const override { return tips() ? At::tipping_state_count : At::state_count; }
    [[nodiscard]] int event_count() const override { return tips() ? At::tipping_event_count : At::event_count; }

    void rhs(double, const double *state, double *rate) override {
        with_state(state, [&](const auto &x) { write_rate(x, rate); });
    }

    bool jacobian(double, const double *state, double *matrix) override {
        with_state(state, [&](const auto &x) { jacobian_.evaluate(x, inputs_, modes_, matrix); });
        return true;
    }

    void indicators(double, const double *state, double *value) override {
        with_state(state, [&](const auto &x) {
            const auto indicator = plant::event_indicators(x, inputs_, modes_, parameters_, derived_);
            std::copy(indicator.begin(), indicator.end(), value);
        });
    }

    void transition(double time_s, double *state, const int *fired) override {
        with_state(state, [&](const auto &x) {
            decltype(plant::event_indicators(x, inputs_, modes_, parameters_, derived_)) direction{};
            std::copy_n(fired, direction.size(), direction.begin());
            auto next = x;
            plant::transition(next, inputs_, modes_, direction, parameters_, derived_);
            std::copy(next.begin(), next.end(), state);
        });
        if (first_contact_time_s_ < 0.0 && modes_.contact > 0.5) {
            first_contact_time_s_ = time_s;
        }
    }

    [[nodiscard]] int side(int event) const override {
        if (of_wheels(At::event_floor, event)) {
            return above(modes_.on_floor[static_cast<std::size_t>(event - At::event_floor)]);
        }
        switch (event) {
        case At::event_contact:
            return above(modes_.contact);
        case At::event_rope:
            return above(modes_.rope_taut);
        case At::event_end_stop:
            return plant::bumper_holds(parameters_) ? 1 : -above(modes_.end_stop);
        case At::event_bottom_stop:
            return above(modes_.bottom_stop);
        case At::event_landing:
            return above(modes_.landed);
        case At::event_wall:
            return above(modes_.walled);
        case At::event_tilt:
            return -above(modes_.overturned);
        default:
            return 1;
        }
    }

    [[nodiscard]] double hysteresis(int event) const override {
        if (of_wheels(At::event_gear, event)) {
            const bool stuck = math::abs(modes_.gear_direction[static_cast<std::size_t>(event)]) < 0.5;
            return stuck ? 1e-8  // N m
                         : 1e-7; // rad/s
        }
        if (event == At::event_tilt) {
            return 1e-9; // of the cosine of the tilt
        }
        return event == At::event_end_stop && modes_.latched > 0.5 ? 1e-6  // N
                                                                   : 1e-9; // m, rad
    }

    [[nodiscard]] double absolute_tolerance(int state) const override {
        constexpr double speed = 1e-8; // m/s, rad/s
        if (of_wheels(At::motor_speed, state) || of_wheels(At::wheel_spin, state)) {
            return speed;
        }
        switch (state) {
        case At::base_vx:
        case At::base_vy:
        case At::base_omega:
        case At::slider_speed:
        case At::weight_speed:
        case At::compression_rate:
        case At::heave_rate:
        case At::body_roll_rate:
        case At::body_pitch_rate:
            return speed;
        case At::work_in:
        case At::dissipated:
        case At::impulse_x:
        case At::impulse_y:
            return 1e-7; // J, N s: accounts, which nothing else depends on
        default:
            return 1e-9; // m, rad
        }
    }

private:
    // Whether it is one of those that each wheel has from `first` on.
    static bool of_wheels(int first, int index) { return index >= first && index < first + Wheels; }
    static int above(double mode) { return mode > 0.5 ? 1 : -1; }

    // `state`: state_count() doubles. Calls use(x) with the plant's state type.
    template <class Use> void with_state(const double *state, Use use) const {
        if (tips()) {
            use(*reinterpret_cast<const plant::TippingVector<double, Wheels> *>(state));
        } else {
            use(*reinterpret_cast<const plant::StateVector<double, Wheels> *>(state));
        }
    }

    // In one piece, and into an evaluation that is not cleared each time: 9 % of the instructions of an event-exact
    // run.
    [[gnu::noinline, gnu::flatten]] void write_rate(const plant::StateVector<double, Wheels> &x, double *rate) {
        plant::evaluate_into(evaluation_, x, inputs_, modes_, parameters_, derived_);
        std::copy(evaluation_.rate.begin(), evaluation_.rate.end(), rate);
    }
    void write_rate(const plant::TippingVector<double, Wheels> &x, double *rate) {
        const auto value = plant::rhs(x, inputs_, modes_, parameters_, derived_);
        std::copy(value.begin(), value.end(), rate);
    }

    plant::Parameters<double, Wheels> parameters_{};
    plant::Derived<double> derived_{};
    plant::Evaluation<double, Wheels> evaluation_{}; // room for rhs(): nothing of it is read from one call to the next
    plant::Jacobian<Wheels> jacobian_;
    plant::Inputs<double, Wheels> inputs_{};
    plant::Modes<double, Wheels> modes_{};
    double first_contact_time_s_ = -1.0;
};

using PlantSystem = PlantSystemOf<plant::table_wheels>;

} // namespace giveway::testbed
