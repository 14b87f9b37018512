#include "recorded_run.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <limits>
#include <new>

#include "links.hpp"

namespace giveway::batch {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint32_t steps_per_report = 64;
constexpr double limit_max_n = 1e9;

} // namespace

void clear(gwb_result_t &result) {
    result = {};
    result.model = GWB_NONE;
    result.reference = GWB_NONE;
    result.value = nan;
    result.minimum = nan;
    result.maximum = nan;
    std::fill_n(result.metric, GWB_METRIC_COUNT, nan);
    std::fill_n(result.truth, GWB_METRIC_COUNT, nan);
}

RecordedRun::RecordedRun(const gwb_spec_t &spec, Monitor &monitor, gwb_result_t &result)
    : spec_(spec), monitor_(monitor), result_(result) {
    clear(result);
}

RecordedRun::~RecordedRun() { monitor_.steps_done.fetch_add(spec_.step_count - reported_, std::memory_order_relaxed); }

bool RecordedRun::prepare(testbed::Variables &testbed) {
    variables_[GWB_TESTBED] = reinterpret_cast<unsigned char *>(&testbed);
    return check_spec() && create() && apply_settings();
}

bool RecordedRun::end(std::uint32_t status, const char *format, ...) {
    result_.status = status;
    std::va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(result_.message, sizeof result_.message, format, arguments);
    va_end(arguments);
    return false;
}

bool RecordedRun::model_failed(std::uint32_t status, std::uint32_t model, Message &message) {
    message.text[sizeof message.text - 1] = '\0';
    result_.model = model;
    const bool silent = message.text[0] == '\0';
    return end(status, "%s: %s", info_of(model).name, silent ? "the model failed without a message" : message.text);
}

// `where` comes before the variable's name, e.g. "plan, row 3: ".
bool RecordedRun::refuse_value(std::uint32_t status, const char *where, std::uint32_t model,
                               const VariableInfo &variable, double value) {
    result_.model = model;
    result_.reference = variable.reference;
    result_.value = value;
    result_.minimum = variable.type == VariableType::boolean ? 0.0 : variable.minimum;
    result_.maximum = variable.type == VariableType::boolean ? 1.0 : variable.maximum;
    const char *kind = variable.type == VariableType::real ? "finite" : "a whole number";
    return end(status, "%s%s.%s = %.17g is not allowed: %s and in [%.17g, %.17g]", where, info_of(model).name,
               variable.name, value, kind, result_.minimum, result_.maximum);
}

bool RecordedRun::check_spec() {
    if (!(spec_.step_s >= GWB_STEP_MIN_S && spec_.step_s <= GWB_STEP_MAX_S)) {
        return end(GWB_WRONG_SPEC, "step_s = %.17g is not allowed: [%g, %g] s", spec_.step_s, GWB_STEP_MIN_S,
                   GWB_STEP_MAX_S);
    }
    if (spec_.step_count < 1 || spec_.step_count > GWB_STEP_COUNT_MAX) {
        return end(GWB_WRONG_SPEC, "step_count = %u is not allowed: [1, %d]", static_cast<unsigned>(spec_.step_count),
                   GWB_STEP_COUNT_MAX);
    }
    if (spec_.push_rows > 0 && spec_.push_rows <= spec_.step_count) {
        return end(GWB_WRONG_SPEC, "push_rows = %u is not allowed: 0, or at least step_count + 1 = %u",
                   static_cast<unsigned>(spec_.push_rows), static_cast<unsigned>(spec_.step_count + 1));
    }
    const double limits[] = {spec_.transient_limit_n, spec_.lasting_limit_n};
    for (std::size_t i = 0; i < std::size(limits); ++i) {
        if (!(limits[i] >= 0.0 && limits[i] <= limit_max_n)) {
            return end(GWB_WRONG_SPEC, "%s = %.17g is not allowed: [0, %g] N",
                       i == 0 ? "transient_limit_n" : "lasting_limit_n", limits[i], limit_max_n);
        }
    }
    const struct {
        const char *name;
        std::uint32_t count;
        bool missing;
    } arrays[] = {{"settings", spec_.setting_count, spec_.settings == nullptr},
                  {"plan", spec_.plan_rows, spec_.plan == nullptr},
                  {"push", spec_.push_rows, spec_.push == nullptr},
                  {"columns", spec_.column_count, spec_.columns == nullptr}};
    for (const auto &array : arrays) {
        if (array.missing && array.count > 0) {
            return end(GWB_WRONG_SPEC, "%s is a null pointer, but its count is %u", array.name,
                       static_cast<unsigned>(array.count));
        }
    }
    return check_columns() && check_table("plan", plan_inputs(), spec_.plan, spec_.plan_rows) &&
           check_table("push", push_inputs(), spec_.push, spec_.push_rows);
}

