// The event loop for any method: from stop to stop, through transitions.
#include "hybrid_integrator.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <new>

#include "stepper.hpp"

namespace giveway::solver {

namespace {

// A system with this many events at one instant is chattering: its result would be meaningless.
constexpr int max_events_per_advance = 2000;
constexpr int max_event_count = 32;

} // namespace

struct HybridIntegrator::Memory {
    Problem problem;
    std::unique_ptr<Stepper> stepper; // freed before the problem, whose vectors it uses
};

HybridIntegrator::~HybridIntegrator() { delete memory_; }

// `code` 0: `what` is the reason.
bool HybridIntegrator::fail(const char *what, int code) {
    char why[200] = "";
    if (code != 0) {
        const Stepper &stepper = *memory_->stepper;
        const int bad = memory_->problem.bad_rate();
        char bad_rate[64] = "";
        std::snprintf(bad_rate, sizeof bad_rate, "the rate of state %d is not a finite number", bad);
        char *code_name = stepper.code_name(code);
        // A last step of zero length means that the state has reached a singularity.
        std::snprintf(why, sizeof why, ": %s (%s, last step %.3g s)", bad >= 0 ? bad_rate : reason(code),
                      code_name != nullptr ? code_name : "no code", stepper.last_step());
        std::free(code_name); // allocated by SUNDIALS
    }
    std::snprintf(error_, sizeof error_, "%s %s at t = %.9g s%s", name(options_.method), what,
                  options_.clock_start_s + time_s_, why);
    return false;
}

bool HybridIntegrator::create(HybridSystem &system, double time_s, const double *state,
                              const IntegratorOptions &options) {
    delete memory_;
    options_ = options;
    time_s_ = time_s;
    step_hint_s_ = 0.0;
    last_event_time_s_ = -1.0;
    fresh_ = true;
    events_ = 0;
    before_ = {};
    memory_ = new (std::nothrow) Memory;
    if (memory_ == nullptr || !memory_->problem.create(system, state, options)) {
        return fail("has no memory", 0);
    }
    memory_->stepper.reset(options.method == Method::erk ? new_erk_stepper() : new_cvode_stepper(options.method));
    if (memory_->stepper == nullptr) {
        return fail("has no memory", 0);
    }
    const int code = memory_->stepper->create(memory_->problem, time_s, options);
    return code == 0 || fail("refuses its options", code);
}

double *HybridIntegrator::state() { return NV_DATA_S(memory_->problem.state()); }

bool HybridIntegrator::resume(HybridSystem &system, const Checkpoint &checkpoint, const double *state,
                              const IntegratorOptions &options) {
    if (!create(system, checkpoint.time_s, state, options)) {
        return false;
    }
    step_hint_s_ = checkpoint.step_hint_s;
    last_event_time_s_ = checkpoint.last_event_time_s;
    before_ = checkpoint.statistics;
    fresh_ = false;
    return true;
}

IntegratorStatistics HybridIntegrator::statistics() const {
    const Stepper &stepper = *memory_->stepper;
    const Problem &problem = memory_->problem;
    return {before_.steps + stepper.steps(), before_.rhs_calls + problem.rhs_calls(),
            before_.jacobian_calls + problem.jacobian_calls(), before_.events + events_};
}

bool HybridIntegrator::advance(double end_s) {
    Stepper &stepper = *memory_->stepper;
    for (int event = 0; event <= max_events_per_advance; ++event) {
        if (time_s_ >= end_s) {
            return true;
        }
        if (!fresh_) {
            // A fresh start: the history before an event or an input change belongs to another function.
            const int code = stepper.restart(time_s_, std::min(step_hint_s_, end_s - time_s_));
            if (code != 0) {
                return fail("cannot restart", code);
            }
        }
        const Outcome outcome = stepper.evolve(end_s, time_s_);
        if (outcome == Outcome::failed) {
            return fail("cannot go on", stepper.code());
        }
        step_hint_s_ = stepper.first_step();
        fresh_ = outcome == Outcome::reached;
        if (outcome == Outcome::event) {
            int fired[max_event_count] = {};
            stepper.fired(fired);
            memory_->problem.system().transition(time_s_, state(), fired);
            events_ += 1;
            last_event_time_s_ = time_s_;
        }
    }
    return fail("stops: events follow each other without end", 0);
}

} // namespace giveway::solver
