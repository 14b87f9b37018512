// The slider's run-up to the robot: the plant's own equations of slider, rail, rope and weight, and its integrator.
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <new>

#include "from_variables.hpp"
#include "giveway_batch.h"
#include "hybrid_integrator.hpp"
#include "models.hpp"

using At = giveway::plant::Layout<>;
namespace plant = giveway::plant;
namespace solver = giveway::solver;
namespace testbed = giveway::testbed;

namespace {

constexpr double tolerance = 1e-6; // as the testbed's
// Between knots the travel is a cubic, good to a micrometre: the rope swings faster than rail friction changes.
constexpr double rope_knot_s = 8e-3;
constexpr double free_knot_s = 32e-3;
constexpr double speed_max_mps = 20.0;
constexpr double start_speed_max_mps = 1000.0; // of a slider that rail friction brings to its speed

// Slider and weight until something ends the motion: then it stands still, whatever time is asked for.
class Slide final : public solver::HybridSystem {
public:
    enum State : int { travel, speed, drop, drop_speed, states };
    enum Event : int { rope, landing, fast_enough, events };
    using StateVector = std::array<double, states>;

    // `direction` -1: backwards in time.
    Slide(const plant::Parameters<double> &parameters, double end_speed_mps, double direction)
        : parameters_(parameters), derived_(plant::derive(parameters)), end_speed_(end_speed_mps),
          direction_(direction) {
        modes_.rope_taut = parameters.rope_attached != 0 ? 1.0 : 0.0;
    }

    [[nodiscard]] bool fast() const { return ended_ && fast_; }
    [[nodiscard]] bool ended() const { return ended_; }
    [[nodiscard]] double end_time() const { return end_time_s_; }

    [[nodiscard]] int state_count() const override { return states; }
    [[nodiscard]] int event_count() const override { return events; }

    void rhs(double, const double *state, double *rate) override {
        std::fill_n(rate, state_count(), 0.0);
        if (ended_) {
            return;
        }
        double loss = 0.0;
        plant::slider_rates(e_, whole(state), modes_, parameters_, derived_, 0.0, loss);
        rate[travel] = e_.rate[At::slider_position];
        rate[speed] = direction_ * e_.rate[At::slider_speed];
        rate[drop] = e_.rate[At::weight_drop];
        rate[drop_speed] = direction_ * e_.rate[At::weight_speed];
    }

    void indicators(double, const double *state, double *value) override {
        plant::EventVector<double> g{};
        plant::slider_indicators(g, whole(state), modes_, parameters_, derived_, -1.0, [] { return 0.0; });
        value[rope] = g[At::event_rope];
        value[landing] = ended_ ? -1.0 : g[At::event_landing];
        value[fast_enough] = ended_ ? -1.0 : state[speed] - end_speed_;
    }

    void transition(double time_s, double *, const int *fired) override {
        if (fired[rope] != 0) {
            modes_.rope_taut = fired[rope] > 0 ? 1.0 : 0.0;
        }
        if (fired[landing] > 0 || fired[fast_enough] > 0) {
            ended_ = true;
            fast_ = fired[fast_enough] > 0;
            end_time_s_ = time_s;
        }
    }

    [[nodiscard]] double absolute_tolerance(int state) const override {
        return state == speed || state == drop_speed ? 1e-8 : 1e-9; // m/s, m
    }

private:
    const plant::StateVector<double> &whole(const double *state) {
        x_[At::slider_position] = state[travel];
        x_[At::slider_speed] = state[speed];
        x_[At::weight_drop] = state[drop];
        x_[At::weight_speed] = state[drop_speed];
        return x_;
    }

