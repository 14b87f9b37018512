// What a collision is judged by, computed from samples of a run. The definitions are those of
// cosim/giveway/metrics.py; a test holds both equal.
#pragma once

#include <cstddef>

namespace giveway::batch {

// What the metrics need of one row of the traces; names as in the variable tables, SI units.
struct Sample {
    double time_s;
    // testbed.truth
    double x, y, theta, vx, vy;
    double wheel_torque[3], motor_torque[3], sensed_torque[3];
    double contact_force, contact_force_x, contact_force_y;
    double contact_base_x, contact_base_y;
    double contact_impulse_x, contact_impulse_y;
    double first_contact_time;
    double nose_x, nose_y;
    double bumper_compression;
    double tip_margin;
    // testbed inputs
    double push_force_x, push_force_y;
    double energy_stored, energy_work_in, energy_dissipated, energy_residual;
    // controller
    double estimate_force, estimate_force_x, estimate_force_y;
    double detection_direction, detection_point_x, detection_point_y;
    double reference_x, reference_y, reference_theta;
    double plan_x, plan_y, plan_theta;
    int detection_count;
    int mode;
    int events;
    bool contact, pushed, latched, rope_taut;
};

struct MetricParameters {
    double wheel_radius_m, wheel_distance_m;
    double estimate_window_s; // over which the estimate is averaged
    bool bumper;
    double bumper_travel_m;
    bool tipping;
    double mass_kg, com_height_m, contact_height_m, push_height_m;
    double transient_limit_n, lasting_limit_n; // as in gwb_spec_t
    double sensed_torque_limit_nm, motor_torque_limit_nm;
};

// Fills value and truth ([GWB_METRIC_COUNT] each); NaN for what did not happen. At least two samples.
void evaluate(const Sample *samples, std::size_t count, const MetricParameters &parameters, double *value,
              double *truth);

} // namespace giveway::batch
