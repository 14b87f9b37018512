// The controller alone, on recorded inputs: the same model with the same checks as in a run.
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>

#include "judged.hpp"

using namespace giveway;

struct gwb_replay {
    std::unique_ptr<Model> controller;
    double step_s = 0.0;
    std::uint64_t steps = 0; // done
};

namespace {

// One call on a replay, and its result.
class Call : public batch::Judged {
public:
    Call(gwb_replay &replay, gwb_result_t &result) : Judged(result), replay_(replay) {
        use(*static_cast<controller::Variables *>(replay.controller->variables()));
        result_.time_s = now_s();
    }

    bool start(const gwb_setting_t *settings, std::uint32_t count) {
        if (!(replay_.step_s >= GWB_STEP_MIN_S && replay_.step_s <= GWB_STEP_MAX_S)) {
            return end(GWB_WRONG_SPEC, "step_s = %.17g is not allowed: [%g, %g] s", replay_.step_s, GWB_STEP_MIN_S,
                       GWB_STEP_MAX_S);
        }
        if (!check_array("settings", settings, count)) {
            return false;
        }
        for (std::uint32_t i = 0; i < count; ++i) {
            if (settings[i].model != GWB_CONTROLLER) {
                return no_controller("settings", i, settings[i].model);
            }
        }
        Message message{};
        if (!apply_settings(settings, count)) {
            return false;
        }
        return replay_.controller->initialise(0.0, message) == Status::ok || failed(GWB_REFUSED, message);
    }

    void steps(const gwb_column_t *columns, std::uint32_t count, std::uint32_t rows) {
        if (!check_array("columns", columns, count)) {
            return;
        }
        for (std::uint32_t i = 0; i < count; ++i) {
            if (columns[i].model != GWB_CONTROLLER) {
                no_controller("columns", i, columns[i].model);
                return;
            }
        }
        const std::unique_ptr<const VariableInfo *[]> variables(new (std::nothrow) const VariableInfo *[count]);
        if (variables == nullptr) {
            end(GWB_NO_MEMORY, "no memory for %u columns", static_cast<unsigned>(count));
            return;
        }
        if (!check_columns(columns, count)) {
            return;
        }
        for (std::uint32_t i = 0; i < count; ++i) {
            variables[i] = batch::find(batch::info_of(GWB_CONTROLLER), columns[i].reference);
        }
        for (std::uint32_t row = 0; row < rows; ++row) {
            if (!step(columns, variables.get(), count, row)) {
                return;
            }
            result_.rows = row + 1;
        }
    }

private:
    double now_s() const { return static_cast<double>(replay_.steps) * replay_.step_s; }

    bool step(const gwb_column_t *columns, const VariableInfo *const *variables, std::uint32_t count,
              std::uint32_t row) {
        unsigned char *const own = variables_[GWB_CONTROLLER];
        for (std::uint32_t i = 0; i < count; ++i) { // all of a row or none of it
            const VariableInfo &variable = *variables[i];
            const std::size_t size = batch::size_of(variable.type);
            const auto *from = static_cast<const unsigned char *>(columns[i].values) + row * size;
            const double value = variable.causality == Causality::input ? batch::load(variable.type, from) : 0.0;
            if (variable.causality == Causality::input && !batch::allowed(variable, value)) {
                return refuse_value(GWB_WRONG_SPEC, "", GWB_CONTROLLER, variable, value);
            }
        }
        for (std::uint32_t i = 0; i < count; ++i) {
            const std::size_t size = batch::size_of(variables[i]->type);
            if (variables[i]->causality == Causality::input) {
                const auto *from = static_cast<const unsigned char *>(columns[i].values) + row * size;
                std::memcpy(own + variables[i]->offset, from, size);
            }
        }
        result_.time_s = now_s();
        Message message{};
        if (replay_.controller->step(now_s(), replay_.step_s, message) != Status::ok) {
            return failed(GWB_FAILED, message);
        }
        ++replay_.steps;
        for (std::uint32_t i = 0; i < count; ++i) {
            const std::size_t size = batch::size_of(variables[i]->type);
            if (variables[i]->causality == Causality::output) {
                auto *to = static_cast<unsigned char *>(columns[i].values) + row * size;
                std::memcpy(to, own + variables[i]->offset, size);
            }
        }
        return true;
    }

    bool no_controller(const char *array, std::uint32_t index, std::uint32_t model) {
        return end(GWB_WRONG_SPEC, "%s[%u].model = %u is not allowed: %d (controller)", array,
                   static_cast<unsigned>(index), static_cast<unsigned>(model), GWB_CONTROLLER);
    }

    bool failed(std::uint32_t status, Message &message) {
        message.text[sizeof message.text - 1] = '\0';
        result_.model = GWB_CONTROLLER;
        return end(status, "%s: %s", batch::info_of(GWB_CONTROLLER).name, message.text);
    }

    gwb_replay &replay_;
};

} // namespace

extern "C" {

int gwb_replay_start(const gwb_setting_t *settings, uint32_t setting_count, double step_s, gwb_replay_t **started,
                     char *message) {
    gwb_result_t result{};
    if (started == nullptr) {
        std::snprintf(result.message, sizeof result.message, "replay is a null pointer");
    } else {
        *started = nullptr;
        std::unique_ptr<gwb_replay> made(new (std::nothrow) gwb_replay);
        if (made != nullptr) {
            made->controller.reset(controller::create_model());
        }
        if (made == nullptr || made->controller == nullptr) {
            std::snprintf(result.message, sizeof result.message, "no memory for a replay");
        } else {
            made->step_s = step_s;
            if (Call(*made, result).start(settings, setting_count)) {
                *started = made.release();
            }
        }
    }
    if (message != nullptr) {
        std::memcpy(message, result.message, sizeof result.message);
    }
    return started != nullptr && *started != nullptr ? 1 : 0;
}

uint32_t gwb_replay_steps(gwb_replay_t *replay, const gwb_column_t *columns, uint32_t column_count, uint32_t rows,
                          gwb_result_t *result) {
    if (replay == nullptr || result == nullptr) {
        return GWB_WRONG_SPEC;
    }
    Call(*replay, *result).steps(columns, column_count, rows);
    return result->status;
}

void gwb_replay_finish(gwb_replay_t *replay) { delete replay; }

} // extern "C"
