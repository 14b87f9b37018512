// The start of a run: plant and drives from the variables, or a message about inconsistent ones.
#pragma once

#include <cstdio>

#include "from_variables.hpp"
#include "plant_system.hpp"

namespace giveway::testbed {

inline PerWheel<double> motor_angles(const double *state) {
    PerWheel<double> angles;
    std::copy_n(state + plant::Layout<>::motor_angle, angles.size(), angles.begin());
    return angles;
}

inline plant::Inputs<double> plant_inputs(const Variables &v, const PerWheel<double> &motor_torque_nm) {
    return {motor_torque_nm, v.push_force_x, v.push_force_y, v.push_point_x, v.push_point_y};
}

inline Command bus_command(const Variables &v) {
    return {std::to_array(v.command_wheel_angle), std::to_array(v.command_wheel_speed), v.command_enable};
}

inline void write_sensors(Variables &v, const SensorSample &sample) {
    std::copy_n(sample.torque_nm.begin(), wheel_count, v.sensor_torque);
    std::copy_n(sample.encoder_counts.begin(), wheel_count, v.sensor_encoder);
    v.sensor_counter = sample.counter;
    v.sensor_present = true;
}

inline ImuTruth imu_truth(const plant::Outputs<double> &truth) {
    double speed = 0.0;
    for (const double wheel : truth.wheel_speed) {
        speed += math::abs(wheel);
    }
    return {{truth.specific_force_x, truth.specific_force_y}, truth.yaw_rate, speed / wheel_count};
}

inline void write_imu(Variables &v, const ImuSample &sample) {
    std::copy_n(sample.acceleration_mps2.begin(), imu_axes, v.sensor_acceleration);
    v.sensor_yaw_rate = sample.yaw_rate_radps;
    v.sensor_imu_counter = sample.counter;
    v.sensor_imu_present = true;
}

// Motor torques of the steady motion that a run starts with: the wheels' and their gears' friction; none where the gear
// holds its wheel.
inline PerWheel<double> steady_motor_torque(const PlantSystem &system, const double *state,
                                            const PerWheel<double> &wheel_torque_nm) {
    PerWheel<double> torque_nm{};
    for (int i = 0; i < wheel_count; ++i) {
        const auto wheel = static_cast<std::size_t>(i);
        const double direction = system.modes().gear_direction[wheel];
        const double speed = state[plant::Layout<>::motor_speed + i];
        torque_nm[wheel] = math::abs(direction) *
                           (wheel_torque_nm[wheel] + plant::gear_friction(system.parameters(), i, direction, speed));
    }
    return torque_nm;
}

// False, with a message, if the parameters are inconsistent.
inline bool start_run(const Variables &v, PlantSystem &system, plant::TippingVector<double> &state, Drives &drives,
                      Imu &imu, double &stored_j, Message &message) {
    if (!check_relations(v, message)) {
        return false;
    }
    const plant::InitialMotion<double> motion{
        v.start_x,  v.start_y,     v.start_theta,  v.start_vx,
        v.start_vy, v.start_omega, v.slider_speed, std::to_array(v.start_bristle)};
    state = {};
    system.start(plant_parameters(v), motion, plant_inputs(v, {}), state);
    const auto truth = system.outputs(state.data());
    // A start inside the robot would catapult the slider.
    constexpr double touching_m = 1e-6;
    if (v.slider_present && truth.contact_depth > touching_m) {
        std::snprintf(message.text, sizeof message.text,
                      "slider.run_up = %.9g is not allowed: with this target, direction and start the nose starts %.9g "
                      "m inside the robot",
                      v.slider_run_up, truth.contact_depth);
        return false;
    }
    stored_j = truth.stored_energy;
    const auto refused =
        drives.start(drive_options(v), motor_angles(state.data()), truth.wheel_speed, truth.wheel_torque,
                     steady_motor_torque(system, state.data(), truth.wheel_torque), v.command_enable);
    if (refused.field != GW_FIELD_NONE) {
        std::snprintf(message.text, sizeof message.text, "%s = %.9g is not allowed: [%.9g, %.9g]",
                      gw_config_name(refused.field), static_cast<double>(refused.value),
                      static_cast<double>(refused.minimum), static_cast<double>(refused.maximum));
        return false;
    }
    imu.start(imu_options(v), imu_truth(truth));
    return true;
}

} // namespace giveway::testbed
