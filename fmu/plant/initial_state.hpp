// A consistent start: at rest, or in steady motion with rollers wound up; drivetrains carry what the rollers pull.
#pragma once

#include "tipping.hpp"

namespace giveway::plant {

template <class T> struct InitialMotion {
    T x, y, theta; // world frame
    T vx, vy, omega;
    T slider_speed;
    std::array<T, wheel_count>
        bristle_offset; // beyond that of the motion, m: what earlier motion left in stuck rollers
};

template <class T>
void initial_state(const InitialMotion<T> &start, const Inputs<T> &u, const Parameters<T> &p, const Derived<T> &d,
                   StateVector<T> &x, Modes<T> &m) {
    x = {};
    m = {};
    x[base_x] = start.x;
    x[base_y] = start.y;
    x[base_theta] = start.theta;
    x[base_vx] = start.vx;
    x[base_vy] = start.vy;
    x[base_omega] = start.omega;
    x[slider_speed] = p.slider_present != 0 ? start.slider_speed : T(0.0);
    x[weight_speed] = p.rope_attached != 0 ? x[slider_speed] : T(0.0);
    const bool held = bumper_holds(p);
    if (p.slider_present != 0 && p.has_plate() && !held) {
        x[compression] = resting_compression(p);
    }
    m.latched = held ? T(1.0) : T(0.0);

    const auto heading = math::sincos(start.theta);
    const Vector2<T> velocity = to_base(heading, Vector2<T>{start.vx, start.vy});
    const Planar3<T> twist{velocity.x, velocity.y, start.omega};
    Planar3<T> friction{T(0.0), T(0.0), T(0.0)};
    for (int i = 0; i < wheel_count; ++i) {
        const Vector2<T> radial{T(wheel_cos[i]), T(wheel_sin[i])};
        const T speed = dot(radial, velocity);
        x[bristle + i] = steady_deflection(p, i, speed) + start.bristle_offset[i];
        const T force = p.wheel_traction[i] * roller_force(p, i, speed, x[bristle + i]).force;
        friction = friction + Planar3<T>{force * radial.x, force * radial.y, T(0.0)};
    }
    const auto torque = balancing_torques(p, friction);
    for (int i = 0; i < wheel_count; ++i) {
        const T speed = dot(wheel_row(p, i), twist);
        x[motor_speed + i] = speed;
        x[motor_angle + i] = torque[i] / p.drivetrain_stiffness;
        m.gear_direction[i] = math::sign(speed);
    }
    accept_inputs(x, u, m, p, d);

    const EventVector<T> g = event_indicators(x, u, m, p, d);
    const auto positive = [](T value) { return math::select(math::less(T(0.0), value), T(1.0), T(0.0)); };
    m.contact = positive(g[event_contact]);
    m.rope_taut = positive(g[event_rope]);
    m.bottom_stop = positive(g[event_bottom_stop]);
    m.landed = positive(g[event_landing]);
    m.walled = positive(g[event_wall]);
    m.end_stop = held ? T(0.0) : T(1.0) - positive(g[event_end_stop]);
}

template <class T>
void initial_state(const InitialMotion<T> &start, const Inputs<T> &u, const Parameters<T> &p, const Derived<T> &d,
                   TippingVector<T> &x, Modes<T> &m) {
    StateVector<T> planar;
    initial_state(start, u, p, d, planar, m);
    x = {};
    for (int i = 0; i < state_count; ++i) {
        x[i] = planar[i];
    }
    // Level, on wheels that bear its weight in equal parts; each grips with what its drive gives.
    x[base_heave] = T(-gravity_mps2 / wheel_count) * p.base_mass / p.wheel_floor_stiffness;
    m.on_floor = {T(1.0), T(1.0), T(1.0)};
    for (int i = 0; i < wheel_count; ++i) {
        x[wheel_spin + i] = x[motor_speed + i];
        x[grip + i] = T(-1.0) * p.drivetrain_stiffness * x[motor_angle + i] / (p.wheel_radius * p.wheel_grip_stiffness);
    }
}

} // namespace giveway::plant
