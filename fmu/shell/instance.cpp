#include "instance.hpp"

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>

namespace giveway {
namespace {

constexpr States readable =
    State::initialisation_mode | State::step_mode | State::terminated | State::failed;
constexpr States writable = State::instantiated | State::initialisation_mode | State::step_mode;

// Communication points are sums of step sizes; how far they may be off what we expect, as a share of
// the step (an importer's sum over a million steps is off by less than 1e-9 of a step).
constexpr double time_tolerance = 1e-6;

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

Instance::Instance(Model *model, bool has_time_variable, LogFunction log, void *log_context)
    : model_(model), has_time_variable_(has_time_variable), log_(log), log_context_(log_context) {}

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
    return refuse(function, "this FMU does not support %s", what);
}

bool Instance::fail(const char *function, Message &message) {
    message.text[sizeof message.text - 1] = '\0';
    state_ = State::failed;
    return refuse(function, "%s",
                  message.text[0] != '\0' ? message.text : "the model failed without a message");
}

bool Instance::ensure_initialised(const char *function) {
    if (initialised_) {
        return true;
    }
    Message message{};
    if (model_->initialise(time_, message) != Status::ok) {
        return fail(function, message);
    }
    initialised_ = true;
    return true;
}

bool Instance::enter_initialisation(const char *function, double start_time, double stop_time) {
    if (!allow(function, only(State::instantiated))) {
        return false;
    }
    if (!std::isfinite(start_time)) {
        return refuse(function, "start time is %g, but must be finite", start_time);
    }
    if (!(stop_time >= start_time)) {
        return refuse(function, "stop time is %g s, but must not be before the start time, %g s",
                      stop_time, start_time);
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
    state_ = State::step_mode;
    return true;
}

bool Instance::step(const char *function, double time, double step_size) {
    if (!allow(function, only(State::step_mode))) {
        return false;
    }
    if (!(step_size > 0.0) || !std::isfinite(step_size)) {
        return refuse(function, "communication step size is %g s, but must be positive", step_size);
    }
    const double tolerance = time_tolerance * step_size;
    if (!(std::fabs(time - time_) <= tolerance)) {
        return refuse(function, "communication point is %.9g s, but the last step ended at %.9g s",
                      time, time_);
    }
    if (time + step_size > stop_time_ + tolerance) {
        return refuse(function, "the step would end at %.9g s, after the stop time, %.9g s",
                      time + step_size, stop_time_);
    }
    Message message{};
    if (model_->step(time, step_size, message) != Status::ok) {
        return fail(function, message);
    }
    time_ = time + step_size;
    return true;
}

bool Instance::terminate(const char *function) {
    if (!allow(function, only(State::step_mode))) {
        return false;
    }
    state_ = State::terminated;
    return true;
}

bool Instance::reset(const char *function) {
    if (!allow(function, writable | State::terminated | State::failed)) {
        return false;
    }
    model_->reset();
    time_ = 0.0;
    state_ = State::instantiated;
    return true;
}

const VariableInfo *Instance::find(const char *function, std::uint32_t reference,
                                   VariableType type) {
    const ModelInfo &info = model_info();
    std::size_t first = 0;
    std::size_t last = info.variable_count;
    while (first < last) {
        const std::size_t middle = first + (last - first) / 2;
        if (info.variables[middle].reference < reference) {
            first = middle + 1;
        } else {
            last = middle;
        }
    }
    if (first == info.variable_count || info.variables[first].reference != reference) {
        refuse(function, "there is no variable with value reference %u",
               static_cast<unsigned>(reference));
        return nullptr;
    }
    const VariableInfo &variable = info.variables[first];
    if (variable.type != type) {
        refuse(function, "variable %s is %s, not %s", variable.name, type_name(variable.type),
               type_name(type));
        return nullptr;
    }
    return &variable;
}

bool Instance::check_settable(const char *function, const VariableInfo &variable) {
    if (variable.causality == Causality::output) {
        return refuse(function, "variable %s is an output and cannot be set", variable.name);
    }
    if (variable.causality == Causality::parameter && state_ == State::step_mode) {
        return refuse(function, "variable %s is a fixed parameter and cannot be set in state '%s'",
                      variable.name, state_name(state_));
    }
    return true;
}

bool Instance::check_value(const char *function, const VariableInfo &variable, double value) {
    if (!std::isfinite(value)) {
        if (variable.allow_nonfinite) {
            return true;
        }
    } else if (value >= variable.minimum && value <= variable.maximum) {
        return true;
    }
    return refuse(function, "variable %s is %.17g, but must be finite and in [%.17g, %.17g]",
                  variable.name, value, variable.minimum, variable.maximum);
}

template <typename T>
bool Instance::get(const char *function, VariableType type, const std::uint32_t *references,
                   std::size_t count, T *values) {
    if (!allow(function, readable)) {
        return false;
    }
    if (count > 0 && (references == nullptr || values == nullptr)) {
        return refuse(function, "value references or values are a null pointer");
    }
    const unsigned char *data = static_cast<const unsigned char *>(model_->variables());
    for (std::size_t i = 0; i < count; ++i) {
        if constexpr (sizeof(T) == sizeof(double)) {
            if (has_time_variable_ && references[i] == 0) {
                values[i] = time_;
                continue;
            }
        }
        const VariableInfo *variable = find(function, references[i], type);
        if (variable == nullptr) {
            return false;
        }
        if (variable->causality == Causality::output && state_ == State::initialisation_mode &&
            !ensure_initialised(function)) {
            return false;
        }
        std::memcpy(&values[i], data + variable->offset, sizeof(T));
    }
    return true;
}

template <typename T>
bool Instance::set(const char *function, VariableType type, const std::uint32_t *references,
                   std::size_t count, const T *values) {
    if (!allow(function, writable)) {
        return false;
    }
    if (count > 0 && (references == nullptr || values == nullptr)) {
        return refuse(function, "value references or values are a null pointer");
    }
    for (std::size_t i = 0; i < count; ++i) {
        const VariableInfo *variable = find(function, references[i], type);
        if (variable == nullptr || !check_settable(function, *variable) ||
            !check_value(function, *variable, static_cast<double>(values[i]))) {
            return false;
        }
    }
    unsigned char *data = static_cast<unsigned char *>(model_->variables());
    for (std::size_t i = 0; i < count; ++i) {
        const VariableInfo *variable = find(function, references[i], type);
        std::memcpy(data + variable->offset, &values[i], sizeof(T));
    }
    initialised_ = false;
    return true;
}

bool Instance::get_real(const char *function, const std::uint32_t *references, std::size_t count,
                        double *values) {
    return get(function, VariableType::real, references, count, values);
}

bool Instance::get_integer(const char *function, const std::uint32_t *references, std::size_t count,
                           std::int32_t *values) {
    return get(function, VariableType::integer, references, count, values);
}

bool Instance::get_boolean(const char *function, const std::uint32_t *references, std::size_t count,
                           bool *values) {
    return get(function, VariableType::boolean, references, count, values);
}

bool Instance::set_real(const char *function, const std::uint32_t *references, std::size_t count,
                        const double *values) {
    return set(function, VariableType::real, references, count, values);
}

bool Instance::set_integer(const char *function, const std::uint32_t *references, std::size_t count,
                           const std::int32_t *values) {
    return set(function, VariableType::integer, references, count, values);
}

bool Instance::set_boolean(const char *function, const std::uint32_t *references, std::size_t count,
                           const bool *values) {
    return set(function, VariableType::boolean, references, count, values);
}

} // namespace giveway
