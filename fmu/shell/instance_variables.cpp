// Reading and setting variables by value reference.
#include "instance.hpp"

#include <cmath>
#include <cstring>

namespace giveway {
namespace {

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

} // namespace

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
                      state_name());
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
