// The plant behind a flat C interface, for the Python tests in this folder only (loaded by ctypes).
//
// Parameters are set by the names they have in parameters.hpp. Those that were never set are NaN
// (reals) or -1 (choices), so that a forgotten one shows in every comparison.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <new>
#include <vector>

#include "hybrid_integrator.hpp"
#include "initial_state.hpp"
#include "outputs.hpp"
#include "plant.hpp"
#include "probe.hpp"
#include "state.hpp"

namespace {

namespace plant = giveway::plant;

using Parameters = plant::Parameters<double>;
using Modes = plant::Modes<double>;

constexpr int mode_count = 10;
constexpr int input_count = 7;

struct Real {
    const char* name;
    double Parameters::* member;
};
struct RealPerWheel {
    const char* name;
    std::array<double, plant::wheel_count> Parameters::* member;
};

#define REAL(name) {#name, &Parameters::name}
constexpr Real reals[] = {
    REAL(mass),
    REAL(yaw_inertia),
    REAL(wheel_radius),
    REAL(wheel_distance),
    REAL(wheel_inertia),
    REAL(roller_radius),
    REAL(roller_inertia),
    REAL(roller_torque),
    REAL(roller_slope),
    REAL(roller_presliding_damping),
    REAL(roller_stribeck_speed),
    REAL(roller_elastic_fraction),
    REAL(motor_inertia),
    REAL(drivetrain_stiffness),
    REAL(drivetrain_damping),
    REAL(gear_coulomb),
    REAL(gear_stiction),
    REAL(gear_viscous),
    REAL(torque_limit),
    REAL(slider_mass),
    REAL(slider_friction),
    REAL(slider_friction_speed),
    REAL(slider_damping),
    REAL(rail_direction),
    REAL(target_x),
    REAL(target_y),
    REAL(run_up),
    REAL(wall_distance),
    REAL(wall_stiffness),
    REAL(wall_damping),
    REAL(hanging_mass),
    REAL(rope_stiffness),
    REAL(rope_damping),
    REAL(drop_height),
    REAL(floor_stiffness),
    REAL(floor_damping),
    REAL(plate_mass),
    REAL(spring_rate),
    REAL(preload),
    REAL(bumper_damping),
    REAL(guide_friction),
    REAL(guide_friction_speed),
    REAL(travel),
    REAL(stop_stiffness),
    REAL(stop_damping),
    REAL(latch_force),
    REAL(latch_gap),
    REAL(mount_x),
    REAL(mount_y),
    REAL(mount_azimuth),
    REAL(nose_radius),
    REAL(contact_stiffness),
    REAL(contact_damping),
    REAL(contact_friction),
    REAL(contact_friction_speed),
    REAL(contact_height),
    REAL(wheel_width),
    REAL(tilt_inertia),
    REAL(com_height),
    REAL(floor_contact_stiffness),
    REAL(floor_contact_damping),
    REAL(grip_friction),
    REAL(grip_stiffness),
    REAL(grip_damping),
    REAL(push_height),
};
constexpr RealPerWheel per_wheel[] = {REAL(wheel_load), REAL(wheel_traction),
                                      REAL(roller_presliding_stiffness)};
#undef REAL

// True if `name` is a choice; sets it.
bool set_choice(Parameters& p, const char* name, int value) {
    const auto is = [name](const char* other) { return std::strcmp(name, other) == 0; };
    if (is("roller_model")) {
        p.roller_model = static_cast<plant::RollerModel>(value);
    } else if (is("bumper_kind")) {
        p.bumper_kind = static_cast<plant::BumperKind>(value);
    } else if (is("bumper_mount")) {
        p.bumper_mount = static_cast<plant::BumperMount>(value);
    } else if (is("latch_model")) {
        p.latch_model = static_cast<plant::LatchModel>(value);
    } else if (is("slider_present")) {
        p.slider_present = value;
    } else if (is("rope_attached")) {
        p.rope_attached = value;
    } else if (is("wall_present")) {
        p.wall_present = value;
    } else if (is("tipping")) {
        p.tipping = value;
    } else if (is("nose_shape")) {
        p.nose_shape = static_cast<plant::NoseShape>(value);
    } else if (is("outline_body")) {
        p.outline_body = value;
    } else if (is("outline_wheels")) {
        p.outline_wheels = value;
    } else {
        return false;
    }
    return true;
}

plant::StateVector<double> state_from(const double* x) {
    plant::StateVector<double> state = {};
    std::copy_n(x, state.size(), state.begin());
    return state;
}

plant::Inputs<double> inputs_from(const double* u) {
    return {{u[0], u[1], u[2]}, u[3], u[4], u[5], u[6]};
}

Modes modes_from(const double* m) {
    return {{m[0], m[1], m[2]}, m[3], m[4], m[5], m[6], m[7], m[8], m[9]};
}

void modes_to(const Modes& m, double* out) {
    const double flat[mode_count] = {m.gear_direction[0], m.gear_direction[1], m.gear_direction[2],
                                     m.contact,           m.rope_taut,         m.end_stop,
                                     m.bottom_stop,       m.latched,           m.landed,
                                     m.walled};
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
    explicit RecordedPlant(const Probe& probe, const Modes& modes, double absolute_tolerance)
        : modes(modes), probe_(probe), absolute_tolerance_(absolute_tolerance) {}

    [[nodiscard]] int state_count() const override { return plant::state_count; }
    [[nodiscard]] int event_count() const override { return plant::event_count; }
    [[nodiscard]] double absolute_tolerance(int) const override { return absolute_tolerance_; }

    void rhs(double, const double* state, double* rate) override {
        const auto result = plant::rhs(state_from(state), inputs, modes, probe_.p, probe_.d);
        std::copy(result.begin(), result.end(), rate);
    }
    void indicators(double, const double* state, double* value) override {
        const auto result =
            plant::event_indicators(state_from(state), inputs, modes, probe_.p, probe_.d);
        std::copy(result.begin(), result.end(), value);
    }
    void transition(double time_s, double* state, const int* fired) override {
        plant::EventVector<double> direction = {};
        for (int i = 0; i < plant::event_count; ++i) {
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
    const Probe& probe_;
    double absolute_tolerance_;
};

} // namespace

EXPORT void* probe_new() {
    auto* probe = new (std::nothrow) Probe;
    if (probe != nullptr) {
        constexpr double unset = std::numeric_limits<double>::quiet_NaN();
        for (const auto& real : reals) {
            probe->p.*real.member = unset;
        }
        for (const auto& real : per_wheel) {
            (probe->p.*real.member).fill(unset);
        }
        for (const char* name : {"roller_model", "bumper_kind", "bumper_mount", "latch_model",
                                 "slider_present", "rope_attached", "wall_present", "tipping", "nose_shape",
                                 "outline_body", "outline_wheels"}) {
            set_choice(probe->p, name, -1);
        }
    }
    return probe;
}

EXPORT void probe_delete(void* handle) { delete static_cast<Probe*>(handle); }

EXPORT const char* probe_error(void* handle) { return static_cast<Probe*>(handle)->error; }

// 0, or 1 if there is no parameter of this name and count.
EXPORT int probe_set(void* handle, const char* name, const double* values, int count) {
    auto& p = static_cast<Probe*>(handle)->p;
    if (std::strcmp(name, "outline_x") == 0 || std::strcmp(name, "outline_y") == 0) {
        if (count < 3 || count > plant::max_outline_vertices) {
            return 1;
        }
        auto& target = name[8] == 'x' ? p.outline_x : p.outline_y;
        std::copy_n(values, count, target.begin());
        p.outline_count = count;
    } else if (count == plant::wheel_count) {
        const auto* found =
            std::find_if(std::begin(per_wheel), std::end(per_wheel),
                         [name](const auto& r) { return std::strcmp(r.name, name) == 0; });
        if (found == std::end(per_wheel)) {
            return 1;
        }
        std::copy_n(values, count, (p.*found->member).begin());
    } else if (count == 1) {
        const auto* found = std::find_if(std::begin(reals), std::end(reals), [name](const auto& r) {
            return std::strcmp(r.name, name) == 0;
        });
        if (found != std::end(reals)) {
            p.*found->member = values[0];
        } else if (!set_choice(p, name, static_cast<int>(values[0]))) {
            return 1;
        }
    } else {
        return 1;
    }
    return 0;
}

// Call after the last probe_set.
EXPORT void probe_derive(void* handle) {
    auto* probe = static_cast<Probe*>(handle);
    probe->d = plant::derive(probe->p);
}

EXPORT void probe_rhs(void* handle, const double* x, const double* u, const double* m,
                      double* rate) {
    const auto* probe = static_cast<const Probe*>(handle);
    const auto result =
        plant::rhs(state_from(x), inputs_from(u), modes_from(m), probe->p, probe->d);
    std::copy(result.begin(), result.end(), rate);
}

EXPORT void probe_indicators(void* handle, const double* x, const double* u, const double* m,
                             double* value) {
    const auto* probe = static_cast<const Probe*>(handle);
    const auto result =
        plant::event_indicators(state_from(x), inputs_from(u), modes_from(m), probe->p, probe->d);
    std::copy(result.begin(), result.end(), value);
}

EXPORT void probe_transition(void* handle, double* x, const double* u, double* m,
                             const double* fired) {
    const auto* probe = static_cast<const Probe*>(handle);
    auto state = state_from(x);
    auto modes = modes_from(m);
    plant::EventVector<double> direction = {};
    std::copy_n(fired, direction.size(), direction.begin());
    plant::transition(state, inputs_from(u), modes, direction, probe->p, probe->d);
    std::copy(state.begin(), state.end(), x);
    modes_to(modes, m);
}

// motion: x, y, theta, vx, vy, omega, slider speed, bristle offsets[3].
EXPORT void probe_initial_state(void* handle, const double* motion, const double* u, double* x,
                                double* m) {
    const auto* probe = static_cast<const Probe*>(handle);
    const plant::InitialMotion<double> start = {motion[0], motion[1], motion[2], motion[3],
                                                motion[4], motion[5], motion[6],
                                                {motion[7], motion[8], motion[9]}};
    plant::StateVector<double> state = {};
    Modes modes = {};
    plant::initial_state(start, inputs_from(u), probe->p, probe->d, state, modes);
    std::copy(state.begin(), state.end(), x);
    modes_to(modes, m);
}

EXPORT void probe_accept_inputs(void* handle, const double* x, const double* u, double* m) {
    const auto* probe = static_cast<const Probe*>(handle);
    auto modes = modes_from(m);
    plant::accept_inputs(state_from(x), inputs_from(u), modes, probe->p, probe->d);
    modes_to(modes, m);
}

// wheel_speed[3], wheel_torque[3], roller_force[3], contact force (magnitude, x, y), contact point
// (world x, y; base x, y), nose tip x, y, bumper force, rope tension, wall force,
// stored energy
EXPORT void probe_outputs(void* handle, const double* x, const double* u, const double* m,
                          double* out) {
    const auto* probe = static_cast<const Probe*>(handle);
    const auto o = plant::outputs(state_from(x), inputs_from(u), modes_from(m), probe->p, probe->d);
    for (int i = 0; i < plant::wheel_count; ++i) {
        out[i] = o.wheel_speed[i];
        out[3 + i] = o.wheel_torque[i];
        out[6 + i] = o.roller_force[i];
    }
    const double rest[] = {o.contact_force,   o.contact_force_x, o.contact_force_y,
                           o.contact_point_x, o.contact_point_y, o.contact_base_x,
                           o.contact_base_y,  o.nose_x,          o.nose_y,
                           o.bumper_force,    o.rope_tension,    o.wall_force,
                           o.stored_energy};
    std::copy(std::begin(rest), std::end(rest), out + 9);
}

// Runs giveway's own solver from times[0]. Inputs are piecewise constant: row k holds from
// input_times[k] on, the first from times[0]. states: one row per time; statistics: steps, rhs
// calls, events. Returns the number of events, or -1 (probe_error says why).
EXPORT int probe_simulate(void* handle, const double* x0, const double* m0, int inputs,
                          const double* input_times, const double* input_rows, int count,
                          const double* times, double relative_tolerance, double absolute_tolerance,
                          double* states, double* modes, int max_events, double* event_times,
                          int* event_indices, std::int64_t* statistics) {
    auto* probe = static_cast<Probe*>(handle);
    RecordedPlant system(*probe, modes_from(m0), absolute_tolerance);
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
            plant::accept_inputs(state_from(integrator.state()), system.inputs, system.modes,
                                 probe->p, probe->d);
            integrator.restart();
            ++next_input;
        }
        good = good && integrator.advance(times[k]);
        std::copy_n(integrator.state(), plant::state_count, states + k * plant::state_count);
        modes_to(system.modes, modes + k * mode_count);
    }
    if (!good) {
        std::snprintf(probe->error, sizeof probe->error, "%s", integrator.error());
        return -1;
    }
    const auto recorded =
        std::min<std::size_t>(system.events.size(), static_cast<std::size_t>(max_events));
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
