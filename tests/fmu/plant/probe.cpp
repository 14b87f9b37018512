// The plant behind a flat C interface, for the Python tests in this folder only (loaded by ctypes).
//
// Parameters are set by the names they have in the plant. Parameters that were never set are NaN (reals) or 255
// (choices), so that every comparison shows a missing one.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <new>
#include <type_traits>
#include <vector>

#include "hybrid_integrator.hpp"
#include "initial_state.hpp"
#include "outputs.hpp"
#include "plant.hpp"
#include "probe.hpp"
#include "state.hpp"

namespace {

namespace plant = giveway::plant;
using At = plant::Layout<>;

using Parameters = plant::Parameters<double>;
using Modes = plant::Modes<double>;

constexpr int mode_count = 13;
constexpr int input_count = 7;

constexpr double unset = std::numeric_limits<double>::quiet_NaN();
constexpr int unset_choice = 255;

// visit(name, member) for every parameter, those beside the table included.
template <class Visitor> void visit_all(Visitor &&visit, Parameters &p) {
    plant::visit_parameters(visit, p);
    visit("wheel_load", p.wheel_load);
    visit("wheel_traction", p.wheel_traction);
    visit("outline_body", p.outline_body);
    visit("outline_wheels", p.outline_wheels);
}

void set_number(double &into, const double *values, int count) { into = count == 1 ? values[0] : into; }
template <std::size_t N> void set_number(std::array<double, N> &into, const double *values, int count) {
    std::copy_n(values, std::min(count, static_cast<int>(N)), into.begin());
}
template <class Choice> void set_number(Choice &into, const double *values, int) {
    into = static_cast<Choice>(static_cast<int>(values[0]));
}

bool count_fits(const double &, int count) { return count == 1; }
template <std::size_t N> bool count_fits(const std::array<double, N> &, int count) {
    return N == plant::max_outline_vertices ? count >= 3 && count <= static_cast<int>(N) : count == static_cast<int>(N);
}
template <class Choice> bool count_fits(const Choice &, int count) { return count == 1; }

plant::StateVector<double> state_from(const double *x) {
    plant::StateVector<double> state = {};
    std::copy_n(x, state.size(), state.begin());
    return state;
}

plant::Inputs<double> inputs_from(const double *u) { return {{u[0], u[1], u[2]}, u[3], u[4], u[5], u[6]}; }

Modes modes_from(const double *m, const Parameters &p) {
    Modes modes = {{m[0], m[1], m[2]}, m[3], m[4], m[5], m[6], m[7], m[8], m[9]};
    for (int i = 0; plant::discrete(p) && i < plant::table_wheels; ++i) {
        plant::stand_on(p, modes, i, m[10 + i]);
    }
    return modes;
}

void modes_to(const Modes &m, double *out) {
    const double flat[mode_count] = {
        m.gear_direction[0], m.gear_direction[1], m.gear_direction[2], m.contact, m.rope_taut,
        m.end_stop,          m.bottom_stop,       m.latched,           m.landed,  m.walled,
        m.roller[0],         m.roller[1],         m.roller[2]};
    std::copy_n(flat, mode_count, out);
}

struct Event {
    double time_s;
    int index;
};

// The plant as the solver sees it, with constant inputs between restarts; keeps a list of the
// events.
class RecordedPlant final : public giveway::solver::HybridSystem {
public:
    explicit RecordedPlant(const Probe &probe, const Modes &modes, double absolute_tolerance)
        : modes(modes), probe_(probe), absolute_tolerance_(absolute_tolerance) {}

    [[nodiscard]] int state_count() const override { return At::state_count; }
    [[nodiscard]] int event_count() const override { return At::event_count; }
    [[nodiscard]] double absolute_tolerance(int) const override { return absolute_tolerance_; }

    void rhs(double, const double *state, double *rate) override {
        const auto result = plant::rhs(state_from(state), inputs, modes, probe_.p, probe_.d);
        std::copy(result.begin(), result.end(), rate);
    }
    void indicators(double, const double *state, double *value) override {
        const auto result = plant::event_indicators(state_from(state), inputs, modes, probe_.p, probe_.d);
        std::copy(result.begin(), result.end(), value);
    }
    void transition(double time_s, double *state, const int *fired) override {
        plant::EventVector<double> direction = {};
        for (int i = 0; i < At::event_count; ++i) {
            direction[i] = fired[i];
            if (fired[i] != 0) {
                events.push_back({time_s, i});
            }
        }
        auto x = state_from(state);
        plant::transition(x, inputs, modes, direction, probe_.p, probe_.d);
        std::copy(x.begin(), x.end(), state);
    }

    plant::Inputs<double> inputs = {};
    Modes modes;
    std::vector<Event> events;

private:
    const Probe &probe_;
    double absolute_tolerance_;
};

} // namespace

EXPORT void *probe_new() {
    auto *probe = new (std::nothrow) Probe;
    if (probe != nullptr) {
        const auto forget = [](const char *, auto &member) {
            if constexpr (std::is_same_v<decltype(member), double &>) {
                member = unset;
            } else if constexpr (requires { member.fill(unset); }) {
                member.fill(unset);
            } else {
                member = static_cast<std::remove_reference_t<decltype(member)>>(unset_choice);
            }
        };
        visit_all(forget, probe->p);
    }
    return probe;
}

EXPORT void probe_delete(void *handle) { delete static_cast<Probe *>(handle); }

EXPORT const char *probe_error(void *handle) { return static_cast<Probe *>(handle)->error; }

