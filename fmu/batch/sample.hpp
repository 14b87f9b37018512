// The values of a run that the metrics read: one sample per row of its traces.
#pragma once

#include <algorithm>
#include <cstddef>
#include <type_traits>

#include "controller_variables.hpp"
#include "plant_parameters.hpp"
#include "testbed_variables.hpp"

namespace giveway::batch {

inline constexpr int wheel_count = plant::table_wheels;

// Names as in the variable tables, SI units.
struct Sample {
    double time_s;
    // testbed.truth
    double x, y, theta, vx, vy;
    double wheel_torque[wheel_count], motor_torque[wheel_count];
    double contact_force, contact_force_x, contact_force_y;
    double contact_base_x, contact_base_y;
    double contact_impulse_x, contact_impulse_y;
    double first_contact_time;
    double nose_x, nose_y;
    double bumper_compression;
    double tip_margin;
    // testbed
    double sensed_torque[wheel_count];
    double push_force_x, push_force_y;
    double energy_stored, energy_work_in, energy_dissipated, energy_residual;
    // controller
    double estimate_force, estimate_force_x, estimate_force_y;
    double detection_direction, detection_point_x, detection_point_y;
    double reference_x, reference_y, reference_theta;
    double plan_x, plan_y, plan_theta;
    int detection_count;
    int mode;
    int events; // of the testbed
    bool contact, latched, rope_taut;
};

// Calls visit(member of Sample, member of a model's Variables) for all but the time.
template <class Visit> void each_trace(Visit &&visit) {
    using T = testbed::Variables;
    visit(&Sample::x, &T::truth_x);
    visit(&Sample::y, &T::truth_y);
    visit(&Sample::theta, &T::truth_theta);
    visit(&Sample::vx, &T::truth_vx);
    visit(&Sample::vy, &T::truth_vy);
    visit(&Sample::wheel_torque, &T::truth_wheel_torque);
    visit(&Sample::motor_torque, &T::truth_motor_torque);
    visit(&Sample::contact_force, &T::truth_contact_force);
    visit(&Sample::contact_force_x, &T::truth_contact_force_x);
    visit(&Sample::contact_force_y, &T::truth_contact_force_y);
    visit(&Sample::contact_base_x, &T::truth_contact_base_x);
    visit(&Sample::contact_base_y, &T::truth_contact_base_y);
    visit(&Sample::contact_impulse_x, &T::truth_contact_impulse_x);
    visit(&Sample::contact_impulse_y, &T::truth_contact_impulse_y);
    visit(&Sample::first_contact_time, &T::truth_first_contact_time);
    visit(&Sample::nose_x, &T::truth_nose_x);
    visit(&Sample::nose_y, &T::truth_nose_y);
    visit(&Sample::bumper_compression, &T::truth_bumper_compression);
    visit(&Sample::tip_margin, &T::truth_tip_margin);
    visit(&Sample::contact, &T::truth_contact);
    visit(&Sample::latched, &T::truth_latched);
    visit(&Sample::rope_taut, &T::truth_rope_taut);
    visit(&Sample::sensed_torque, &T::sensor_torque);
    visit(&Sample::push_force_x, &T::push_force_x);
    visit(&Sample::push_force_y, &T::push_force_y);
    visit(&Sample::energy_stored, &T::energy_stored);
    visit(&Sample::energy_work_in, &T::energy_work_in);
    visit(&Sample::energy_dissipated, &T::energy_dissipated);
    visit(&Sample::energy_residual, &T::energy_residual);
    visit(&Sample::events, &T::events);
    using C = controller::Variables;
    visit(&Sample::estimate_force, &C::estimate_force);
    visit(&Sample::estimate_force_x, &C::estimate_force_x);
    visit(&Sample::estimate_force_y, &C::estimate_force_y);
    visit(&Sample::detection_direction, &C::detection_direction);
    visit(&Sample::detection_point_x, &C::detection_point_x);
    visit(&Sample::detection_point_y, &C::detection_point_y);
    visit(&Sample::detection_count, &C::detection_count);
    visit(&Sample::reference_x, &C::reference_x);
    visit(&Sample::reference_y, &C::reference_y);
    visit(&Sample::reference_theta, &C::reference_theta);
    visit(&Sample::plan_x, &C::plan_x);
    visit(&Sample::plan_y, &C::plan_y);
    visit(&Sample::plan_theta, &C::plan_theta);
    visit(&Sample::mode, &C::mode);
}

// The sample of the present values of the models' variables.
inline void take_sample(Sample &sample, double now_s, const testbed::Variables &testbed,
                        const controller::Variables &controller) {
    sample.time_s = now_s;
    each_trace([&]<class Variables, class Value>(Value Sample::*to, Value Variables::*from) {
        const Variables &variables = [&]() -> const Variables & {
            if constexpr (std::is_same_v<Variables, testbed::Variables>) {
                return testbed;
            } else {
                return controller;
            }
        }();
        if constexpr (std::is_array_v<Value>) {
            std::copy_n(variables.*from, std::extent_v<Value>, sample.*to);
        } else {
            sample.*to = variables.*from;
        }
    });
}

} // namespace giveway::batch
