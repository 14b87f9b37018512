#include "lag_variables.hpp"
#include "model.hpp"
#include "state_archive.hpp"

#include <cmath>
#include <cstdio>
#include <new>

namespace giveway {
namespace {

class Lag final : public Model {
public:
    Lag() { set_start_values(variables_); }

    void *variables() override { return &variables_; }

    Status initialise(double, Message &message) override {
        if (variables_.lag_limit == 0.0) {
            std::snprintf(message.text, sizeof message.text, "lag.limit is 0 N.m, nothing can hold that");
            return Status::error;
        }
        variables_.output_y = variables_.lag_time_constant;
        return Status::ok;
    }

    Status step(double time_s, double step_size_s, Message &message) override {
        const lag::Variables &in = variables_;
        double y = in.output_y;
        for (int i = 0; i < in.lag_repetitions && !in.input_hold; ++i) {
            y += step_size_s / in.lag_repetitions * (in.input_u - y) / in.lag_time_constant;
        }
        if (std::fabs(y) > in.lag_limit) {
            std::snprintf(message.text, sizeof message.text, "the lag broke at %g s: 100%% over", time_s);
            return Status::error;
        }
        variables_.output_y = y;
        for (int i = 0; i < 2; ++i) {
            variables_.output_raw[i] = in.lag_weights[i] * in.input_raw[i];
        }
        variables_.output_number = in.input_number;
        variables_.output_held = in.input_hold;
        return Status::ok;
    }

    template <class Archive> void archive(Archive &a) { a(variables_); }
    std::size_t save_state(void *bytes) override { return save_archive(*this, bytes); }

    Status load_state(const void *bytes, std::size_t size, Message &message) override {
        return load_archive(*this, bytes, size, message);
    }

    void reset() override { set_start_values(variables_); }

private:
    lag::Variables variables_;
};

} // namespace

Model *lag::create_model() { return new (std::nothrow) Lag; }

} // namespace giveway
