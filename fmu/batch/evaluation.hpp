// Metrics of traces that were recorded before.
#pragma once

#include "giveway_batch.h"

namespace giveway::batch {

// gwb_evaluate; writes all of `result`.
void evaluate_traces(const gwb_traces_t &traces, gwb_result_t &result);

} // namespace giveway::batch
