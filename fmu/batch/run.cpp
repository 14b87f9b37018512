#include "run.hpp"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <limits>
#include <memory>
#include <new>

#include "metrics.hpp"
#include "models.hpp"

namespace giveway::batch {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint32_t steps_per_report = 64;

void clear(gwb_result_t& result) {
    result = {};
    result.model = GWB_NONE;
    result.reference = GWB_NONE;
    result.value = nan;
    result.minimum = nan;
    result.maximum = nan;
    std::fill_n(result.metric, GWB_METRIC_COUNT, nan);
    std::fill_n(result.truth, GWB_METRIC_COUNT, nan);
}

// Outputs of one model that are inputs of the other, by name. The two together are the exchange.
class Links {
public:
    Links(std::uint32_t from, std::uint32_t to) : from_(from), to_(to) {
        const ModelInfo& receiver = info_of(to);
        for (std::size_t i = 0; i < receiver.variable_count; ++i) {
            const VariableInfo& input = receiver.variables[i];
            if (input.causality != Causality::input) {
                continue;
            }
            const VariableInfo* output = find(info_of(from), input.name);
            if (output != nullptr && output->causality == Causality::output && count_ < links_.size()) {
                links_[count_++] = {output, &input};
            }
        }
    }

    // Passes all values on, or none and returns the input that does not take its value.
    const VariableInfo* pass(unsigned char* const* variables, double& refused) const {
        for (std::size_t i = 0; i < count_; ++i) {
            const double value = load(*links_[i].output, variables[from_]);
            if (!allowed(*links_[i].input, value)) {
                refused = value;
                return links_[i].input;
            }
        }
        for (std::size_t i = 0; i < count_; ++i) {
            store(*links_[i].input, variables[to_], load(*links_[i].output, variables[from_]));
        }
        return nullptr;
    }

private:
    struct Link {
        const VariableInfo* output;
        const VariableInfo* input;
    };
    std::uint32_t from_, to_;
    std::array<Link, 64> links_{};
    std::size_t count_ = 0;
};

const Links& sensors() {
    static const Links links(GWB_TESTBED, GWB_CONTROLLER);
    return links;
}
const Links& commands() {
    static const Links links(GWB_CONTROLLER, GWB_TESTBED);
    return links;
}

// Inputs that a table drives, one per column.
template <std::size_t N> struct TableInputs {
    std::uint32_t model;
    std::array<const VariableInfo*, N> column;

    TableInputs(std::uint32_t model_, const std::array<const char*, N>& names) : model(model_), column{} {
        for (std::size_t i = 0; i < N; ++i) {
            column[i] = find(info_of(model), names[i]);
        }
    }
    void set(unsigned char* const* variables, const double* row) const {
        for (std::size_t i = 0; i < N; ++i) {
            std::memcpy(variables[model] + column[i]->offset, &row[i], sizeof row[i]);
        }
    }
};

const TableInputs<GWB_PLAN_COLUMNS>& plan_inputs() {
    static const TableInputs<GWB_PLAN_COLUMNS> inputs(GWB_CONTROLLER,
                                                      {"plan.x", "plan.y", "plan.theta", "plan.vx", "plan.vy",
                                                       "plan.omega", "plan.ax", "plan.ay", "plan.alpha"});
    return inputs;
}
const TableInputs<GWB_PUSH_COLUMNS>& push_inputs() {
    static const TableInputs<GWB_PUSH_COLUMNS> inputs(GWB_TESTBED,
                                                      {"push.force_x", "push.force_y", "push.point_x", "push.point_y"});
    return inputs;
}

class Run {
public:
    Run(const gwb_spec_t& spec, Monitor& monitor, gwb_result_t& result)
        : spec_(spec), monitor_(monitor), result_(result) {}

    void go() {
        if (check_spec() && create() && apply_settings() && initialise()) {
            loop();
        }
    }

private:
    // Ends the run with a message; always false.
    [[gnu::format(printf, 3, 4)]] bool end(std::uint32_t status, const char* format, ...) {
        result_.status = status;
        std::va_list arguments;
        va_start(arguments, format);
        std::vsnprintf(result_.message, sizeof result_.message, format, arguments);
        va_end(arguments);
        return false;
    }

    bool model_failed(std::uint32_t status, std::uint32_t model, Message& message) {
        message.text[sizeof message.text - 1] = '\0';
        result_.model = model;
        const bool silent = message.text[0] == '\0';
        return end(status, "%s: %s", info_of(model).name,
                   silent ? "the model failed without a message" : message.text);
    }