    plant::Parameters<double> parameters_;
    plant::Derived<double> derived_;
    plant::Modes<double> modes_{};
    plant::StateVector<double> x_{}; // of which the slider's equations read their part
    plant::Evaluation<double> e_{};
    double end_speed_, direction_;
    bool ended_ = false;
    bool fast_ = false;
    double end_time_s_ = 0.0;
};

struct Field {
    double gwb_run_up_t::*value;
    const char *variable;
};
// Members that are the testbed's variables, with their ranges.
constexpr Field fields[] = {
    {&gwb_run_up_t::slider_mass, "slider.mass"},
    {&gwb_run_up_t::slider_friction, "slider.friction"},
    {&gwb_run_up_t::slider_friction_speed, "slider.friction_speed"},
    {&gwb_run_up_t::slider_damping, "slider.damping"},
    {&gwb_run_up_t::rope_hanging_mass, "rope.hanging_mass"},
    {&gwb_run_up_t::rope_stiffness, "rope.stiffness"},
    {&gwb_run_up_t::rope_damping, "rope.damping"},
    {&gwb_run_up_t::rope_drop_height, "rope.drop_height"},
};

using Ranges = std::array<const giveway::VariableInfo *, std::size(fields)>;

// Looked up once for all run-ups: by name in the table it takes a tenth of a free slider's whole answer.
Ranges ranges_of_fields() {
    Ranges ranges{};
    std::transform(std::begin(fields), std::end(fields), ranges.begin(),
                   [](const Field &field) { return giveway::batch::find(testbed::model_info(), field.variable); });
    return ranges;
}

bool in_range(const gwb_run_up_t &r, const Ranges &ranges) {
    for (std::size_t i = 0; i < std::size(fields); ++i) {
        if (!giveway::batch::allowed(*ranges[i], r.*fields[i].value)) {
            return false;
        }
    }
    const bool speed = r.end_speed_mps >= 0.0 && r.end_speed_mps <= speed_max_mps;
    if (r.rope_attached > 1 || !speed || (r.time_count > 0 && (r.times_s == nullptr || r.travels_m == nullptr))) {
        return false;
    }
    if (r.rope_attached != 0 ? r.end_speed_mps <= 0.0
                             : !(r.duration_s >= 0.0 && r.duration_s <= GWB_RUN_UP_LONGEST_S)) {
        return false;
    }
    return std::is_sorted(r.times_s, r.times_s + r.time_count) && (r.time_count == 0 || r.times_s[0] >= 0.0) &&
           std::all_of(r.times_s, r.times_s + r.time_count, [](double time_s) { return std::isfinite(time_s); });
}

plant::Parameters<double> parameters_of(const plant::Parameters<double> &start, const gwb_run_up_t &r) {
    plant::Parameters<double> p = start;
    p.slider_present = 1;
    p.rope_attached = static_cast<std::int32_t>(r.rope_attached);
    p.bumper_kind = plant::BumperKind::none; // up to the contact the plate rests on the slider
    p.wall_present = 0;
    p.slider_mass = r.slider_mass;
    p.slider_friction = r.slider_friction;
    p.slider_friction_speed = r.slider_friction_speed;
    p.slider_damping = r.slider_damping;
    p.rope_hanging_mass = r.rope_hanging_mass;
    p.rope_stiffness = r.rope_stiffness;
    p.rope_damping = r.rope_damping;
    p.rope_drop_height = r.rope_drop_height;
    return p;
}

// Where the slide is at times that the integrator was asked for.
struct Knot {
    double time_s, travel_m, speed_mps;
};

// Times, travels and speeds of a slide, for what lies in between.
class Path {
public:
    // False when memory is short.
    bool reserve() {
        knots_.reset(new (std::nothrow) Knot[most]);
        return knots_ != nullptr;
    }
    void clear() { count_ = 0; }
    void add(const Knot &knot) { knots_[count_++] = knot; }
    [[nodiscard]] const Knot &last() const { return knots_[count_ - 1]; }

    // The cubic with the travels and speeds of the knots on either side; beyond the last knot its travel.
    [[nodiscard]] double travel_at(double time_s) const {
        const Knot *after = std::upper_bound(knots_.get(), knots_.get() + count_, time_s,
                                             [](double time, const Knot &knot) { return time < knot.time_s; });
        if (after == knots_.get() + count_) {
            return last().travel_m;
        }
        const Knot &b = *after;
        const Knot &a = *(after - 1);
        const double step_s = b.time_s - a.time_s;
        const double share = (time_s - a.time_s) / step_s;
        const double rest = 1.0 - share;
        return rest * rest * ((1.0 + 2.0 * share) * a.travel_m + share * step_s * a.speed_mps) +
               share * share * ((1.0 + 2.0 * rest) * b.travel_m - rest * step_s * b.speed_mps);
    }

