// LanePlant for N lanes: the plant's equations in Lanes<N>, the classic Runge-Kutta method of order 4, modes that
// change at step ends. Included by one file per width, compiled for the processors that have it; nothing here is to be
// used by code for all processors.
#pragma once

#include <cstring>
#include <new>

#include "convert.hpp"
#include "lane_plant.hpp"

namespace giveway::batch {

// Where a number of the first design is; those of the others follow at the distance of a whole design. As a scalar type
// it makes convert() gather designs into lanes.
template <int N> struct Strided {
    const double *first = nullptr;
    Strided() = default;
    explicit Strided(const double &number) : first(&number) {}

    explicit operator math::Lanes<N>() const {
        double row[N];
        std::size_t at = 0; // bytes
        for (double &number : row) {
            std::memcpy(&number, reinterpret_cast<const unsigned char *>(first) + at, sizeof number);
            at += sizeof(LaneStart);
        }
        return math::Lanes<N>::load(row);
    }
};

// Contacts, stops and the rope check themselves whether they act; their modes only report it. A mode that decides, that
// of a gear or of an idealised latch, also changes at the end of a step, and the step is corrected: the instant at
// which the indicator was zero and the state there are interpolated, the mode changes there, and the rest of the step
// is repeated. So is the roller on which a wheel stands.
template <int N> class LanePlantOf final : public LanePlant {
    using L = math::Lanes<N>;
    using State = plant::StateVector<L>;
    using Evaluation = plant::Evaluation<L>;
    using Events = plant::EventVector<L>;
    using At = plant::Layout<>;

public:
    [[nodiscard]] int lanes() const override { return N; }

    void start(const LaneStart *designs) override {
        p_ = plant::convert<L>(plant::convert<Strided<N>>(designs[0].parameters));
        d_ = plant::derive(p_);
        x_ = plant::detail::converted<L>(plant::detail::converted<Strided<N>>(designs[0].state));
        m_ = plant::convert<L>(plant::convert<Strided<N>>(designs[0].modes));
        u_ = plant::convert<L>(plant::convert<Strided<N>>(designs[0].inputs));
        first_contact_ = L(Strided<N>(designs[0].first_contact_s));
        events_ = L(0.0);
        last_event_ = L(-1.0);
        now_s_ = 0.0;
        last_step_s_ = 0.0;
        stages_ = {};
        restart_ = {};
        present_ = {};
        evaluated_ = false;
        torques_are_new_ = false;
        // The existing elements.
        const auto there = [](bool yes) { return L(yes ? 1.0 : 0.0); };
        const bool rope = p_.slider_present != 0 && p_.rope_attached != 0;
        const bool plate = p_.slider_present != 0 && p_.has_plate();
        there_ = {.gear_direction = {},
                  .contact = there(p_.slider_present != 0),
                  .rope_taut = there(rope),
                  .end_stop = there(plate && !plant::bumper_holds(p_)),
                  .bottom_stop = there(plate),
                  .latched = L(0.0),
                  .landed = there(rope),
                  .walled = there(p_.slider_present != 0 && p_.wall_present != 0)};
        observe();
    }

    void set_motor_torques(const double *rows) override {
        for (std::size_t i = 0; i < u_.motor_torque.size(); ++i) {
            u_.motor_torque[i] = L::load(rows + i * N);
        }
        torques_are_new_ = true;
    }

    void set_pushes(const double *rows) override {
        L *const pushes[] = {&u_.push_force_x, &u_.push_force_y, &u_.push_point_x, &u_.push_point_y};
        for (L *const push : pushes) {
            evaluated_ = evaluated_ && std::memcmp(push, rows, sizeof *push) == 0;
            *push = L::load(rows);
            rows += N;
        }
    }

    [[gnu::flatten]] void advance(int count, double step_s) override {
        const double start_s = now_s_;
        for (int step = 1; step <= count; ++step) {
            const Evaluation &e = settled();
            before_ = x_;
            rate_before_ = e.rate;
            indicators_before_ = plant::event_indicators(e, x_, m_, p_, d_);
            acted_ = u_;
            move(x_, before_, rate_before_, L(step_s), u_);
            evaluated_ = false;
            last_step_s_ = step_s;
            now_s_ = start_s + static_cast<double>(step) * step_s;
        }
    }

    [[gnu::flatten]] void observe() override { outputs_ = plant::outputs(settled(), x_, p_, d_); }

    [[nodiscard]] const double *state() const override { return rows(x_); }
    [[nodiscard]] const double *modes() const override { return rows(m_); }
    [[nodiscard]] const double *outputs() const override { return rows(outputs_); }
    [[nodiscard]] const double *first_contact_s() const override { return rows(first_contact_); }
    [[nodiscard]] const double *events() const override { return rows(events_); }
    [[nodiscard]] const double *last_event_s() const override { return rows(last_event_); }

private:
    template <class Block> static const double *rows(const Block &block) {
        return reinterpret_cast<const double *>(&block);
    }

    // Not inlined, so that all callers share one copy in the instruction cache.
    [[gnu::noinline, gnu::flatten]] void evaluate(Evaluation &e, const State &x, const plant::Inputs<L> &u) {
        there_.gear_direction = m_.gear_direction;
        there_.latched = m_.latched;
        if (plant::discrete(p_)) {
            there_.roller = m_.roller;
            there_.roller_offset = m_.roller_offset;
            there_.roller_friction = m_.roller_friction;
        }
        plant::evaluate_into(e, x, u, there_, p_, d_);
    }

    // One step of the classic Runge-Kutta method from x, where the rate is `rate`, to `next`.
    void move(State &next, const State &x, const State &rate, L step_s, const plant::Inputs<L> &u) {
        const L sixth = L(1.0 / 6.0) * step_s;
        const L third = L(1.0 / 3.0) * step_s;
        const L half = L(0.5) * step_s;
        State reached;
        const L reaches[] = {half, half, step_s};
        const State *from = &rate;
        for (std::size_t stage = 0; stage < stages_.size(); ++stage) {
            for (std::size_t i = 0; i < x.size(); ++i) {
                reached[i] = x[i] + reaches[stage] * (*from)[i];
            }
            evaluate(stages_[stage], reached, u);
            from = &stages_[stage].rate;
        }
        for (std::size_t i = 0; i < x.size(); ++i) {
            next[i] = (((x[i] + sixth * rate[i]) + third * stages_[0].rate[i]) + third * stages_[1].rate[i]) +
                      sixth * stages_[2].rate[i];
        }
    }

    // Everything at the present state and inputs, after the mode changes that are due. A lane in which none is due
    // keeps its bits.
    const Evaluation &settled() {
        if (!evaluated_) {
            evaluate(present_, x_, u_);
            evaluated_ = true;
        }
        if (last_step_s_ > 0.0) {
            if (change_modes()) {
                evaluate(present_, x_, u_);
            }
            last_step_s_ = 0.0;
        }
        if (torques_are_new_) {
            // As accept_inputs() of the plant.
            const auto before = m_.gear_direction;
            L changed(0.0);
            for (int i = 0; i < plant::table_wheels; ++i) {
                plant::break_away(u_, m_, p_, i, present_.sensed_torque[i]);
                changed = changed + math::abs(m_.gear_direction[i] - before[i]);
            }
            if (any(math::less(L(0.0), changed))) {
                evaluate(present_, x_, u_);
            } else {
                plant::drive_motors(present_, x_, u_, m_, p_);
            }
            torques_are_new_ = false;
        }
        return present_;
    }

    // Mode changes after the last step. True if the state or a deciding mode has changed, so that present_ has to be
    // computed again.
    // Long because modes that report and modes that decide are told apart on the same indicators, lane by lane.
    bool change_modes() {
        Evaluation &end = present_;
        const L zero(0.0);
        const L one(1.0);
        // The gears with the torques that acted during the step.
        const auto net_torque = end.net_torque;
        for (int i = 0; i < plant::table_wheels; ++i) {
            end.net_torque[i] = plant::net_motor_torque(p_, acted_.motor_torque[i], end.sensed_torque[i]);
        }
        const Events g = plant::event_indicators(end, x_, m_, p_, d_);

        // The modes that only report.
        Events reported{};
        const auto follow = [&](int event, L mode) {
            reported[event] = math::select(math::less(zero, g[event]), one, zero) - mode;
        };
        follow(At::event_contact, m_.contact);
        follow(At::event_rope, m_.rope_taut);
        follow(At::event_bottom_stop, m_.bottom_stop);
        follow(At::event_landing, m_.landed);
        follow(At::event_wall, m_.walled);
        if (!plant::bumper_holds(p_)) {
            follow(At::event_end_stop, one - m_.end_stop);
        }
        // The modes that decide.
        std::array<int, 2 * plant::table_wheels + 1> deciding{};
        int deciding_count = 0;
        for (int i = 0; i < plant::table_wheels; ++i) {
            deciding[deciding_count++] = At::event_gear + i;
        }
        if (plant::bumper_holds(p_)) {
            deciding[deciding_count++] = At::event_end_stop;
        }
        if (plant::discrete(p_)) {
            for (int i = 0; i < plant::table_wheels; ++i) {
                deciding[deciding_count++] = At::event_roller + i;
            }
        }
        L lowest = zero;
        for (int k = 0; k < deciding_count; ++k) {
            lowest = math::min(lowest, g[deciding[k]]);
        }
        const auto decided = math::less(lowest, zero);
        L changes = math::select(decided, one, zero);
        for (const L &change : reported) {
            changes = changes + math::abs(change);
        }
        const auto changed = math::less(zero, changes);
        if (!any(changed)) {
            end.net_torque = net_torque;
            return false;
        }
        // Of several in one step the first.
        std::array<L, deciding.size()> share;
        L first = L(2.0);
        for (int k = 0; k < deciding_count; ++k) {
            const int event = deciding[k];
            const L from = math::max(indicators_before_[event], zero);
            const L crossed = from / math::max(from - g[event], L(1e-300));
            share[k] = math::select(math::less(g[event], zero), crossed, L(2.0));
            first = math::min(first, share[k]);
        }
        const double before_s = now_s_ - last_step_s_;
        const L before_depth = indicators_before_[At::event_contact];
        const L rise = math::max(g[At::event_contact] - before_depth, L(1e-300));
        const L touched = L(before_s) + L(last_step_s_) * math::clamp((zero - before_depth) / rise, zero, one);
        const L met = math::select(math::less(zero, reported[At::event_contact]), touched, first_contact_);
        first_contact_ = math::select(math::less(first_contact_, zero), met, first_contact_);
        events_ = events_ + math::select(changed, one, zero);
        last_event_ =
            math::select(changed, math::select(decided, L(before_s) + L(last_step_s_) * first, L(now_s_)), last_event_);
        State as_it_is = x_; // nothing jumps where modes only report
        plant::planar_transition(end, as_it_is, m_, reported, p_, d_);
        if (!any(decided)) {
            end.net_torque = net_torque;
            return false;
        }
        Events fired{};
        for (int k = 0; k < deciding_count; ++k) {
            fired[deciding[k]] = math::select(math::less(first, share[k]), zero, math::select(decided, L(-1.0), zero));
        }
        redo(first, decided, fired);
        return true;
    }

    // Sets the lanes with a decided mode change back to `share` of the last step, and repeats the rest with new modes.
    template <class Mask> void redo(L share, Mask decided, const Events &fired) {
        const L step(last_step_s_);
        const L part = math::select(decided, share, L(0.0));
        State x;
        for (std::size_t i = 0; i < x.size(); ++i) {
            // Interpolation through both ends with the slope of the beginning.
            const L straight = step * rate_before_[i];
            x[i] = before_[i] + part * (straight + part * (x_[i] - before_[i] - straight));
        }
        evaluate(restart_, x, acted_);
        plant::planar_transition(restart_, x, m_, fired, p_, d_);
        evaluate(restart_, x, acted_);
        State end;
        move(end, x, restart_.rate, (L(1.0) - part) * step, acted_);
        for (std::size_t i = 0; i < x.size(); ++i) {
            x_[i] = math::select(decided, end[i], x_[i]);
        }
    }

    plant::Parameters<L> p_{};
    plant::Derived<L> d_{};
    State x_{};
    plant::Modes<L> m_{};
    plant::Modes<L> there_{}; // m_ where it decides, else 1 for all elements that there are
    plant::Inputs<L> u_{};
    plant::Outputs<L> outputs_{};
    L first_contact_, events_, last_event_;
    double now_s_ = 0.0;
    std::array<Evaluation, 3> stages_{}; // on the way to the end of a step
    Evaluation restart_{};               // where a step is taken up again
    Evaluation present_{};               // at x_, u_ and m_, if
    bool evaluated_ = false;
    bool torques_are_new_ = false;
    // The last step: its length (0 once its mode changes were made), its beginning, and the inputs during it.
    double last_step_s_ = 0.0;
    State before_{}, rate_before_{};
    Events indicators_before_{};
    plant::Inputs<L> acted_{};
};

} // namespace giveway::batch
