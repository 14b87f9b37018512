// The options of the integrator, and its statistics.
#pragma once

#include <cstdint>

namespace giveway::solver {

enum class Method : std::uint8_t {
    erk = 0,   // explicit Runge-Kutta of Dormand and Prince 5(4), ARKODE
    adams = 1, // Adams-Moulton, orders 1 to 12, fixed-point corrector, CVODE
    bdf = 2,   // backward differentiation, orders 1 to 5, Newton corrector with the system's Jacobian, CVODE
};

constexpr const char *name(Method method) {
    return method == Method::erk ? "ERK" : method == Method::adams ? "Adams" : "BDF";
}

struct IntegratorOptions {
    double relative_tolerance = 1e-6;
    double absolute_tolerance_scale = 1.0; // multiplies the system's absolute tolerances
    double maximum_step_s = 0.0;           // 0: no limit
    Method method = Method::erk;
    double clock_start_s = 0.0; // added to the integrator's time in messages: the caller's time at the integrator's
                                // zero
};

struct IntegratorStatistics {
    std::int64_t steps, rhs_calls, jacobian_calls, events;
};

} // namespace giveway::solver
