// State, inputs and modes of the plant; the table in README.md of this folder is the legend.
#pragma once

#include <array>

#include "derived.hpp"

namespace giveway::plant {

enum StateIndex : int {
    base_x = 0,
    base_y = 1,
    base_theta = 2,
    base_vx = 3,
    base_vy = 4,
    base_omega = 5,
    motor_angle = 6,  // 3
    motor_speed = 9,  // 3
    wheel_angle = 12, // 3
    bristle = 15,     // 3
    slider_position = 18,
    slider_speed = 19,
    weight_drop = 20,
    weight_speed = 21,
    compression = 22,
    compression_rate = 23,
    work_in = 24,
    dissipated = 25,
    impulse_x = 26,
    impulse_y = 27,
    state_count = 28,
    // Only with tipping.
    base_heave = 28,
    base_roll = 29,
    base_pitch = 30,
    heave_rate = 31,
    body_roll_rate = 32, // about the body's own axes
    body_pitch_rate = 33,
    wheel_spin = 34, // 3
    grip = 37,       // 3
    tipping_state_count = 40,
};

template <class T> using StateVector = std::array<T, state_count>;
template <class T> using TippingVector = std::array<T, tipping_state_count>;

template <class T> struct Inputs {
    std::array<T, wheel_count> motor_torque;
    T push_force_x, push_force_y; // world frame, N
    T push_point_x, push_point_y; // base frame, m
};

// Constant between events. Numbers, not booleans: lanes differ.
template <class T> struct Modes {
    std::array<T, wheel_count> gear_direction;                            // -1, 0 (stuck), +1
    T contact, rope_taut, end_stop, bottom_stop, latched, landed, walled; // 0 or 1
    // Only with tipping.
    std::array<T, wheel_count> on_floor = {};
    T overturned = T(0.0); // tilted further than the model goes
};

enum EventIndex : int {
    event_gear = 0, // 3
    event_contact = 3,
    event_rope = 4,
    event_end_stop = 5,
    event_bottom_stop = 6,
    event_landing = 7,
    event_wall = 8,
    event_count = 9,
    // Only with tipping.
    event_floor = 9, // 3
    event_tilt = 12,
    tipping_event_count = 13,
};

template <class T> using EventVector = std::array<T, event_count>;
template <class T> using TippingEvents = std::array<T, tipping_event_count>;

} // namespace giveway::plant
