// One FMU instance of any FMI version: state machine, checked access to variables, messages.
//
// FMI's entry points (fmi2_shell.cpp, fmi3_shell.cpp) translate types and status codes and leave the
// rest to this class. Every function that returns false has logged why, and has changed nothing
// unless the model itself failed (see State::failed).
#pragma once

#include "model.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace giveway {

struct SavedState;

enum class State : unsigned {
    instantiated = 1u << 0,
    initialisation_mode = 1u << 1,
    step_mode = 1u << 2,
    terminated = 1u << 3,
    failed = 1u << 4,               // the model reported an error: only reading, reset and freeing are left
    event_mode = 1u << 5,           // Model Exchange
    continuous_time_mode = 1u << 6, // Model Exchange
};

// A set of states in which a call is legal.
using States = unsigned;
constexpr States operator|(State a, State b) { return static_cast<States>(a) | static_cast<States>(b); }
constexpr States operator|(States a, State b) { return a | static_cast<States>(b); }
constexpr States any_state = ~0u;
constexpr States only(State state) { return static_cast<States>(state); }
constexpr bool in(State state, States states) { return (static_cast<States>(state) & states) != 0; }

// The calls that the standards allow in each state; the same for both versions unless an entry point says otherwise.
constexpr States exchange_modes = State::event_mode | State::continuous_time_mode;
constexpr States readable = State::initialisation_mode | State::step_mode | State::terminated | State::failed |
                            State::event_mode | State::continuous_time_mode;
// States in which equations can be evaluated; a failed model may not have reached them.
constexpr States evaluable =
    State::initialisation_mode | State::terminated | State::event_mode | State::continuous_time_mode;
constexpr States writable = State::instantiated | State::initialisation_mode | State::step_mode | State::event_mode |
                            State::continuous_time_mode;

// Where messages go; `context` is the entry points' own object.
using LogFunction = void (*)(void *context, const char *text);

enum class Interface : std::uint8_t { co_simulation, model_exchange };

// Its members stand in four files: instance.cpp (life cycle and messages), instance_variables.cpp,
// instance_exchange.cpp (Model Exchange) and instance_states.cpp (saved states).
class Instance {
public:
    // `has_time_variable`: reference 0 can be read as the current time (FMI 3).
    Instance(Model *model, Interface interface, bool has_time_variable, LogFunction log, void *log_context);
    ~Instance();
    Instance(const Instance &) = delete;
    Instance &operator=(const Instance &) = delete;

    // True if `function` is legal in the current state.
    bool allow(const char *function, States states) { return in(state_, states) || refuse_state(function); }

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

    // The whole state. `saved` is a handle: one that was freed, or never given out, is refused. A state that *saved
    // stands for before is replaced.
    bool get_state(const char *function, void **saved);
    bool set_state(const char *function, const void *saved);
    bool free_state(const char *function, void **saved);
    bool serialised_size(const char *function, const void *saved, std::size_t *size);
    bool serialise(const char *function, const void *saved, unsigned char *bytes, std::size_t size);
    bool deserialise(const char *function, const unsigned char *bytes, std::size_t size, void **saved);

    // As allow, for what only Co-Simulation has.
    bool allow_stepping(const char *function, States states);

    // Model Exchange. Counts are those of the arrays that the importer hands over.
    bool allow_exchange(const char *function, States states);
    bool enter_event_mode(const char *function, States states);
    bool update_events(const char *function, EventUpdate &update);
    bool enter_continuous_time_mode(const char *function);
    // `event_needed`: the step passed an event at which no root finder has stopped.
    bool completed_step(const char *function, bool &event_needed);
    bool set_time(const char *function, double time);
    bool set_states(const char *function, const double *values, std::size_t count);
    bool get_states(const char *function, double *values, std::size_t count);
    bool get_derivatives(const char *function, double *values, std::size_t count);
    bool get_indicators(const char *function, double *values, std::size_t count);
    bool get_nominals(const char *function, States states, double *values, std::size_t count);

    bool get_real(const char *function, const std::uint32_t *references, std::size_t count, double *values);
    bool get_integer(const char *function, const std::uint32_t *references, std::size_t count, std::int32_t *values);
    bool get_boolean(const char *function, const std::uint32_t *references, std::size_t count, bool *values);
    bool get_boolean(const char *function, const std::uint32_t *references, std::size_t count, int *values);
    // All of them are set or, if one is refused, none.
    bool set_real(const char *function, const std::uint32_t *references, std::size_t count, const double *values);
    bool set_integer(const char *function, const std::uint32_t *references, std::size_t count,
                     const std::int32_t *values);
    bool set_boolean(const char *function, const std::uint32_t *references, std::size_t count, const bool *values);
    bool set_boolean(const char *function, const std::uint32_t *references, std::size_t count, const int *values);

    double time() const { return time_; }
    State state() const { return state_; }

private:
    template <class Archive> void archive(Archive &a) {
        a(interface_);
        a(state_);
        a(time_);
        a(stop_time_);
        a(initialised_);
        a(outputs_fresh_);
        a(update_pending_);
        a(discontinuities_);
        a(discontinuity_seen_);
    }
    template <typename T, typename Theirs>
    bool get(const char *function, VariableType type, const std::uint32_t *references, std::size_t count,
             Theirs *values);
    template <typename T, typename Theirs>
    bool set(const char *function, VariableType type, const std::uint32_t *references, std::size_t count,
             const Theirs *values);
    // `previous`: the result of the last call, null if there was none.
    const VariableInfo *find(const char *function, std::uint32_t reference, VariableType type,
                             const VariableInfo *previous);
    const VariableInfo *search(const char *function, std::uint32_t reference, VariableType type);
    bool check_references(const char *function, const std::uint32_t *references, std::size_t count, const void *values);
    const SavedState *find_state(const char *function, const void *saved);
    bool keep_state(const char *function, std::unique_ptr<unsigned char[]> bytes, std::size_t size, void **saved);
    bool check_settable(const char *function, const VariableInfo &variable);
    bool check_value(const char *function, const VariableInfo &variable, double value);
    bool check_array(const char *function, const void *values, std::size_t count, std::size_t expected,
                     const char *what);
    // States that the model integrates.
    static std::size_t integrated_count() { return model_info().state_count == 0 ? 0 : model_info().state_count - 1; }
    void write_states(double *values);
    void write_derivatives(double *values);
    bool readable_exchange(const char *function);
    bool ensure_initialised(const char *function);
    // Outputs, states, derivatives and indicators in the Variables struct belong to what was set.
    void refresh(Causality causality);
    const char *state_variable_name(std::size_t index) const;
    const char *state_name() const;
    bool refuse_state(const char *function); // not allowed in it; always false
    bool fail(const char *function, Message &message);

    Model *model_;
    Equations *equations_; // of a Model Exchange instance, else nullptr
    Interface interface_;
    bool has_time_variable_;
    const VariableInfo *end_; // of the variable table
    LogFunction log_;
    void *log_context_;
    State state_ = State::instantiated;
    double time_ = 0.0;
    double stop_time_ = 0.0;
    bool initialised_ = false;    // the outputs in the initialisation mode belong to the values set
    bool outputs_fresh_ = true;   // Model Exchange: the outputs belong to time, states and inputs
    bool update_pending_ = false; // the last event update asked for another
    // The last of the states that an importer sees. It grows by one in every event at which inputs or equations jump:
    // then a state has formally changed, so an importer that restarts its solver only on such a change does so.
    double discontinuities_ = 0.0;
    bool discontinuity_seen_ = false; // it grows in the last update of this event
};

} // namespace giveway
