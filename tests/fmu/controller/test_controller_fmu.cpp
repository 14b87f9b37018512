// The adapter between the C library and the model interface: same defaults, same bounds, same ticks, clear refusals.
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "controller_members.hpp"
#include "controller_variables.hpp"
#include "giveway/gw_config.h"
#include "model.hpp"

namespace {

using giveway::Message;
using giveway::Status;
using giveway::controller::Variables;

class Fmu {
public:
    Fmu() : model(giveway::create_model()), v(*static_cast<Variables *>(model->variables())) {}
    Status initialise() { return model->initialise(0.0, message); }
    std::unique_ptr<giveway::Model> model;
    Variables &v;
    Message message{};
};

const giveway::VariableInfo *variable(const std::string &name) {
    const giveway::ModelInfo &info = giveway::model_info();
    for (std::size_t i = 0; i < info.variable_count; ++i) {
        if (name == info.variables[i].name || name + "[0]" == info.variables[i].name) {
            return &info.variables[i];
        }
    }
    return nullptr;
}

TEST(ControllerFmu, StartValuesAreTheDefaultsOfTheLibrary) {
    // The robot file on one side, gw_trikey.h on the other: one set of numbers.
    Variables start{};
    giveway::controller::set_start_values(start);
    const gw_controller_config_t from_table = giveway::controller::configuration(start);
    gw_controller_config_t from_library{};
    gw_controller_config_trikey(&from_library);
    EXPECT_EQ(std::memcmp(&from_table, &from_library, sizeof from_table), 0);
}

TEST(ControllerFmu, BoundsAreThoseOfTheLibrary) {
    int compared = 0;
    for (int row = 1; row < GW_FIELD_COUNT; ++row) {
        const auto field = static_cast<gw_config_field_t>(row);
        const gw_config_limit_t limit = gw_config_limit(field);
        const std::string name = gw_config_name(field);
        if (field == GW_FIELD_OUTLINE_CONVEX || name.starts_with("servo.")) {
            continue; // a rule on the whole outline; the servo is in the testbed
        }
        const giveway::VariableInfo *info = variable(name);
        ASSERT_NE(info, nullptr) << name;
        EXPECT_EQ(info->causality, giveway::Causality::parameter);
        EXPECT_EQ(static_cast<float>(info->minimum), limit.minimum) << name;
        EXPECT_EQ(static_cast<float>(info->maximum), limit.maximum) << name;
        ++compared;
    }
    EXPECT_GT(compared, 55);
}

TEST(ControllerFmu, RefusalsNameVariableValueAndRange) {
    Fmu fmu;
    fmu.v.base_mass = 2001.0;
    ASSERT_EQ(fmu.initialise(), Status::error);
    EXPECT_STREQ(fmu.message.text, "base.mass = 2001 is not allowed: [0.100000001, 2000]");
    fmu.model->reset();
    fmu.v.geometry_wheel_slot[2] = 1;
    ASSERT_EQ(fmu.initialise(), Status::error);
    EXPECT_STREQ(fmu.message.text, "geometry.wheel_slot[2] = 1 is not allowed: each of 0, 1 and 2 exactly once");
    fmu.model->reset();
    fmu.v.outline_y[1] = -0.4; // clockwise
    ASSERT_EQ(fmu.initialise(), Status::error);
    EXPECT_NE(std::strstr(fmu.message.text, "counter-clockwise"), nullptr);
    fmu.model->reset();
    fmu.v.outline_y[1] = 11.0;
    ASSERT_EQ(fmu.initialise(), Status::error);
    EXPECT_STREQ(fmu.message.text, "outline.y[1] = 11 is not allowed: [-10, 10]");
    fmu.model->reset();
    fmu.v.estimator_presliding_stiffness[2] = 9.0;
    ASSERT_EQ(fmu.initialise(), Status::error);
    EXPECT_STREQ(fmu.message.text, "estimator.presliding_stiffness[2] = 9 is not allowed: [10, 10000000]");
    fmu.model->reset();
    fmu.v.controller_period = 0.02;
    fmu.v.reference_follow_gain = 30.0;
    ASSERT_EQ(fmu.initialise(), Status::error);
    EXPECT_NE(std::strstr(fmu.message.text, "reference.follow_gain = 30"), nullptr);
    fmu.model->reset();
    EXPECT_EQ(fmu.initialise(), Status::ok);
}

// Bounds hold after rounding to float: the double just above a bound rounds onto it and is accepted.
TEST(ControllerFmu, RangesAreCheckedAfterRounding) {
    Fmu fmu;
    fmu.v.base_mass = std::nextafter(2000.0, 3000.0);
    EXPECT_EQ(fmu.initialise(), Status::ok);
    fmu.v.base_mass = 2000.0001; // next float is 2000.00012
    EXPECT_EQ(fmu.initialise(), Status::error);
}

TEST(ControllerFmu, TicksAreThoseThatFallIntoTheStep) {
    Fmu fmu;
    ASSERT_EQ(fmu.initialise(), Status::ok);
    EXPECT_FALSE(fmu.v.command_enable);
    EXPECT_EQ(fmu.v.detection_tick, -1);
    EXPECT_EQ(fmu.v.mode, GW_MODE_TARING);
    const auto step = [&](double t, double h) {
        ++fmu.v.sensor_counter;
        ASSERT_EQ(fmu.model->step(t, h, fmu.message), Status::ok);
    };
    step(0.0, 0.0005);
    EXPECT_EQ(fmu.v.tick, 0);
    EXPECT_TRUE(fmu.v.command_enable);
    step(0.0005, 0.0005); // tick 1 is due at 0.001, not before
    EXPECT_EQ(fmu.v.tick, 0);
    step(0.001, 0.0005);
    EXPECT_EQ(fmu.v.tick, 1);
    double t = 0.002;
    for (int i = 2; i < 5000; ++i) {
        step(t, 0.001);
        ASSERT_EQ(fmu.v.tick, i); // times accumulate rounding, ticks do not
        t += 0.001;
    }
}

TEST(ControllerFmu, BadSensorsAreHandledNotRefused) {
    Fmu fmu;
    ASSERT_EQ(fmu.initialise(), Status::ok);
    ASSERT_EQ(fmu.model->step(0.0, 0.001, fmu.message), Status::ok);
    EXPECT_EQ(fmu.v.status, GW_STATUS_OK);
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
        fmu.v.sensor_torque[1] = bad; // 1e300 rounds to infinity in float
        ++fmu.v.sensor_counter;
        ASSERT_EQ(fmu.model->step(0.001, 0.001, fmu.message), Status::ok);
        EXPECT_EQ(fmu.v.status, GW_STATUS_SENSOR_NONFINITE);
        EXPECT_EQ(fmu.v.mode, GW_MODE_FAULT);
        EXPECT_EQ(fmu.v.command_wheel_speed[0], 0.0);
        fmu.model->reset();
        ASSERT_EQ(fmu.initialise(), Status::ok);
        ASSERT_EQ(fmu.model->step(0.0, 0.001, fmu.message), Status::ok);
    }
}

