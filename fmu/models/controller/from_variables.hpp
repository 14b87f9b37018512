// Variables of the FMU -> the C library's configuration. Reals are rounded to its real type once, here.
#pragma once

#include "controller_variables.hpp"
#include "giveway/gw_controller.h"

namespace giveway::controller {

inline gw_real_t rounded(double value) { return static_cast<gw_real_t>(value); }

// A negative count becomes a huge one, which the library refuses.
inline std::uint32_t count(std::int32_t value) { return static_cast<std::uint32_t>(value); }

inline gw_controller_config_t configuration(const Variables &v) {
    gw_controller_config_t c{};
    c.period_s = rounded(v.controller_period);
    c.drives_enabled = v.controller_drives_enabled;

    c.geometry.wheel_radius_m = rounded(v.geometry_wheel_radius);
    c.geometry.roller_radius_m = rounded(v.geometry_roller_radius);
    c.geometry.wheel_distance_m = rounded(v.geometry_wheel_distance);
    for (std::size_t i = 0; i < GW_WHEEL_COUNT; ++i) {
        c.geometry.wheel_slot[i] = count(v.geometry_wheel_slot[i]);
    }
    c.geometry.azimuth_rad = rounded(v.geometry_azimuth);

    c.base.mass_kg = rounded(v.base_mass);
    c.base.yaw_inertia_kgm2 = rounded(v.base_yaw_inertia);
    c.base.wheel_inertia_kgm2 = rounded(v.base_wheel_inertia);
    c.base.roller_inertia_kgm2 = rounded(v.base_roller_inertia);
    c.friction.coulomb_torque_nm = rounded(v.friction_coulomb_torque);
    c.friction.tanh_slope_s_per_rad = rounded(v.friction_tanh_slope);

    c.sensor_check.torque_limit_nm = rounded(v.sensor_check_torque_limit);
    c.sensor_check.stale_ticks_max = count(v.sensor_check_stale_ticks_max);
    c.sensor_check.encoder_jump_counts = count(v.sensor_check_encoder_jump);
    c.sensor_check.recover_ticks = count(v.sensor_check_recover_ticks);

    c.estimator.velocity_source = count(v.estimator_velocity_source);
    c.estimator.acceleration_source = count(v.estimator_acceleration_source);
    c.estimator.torque_noise_nm = rounded(v.estimator_torque_noise);
    c.estimator.rate_cutoff_radps = rounded(v.estimator_rate_cutoff);
    c.estimator.drivetrain_stiffness_nm_per_rad = rounded(v.estimator_drivetrain_stiffness);
    c.estimator.encoder_counts = count(v.estimator_encoder_counts);
    c.estimator.average_window = count(v.estimator_average_window);
    c.estimator.rest_speed_mps = rounded(v.estimator_rest_speed);
    c.estimator.creep_speed_mps = rounded(v.estimator_creep_speed);
    c.estimator.rest_ticks = count(v.estimator_rest_ticks);
    c.estimator.tare_ticks = count(v.estimator_tare_ticks);
    c.estimator.retare_ticks = count(v.estimator_retare_ticks);
    c.estimator.tare_variation_nm = rounded(v.estimator_tare_variation);
    c.estimator.friction_model = count(v.estimator_friction_model);
    for (std::size_t i = 0; i < GW_WHEEL_COUNT; ++i) {
        c.estimator.presliding.stiffness_n_per_m[i] = rounded(v.estimator_presliding_stiffness[i]);
    }
    c.estimator.presliding.damping_newton_s_per_m = rounded(v.estimator_presliding_damping);
    c.estimator.presliding.stribeck_speed_mps = rounded(v.estimator_stribeck_speed);
    c.estimator.presliding.elastic_fraction = rounded(v.estimator_elastic_fraction);

    c.contact.minimum_force_n = rounded(v.contact_minimum_force);
    c.contact.vertex_count = count(v.outline_count);
    for (std::size_t i = 0; i < GW_OUTLINE_VERTEX_MAX; ++i) {
        c.contact.vertex_m[i] = {rounded(v.outline_x[i]), rounded(v.outline_y[i])};
    }

    c.detector.kind = count(v.detector_kind);
    c.detector.force_threshold_n = rounded(v.detector_force_threshold);
    c.detector.impulse_threshold_newton_s = rounded(v.detector_impulse_threshold);
    c.detector.leak_rest_n = rounded(v.detector_leak_rest);
    c.detector.leak_creep_n = rounded(v.detector_leak_creep);
    c.detector.leak_motion_n = rounded(v.detector_leak_motion);
    c.detector.release_force_n = rounded(v.detector_release_force);
    c.detector.blanking_ticks = count(v.detector_blanking_ticks);

    c.admittance.kind = count(v.admittance_kind);
    c.admittance.mass_kg = rounded(v.admittance_mass);
    c.admittance.damping_newton_s_per_m = rounded(v.admittance_damping);
    c.admittance.escape_impulse_newton_s = rounded(v.admittance_escape_impulse);
    c.admittance.speed_limit_mps = rounded(v.admittance_speed_limit);
    c.admittance.acceleration_limit_mps2 = rounded(v.admittance_acceleration_limit);
    c.admittance.finish_speed_mps = rounded(v.admittance_finish_speed);

    c.reference.follow_gain_per_s = rounded(v.reference_follow_gain);
    c.reference.speed_limit_mps = rounded(v.reference_speed_limit);
    c.reference.acceleration_limit_mps2 = rounded(v.reference_acceleration_limit);
    c.reference.yaw_rate_limit_radps = rounded(v.reference_yaw_rate_limit);
    c.reference.yaw_acceleration_limit_radps2 = rounded(v.reference_yaw_acceleration_limit);
    c.reference.rejoin_speed_mps = rounded(v.reference_rejoin_speed);
    c.reference.finish_speed_mps = rounded(v.reference_finish_speed);

    c.supervisor.settled_speed_mps = rounded(v.supervisor_settled_speed);
    c.supervisor.settled_ticks = count(v.supervisor_settled_ticks);
    c.supervisor.after_settled = count(v.supervisor_after_settled);
    c.supervisor.rejoin_distance_m = rounded(v.supervisor_rejoin_distance);
    c.supervisor.rejoin_angle_rad = rounded(v.supervisor_rejoin_angle);
    return c;
}

inline gw_controller_input_t inputs(const Variables &v) {
    gw_controller_input_t in{};
    for (std::size_t i = 0; i < GW_WHEEL_COUNT; ++i) {
        in.sensor.torque_nm[i] = rounded(v.sensor_torque[i]);
        in.sensor.encoder_count[i] = v.sensor_encoder[i];
    }
    in.sensor.counter = static_cast<std::uint32_t>(v.sensor_counter);
    in.sensor.present = v.sensor_present;
    in.plan.pose = {rounded(v.plan_x), rounded(v.plan_y), rounded(v.plan_theta)};
    in.plan.twist = {rounded(v.plan_vx), rounded(v.plan_vy), rounded(v.plan_omega)};
    in.plan.acceleration = {rounded(v.plan_ax), rounded(v.plan_ay), rounded(v.plan_alpha)};
    in.stop_request = v.stop_request;
    in.tare_request = v.tare_request;
    return in;
}

inline void write_outputs(const gw_controller_output_t &out, gw_status_t status, Variables &v) {
    for (std::size_t i = 0; i < GW_WHEEL_COUNT; ++i) {
        v.command_wheel_angle[i] = static_cast<double>(out.command.angle_rad[i]);
        v.command_wheel_speed[i] = static_cast<double>(out.command.speed_radps[i]);
    }
    v.command_enable = out.enable;

    v.estimate_force_x = static_cast<double>(out.estimate.force_x_n);
    v.estimate_force_y = static_cast<double>(out.estimate.force_y_n);
    v.estimate_torque_z = static_cast<double>(out.estimate.torque_nm);
    v.estimate_force = static_cast<double>(out.contact.force_n);
    v.estimate_direction = static_cast<double>(out.contact.direction_rad);
    v.estimate_point_x = static_cast<double>(out.contact.point_m.x);
    v.estimate_point_y = static_cast<double>(out.contact.point_m.y);
    v.estimate_on_outline = out.contact.on_outline;
    v.estimate_lever_arm = static_cast<double>(out.contact.lever_arm_m);
    v.estimate_lever_arm_sigma = static_cast<double>(out.contact.lever_arm_sigma_m);
    v.estimate_valid = out.contact.valid;

    v.detection_active = out.detection_active;
    v.detection_count = static_cast<std::int32_t>(out.detection_count);
    v.detection_tick = out.detection_tick;
    v.detection_statistic = static_cast<double>(out.detection_statistic);
    v.detection_force_x = static_cast<double>(out.detection_wrench.force_x_n);
    v.detection_force_y = static_cast<double>(out.detection_wrench.force_y_n);
    v.detection_torque_z = static_cast<double>(out.detection_wrench.torque_nm);
    v.detection_direction = static_cast<double>(out.detection_contact.direction_rad);
    v.detection_point_x = static_cast<double>(out.detection_contact.point_m.x);
    v.detection_point_y = static_cast<double>(out.detection_contact.point_m.y);
    v.detection_point_sigma = static_cast<double>(out.detection_contact.lever_arm_sigma_m);
    v.detection_on_outline = out.detection_contact.on_outline;

    v.reference_x = static_cast<double>(out.reference_pose.x_m);
    v.reference_y = static_cast<double>(out.reference_pose.y_m);
    v.reference_theta = static_cast<double>(out.reference_pose.theta_rad);
    v.reference_vx = static_cast<double>(out.reference_twist.vx_mps);
    v.reference_vy = static_cast<double>(out.reference_twist.vy_mps);
    v.reference_omega = static_cast<double>(out.reference_twist.omega_radps);
    v.path_ticks = static_cast<std::int32_t>(out.path_ticks);
    v.mode = static_cast<std::int32_t>(out.mode);
    v.status = static_cast<std::int32_t>(status);
    v.tick = static_cast<std::int32_t>(out.tick);
}

} // namespace giveway::controller
