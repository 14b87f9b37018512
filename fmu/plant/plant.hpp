// The plant's four functions: rhs, outputs, event_indicators, transition. README.md of this folder has the equations.
#pragma once

#include "arrangement.hpp"
#include "base.hpp"
#include "bumper.hpp"
#include "contact.hpp"
#include "drivetrain.hpp"
#include "roller.hpp"
#include "rope.hpp"

namespace giveway::plant {

// All intermediate results of the equations for the state's rate.
template <class T, int Wheels = table_wheels, std::size_t N = Layout<Wheels>::state_count> struct Evaluation {
    std::array<T, N> rate;
    math::SinCos<T> heading;
    Vector2<T> velocity; // base axes
    T push_power;
    std::array<T, Wheels> wheel_speed, sensed_torque, net_torque, roller_force;
    std::array<Rolling<T>, Wheels> rollers; // if they are one by one
    T lifted;                               // energy of the weight on them, J
    Contact<T> contact;
    ContactForce<T> contact_force;
    BumperForce<T> bumper;
    RopeForces<T> rope;
    StopForce<T> wall;
    T internal_force; // between plate and carrier, compressing; of a locked bumper the force that locks it
};

template <class T> Vector2<T> to_base(const math::SinCos<T> &heading, Vector2<T> world) {
    return {heading.cos * world.x + heading.sin * world.y, heading.cos * world.y - heading.sin * world.x};
}
template <class T> Vector2<T> to_world(const math::SinCos<T> &heading, Vector2<T> base) {
    return {heading.cos * base.x - heading.sin * base.y, heading.sin * base.x + heading.cos * base.y};
}

// 1 where the plate moves as one with its carrier.
template <class T, int Wheels> T locked(const Parameters<T, Wheels> &p, const Modes<T, Wheels> &m) {
    if (!p.has_plate() || p.slider_present == 0) {
        return T(1.0);
    }
    return bumper_holds(p) ? m.latched : T(0.0);
}

// The share of the accelerations of a locked plate; the rest are those of a free one. An inertance between plate and
// carrier is in between: exactly this mean of both.
template <class T, int Wheels> T locked_share(const Parameters<T, Wheels> &p, const Modes<T, Wheels> &m) {
    if (p.bumper_kind == BumperKind::lever && p.slider_present != 0) {
        const T inertance = bumper_inertance(p);
        const T plate = p.bumper_plate_mass;
        const T slider = p.slider_mass;
        const T guided = p.plate_on_robot() ? plate : plate * (slider - plate) / slider;
        return inertance / (guided + inertance);
    }
    return locked(p, m);
}

template <class T, int Wheels, std::size_t N>
std::array<Rolling<T>, Wheels> all_rolling(const Parameters<T, Wheels> &p, const Derived<T> &d,
                                           const Modes<T, Wheels> &m, const std::array<T, N> &x) {
    std::array<Rolling<T>, Wheels> rollers;
    for (int i = 0; i < Wheels; ++i) {
        rollers[i] = rolling(p, d, m, i, x[Layout<Wheels>::wheel_angle + i]);
    }
    return rollers;
}

namespace detail {

template <class T, int Wheels, std::size_t N>
Nose<T> find_nose(const std::array<T, N> &x, const Parameters<T, Wheels> &p, const Derived<T> &d,
                  const math::SinCos<T> &heading) {
    using At = Layout<Wheels>;
    const bool plate_on_slider = p.has_plate() && !p.plate_on_robot();
    const T nose_travel = plate_on_slider ? x[At::slider_position] - x[At::compression] : x[At::slider_position];
    const T nose_speed = plate_on_slider ? x[At::slider_speed] - x[At::compression_rate] : x[At::slider_speed];
    const Vector2<T> rail{d.rail_x, d.rail_y};
    const Vector2<T> nose{d.origin_x + nose_travel * rail.x - x[At::base_x],
                          d.origin_y + nose_travel * rail.y - x[At::base_y]};
    return {to_base(heading, nose), to_base(heading, nose_speed * rail), to_base(heading, rail)};
}

} // namespace detail

// Slider, weight and bumper; `decelerating`: the contact force against the slider along its rail. Adds their losses
// to `loss`.
template <class T, int Wheels, std::size_t N>
void slider_rates(Evaluation<T, Wheels, N> &e, const std::array<T, N> &x, const Modes<T, Wheels> &m,
                  const Parameters<T, Wheels> &p, const Derived<T> &d, T decelerating, T &loss) {
    using At = Layout<Wheels>;
    const T lock = locked_share(p, m);
    const T free = T(1.0) - lock;
    if (p.slider_present != 0) {
        e.rope =
            rope_forces(p, d, m, x[At::slider_position], x[At::slider_speed], x[At::weight_drop], x[At::weight_speed]);
        const T rail = rail_friction(p, x[At::slider_speed]);
        loss = loss + e.rope.dissipation + rail * x[At::slider_speed] + e.contact_force.dissipation;
        if (p.has_plate()) {
            e.bumper = bumper_force(p, m, x[At::compression], x[At::compression_rate]);
            loss = loss + e.bumper.dissipation;
        }
        T drive = e.rope.tension - rail;
        if (p.wall_present != 0) {
            e.wall = stop_force(m.walled, p.wall_stiffness, p.wall_damping,
                                T(-1.0) * (x[At::slider_position] + p.wall_distance), T(-1.0) * x[At::slider_speed]);
            drive = drive + e.wall.force;
            loss = loss + e.wall.dissipation;
        }
        const T whole = (drive - decelerating) / p.slider_mass;
        e.rate[At::slider_position] = x[At::slider_speed];
        e.rate[At::slider_speed] = whole;
        if (p.has_plate() && !p.plate_on_robot()) {
            const T alone = (drive - e.bumper.force) / d.carriage_mass;
            e.rate[At::slider_speed] = free * alone + lock * whole;
            e.rate[At::compression_rate] = free * (alone - (e.bumper.force - decelerating) / p.bumper_plate_mass);
            e.internal_force = free * e.bumper.force + lock * (decelerating + p.bumper_plate_mass * whole);
        }
        e.rate[At::compression] = (T(1.0) - locked(p, m)) * x[At::compression_rate];
        if (p.rope_attached != 0) {
            e.rate[At::weight_drop] = x[At::weight_speed];
            e.rate[At::weight_speed] = T(gravity_mps2) - (e.rope.tension + e.rope.floor) / p.rope_hanging_mass;
        }
    }
}

// The quantities that depend on the motors' torques; new torques at the same state only need this function.
template <class T, int Wheels>
void drive_motors(Evaluation<T, Wheels> &e, const StateVector<T, Wheels> &x, const Inputs<T, Wheels> &u,
                  const Modes<T, Wheels> &m, const Parameters<T, Wheels> &p) {
    using At = Layout<Wheels>;
    T work = e.push_power;
    for (int i = 0; i < Wheels; ++i) {
        e.net_torque[i] = net_motor_torque(p, u.motor_torque[i], e.sensed_torque[i]);
        e.rate[At::motor_speed + i] =
            motor_acceleration(p, i, m.gear_direction[i], e.net_torque[i], x[At::motor_speed + i]);
        work = work + (e.net_torque[i] + e.sensed_torque[i]) * x[At::motor_speed + i];
    }
    e.rate[At::work_in] = work;
}

// `e`: zero, or a previous result for the same elements; the members of absent elements are not written.
// Long because it is the equations of README.md in their order, each using what stands above it.
template <class T, int Wheels>
void evaluate_into(Evaluation<T, Wheels> &e, const StateVector<T, Wheels> &x, const Inputs<T, Wheels> &u,
                   const Modes<T, Wheels> &m, const Parameters<T, Wheels> &p, const Derived<T> &d) {
    using At = Layout<Wheels>;
    e.heading = math::heading(x[At::base_theta]);
    e.velocity = to_base(e.heading, Vector2<T>{x[At::base_vx], x[At::base_vy]});
    const T omega = x[At::base_omega];
    const Planar3<T> twist{e.velocity.x, e.velocity.y, omega};
    const Vector2<T> push = to_base(e.heading, Vector2<T>{u.push_force_x, u.push_force_y});
    const Vector2<T> push_point{u.push_point_x, u.push_point_y};
    T loss = T(0.0);
    e.push_power = dot(push, e.velocity + omega * turned(push_point));

    Planar3<T> wrench = {push.x, push.y, cross(push_point, push)};
    // Turning about the wheels' centre, and down the floor.
    const Vector2<T> com = mass_centre(p);
    const Vector2<T> downhill = to_base(e.heading, Vector2<T>{d.downhill_x, d.downhill_y});
    const Vector2<T> drawn = (omega * omega) * com + downhill;
    wrench = wrench + p.base_mass * Planar3<T>{drawn.x, drawn.y, cross(com, downhill)};
    // First for all wheels, so that the processor can run independent chains of operations in parallel.
    std::array<T, Wheels> steady;
    const bool one_by_one = discrete(p);
    if (one_by_one) {
        e.rollers = all_rolling(p, d, m, x);
    }
    for (int i = 0; i < Wheels; ++i) {
        const T speed = dot(Vector2<T>{T(Azimuths<Wheels>::cos[i]), T(Azimuths<Wheels>::sin[i])}, e.velocity);
        steady[i] = one_by_one ? steady_friction(p, i, speed, e.rollers[i].touch) : steady_friction(p, i, speed);
    }
    e.lifted = T(0.0);
// With the azimuths as constants a run over fixed steps takes 0.7 % fewer instructions.
#pragma GCC unroll 4
    for (int i = 0; i < Wheels; ++i) {
        const Vector2<T> radial{T(Azimuths<Wheels>::cos[i]), T(Azimuths<Wheels>::sin[i])};
        const T axial_speed = dot(radial, e.velocity);
        const T rolling_speed = dot(turned(radial), e.velocity);
        const Planar3<T> row = one_by_one ? e.rollers[i].row : wheel_row(p, i);
        e.wheel_speed[i] = dot(row, twist);
        e.sensed_torque[i] =
            sensed_torque(p, x[At::motor_angle + i], x[At::motor_speed + i], x[At::wheel_angle + i], e.wheel_speed[i]);
        const auto roller = roller_force(p, d.roller_plastic_fraction, i, axial_speed, x[At::bristle + i], steady[i]);
        e.roller_force[i] = p.wheel_traction[i] * roller.force;

        // The parts of the wheel's and roller's accelerations that come from turning (29), (30).
        T wheel_turning = T(-1.0) * omega * axial_speed / p.wheel_radius;
        const T roller_turning = omega * rolling_speed / p.roller_radius;
        if (one_by_one) {
            const Rolling<T> &r = e.rollers[i];
            wheel_turning = T(-1.0) * (omega * axial_speed + r.slope * math::square(e.wheel_speed[i])) / r.radius;
            // The weight climbs the wheel's radius; its heave follows at once.
            const T weight = carried(p, d, i);
            wrench = wrench + (T(-1.0) * weight * r.slope) * row;
            e.lifted = e.lifted + weight * (r.radius - p.wheel_radius);
        }
        wrench = wrench + (p.wheel_traction[i] * (e.sensed_torque[i] - p.wheel_inertia * wheel_turning)) * row;
        wrench = wrench + (T(-1.0) * e.roller_force[i]) * Planar3<T>{radial.x, radial.y, T(0.0)};
        wrench = wrench + (T(-1.0) * p.wheel_traction[i] * p.roller_inertia * roller_turning) * roller_row(p, i);

        const T direction = m.gear_direction[i];
        e.rate[At::motor_angle + i] = x[At::motor_speed + i];
        e.rate[At::wheel_angle + i] = e.wheel_speed[i];
        e.rate[At::bristle + i] = roller.deflection_rate;
        loss = loss + gear_dissipation(p, i, direction, x[At::motor_speed + i]) +
               p.drivetrain_damping * math::square(x[At::motor_speed + i] - e.wheel_speed[i]) +
               p.wheel_traction[i] * roller.dissipation;
    }
    drive_motors(e, x, u, m, p);

    const auto touching = touch(p, d, detail::find_nose(x, p, d, e.heading), e.velocity, omega, x[At::compression],
                                x[At::compression_rate], p.slider_present != 0 ? m.contact : T(0.0));
    e.contact = touching.contact;
    e.contact_force = touching.force;
    const Vector2<T> force = e.contact_force.on_robot;
    wrench = wrench + Planar3<T>{force.x, force.y, e.contact_force.moment};
    const Vector2<T> force_world = to_world(e.heading, force);
    // Contact force against the slider along its rail.
    const T decelerating = force_world.x * d.rail_x + force_world.y * d.rail_y;

    slider_rates(e, x, m, p, d, decelerating, loss);
    const T lock = locked_share(p, m);
    const T free = T(1.0) - lock;

    Planar3<T> acceleration;
    if (p.plate_on_robot()) {
        // Point mass on a guide along `outward`: across the guide, and along it while locked, it adds to the base's
        // inertia.
        const Vector2<T> outward{d.plate_x, d.plate_y};
        const Vector2<T> plate = Vector2<T>{p.bumper_mount_x, p.bumper_mount_y} - x[At::compression] * outward;
        const Planar3<T> along = wrench_direction(outward, plate);
        const Planar3<T> across = wrench_direction(turned(outward), plate);
        const T centripetal = omega * omega;
        Inertia3<T> inertia = one_by_one ? base_inertia(p, e.rollers) : base_inertia(p);
        inertia.add(p.bumper_plate_mass, across);
        inertia.add(lock * p.bumper_plate_mass, along);
        const T across_turning = T(-1.0) * centripetal * dot(plate, turned(outward)) -
                                 T(2.0) * omega * (T(1.0) - locked(p, m)) * x[At::compression_rate];
        const T along_turning = T(-1.0) * centripetal * dot(plate, outward);
        const Vector2<T> weight = p.bumper_plate_mass * downhill;
        const T pull = dot(force + weight, outward);
        wrench = wrench + Planar3<T>{weight.x, weight.y, cross(plate, weight)};
        wrench = wrench + (T(-1.0) * p.bumper_plate_mass * across_turning) * across;
        wrench =
            wrench + (T(-1.0) * (free * (pull + e.bumper.force) + lock * p.bumper_plate_mass * along_turning)) * along;
        acceleration = inertia.solve(wrench);
        const T guide = dot(along, acceleration) + along_turning;
        e.rate[At::compression_rate] = free * (guide - (pull + e.bumper.force) / p.bumper_plate_mass);
        e.internal_force = free * e.bumper.force + lock * (p.bumper_plate_mass * guide - pull);
    } else {
        acceleration = one_by_one ? base_inertia(p, e.rollers).solve(wrench) : d.base_inertia.solve(wrench);
    }

    const Vector2<T> acceleration_world = to_world(e.heading, Vector2<T>{acceleration.x, acceleration.y});
    e.rate[At::base_x] = x[At::base_vx];
    e.rate[At::base_y] = x[At::base_vy];
    e.rate[At::base_theta] = omega;
    e.rate[At::base_vx] = acceleration_world.x;
    e.rate[At::base_vy] = acceleration_world.y;
    e.rate[At::base_omega] = acceleration.z;
    e.rate[At::dissipated] = loss;
    e.rate[At::impulse_x] = force_world.x;
    e.rate[At::impulse_y] = force_world.y;
}

template <class T, int Wheels>
Evaluation<T, Wheels> evaluate(const StateVector<T, Wheels> &x, const Inputs<T, Wheels> &u, const Modes<T, Wheels> &m,
                               const Parameters<T, Wheels> &p, const Derived<T> &d) {
    Evaluation<T, Wheels> e{};
    evaluate_into(e, x, u, m, p, d);
    return e;
}

template <class T, int Wheels>
StateVector<T, Wheels> rhs(const StateVector<T, Wheels> &x, const Inputs<T, Wheels> &u, const Modes<T, Wheels> &m,
                           const Parameters<T, Wheels> &p, const Derived<T> &d) {
    return evaluate(x, u, m, p, d).rate;
}

// Of slider, weight and bumper. Indicators of impossible events keep a constant sign. internal_force() is called only
// for a bumper that holds.
template <class T, int Wheels, std::size_t N, std::size_t E, class InternalForce>
void slider_indicators(std::array<T, E> &g, const std::array<T, N> &x, const Modes<T, Wheels> &m,
                       const Parameters<T, Wheels> &p, const Derived<T> &d, T depth, InternalForce internal_force) {
    using At = Layout<Wheels>;
    const bool slider = p.slider_present != 0;
    g[At::event_contact] = depth;
    g[At::event_rope] = slider && p.rope_attached != 0
                            ? d.rope_pretension_length + x[At::weight_drop] - x[At::slider_position]
                            : T(-1.0);
    g[At::event_end_stop] = T(1.0);
    if (slider && bumper_holds(p)) {
        const T holding = bumper_release_force(p) - internal_force();
        g[At::event_end_stop] = math::select(math::less(T(0.5), m.latched), holding, x[At::compression]);
    } else if (slider && p.has_plate()) {
        g[At::event_end_stop] = x[At::compression];
    }
    g[At::event_bottom_stop] = slider && p.has_plate() ? x[At::compression] - p.bumper_travel : T(-1.0);
    g[At::event_landing] = slider && p.rope_attached != 0 ? x[At::weight_drop] - p.rope_drop_height : T(-1.0);
    g[At::event_wall] = slider && p.wall_present != 0 ? T(-1.0) * (x[At::slider_position] + p.wall_distance) : T(-1.0);
}

template <class T, int Wheels>
void roller_indicators(EventVector<T, Wheels> &g, const StateVector<T, Wheels> &x, const Modes<T, Wheels> &m,
                       const Parameters<T, Wheels> &p, const Derived<T> &d) {
    using At = Layout<Wheels>;
    for (int i = 0; i < Wheels; ++i) {
        g[At::event_roller + i] =
            discrete(p) ? hand_over_indicator(d, rolling(p, d, m, i, x[At::wheel_angle + i])) : T(1.0);
    }
}

// Zero at an event; see the table in README.md for the meaning of the signs.
template <class T, int Wheels>
EventVector<T, Wheels> event_indicators(const StateVector<T, Wheels> &x, const Inputs<T, Wheels> &u,
                                        const Modes<T, Wheels> &m, const Parameters<T, Wheels> &p,
                                        const Derived<T> &d) {
    using At = Layout<Wheels>;
    EventVector<T, Wheels> g{};
    const auto heading = math::heading(x[At::base_theta]);
    const Vector2<T> velocity = to_base(heading, Vector2<T>{x[At::base_vx], x[At::base_vy]});
    const Planar3<T> twist{velocity.x, velocity.y, x[At::base_omega]};
    for (int i = 0; i < Wheels; ++i) {
        const T sensed = sensed_torque(p, x[At::motor_angle + i], x[At::motor_speed + i], x[At::wheel_angle + i],
                                       dot(wheel_row(p, d, m, i, x[At::wheel_angle + i]), twist));
        g[At::event_gear + i] = gear_indicator(p, i, m.gear_direction[i],
                                               net_motor_torque(p, u.motor_torque[i], sensed), x[At::motor_speed + i]);
    }
    const T depth = p.slider_present != 0
                        ? locate_contact(p, d, detail::find_nose(x, p, d, heading), velocity, x[At::base_omega],
                                         x[At::compression], x[At::compression_rate])
                              .depth
                        : T(-1.0);
    slider_indicators(g, x, m, p, d, depth, [&] { return evaluate(x, u, m, p, d).internal_force; });
    roller_indicators(g, x, m, p, d);
    return g;
}

// The same with an existing evaluation.
template <class T, int Wheels>
EventVector<T, Wheels> event_indicators(const Evaluation<T, Wheels> &e, const StateVector<T, Wheels> &x,
                                        const Modes<T, Wheels> &m, const Parameters<T, Wheels> &p,
                                        const Derived<T> &d) {
    using At = Layout<Wheels>;
    EventVector<T, Wheels> g{};
    for (int i = 0; i < Wheels; ++i) {
        g[At::event_gear + i] = gear_indicator(p, i, m.gear_direction[i], e.net_torque[i], x[At::motor_speed + i]);
    }
    slider_indicators(g, x, m, p, d, p.slider_present != 0 ? e.contact.depth : T(-1.0),
                      [&] { return e.internal_force; });
    roller_indicators(g, x, m, p, d);
    return g;
}

// Everything that moves with the base's twist in one piece, on rollers one by one.
template <class T, int Wheels, std::size_t N>
Inertia3<T> inertia_with_plate(const StateVector<T, Wheels> &x, const Modes<T, Wheels> &m,
                               const Parameters<T, Wheels> &p, const Derived<T> &d,
                               const std::array<Rolling<T>, N> &rollers) {
    Inertia3<T> inertia = base_inertia(p, rollers);
    if (p.plate_on_robot()) {
        const Vector2<T> outward{d.plate_x, d.plate_y};
        const Vector2<T> plate =
            Vector2<T>{p.bumper_mount_x, p.bumper_mount_y} - x[Layout<Wheels>::compression] * outward;
        inertia.add(p.bumper_plate_mass, wrench_direction(turned(outward), plate));
        inertia.add(locked_share(p, m) * p.bumper_plate_mass, wrench_direction(outward, plate));
    }
    return inertia;
}

// The wheels whose indicator fell stand on their next roller: its bristle is at rest, its spin is not, and the row's
// lever is another. Wheels and base share the impulse that this takes; the loss is heat, as is the old bristle's
// energy.
template <class T, int Wheels>
void hand_over(const Evaluation<T, Wheels> &e, StateVector<T, Wheels> &x, Modes<T, Wheels> &m,
               const EventVector<T, Wheels> &fired, const Parameters<T, Wheels> &p, const Derived<T> &d) {
    using At = Layout<Wheels>;
    const auto before = all_rolling(p, d, m, x);
    T loss = T(0.0);
    std::array<T, Wheels> passing;
    for (int i = 0; i < Wheels; ++i) {
        const auto now = math::less(fired[At::event_roller + i], T(0.0));
        passing[i] = math::select(now, T(1.0), T(0.0));
        stand_on(p, m, i, math::select(now, roller_after(m.roller[i], before[i].angle), m.roller[i]));
        if (p.roller_model == RollerModel::bristle) {
            loss = loss + T(0.5) * passing[i] * p.roller_presliding_stiffness[i] * math::square(x[At::bristle + i]);
        }
        x[At::bristle + i] = math::select(now, T(0.0), x[At::bristle + i]);
    }
    const auto after = all_rolling(p, d, m, x);
    const Planar3<T> twist{e.velocity.x, e.velocity.y, x[At::base_omega]};
    Planar3<T> impulse{T(0.0), T(0.0), T(0.0)};
    for (int i = 0; i < Wheels; ++i) {
        const T grip = passing[i] * p.wheel_traction[i];
        const Planar3<T> spin = roller_row(p, i);
        impulse =
            impulse + (grip * p.wheel_inertia * (dot(before[i].row, twist) - dot(after[i].row, twist))) * after[i].row;
        impulse = impulse + (T(-1.0) * grip * p.roller_inertia * dot(spin, twist)) * spin;
        loss = loss + passing[i] * carried(p, d, i) * (before[i].radius - after[i].radius);
    }
    const Inertia3<T> together = inertia_with_plate(x, m, p, d, after);
    const Planar3<T> change = together.solve(impulse);
    const Planar3<T> next = twist + change;
    loss = loss + inertia_with_plate(x, m, p, d, before).energy(twist) - together.energy(next);
    const Vector2<T> change_world = to_world(e.heading, Vector2<T>{change.x, change.y});
    x[At::base_vx] = x[At::base_vx] + change_world.x;
    x[At::base_vy] = x[At::base_vy] + change_world.y;
    x[At::base_omega] = x[At::base_omega] + change.z;
    if (p.plate_on_robot()) {
        // A free plate keeps its velocity along its guide.
        const Vector2<T> outward{d.plate_x, d.plate_y};
        const Vector2<T> plate = Vector2<T>{p.bumper_mount_x, p.bumper_mount_y} - x[At::compression] * outward;
        const T free = T(1.0) - locked_share(p, m);
        x[At::compression_rate] = x[At::compression_rate] + free * dot(wrench_direction(outward, plate), change);
    }
    x[At::dissipated] = x[At::dissipated] + loss;
}

// The events that the planar plant has; `e` is the evaluation before them.
template <class T, int Wheels, std::size_t N, std::size_t E>
void planar_transition(const Evaluation<T, Wheels, N> &e, std::array<T, N> &x, Modes<T, Wheels> &m,
                       const std::array<T, E> &fired, const Parameters<T, Wheels> &p, const Derived<T> &d) {
    using At = Layout<Wheels>;
    for (int i = 0; i < Wheels; ++i) {
        const auto now = math::less(fired[At::event_gear + i], T(0.0));
        const auto was_stuck = math::less(math::abs(m.gear_direction[i]), T(0.5));
        // At the located break-away the net torque equals the stiction up to rounding: the gear slides in the direction
        // of the torque.
        const T from_stuck = math::sign(e.net_torque[i]);
        const T from_sliding = gear_direction_from_rest(p, i, e.net_torque[i]);
        x[At::motor_speed + i] = math::select(now, T(0.0), x[At::motor_speed + i]);
        m.gear_direction[i] = math::select(now, math::select(was_stuck, from_stuck, from_sliding), m.gear_direction[i]);
    }
    if constexpr (N == At::state_count) {
        if (discrete(p)) {
            hand_over(e, x, m, fired, p, d);
        }
    }
    const auto follow = [&](int event, T mode) {
        return math::select(math::less(T(0.0), fired[event]), T(1.0),
                            math::select(math::less(fired[event], T(0.0)), T(0.0), mode));
    };
    m.contact = follow(At::event_contact, m.contact);
    m.rope_taut = follow(At::event_rope, m.rope_taut);
    m.bottom_stop = follow(At::event_bottom_stop, m.bottom_stop);
    m.landed = follow(At::event_landing, m.landed);
    m.walled = follow(At::event_wall, m.walled);
    if (!bumper_holds(p)) {
        m.end_stop = T(1.0) - follow(At::event_end_stop, T(1.0) - m.end_stop);
        return;
    }
    // In both cases the indicator falls: the latch releases, or the plate is back and latches in a plastic impact.
    const auto now = math::less(fired[At::event_end_stop], T(0.0));
    const T latching = math::select(now, T(1.0) - m.latched, T(0.0));
    const T rate = latching * x[At::compression_rate];
    T impulse;
    if (p.plate_on_robot()) {
        const Vector2<T> outward{d.plate_x, d.plate_y};
        const Vector2<T> plate = Vector2<T>{p.bumper_mount_x, p.bumper_mount_y} - x[At::compression] * outward;
        const Planar3<T> along = wrench_direction(outward, plate);
        Inertia3<T> inertia = discrete(p) ? base_inertia(p, all_rolling(p, d, m, x)) : base_inertia(p);
        inertia.add(p.bumper_plate_mass, wrench_direction(turned(outward), plate));
        inertia.add(p.bumper_plate_mass, along);
        const Planar3<T> change = inertia.solve((T(-1.0) * p.bumper_plate_mass * rate) * along);
        const Vector2<T> change_world = to_world(e.heading, Vector2<T>{change.x, change.y});
        x[At::base_vx] = x[At::base_vx] + change_world.x;
        x[At::base_vy] = x[At::base_vy] + change_world.y;
        x[At::base_omega] = x[At::base_omega] + change.z;
        impulse = p.bumper_plate_mass * (dot(along, change) + rate);
    } else {
        x[At::slider_speed] = x[At::slider_speed] - p.bumper_plate_mass / p.slider_mass * rate;
        impulse = T(p.bumper_plate_mass) * d.carriage_mass / p.slider_mass * rate;
    }
    x[At::dissipated] = x[At::dissipated] + T(0.5) * impulse * rate;
    x[At::compression] = math::select(now, T(0.0), x[At::compression]);
    x[At::compression_rate] = math::select(now, T(0.0), x[At::compression_rate]);
    m.latched = math::select(now, T(1.0) - m.latched, m.latched);
}

// `fired`: +1 where the indicator rose through zero, -1 where it fell, 0 elsewhere. Changes modes, and the state where
// it jumps.
template <class T, int Wheels>
void transition(StateVector<T, Wheels> &x, const Inputs<T, Wheels> &u, Modes<T, Wheels> &m,
                const EventVector<T, Wheels> &fired, const Parameters<T, Wheels> &p, const Derived<T> &d) {
    planar_transition(evaluate(x, u, m, p, d), x, m, fired, p, d);
    if (discrete(p)) {
        accept_inputs(x, u, m, p, d); // wheels that changed their speed twist their drivetrains otherwise
    }
}

template <class T, int Wheels>
void break_away(const Inputs<T, Wheels> &u, Modes<T, Wheels> &m, const Parameters<T, Wheels> &p, int wheel, T sensed) {
    const T direction = gear_direction_from_rest(p, wheel, net_motor_torque(p, u.motor_torque[wheel], sensed));
    m.gear_direction[wheel] =
        math::select(math::less(math::abs(m.gear_direction[wheel]), T(0.5)), direction, m.gear_direction[wheel]);
}

// After the inputs changed: a stuck gear whose motor now pulls more than its stiction breaks away.
template <class T, int Wheels>
void accept_inputs(const StateVector<T, Wheels> &x, const Inputs<T, Wheels> &u, Modes<T, Wheels> &m,
                   const Parameters<T, Wheels> &p, const Derived<T> &d) {
    using At = Layout<Wheels>;
    const auto heading = math::heading(x[At::base_theta]);
    const Vector2<T> velocity = to_base(heading, Vector2<T>{x[At::base_vx], x[At::base_vy]});
    const Planar3<T> twist{velocity.x, velocity.y, x[At::base_omega]};
    for (int i = 0; i < Wheels; ++i) {
        const T sensed = sensed_torque(p, x[At::motor_angle + i], x[At::motor_speed + i], x[At::wheel_angle + i],
                                       dot(wheel_row(p, d, m, i, x[At::wheel_angle + i]), twist));
        break_away(u, m, p, i, sensed);
    }
}

} // namespace giveway::plant
