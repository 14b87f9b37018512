// The controller: the C library of c_core, unchanged, behind the model interface.
//
// A step runs the control ticks that fall into [t, t + h), with the inputs held; tick k is due k periods after the
// start. A step shorter than the period may run none.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <new>

#include "controller_members.hpp"
#include "controller_variables.hpp"
#include "model.hpp"
#include "state_archive.hpp"
#include "times.hpp"

namespace giveway::controller {

namespace {

class Controller final : public Model {
public:
    Controller() { set_start_values(v_); }

    void *variables() override { return &v_; }

    void reset() override {
        v_ = {};
        set_start_values(v_);
    }

    template <class Archive> void archive(Archive &a) {
        a(v_);
        a(controller_);
        a(start_time_s_);
        a(ticks_);
    }

    std::size_t save_state(void *bytes) override { return save_archive(*this, bytes); }

    Status load_state(const void *bytes, std::size_t size, Message &message) override {
        return load_archive(*this, bytes, size, message);
    }

    Status initialise(double start_time_s, Message &message) override {
        const gw_controller_config_t config = configuration(v_);
        gw_config_error_t error{};
        if (gw_controller_init(&controller_, &config, &error) != GW_STATUS_OK) {
            explain(error, message);
            return Status::error;
        }
        start_time_s_ = start_time_s;
        ticks_ = 0;
        // Before the first tick: do not move, in the mode that comes first.
        gw_controller_output_t output{};
        gw_controller_safe_output(&output);
        output.mode = GW_MODE_TARING;
        write_outputs(output, v_);
        assign(v_.status, GW_STATUS_NOT_INITIALISED);
        return Status::ok;
    }

    Status step(double time_s, double step_size_s, Message &) override {
        const double latest_s = std::max(std::fabs(time_s + step_size_s), std::fabs(start_time_s_));
        const double end_ticks = (time_s + step_size_s - start_time_s_) / v_.controller_period -
                                 tick_tolerance(latest_s, 1.0 / v_.controller_period);
        const gw_controller_input_t in = inputs(v_);
        while (static_cast<double>(ticks_) < end_ticks) {
            gw_controller_output_t output{};
            assign(v_.status, gw_controller_step(&controller_, &in, &output));
            write_outputs(output, v_);
            ++ticks_;
        }
        return Status::ok;
    }

private:
    static void explain(const gw_config_error_t &error, Message &message) {
        const char *name = gw_config_name(error.field);
        const auto value = static_cast<double>(error.value);
        switch (error.field) {
        case GW_FIELD_OUTLINE_CONVEX:
            std::snprintf(message.text, sizeof message.text,
                          "outline.x, outline.y: the edge from vertex %u has a vertex on its right or on it; the "
                          "outline must run counter-clockwise, be convex and have no three vertices on a line",
                          static_cast<unsigned>(error.index));
            break;
        case GW_FIELD_GEOMETRY_WHEEL_SLOT:
            std::snprintf(message.text, sizeof message.text,
                          "%s[%u] = %g is not allowed: each of 0, 1 and 2 exactly once", name,
                          static_cast<unsigned>(error.index), value);
            break;
        case GW_FIELD_OUTLINE_X:
        case GW_FIELD_OUTLINE_Y:
        case GW_FIELD_ESTIMATOR_PRESLIDING_STIFFNESS:
            std::snprintf(message.text, sizeof message.text, "%s[%u] = %.9g is not allowed: [%.9g, %.9g]", name,
                          static_cast<unsigned>(error.index), value, static_cast<double>(error.minimum),
                          static_cast<double>(error.maximum));
            break;
        default:
            std::snprintf(message.text, sizeof message.text, "%s = %.9g is not allowed: [%.9g, %.9g]", name, value,
                          static_cast<double>(error.minimum), static_cast<double>(error.maximum));
            break;
        }
    }

    Variables v_{};
    gw_controller_t controller_{};
    double start_time_s_ = 0.0;
    std::int64_t ticks_ = 0; // since the start
};

} // namespace

} // namespace giveway::controller

giveway::Model *giveway::controller::create_model() { return new (std::nothrow) Controller; }
