#include "instance.hpp"

#include "times.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>

namespace giveway {
namespace {

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

} // namespace

const char *Instance::state_name() const {
    switch (state_) {
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

bool Instance::refuse_state(const char *function) {
    return refuse(function, "not allowed in state '%s'", state_name());
}

bool Instance::unsupported(const char *function, const char *what) {
    return refuse(function, "this FMU does not support %s (in state '%s', as in any)", what, state_name());
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

bool Instance::allow_stepping(const char *function, States states) {
    if (interface_ != Interface::co_simulation) {
        return refuse(function, "this instance, in state '%s', was made for Model Exchange, not for Co-Simulation",
                      state_name());
    }
    return allow(function, states);
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

} // namespace giveway
