// The truth for an observer with perfect sensors, with which estimates are compared.
#pragma once

#include "tipping.hpp"

namespace giveway::plant {

template <class T, int Wheels = table_wheels> struct Outputs {
    std::array<T, Wheels> wheel_speed, wheel_torque, roller_force;
    T contact_depth;                    // negative: clear of the robot
    T contact_force;                    // magnitude, N
    T contact_force_x, contact_force_y; // on the robot, world frame
    T contact_point_x, contact_point_y; // world frame
    T contact_base_x, contact_base_y;   // base frame
    T nose_x, nose_y;                   // tip of the nose, world frame
    T bumper_force, rope_tension, wall_force;
    T stored_energy;
    T roll, pitch;
    std::array<T, Wheels> wheel_load;
    T tip_margin;
    T specific_force_x, specific_force_y; // where the accelerometer sits, along its axes: acceleration less gravity
    T yaw_rate;                           // about the body's own vertical axis
};

// Work of gravity along the floor on a unit mass since the world's origin; `point` in base axes.
template <class T, int Wheels, std::size_t N>
T descent(const std::array<T, N> &x, const Evaluation<T, Wheels, N> &e, const Derived<T> &d, Vector2<T> point) {
    using At = Layout<Wheels>;
    return dot(Vector2<T>{d.downhill_x, d.downhill_y},
               Vector2<T>{x[At::base_x], x[At::base_y]} + to_world(e.heading, point));
}

// Of slider, weight, bumper and contact; a plate on the robot included.
template <class T, int Wheels, std::size_t N>
T slider_energy(T energy, const std::array<T, N> &x, const Evaluation<T, Wheels, N> &e, const Parameters<T, Wheels> &p,
                const Derived<T> &d) {
    using At = Layout<Wheels>;
    const T half = T(0.5);
    if (p.plate_on_robot()) {
        const Vector2<T> outward{d.plate_x, d.plate_y};
        const Vector2<T> plate = Vector2<T>{p.bumper_mount_x, p.bumper_mount_y} - x[At::compression] * outward;
        const Vector2<T> speed = e.velocity + x[At::base_omega] * turned(plate) - x[At::compression_rate] * outward;
        energy =
            energy + half * p.bumper_plate_mass * dot(speed, speed) - p.bumper_plate_mass * descent(x, e, d, plate);
    }
    if (p.slider_present != 0) {
        energy = energy + half * d.carriage_mass * math::square(x[At::slider_speed]);
        if (p.has_plate() && !p.plate_on_robot()) {
            energy = energy + half * p.bumper_plate_mass * math::square(x[At::slider_speed] - x[At::compression_rate]);
        }
        if (p.bumper_kind == BumperKind::lever) {
            energy = energy + half * bumper_inertance(p) * math::square(x[At::compression_rate]);
        }
        if (p.rope_attached != 0) {
            energy = energy + half * p.rope_hanging_mass * math::square(x[At::weight_speed]);
        }
        energy = energy + e.bumper.stored + e.rope.stored + e.contact_force.stored;
        if (p.wall_present != 0) {
            energy = energy + e.wall.stored;
        }
    }
    return energy;
}

template <class T, int Wheels>
T stored_energy(const StateVector<T, Wheels> &x, const Evaluation<T, Wheels> &e, const Parameters<T, Wheels> &p,
                const Derived<T> &d) {
    using At = Layout<Wheels>;
    const T half = T(0.5);
    const Vector2<T> com = mass_centre(p);
    const Vector2<T> speed = e.velocity + x[At::base_omega] * turned(com);
    T energy = half * p.base_mass * dot(speed, speed) + half * p.base_yaw_inertia * math::square(x[At::base_omega]) -
               p.base_mass * descent(x, e, d, com);
    for (int i = 0; i < Wheels; ++i) {
        const T roller_speed =
            (T(Azimuths<Wheels>::cos[i]) * e.velocity.x + T(Azimuths<Wheels>::sin[i]) * e.velocity.y) / p.roller_radius;
        energy =
            energy +
            half * p.wheel_traction[i] *
                (p.wheel_inertia * math::square(e.wheel_speed[i]) + p.roller_inertia * math::square(roller_speed)) +
            half * p.drivetrain_motor_inertia * math::square(x[At::motor_speed + i]) +
            half * p.drivetrain_stiffness * math::square(x[At::motor_angle + i] - x[At::wheel_angle + i]);
        if (p.roller_model == RollerModel::bristle) {
            energy = energy + half * p.roller_presliding_stiffness[i] * math::square(x[At::bristle + i]);
        }
    }
    if (discrete(p)) {
        energy = energy + e.lifted;
    }
    return slider_energy(energy, x, e, p, d);
}

template <class T, int Wheels>
T stored_energy(const TippingVector<T, Wheels> &x, const TippingEvaluation<T, Wheels> &e,
                const Parameters<T, Wheels> &p, const Derived<T> &d) {
    using At = Layout<Wheels>;
    const T half = T(0.5);
    const Stance<T> &s = e.stance;
    const Vector3<T> com = s.at(p.base_com_x, p.base_com_y, p.base_com_height);
    const Vector3<T> velocity = s.velocity_of(com);
    const T tilting = p.base_tilt_inertia - T(0.5 * Wheels) * p.wheel_inertia;
    T energy = half * p.base_mass * dot(velocity, velocity) +
               p.base_mass * d.floor_gravity * (x[At::base_heave] + com.z) -
               p.base_mass * descent(x, e, d, com.plan()) + e.floor_stored +
               half * tilting * (math::square(x[At::body_roll_rate]) + math::square(x[At::body_pitch_rate])) +
               half * p.base_yaw_inertia * math::square(s.yaw_rate);
    for (int i = 0; i < Wheels; ++i) {
        energy = energy + half * p.wheel_inertia * math::square(x[At::wheel_spin + i]) +
                 half * p.drivetrain_motor_inertia * math::square(x[At::motor_speed + i]) +
                 half * p.drivetrain_stiffness * math::square(x[At::motor_angle + i] - x[At::wheel_angle + i]);
    }
    return slider_energy(energy, x, e, p, d);
}

// Acceleration less gravity where the accelerometer sits, along the base's axes, or the body's own where that leans.
template <class T, int Wheels>
Vector2<T> specific_force(const StateVector<T, Wheels> &x, const Evaluation<T, Wheels> &e,
                          const Parameters<T, Wheels> &p, const Derived<T> &d) {
    using At = Layout<Wheels>;
    const Vector2<T> place{p.imu_x, p.imu_y};
    const T omega = x[At::base_omega];
    return to_base(e.heading, Vector2<T>{e.rate[At::base_vx] - d.downhill_x, e.rate[At::base_vy] - d.downhill_y}) +
           e.rate[At::base_omega] * turned(place) - (omega * omega) * place;
}
template <class T, int Wheels>
Vector2<T> specific_force(const TippingVector<T, Wheels> &, const TippingEvaluation<T, Wheels> &e,
                          const Parameters<T, Wheels> &p, const Derived<T> &d) {
    using At = Layout<Wheels>;
    const Stance<T> &s = e.stance;
    const Vector3<T> place = s.at(p.imu_x, p.imu_y, p.imu_height);
    const Vector2<T> along =
        to_base(e.heading, Vector2<T>{e.rate[At::base_vx] - d.downhill_x, e.rate[At::base_vy] - d.downhill_y});
    const Vector3<T> force = Vector3<T>{along.x, along.y, e.rate[At::heave_rate] + d.floor_gravity} +
                             cross(e.turning_rate, place) + cross(s.turning, cross(s.turning, place));
    return {dot(s.forward, force), dot(s.left, force)};
}

// `e`: everything evaluated at x.
template <class E, class T, int Wheels, std::size_t N>
Outputs<T, Wheels> outputs(const E &e, const std::array<T, N> &x, const Parameters<T, Wheels> &p, const Derived<T> &d) {
    using At = Layout<Wheels>;
    Outputs<T, Wheels> o{};
    o.wheel_speed = e.wheel_speed;
    o.wheel_torque = e.sensed_torque;
    o.roller_force = e.roller_force;
    const Vector2<T> force = to_world(e.heading, e.contact_force.on_robot);
    o.contact_depth = e.contact.depth;
    o.contact_force = math::sqrt(dot(force, force));
    o.contact_force_x = force.x;
    o.contact_force_y = force.y;
    o.contact_base_x = e.contact.point.x;
    o.contact_base_y = e.contact.point.y;
    Vector2<T> reach = e.contact.point;
    if constexpr (N == At::tipping_state_count) {
        reach = reach + e.contact_offset;
        o.roll = x[At::base_roll];
        o.pitch = x[At::base_pitch];
        o.wheel_load = e.load;
        o.yaw_rate = e.stance.yaw_rate;
        o.tip_margin = tip_margin(e.stance, p, d, to_base(e.heading, Vector2<T>{d.downhill_x, d.downhill_y}));
    } else {
        for (int i = 0; i < Wheels; ++i) {
            o.wheel_load[i] = p.base_mass * d.floor_gravity / T(Wheels) * static_load_share(p, i, mass_centre(p));
        }
        o.tip_margin = T(1.0);
        o.yaw_rate = x[At::base_omega];
    }
    const Vector2<T> point = to_world(e.heading, reach);
    o.contact_point_x = x[At::base_x] + point.x;
    o.contact_point_y = x[At::base_y] + point.y;
    const T travel = x[At::slider_position] - ((p.has_plate() && !p.plate_on_robot()) ? x[At::compression] : T(0.0)) +
                     p.contact_nose_radius;
    o.nose_x = d.origin_x + travel * d.rail_x;
    o.nose_y = d.origin_y + travel * d.rail_y;
    o.bumper_force = e.internal_force;
    o.rope_tension = e.rope.tension;
    o.wall_force = e.wall.force;
    o.stored_energy = stored_energy(x, e, p, d);
    const Vector2<T> felt = specific_force(x, e, p, d);
    o.specific_force_x = d.imu_cos * felt.x + d.imu_sin * felt.y;
    o.specific_force_y = d.imu_cos * felt.y - d.imu_sin * felt.x;
    return o;
}

template <class T, int Wheels, std::size_t N>
Outputs<T, Wheels> outputs(const std::array<T, N> &x, const Inputs<T, Wheels> &u, const Modes<T, Wheels> &m,
                           const Parameters<T, Wheels> &p, const Derived<T> &d) {
    return outputs(evaluate(x, u, m, p, d), x, p, d);
}

} // namespace giveway::plant
