// The two models of a run and their variable tables, as this library numbers them.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "controller_variables.hpp"
#include "giveway_batch.h"
#include "model.hpp"
#include "testbed_variables.hpp"

namespace giveway::batch {

inline const ModelInfo &info_of(std::uint32_t model) {
    return model == GWB_CONTROLLER ? controller::model_info() : testbed::model_info();
}

// Null if the model has no such variable.
inline const VariableInfo *find(const ModelInfo &info, std::uint32_t reference) {
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
    const bool found = first < info.variable_count && info.variables[first].reference == reference;
    return found ? &info.variables[first] : nullptr;
}

inline const VariableInfo *find(const ModelInfo &info, const char *name) {
    for (std::size_t i = 0; i < info.variable_count; ++i) {
        if (std::strcmp(info.variables[i].name, name) == 0) {
            return &info.variables[i];
        }
    }
    return nullptr;
}

inline std::size_t size_of(VariableType type) {
    switch (type) {
    case VariableType::real:
        return sizeof(double);
    case VariableType::integer:
        return sizeof(std::int32_t);
    case VariableType::boolean:
        return sizeof(bool);
    }
    return 0;
}

// True if an importer of the FMU could set this value: of the type, in range, and finite unless the table allows else.
inline bool allowed(const VariableInfo &variable, double value) {
    if (!std::isfinite(value)) {
        return variable.type == VariableType::real && variable.allow_nonfinite;
    }
    switch (variable.type) {
    case VariableType::real:
        break;
    case VariableType::integer:
        if (!(value >= INT32_MIN && value <= INT32_MAX) || value != std::trunc(value)) {
            return false;
        }
        break;
    case VariableType::boolean:
        if (value != 0.0 && value != 1.0) {
            return false;
        }
        break;
    }
    return value >= variable.minimum && value <= variable.maximum;
}

// The variable of this type that lies at `place`.
inline double load(VariableType type, const unsigned char *place) {
    if (type == VariableType::real) {
        double value = 0.0;
        std::memcpy(&value, place, sizeof value);
        return value;
    }
    if (type == VariableType::integer) {
        std::int32_t value = 0;
        std::memcpy(&value, place, sizeof value);
        return value;
    }
    bool value = false;
    std::memcpy(&value, place, sizeof value);
    return value ? 1.0 : 0.0;
}

// `value` is allowed.
void store(const VariableInfo &variable, unsigned char *variables, double value);

} // namespace giveway::batch
