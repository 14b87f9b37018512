// FMI 2.0 entry points: Co-Simulation and, for models with equations, Model Exchange.
#include "handles.hpp"
#include "instance.hpp"

#include <fmi2Functions.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <new>

namespace {

using giveway::Instance;
using giveway::State;

struct Fmi2Instance {
    fmi2CallbackLogger logger;
    fmi2ComponentEnvironment environment;
    char *name; // owned copy, handed to the logger
    Instance instance;
    // From fmi2SetupExperiment, for fmi2EnterInitializationMode.
    bool experiment_set_up = false;
    double start_time = 0.0;
    double stop_time = 0.0;

    // In FMI 2 the message is a printf format. It goes out complete, with its percent signs doubled,
    // since some importers show the format as it is.
    static void log(void *context, const char *text) {
        const Fmi2Instance *self = static_cast<const Fmi2Instance *>(context);
        if (self->logger == nullptr) {
            return;
        }
        char format[1200];
        size_t length = 0;
        for (; *text != '\0' && length + 3 <= sizeof format; ++text) {
            if (*text == '%') {
                format[length++] = '%';
            }
            format[length++] = *text;
        }
        format[length] = '\0';
        self->logger(self->environment, self->name, fmi2Error, "logStatusError", format);
    }

    Fmi2Instance(const fmi2CallbackFunctions &functions, char *name_, giveway::Model *model,
                 giveway::Interface interface)
        : logger(functions.logger), environment(functions.componentEnvironment), name(name_),
          instance(model, interface, false, log, this) {}
    ~Fmi2Instance() { delete[] name; }
};

giveway::Handles instances;

// Null if there is no such instance (any more): then the error can only be returned to the caller.
Fmi2Instance *unwrap(fmi2Component component) { return static_cast<Fmi2Instance *>(instances.find(component)); }

fmi2Status status(bool ok) { return ok ? fmi2OK : fmi2Error; }

fmi2Status unsupported(fmi2Component component, const char *function, const char *what) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.unsupported(function, what));
}

fmi2Component refuse_instance(const fmi2CallbackFunctions *functions, const char *name, const char *text) {
    if (functions->logger != nullptr) {
        functions->logger(functions->componentEnvironment, name != nullptr ? name : "", fmi2Error, "logStatusError",
                          text);
    }
    return nullptr;
}

// In FMI 2 the result of a step can only be queried afterwards.
bool allow_status(Fmi2Instance &self, const char *function) {
    return self.instance.allow_stepping(function, State::step_mode | State::terminated | State::failed);
}

fmi2Status no_strings(fmi2Component component, const char *function, giveway::States states, size_t count) {
    Fmi2Instance *self = unwrap(component);
    if (self == nullptr || !self->instance.allow(function, states)) {
        return fmi2Error;
    }
    return status(count == 0 || self->instance.refuse(function, "no variable is of type String"));
}

// Only asynchronous steps have a status; this FMU has none.
fmi2Status no_step_status(fmi2Component component, const char *function) {
    Fmi2Instance *self = unwrap(component);
    if (self == nullptr || !allow_status(*self, function)) {
        return fmi2Error;
    }
    self->instance.unsupported(function, "asynchronous steps");
    return fmi2Discard;
}

} // namespace

extern "C" {

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }

const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean, size_t count, const fmi2String categories[]) {
    Fmi2Instance *self = unwrap(component);
    if (self == nullptr) {
        return fmi2Error;
    }
    for (size_t i = 0; i < count; ++i) {
        if (categories == nullptr || categories[i] == nullptr || std::strcmp(categories[i], "logStatusError") != 0) {
            return status(
                self->instance.refuse("fmi2SetDebugLogging", "unknown log category '%s'",
                                      categories != nullptr && categories[i] != nullptr ? categories[i] : "(null)"));
        }
    }
    return fmi2OK; // errors, the only category, are always logged
}

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String,
                              const fmi2CallbackFunctions *functions, fmi2Boolean, fmi2Boolean) {
    if (functions == nullptr) {
        return nullptr; // and there is no logger to say so
    }
    if (name == nullptr || name[0] == '\0') {
        return refuse_instance(functions, name, "fmi2Instantiate: the instance name is missing");
    }
    if (type != fmi2ModelExchange && type != fmi2CoSimulation) {
        return refuse_instance(functions, name,
                               "fmi2Instantiate: the type is neither Model Exchange nor Co-Simulation");
    }
    if (type == fmi2ModelExchange && giveway::model_info().state_count == 0) {
        return refuse_instance(functions, name, "fmi2Instantiate: this FMU does not support Model Exchange");
    }
    if (guid == nullptr || std::strcmp(guid, giveway::model_info().token) != 0) {
        return refuse_instance(functions, name,
                               "fmi2Instantiate: the GUID does not match; model description and "
                               "binary are of different builds");
    }
    const size_t size = std::strlen(name) + 1;
    char *name_copy = new (std::nothrow) char[size];
    giveway::Model *model = giveway::create_model();
    if (name_copy != nullptr && model != nullptr) {
        std::memcpy(name_copy, name, size);
        Fmi2Instance *self = new (std::nothrow) Fmi2Instance(
            *functions, name_copy, model,
            type == fmi2ModelExchange ? giveway::Interface::model_exchange : giveway::Interface::co_simulation);
        if (self != nullptr) {
            fmi2Component handle = instances.add(self);
            if (handle == nullptr) {
                delete self;
                return refuse_instance(functions, name, "fmi2Instantiate: out of memory");
            }
            return handle;
        }
    }
    delete model;
    delete[] name_copy;
    return refuse_instance(functions, name, "fmi2Instantiate: out of memory");
}

