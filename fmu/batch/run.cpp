#include "run.hpp"

#include <cstdio>
#include <new>

#include "recorded_run.hpp"

namespace giveway::batch {

void run(const gwb_spec_t &spec, Monitor &monitor, gwb_result_t &result) {
    RecordedRun recorded(spec, monitor, result);
    const std::unique_ptr<Model> plant(testbed::create_model());
    if (plant == nullptr) {
        recorded.end(GWB_NO_MEMORY, "no memory for a run of %u steps", static_cast<unsigned>(spec.step_count));
        return;
    }
    Message message{};
    if (!recorded.prepare(*static_cast<testbed::Variables *>(plant->variables())) || !recorded.start_controller()) {
        return;
    }
    if (plant->initialise(0.0, message) != Status::ok) {
        recorded.model_failed(GWB_REFUSED, GWB_TESTBED, message);
        return;
    }
    SampleRoom room;
    if (!recorded.begin(room)) {
        return;
    }
    for (std::uint32_t k = 0; recorded.exchange(k); ++k) {
        if (k == spec.step_count) {
            recorded.judge();
            return;
        }
        if (plant->step(recorded.time_s(k), spec.step_s, message) != Status::ok) {
            recorded.model_failed(GWB_FAILED, GWB_TESTBED, message);
            return;
        }
        recorded.report(k + 1);
    }
}

void never_started(gwb_result_t &result) {
    clear(result);
    result.status = GWB_CANCELLED;
    std::snprintf(result.message, sizeof result.message, "cancelled before the start");
}

} // namespace giveway::batch
