#include "models.hpp"

namespace giveway::batch {

void store(const VariableInfo &variable, unsigned char *variables, double value) {
    unsigned char *place = variables + variable.offset;
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
