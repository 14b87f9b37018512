// The bumper between two faces with given motion, as seen by the solver: its force is algebraic, its states are energy
// accounts.
#pragma once

#include "bumper.hpp"
#include "exchange.hpp"

namespace giveway::bumper {

enum StateIndex : int { work_in, dissipated, state_count };
enum EventIndex : int { event_end_stop, event_bottom_stop, event_count };

// Both positions along one axis from the carrier to the plate, equal at full extension.
struct Faces {
    double carrier_m, carrier_mps, plate_m, plate_mps;
};

class BumperSystem final : public ExchangeableSystem {
public:
    void start(const plant::Parameters<double> &parameters) {
        parameters_ = parameters;
        modes_ = {};
    }

    template <class Archive> void archive(Archive &a) {
        a(parameters_);
        a(modes_);
        a(faces_);
        a(faces_time_s_);
    }

    // From `time_s` on the faces move with these velocities. Their positions decide which stops they touch.
    void set_faces(const Faces &faces, double time_s) {
        follow_faces(faces, time_s);
        const double c = compression(time_s);
        const double beyond = c - parameters_.bumper_travel;
        modes_.end_stop = c < 0.0 || (c <= 0.0 && compression_rate() <= 0.0) ? 1.0 : 0.0;
        modes_.bottom_stop = beyond > 0.0 || (beyond >= 0.0 && compression_rate() > 0.0) ? 1.0 : 0.0;
    }

    // In continuous time: stops that are reached wait for the following event.
    void follow_faces(const Faces &faces, double time_s) {
        faces_ = faces;
        faces_time_s_ = time_s;
    }

    [[nodiscard]] double compression(double time_s) const {
        return faces_.carrier_m - faces_.plate_m + compression_rate() * (time_s - faces_time_s_);
    }
    [[nodiscard]] double compression_rate() const { return faces_.carrier_mps - faces_.plate_mps; }
    [[nodiscard]] bool end_stop() const { return modes_.end_stop > 0.5; }
    [[nodiscard]] bool bottom_stop() const { return modes_.bottom_stop > 0.5; }
    [[nodiscard]] bool latched(double time_s) const {
        return plant::is_latched(parameters_, compression(time_s), end_stop());
    }

    // The ideal latch is the continuous one with zero reach: its full force while the plate is at its end stop, none
    // beyond. It releases when the pull of the faces exceeds its force plus the preload, and latches again at full
    // extension.
    [[nodiscard]] plant::BumperForce<double> force(double time_s) const {
        const double c = compression(time_s);
        auto bumper = plant::bumper_force(parameters_, modes_, c, compression_rate());
        if (plant::bumper_holds(parameters_)) {
            const double holding = plant::bumper_holding_force(parameters_);
            bumper.force += modes_.end_stop * holding;
            bumper.stored += modes_.end_stop * holding * c;
        }
        return bumper;
    }

    [[nodiscard]] int state_count() const override { return bumper::state_count; }
    [[nodiscard]] int event_count() const override { return bumper::event_count; }

    void rhs(double time_s, const double *, double *rate) override {
        const auto bumper = force(time_s);
        rate[work_in] = bumper.force * compression_rate();
        rate[dissipated] = bumper.dissipation;
    }

    void indicators(double time_s, const double *, double *value) override {
        value[event_end_stop] = compression(time_s);
        value[event_bottom_stop] = compression(time_s) - parameters_.bumper_travel;
    }

    void transition(double, double *, const int *fired) override {
        if (fired[event_end_stop] != 0) {
            modes_.end_stop = fired[event_end_stop] < 0 ? 1.0 : 0.0;
        }
        if (fired[event_bottom_stop] != 0) {
            modes_.bottom_stop = fired[event_bottom_stop] > 0 ? 1.0 : 0.0;
        }
    }

    [[nodiscard]] int side(int event) const override {
        return event == event_end_stop ? (end_stop() ? -1 : 1) : (bottom_stop() ? 1 : -1);
    }
    [[nodiscard]] double hysteresis(int) const override { return 1e-9; } // m

    [[nodiscard]] double absolute_tolerance(int) const override { return 1e-7; } // J

private:
    plant::Parameters<double> parameters_{};
    plant::Modes<double> modes_{};
    Faces faces_{};
    double faces_time_s_ = 0.0;
};

} // namespace giveway::bumper
