// State, inputs and modes of the plant; the table in README.md of this folder is the legend.
#pragma once

#include <array>

#include "derived.hpp"

namespace giveway::plant {

// Indices of states and events in their vectors.
template <int Wheels = table_wheels> struct Layout {
    enum State : int {
        base_x,
        base_y,
        base_theta,
        base_vx,
        base_vy,
        base_omega,
        motor_angle,                        // of each wheel
        motor_speed = motor_angle + Wheels, // of each wheel
        wheel_angle = motor_speed + Wheels, // of each wheel
        bristle = wheel_angle + Wheels,     // of each wheel
        slider_position = bristle + Wheels,
        slider_speed,
        weight_drop,
        weight_speed,
        compression,
        compression_rate,
        work_in,
        dissipated,
        impulse_x,
        impulse_y,
        state_count,
        // Only with tipping.
        base_heave = state_count,
        base_roll,
        base_pitch,
        heave_rate,
        body_roll_rate, // about the body's own axes
        body_pitch_rate,
        wheel_spin,                 // of each wheel
        grip = wheel_spin + Wheels, // of each wheel
        tipping_state_count = grip + Wheels,
    };
    enum Event : int {
        event_gear, // of each wheel
        event_contact = event_gear + Wheels,
        event_rope,
        event_end_stop,
        event_bottom_stop,
        event_landing,
        event_wall,
        event_roller, // of each wheel
        event_count = event_roller + Wheels,
        // Only with tipping.
        event_floor = event_count, // of each wheel
        event_tilt = event_floor + Wheels,
        tipping_event_count,
    };
};

template <class T, int Wheels = table_wheels> using StateVector = std::array<T, Layout<Wheels>::state_count>;
template <class T, int Wheels = table_wheels> using TippingVector = std::array<T, Layout<Wheels>::tipping_state_count>;

template <class T, int Wheels = table_wheels> struct Inputs {
    std::array<T, Wheels> motor_torque;
    T push_force_x, push_force_y; // world frame, N
    T push_point_x, push_point_y; // base frame, m
};

// Constant between events. Numbers, not booleans: lanes differ.
template <class T, int Wheels = table_wheels> struct Modes {
    std::array<T, Wheels> gear_direction;                                 // -1, 0 (stuck), +1
    T contact, rope_taut, end_stop, bottom_stop, latched, landed, walled; // 0 or 1
    // Only with tipping.
    std::array<T, Wheels> on_floor = {};
    T overturned = T(0.0); // tilted beyond the model's range
    // Only with rollers one by one: which roller of each wheel is at the bottom, counted from the start on; where its
    // row is along the axle (m); its friction over that of (28).
    std::array<T, Wheels> roller = {}, roller_offset = {}, roller_friction = {};
};

template <class T, int Wheels = table_wheels> using EventVector = std::array<T, Layout<Wheels>::event_count>;
template <class T, int Wheels = table_wheels> using TippingEvents = std::array<T, Layout<Wheels>::tipping_event_count>;

} // namespace giveway::plant