    // `where` comes before the variable's name, e.g. "plan, row 3: ".
    bool refuse_value(std::uint32_t status, const char* where, std::uint32_t model, const VariableInfo& variable,
                      double value) {
        result_.model = model;
        result_.reference = variable.reference;
        result_.value = value;
        result_.minimum = variable.type == VariableType::boolean ? 0.0 : variable.minimum;
        result_.maximum = variable.type == VariableType::boolean ? 1.0 : variable.maximum;
        const char* kind = variable.type == VariableType::real ? "finite" : "a whole number";
        return end(status, "%s%s.%s = %.17g is not allowed: %s and in [%.17g, %.17g]", where, info_of(model).name,
                   variable.name, value, kind, result_.minimum, result_.maximum);
    }

    bool check_spec() {
        if (!(spec_.step_s >= GWB_STEP_MIN_S && spec_.step_s <= GWB_STEP_MAX_S)) {
            return end(GWB_WRONG_SPEC, "step_s = %.17g is not allowed: [%g, %g] s", spec_.step_s, GWB_STEP_MIN_S,
                       GWB_STEP_MAX_S);
        }
        if (spec_.step_count < 1 || spec_.step_count > GWB_STEP_COUNT_MAX) {
            return end(GWB_WRONG_SPEC, "step_count = %u is not allowed: [1, %d]",
                       static_cast<unsigned>(spec_.step_count), GWB_STEP_COUNT_MAX);
        }
        if (spec_.push_rows > 0 && spec_.push_rows <= spec_.step_count) {
            return end(GWB_WRONG_SPEC, "push_rows = %u is not allowed: 0, or at least step_count + 1 = %u",
                       static_cast<unsigned>(spec_.push_rows), static_cast<unsigned>(spec_.step_count + 1));
        }
        const struct {
            const char* name;
            std::uint32_t count;
            bool missing;
        } arrays[] = {{"settings", spec_.setting_count, spec_.settings == nullptr},
                      {"plan", spec_.plan_rows, spec_.plan == nullptr},
                      {"push", spec_.push_rows, spec_.push == nullptr},
                      {"columns", spec_.column_count, spec_.columns == nullptr}};
        for (const auto& array : arrays) {
            if (array.missing && array.count > 0) {
                return end(GWB_WRONG_SPEC, "%s is a null pointer, but its count is %u", array.name,
                           static_cast<unsigned>(array.count));
            }
        }
        return check_columns() && check_table("plan", plan_inputs(), spec_.plan, spec_.plan_rows) &&
               check_table("push", push_inputs(), spec_.push, spec_.push_rows);
    }

    template <std::size_t N>
    bool check_table(const char* name, const TableInputs<N>& inputs, const double* table, std::uint32_t rows) {
        for (std::size_t row = 0; row < rows; ++row) {
            for (std::size_t column = 0; column < N; ++column) {
                const double value = table[row * N + column];
                if (!allowed(*inputs.column[column], value)) {
                    char where[64];
                    std::snprintf(where, sizeof where, "%s, row %zu: ", name, row);
                    return refuse_value(GWB_WRONG_SPEC, where, inputs.model, *inputs.column[column], value);
                }
            }
        }
        return true;
    }

    // The variable of entry `index` of an array of the spec; null, with the run ended, if there is none.
    const VariableInfo* lookup(const char* array, std::uint32_t index, std::uint32_t model, std::uint32_t reference) {
        if (model >= GWB_MODEL_COUNT) {
            end(GWB_WRONG_SPEC, "%s[%u].model = %u is not allowed: %d (controller) or %d (testbed)", array,
                static_cast<unsigned>(index), static_cast<unsigned>(model), GWB_CONTROLLER, GWB_TESTBED);
            return nullptr;
        }
        const VariableInfo* variable = find(info_of(model), reference);
        if (variable == nullptr) {
            result_.model = model;
            end(GWB_WRONG_SPEC, "%s[%u].reference = %u is not allowed: the %s has no such variable", array,
                static_cast<unsigned>(index), static_cast<unsigned>(reference), info_of(model).name);
        }
        return variable;
    }

