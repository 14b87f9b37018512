#include "evaluation.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>

#include "judged.hpp"

namespace giveway::batch {

namespace {

class Evaluation : public Judged {
public:
    Evaluation(const gwb_traces_t &traces, gwb_result_t &result) : Judged(result), traces_(traces) {
        testbed::set_start_values(testbed_);
        controller::set_start_values(controller_);
        use(testbed_);
        use(controller_);
    }

    void go() {
        const ForceLimits limits{traces_.transient_limit_n, traces_.lasting_limit_n};
        if (!check_rows() || !check_limits(limits) ||
            !check_array("settings", traces_.settings, traces_.setting_count) ||
            !check_array("columns", traces_.columns, traces_.column_count) ||
            !check_columns(traces_.columns, traces_.column_count) ||
            !apply_settings(traces_.settings, traces_.setting_count) || !find_columns()) {
            return;
        }
        const std::unique_ptr<Sample[]> samples(new (std::nothrow) Sample[traces_.rows]);
        if (samples == nullptr) {
            end(GWB_NO_MEMORY, "no memory for %u rows", static_cast<unsigned>(traces_.rows));
            return;
        }
        for (std::uint32_t row = 0; row < traces_.rows; ++row) {
            load_row(row);
            take_sample(samples[row], traces_.time_s[row], testbed_, controller_);
        }
        result_.rows = traces_.rows;
        result_.time_s = traces_.time_s[traces_.rows - 1];
        judge_samples(samples.get(), limits);
    }

private:
    // One recorded value per row and the variable that it is of.
    struct Source {
        const unsigned char *values;
        unsigned char *variable;
        VariableType type;
    };

    bool check_rows() {
        if (traces_.rows < 1 || traces_.rows > GWB_STEP_COUNT_MAX + 1) {
            return end(GWB_WRONG_SPEC, "rows = %u is not allowed: [1, %d]", static_cast<unsigned>(traces_.rows),
                       GWB_STEP_COUNT_MAX + 1);
        }
        if (!check_array("time_s", traces_.time_s, traces_.rows)) {
            return false;
        }
        for (std::uint32_t row = 0; row < traces_.rows; ++row) {
            const double time_s = traces_.time_s[row];
            if (!std::isfinite(time_s) || (row > 0 && !(time_s > traces_.time_s[row - 1]))) {
                return end(GWB_WRONG_SPEC, "time_s[%u] = %.17g is not allowed: finite and above the one before it",
                           static_cast<unsigned>(row), time_s);
            }
        }
        return true;
    }

    // The columns that the samples are taken from.
    bool find_columns() {
        bool complete = true;
        each_trace([&]<class Variables, class Value>(Value Sample::*, Value Variables::*from) {
            constexpr bool of_testbed = std::is_same_v<Variables, testbed::Variables>;
            const std::uint32_t model = of_testbed ? GWB_TESTBED : GWB_CONTROLLER;
            unsigned char *variables = variables_[model];
            auto *first = reinterpret_cast<unsigned char *>(&(reinterpret_cast<Variables *>(variables)->*from));
            constexpr std::size_t size = sizeof(std::remove_all_extents_t<Value>);
            for (std::size_t offset = 0; complete && offset < sizeof(Value); offset += size) {
                complete = find_column(model, first + offset);
            }
        });
        return complete;
    }

    bool find_column(std::uint32_t model, unsigned char *variable) {
        const auto offset = static_cast<std::size_t>(variable - variables_[model]);
        const VariableInfo *info = info_of(model).variables;
        while (info->offset != offset) {
            ++info;
        }
        for (std::uint32_t i = 0; i < traces_.column_count; ++i) {
            const gwb_column_t &column = traces_.columns[i];
            if (column.model == model && column.reference == info->reference) {
                sources_[source_count_++] = {static_cast<const unsigned char *>(column.values), variable, info->type};
                return true;
            }
        }
        if (std::strncmp(info->name, "push.", 5) == 0) {
            return true; // there was no push: 0 is the start value
        }
        result_.model = model;
        result_.reference = info->reference;
        return end(GWB_WRONG_SPEC, "columns: %s.%s is missing", info_of(model).name, info->name);
    }

    void load_row(std::size_t row) {
        for (std::size_t i = 0; i < source_count_; ++i) {
            const Source &source = sources_[i];
            const std::size_t size = size_of(source.type);
            const unsigned char *value = source.values + row * size;
            if (source.type == VariableType::boolean) {
                *reinterpret_cast<bool *>(source.variable) = *value != 0;
            } else {
                std::memcpy(source.variable, value, size);
            }
        }
    }

    const gwb_traces_t &traces_;
    testbed::Variables testbed_{};
    controller::Variables controller_{};
    std::array<Source, sizeof(Sample)> sources_{}; // each is at least a byte of a sample
    std::size_t source_count_ = 0;
};

} // namespace

void evaluate_traces(const gwb_traces_t &traces, gwb_result_t &result) { Evaluation(traces, result).go(); }

} // namespace giveway::batch
