// Adaptive explicit Runge-Kutta (ARKODE, Dormand-Prince 5(4)) with located events. The only room that knows SUNDIALS.
#pragma once

#include <cstdint>

#include "hybrid_system.hpp"

namespace giveway::solver {

struct IntegratorOptions {
    double relative_tolerance = 1e-6;
    double absolute_tolerance_scale = 1.0; // multiplies the system's absolute tolerances
    double maximum_step_s = 0.0;           // 0: no limit
};

struct IntegratorStatistics {
    std::int64_t steps, rhs_calls, events;
};

class HybridIntegrator {
public:
    HybridIntegrator() = default;
    ~HybridIntegrator();
    HybridIntegrator(const HybridIntegrator&) = delete;
    HybridIntegrator& operator=(const HybridIntegrator&) = delete;

    // False when SUNDIALS refuses or memory is short; error() says why. `system` must outlive the integrator.
    [[nodiscard]] bool create(HybridSystem& system, double time_s, const double* state, const IntegratorOptions& options);
    // The state, writable between advances; call restart() after writing or after an input changed.
    [[nodiscard]] double* state();
    [[nodiscard]] double time() const { return time_s_; }
    void restart() { fresh_ = false; }
    // Integrates to exactly end_s, through any number of events. False on failure; error() names time and reason.
    [[nodiscard]] bool advance(double end_s);
    [[nodiscard]] const char* error() const { return error_; }
    [[nodiscard]] IntegratorStatistics statistics() const { return statistics_; }
    [[nodiscard]] double last_event_time() const { return last_event_time_s_; }

private:
    struct Memory;
    [[nodiscard]] bool fail(const char* what, int code);

    Memory* memory_ = nullptr;
    double time_s_ = 0.0;
    double step_hint_s_ = 0.0;
    double last_event_time_s_ = -1.0;
    bool fresh_ = true; // the integrator's history belongs to the current inputs and modes
    IntegratorStatistics statistics_ = {};
    char error_[256] = "";
};

} // namespace giveway::solver
