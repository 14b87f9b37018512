// One integration method between two fresh starts: integrates to a time, or to the first event before it.
#pragma once

#include "problem.hpp"

namespace giveway::solver {

enum class Outcome { reached, event, failed };

class Stepper {
public:
    virtual ~Stepper() = default;
    // Each returns SUNDIALS' code, 0 when all is well. `problem` outlives the stepper.
    [[nodiscard]] virtual int create(Problem &problem, double time_s, const IntegratorOptions &options) = 0;
    // The history belongs to another function: start again from the problem's state, which may have been written to.
    // `first_step_s` is a guess for a good first step, 0: unknown.
    [[nodiscard]] virtual int restart(double time_s, double first_step_s) = 0;
    // Moves the problem's state and `time_s` to end_s exactly, or to the first event. After a failure both are those of
    // the last accepted step, and code() is the reason.
    [[nodiscard]] virtual Outcome evolve(double end_s, double &time_s) = 0;

    // After an event: which indicator crossed zero, and in which direction.
    virtual void fired(int *direction) const = 0;
    // A guess for the next restart.
    [[nodiscard]] virtual double first_step() const = 0;
    [[nodiscard]] virtual double last_step() const = 0;
    [[nodiscard]] virtual std::int64_t steps() const = 0;
    [[nodiscard]] virtual int code() const = 0;
    // SUNDIALS' name of a code; the caller frees it.
    [[nodiscard]] virtual char *code_name(int code) const = 0;
};

// A system that needs more steps than this between two stops is too stiff for the method.
inline constexpr long max_steps_between_stops = 100'000;

// The reason behind a code, in words.
[[nodiscard]] const char *reason(int code);

// nullptr when memory is short.
[[nodiscard]] Stepper *new_erk_stepper();
[[nodiscard]] Stepper *new_cvode_stepper(Method method);

} // namespace giveway::solver