void fmi2FreeInstance(fmi2Component component) { delete static_cast<Fmi2Instance *>(instances.remove(component)); }

fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                               fmi2Real start_time, fmi2Boolean stop_time_defined, fmi2Real stop_time) {
    Fmi2Instance *self = unwrap(component);
    if (self == nullptr || !self->instance.allow("fmi2SetupExperiment", only(State::instantiated))) {
        return fmi2Error;
    }
    // The tolerances of a model's solver are its parameters; a given one is checked, not used.
    if (tolerance_defined && !(tolerance > 0.0)) {
        return status(self->instance.refuse("fmi2SetupExperiment", "tolerance is %g, but must be positive", tolerance));
    }
    self->experiment_set_up = true;
    self->start_time = start_time;
    self->stop_time = stop_time_defined ? stop_time : std::numeric_limits<double>::infinity();
    return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
    Fmi2Instance *self = unwrap(component);
    if (self == nullptr || !self->instance.allow("fmi2EnterInitializationMode", only(State::instantiated))) {
        return fmi2Error;
    }
    if (!self->experiment_set_up) {
        return status(self->instance.refuse("fmi2EnterInitializationMode", "not allowed before fmi2SetupExperiment"));
    }
    return status(
        self->instance.enter_initialisation("fmi2EnterInitializationMode", self->start_time, self->stop_time));
}

fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.exit_initialisation("fmi2ExitInitializationMode"));
}

fmi2Status fmi2Terminate(fmi2Component component) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.terminate("fmi2Terminate"));
}

fmi2Status fmi2Reset(fmi2Component component) {
    Fmi2Instance *self = unwrap(component);
    if (self == nullptr || !self->instance.reset("fmi2Reset")) {
        return fmi2Error;
    }
    self->experiment_set_up = false;
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component component, fmi2Real time, fmi2Real step_size, fmi2Boolean) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.step("fmi2DoStep", time, step_size));
}

fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                       fmi2Real values[]) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.get_real("fmi2GetReal", references, count, values));
}

fmi2Status fmi2GetInteger(fmi2Component component, const fmi2ValueReference references[], size_t count,
                          fmi2Integer values[]) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.get_integer("fmi2GetInteger", references, count, values));
}

fmi2Status fmi2GetBoolean(fmi2Component component, const fmi2ValueReference references[], size_t count,
                          fmi2Boolean values[]) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.get_boolean("fmi2GetBoolean", references, count, values));
}

fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference references[], size_t count,
                       const fmi2Real values[]) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.set_real("fmi2SetReal", references, count, values));
}

fmi2Status fmi2SetInteger(fmi2Component component, const fmi2ValueReference references[], size_t count,
                          const fmi2Integer values[]) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.set_integer("fmi2SetInteger", references, count, values));
}

fmi2Status fmi2SetBoolean(fmi2Component component, const fmi2ValueReference references[], size_t count,
                          const fmi2Boolean values[]) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.set_boolean("fmi2SetBoolean", references, count, values));
}

fmi2Status fmi2GetString(fmi2Component component, const fmi2ValueReference[], size_t count, fmi2String[]) {
    return no_strings(component, "fmi2GetString", giveway::readable, count);
}

fmi2Status fmi2SetString(fmi2Component component, const fmi2ValueReference[], size_t count, const fmi2String[]) {
    return no_strings(component, "fmi2SetString", giveway::writable, count);
}

fmi2Status fmi2GetRealStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Real *value) {
    Fmi2Instance *self = unwrap(component);
    if (self == nullptr || !allow_status(*self, "fmi2GetRealStatus")) {
        return fmi2Error;
    }
    if (value == nullptr) {
        return status(self->instance.refuse("fmi2GetRealStatus", "the result is a null pointer"));
    }
    if (kind != fmi2LastSuccessfulTime) {
        self->instance.unsupported("fmi2GetRealStatus", "anything but fmi2LastSuccessfulTime");
        return fmi2Discard;
    }
    *value = self->instance.time();
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean *value) {
    Fmi2Instance *self = unwrap(component);
    if (self == nullptr || !allow_status(*self, "fmi2GetBooleanStatus")) {
        return fmi2Error;
    }
    if (value == nullptr) {
        return status(self->instance.refuse("fmi2GetBooleanStatus", "the result is a null pointer"));
    }
    if (kind != fmi2Terminated) {
        self->instance.unsupported("fmi2GetBooleanStatus", "anything but fmi2Terminated");
        return fmi2Discard;
    }
    *value = fmi2False; // the FMU never asks to end the simulation
    return fmi2OK;
}

