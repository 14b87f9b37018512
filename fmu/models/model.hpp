// The one interface between an FMU's shell and the model inside it.
//
// The shell knows only FMI and this header; a model knows this header but not FMI.
// A new FMU is a model (NAME.cpp) and a variable table (variables.toml beside it); the generated code
// supplies the Variables struct, its start values and the table of its variables.
#pragma once

#include <cstddef>
#include <cstdint>

namespace giveway {

enum class VariableType : std::uint8_t { real, integer, boolean };
enum class Causality : std::uint8_t { parameter, input, output, local };

// One row of the variable table.
struct VariableInfo {
    std::uint32_t reference; // explicit and append-only; 0 is the FMI 3 independent variable
    const char *name;
    VariableType type;
    Causality causality;
    double minimum;       // inclusive, -infinity if none; also used for integers
    double maximum;       // inclusive, +infinity if none; also used for integers
    std::size_t offset;   // byte offset of the double, int32_t or bool inside the Variables struct
    bool allow_nonfinite; // an input that must survive bad sensors: NaN and infinity are let through
};

struct ModelInfo {
    const char *name;              // "testbed"
    const char *token;             // instantiation token: hash of the variable table
    const VariableInfo *variables; // sorted by reference
    std::size_t variable_count;
    // For models with equations to integrate; 0 and null otherwise. The last state is the shell's own, which counts
    // discontinuities.
    const double *state_nominals;
    std::size_t state_count;
    std::size_t indicator_count;
    // Byte offsets of the arrays in the Variables struct that the shell fills for reading.
    std::size_t states_offset;
    std::size_t derivatives_offset;
    std::size_t indicators_offset;
};

enum class Status { ok, error };

// Filled by the model when it returns Status::error: what was wrong, with names, values and units.
struct Message {
    char text[512];
};

// Results of an event update.
struct EventUpdate {
    bool again;          // another update is needed, after outputs have been passed on
    bool discontinuity;  // the equations changed: a mode, or a torque that is held from tick to tick
    bool states_changed; // filled by the shell
    bool has_next_time;  // the next event that is known in advance
    double next_time_s;
};

// A model's equations, for an importer that integrates (Model Exchange). Valid from initialise() on.
// In continuous time modes are constant: only update_events() changes them, and only it reads discrete inputs (FMPy,
// unlike the standard, also sets them between events).
class Equations {
public:
    virtual ~Equations() = default;

    // The first call after initialise(); from then on the importer integrates and inputs act at once.
    virtual void set_time(double time_s) = 0;
    // state_count - 1 numbers, which the importer writes in continuous time.
    virtual double *states() = 0;
    // At the present time, states and inputs.
    virtual void derivatives(double *values) = 0;
    // Positive; an event occurs where one falls to zero or below. After an event all are positive again, by a
    // hysteresis.
    virtual void indicators(double *values) = 0;
    virtual void write_outputs() = 0;
    virtual Status update_events(EventUpdate &update, Message &message) = 0;
};

// One instance of one FMU. Inputs and parameters are in range (and finite unless the table allows
// otherwise) when initialise and step are called.
class Model {
public:
    virtual ~Model() = default;

    // The generated Variables struct (plain data); the shell reads and writes it by offset.
    virtual void *variables() = 0;

    // Parameters and start inputs are set; computes the outputs at the start time, from parameters alone. Called again,
    // from scratch, when a value is set after the outputs were read.
    virtual Status initialise(double start_time_s, Message &message) = 0;

    // Inputs are held constant over the step; the outputs are valid at its end.
    virtual Status step(double time_s, double step_size_s, Message &message) = 0;

    // Back to the start values, as if newly created.
    virtual void reset() = 0;

    // The whole state between two calls, as bytes without pointers (state_archive.hpp): a model that loads them
    // continues bit for bit like the one that saved them, also in another process. save_state(nullptr) only counts.
    virtual std::size_t save_state(void *bytes) = 0;
    virtual Status load_state(const void *bytes, std::size_t size, Message &message) = 0;

    // nullptr: the model offers Co-Simulation only.
    virtual Equations *equations() { return nullptr; }
};

// Every model has both in its own namespace (NAME_variables.hpp), so that several fit into one library.
// These refer to the one model of an FMU binary; generated code defines them only there.
const ModelInfo &model_info();

// nullptr when out of memory.
Model *create_model();

} // namespace giveway