    bool check_columns() {
        for (std::uint32_t i = 0; i < spec_.column_count; ++i) {
            const gwb_column_t& column = spec_.columns[i];
            const VariableInfo* variable = lookup("columns", i, column.model, column.reference);
            if (variable == nullptr) {
                return false;
            }
            if (variable->causality != Causality::input && variable->causality != Causality::output) {
                result_.model = column.model;
                return end(GWB_WRONG_SPEC, "columns[%u]: %s.%s is neither an input nor an output",
                           static_cast<unsigned>(i), info_of(column.model).name, variable->name);
            }
            if (column.values == nullptr) {
                return end(GWB_WRONG_SPEC, "columns[%u].values is a null pointer", static_cast<unsigned>(i));
            }
        }
        return true;
    }

    bool create() {
        models_[GWB_CONTROLLER].reset(controller::create_model());
        models_[GWB_TESTBED].reset(testbed::create_model());
        samples_.reset(new (std::nothrow) Sample[spec_.step_count + 1]);
        recorders_.reset(new (std::nothrow) Recorder[spec_.column_count]);
        if (models_[0] == nullptr || models_[1] == nullptr || samples_ == nullptr || recorders_ == nullptr) {
            return end(GWB_NO_MEMORY, "no memory for a run of %u steps", static_cast<unsigned>(spec_.step_count));
        }
        for (std::uint32_t model = 0; model < GWB_MODEL_COUNT; ++model) {
            variables_[model] = static_cast<unsigned char*>(models_[model]->variables());
        }
        for (std::uint32_t i = 0; i < spec_.column_count; ++i) {
            const gwb_column_t& column = spec_.columns[i];
            const VariableInfo& variable = *find(info_of(column.model), column.reference);
            recorders_[i] = {variables_[column.model] + variable.offset, static_cast<unsigned char*>(column.values),
                             size_of(variable.type)};
        }
        return true;
    }

    bool apply_settings() {
        for (std::uint32_t i = 0; i < spec_.setting_count; ++i) {
            const gwb_setting_t& setting = spec_.settings[i];
            const VariableInfo* variable = lookup("settings", i, setting.model, setting.reference);
            if (variable == nullptr) {
                return false;
            }
            if (variable->causality != Causality::parameter) {
                result_.model = setting.model;
                return end(GWB_WRONG_SPEC, "settings[%u]: %s.%s is an %s, not a parameter", static_cast<unsigned>(i),
                           info_of(setting.model).name, variable->name,
                           variable->causality == Causality::input ? "input" : "output");
            }
            if (!allowed(*variable, setting.value)) {
                return refuse_value(GWB_WRONG_SPEC, "", setting.model, *variable, setting.value);
            }
            store(*variable, variables_[setting.model], setting.value);
        }
        return true;
    }

    bool initialise() {
        for (std::uint32_t model = 0; model < GWB_MODEL_COUNT; ++model) {
            Message message{};
            if (models_[model]->initialise(0.0, message) != Status::ok) {
                return model_failed(GWB_REFUSED, model, message);
            }
        }
        return true;
    }

    bool pass(const Links& links, std::uint32_t receiver) {
        double value = nan;
        const VariableInfo* refused = links.pass(variables_.data(), value);
        return refused == nullptr || refuse_value(GWB_FAILED, "", receiver, *refused, value);
    }

    bool step(std::uint32_t model, double now_s) {
        Message message{};
        return models_[model]->step(now_s, spec_.step_s, message) == Status::ok ||
               model_failed(GWB_FAILED, model, message);
    }

    // The exchange order is part of the definition of a run: see fmu/README.md and cosim/giveway/master.py.
    void loop() {
        const auto& decided = *reinterpret_cast<const controller::Variables*>(variables_[GWB_CONTROLLER]);
        std::uint32_t path_row = 0;
        for (std::uint32_t k = 0; k <= spec_.step_count; ++k) {
            const double now_s = static_cast<double>(k) * spec_.step_s;
            result_.time_s = now_s;
            if (monitor_.cancelled.load(std::memory_order_relaxed)) {
                end(GWB_CANCELLED, "cancelled at t = %.9g s", now_s);
                return;
            }
            if (!pass(sensors(), GWB_CONTROLLER)) {
                return;
            }
            if (spec_.plan_rows > 0) {
                plan_inputs().set(variables_.data(), spec_.plan + std::size_t{path_row} * GWB_PLAN_COLUMNS);
            }
            if (!step(GWB_CONTROLLER, now_s)) {
                return;
            }
            const bool at_end = k == spec_.step_count;
            if (!at_end && !pass(commands(), GWB_TESTBED)) {
                return;
            }
            if (!at_end && spec_.push_rows > 0) {
                push_inputs().set(variables_.data(), spec_.push + std::size_t{k} * GWB_PUSH_COLUMNS);
            }
            record(k, now_s);
            if (at_end) {
                break;
            }
            if (spec_.plan_rows > 0) {
                path_row = static_cast<std::uint32_t>(
                    std::clamp<std::int64_t>(decided.path_ticks, 0, std::int64_t{spec_.plan_rows} - 1));
            }
            if (!step(GWB_TESTBED, now_s)) {
                return;
            }
            if ((k + 1) % steps_per_report == 0) {
                report(k + 1);
            }
        }
        judge();
    }

