// Common to runs and recorded traces: both models' variables with the caller's settings, messages of refusals, metrics.
#pragma once

#include <array>
#include <cstdint>

#include "metrics.hpp"
#include "models.hpp"

namespace giveway::batch {

// Writes all of `result`, as of a run that has not started.
void clear(gwb_result_t &result);

class Judged {
public:
    explicit Judged(gwb_result_t &result) : result_(result) { clear(result); }
    Judged(const Judged &) = delete;
    Judged &operator=(const Judged &) = delete;

    // Ends it with a message; always false.
    [[gnu::format(printf, 3, 4)]] bool end(std::uint32_t status, const char *format, ...);

    [[nodiscard]] gwb_result_t &result() { return result_; }

protected:
    ~Judged() = default;

    void use(testbed::Variables &testbed) { variables_[GWB_TESTBED] = reinterpret_cast<unsigned char *>(&testbed); }
    void use(controller::Variables &controller) {
        variables_[GWB_CONTROLLER] = reinterpret_cast<unsigned char *>(&controller);
    }
    [[nodiscard]] const testbed::Variables &testbed() const {
        return *reinterpret_cast<const testbed::Variables *>(variables_[GWB_TESTBED]);
    }
    [[nodiscard]] const controller::Variables &controller() const {
        return *reinterpret_cast<const controller::Variables *>(variables_[GWB_CONTROLLER]);
    }

    // Each of these is false if it ended with a message.
    bool refuse_value(std::uint32_t status, const char *where, std::uint32_t model, const VariableInfo &variable,
                      double value);
    bool check_array(const char *name, const void *array, std::uint32_t count);
    bool check_limits(const ForceLimits &limits);
    bool check_columns(const gwb_column_t *columns, std::uint32_t count);
    bool apply_settings(const gwb_setting_t *settings, std::uint32_t count);
    // result().rows samples, at least one.
    void judge_samples(const Sample *samples, const ForceLimits &limits) {
        evaluate(samples, result_.rows, testbed(), controller(), limits, result_.metric, result_.truth);
    }

    gwb_result_t &result_;
    std::array<unsigned char *, GWB_MODEL_COUNT> variables_{};

private:
    const VariableInfo *lookup(const char *array, std::uint32_t index, std::uint32_t model, std::uint32_t reference);
};

} // namespace giveway::batch
