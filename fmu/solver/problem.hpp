// A hybrid system for SUNDIALS: context, vectors and callbacks shared by all methods.
#pragma once

#include <cstdint>

#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sundials/sundials_matrix.h>

#include "hybrid_system.hpp"
#include "integrator_options.hpp"

namespace giveway::solver {

class Problem {
public:
    Problem() = default;
    ~Problem();
    Problem(const Problem &) = delete;
    Problem &operator=(const Problem &) = delete;

    // False when memory is short.
    [[nodiscard]] bool create(HybridSystem &system, const double *state, const IntegratorOptions &options);

    [[nodiscard]] HybridSystem &system() const { return *system_; }
    [[nodiscard]] SUNContext context() const { return context_; }
    [[nodiscard]] N_Vector state() const { return state_; }
    [[nodiscard]] N_Vector tolerance() const { return tolerance_; }
    [[nodiscard]] std::int64_t rhs_calls() const { return rhs_calls_; }
    [[nodiscard]] std::int64_t jacobian_calls() const { return jacobian_calls_; }
    // The first state whose rate was infinite or not a number in the latest evaluation; -1: none.
    [[nodiscard]] int bad_rate() const;

    // Time of the last step that ARKODE accepted.
    [[nodiscard]] double accepted_time() const { return accepted_time_s_; }
    void set_accepted_time(double time_s) { accepted_time_s_ = time_s; }

    // Callbacks; `user` is the Problem.
    static int rhs(sunrealtype time, N_Vector y, N_Vector rate, void *user);
    // Positive, that is "try a shorter step", where a rate is not finite.
    static int checked_rhs(sunrealtype time, N_Vector y, N_Vector rate, void *user);
    static int roots(sunrealtype time, N_Vector y, sunrealtype *value, void *user);
    static int accepted(sunrealtype time, N_Vector y, void *user);
    static int jacobian(sunrealtype time, N_Vector y, N_Vector rate, SUNMatrix matrix, void *user, N_Vector, N_Vector,
                        N_Vector);

private:
    HybridSystem *system_ = nullptr;
    SUNContext context_ = nullptr;
    N_Vector state_ = nullptr;
    N_Vector tolerance_ = nullptr;
    std::int64_t rhs_calls_ = 0;
    std::int64_t jacobian_calls_ = 0;
    double accepted_time_s_ = 0.0;
    N_Vector latest_rate_ = nullptr; // SUNDIALS' vector, alive as long as the stepper
};

} // namespace giveway::solver
