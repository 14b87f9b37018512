// The values exchanged between the models, and the inputs that tables drive.
#pragma once

#include <array>

#include "models.hpp"

namespace giveway::batch {

// Outputs of one model that are inputs of the other, by name. The two together are the exchange.
class Links {
public:
    Links(std::uint32_t from, std::uint32_t to) : from_(from), to_(to) {
        const ModelInfo &receiver = info_of(to);
        for (std::size_t i = 0; i < receiver.variable_count; ++i) {
            const VariableInfo &input = receiver.variables[i];
            if (input.causality != Causality::input) {
                continue;
            }
            const VariableInfo *output = find(info_of(from), input.name);
            if (output != nullptr && output->causality == Causality::output && output->type == input.type &&
                count_ < links_.size()) {
                links_[count_++] = {output->offset, &input};
            }
        }
    }

    // Passes all values on, or returns the input that does not take its value; some may have been passed on then, and
    // the run ends.
    const VariableInfo *pass(unsigned char *const *variables, double &refused) const {
        for (std::size_t i = 0; i < count_; ++i) {
            const VariableInfo &input = *links_[i].input;
            const unsigned char *from = variables[from_] + links_[i].offset;
            const double value = load(input.type, from);
            if (!allowed(input, value)) {
                refused = value;
                return &input;
            }
            std::memcpy(variables[to_] + input.offset, from, size_of(input.type));
        }
        return nullptr;
    }

private:
    struct Link {
        std::size_t offset; // of the output
        const VariableInfo *input;
    };
    std::uint32_t from_, to_;
    std::array<Link, 64> links_{};
    std::size_t count_ = 0;
};

inline const Links &sensors() {
    static const Links links(GWB_TESTBED, GWB_CONTROLLER);
    return links;
}
inline const Links &commands() {
    static const Links links(GWB_CONTROLLER, GWB_TESTBED);
    return links;
}

// Inputs that a table drives, one per column.
template <std::size_t N> struct TableInputs {
    std::uint32_t model;
    std::array<const VariableInfo *, N> column;

    TableInputs(std::uint32_t model_, const std::array<const char *, N> &names) : model(model_), column{} {
        for (std::size_t i = 0; i < N; ++i) {
            column[i] = find(info_of(model), names[i]);
        }
    }
    void set(unsigned char *const *variables, const double *row) const {
        for (std::size_t i = 0; i < N; ++i) {
            std::memcpy(variables[model] + column[i]->offset, &row[i], sizeof row[i]);
        }
    }
};

inline const TableInputs<GWB_PLAN_COLUMNS> &plan_inputs() {
    static const TableInputs<GWB_PLAN_COLUMNS> inputs(
        GWB_CONTROLLER,
        {"plan.x", "plan.y", "plan.theta", "plan.vx", "plan.vy", "plan.omega", "plan.ax", "plan.ay", "plan.alpha"});
    return inputs;
}
inline const TableInputs<GWB_PUSH_COLUMNS> &push_inputs() {
    static const TableInputs<GWB_PUSH_COLUMNS> inputs(GWB_TESTBED,
                                                      {"push.force_x", "push.force_y", "push.point_x", "push.point_y"});
    return inputs;
}

} // namespace giveway::batch
