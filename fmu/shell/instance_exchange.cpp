// Model Exchange: states, derivatives, event indicators, events.
#include "instance.hpp"

#include <cmath>
#include <cstring>

namespace giveway {

bool Instance::allow_exchange(const char *function, States states) {
    if (model_->equations() == nullptr) {
        return unsupported(function, "Model Exchange");
    }
    if (equations_ == nullptr) {
        return refuse(function, "this instance, in state '%s', was made for Co-Simulation, not for Model Exchange",
                      state_name());
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
                      state_name());
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

} // namespace giveway
