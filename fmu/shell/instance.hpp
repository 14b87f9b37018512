// One FMU instance, whatever the FMI version: state machine, checked access to variables, messages.
//
// FMI's entry points (fmi2_shell.cpp, fmi3_shell.cpp) translate types and status codes and leave the
// rest to this class. Every function that returns false has logged why, and has changed nothing
// unless the model itself failed (see State::failed).
#pragma once

#include "model.hpp"

#include <cstddef>
#include <cstdint>

namespace giveway {

enum class State : unsigned {
    instantiated = 1u << 0,
    initialisation_mode = 1u << 1,
    step_mode = 1u << 2,
    terminated = 1u << 3,
    failed = 1u << 4, // the model reported an error: only reading, reset and freeing are left
};

// A set of states in which a call is legal.
using States = unsigned;
constexpr States operator|(State a, State b) {
    return static_cast<States>(a) | static_cast<States>(b);
}
constexpr States operator|(States a, State b) { return a | static_cast<States>(b); }
constexpr States only(State state) { return static_cast<States>(state); }

// Where messages go; `context` is the entry points' own object.
using LogFunction = void (*)(void *context, const char *text);

class Instance {
public:
    // `has_time_variable`: reference 0 can be read as the current time (FMI 3).
    Instance(Model *model, bool has_time_variable, LogFunction log, void *log_context);
    ~Instance();
    Instance(const Instance &) = delete;
    Instance &operator=(const Instance &) = delete;

    // True if `function` is legal in the current state.
    bool allow(const char *function, States states);

    // Logs that `function` does something this FMU cannot do; always false.
    bool unsupported(const char *function, const char *what);

    // Logs "<function>: <printf-style text>"; always false.
    [[gnu::format(printf, 3, 4)]] bool refuse(const char *function, const char *format, ...);

    // Stop time is infinity if there is none.
    bool enter_initialisation(const char *function, double start_time, double stop_time);
    bool exit_initialisation(const char *function);
    bool step(const char *function, double time, double step_size);
    bool terminate(const char *function);
    bool reset(const char *function);

    bool get_real(const char *function, const std::uint32_t *references, std::size_t count,
                  double *values);
    bool get_integer(const char *function, const std::uint32_t *references, std::size_t count,
                     std::int32_t *values);
    bool get_boolean(const char *function, const std::uint32_t *references, std::size_t count,
                     bool *values);
    // All of them are set or, if one is refused, none.
    bool set_real(const char *function, const std::uint32_t *references, std::size_t count,
                  const double *values);
    bool set_integer(const char *function, const std::uint32_t *references, std::size_t count,
                     const std::int32_t *values);
    bool set_boolean(const char *function, const std::uint32_t *references, std::size_t count,
                     const bool *values);

    double time() const { return time_; }
    State state() const { return state_; }

private:
    template <typename T>
    bool get(const char *function, VariableType type, const std::uint32_t *references,
             std::size_t count, T *values);
    template <typename T>
    bool set(const char *function, VariableType type, const std::uint32_t *references,
             std::size_t count, const T *values);
    const VariableInfo *find(const char *function, std::uint32_t reference, VariableType type);
    bool check_settable(const char *function, const VariableInfo &variable);
    bool check_value(const char *function, const VariableInfo &variable, double value);
    bool ensure_initialised(const char *function);
    bool fail(const char *function, Message &message);

    Model *model_;
    bool has_time_variable_;
    LogFunction log_;
    void *log_context_;
    State state_ = State::instantiated;
    double time_ = 0.0;
    double stop_time_ = 0.0;
    bool initialised_ = false; // the outputs in the initialisation mode belong to the values set
};

} // namespace giveway