    void record(std::uint32_t k, double now_s) {
        for (std::uint32_t i = 0; i < spec_.column_count; ++i) {
            const Recorder& r = recorders_[i];
            std::memcpy(r.to + k * r.size, r.from, r.size);
        }
        const auto& t = *reinterpret_cast<const testbed::Variables*>(variables_[GWB_TESTBED]);
        const auto& c = *reinterpret_cast<const controller::Variables*>(variables_[GWB_CONTROLLER]);
        Sample& s = samples_[k];
        s.time_s = now_s;
        s.x = t.truth_x;
        s.y = t.truth_y;
        s.theta = t.truth_theta;
        s.vx = t.truth_vx;
        s.vy = t.truth_vy;
        std::copy_n(t.truth_wheel_torque, 3, s.wheel_torque);
        s.contact_force = t.truth_contact_force;
        s.contact_force_x = t.truth_contact_force_x;
        s.contact_force_y = t.truth_contact_force_y;
        s.contact_base_x = t.truth_contact_base_x;
        s.contact_base_y = t.truth_contact_base_y;
        s.contact_impulse_x = t.truth_contact_impulse_x;
        s.contact_impulse_y = t.truth_contact_impulse_y;
        s.first_contact_time = t.truth_first_contact_time;
        s.nose_x = t.truth_nose_x;
        s.nose_y = t.truth_nose_y;
        s.bumper_compression = t.truth_bumper_compression;
        s.energy_stored = t.energy_stored;
        s.energy_work_in = t.energy_work_in;
        s.energy_dissipated = t.energy_dissipated;
        s.energy_residual = t.energy_residual;
        s.estimate_force = c.estimate_force;
        s.estimate_force_x = c.estimate_force_x;
        s.estimate_force_y = c.estimate_force_y;
        s.detection_direction = c.detection_direction;
        s.detection_point_x = c.detection_point_x;
        s.detection_point_y = c.detection_point_y;
        s.reference_x = c.reference_x;
        s.reference_y = c.reference_y;
        s.detection_count = c.detection_count;
        s.events = t.events;
        s.contact = t.truth_contact;
        s.pushed = t.push_force_x != 0.0 || t.push_force_y != 0.0;
        s.latched = t.truth_latched;
        s.rope_taut = t.truth_rope_taut;
        result_.rows = k + 1;
    }

    void judge() {
        const auto& t = *reinterpret_cast<const testbed::Variables*>(variables_[GWB_TESTBED]);
        const auto& c = *reinterpret_cast<const controller::Variables*>(variables_[GWB_CONTROLLER]);
        const MetricParameters parameters{t.wheel_radius, t.wheel_distance,
                                          static_cast<double>(c.estimator_average_window) * c.controller_period};
        evaluate(samples_.get(), result_.rows, parameters, result_.metric, result_.truth);
    }

    void report(std::uint32_t steps) {
        monitor_.steps_done.fetch_add(steps - reported_, std::memory_order_relaxed);
        reported_ = steps;
    }

public:
    ~Run() { report(spec_.step_count); }
    Run(const Run&) = delete;
    Run& operator=(const Run&) = delete;

private:
    struct Recorder {
        const unsigned char* from;
        unsigned char* to;
        std::size_t size;
    };

    const gwb_spec_t& spec_;
    Monitor& monitor_;
    gwb_result_t& result_;
    std::array<std::unique_ptr<Model>, GWB_MODEL_COUNT> models_;
    std::array<unsigned char*, GWB_MODEL_COUNT> variables_{};
    std::unique_ptr<Sample[]> samples_;
    std::unique_ptr<Recorder[]> recorders_;
    std::uint32_t reported_ = 0; // steps counted as done
};

} // namespace

void run(const gwb_spec_t& spec, Monitor& monitor, gwb_result_t& result) {
    clear(result);
    Run(spec, monitor, result).go();
}

void never_started(gwb_result_t& result) {
    clear(result);
    result.status = GWB_CANCELLED;
    std::snprintf(result.message, sizeof result.message, "cancelled before the start");
}

} // namespace giveway::batch