TEST(ControllerFmu, BristlesReachTheLibrary) {
    // The estimate of the FMU is that of the library with the same numbers, and not that of the tanh law.
    const auto run = [](bool bristles) {
        Fmu fmu;
        fmu.v.estimator_friction_model = bristles ? 1 : 0;
        fmu.v.estimator_presliding_stiffness[0] = 2.0e4;
        fmu.v.estimator_presliding_stiffness[1] = 3.0e4;
        fmu.v.estimator_presliding_stiffness[2] = 4.0e4;
        fmu.v.estimator_drivetrain_stiffness = 668.0;
        fmu.v.estimator_presliding_damping = 10.0;
        fmu.v.estimator_stribeck_speed = 0.004;
        fmu.v.estimator_elastic_fraction = 0.5;
        fmu.v.detector_impulse_threshold = 100.0; // no reaction
        EXPECT_EQ(fmu.initialise(), Status::ok);
        gw_controller_t library{};
        const gw_controller_config_t config = giveway::controller::configuration(fmu.v);
        EXPECT_EQ(gw_controller_init(&library, &config, nullptr), GW_STATUS_OK);
        double seen = 0.0;
        for (int k = 0; k < 400; ++k) {
            fmu.v.sensor_counter = k;
            const double ramp = k < 150 ? 0.0 : 0.5 * std::min(1.0, (k - 150) / 100.0);
            fmu.v.sensor_torque[1] = ramp;
            fmu.v.sensor_torque[2] = -ramp;
            const gw_controller_input_t input = giveway::controller::inputs(fmu.v);
            gw_controller_output_t output{};
            EXPECT_EQ(gw_controller_step(&library, &input, &output), GW_STATUS_OK);
            EXPECT_EQ(fmu.model->step(k * 1e-3, 1e-3, fmu.message), Status::ok);
            EXPECT_EQ(fmu.v.estimate_force_x, static_cast<double>(output.estimate.force_x_n));
            seen = fmu.v.estimate_force_x;
        }
        return seen;
    };
    const double with = run(true);
    const double without = run(false);
    EXPECT_GT(std::fabs(without), 5.0);
    // Wheels and rollers share a push as k/r_w^2 = 64.7 kN/m to some 30.
    EXPECT_NEAR(with / without, 1.0 + 30.0 / 64.7, 0.1);
}

} // namespace