// 0, or 1 if there is no parameter of this name and count.
EXPORT int probe_set(void *handle, const char *name, const double *values, int count) {
    auto &p = static_cast<Probe *>(handle)->p;
    bool found = false;
    const auto set = [&](const char *other, auto &member) {
        if (std::strcmp(name, other) == 0 && count_fits(member, count)) {
            set_number(member, values, count);
            found = true;
        }
    };
    visit_all(set, p);
    if (found && std::strncmp(name, "outline_x", 9) == 0) {
        p.outline_count = count;
    }
    return found ? 0 : 1;
}

// Call after the last probe_set.
EXPORT void probe_derive(void *handle) {
    auto *probe = static_cast<Probe *>(handle);
    probe->d = plant::derive(probe->p);
}

EXPORT void probe_rhs(void *handle, const double *x, const double *u, const double *m, double *rate) {
    const auto *probe = static_cast<const Probe *>(handle);
    const auto result = plant::rhs(state_from(x), inputs_from(u), modes_from(m, probe->p), probe->p, probe->d);
    std::copy(result.begin(), result.end(), rate);
}

EXPORT void probe_indicators(void *handle, const double *x, const double *u, const double *m, double *value) {
    const auto *probe = static_cast<const Probe *>(handle);
    const auto result =
        plant::event_indicators(state_from(x), inputs_from(u), modes_from(m, probe->p), probe->p, probe->d);
    std::copy(result.begin(), result.end(), value);
}

EXPORT void probe_transition(void *handle, double *x, const double *u, double *m, const double *fired) {
    const auto *probe = static_cast<const Probe *>(handle);
    auto state = state_from(x);
    auto modes = modes_from(m, probe->p);
    plant::EventVector<double> direction = {};
    std::copy_n(fired, direction.size(), direction.begin());
    plant::transition(state, inputs_from(u), modes, direction, probe->p, probe->d);
    std::copy(state.begin(), state.end(), x);
    modes_to(modes, m);
}

// motion: x, y, theta, vx, vy, omega, slider speed, bristle offsets[3].
EXPORT void probe_initial_state(void *handle, const double *motion, const double *u, double *x, double *m) {
    const auto *probe = static_cast<const Probe *>(handle);
    const plant::InitialMotion<double> start = {motion[0], motion[1], motion[2], motion[3],
                                                motion[4], motion[5], motion[6], {motion[7], motion[8], motion[9]}};
    plant::StateVector<double> state = {};
    Modes modes = {};
    plant::initial_state(start, inputs_from(u), probe->p, probe->d, state, modes);
    std::copy(state.begin(), state.end(), x);
    modes_to(modes, m);
}

EXPORT void probe_accept_inputs(void *handle, const double *x, const double *u, double *m) {
    const auto *probe = static_cast<const Probe *>(handle);
    auto modes = modes_from(m, probe->p);
    plant::accept_inputs(state_from(x), inputs_from(u), modes, probe->p, probe->d);
    modes_to(modes, m);
}

// wheel_speed[3], wheel_torque[3], roller_force[3], contact force (magnitude, x, y), contact point
// (world x, y; base x, y), nose tip x, y, bumper force, rope tension, wall force,
// stored energy
EXPORT void probe_outputs(void *handle, const double *x, const double *u, const double *m, double *out) {
    const auto *probe = static_cast<const Probe *>(handle);
    const auto o = plant::outputs(state_from(x), inputs_from(u), modes_from(m, probe->p), probe->p, probe->d);
    for (int i = 0; i < plant::table_wheels; ++i) {
        out[i] = o.wheel_speed[i];
        out[3 + i] = o.wheel_torque[i];
        out[6 + i] = o.roller_force[i];
    }
    const double rest[] = {o.contact_force,   o.contact_force_x,  o.contact_force_y,  o.contact_point_x,
                           o.contact_point_y, o.contact_base_x,   o.contact_base_y,   o.nose_x,
                           o.nose_y,          o.bumper_force,     o.rope_tension,     o.wall_force,
                           o.stored_energy,   o.specific_force_x, o.specific_force_y, o.yaw_rate};
    std::copy(std::begin(rest), std::end(rest), out + 9);
}

// Runs giveway's own solver from times[0]. Inputs are piecewise constant: row k holds from
// input_times[k] on, the first from times[0]. states: one row per time; statistics: steps, rhs
// calls, events. Returns the number of events, or -1 (probe_error says why).
EXPORT int probe_simulate(void *handle, const double *x0, const double *m0, int inputs, const double *input_times,
                          const double *input_rows, int count, const double *times, double relative_tolerance,
                          double absolute_tolerance, double *states, double *modes, int max_events, double *event_times,
                          int *event_indices, std::int64_t *statistics) {
    auto *probe = static_cast<Probe *>(handle);
    RecordedPlant system(*probe, modes_from(m0, probe->p), absolute_tolerance);
    giveway::solver::HybridIntegrator integrator;
    giveway::solver::IntegratorOptions options;
    options.relative_tolerance = relative_tolerance;
    system.inputs = inputs_from(input_rows);
    plant::accept_inputs(state_from(x0), system.inputs, system.modes, probe->p, probe->d);
    bool good = integrator.create(system, times[0], x0, options);
    int next_input = 1;
    for (int k = 0; good && k < count; ++k) {
        while (good && next_input < inputs && input_times[next_input] <= times[k]) {
            good = integrator.advance(input_times[next_input]);
            system.inputs = inputs_from(input_rows + next_input * input_count);
            plant::accept_inputs(state_from(integrator.state()), system.inputs, system.modes, probe->p, probe->d);
            integrator.restart();
            ++next_input;
        }
        good = good && integrator.advance(times[k]);
        std::copy_n(integrator.state(), At::state_count, states + k * At::state_count);
        modes_to(system.modes, modes + k * mode_count);
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
    const auto s = integrator.statistics();
    statistics[0] = s.steps;
    statistics[1] = s.rhs_calls;
    statistics[2] = s.events;
    return static_cast<int>(recorded);
}
