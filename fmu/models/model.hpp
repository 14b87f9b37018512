// The one interface between an FMU's shell and the model inside it.
//
// The shell knows FMI and this header, nothing else; a model knows this header and nothing of FMI.
// A new FMU is a model (NAME.cpp) and a variable table (variables.toml beside it); the generated code
// supplies the Variables struct, its start values and the table of its variables.
#pragma once

#include <cstddef>
#include <cstdint>

namespace giveway {

enum class VariableType : std::uint8_t { real, integer, boolean };
enum class Causality : std::uint8_t { parameter, input, output };

// One row of the variable table.
struct VariableInfo {
    std::uint32_t reference; // explicit and append-only; 0 is the FMI 3 independent variable
    const char *name;
    VariableType type;
    Causality causality;
    double minimum; // inclusive, -infinity if none; also used for integers
    double maximum; // inclusive, +infinity if none; also used for integers
    std::size_t offset; // byte offset of the double, int32_t or bool inside the Variables struct
    bool allow_nonfinite; // an input that must survive bad sensors: NaN and infinity are let through
};

struct ModelInfo {
    const char *name;              // "testbed"
    const char *token;             // instantiation token: hash of the variable table
    const VariableInfo *variables; // sorted by reference
    std::size_t variable_count;
};

enum class Status { ok, error };

// Filled by the model when it returns Status::error: what was wrong, with names, values and units.
struct Message {
    char text[512];
};

// One instance of one FMU. Inputs and parameters are in range (and finite unless the table allows
// otherwise) when initialise and step are called.
class Model {
public:
    virtual ~Model() = default;

    // The generated Variables struct (plain data); the shell reads and writes it by offset.
    virtual void *variables() = 0;

    // Parameters and start inputs are set; computes the outputs at the start time, from parameters
    // alone. Called again, from scratch, when a value is set after a first look at the outputs.
    virtual Status initialise(double start_time_s, Message &message) = 0;

    // Inputs are held constant over the step; the outputs are valid at its end.
    virtual Status step(double time_s, double step_size_s, Message &message) = 0;

    // Back to the start values, as if newly created.
    virtual void reset() = 0;
};

// Every model has both in its own namespace (NAME_variables.hpp), so that several fit into one library.
// These are of the one model of an FMU binary; generated code defines them there and nowhere else.
const ModelInfo &model_info();

// nullptr when out of memory.
Model *create_model();

} // namespace giveway
