#include "models.hpp"

#include <cmath>

namespace giveway::batch {

bool allowed(const VariableInfo& variable, double value) {
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

double load(const VariableInfo& variable, const unsigned char* variables) {
    const unsigned char* place = variables + variable.offset;
    if (variable.type == VariableType::real) {
        double value = 0.0;
        std::memcpy(&value, place, sizeof value);
        return value;
    }
    if (variable.type == VariableType::integer) {
        std::int32_t value = 0;
        std::memcpy(&value, place, sizeof value);
        return value;
    }
    bool value = false;
    std::memcpy(&value, place, sizeof value);
    return value ? 1.0 : 0.0;
}

void store(const VariableInfo& variable, unsigned char* variables, double value) {
    unsigned char* place = variables + variable.offset;
    if (variable.type == VariableType::real) {
        std::memcpy(place, &value, sizeof value);
    } else if (variable.type == VariableType::integer) {
        const auto whole = static_cast<std::int32_t>(value);
        std::memcpy(place, &whole, sizeof whole);
    } else {
        const bool yes = value != 0.0;
        std::memcpy(place, &yes, sizeof yes);
    }
}

} // namespace giveway::batch
