// The metrics of a collision, computed from samples of a run; each metric's definition is its line in GWB_METRICS.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

#include "giveway_batch.h"
#include "sample.hpp"

namespace giveway::batch {

struct ForceLimits {
    double transient_n, lasting_n; // as in gwb_spec_t
};

// Fills value and truth ([GWB_METRIC_COUNT] each); NaN for events that did not happen. At least one sample; the models'
// variables hold the run's parameters.
void evaluate(const Sample *samples, std::size_t count, const testbed::Variables &testbed,
              const controller::Variables &controller, const ForceLimits &limits, double *value, double *truth);

// gwb_judge_force, with time_s(row) and force_n(row).
template <class Time, class Force>
gwb_force_t judge_force(std::size_t rows, const Time &time_s, const Force &force_n, double touch_n) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr double long_ago_s = -std::numeric_limits<double>::infinity();
    gwb_force_t found{0.0, nan, 0.0, nan, 0.0, 1, 0};
    double began_s = long_ago_s;
    double touched_s = long_ago_s;
    double first_s = long_ago_s;
    for (std::size_t i = 0; i < rows; ++i) {
        const double now_s = time_s(i);
        const double force = force_n(i);
        if (!(force > touch_n)) {
            continue;
        }
        if (now_s - touched_s >= GWB_TRANSIENT_WINDOW_S) {
            began_s = now_s;
        }
        first_s = touched_s == long_ago_s ? now_s : first_s;
        touched_s = now_s;
        const double since_s = now_s - began_s;
        found.longest_contact_s = std::max(found.longest_contact_s, since_s);
        const bool transient = since_s <= GWB_TRANSIENT_WINDOW_S;
        double &largest = transient ? found.transient_n : found.lasting_n;
        if (force > largest) {
            largest = force;
            (transient ? found.transient_time_s : found.lasting_time_s) = now_s;
        }
    }
    found.lasting_known = first_s == long_ago_s || time_s(rows - 1) - first_s > GWB_TRANSIENT_WINDOW_S ? 1 : 0;
    return found;
}

} // namespace giveway::batch
