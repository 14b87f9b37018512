// One run, event-exact: the FMUs' models, stepped in the exchange order of the co-simulation.
#pragma once

#include <atomic>
#include <cstdint>

#include "giveway_batch.h"

namespace giveway::batch {

// Progress and cancellation, shared by a run and the waiting thread.
struct Monitor {
    std::atomic<bool> cancelled{false};
    std::atomic<std::uint64_t> steps_done{0};
};

// Writes all of `result`. A run that ends early counts all of its steps as done.
void run(const gwb_spec_t &spec, Monitor &monitor, gwb_result_t &result);

// Marks a run that never started.
void never_started(gwb_result_t &result);

} // namespace giveway::batch
