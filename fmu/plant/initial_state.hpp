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

namespace detail {

// The wheel torques that balance a wrench on rollers one by one, and what the rollers ask for in steady motion.
template <class T, int Wheels>
std::array<T, Wheels> torques_on_rollers(const Parameters<T, Wheels> &p, const Derived<T> &d, const Modes<T, Wheels> &m,
                                         Planar3<T> wrench, Planar3<T> twist) {
    std::array<Rolling<T>, Wheels> rollers;
    Inertia3<T> rows{T(0.0), T(0.0), T(0.0), T(0.0), T(0.0), T(0.0)};
    for (int i = 0; i < Wheels; ++i) {
        rollers[i] = rolling(p, d, m, i, T(0.0));
        rows.add(T(1.0), rollers[i].row);
    }
    const Planar3<T> share = rows.solve(wrench);
    std::array<T, Wheels> torque;
    for (int i = 0; i < Wheels; ++i) {
        const Rolling<T> &r = rollers[i];
        torque[i] = dot(r.row, share) + r.slope * (carried(p, d, i) - p.wheel_traction[i] * p.wheel_inertia *
                                                                          math::square(dot(r.row, twist)) / r.radius);
    }
    return torque;
}

// What the floor's fall and the turning of a centre of mass beside the wheels' pull with.
template <class T, int Wheels>
Planar3<T> drawn_at_start(const InitialMotion<T, Wheels> &start, const Parameters<T, Wheels> &p, const Derived<T> &d,
                          const math::SinCos<T> &heading, T compression) {
    const Vector2<T> downhill = to_base(heading, Vector2<T>{d.downhill_x, d.downhill_y});
    const auto weight = [&](T mass, Vector2<T> at) {
        return mass * Planar3<T>{downhill.x, downhill.y, cross(at, downhill)};
    };
    const Vector2<T> com = mass_centre(p);
    const Vector2<T> swung = (p.base_mass * start.omega * start.omega) * com;
    const Planar3<T> base = weight(p.base_mass, com) + Planar3<T>{swung.x, swung.y, T(0.0)};
    if (!p.plate_on_robot()) {
        return base;
    }
    const Vector2<T> outward{d.plate_x, d.plate_y};
    return base + weight(p.bumper_plate_mass, Vector2<T>{p.bumper_mount_x, p.bumper_mount_y} - compression * outward);
}

// `share`: each wheel's of the rollers' friction.
template <class T, int Wheels>
void planar_start(const InitialMotion<T, Wheels> &start, const Inputs<T, Wheels> &u, const Parameters<T, Wheels> &p,
                  const Derived<T> &d, const decltype(Parameters<T, Wheels>::wheel_traction) &share,
                  StateVector<T, Wheels> &x, Modes<T, Wheels> &m) {
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
    const bool latched = bumper_holds(p);
    if (p.slider_present != 0 && p.has_plate() && !latched) {
        x[At::compression] = resting_compression(p);
    }
    m.latched = latched ? T(1.0) : T(0.0);
    if (discrete(p)) {
        for (int i = 0; i < Wheels; ++i) {
            stand_on(p, m, i, math::round(p.roller_phase[i] / d.roller_pitch));
        }
    }

    const auto heading = math::sincos(start.theta);
    const Vector2<T> velocity = to_base(heading, Vector2<T>{start.vx, start.vy});
    const Planar3<T> twist{velocity.x, velocity.y, start.omega};
    Planar3<T> held{T(0.0), T(0.0), T(0.0)}; // by the drives
    for (int i = 0; i < Wheels; ++i) {
        const Vector2<T> radial{T(Azimuths<Wheels>::cos[i]), T(Azimuths<Wheels>::sin[i])};
        const T speed = dot(radial, velocity);
        const T steady = steady_friction_now(p, d, m, i, speed, T(0.0));
        x[At::bristle + i] = steady_deflection(p, i, speed, steady) + start.bristle_offset[i];
        const T force =
            share[i] * roller_force(p, d.roller_plastic_fraction, i, speed, x[At::bristle + i], steady).force;
        held = held + Planar3<T>{force * radial.x, force * radial.y, T(0.0)};
    }
    held = held + T(-1.0) * drawn_at_start(start, p, d, heading, x[At::compression]);
    const auto torque = discrete(p) ? torques_on_rollers(p, d, m, held, twist) : balancing_torques(p, held);
    for (int i = 0; i < Wheels; ++i) {
        const T speed = dot(wheel_row(p, d, m, i, T(0.0)), twist);
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
    m.end_stop = latched ? T(0.0) : T(1.0) - positive(g[At::event_end_stop]);
}

} // namespace detail

template <class T, int Wheels>
void initial_state(const InitialMotion<T, Wheels> &start, const Inputs<T, Wheels> &u, const Parameters<T, Wheels> &p,
                   const Derived<T> &d, StateVector<T, Wheels> &x, Modes<T, Wheels> &m) {
    detail::planar_start(start, u, p, d, p.wheel_traction, x, m);
}

template <class T, int Wheels>
void initial_state(const InitialMotion<T, Wheels> &start, const Inputs<T, Wheels> &u, const Parameters<T, Wheels> &p,
                   const Derived<T> &d, TippingVector<T, Wheels> &x, Modes<T, Wheels> &m) {
    using At = Layout<Wheels>;
    // Weight acts where its line through the centre of mass meets the floor. The base leans by `tilt` times that,
    // which moves the centre of mass further.
    const Vector2<T> downhill = to_base(math::sincos(start.theta), Vector2<T>{d.downhill_x, d.downhill_y});
    const T weight = p.base_mass * d.floor_gravity;
    const T tilt = T(2.0) * weight / (T(Wheels) * p.wheel_floor_stiffness * math::square(p.wheel_distance));
    const Vector2<T> upright = mass_centre(p) + (p.base_com_height / d.floor_gravity) * downhill;
    const Vector2<T> centre = (T(1.0) / (T(1.0) - p.base_com_height * tilt)) * upright;
    decltype(Parameters<T, Wheels>::wheel_traction) share;
    for (int i = 0; i < Wheels; ++i) {
        share[i] = static_load_share(p, i, centre) * d.floor_gravity / T(gravity_mps2);
    }
    StateVector<T, Wheels> planar;
    detail::planar_start(start, u, p, d, share, planar, m);
    x = {};
    for (int i = 0; i < At::state_count; ++i) {
        x[i] = planar[i];
    }
    // On wheels that carry its weight; the grip of each balances its drive.
    x[At::base_heave] =
        T(-gravity_mps2 / Wheels) * p.base_mass / p.wheel_floor_stiffness * (d.floor_gravity / T(gravity_mps2));
    x[At::base_roll] = T(0.0) - tilt * centre.y;
    x[At::base_pitch] = tilt * centre.x;
    m.on_floor.fill(T(1.0));
    for (int i = 0; i < Wheels; ++i) {
        if (discrete(p)) {
            // As far as the wheel has sunk onto the end of its roller: lower there.
            const T sunk = p.wheel_radius - rolling(p, d, m, i, T(0.0)).radius;
            x[At::base_heave] = x[At::base_heave] - T(1.0 / Wheels) * sunk;
            const T lean = T(2.0 / Wheels) * sunk / p.wheel_distance;
            x[At::base_pitch] = x[At::base_pitch] + T(Azimuths<Wheels>::cos[i]) * lean;
            x[At::base_roll] = x[At::base_roll] - T(Azimuths<Wheels>::sin[i]) * lean;
        }
        x[At::wheel_spin + i] = x[At::motor_speed + i];
        x[At::grip + i] = T(-1.0) * p.drivetrain_stiffness * x[At::motor_angle + i] /
                          (p.wheel_radius * p.wheel_grip_stiffness) / share[i];
    }
}

} // namespace giveway::plant
