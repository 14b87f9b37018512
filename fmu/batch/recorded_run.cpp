#include "recorded_run.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <new>

#include "links.hpp"

namespace giveway::batch {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint32_t steps_per_report = 64;

} // namespace

RecordedRun::RecordedRun(const gwb_spec_t &spec, Monitor &monitor, gwb_result_t &result)
    : Judged(result), spec_(spec), monitor_(monitor) {}

RecordedRun::~RecordedRun() { monitor_.steps_done.fetch_add(spec_.step_count - reported_, std::memory_order_relaxed); }

bool RecordedRun::prepare(testbed::Variables &testbed) {
    use(testbed);
    return check_spec() && create() && apply_settings(spec_.settings, spec_.setting_count);
}

bool RecordedRun::model_failed(std::uint32_t status, std::uint32_t model, Message &message) {
    message.text[sizeof message.text - 1] = '\0';
    result_.model = model;
    const bool silent = message.text[0] == '\0';
    return end(status, "%s: %s", info_of(model).name, silent ? "the model failed without a message" : message.text);
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
    return check_limits({spec_.transient_limit_n, spec_.lasting_limit_n}) &&
           check_array("settings", spec_.settings, spec_.setting_count) &&
           check_array("plan", spec_.plan, spec_.plan_rows) && check_array("push", spec_.push, spec_.push_rows) &&
           check_array("columns", spec_.columns, spec_.column_count) &&
           check_columns(spec_.columns, spec_.column_count) &&
           check_table("plan", plan_inputs(), spec_.plan, spec_.plan_rows) &&
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

bool RecordedRun::create() {
    controller_.reset(controller::create_model());
    recorders_.reset(new (std::nothrow) Recorder[spec_.column_count]);
    if (controller_ == nullptr || recorders_ == nullptr) {
        return end(GWB_NO_MEMORY, "no memory for a run of %u steps", static_cast<unsigned>(spec_.step_count));
    }
    use(*static_cast<controller::Variables *>(controller_->variables()));
    for (std::uint32_t i = 0; i < spec_.column_count; ++i) {
        const gwb_column_t &column = spec_.columns[i];
        const VariableInfo &variable = *find(info_of(column.model), column.reference);
        recorders_[i] = {variables_[column.model] + variable.offset, static_cast<unsigned char *>(column.values),
                         size_of(variable.type)};
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

// The exchange order is part of the definition of a run: see fmu/README.md and cosim/giveway/simulation/master.py.
bool RecordedRun::exchange(std::uint32_t step) {
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
            std::clamp<std::int64_t>(controller().path_ticks, 0, std::int64_t{spec_.plan_rows} - 1));
    }
    return true;
}

void RecordedRun::record(std::uint32_t k, double now_s) {
    for (std::uint32_t i = 0; i < spec_.column_count; ++i) {
        const Recorder &r = recorders_[i];
        std::memcpy(r.to + k * r.size, r.from, r.size);
    }
    take_sample(samples_[k], now_s, testbed(), controller());
    result_.rows = k + 1;
}

void RecordedRun::judge() { judge_samples(samples_, {spec_.transient_limit_n, spec_.lasting_limit_n}); }

void RecordedRun::report(std::uint32_t step) {
    if (step % steps_per_report == 0) {
        monitor_.steps_done.fetch_add(step - reported_, std::memory_order_relaxed);
        reported_ = step;
    }
}

} // namespace giveway::batch
