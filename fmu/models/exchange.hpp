// State events for an importer in Model Exchange: with hysteresis, so that an event does not happen twice.
#pragma once

#include <array>

#include "hybrid_system.hpp"

namespace giveway {

class ExchangeableSystem : public solver::HybridSystem {
public:
    // Sign of the indicator in the present mode: above zero (+1) or below (-1).
    [[nodiscard]] virtual int side(int event) const = 0;
    // Distance beyond zero at which an importer sees the event, in the indicator's unit: small compared with relevant
    // values, large compared with rounding and the importer's tolerance.
    [[nodiscard]] virtual double hysteresis(int event) const = 0;
};

inline constexpr int max_indicators = 32;
inline constexpr int too_many_events = -1;

// Positive while the present modes last.
inline void margins(ExchangeableSystem &system, double time_s, const double *state, double *value) {
    system.indicators(time_s, state, value);
    for (int i = 0; i < system.event_count(); ++i) {
        value[i] = system.side(i) * value[i] + system.hysteresis(i);
    }
}

// Makes all due transitions and those that follow from them. Returns their number.
inline int settle(ExchangeableSystem &system, double time_s, double *state) {
    constexpr int max_rounds = 100; // more at one instant is chatter
    for (int round = 0; round < max_rounds; ++round) {
        std::array<double, max_indicators> value{};
        margins(system, time_s, state, value.data());
        std::array<int, max_indicators> fired{};
        bool any = false;
        for (int i = 0; i < system.event_count(); ++i) {
            const auto index = static_cast<std::size_t>(i);
            fired[index] = value[index] <= 0.0 ? -system.side(i) : 0;
            any = any || fired[index] != 0;
        }
        if (!any) {
            return round;
        }
        system.transition(time_s, state, fired.data());
    }
    return too_many_events;
}

} // namespace giveway
