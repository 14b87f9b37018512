// Adaptive integration with located events, by one of three methods of SUNDIALS. Only this room uses SUNDIALS.
#pragma once

#include "hybrid_system.hpp"
#include "integrator_options.hpp"

namespace giveway::solver {

// Plain data.
struct Checkpoint {
    double time_s, step_hint_s, last_event_time_s;
    IntegratorStatistics statistics;
};

class HybridIntegrator {
public:
    HybridIntegrator() = default;
    ~HybridIntegrator();
    HybridIntegrator(const HybridIntegrator &) = delete;
    HybridIntegrator &operator=(const HybridIntegrator &) = delete;

    // False when SUNDIALS refuses or memory is short; error() says why. `system` must outlive the integrator.
    [[nodiscard]] bool create(HybridSystem &system, double time_s, const double *state,
                              const IntegratorOptions &options);
    // Continues from the checkpoint of another integrator with the same system and options.
    [[nodiscard]] bool resume(HybridSystem &system, const Checkpoint &checkpoint, const double *state,
                              const IntegratorOptions &options);
    // Together with the state it is complete, provided that restart() is called before the next advance(): a fresh
    // start needs no history.
    [[nodiscard]] Checkpoint checkpoint() const { return {time_s_, step_hint_s_, last_event_time_s_, statistics()}; }
    // The state, writable between advances; call restart() after writing or after an input changed.
    [[nodiscard]] double *state();
    [[nodiscard]] double time() const { return time_s_; }
    void restart() { fresh_ = false; }
    // Integrates to exactly end_s, through any number of events. False on failure: error() names time, method and
    // reason, and time() and state() are those of the last good step.
    [[nodiscard]] bool advance(double end_s);
    [[nodiscard]] const char *error() const { return error_; }
    [[nodiscard]] IntegratorStatistics statistics() const;
    [[nodiscard]] double last_event_time() const { return last_event_time_s_; }

private:
    struct Memory;
    [[nodiscard]] bool fail(const char *what, int code);

    Memory *memory_ = nullptr;
    IntegratorOptions options_ = {};
    double time_s_ = 0.0;
    double step_hint_s_ = 0.0;
    double last_event_time_s_ = -1.0;
    bool fresh_ = true; // the integrator's history belongs to the current inputs and modes
    std::int64_t events_ = 0;
    IntegratorStatistics before_ = {}; // of the run that was resumed
    char error_[256] = "";
};

} // namespace giveway::solver
