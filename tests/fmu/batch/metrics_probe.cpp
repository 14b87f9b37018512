// The batch library's metrics behind a flat C interface: tests/cosim/test_metric_definitions.py hands them samples.
#include "metrics.hpp"

#include <iterator>
#include <vector>

using giveway::batch::MetricParameters;
using giveway::batch::Sample;

namespace {

struct Column {
    const char *trace; // as in a result's traces
    void (*set)(Sample &, double);
};

#define COLUMN(trace, member) \
    {trace, [](Sample &s, double value) { s.member = static_cast<decltype(s.member)>(value); }}

constexpr Column columns[] = {
    COLUMN("time", time_s),
    COLUMN("testbed.truth.x", x),
    COLUMN("testbed.truth.y", y),
    COLUMN("testbed.truth.theta", theta),
    COLUMN("testbed.truth.vx", vx),
    COLUMN("testbed.truth.vy", vy),
    {"testbed.truth.wheel_torque[0]", [](Sample &s, double value) { s.wheel_torque[0] = value; }},
    {"testbed.truth.wheel_torque[1]", [](Sample &s, double value) { s.wheel_torque[1] = value; }},
    {"testbed.truth.wheel_torque[2]", [](Sample &s, double value) { s.wheel_torque[2] = value; }},
    {"testbed.truth.motor_torque[0]", [](Sample &s, double value) { s.motor_torque[0] = value; }},
    {"testbed.truth.motor_torque[1]", [](Sample &s, double value) { s.motor_torque[1] = value; }},
    {"testbed.truth.motor_torque[2]", [](Sample &s, double value) { s.motor_torque[2] = value; }},
    {"testbed.sensor.torque[0]", [](Sample &s, double value) { s.sensed_torque[0] = value; }},
    {"testbed.sensor.torque[1]", [](Sample &s, double value) { s.sensed_torque[1] = value; }},
    {"testbed.sensor.torque[2]", [](Sample &s, double value) { s.sensed_torque[2] = value; }},
    COLUMN("testbed.truth.contact_force", contact_force),
    COLUMN("testbed.truth.contact_force_x", contact_force_x),
    COLUMN("testbed.truth.contact_force_y", contact_force_y),
    COLUMN("testbed.truth.contact_base_x", contact_base_x),
    COLUMN("testbed.truth.contact_base_y", contact_base_y),
    COLUMN("testbed.truth.contact_impulse_x", contact_impulse_x),
    COLUMN("testbed.truth.contact_impulse_y", contact_impulse_y),
    COLUMN("testbed.truth.first_contact_time", first_contact_time),
    COLUMN("testbed.truth.nose_x", nose_x),
    COLUMN("testbed.truth.nose_y", nose_y),
    COLUMN("testbed.truth.bumper_compression", bumper_compression),
    COLUMN("testbed.truth.tip_margin", tip_margin),
    COLUMN("testbed.push.force_x", push_force_x),
    COLUMN("testbed.push.force_y", push_force_y),
    COLUMN("testbed.energy.stored", energy_stored),
    COLUMN("testbed.energy.work_in", energy_work_in),
    COLUMN("testbed.energy.dissipated", energy_dissipated),
    COLUMN("testbed.energy.residual", energy_residual),
    COLUMN("controller.estimate.force", estimate_force),
    COLUMN("controller.estimate.force_x", estimate_force_x),
    COLUMN("controller.estimate.force_y", estimate_force_y),
    COLUMN("controller.detection.direction", detection_direction),
    COLUMN("controller.detection.point_x", detection_point_x),
    COLUMN("controller.detection.point_y", detection_point_y),
    COLUMN("controller.reference.x", reference_x),
    COLUMN("controller.reference.y", reference_y),
    COLUMN("controller.reference.theta", reference_theta),
    COLUMN("controller.plan.x", plan_x),
    COLUMN("controller.plan.y", plan_y),
    COLUMN("controller.plan.theta", plan_theta),
    COLUMN("controller.mode", mode),
    COLUMN("controller.detection.count", detection_count),
    COLUMN("testbed.truth.contact", contact),
    COLUMN("testbed.truth.latched", latched),
};

} // namespace

extern "C" {

__attribute__((visibility("default"))) std::size_t metrics_column_count() { return std::size(columns); }

__attribute__((visibility("default"))) const char *metrics_column(std::size_t column) { return columns[column].trace; }

// `table`: count rows of columns; `parameters`: wheel radius and distance, averaging window, bumper, its travel,
// tipping, mass, heights of the centre of mass, the contact and the push, limits of transient and lasting force, of the
// sensed and the motors' torque.
__attribute__((visibility("default"))) void metrics_evaluate(const double *table, std::size_t count,
                                                             const double *parameters, double *value, double *truth) {
    std::vector<Sample> samples(count);
    for (Sample &s : samples) {
        for (const Column &column : columns) {
            column.set(s, *table++);
        }
        s.pushed = s.push_force_x != 0.0 || s.push_force_y != 0.0;
    }
    const double *p = parameters;
    const MetricParameters all{.wheel_radius_m = p[0],
                               .wheel_distance_m = p[1],
                               .estimate_window_s = p[2],
                               .bumper = p[3] != 0.0,
                               .bumper_travel_m = p[4],
                               .tipping = p[5] != 0.0,
                               .mass_kg = p[6],
                               .com_height_m = p[7],
                               .contact_height_m = p[8],
                               .push_height_m = p[9],
                               .transient_limit_n = p[10],
                               .lasting_limit_n = p[11],
                               .sensed_torque_limit_nm = p[12],
                               .motor_torque_limit_nm = p[13]};
    evaluate(samples.data(), count, all, value, truth);
}
}
