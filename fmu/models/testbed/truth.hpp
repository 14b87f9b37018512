// The truth for an observer with perfect sensors, and the energy account, as outputs of the testbed.
#pragma once

#include <algorithm>
#include <cmath>

#include "outputs.hpp"
#include "testbed_variables.hpp"

namespace giveway::testbed {

// Times of the run; its clock starts at start_s.
struct RunClock {
    double start_s;
    double first_contact_s; // since the start, negative: none yet
};

// `x`: state of a planar plant at least.
inline void write_truth(Variables &v, const double *x, const plant::Outputs<double> &truth,
                        const plant::Modes<double> &modes, const plant::Parameters<double> &p,
                        const std::array<double, plant::table_wheels> &motor_torque_nm, const RunClock &clock,
                        double stored_at_start_j) {
    using At = plant::Layout<>;
    v.truth_x = x[At::base_x];
    v.truth_y = x[At::base_y];
    v.truth_theta = x[At::base_theta];
    v.truth_vx = x[At::base_vx];
    v.truth_vy = x[At::base_vy];
    v.truth_omega = x[At::base_omega];
    for (int i = 0; i < plant::table_wheels; ++i) {
        const auto wheel = static_cast<std::size_t>(i);
        v.truth_wheel_angle[i] = x[At::wheel_angle + i];
        v.truth_wheel_speed[i] = truth.wheel_speed[wheel];
        v.truth_wheel_torque[i] = truth.wheel_torque[wheel];
        v.truth_motor_torque[i] = motor_torque_nm[wheel];
        v.truth_gear_stuck[i] = std::fabs(modes.gear_direction[wheel]) < 0.5;
        v.truth_roller_force[i] = truth.roller_force[wheel];
    }
    v.truth_contact = modes.contact > 0.5;
    v.truth_contact_force = truth.contact_force;
    v.truth_contact_force_x = truth.contact_force_x;
    v.truth_contact_force_y = truth.contact_force_y;
    v.truth_contact_point_x = truth.contact_point_x;
    v.truth_contact_point_y = truth.contact_point_y;
    v.truth_contact_base_x = truth.contact_base_x;
    v.truth_contact_base_y = truth.contact_base_y;
    v.truth_contact_impulse_x = x[At::impulse_x];
    v.truth_contact_impulse_y = x[At::impulse_y];
    v.truth_first_contact_time = clock.first_contact_s < 0.0 ? -1.0 : clock.start_s + clock.first_contact_s;
    v.truth_slider_position = x[At::slider_position];
    v.truth_slider_speed = x[At::slider_speed];
    v.truth_nose_x = truth.nose_x;
    v.truth_nose_y = truth.nose_y;
    v.truth_bumper_compression = x[At::compression];
    v.truth_bumper_force = truth.bumper_force;
    v.truth_latched = p.has_plate() && plant::is_latched(p, x[At::compression], modes.latched > 0.5);
    v.truth_rope_tension = truth.rope_tension;
    v.truth_rope_taut = modes.rope_taut > 0.5;
    v.truth_wall_force = truth.wall_force;
    v.truth_roll = truth.roll;
    v.truth_pitch = truth.pitch;
    std::copy_n(truth.wheel_load.begin(), plant::table_wheels, v.truth_wheel_load);
    v.truth_tip_margin = truth.tip_margin;
    v.truth_weight_drop = x[At::weight_drop];
    v.energy_stored = truth.stored_energy - stored_at_start_j;
    v.energy_work_in = x[At::work_in];
    v.energy_dissipated = x[At::dissipated];
    v.energy_residual = v.energy_work_in - v.energy_dissipated - v.energy_stored;
}

} // namespace giveway::testbed
