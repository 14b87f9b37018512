// State events as an importer sees them in Model Exchange: with hysteresis, so that an event that just happened does
// not happen again.
#pragma once

#include <array>

#include "hybrid_system.hpp"

namespace giveway {

class ExchangeableSystem : public solver::HybridSystem {
public:
    // Where the indicator is while the present mode lasts: above zero (+1) or below (-1).
    [[nodiscard]] virtual int side(int event) const = 0;
    // How far past zero an importer meets the event, in the indicator's unit: small against what matters, large against
    // rounding and the importer's tolerance.
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

// Makes every transition that is due, and those that follow from them. Returns how many there were.
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
