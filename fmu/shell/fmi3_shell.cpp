// FMI 3.0 entry points: Co-Simulation and, for models with equations, Model Exchange.
#include "handles.hpp"
#include "instance.hpp"

#include <fmi3Functions.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <new>

namespace {

using giveway::Instance;
using giveway::State;

struct Fmi3Instance {
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log_message;
    Instance instance;

    static void log(void *context, const char *text) {
        const Fmi3Instance *self = static_cast<const Fmi3Instance *>(context);
        if (self->log_message != nullptr) {
            self->log_message(self->environment, fmi3Error, "logStatusError", text);
        }
    }

    Fmi3Instance(fmi3InstanceEnvironment environment_, fmi3LogMessageCallback log_message_, giveway::Model *model,
                 giveway::Interface interface)
        : environment(environment_), log_message(log_message_), instance(model, interface, true, log, this) {}
};

giveway::Handles instances;

// Null if there is no such instance (any more): then the error can only be returned to the caller.
Instance *unwrap(fmi3Instance instance) {
    auto *self = static_cast<Fmi3Instance *>(instances.find(instance));
    return self == nullptr ? nullptr : &self->instance;
}

fmi3Status status(bool ok) { return ok ? fmi3OK : fmi3Error; }

fmi3Status unsupported(fmi3Instance instance, const char *function, const char *what) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && self->unsupported(function, what));
}

fmi3Instance refuse_instance(fmi3InstanceEnvironment environment, fmi3LogMessageCallback log_message,
                             const char *text) {
    if (log_message != nullptr) {
        log_message(environment, fmi3Error, "logStatusError", text);
    }
    return nullptr;
}

fmi3Instance refuse_instance(fmi3InstanceEnvironment environment, fmi3LogMessageCallback log_message,
                             const char *function, const char *what) {
    char text[256];
    std::snprintf(text, sizeof text, "%s: %s", function, what);
    return refuse_instance(environment, log_message, text);
}

fmi3Instance make_instance(const char *function, fmi3String name, fmi3String token, fmi3InstanceEnvironment environment,
                           fmi3LogMessageCallback log_message, giveway::Interface interface) {
    if (name == nullptr || name[0] == '\0') {
        return refuse_instance(environment, log_message, function, "the instance name is missing");
    }
    if (token == nullptr || std::strcmp(token, giveway::model_info().token) != 0) {
        return refuse_instance(environment, log_message, function,
                               "the instantiation token does not match; model description and binary "
                               "are of different builds");
    }
    giveway::Model *model = giveway::create_model();
    if (model != nullptr) {
        Fmi3Instance *self = new (std::nothrow) Fmi3Instance(environment, log_message, model, interface);
        if (self != nullptr) {
            fmi3Instance handle = instances.add(self);
            if (handle == nullptr) {
                delete self;
                return refuse_instance(environment, log_message, function, "out of memory");
            }
            return handle;
        }
        delete model;
    }
    return refuse_instance(environment, log_message, function, "out of memory");
}

// Scalars only: every value reference stands for one value.
bool check_count(Instance &self, const char *function, size_t references, size_t values) {
    return references == values || self.refuse(function, "%zu value references but %zu values", references, values);
}

fmi3Status no_such_type(fmi3Instance instance, const char *function, giveway::States states, size_t count,
                        const char *type) {
    Instance *self = unwrap(instance);
    if (self == nullptr || !self->allow(function, states)) {
        return fmi3Error;
    }
    return status(count == 0 || self->refuse(function, "no variable is of type %s", type));
}

fmi3Status get_count(fmi3Instance instance, const char *function, size_t value, size_t *count) {
    Instance *self = unwrap(instance);
    if (self == nullptr || !self->allow_exchange(function, giveway::any_state)) {
        return fmi3Error;
    }
    if (count == nullptr) {
        return status(self->refuse(function, "the result is a null pointer"));
    }
    *count = value;
    return fmi3OK;
}

} // namespace

