// Common code of the models that integrate, over their generated Variables structs.
#pragma once

#include <cstdint>
#include <cstdio>

#include "exchange.hpp"
#include "hybrid_integrator.hpp"
#include "model.hpp"

namespace giveway {

// Events of Model Exchange, where the importer integrates; in Co-Simulation the integrator counts its own.
struct ExchangedEvents {
    std::int32_t count = 0;
    double last_s = 0.0; // since the start
};

template <class Variables>
[[nodiscard]] solver::IntegratorOptions solver_options(const Variables &v, double start_time_s) {
    solver::IntegratorOptions options{
        .relative_tolerance = v.solver_relative_tolerance,
        .absolute_tolerance_scale = v.solver_absolute_scale,
        .maximum_step_s = v.solver_maximum_step,
        .clock_start_s = start_time_s,
    };
    if constexpr (requires { v.solver_method; }) {
        options.method = static_cast<solver::Method>(v.solver_method);
    }
    return options;
}

// The integrator's error as the model's.
[[nodiscard]] inline Status failure(const solver::HybridIntegrator &integrator, Message &message) {
    std::snprintf(message.text, sizeof message.text, "%s", integrator.error());
    return Status::error;
}

// Makes all transitions due at now_s after the start. False if they follow each other without end.
[[nodiscard]] inline bool settle_events(ExchangeableSystem &system, double now_s, double *states, double start_time_s,
                                        ExchangedEvents &events, EventUpdate &update, Message &message) {
    const int count = settle(system, now_s, states);
    if (count == too_many_events) {
        std::snprintf(message.text, sizeof message.text, "events follow each other without end at t = %.9g s",
                      start_time_s + now_s);
        return false;
    }
    if (count > 0) {
        events.count += count;
        events.last_s = now_s;
        update.discontinuity = true;
    }
    return true;
}

template <class Variables>
void write_statistics(Variables &v, const solver::HybridIntegrator &integrator, const ExchangedEvents &events,
                      double start_time_s) {
    const auto statistics = integrator.statistics(); // empty in Model Exchange
    const double last_event_s = events.count > 0 ? events.last_s : integrator.last_event_time();
    v.events = static_cast<std::int32_t>(statistics.events) + events.count;
    v.last_event_time = v.events == 0 ? -1.0 : start_time_s + last_event_s;
    v.solver_steps = static_cast<std::int32_t>(statistics.steps);
    v.solver_rhs_calls = static_cast<std::int32_t>(statistics.rhs_calls);
    if constexpr (requires { v.solver_jacobian_calls; }) {
        v.solver_jacobian_calls = static_cast<std::int32_t>(statistics.jacobian_calls);
    }
}

} // namespace giveway
