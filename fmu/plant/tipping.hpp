// The plant whose base can tip: a rigid body on wheels that press on the floor, grip it and leave it.
// Everything except the base and its wheels comes from the planar plant. README.md of this folder has the equations.
#pragma once

#include "plant.hpp"
#include "vector3.hpp"

namespace giveway::plant {

// Beyond this tilt the model ends: 15 deg, slightly less than the tilt at which Trikey's centre of mass is above the
// line between two wheels.
inline constexpr double cos_greatest_tilt = 0.9659258262890683;

// Attitude and motion of the tilted base. Axes: those of the base turned by its heading alone, "base axes".
template <class T> struct Stance {
    Vector3<T> forward, left, up; // the body's own axes
    Vector3<T> velocity;          // of the body's point that is the base's centre at floor level
    Vector3<T> turning;           // angular velocity
    T yaw_rate;                   // about the body's own vertical axis
    T roll_rate, pitch_rate;      // of the angles

    [[nodiscard]] Vector3<T> at(T x, T y, T z) const { return x * forward + y * left + z * up; }
    [[nodiscard]] Vector3<T> velocity_of(Vector3<T> point) const { return velocity + cross(turning, point); }
};

template <int Wheels, class T> Stance<T> stance(const TippingVector<T, Wheels> &x, Vector2<T> velocity) {
    using At = Layout<Wheels>;
    const auto roll = math::sincos(x[At::base_roll]);
    const auto pitch = math::sincos(x[At::base_pitch]);
    Stance<T> s;
    s.forward = {pitch.cos, T(0.0), T(-1.0) * pitch.sin};
    s.left = {pitch.sin * roll.sin, roll.cos, pitch.cos * roll.sin};
    s.up = {pitch.sin * roll.cos, T(-1.0) * roll.sin, pitch.cos * roll.cos};
    s.velocity = {velocity.x, velocity.y, x[At::heave_rate]};
    s.yaw_rate = (x[At::base_omega] * pitch.cos - x[At::body_pitch_rate] * roll.sin) / roll.cos;
    s.turning = x[At::body_roll_rate] * s.forward + x[At::body_pitch_rate] * s.left + s.yaw_rate * s.up;
    s.roll_rate = x[At::body_roll_rate] + pitch.sin * x[At::base_omega];
    s.pitch_rate = x[At::body_pitch_rate] * roll.cos - s.yaw_rate * roll.sin;
    return s;
}

// One wheel as a thin disc over the floor.
template <class T> struct Footing {
    Vector3<T> axle;            // unit vector, outwards
    Vector3<T> rolling, radial; // horizontal unit vectors: where it rolls to, and across
    Vector3<T> point;           // its lowest
    Vector3<T> velocity;        // of the body at that point
    T depth, depth_rate;
    T wheel_speed; // against the body
    // Of rollers one by one; what the floor's forces have as levers about the axle.
    Rolling<T> roller;
    T level, lead; // of the axle; of the contact before the hub, m
};

// Past the vertical a wheel's angle is that against the body, less the body's lean about the axle (of small angles).
template <class T, int Wheels>
Rolling<T> tilted_rolling(const TippingVector<T, Wheels> &x, const Parameters<T, Wheels> &p, const Derived<T> &d,
                          const Modes<T, Wheels> &m, int wheel) {
    using At = Layout<Wheels>;
    const T lean =
        T(Azimuths<Wheels>::cos[wheel]) * x[At::base_roll] + T(Azimuths<Wheels>::sin[wheel]) * x[At::base_pitch];
    return rolling(p, d, m, wheel, x[At::wheel_angle + wheel] - lean);
}

template <class T, int Wheels>
Footing<T> footing(const TippingVector<T, Wheels> &x, const Parameters<T, Wheels> &p, const Derived<T> &d,
                   const Modes<T, Wheels> &m, const Stance<T> &s, int wheel) {
    using At = Layout<Wheels>;
    Footing<T> f{};
    f.axle = T(Azimuths<Wheels>::cos[wheel]) * s.forward + T(Azimuths<Wheels>::sin[wheel]) * s.left;
    const T level = math::sqrt(f.axle.x * f.axle.x + f.axle.y * f.axle.y);
    f.radial = {f.axle.x / level, f.axle.y / level, T(0.0)};
    f.rolling = {T(-1.0) * f.radial.y, f.radial.x, T(0.0)};
    const Vector3<T> rim = (T(-1.0) / level) * (Vector3<T>{T(0.0), T(0.0), T(1.0)} -
                                                f.axle.z * f.axle); // from the hub straight down in the wheel's plane
    f.wheel_speed = x[At::wheel_spin + wheel] + dot(s.turning, f.axle);
    if (discrete(p)) {
        f.roller = tilted_rolling(x, p, d, m, wheel);
        f.level = level;
        f.lead = f.roller.slope;
        f.point = f.roller.lever * f.axle + p.wheel_radius * s.up + f.roller.radius * rim + f.lead * f.rolling;
        f.velocity = s.velocity_of(f.point);
        f.depth_rate = T(-1.0) * f.velocity.z + f.lead * level * f.wheel_speed;
    } else {
        f.point = p.wheel_distance * f.axle + p.wheel_radius * (s.up + rim);
        f.velocity = s.velocity_of(f.point);
        f.depth_rate = T(-1.0) * f.velocity.z;
    }
    f.depth = T(-1.0) * (x[At::base_heave] + f.point.z);
    return f;
}

template <class T, int Wheels> struct TippingEvaluation : Evaluation<T, Wheels, Layout<Wheels>::tipping_state_count> {
    Stance<T> stance;
    Vector3<T> turning_rate;           // angular acceleration
    std::array<T, Wheels> depth, load; // m, N
    Vector2<T> contact_offset;         // of the body's axis at the contact's height
    T floor_stored;
};

// The base's centre as a contact at the contact's height sees it, and the nose relative to that.
namespace detail {

template <class T, int Wheels>
Nose<T> nose_at_height(const TippingVector<T, Wheels> &x, const Parameters<T, Wheels> &p, const Derived<T> &d,
                       const math::SinCos<T> &heading, const Stance<T> &s) {
    Nose<T> nose = find_nose(x, p, d, heading);
    nose.centre = nose.centre - (p.contact_height * s.up).plan();
    return nose;
}

} // namespace detail

// Long because it is the equations of README.md in their order, each using what stands above it.
template <class T, int Wheels>
TippingEvaluation<T, Wheels> evaluate(const TippingVector<T, Wheels> &x, const Inputs<T, Wheels> &u,
                                      const Modes<T, Wheels> &m, const Parameters<T, Wheels> &p, const Derived<T> &d) {
    using At = Layout<Wheels>;
    TippingEvaluation<T, Wheels> e{};
    e.heading = math::sincos(x[At::base_theta]);
    e.velocity = to_base(e.heading, Vector2<T>{x[At::base_vx], x[At::base_vy]});
    e.stance = stance<Wheels>(x, e.velocity);
    const Stance<T> &s = e.stance;
    const Vector2<T> push_plan = to_base(e.heading, Vector2<T>{u.push_force_x, u.push_force_y});
    const Vector3<T> push{push_plan.x, push_plan.y, T(0.0)};
    const Vector3<T> push_point = s.at(u.push_point_x, u.push_point_y, p.push_height);
    T loss = T(0.0);
    T work = dot(push, s.velocity_of(push_point));

    Vector3<T> force = push;
    Vector3<T> moment = cross(push_point, push); // about the base's centre at floor level
    const T nominal_load = p.base_mass * T(gravity_mps2) / T(Wheels);
    const bool one_by_one = discrete(p);
    for (int i = 0; i < Wheels; ++i) {
        const Footing<T> f = footing(x, p, d, m, s, i);
        e.wheel_speed[i] = f.wheel_speed;
        e.sensed_torque[i] =
            sensed_torque(p, x[At::motor_angle + i], x[At::motor_speed + i], x[At::wheel_angle + i], f.wheel_speed);
        e.net_torque[i] = net_motor_torque(p, u.motor_torque[i], e.sensed_torque[i]);
        const auto floor =
            stop_force(m.on_floor[i], p.wheel_floor_stiffness, p.wheel_floor_damping, f.depth, f.depth_rate);
        e.depth[i] = f.depth;
        e.load[i] = floor.force;
        e.floor_stored = e.floor_stored + floor.stored;

        // A bristle's deflection is that at nominal load; its force is proportional to the load.
        const T share = floor.force / nominal_load;
        T axial_speed = dot(f.radial, f.velocity);
        T slip = dot(f.rolling, f.velocity) - p.wheel_radius * f.wheel_speed;
        T steady;
        if (one_by_one) {
            slip = dot(f.rolling, f.velocity) - f.roller.radius * f.wheel_speed;
            axial_speed = axial_speed + f.lead * f.axle.z * f.wheel_speed;
            steady = steady_friction(p, i, axial_speed, f.roller.touch);
        } else {
            steady = steady_friction(p, i, axial_speed);
        }
        const auto roller = roller_force(p, d.roller_plastic_fraction, i, axial_speed, x[At::bristle + i], steady);
        const T grip_rate =
            bristle_rate(slip, x[At::grip + i], p.wheel_grip_stiffness, p.wheel_grip_friction * nominal_load,
                         p.roller_elastic_fraction, d.roller_plastic_fraction);
        const T traction =
            T(-1.0) * share * (p.wheel_grip_stiffness * x[At::grip + i] + p.wheel_grip_damping * grip_rate);
        e.roller_force[i] = share * roller.force;
        const Vector3<T> at_floor =
            traction * f.rolling - e.roller_force[i] * f.radial + Vector3<T>{T(0.0), T(0.0), floor.force};
        // About its axle the floor's moment acts on the wheel and the drive's moment on the body, and the spin turns
        // with the body.
        T spinning_up = e.sensed_torque[i] - p.wheel_radius * traction;
        if (one_by_one) {
            spinning_up = e.sensed_torque[i] - f.roller.radius * traction -
                          f.lead * (f.level * floor.force + f.axle.z * e.roller_force[i]);
        }
        force = force + at_floor;
        moment = moment + cross(f.point, at_floor) + spinning_up * f.axle +
                 (p.wheel_inertia * x[At::wheel_spin + i]) * cross(s.turning, f.axle);

        const T direction = m.gear_direction[i];
        e.rate[At::motor_angle + i] = x[At::motor_speed + i];
        e.rate[At::motor_speed + i] = motor_acceleration(p, i, direction, e.net_torque[i], x[At::motor_speed + i]);
        e.rate[At::wheel_angle + i] = f.wheel_speed;
        e.rate[At::wheel_spin + i] = spinning_up / p.wheel_inertia;
        e.rate[At::bristle + i] = m.on_floor[i] * roller.deflection_rate;
        e.rate[At::grip + i] = m.on_floor[i] * grip_rate;
        work = work + (e.net_torque[i] + e.sensed_torque[i]) * x[At::motor_speed + i];
        loss = loss + gear_dissipation(p, i, direction, x[At::motor_speed + i]) +
               p.drivetrain_damping * math::square(x[At::motor_speed + i] - f.wheel_speed) + floor.dissipation -
               traction * slip + e.roller_force[i] * axial_speed;
    }

    const Vector3<T> axis_point = p.contact_height * s.up;
    const T omega = x[At::base_omega];
    const auto touching =
        touch(p, d, detail::nose_at_height(x, p, d, e.heading, s), s.velocity_of(axis_point).plan(), omega,
              x[At::compression], x[At::compression_rate], p.slider_present != 0 ? m.contact : T(0.0));
    e.contact = touching.contact;
    e.contact_force = touching.force;
    e.contact_offset = axis_point.plan();
    const Vector3<T> hit{e.contact_force.on_robot.x, e.contact_force.on_robot.y, T(0.0)};
    force = force + hit;
    // The outline turns with the heading alone, so its moment may do work only through the heading's rate.
    moment = moment + cross(axis_point, hit) +
             e.contact_force.moment * Vector3<T>{T(-1.0) * s.forward.z / s.forward.x, T(0.0), T(1.0)};
    const Vector2<T> force_world = to_world(e.heading, e.contact_force.on_robot);
    slider_rates(e, x, m, p, d, force_world.x * d.rail_x + force_world.y * d.rail_y, loss);

    // Newton and Euler at the centre of mass. A wheel's own spin is handled separately.
    const Vector3<T> com = s.at(p.base_com_x, p.base_com_y, p.base_com_height);
    const Vector3<T> torque = moment - cross(com, force);
    const T tilting = p.base_tilt_inertia - T(0.5 * Wheels) * p.wheel_inertia;
    const T roll_rate = x[At::body_roll_rate];
    const T pitch_rate = x[At::body_pitch_rate];
    const T roll_acceleration =
        (dot(torque, s.forward) + (tilting - p.base_yaw_inertia) * pitch_rate * s.yaw_rate) / tilting;
    const T pitch_acceleration =
        (dot(torque, s.left) + (p.base_yaw_inertia - tilting) * roll_rate * s.yaw_rate) / tilting;
    const T yaw_acceleration = dot(torque, s.up) / p.base_yaw_inertia;
    e.turning_rate = roll_acceleration * s.forward + pitch_acceleration * s.left + yaw_acceleration * s.up;
    const Vector2<T> downhill = to_base(e.heading, Vector2<T>{d.downhill_x, d.downhill_y});
    const Vector3<T> weight{downhill.x, downhill.y, T(-1.0) * d.floor_gravity};
    const Vector3<T> acceleration =
        (T(1.0) / p.base_mass) * force + weight - cross(e.turning_rate, com) - cross(s.turning, cross(s.turning, com));

    const Vector2<T> acceleration_world = to_world(e.heading, acceleration.plan());
    e.rate[At::base_x] = x[At::base_vx];
    e.rate[At::base_y] = x[At::base_vy];
    e.rate[At::base_theta] = omega;
    e.rate[At::base_vx] = acceleration_world.x;
    e.rate[At::base_vy] = acceleration_world.y;
    // The heading's rate is (left.z pitch_rate + up.z yaw_rate) / cos(pitch)^2, differentiated.
    const T pitch_cos = s.forward.x;
    const T pitch_sin = T(-1.0) * s.forward.z;
    const T roll_sin = s.left.z / pitch_cos;
    const T roll_cos = s.left.y;
    e.rate[At::base_omega] = (pitch_acceleration * roll_sin + yaw_acceleration * roll_cos + s.roll_rate * s.pitch_rate +
                              omega * pitch_sin * s.pitch_rate) /
                             pitch_cos;
    e.rate[At::base_heave] = x[At::heave_rate];
    e.rate[At::base_roll] = s.roll_rate;
    e.rate[At::base_pitch] = s.pitch_rate;
    e.rate[At::heave_rate] = acceleration.z;
    e.rate[At::body_roll_rate] = roll_acceleration;
    e.rate[At::body_pitch_rate] = pitch_acceleration;
    e.rate[At::work_in] = work;
    e.rate[At::dissipated] = loss;
    e.rate[At::impulse_x] = force_world.x;
    e.rate[At::impulse_y] = force_world.y;
    return e;
}

template <class T, int Wheels>
TippingVector<T, Wheels> rhs(const TippingVector<T, Wheels> &x, const Inputs<T, Wheels> &u, const Modes<T, Wheels> &m,
                             const Parameters<T, Wheels> &p, const Derived<T> &d) {
    return evaluate(x, u, m, p, d).rate;
}

template <class T, int Wheels>
TippingEvents<T, Wheels> event_indicators(const TippingVector<T, Wheels> &x, const Inputs<T, Wheels> &u,
                                          const Modes<T, Wheels> &m, const Parameters<T, Wheels> &p,
                                          const Derived<T> &d) {
    using At = Layout<Wheels>;
    TippingEvents<T, Wheels> g{};
    const auto heading = math::sincos(x[At::base_theta]);
    const Stance<T> s = stance<Wheels>(x, to_base(heading, Vector2<T>{x[At::base_vx], x[At::base_vy]}));
    for (int i = 0; i < Wheels; ++i) {
        const Footing<T> f = footing(x, p, d, m, s, i);
        const T sensed =
            sensed_torque(p, x[At::motor_angle + i], x[At::motor_speed + i], x[At::wheel_angle + i], f.wheel_speed);
        g[At::event_gear + i] = gear_indicator(p, i, m.gear_direction[i],
                                               net_motor_torque(p, u.motor_torque[i], sensed), x[At::motor_speed + i]);
        g[At::event_floor + i] = f.depth;
        g[At::event_roller + i] = discrete(p) ? hand_over_indicator(d, f.roller) : T(1.0);
    }
    g[At::event_tilt] = s.up.z - T(cos_greatest_tilt);
    const T depth = p.slider_present != 0
                        ? locate_contact(p, d, detail::nose_at_height(x, p, d, heading, s),
                                         s.velocity_of(p.contact_height * s.up).plan(), x[At::base_omega],
                                         x[At::compression], x[At::compression_rate])
                              .depth
                        : T(-1.0);
    slider_indicators(g, x, m, p, d, depth, [&] { return evaluate(x, u, m, p, d).internal_force; });
    return g;
}

// As that of the planar plant. Nothing is rigid between wheel and floor, so no speed jumps; with the row the floor's
// springs change, by which the account is corrected.
template <class T, int Wheels>
void hand_over(TippingVector<T, Wheels> &x, const Inputs<T, Wheels> &u, Modes<T, Wheels> &m,
               const TippingEvents<T, Wheels> &fired, const Parameters<T, Wheels> &p, const Derived<T> &d) {
    using At = Layout<Wheels>;
    const T stored = evaluate(x, u, m, p, d).floor_stored;
    for (int i = 0; i < Wheels; ++i) {
        const auto now = math::less(fired[At::event_roller + i], T(0.0));
        const T angle = tilted_rolling(x, p, d, m, i).angle;
        stand_on(p, m, i, math::select(now, roller_after(m.roller[i], angle), m.roller[i]));
        x[At::bristle + i] = math::select(now, T(0.0), x[At::bristle + i]);
        x[At::grip + i] = math::select(now, T(0.0), x[At::grip + i]);
    }
    auto e = evaluate(x, u, m, p, d);
    for (int i = 0; i < Wheels; ++i) {
        // A wheel that a tilted base holds over the floor on its other row.
        const auto now = math::less(fired[At::event_roller + i], T(0.0));
        m.on_floor[i] = math::select(now, math::select(math::less(T(0.0), e.depth[i]), T(1.0), T(0.0)), m.on_floor[i]);
    }
    e = evaluate(x, u, m, p, d);
    x[At::dissipated] = x[At::dissipated] + stored - e.floor_stored;
    accept_inputs(x, u, m, p, d);
}

template <class T, int Wheels>
void transition(TippingVector<T, Wheels> &x, const Inputs<T, Wheels> &u, Modes<T, Wheels> &m,
                const TippingEvents<T, Wheels> &fired, const Parameters<T, Wheels> &p, const Derived<T> &d) {
    using At = Layout<Wheels>;
    for (int i = 0; i < Wheels; ++i) {
        const auto landed = math::less(T(0.0), fired[At::event_floor + i]);
        const auto lifted = math::less(fired[At::event_floor + i], T(0.0));
        m.on_floor[i] = math::select(landed, T(1.0), math::select(lifted, T(0.0), m.on_floor[i]));
        // In the air the bristles are reset; without load they carried no force any more.
        x[At::bristle + i] = math::select(lifted, T(0.0), x[At::bristle + i]);
        x[At::grip + i] = math::select(lifted, T(0.0), x[At::grip + i]);
    }
    m.overturned = math::select(math::less(fired[At::event_tilt], T(0.0)), T(1.0), m.overturned);
    planar_transition(evaluate(x, u, m, p, d), x, m, fired, p, d);
    if (discrete(p)) {
        hand_over(x, u, m, fired, p, d);
    }
}

template <class T, int Wheels>
void accept_inputs(const TippingVector<T, Wheels> &x, const Inputs<T, Wheels> &u, Modes<T, Wheels> &m,
                   const Parameters<T, Wheels> &p, const Derived<T> &d) {
    using At = Layout<Wheels>;
    const auto heading = math::sincos(x[At::base_theta]);
    const Stance<T> s = stance<Wheels>(x, to_base(heading, Vector2<T>{x[At::base_vx], x[At::base_vy]}));
    for (int i = 0; i < Wheels; ++i) {
        const T speed = footing(x, p, d, m, s, i).wheel_speed;
        break_away(u, m, p, i,
                   sensed_torque(p, x[At::motor_angle + i], x[At::motor_speed + i], x[At::wheel_angle + i], speed));
    }
}

// Remaining share of the margin before the base tips over if only its weight acts from now on: 1 level and at rest with
// the centre of mass in the middle, 0 at the point of no return. Over the line between two wheels the base is an
// inverted pendulum; the growing part of its motion, place + speed / rate, decides. `downhill`: gravity along the
// floor, in base axes.
template <class T, int Wheels>
T tip_margin(const Stance<T> &s, const Parameters<T, Wheels> &p, const Derived<T> &d, Vector2<T> downhill) {
    const Vector3<T> com = s.at(p.base_com_x, p.base_com_y, p.base_com_height);
    const Vector2<T> place = com.plan() + (com.z / d.floor_gravity) * downhill;
    const Vector2<T> speed = cross(s.turning, com).plan();
    T farthest = T(-1e300);
    for (int i = 0; i < Wheels; ++i) {
        const Side side = side_after<Wheels>(i);
        const T distance = T(Azimuths<Wheels>::side_distance) * p.wheel_distance -
                           (T(side.cos) * p.base_com_x + T(side.sin) * p.base_com_y);
        const T inertia =
            p.base_tilt_inertia + p.base_mass * (math::square(p.base_com_height) + math::square(distance));
        const T rate = math::sqrt(p.base_mass * d.floor_gravity * p.base_com_height / inertia);
        const Vector2<T> bound = place + (T(1.0) / rate) * speed;
        farthest = math::max(farthest, T(side.cos) * bound.x + T(side.sin) * bound.y);
    }
    return T(1.0) - T(1.0 / Azimuths<Wheels>::side_distance) * farthest / p.wheel_distance;
}

} // namespace giveway::plant