extern "C" {

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean, size_t count, const fmi3String categories[]) {
    Instance *self = unwrap(instance);
    if (self == nullptr) {
        return fmi3Error;
    }
    for (size_t i = 0; i < count; ++i) {
        if (categories == nullptr || categories[i] == nullptr || std::strcmp(categories[i], "logStatusError") != 0) {
            return status(self->refuse("fmi3SetDebugLogging", "unknown log category '%s'",
                                       categories != nullptr && categories[i] != nullptr ? categories[i] : "(null)"));
        }
    }
    return fmi3OK; // errors, the only category, are always logged
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String, fmi3Boolean, fmi3Boolean,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback log_message) {
    if (giveway::model_info().state_count == 0) {
        return refuse_instance(environment, log_message,
                               "fmi3InstantiateModelExchange: this FMU does not support Model Exchange");
    }
    return make_instance("fmi3InstantiateModelExchange", name, token, environment, log_message,
                         giveway::Interface::model_exchange);
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log_message,
                                               fmi3ClockUpdateCallback, fmi3LockPreemptionCallback,
                                               fmi3UnlockPreemptionCallback) {
    return refuse_instance(environment, log_message,
                           "fmi3InstantiateScheduledExecution: this FMU does not support Scheduled Execution");
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String, fmi3Boolean, fmi3Boolean,
                                         fmi3Boolean event_mode_used, fmi3Boolean, const fmi3ValueReference[],
                                         size_t intermediate_count, fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback log_message, fmi3IntermediateUpdateCallback) {
    if (event_mode_used) {
        return refuse_instance(environment, log_message, "fmi3InstantiateCoSimulation: this FMU has no event mode");
    }
    if (intermediate_count != 0) {
        return refuse_instance(environment, log_message,
                               "fmi3InstantiateCoSimulation: this FMU has no intermediate update");
    }
    return make_instance("fmi3InstantiateCoSimulation", name, token, environment, log_message,
                         giveway::Interface::co_simulation);
}

void fmi3FreeInstance(fmi3Instance instance) { delete static_cast<Fmi3Instance *>(instances.remove(instance)); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean tolerance_defined, fmi3Float64 tolerance,
                                       fmi3Float64 start_time, fmi3Boolean stop_time_defined, fmi3Float64 stop_time) {
    Instance *self = unwrap(instance);
    if (self == nullptr) {
        return fmi3Error;
    }
    // The tolerances of a model's solver are its parameters; a given one is checked, not used.
    if (tolerance_defined && !(tolerance > 0.0)) {
        return status(self->refuse("fmi3EnterInitializationMode", "tolerance is %g, but must be positive", tolerance));
    }
    const double stop = stop_time_defined ? stop_time : std::numeric_limits<double>::infinity();
    return status(self->enter_initialisation("fmi3EnterInitializationMode", start_time, stop));
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && self->exit_initialisation("fmi3ExitInitializationMode"));
}

fmi3Status fmi3Terminate(fmi3Instance instance) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && self->terminate("fmi3Terminate"));
}

fmi3Status fmi3Reset(fmi3Instance instance) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && self->reset("fmi3Reset"));
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 step_size, fmi3Boolean,
                      fmi3Boolean *event_handling_needed, fmi3Boolean *terminate_simulation, fmi3Boolean *early_return,
                      fmi3Float64 *last_successful_time) {
    Instance *self = unwrap(instance);
    if (self == nullptr) {
        return fmi3Error;
    }
    const bool ok = self->step("fmi3DoStep", time, step_size);
    if (event_handling_needed != nullptr) {
        *event_handling_needed = fmi3False;
    }
    if (terminate_simulation != nullptr) {
        *terminate_simulation = fmi3False;
    }
    if (early_return != nullptr) {
        *early_return = fmi3False;
    }
    if (last_successful_time != nullptr) {
        *last_successful_time = self->time();
    }
    return status(ok);
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                          fmi3Float64 values[], size_t value_count) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && check_count(*self, "fmi3GetFloat64", count, value_count) &&
                  self->get_real("fmi3GetFloat64", references, count, values));
}

fmi3Status fmi3GetInt32(fmi3Instance instance, const fmi3ValueReference references[], size_t count, fmi3Int32 values[],
                        size_t value_count) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && check_count(*self, "fmi3GetInt32", count, value_count) &&
                  self->get_integer("fmi3GetInt32", references, count, values));
}

fmi3Status fmi3GetBoolean(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                          fmi3Boolean values[], size_t value_count) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && check_count(*self, "fmi3GetBoolean", count, value_count) &&
                  self->get_boolean("fmi3GetBoolean", references, count, values));
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                          const fmi3Float64 values[], size_t value_count) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && check_count(*self, "fmi3SetFloat64", count, value_count) &&
                  self->set_real("fmi3SetFloat64", references, count, values));
}

fmi3Status fmi3SetInt32(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                        const fmi3Int32 values[], size_t value_count) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && check_count(*self, "fmi3SetInt32", count, value_count) &&
                  self->set_integer("fmi3SetInt32", references, count, values));
}

