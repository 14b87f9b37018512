#include "hybrid_integrator.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <new>

#include <arkode/arkode_erkstep.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>

namespace giveway::solver {

namespace {

// A system that fires this often without getting on is chattering: an answer would not mean anything.
constexpr int max_events_per_advance = 2000;
constexpr int max_event_count = 32;

} // namespace

struct HybridIntegrator::Memory {
    HybridSystem* system = nullptr;
    SUNContext context = nullptr;
    N_Vector state = nullptr;
    N_Vector tolerance = nullptr;
    void* arkode = nullptr;
    std::int64_t rhs_calls = 0;

    ~Memory() {
        if (arkode != nullptr) {
            ARKodeFree(&arkode);
        }
        if (tolerance != nullptr) {
            N_VDestroy(tolerance);
        }
        if (state != nullptr) {
            N_VDestroy(state);
        }
        if (context != nullptr) {
            SUNContext_Free(&context);
        }
    }

    static int rhs(sunrealtype time, N_Vector y, N_Vector rate, void* user) {
        auto* self = static_cast<Memory*>(user);
        ++self->rhs_calls;
        self->system->rhs(time, NV_DATA_S(y), NV_DATA_S(rate));
        return 0;
    }
    static int roots(sunrealtype time, N_Vector y, sunrealtype* value, void* user) {
        auto* self = static_cast<Memory*>(user);
        self->system->indicators(time, NV_DATA_S(y), value);
        return 0;
    }
    // SUNDIALS prints to stderr unless told otherwise; failures are reported through error() instead.
    static void silent(int, const char*, const char*, const char*, SUNErrCode, void*, SUNContext) {}
};

HybridIntegrator::~HybridIntegrator() { delete memory_; }

bool HybridIntegrator::fail(const char* what, int code) {
    char* name = ARKodeGetReturnFlagName(code);
    std::snprintf(error_, sizeof error_, "%s at t = %.9g s (%s)", what, time_s_, name != nullptr ? name : "no code");
    std::free(name); // allocated by SUNDIALS
    return false;
}

bool HybridIntegrator::create(HybridSystem& system, double time_s, const double* state, const IntegratorOptions& options) {
    delete memory_;
    time_s_ = time_s;
    step_hint_s_ = 0.0;
    last_event_time_s_ = -1.0;
    fresh_ = true;
    statistics_ = {};
    const int count = system.state_count();
    memory_ = new (std::nothrow) Memory;
    if (memory_ == nullptr || SUNContext_Create(SUN_COMM_NULL, &memory_->context) != 0) {
        return fail("no memory for the integrator", ARK_MEM_FAIL);
    }
    Memory& memory = *memory_;
    memory.system = &system;
    SUNContext_ClearErrHandlers(memory.context);
    SUNContext_PushErrHandler(memory.context, Memory::silent, nullptr);
    memory.state = N_VNew_Serial(count, memory.context);
    memory.tolerance = N_VNew_Serial(count, memory.context);
    if (memory.state == nullptr || memory.tolerance == nullptr) {
        return fail("no memory for the integrator", ARK_MEM_FAIL);
    }
    for (int i = 0; i < count; ++i) {
        NV_Ith_S(memory.state, i) = state[i];
        NV_Ith_S(memory.tolerance, i) = system.absolute_tolerance(i) * options.absolute_tolerance_scale;
    }
    memory.arkode = ERKStepCreate(Memory::rhs, time_s, memory.state, memory.context);
    if (memory.arkode == nullptr) {
        return fail("no memory for the integrator", ARK_MEM_FAIL);
    }
    int code = ARKodeSetUserData(memory.arkode, memory_);
    code = code != 0 ? code : ERKStepSetTableNum(memory.arkode, ARKODE_DORMAND_PRINCE_7_4_5);
    code = code != 0 ? code : ARKodeSVtolerances(memory.arkode, options.relative_tolerance, memory.tolerance);
    code = code != 0 ? code : ARKodeSetMaxNumSteps(memory.arkode, 100000);
    if (options.maximum_step_s > 0.0) {
        code = code != 0 ? code : ARKodeSetMaxStep(memory.arkode, options.maximum_step_s);
    }
    if (system.event_count() > 0) {
        code = code != 0 ? code : ARKodeRootInit(memory.arkode, system.event_count(), Memory::roots);
        // An indicator that starts at zero (a mode just entered) is watched from its first move on.
        code = code != 0 ? code : ARKodeSetNoInactiveRootWarn(memory.arkode);
    }
    return code == 0 || fail("the integrator refuses its options", code);
}

double* HybridIntegrator::state() { return NV_DATA_S(memory_->state); }

bool HybridIntegrator::advance(double end_s) {
    Memory& memory = *memory_;
    for (int event = 0; event <= max_events_per_advance; ++event) {
        if (time_s_ >= end_s) {
            return true;
        }
        if (!fresh_) {
            // A fresh start: the history before an event or an input change is another function's.
            int code = ARKodeReset(memory.arkode, time_s_, memory.state);
            code = code != 0 ? code : ARKodeSetInitStep(memory.arkode, std::min(step_hint_s_, end_s - time_s_));
            if (code != 0) {
                return fail("the integrator cannot restart", code);
            }
        }
        long before = 0;
        long after = 0;
        (void)ARKodeGetNumSteps(memory.arkode, &before);
        (void)ARKodeSetStopTime(memory.arkode, end_s);
        const int code = ARKodeEvolve(memory.arkode, end_s, memory.state, &time_s_, ARK_NORMAL);
        (void)ARKodeGetNumSteps(memory.arkode, &after);
        statistics_.steps += after - before;
        statistics_.rhs_calls = memory.rhs_calls;
        if (code < 0) {
            return fail("the integrator cannot go on", code);
        }
        // A stop time cuts the last step short and hides ARKODE's own proposal: try twice as much; its error test corrects that.
        double last_step_s = 0.0;
        (void)ARKodeGetLastStep(memory.arkode, &last_step_s);
        step_hint_s_ = 2.0 * last_step_s;
        fresh_ = true;
        if (code == ARK_ROOT_RETURN) {
            int fired[max_event_count] = {};
            (void)ARKodeGetRootInfo(memory.arkode, fired);
            memory.system->transition(time_s_, NV_DATA_S(memory.state), fired);
            statistics_.events += 1;
            last_event_time_s_ = time_s_;
            fresh_ = false;
        } else {
            time_s_ = end_s;
        }
    }
    return fail("events follow each other without end", 0);
}

} // namespace giveway::solver