// Functions that the model description does not offer.

fmi2Status fmi2GetStatus(fmi2Component component, const fmi2StatusKind, fmi2Status *) {
    return no_step_status(component, "fmi2GetStatus");
}

fmi2Status fmi2GetIntegerStatus(fmi2Component component, const fmi2StatusKind, fmi2Integer *) {
    return no_step_status(component, "fmi2GetIntegerStatus");
}

fmi2Status fmi2GetStringStatus(fmi2Component component, const fmi2StatusKind, fmi2String *) {
    return no_step_status(component, "fmi2GetStringStatus");
}

fmi2Status fmi2CancelStep(fmi2Component component) {
    return unsupported(component, "fmi2CancelStep", "asynchronous steps");
}

fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.get_state("fmi2GetFMUstate", state));
}

fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.set_state("fmi2SetFMUstate", state));
}

fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *state) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.free_state("fmi2FreeFMUstate", state));
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t *size) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.serialised_size("fmi2SerializedFMUstateSize", state, size));
}

fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.serialise("fmi2SerializeFMUstate", state,
                                                              reinterpret_cast<unsigned char *>(bytes), size));
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr &&
                  self->instance.deserialise("fmi2DeSerializeFMUstate", reinterpret_cast<const unsigned char *>(bytes),
                                             size, state));
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component component, const fmi2ValueReference[], size_t,
                                        const fmi2ValueReference[], size_t, const fmi2Real[], fmi2Real[]) {
    return unsupported(component, "fmi2GetDirectionalDerivative", "directional derivatives");
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component component, const fmi2ValueReference[], size_t, const fmi2Integer[],
                                       const fmi2Real[]) {
    return unsupported(component, "fmi2SetRealInputDerivatives", "input derivatives");
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component component, const fmi2ValueReference[], size_t,
                                        const fmi2Integer[], fmi2Real[]) {
    return unsupported(component, "fmi2GetRealOutputDerivatives", "output derivatives");
}

// Model Exchange.

fmi2Status fmi2EnterEventMode(fmi2Component component) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.enter_event_mode("fmi2EnterEventMode", giveway::exchange_modes));
}

fmi2Status fmi2NewDiscreteStates(fmi2Component component, fmi2EventInfo *info) {
    Fmi2Instance *self = unwrap(component);
    giveway::EventUpdate update{};
    if (self == nullptr || !self->instance.allow_exchange("fmi2NewDiscreteStates", only(State::event_mode))) {
        return fmi2Error;
    }
    if (info == nullptr) { // without it the importer could not know that another update is needed
        return status(self->instance.refuse("fmi2NewDiscreteStates", "the event info is a null pointer"));
    }
    if (!self->instance.update_events("fmi2NewDiscreteStates", update)) {
        return fmi2Error;
    }
    info->newDiscreteStatesNeeded = update.again;
    info->terminateSimulation = fmi2False;
    info->nominalsOfContinuousStatesChanged = fmi2False;
    info->valuesOfContinuousStatesChanged = update.states_changed;
    info->nextEventTimeDefined = update.has_next_time;
    info->nextEventTime = update.next_time_s;
    return fmi2OK;
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component component) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.enter_continuous_time_mode("fmi2EnterContinuousTimeMode"));
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component component, fmi2Boolean, fmi2Boolean *enter_event_mode,
                                       fmi2Boolean *terminate_simulation) {
    Fmi2Instance *self = unwrap(component);
    bool needed = false;
    if (self == nullptr || !self->instance.completed_step("fmi2CompletedIntegratorStep", needed)) {
        return fmi2Error;
    }
    if (enter_event_mode != nullptr) {
        *enter_event_mode = needed ? fmi2True : fmi2False;
    }
    if (terminate_simulation != nullptr) {
        *terminate_simulation = fmi2False;
    }
    return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component component, fmi2Real time) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.set_time("fmi2SetTime", time));
}

fmi2Status fmi2SetContinuousStates(fmi2Component component, const fmi2Real states[], size_t count) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.set_states("fmi2SetContinuousStates", states, count));
}

fmi2Status fmi2GetDerivatives(fmi2Component component, fmi2Real derivatives[], size_t count) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.get_derivatives("fmi2GetDerivatives", derivatives, count));
}

fmi2Status fmi2GetEventIndicators(fmi2Component component, fmi2Real indicators[], size_t count) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.get_indicators("fmi2GetEventIndicators", indicators, count));
}

fmi2Status fmi2GetContinuousStates(fmi2Component component, fmi2Real states[], size_t count) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr && self->instance.get_states("fmi2GetContinuousStates", states, count));
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component component, fmi2Real nominals[], size_t count) {
    Fmi2Instance *self = unwrap(component);
    return status(self != nullptr &&
                  self->instance.get_nominals("fmi2GetNominalsOfContinuousStates",
                                              giveway::evaluable | State::instantiated, nominals, count));
}

} // extern "C"