fmi3Status fmi3SetBoolean(fmi3Instance instance, const fmi3ValueReference references[], size_t count,
                          const fmi3Boolean values[], size_t value_count) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && check_count(*self, "fmi3SetBoolean", count, value_count) &&
                  self->set_boolean("fmi3SetBoolean", references, count, values));
}

// Types that no giveway FMU has a variable of.
#define GIVEWAY_NO_TYPE(Type) \
    fmi3Status fmi3Get##Type(fmi3Instance instance, const fmi3ValueReference[], size_t count, fmi3##Type[], size_t) { \
        return no_such_type(instance, "fmi3Get" #Type, giveway::readable, count, #Type); \
    } \
    fmi3Status fmi3Set##Type(fmi3Instance instance, const fmi3ValueReference[], size_t count, const fmi3##Type[], \
                             size_t) { \
        return no_such_type(instance, "fmi3Set" #Type, giveway::writable, count, #Type); \
    }
GIVEWAY_NO_TYPE(Float32)
GIVEWAY_NO_TYPE(Int8)
GIVEWAY_NO_TYPE(UInt8)
GIVEWAY_NO_TYPE(Int16)
GIVEWAY_NO_TYPE(UInt16)
GIVEWAY_NO_TYPE(UInt32)
GIVEWAY_NO_TYPE(Int64)
GIVEWAY_NO_TYPE(UInt64)
GIVEWAY_NO_TYPE(String)
#undef GIVEWAY_NO_TYPE

fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference[], size_t count, size_t[], fmi3Binary[],
                         size_t) {
    return no_such_type(instance, "fmi3GetBinary", giveway::readable, count, "Binary");
}

fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference[], size_t count, const size_t[],
                         const fmi3Binary[], size_t) {
    return no_such_type(instance, "fmi3SetBinary", giveway::writable, count, "Binary");
}

fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference[], size_t count, fmi3Clock[]) {
    return no_such_type(instance, "fmi3GetClock", giveway::readable, count, "Clock");
}

fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference[], size_t count, const fmi3Clock[]) {
    return no_such_type(instance, "fmi3SetClock", giveway::writable, count, "Clock");
}

// Functions that the model description does not offer.

fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance) {
    return unsupported(instance, "fmi3EnterConfigurationMode", "a configuration mode");
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance) {
    return unsupported(instance, "fmi3ExitConfigurationMode", "a configuration mode");
}

fmi3Status fmi3EnterStepMode(fmi3Instance instance) {
    return unsupported(instance, "fmi3EnterStepMode", "an event mode to leave");
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance) {
    return unsupported(instance, "fmi3EvaluateDiscreteStates", "an event mode");
}

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && self->get_state("fmi3GetFMUState", state));
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && self->set_state("fmi3SetFMUState", state));
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && self->free_state("fmi3FreeFMUState", state));
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, size_t *size) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && self->serialised_size("fmi3SerializedFMUStateSize", state, size));
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
    Instance *self = unwrap(instance);
    return status(self != nullptr &&
                  self->serialise("fmi3SerializeFMUState", state, reinterpret_cast<unsigned char *>(bytes), size));
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[], size_t size, fmi3FMUState *state) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && self->deserialise("fmi3DeserializeFMUState",
                                                       reinterpret_cast<const unsigned char *>(bytes), size, state));
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance instance, fmi3ValueReference, size_t *) {
    return unsupported(instance, "fmi3GetNumberOfVariableDependencies", "variable dependencies");
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance instance, fmi3ValueReference, size_t[], fmi3ValueReference[],
                                       size_t[], fmi3DependencyKind[], size_t) {
    return unsupported(instance, "fmi3GetVariableDependencies", "variable dependencies");
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference[], size_t,
                                        const fmi3ValueReference[], size_t, const fmi3Float64[], size_t, fmi3Float64[],
                                        size_t) {
    return unsupported(instance, "fmi3GetDirectionalDerivative", "directional derivatives");
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance instance, const fmi3ValueReference[], size_t,
                                    const fmi3ValueReference[], size_t, const fmi3Float64[], size_t, fmi3Float64[],
                                    size_t) {
    return unsupported(instance, "fmi3GetAdjointDerivative", "adjoint derivatives");
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance instance, const fmi3ValueReference[], size_t, const fmi3Int32[],
                                    fmi3Float64[], size_t) {
    return unsupported(instance, "fmi3GetOutputDerivatives", "output derivatives");
}

fmi3Status fmi3GetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference[], size_t, fmi3Float64[],
                                  fmi3IntervalQualifier[]) {
    return unsupported(instance, "fmi3GetIntervalDecimal", "clocks");
}

