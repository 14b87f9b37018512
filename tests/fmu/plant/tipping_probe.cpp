// The plant whose base tips, as probe.cpp has the planar one. Modes: gear[3], contact, on_floor[3], overturned,
// roller[3].
#include <algorithm>
#include <cstdio>
#include <vector>

#include "hybrid_integrator.hpp"
#include "initial_state.hpp"
#include "outputs.hpp"
#include "probe.hpp"
#include "tipping.hpp"

namespace {

namespace plant = giveway::plant;
using At = plant::Layout<>;
using Modes = plant::Modes<double>;

plant::TippingVector<double> state_from(const double *x) {
    plant::TippingVector<double> state = {};
    std::copy_n(x, state.size(), state.begin());
    return state;
}

plant::Inputs<double> inputs_from(const double *u) { return {{u[0], u[1], u[2]}, u[3], u[4], u[5], u[6]}; }

Modes modes_from(const double *m, const plant::Parameters<double> &p) {
    Modes modes = {};
    std::copy_n(m, 3, modes.gear_direction.begin());
    modes.contact = m[3];
    std::copy_n(m + 4, 3, modes.on_floor.begin());
    modes.overturned = m[7];
    for (int i = 0; plant::discrete(p) && i < plant::table_wheels; ++i) {
        plant::stand_on(p, modes, i, m[8 + i]);
    }
    return modes;
}

void modes_to(const Modes &m, double *out) {
    std::copy_n(m.gear_direction.begin(), 3, out);
    out[3] = m.contact;
    std::copy_n(m.on_floor.begin(), 3, out + 4);
    out[7] = m.overturned;
    std::copy_n(m.roller.begin(), 3, out + 8);
}

class Tipping final : public giveway::solver::HybridSystem {
public:
    Tipping(const Probe &probe, const Modes &start) : modes(start), probe_(probe) {}
    [[nodiscard]] int state_count() const override { return At::tipping_state_count; }
    [[nodiscard]] int event_count() const override { return At::tipping_event_count; }
    [[nodiscard]] double absolute_tolerance(int) const override { return 1e-12; }
    void rhs(double, const double *state, double *rate) override {
        const auto result = plant::rhs(state_from(state), inputs, modes, probe_.p, probe_.d);
        std::copy(result.begin(), result.end(), rate);
    }
    void indicators(double, const double *state, double *value) override {
        const auto result = plant::event_indicators(state_from(state), inputs, modes, probe_.p, probe_.d);
        std::copy(result.begin(), result.end(), value);
    }
    void transition(double time_s, double *state, const int *fired) override {
        plant::TippingEvents<double> direction = {};
        std::copy_n(fired, direction.size(), direction.begin());
        for (int i = 0; i < At::tipping_event_count; ++i) {
            if (fired[i] != 0) {
                events.push_back({time_s, i});
            }
        }
        auto x = state_from(state);
        plant::transition(x, inputs, modes, direction, probe_.p, probe_.d);
        std::copy(x.begin(), x.end(), state);
    }

    struct Event {
        double time_s;
        int index;
    };
    plant::Inputs<double> inputs = {};
    Modes modes;
    std::vector<Event> events;

private:
    const Probe &probe_;
};

} // namespace

EXPORT void tipping_rhs(void *handle, const double *x, const double *u, const double *m, double *rate) {
    const auto *probe = static_cast<const Probe *>(handle);
    const auto result = plant::rhs(state_from(x), inputs_from(u), modes_from(m, probe->p), probe->p, probe->d);
    std::copy(result.begin(), result.end(), rate);
}

EXPORT void tipping_indicators(void *handle, const double *x, const double *u, const double *m, double *value) {
    const auto *probe = static_cast<const Probe *>(handle);
    const auto result =
        plant::event_indicators(state_from(x), inputs_from(u), modes_from(m, probe->p), probe->p, probe->d);
    std::copy(result.begin(), result.end(), value);
}

EXPORT void tipping_transition(void *handle, double *x, const double *u, double *m, const double *fired) {
    const auto *probe = static_cast<const Probe *>(handle);
    auto state = state_from(x);
    auto modes = modes_from(m, probe->p);
    plant::TippingEvents<double> direction = {};
    std::copy_n(fired, direction.size(), direction.begin());
    plant::transition(state, inputs_from(u), modes, direction, probe->p, probe->d);
    std::copy(state.begin(), state.end(), x);
    modes_to(modes, m);
}

// wheel_load[3], tip_margin, stored energy, contact force x, y, roll, pitch, specific force x, y, yaw rate
EXPORT void tipping_outputs(void *handle, const double *x, const double *u, const double *m, double *out) {
    const auto *probe = static_cast<const Probe *>(handle);
    const auto o = plant::outputs(state_from(x), inputs_from(u), modes_from(m, probe->p), probe->p, probe->d);
    const double all[] = {o.wheel_load[0], o.wheel_load[1],    o.wheel_load[2],    o.tip_margin,
                          o.stored_energy, o.contact_force_x,  o.contact_force_y,  o.roll,
                          o.pitch,         o.specific_force_x, o.specific_force_y, o.yaw_rate};
    std::copy(std::begin(all), std::end(all), out);
}

// motion: x, y, theta, vx, vy, omega, slider speed.
EXPORT void tipping_initial_state(void *handle, const double *motion, const double *u, double *x, double *m) {
    const auto *probe = static_cast<const Probe *>(handle);
    plant::TippingVector<double> state = {};
    Modes modes = {};
    plant::initial_state({motion[0], motion[1], motion[2], motion[3], motion[4], motion[5], motion[6], {}},
                         inputs_from(u), probe->p, probe->d, state, modes);
    std::copy(state.begin(), state.end(), x);
    modes_to(modes, m);
}

// With giveway's solver. Input row k holds from input_times[k] on. Returns the number of events, or -1 (probe_error
// says why).
EXPORT int tipping_simulate(void *handle, const double *x0, const double *m0, int inputs, const double *input_times,
                            const double *input_rows, int count, const double *times, double relative_tolerance,
                            double *states, double *modes, int max_events, double *event_times, int *event_indices) {
    auto *probe = static_cast<Probe *>(handle);
    Tipping system(*probe, modes_from(m0, probe->p));
    giveway::solver::HybridIntegrator integrator;
    giveway::solver::IntegratorOptions options;
    options.relative_tolerance = relative_tolerance;
    system.inputs = inputs_from(input_rows);
    plant::accept_inputs(state_from(x0), system.inputs, system.modes, probe->p, probe->d);
    bool good = integrator.create(system, times[0], x0, options);
    int next = 1;
    for (int k = 0; good && k < count; ++k) {
        while (good && next < inputs && input_times[next] <= times[k]) {
            good = integrator.advance(input_times[next]);
            system.inputs = inputs_from(input_rows + next * 7);
            plant::accept_inputs(state_from(integrator.state()), system.inputs, system.modes, probe->p, probe->d);
            integrator.restart();
            ++next;
        }
        good = good && integrator.advance(times[k]);
        std::copy_n(integrator.state(), At::tipping_state_count, states + k * At::tipping_state_count);
        modes_to(system.modes, modes + k * 11);
    }
    if (!good) {
        std::snprintf(probe->error, sizeof probe->error, "%s", integrator.error());
        return -1;
    }
    const auto recorded = std::min<std::size_t>(system.events.size(), static_cast<std::size_t>(max_events));
    for (std::size_t k = 0; k < recorded; ++k) {
        event_times[k] = system.events[k].time_s;
        event_indices[k] = system.events[k].index;
    }
    return static_cast<int>(recorded);
}