    // Turns a motion that was followed backwards around: it starts where it ended.
    void reverse() {
        const Knot end = last();
        std::reverse(knots_.get(), knots_.get() + count_);
        for (std::size_t i = 0; i < count_; ++i) {
            Knot &knot = knots_[i];
            knot = {end.time_s - knot.time_s, end.travel_m - knot.travel_m, knot.speed_mps};
        }
    }

private:
    static constexpr std::size_t most = static_cast<std::size_t>(GWB_RUN_UP_LONGEST_S / rope_knot_s) + 3;
    std::unique_ptr<Knot[]> knots_;
    std::size_t count_ = 0;
};

// Follows the slide from `speed_mps` to its end, at most for longest_s. False if the integrator fails.
bool follow(Slide &slide, double speed_mps, double longest_s, double knot_s, Path &path) {
    const Slide::StateVector state = {0.0, speed_mps, 0.0, 0.0};
    solver::HybridIntegrator integrator;
    if (!integrator.create(slide, 0.0, state.data(), {.relative_tolerance = tolerance})) {
        return false;
    }
    path.clear();
    path.add({0.0, 0.0, speed_mps});
    for (int step = 1; !slide.ended() && path.last().time_s < longest_s; ++step) {
        if (!integrator.advance(std::min(step * knot_s, longest_s))) {
            return false;
        }
        path.add({slide.ended() ? slide.end_time() : integrator.time(), integrator.state()[Slide::travel],
                  integrator.state()[Slide::speed]});
    }
    return true;
}

// Pulled from rest until it is fast enough.
std::uint32_t pull(const plant::Parameters<double> &p, gwb_run_up_t &r, Path &path) {
    Slide slide(p, r.end_speed_mps, 1.0);
    if (!follow(slide, 0.0, GWB_RUN_UP_LONGEST_S, rope_knot_s, path)) {
        return GWB_FAILED;
    }
    r.duration_s = path.last().time_s;
    r.travel_m = path.last().travel_m;
    r.reached_mps = path.last().speed_mps;
    return slide.fast() ? GWB_OK : GWB_REFUSED;
}

// Backwards from the end, where friction makes it faster and faster.
std::uint32_t slide_back(const plant::Parameters<double> &p, gwb_run_up_t &r, Path &path) {
    Slide slide(p, start_speed_max_mps, -1.0);
    if (!follow(slide, r.end_speed_mps, r.duration_s, r.time_count > 0 ? free_knot_s : r.duration_s, path)) {
        return GWB_FAILED;
    }
    r.travel_m = path.last().travel_m;
    r.start_speed_mps = path.last().speed_mps;
    r.reached_mps = r.end_speed_mps;
    path.reverse();
    return slide.fast() ? GWB_REFUSED : GWB_OK;
}

} // namespace

size_t gwb_run_up(gwb_run_up_t *run_ups, size_t count) {
    if (run_ups == nullptr) {
        return 0;
    }
    testbed::Variables variables{};
    testbed::set_start_values(variables);
    const plant::Parameters<double> defaults = testbed::plant_parameters(variables);
    const Ranges ranges = ranges_of_fields();
    Path path;
    const bool memory = path.reserve();
    std::size_t good = 0;
    for (std::size_t i = 0; i < count; ++i) {
        gwb_run_up_t &r = run_ups[i];
        r.start_speed_mps = r.travel_m = r.reached_mps = 0.0;
        if (!in_range(r, ranges)) {
            r.status = GWB_WRONG_SPEC;
        } else if (!memory) {
            r.status = GWB_NO_MEMORY;
        } else {
            const plant::Parameters<double> p = parameters_of(defaults, r);
            r.status = r.rope_attached != 0 ? pull(p, r, path) : slide_back(p, r, path);
        }
        if (r.status == GWB_OK) {
            ++good;
            std::transform(r.times_s, r.times_s + r.time_count, r.travels_m,
                           [&](double time_s) { return path.travel_at(time_s); });
        }
    }
    return good;
}
