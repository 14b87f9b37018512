#include "judged.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <iterator>
#include <limits>

namespace giveway::batch {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
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

bool Judged::end(std::uint32_t status, const char *format, ...) {
    result_.status = status;
    std::va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(result_.message, sizeof result_.message, format, arguments);
    va_end(arguments);
    return false;
}

// `where` comes before the variable's name, e.g. "plan, row 3: ".
bool Judged::refuse_value(std::uint32_t status, const char *where, std::uint32_t model, const VariableInfo &variable,
                          double value) {
    result_.model = model;
    result_.reference = variable.reference;
    result_.value = value;
    result_.minimum = variable.type == VariableType::boolean ? 0.0 : variable.minimum;
    result_.maximum = variable.type == VariableType::boolean ? 1.0 : variable.maximum;
    const char *kind = variable.type == VariableType::real ? "finite" : "a whole number";
    return end(status, "%s%s.%s = %.17g is not allowed: %s and in [%.17g, %.17g]", where, info_of(model).name,
               variable.name, value, kind, result_.minimum, result_.maximum);
}

bool Judged::check_array(const char *name, const void *array, std::uint32_t count) {
    return array != nullptr || count == 0 ||
           end(GWB_WRONG_SPEC, "%s is a null pointer, but its count is %u", name, static_cast<unsigned>(count));
}

bool Judged::check_limits(const ForceLimits &limits) {
    const double values[] = {limits.transient_n, limits.lasting_n};
    for (std::size_t i = 0; i < std::size(values); ++i) {
        if (!(values[i] >= 0.0 && values[i] <= limit_max_n)) {
            return end(GWB_WRONG_SPEC, "%s = %.17g is not allowed: [0, %g] N",
                       i == 0 ? "transient_limit_n" : "lasting_limit_n", values[i], limit_max_n);
        }
    }
    return true;
}

// The variable of entry `index` of an array of the spec; null, with the run ended, if there is none.
const VariableInfo *Judged::lookup(const char *array, std::uint32_t index, std::uint32_t model,
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

bool Judged::check_columns(const gwb_column_t *columns, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
        const gwb_column_t &column = columns[i];
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

bool Judged::apply_settings(const gwb_setting_t *settings, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) {
        const gwb_setting_t &setting = settings[i];
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

} // namespace giveway::batch
