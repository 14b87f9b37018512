// LanePlant for N lanes: the plant's equations in Lanes<N>, the classic Runge-Kutta method of order 4, modes that change at step ends.
// Included by one file per width, compiled for the processors that have it; nothing here is to be used by code for all processors.
#pragma once

#include <cstring>
#include <new>

#include "convert.hpp"
#include "lane_plant.hpp"

namespace giveway::batch {

// Where a number of the first design is; those of the others follow at the distance of a whole design. In place of a scalar type it
// makes convert() gather designs into lanes.
template <int N> struct Strided {
    const double* first = nullptr;
    Strided() = default;
    explicit Strided(const double& number) : first(&number) {}

    explicit operator math::Lanes<N>() const {
        double row[N];
        for (int i = 0; i < N; ++i) {
            std::memcpy(&row[i], reinterpret_cast<const unsigned char*>(first) + static_cast<std::size_t>(i) * sizeof(LaneStart), sizeof(double));
        }
        return math::Lanes<N>::load(row);
    }
};

template <int N> class LanePlantOf final : public LanePlant {
    using L = math::Lanes<N>;
    using State = plant::StateVector<L>;
    using Evaluation = plant::Evaluation<L>;

public:
    [[nodiscard]] int lanes() const override { return N; }

    void start(const LaneStart* designs) override {
        p_ = plant::convert<L>(plant::convert<Strided<N>>(designs[0].parameters));
        d_ = plant::derive(p_);
        x_ = plant::detail::converted<L>(plant::detail::converted<Strided<N>>(designs[0].state));
        m_ = plant::convert<L>(plant::convert<Strided<N>>(designs[0].modes));
        u_ = plant::convert<L>(plant::convert<Strided<N>>(designs[0].inputs));
        first_contact_ = L(Strided<N>(designs[0].first_contact_s));
        events_ = L(0.0);
        last_event_ = L(-1.0);
        now_ = 0.0;
        before_ = 0.0;
        depth_before_ = L(0.0);
        // Elements that there are; whether they act, they see by themselves.
        const auto there = [](bool yes) { return L(yes ? 1.0 : 0.0); };
        const bool rope = p_.slider_present != 0 && p_.rope_attached != 0;
        const bool plate = p_.slider_present != 0 && p_.has_plate();
        armed_ = {.gear_direction = {},
                  .contact = there(p_.slider_present != 0),
                  .rope_taut = there(rope),
                  .end_stop = there(plate && !p_.has_ideal_latch()),
                  .bottom_stop = there(plate),
                  .latched = L(0.0),
                  .landed = there(rope),
                  .walled = there(p_.slider_present != 0 && p_.wall_present != 0)};
        observe();
    }

    void set_motor_torques(const double* rows) override {
        for (std::size_t i = 0; i < u_.motor_torque.size(); ++i) {
            u_.motor_torque[i] = L::load(rows + i * N);
        }
        plant::accept_inputs(x_, u_, m_, p_, d_);
    }

    void set_pushes(const double* rows) override {
        u_.push_force_x = L::load(rows);
        u_.push_force_y = L::load(rows + N);
        u_.push_point_x = L::load(rows + 2 * N);
        u_.push_point_y = L::load(rows + 3 * N);
    }

    [[gnu::flatten]] void advance(int count, double step_s) override {
        const L half(0.5 * step_s);
        const L whole(step_s);
        const L sixth(step_s / 6.0);
        const L third(step_s / 3.0);
        const double start_s = now_;
        for (int step = 0; step < count; ++step) {
            State rate = settled().rate;
            State next = x_;
            State stage;
            for (int stage_number = 0;; ++stage_number) {
                const bool outer = stage_number == 0 || stage_number == 3;
                const L weight = outer ? sixth : third;
                const L reach = stage_number == 2 ? whole : half;
                for (std::size_t i = 0; i < next.size(); ++i) {
                    next[i] = next[i] + weight * rate[i];
                    stage[i] = x_[i] + reach * rate[i];
                }
                if (stage_number == 3) {
                    break;
                }
                rate = evaluate(stage).rate;
            }
            x_ = next;
            now_ = start_s + static_cast<double>(step + 1) * step_s;
        }
    }

    [[gnu::flatten]] void observe() override { outputs_ = plant::outputs(settled(), x_, p_, d_); }

    [[nodiscard]] const double* state() const override { return rows(x_); }
    [[nodiscard]] const double* modes() const override { return rows(m_); }
    [[nodiscard]] const double* outputs() const override { return rows(outputs_); }
    [[nodiscard]] const double* first_contact_s() const override { return rows(first_contact_); }
    [[nodiscard]] const double* events() const override { return rows(events_); }
    [[nodiscard]] const double* last_event_s() const override { return rows(last_event_); }

private:
    template <class Block> static const double* rows(const Block& block) { return reinterpret_cast<const double*>(&block); }

    Evaluation evaluate(const State& x) {
        armed_.gear_direction = m_.gear_direction;
        armed_.latched = m_.latched;
        return plant::evaluate(x, u_, armed_, p_, d_);
    }

    // Everything at the present state, after the mode changes that are due. A lane in which none is due keeps its bits.
    Evaluation settled() {
        const Evaluation e = evaluate(x_);
        const L zero(0.0);
        const L one(1.0);
        const auto g = plant::event_indicators(e, x_, m_, p_, d_);
        plant::EventVector<L> fired{};
        // One-sided elements follow their indicator.
        const auto follow = [&](int event, L mode) {
            const L side = math::select(math::less(zero, g[event]), one, zero);
            fired[event] = side - mode;
        };
        for (int i = 0; i < plant::wheel_count; ++i) {
            fired[plant::event_gear + i] = math::select(math::less(g[plant::event_gear + i], zero), L(-1.0), zero);
        }
        follow(plant::event_contact, m_.contact);
        follow(plant::event_rope, m_.rope_taut);
        follow(plant::event_bottom_stop, m_.bottom_stop);
        follow(plant::event_landing, m_.landed);
        follow(plant::event_wall, m_.walled);
        if (p_.has_ideal_latch()) {
            fired[plant::event_end_stop] = math::select(math::less(g[plant::event_end_stop], zero), L(-1.0), zero);
        } else {
            follow(plant::event_end_stop, one - m_.end_stop);
        }
        L any = zero;
        for (const L& one_fired : fired) {
            any = any + math::abs(one_fired);
        }
        const L depth = g[plant::event_contact];
        if (!any_positive(any)) {
            before_ = now_;
            depth_before_ = depth;
            return e;
        }
        // The instant of the first contact: the depth crosses zero on its way from the last state to this one.
        const auto touched = math::less(zero, fired[plant::event_contact]);
        const L crossing = L(before_) + L(now_ - before_) * (zero - depth_before_) / math::max(depth - depth_before_, L(1e-300));
        const L since = math::clamp(crossing, L(before_), L(now_));
        first_contact_ = math::select(math::less(first_contact_, zero), math::select(touched, since, first_contact_), first_contact_);
        before_ = now_;
        depth_before_ = depth;
        const auto changed = math::less(zero, any);
        events_ = events_ + math::select(changed, one, zero);
        last_event_ = math::select(changed, L(now_), last_event_);
        State x = x_;
        plant::planar_transition(e, x, m_, fired, p_, d_);
        for (std::size_t i = 0; i < x.size(); ++i) {
            x_[i] = math::select(changed, x[i], x_[i]);
        }
        return evaluate(x_);
    }

    static bool any_positive(const L& lanes) {
        double row[N];
        lanes.store(row);
        double largest = 0.0;
        for (const double number : row) {
            largest = largest < number ? number : largest;
        }
        return largest > 0.0;
    }

    plant::Parameters<L> p_{};
    plant::Derived<L> d_{};
    State x_{};
    plant::Modes<L> m_{};
    plant::Modes<L> armed_{};
    plant::Inputs<L> u_{};
    plant::Outputs<L> outputs_{};
    L first_contact_, events_, last_event_;
    double now_ = 0.0;
    double before_ = 0.0; // of the last settled state
    L depth_before_;
};

} // namespace giveway::batch