template <class Inputs>
bool RecordedRun::check_table(const char *name, const Inputs &inputs, const double *table, std::uint32_t rows) {
    constexpr std::size_t N = std::tuple_size_v<decltype(inputs.column)>;
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
const VariableInfo *RecordedRun::lookup(const char *array, std::uint32_t index, std::uint32_t model,
                                        std::uint32_t reference) {
    if (model >= GWB_MODEL_COUNT) {
        end(GWB_WRONG_SPEC, "%s[%u].model = %u is not allowed: %d (controller) or %d (testbed)", array,
            static_cast<unsigned>(index), static_cast<unsigned>(model), GWB_CONTROLLER, GWB_TESTBED);
        return nullptr;
    }
    const VariableInfo *variable = find(info_of(model), reference);
    if (variable == nullptr) {
        result_.model = model;
        end(GWB_WRONG_SPEC, "%s[%u].reference = %u is not allowed: the %s has no such variable", array,
            static_cast<unsigned>(index), static_cast<unsigned>(reference), info_of(model).name);
    }
    return variable;
}

bool RecordedRun::check_columns() {
    for (std::uint32_t i = 0; i < spec_.column_count; ++i) {
        const gwb_column_t &column = spec_.columns[i];
        const VariableInfo *variable = lookup("columns", i, column.model, column.reference);
        if (variable == nullptr) {
            return false;
        }
        if (variable->causality != Causality::input && variable->causality != Causality::output) {
            result_.model = column.model;
            return end(GWB_WRONG_SPEC, "columns[%u]: %s.%s is neither an input nor an output", static_cast<unsigned>(i),
                       info_of(column.model).name, variable->name);
        }
        if (column.values == nullptr) {
            return end(GWB_WRONG_SPEC, "columns[%u].values is a null pointer", static_cast<unsigned>(i));
        }
    }
    return true;
}

bool RecordedRun::create() {
    controller_.reset(controller::create_model());
    recorders_.reset(new (std::nothrow) Recorder[spec_.column_count]);
    if (controller_ == nullptr || recorders_ == nullptr) {
        return end(GWB_NO_MEMORY, "no memory for a run of %u steps", static_cast<unsigned>(spec_.step_count));
    }
    variables_[GWB_CONTROLLER] = static_cast<unsigned char *>(controller_->variables());
    for (std::uint32_t i = 0; i < spec_.column_count; ++i) {
        const gwb_column_t &column = spec_.columns[i];
        const VariableInfo &variable = *find(info_of(column.model), column.reference);
        recorders_[i] = {variables_[column.model] + variable.offset, static_cast<unsigned char *>(column.values),
                         size_of(variable.type)};
    }
    return true;
}

bool RecordedRun::apply_settings() {
    for (std::uint32_t i = 0; i < spec_.setting_count; ++i) {
        const gwb_setting_t &setting = spec_.settings[i];
        const VariableInfo *variable = lookup("settings", i, setting.model, setting.reference);
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

bool RecordedRun::start_controller() {
    Message message{};
    return controller_->initialise(0.0, message) == Status::ok || model_failed(GWB_REFUSED, GWB_CONTROLLER, message);
}

bool RecordedRun::begin(SampleRoom &room) {
    samples_ = room.of(std::size_t{spec_.step_count} + 1);
    return samples_ != nullptr ||
           end(GWB_NO_MEMORY, "no memory for a run of %u steps", static_cast<unsigned>(spec_.step_count));
}

bool RecordedRun::pass(const Links &links, std::uint32_t receiver) {
    double value = nan;
    const VariableInfo *refused = links.pass(variables_.data(), value);
    return refused == nullptr || refuse_value(GWB_FAILED, "", receiver, *refused, value);
}

// The exchange order is part of the definition of a run: see fmu/README.md and cosim/giveway/master.py.
bool RecordedRun::exchange(std::uint32_t step) {
    const auto &decided = *reinterpret_cast<const controller::Variables *>(variables_[GWB_CONTROLLER]);
    const double now_s = time_s(step);
    result_.time_s = now_s;
    if (monitor_.cancelled.load(std::memory_order_relaxed)) {
        return end(GWB_CANCELLED, "cancelled at t = %.9g s", now_s);
    }
    if (!pass(sensors(), GWB_CONTROLLER)) {
        return false;
    }
    if (spec_.plan_rows > 0) {
        plan_inputs().set(variables_.data(), spec_.plan + std::size_t{path_row_} * GWB_PLAN_COLUMNS);
    }
    Message message{};
    if (controller_->step(now_s, spec_.step_s, message) != Status::ok) {
        return model_failed(GWB_FAILED, GWB_CONTROLLER, message);
    }
    const bool at_end = step == spec_.step_count;
    if (!at_end && !pass(commands(), GWB_TESTBED)) {
        return false;
    }
    if (!at_end && spec_.push_rows > 0) {
        push_inputs().set(variables_.data(), spec_.push + std::size_t{step} * GWB_PUSH_COLUMNS);
    }
    record(step, now_s);
    if (spec_.plan_rows > 0) {
        path_row_ = static_cast<std::uint32_t>(
            std::clamp<std::int64_t>(decided.path_ticks, 0, std::int64_t{spec_.plan_rows} - 1));
    }
    return true;
}

void RecordedRun::record(std::uint32_t k, double now_s) {
    for (std::uint32_t i = 0; i < spec_.column_count; ++i) {
        const Recorder &r = recorders_[i];
        std::memcpy(r.to + k * r.size, r.from, r.size);
    }
    const auto &t = *reinterpret_cast<const testbed::Variables *>(variables_[GWB_TESTBED]);
    const auto &c = *reinterpret_cast<const controller::Variables *>(variables_[GWB_CONTROLLER]);
    Sample &s = samples_[k];
    s.time_s = now_s;
    s.x = t.truth_x;
    s.y = t.truth_y;
    s.theta = t.truth_theta;
    s.vx = t.truth_vx;
    s.vy = t.truth_vy;
    std::copy_n(t.truth_wheel_torque, 3, s.wheel_torque);
    std::copy_n(t.truth_motor_torque, 3, s.motor_torque);
    std::copy_n(t.sensor_torque, 3, s.sensed_torque);
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
    s.tip_margin = t.truth_tip_margin;
    s.push_force_x = t.push_force_x;
    s.push_force_y = t.push_force_y;
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
    s.reference_theta = c.reference_theta;
    s.plan_x = c.plan_x;
    s.plan_y = c.plan_y;
    s.plan_theta = c.plan_theta;
    s.detection_count = c.detection_count;
    s.mode = c.mode;
    s.events = t.events;
    s.contact = t.truth_contact;
    s.pushed = t.push_force_x != 0.0 || t.push_force_y != 0.0;
    s.latched = t.truth_latched;
    s.rope_taut = t.truth_rope_taut;
    result_.rows = k + 1;
}

void RecordedRun::judge() {
    const auto &t = *reinterpret_cast<const testbed::Variables *>(variables_[GWB_TESTBED]);
    const auto &c = *reinterpret_cast<const controller::Variables *>(variables_[GWB_CONTROLLER]);
    const MetricParameters parameters{t.wheel_radius,
                                      t.wheel_distance,
                                      static_cast<double>(c.estimator_average_window) * c.controller_period,
                                      t.bumper_kind != 0,
                                      t.bumper_travel,
                                      t.base_tipping,
                                      t.base_mass,
                                      t.base_com_height,
                                      t.contact_height,
                                      t.push_height,
                                      spec_.transient_limit_n,
                                      spec_.lasting_limit_n,
                                      std::min(t.electronics_torque_range, c.sensor_check_torque_limit),
                                      t.drivetrain_torque_limit};
    evaluate(samples_, result_.rows, parameters, result_.metric, result_.truth);
}

void RecordedRun::report(std::uint32_t step) {
    if (step % steps_per_report == 0) {
        monitor_.steps_done.fetch_add(step - reported_, std::memory_order_relaxed);
        reported_ = step;
    }
}

} // namespace giveway::batch