fmi3Status fmi3GetIntervalFraction(fmi3Instance instance, const fmi3ValueReference[], size_t, fmi3UInt64[],
                                   fmi3UInt64[], fmi3IntervalQualifier[]) {
    return unsupported(instance, "fmi3GetIntervalFraction", "clocks");
}

fmi3Status fmi3GetShiftDecimal(fmi3Instance instance, const fmi3ValueReference[], size_t, fmi3Float64[]) {
    return unsupported(instance, "fmi3GetShiftDecimal", "clocks");
}

fmi3Status fmi3GetShiftFraction(fmi3Instance instance, const fmi3ValueReference[], size_t, fmi3UInt64[], fmi3UInt64[]) {
    return unsupported(instance, "fmi3GetShiftFraction", "clocks");
}

fmi3Status fmi3SetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference[], size_t, const fmi3Float64[]) {
    return unsupported(instance, "fmi3SetIntervalDecimal", "clocks");
}

fmi3Status fmi3SetIntervalFraction(fmi3Instance instance, const fmi3ValueReference[], size_t, const fmi3UInt64[],
                                   const fmi3UInt64[]) {
    return unsupported(instance, "fmi3SetIntervalFraction", "clocks");
}

fmi3Status fmi3SetShiftDecimal(fmi3Instance instance, const fmi3ValueReference[], size_t, const fmi3Float64[]) {
    return unsupported(instance, "fmi3SetShiftDecimal", "clocks");
}

fmi3Status fmi3SetShiftFraction(fmi3Instance instance, const fmi3ValueReference[], size_t, const fmi3UInt64[],
                                const fmi3UInt64[]) {
    return unsupported(instance, "fmi3SetShiftFraction", "clocks");
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference, fmi3Float64) {
    return unsupported(instance, "fmi3ActivateModelPartition", "Scheduled Execution");
}

// Model Exchange.

fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && self->enter_event_mode("fmi3EnterEventMode", only(State::continuous_time_mode)));
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *update_needed,
                                    fmi3Boolean *terminate_simulation, fmi3Boolean *nominals_changed,
                                    fmi3Boolean *states_changed, fmi3Boolean *next_time_defined,
                                    fmi3Float64 *next_time) {
    Instance *self = unwrap(instance);
    giveway::EventUpdate update{};
    if (self == nullptr || !self->update_events("fmi3UpdateDiscreteStates", update)) {
        return fmi3Error;
    }
    const auto hand_over = [](fmi3Boolean *target, bool value) {
        if (target != nullptr) {
            *target = value;
        }
    };
    hand_over(update_needed, update.again);
    hand_over(terminate_simulation, false);
    hand_over(nominals_changed, false);
    hand_over(states_changed, update.states_changed);
    hand_over(next_time_defined, update.has_next_time);
    if (next_time != nullptr) {
        *next_time = update.next_time_s;
    }
    return fmi3OK;
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && self->enter_continuous_time_mode("fmi3EnterContinuousTimeMode"));
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean, fmi3Boolean *enter_event_mode,
                                       fmi3Boolean *terminate_simulation) {
    Instance *self = unwrap(instance);
    bool needed = false;
    if (self == nullptr || !self->completed_step("fmi3CompletedIntegratorStep", needed)) {
        return fmi3Error;
    }
    if (enter_event_mode != nullptr) {
        *enter_event_mode = needed;
    }
    if (terminate_simulation != nullptr) {
        *terminate_simulation = fmi3False;
    }
    return fmi3OK;
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && self->set_time("fmi3SetTime", time));
}

fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 values[], size_t count) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && self->set_states("fmi3SetContinuousStates", values, count));
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64 values[], size_t count) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && self->get_derivatives("fmi3GetContinuousStateDerivatives", values, count));
}

fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 values[], size_t count) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && self->get_indicators("fmi3GetEventIndicators", values, count));
}

fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 values[], size_t count) {
    Instance *self = unwrap(instance);
    return status(self != nullptr && self->get_states("fmi3GetContinuousStates", values, count));
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64 values[], size_t count) {
    Instance *self = unwrap(instance);
    return status(self != nullptr &&
                  self->get_nominals("fmi3GetNominalsOfContinuousStates", giveway::evaluable, values, count));
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *count) {
    return get_count(instance, "fmi3GetNumberOfEventIndicators", giveway::model_info().indicator_count, count);
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *count) {
    return get_count(instance, "fmi3GetNumberOfContinuousStates", giveway::model_info().state_count, count);
}

} // extern "C"
