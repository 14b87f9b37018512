// Runs over fixed steps, in groups of designs side by side.
#pragma once

#include <cstddef>

#include "run.hpp"

namespace giveway::batch {

// How a batch is to be run.
struct FixedStep {
    int lanes;           // 1, 4 or 8
    double plant_step_s; // longest step wanted; 0: as long as the design allows
};

// Widest lanes of this processor.
int widest_lanes();

// Runs `count` specs one after the other or side by side; results[i] is that of specs[i], independent of the others. A
// design that cannot run with fixed steps runs event-exact. Calls done() once for each run when its result is written.
class RunDone {
public:
    virtual ~RunDone() = default;
    virtual void done() = 0;
};
void run_fixed_step(const gwb_spec_t *specs, std::size_t count, const FixedStep &how, Monitor &monitor,
                    gwb_result_t *results, RunDone &listener);

} // namespace giveway::batch
