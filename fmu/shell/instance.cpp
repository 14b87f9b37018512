#include "instance.hpp"

#include "handles.hpp"
#include "saved_state.hpp"
#include "state_archive.hpp"
#include "times.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <new>
#include <utility>

namespace giveway {
namespace {

// Of the saved states; one for all instances, which may take over each other's states.
Handles saved_states;

// Communication points are sums of step sizes; how far they may be off what we expect, as a share of the step (an
// importer's sum over a million steps is off by less than 1e-9 of a step), or by the rounding of two times that were
// added up differently.
constexpr double share_of_step = 1e-6;

double time_tolerance(double time, double expected, double step_size) {
    return std::max(share_of_step * step_size, std::max(time_rounding(time), time_rounding(expected)));
}

// Two times with the smallest number of digits, at least nine, that distinguishes them.
struct TwoTimes {
    char first[32];
    char second[32];

    TwoTimes(double one, double other) {
        int digits = 9;
        do {
            std::snprintf(first, sizeof first, "%.*g", digits, one);
            std::snprintf(second, sizeof second, "%.*g", digits, other);
        } while (std::strcmp(first, second) == 0 && ++digits <= 17);
    }
};

const char *state_name(State state) {
    switch (state) {
    case State::instantiated:
        return "instantiated";
    case State::initialisation_mode:
        return "initialisation mode";
    case State::step_mode:
        return "step mode";
    case State::terminated:
        return "terminated";
    case State::failed:
        return "failed";
    case State::event_mode:
        return "event mode";
    case State::continuous_time_mode:
        return "continuous-time mode";
    }
    return "";
}

const char *type_name(VariableType type) {
    switch (type) {
    case VariableType::real:
        return "real";
    case VariableType::integer:
        return "integer";
    case VariableType::boolean:
        return "boolean";
    }
    return "";
}

bool in(State state, States states) { return (static_cast<States>(state) & states) != 0; }

} // namespace

Instance::Instance(Model *model, Interface interface, bool has_time_variable, LogFunction log, void *log_context)
    : model_(model), equations_(interface == Interface::model_exchange ? model->equations() : nullptr),
      interface_(interface), has_time_variable_(has_time_variable),
      end_(model_info().variables + model_info().variable_count), log_(log), log_context_(log_context) {}

Instance::~Instance() { delete model_; }

bool Instance::refuse(const char *function, const char *format, ...) {
    char text[1024];
    int length = std::snprintf(text, sizeof text, "%s: ", function);
    if (length < 0 || static_cast<std::size_t>(length) >= sizeof text) {
        length = 0;
    }
    std::va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(text + length, sizeof text - static_cast<std::size_t>(length), format, arguments);
    va_end(arguments);
    log_(log_context_, text);
    return false;
}

bool Instance::allow(const char *function, States states) {
    return in(state_, states) || refuse(function, "not allowed in state '%s'", state_name(state_));
}

bool Instance::unsupported(const char *function, const char *what) {
    return refuse(function, "this FMU does not support %s (in state '%s', as in any)", what, state_name(state_));
}

bool Instance::fail(const char *function, Message &message) {
    message.text[sizeof message.text - 1] = '\0';
    state_ = State::failed;
    return refuse(function, "%s", message.text[0] != '\0' ? message.text : "the model failed without a message");
}

bool Instance::ensure_initialised(const char *function) {
    if (initialised_) {
        return true;
    }
    Message message{};
    if (model_->initialise(time_, message) != Status::ok) {
        return fail(function, message);
    }
    if (equations_ != nullptr) {
        equations_->set_time(time_);
    }
    initialised_ = true;
    outputs_fresh_ = true;
    return true;
}

bool Instance::enter_initialisation(const char *function, double start_time, double stop_time) {
    if (!allow(function, only(State::instantiated))) {
        return false;
    }
    if (!std::isfinite(start_time)) {
        return refuse(function, "start time is %g, but must be finite", start_time);
    }
    if (std::fabs(start_time) > greatest_start_time_s) {
        return refuse(function,
                      "start time is %.9g s, but must be in [%.9g, %.9g]: later times are too coarse for a servo tick",
                      start_time, -greatest_start_time_s, greatest_start_time_s);
    }
    if (!(stop_time >= start_time)) {
        const TwoTimes times(stop_time, start_time);
        return refuse(function, "stop time is %s s, but must not be before the start time, %s s", times.first,
                      times.second);
    }
    time_ = start_time;
    stop_time_ = stop_time;
    initialised_ = false;
    state_ = State::initialisation_mode;
    return true;
}

bool Instance::exit_initialisation(const char *function) {
    if (!allow(function, only(State::initialisation_mode)) || !ensure_initialised(function)) {
        return false;
    }
    update_pending_ = false;
    state_ = equations_ != nullptr ? State::event_mode : State::step_mode;
    return true;
}

bool Instance::step(const char *function, double time, double step_size) {
    if (!allow_stepping(function, only(State::step_mode))) {
        return false;
    }
    if (!(step_size > 0.0) || !std::isfinite(step_size)) {
        return refuse(function, "communication step size is %g s, but must be positive", step_size);
    }
    const double tolerance = time_tolerance(time, time_, step_size);
    if (!(std::fabs(time - time_) <= tolerance)) {
        const TwoTimes times(time, time_);
        return refuse(function, "communication point is %s s, but the last step ended at %s s", times.first,
                      times.second);
    }
    if (!(time + step_size > time)) {
        return refuse(function, "communication step size is %.9g s, too small to be added to %.9g s", step_size, time);
    }
    if (time + step_size > stop_time_ + tolerance) {
        const TwoTimes times(time + step_size, stop_time_);
        return refuse(function, "the step would end at %s s, after the stop time, %s s", times.first, times.second);
    }
    Message message{};
    if (model_->step(time, step_size, message) != Status::ok) {
        return fail(function, message);
    }
    time_ = time + step_size;
    return true;
}

bool Instance::terminate(const char *function) {
    if (!allow(function, only(State::step_mode) | exchange_modes)) {
        return false;
    }
    refresh(Causality::output);
    state_ = State::terminated;
    return true;
}

bool Instance::allow_exchange(const char *function, States states) {
    if (model_->equations() == nullptr) {
        return unsupported(function, "Model Exchange");
    }
    if (equations_ == nullptr) {
        return refuse(function, "this instance, in state '%s', was made for Co-Simulation, not for Model Exchange",
                      state_name(state_));
    }
    return allow(function, states);
}

bool Instance::allow_stepping(const char *function, States states) {
    if (interface_ != Interface::co_simulation) {
        return refuse(function, "this instance, in state '%s', was made for Model Exchange, not for Co-Simulation",
                      state_name(state_));
    }
    return allow(function, states);
}

bool Instance::enter_event_mode(const char *function, States states) {
    if (!allow_exchange(function, states)) {
        return false;
    }
    state_ = State::event_mode;
    return true;
}

bool Instance::update_events(const char *function, EventUpdate &update) {
    if (!allow_exchange(function, only(State::event_mode))) {
        return false;
    }
    Message message{};
    update = EventUpdate{};
    double *before =
        reinterpret_cast<double *>(static_cast<unsigned char *>(model_->variables()) + model_info().states_offset);
    write_states(before);
    if (equations_->update_events(update, message) != Status::ok) {
        return fail(function, message);
    }
    const bool jumped = std::memcmp(before, equations_->states(), integrated_count() * sizeof(double)) != 0;
    discontinuity_seen_ = discontinuity_seen_ || jumped || update.discontinuity;
    const bool counted = discontinuity_seen_ && !update.again;
    if (counted) {
        discontinuities_ += 1.0;
        discontinuity_seen_ = false;
    }
    update.states_changed = jumped || counted;
    update_pending_ = update.again;
    outputs_fresh_ = false;
    return true;
}

bool Instance::enter_continuous_time_mode(const char *function) {
    if (!allow_exchange(function, only(State::event_mode))) {
        return false;
    }
    if (update_pending_) {
        return refuse(function, "not allowed in state '%s': the last update of discrete states asked for another one",
                      state_name(state_));
    }
    state_ = State::continuous_time_mode;
    return true;
}

bool Instance::completed_step(const char *function, bool &event_needed) {
    event_needed = false;
    if (!allow_exchange(function, only(State::continuous_time_mode))) {
        return false;
    }
    unsigned char *data = static_cast<unsigned char *>(model_->variables());
    const ModelInfo &info = model_info();
    double *indicators = reinterpret_cast<double *>(data + info.indicators_offset);
    equations_->indicators(indicators);
    for (std::size_t i = 0; i < info.indicator_count; ++i) {
        event_needed = event_needed || indicators[i] <= 0.0;
    }
    return true;
}

bool Instance::set_time(const char *function, double time) {
    if (!allow_exchange(function, exchange_modes)) {
        return false;
    }
    if (!std::isfinite(time)) {
        return refuse(function, "time is %g, but must be finite", time);
    }
    time_ = time;
    equations_->set_time(time);
    outputs_fresh_ = false;
    return true;
}

bool Instance::check_array(const char *function, const void *values, std::size_t count, std::size_t expected,
                           const char *what) {
    if (count != expected) {
        return refuse(function, "%zu values, but this FMU has %zu %s", count, expected, what);
    }
    return count == 0 || values != nullptr || refuse(function, "values are a null pointer");
}

const char *Instance::state_variable_name(std::size_t index) const {
    const ModelInfo &info = model_info();
    for (std::size_t i = 0; i < info.variable_count; ++i) {
        if (info.variables[i].causality == Causality::local &&
            info.variables[i].offset == info.states_offset + index * sizeof(double)) {
            return info.variables[i].name;
        }
    }
    return "";
}

bool Instance::set_states(const char *function, const double *values, std::size_t count) {
    if (!allow_exchange(function, only(State::continuous_time_mode)) ||
        !check_array(function, values, count, model_info().state_count, "continuous states")) {
        return false;
    }
    for (std::size_t i = 0; i < count; ++i) {
        if (!std::isfinite(values[i])) {
            return refuse(function, "state %s is %g, but must be finite", state_variable_name(i), values[i]);
        }
    }
    std::memcpy(equations_->states(), values, integrated_count() * sizeof(double));
    discontinuities_ = values[integrated_count()];
    outputs_fresh_ = false;
    return true;
}

bool Instance::readable_exchange(const char *function) {
    return allow_exchange(function, evaluable) &&
           (state_ != State::initialisation_mode || ensure_initialised(function));
}

bool Instance::get_states(const char *function, double *values, std::size_t count) {
    if (!readable_exchange(function) ||
        !check_array(function, values, count, model_info().state_count, "continuous states")) {
        return false;
    }
    write_states(values);
    return true;
}

bool Instance::get_derivatives(const char *function, double *values, std::size_t count) {
    if (!readable_exchange(function) ||
        !check_array(function, values, count, model_info().state_count, "continuous states")) {
        return false;
    }
    write_derivatives(values);
    return true;
}

bool Instance::get_indicators(const char *function, double *values, std::size_t count) {
    if (!readable_exchange(function) ||
        !check_array(function, values, count, model_info().indicator_count, "event indicators")) {
        return false;
    }
    equations_->indicators(values);
    return true;
}

bool Instance::get_nominals(const char *function, States states, double *values, std::size_t count) {
    if (!allow_exchange(function, states) ||
        !check_array(function, values, count, model_info().state_count, "continuous states")) {
        return false;
    }
    std::memcpy(values, model_info().state_nominals, count * sizeof(double));
    return true;
}

void Instance::write_states(double *values) {
    std::memcpy(values, model_->equations()->states(), integrated_count() * sizeof(double));
    values[integrated_count()] = discontinuities_;
}

void Instance::write_derivatives(double *values) {
    model_->equations()->derivatives(values);
    values[integrated_count()] = 0.0;
}

void Instance::refresh(Causality causality) {
    Equations *equations = model_->equations();
    if (equations_ != nullptr && causality == Causality::output && !outputs_fresh_) {
        equations_->write_outputs();
        outputs_fresh_ = true;
    }
    if (equations != nullptr && causality == Causality::local) {
        unsigned char *data = static_cast<unsigned char *>(model_->variables());
        const ModelInfo &info = model_info();
        write_states(reinterpret_cast<double *>(data + info.states_offset));
        write_derivatives(reinterpret_cast<double *>(data + info.derivatives_offset));
        equations->indicators(reinterpret_cast<double *>(data + info.indicators_offset));
    }
}

bool Instance::reset(const char *function) {
    if (!allow(function, writable | State::terminated | State::failed)) {
        return false;
    }
    model_->reset();
    discontinuities_ = 0.0;
    discontinuity_seen_ = false;
    time_ = 0.0;
    state_ = State::instantiated;
    return true;
}

const SavedState *Instance::find_state(const char *function, const void *saved) {
    const auto *state = static_cast<const SavedState *>(saved_states.find(saved));
    if (state == nullptr) {
        refuse(function, saved == nullptr ? "the saved state is a null pointer"
                                          : "there is no such saved state, or it was freed");
    }
    return state;
}

bool Instance::get_state(const char *function, void **saved) {
    if (saved == nullptr) {
        return refuse(function, "the state's address is a null pointer");
    }
    StateWriter counter(nullptr);
    archive(counter);
    const std::size_t own = counter.size();
    const std::size_t size = own + model_->save_state(nullptr);
    std::unique_ptr<unsigned char[]> bytes(new (std::nothrow) unsigned char[sizeof(StateHeader) + size]);
    if (bytes == nullptr) {
        return refuse(function, "out of memory");
    }
    StateWriter writer(bytes.get() + sizeof(StateHeader));
    archive(writer);
    (void)model_->save_state(bytes.get() + sizeof(StateHeader) + own);
    seal(bytes.get(), size);
    return keep_state(function, std::move(bytes), sizeof(StateHeader) + size, saved);
}

// Fills the state that *saved stands for, or a new one if that is null or was never one: some importers leave the
// pointer uninitialised.
bool Instance::keep_state(const char *function, std::unique_ptr<unsigned char[]> bytes, std::size_t size,
                          void **saved) {
    if (saved_states.was_given_out(*saved)) {
        auto *old = static_cast<SavedState *>(saved_states.find(*saved));
        if (old == nullptr) {
            return refuse(function, "there is no such saved state to fill, or it was freed");
        }
        *old = SavedState{std::move(bytes), size};
        return true;
    }
    std::unique_ptr<SavedState> state(new (std::nothrow) SavedState{std::move(bytes), size});
    void *handle = state == nullptr ? nullptr : saved_states.add(state.get());
    if (handle == nullptr) {
        return refuse(function, "out of memory");
    }
    (void)state.release(); // the handle's
    *saved = handle;
    return true;
}

bool Instance::set_state(const char *function, const void *saved) {
    const SavedState *state = find_state(function, saved);
    if (state == nullptr) {
        return false;
    }
    StateWriter counter(nullptr);
    archive(counter);
    const std::size_t own = counter.size();
    if (state->size < sizeof(StateHeader) + own) {
        return refuse(function, "the saved state is too short for this FMU");
    }
    const Interface interface = interface_;
    StateReader reader(state->bytes.get() + sizeof(StateHeader), own);
    archive(reader);
    if (interface_ != interface) {
        interface_ = interface;
        state_ = State::failed;
        return refuse(function, "the state was saved by an instance of the other interface "
                                "(Co-Simulation, Model Exchange)");
    }
    Message message{};
    const std::size_t before = sizeof(StateHeader) + own;
    if (model_->load_state(state->bytes.get() + before, state->size - before, message) != Status::ok) {
        return fail(function, message);
    }
    return true;
}

bool Instance::free_state(const char *function, void **saved) {
    if (saved_states.was_given_out(saved)) {
        return refuse(function, "this is the saved state itself, but must be the address of where it is kept");
    }
    if (saved == nullptr || *saved == nullptr) {
        return true; // nothing to free, as the standard has it
    }
    auto *state = static_cast<SavedState *>(saved_states.remove(*saved));
    if (state == nullptr) {
        return refuse(function, "there is no such saved state, or it was freed");
    }
    delete state;
    *saved = nullptr;
    return true;
}

bool Instance::serialised_size(const char *function, const void *saved, std::size_t *size) {
    const SavedState *state = find_state(function, saved);
    if (state == nullptr) {
        return false;
    }
    if (size == nullptr) {
        return refuse(function, "the size is a null pointer");
    }
    *size = state->size;
    return true;
}

bool Instance::serialise(const char *function, const void *saved, unsigned char *bytes, std::size_t size) {
    const SavedState *state = find_state(function, saved);
    if (state == nullptr) {
        return false;
    }
    if (bytes == nullptr) {
        return refuse(function, "the bytes are a null pointer");
    }
    if (size < state->size) {
        return refuse(function, "room for %zu bytes, but the state has %zu", size, state->size);
    }
    std::memcpy(bytes, state->bytes.get(), state->size);
    return true;
}

bool Instance::deserialise(const char *function, const unsigned char *bytes, std::size_t size, void **saved) {
    if (saved == nullptr) {
        return refuse(function, "the state's address is a null pointer");
    }
    const char *fault = state_fault(bytes, size);
    if (fault != nullptr) {
        return refuse(function, "the state cannot be used: %s", fault);
    }
    std::unique_ptr<unsigned char[]> copy(new (std::nothrow) unsigned char[size]);
    if (copy == nullptr) {
        return refuse(function, "out of memory");
    }
    std::memcpy(copy.get(), bytes, size);
    *saved = nullptr; // an importer need not have set it
    return keep_state(function, std::move(copy), size, saved);
}

inline const VariableInfo *Instance::find(const char *function, std::uint32_t reference, VariableType type,
                                          const VariableInfo *previous) {
    // Importers ask for variables in the order of the table more often than not.
    if (previous != nullptr && previous + 1 < end_ && previous[1].reference == reference && previous[1].type == type) {
        return previous + 1;
    }
    return search(function, reference, type);
}

const VariableInfo *Instance::search(const char *function, std::uint32_t reference, VariableType type) {
    const VariableInfo *first = model_info().variables;
    std::size_t count = model_info().variable_count;
    while (count > 0) {
        const std::size_t half = count / 2;
        const bool above = first[half].reference < reference;
        first = above ? first + half + 1 : first;
        count = above ? count - half - 1 : half;
    }
    if (first == end_ || first->reference != reference) {
        refuse(function, "there is no variable with value reference %u", static_cast<unsigned>(reference));
        return nullptr;
    }
    if (first->type != type) {
        refuse(function, "variable %s is %s, not %s", first->name, type_name(first->type), type_name(type));
        return nullptr;
    }
    return first;
}

bool Instance::check_settable(const char *function, const VariableInfo &variable) {
    if (variable.causality == Causality::output || variable.causality == Causality::local) {
        return refuse(function, "variable %s is %s and cannot be set", variable.name,
                      variable.causality == Causality::output ? "an output" : "local");
    }
    if (variable.causality == Causality::parameter && !in(state_, State::instantiated | State::initialisation_mode)) {
        return refuse(function, "variable %s is a fixed parameter and cannot be set in state '%s'", variable.name,
                      state_name(state_));
    }
    // In continuous time the standards allow continuous inputs only. FMPy 0.3.32 passes all of them there, so a
    // discrete one is accepted, and waits for the next event.
    return true;
}

// With a wrong count we would read beyond the importer's array.
bool Instance::check_references(const char *function, const std::uint32_t *references, std::size_t count,
                                const void *values) {
    const std::size_t all = model_info().variable_count + (has_time_variable_ ? 1 : 0);
    if (count > all) {
        return refuse(function, "%zu value references, but this FMU has %zu variables", count, all);
    }
    return count == 0 || (references != nullptr && values != nullptr) ||
           refuse(function, "value references or values are a null pointer");
}

bool Instance::check_value(const char *function, const VariableInfo &variable, double value) {
    if (!std::isfinite(value)) {
        if (variable.allow_nonfinite) {
            return true;
        }
    } else if (value >= variable.minimum && value <= variable.maximum) {
        return true;
    }
    return refuse(function, "variable %s is %.17g, but must be finite and in [%.17g, %.17g]", variable.name, value,
                  variable.minimum, variable.maximum);
}

// T is the variables' type, Theirs the importer's: FMI 2 has booleans as int.
template <typename T, typename Theirs>
bool Instance::get(const char *function, VariableType type, const std::uint32_t *references, std::size_t count,
                   Theirs *values) {
    if (!allow(function, readable) || !check_references(function, references, count, values)) {
        return false;
    }
    const unsigned char *data = static_cast<const unsigned char *>(model_->variables());
    bool locals_fresh = false;
    bool outputs_fresh = false;
    const VariableInfo *variable = nullptr;
    for (std::size_t i = 0; i < count; ++i) {
        if constexpr (sizeof(T) == sizeof(double)) {
            if (has_time_variable_ && references[i] == 0) {
                values[i] = time_;
                continue;
            }
        }
        variable = find(function, references[i], type, variable);
        if (variable == nullptr) {
            return false;
        }
        if (variable->causality == Causality::output || variable->causality == Causality::local) {
            if (state_ == State::initialisation_mode && !ensure_initialised(function)) {
                return false;
            }
            // Once per call: all locals are evaluated together.
            bool &fresh = variable->causality == Causality::local ? locals_fresh : outputs_fresh;
            if (!fresh && state_ != State::failed) {
                refresh(variable->causality);
            }
            fresh = true;
        }
        T value;
        std::memcpy(&value, data + variable->offset, sizeof(T));
        values[i] = static_cast<Theirs>(value);
    }
    return true;
}

template <typename T, typename Theirs>
bool Instance::set(const char *function, VariableType type, const std::uint32_t *references, std::size_t count,
                   const Theirs *values) {
    if (!allow(function, writable) || !check_references(function, references, count, values)) {
        return false;
    }
    // All are checked before the first is written. If they are few, their places are remembered and not looked up
    // again.
    constexpr std::size_t remembered = 16;
    std::size_t offsets[remembered];
    const VariableInfo *variable = nullptr;
    for (std::size_t i = 0; i < count; ++i) {
        variable = find(function, references[i], type, variable);
        if (variable == nullptr || !check_settable(function, *variable) ||
            !check_value(function, *variable, static_cast<double>(static_cast<T>(values[i])))) {
            return false;
        }
        if (i < remembered) {
            offsets[i] = variable->offset;
        }
    }
    unsigned char *data = static_cast<unsigned char *>(model_->variables());
    bool jumps = false;
    for (std::size_t i = 0; i < count; ++i) {
        if (i >= remembered) {
            variable = find(function, references[i], type, i == remembered ? nullptr : variable);
        }
        const T value = static_cast<T>(values[i]);
        unsigned char *target = data + (i < remembered ? offsets[i] : variable->offset);
        jumps = jumps || std::memcmp(target, &value, sizeof(T)) != 0;
        std::memcpy(target, &value, sizeof(T));
    }
    discontinuity_seen_ = discontinuity_seen_ || (jumps && state_ == State::event_mode);
    initialised_ = false;
    outputs_fresh_ = false;
    return true;
}

bool Instance::get_real(const char *function, const std::uint32_t *references, std::size_t count, double *values) {
    return get<double>(function, VariableType::real, references, count, values);
}

bool Instance::get_integer(const char *function, const std::uint32_t *references, std::size_t count,
                           std::int32_t *values) {
    return get<std::int32_t>(function, VariableType::integer, references, count, values);
}

bool Instance::get_boolean(const char *function, const std::uint32_t *references, std::size_t count, bool *values) {
    return get<bool>(function, VariableType::boolean, references, count, values);
}

bool Instance::get_boolean(const char *function, const std::uint32_t *references, std::size_t count, int *values) {
    return get<bool>(function, VariableType::boolean, references, count, values);
}

bool Instance::set_real(const char *function, const std::uint32_t *references, std::size_t count,
                        const double *values) {
    return set<double>(function, VariableType::real, references, count, values);
}

bool Instance::set_integer(const char *function, const std::uint32_t *references, std::size_t count,
                           const std::int32_t *values) {
    return set<std::int32_t>(function, VariableType::integer, references, count, values);
}

bool Instance::set_boolean(const char *function, const std::uint32_t *references, std::size_t count,
                           const bool *values) {
    return set<bool>(function, VariableType::boolean, references, count, values);
}

bool Instance::set_boolean(const char *function, const std::uint32_t *references, std::size_t count,
                           const int *values) {
    return set<bool>(function, VariableType::boolean, references, count, values);
}

} // namespace giveway
