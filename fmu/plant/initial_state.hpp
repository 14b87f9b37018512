// A consistent start: at rest, or in steady motion with deflected rollers; the drivetrains balance the rollers'
// friction.
#pragma once

#include "tipping.hpp"

namespace giveway::plant {

template <class T, int Wheels = table_wheels> struct InitialMotion {
    T x, y, theta; // world frame
    T vx, vy, omega;
    T slider_speed;
    std::array<T, Wheels> bristle_offset; // in addition to that of the motion, m: deflection that earlier motion left
                                          // in stuck rollers
};

template <class T, int Wheels>
void initial_state(const InitialMotion<T, Wheels> &start, const Inputs<T, Wheels> &u, const Parameters<T, Wheels> &p,
                   const Derived<T> &d, StateVector<T, Wheels> &x, Modes<T, Wheels> &m) {
    using At = Layout<Wheels>;
    x = {};
    m = {};
    x[At::base_x] = start.x;
    x[At::base_y] = start.y;
    x[At::base_theta] = start.theta;
    x[At::base_vx] = start.vx;
    x[At::base_vy] = start.vy;
    x[At::base_omega] = start.omega;
    x[At::slider_speed] = p.slider_present != 0 ? start.slider_speed : T(0.0);
    x[At::weight_speed] = p.rope_attached != 0 ? x[At::slider_speed] : T(0.0);
    const bool held = bumper_holds(p);
    if (p.slider_present != 0 && p.has_plate() && !held) {
        x[At::compression] = resting_compression(p);
    }
    m.latched = held ? T(1.0) : T(0.0);

    const auto heading = math::sincos(start.theta);
    const Vector2<T> velocity = to_base(heading, Vector2<T>{start.vx, start.vy});
    const Planar3<T> twist{velocity.x, velocity.y, start.omega};
    Planar3<T> friction{T(0.0), T(0.0), T(0.0)};
    for (int i = 0; i < Wheels; ++i) {
        const Vector2<T> radial{T(Azimuths<Wheels>::cos[i]), T(Azimuths<Wheels>::sin[i])};
        const T speed = dot(radial, velocity);
        x[At::bristle + i] = steady_deflection(p, i, speed) + start.bristle_offset[i];
        const T force = p.wheel_traction[i] * roller_force(p, i, speed, x[At::bristle + i]).force;
        friction = friction + Planar3<T>{force * radial.x, force * radial.y, T(0.0)};
    }
    const auto torque = balancing_torques(p, friction);
    for (int i = 0; i < Wheels; ++i) {
        const T speed = dot(wheel_row(p, i), twist);
        x[At::motor_speed + i] = speed;
        x[At::motor_angle + i] = torque[i] / p.drivetrain_stiffness;
        m.gear_direction[i] = math::sign(speed);
    }
    accept_inputs(x, u, m, p, d);

    const EventVector<T, Wheels> g = event_indicators(x, u, m, p, d);
    const auto positive = [](T value) { return math::select(math::less(T(0.0), value), T(1.0), T(0.0)); };
    m.contact = positive(g[At::event_contact]);
    m.rope_taut = positive(g[At::event_rope]);
    m.bottom_stop = positive(g[At::event_bottom_stop]);
    m.landed = positive(g[At::event_landing]);
    m.walled = positive(g[At::event_wall]);
    m.end_stop = held ? T(0.0) : T(1.0) - positive(g[At::event_end_stop]);
}

template <class T, int Wheels>
void initial_state(const InitialMotion<T, Wheels> &start, const Inputs<T, Wheels> &u, const Parameters<T, Wheels> &p,
                   const Derived<T> &d, TippingVector<T, Wheels> &x, Modes<T, Wheels> &m) {
    using At = Layout<Wheels>;
    StateVector<T, Wheels> planar;
    initial_state(start, u, p, d, planar, m);
    x = {};
    for (int i = 0; i < At::state_count; ++i) {
        x[i] = planar[i];
    }
    // Level, on wheels that carry its weight in equal parts; the grip of each balances its drive.
    x[At::base_heave] = T(-gravity_mps2 / Wheels) * p.base_mass / p.wheel_floor_stiffness;
    m.on_floor.fill(T(1.0));
    for (int i = 0; i < Wheels; ++i) {
        x[At::wheel_spin + i] = x[At::motor_speed + i];
        x[At::grip + i] =
            T(-1.0) * p.drivetrain_stiffness * x[At::motor_angle + i] / (p.wheel_radius * p.wheel_grip_stiffness);
    }
}

} // namespace giveway::plant
