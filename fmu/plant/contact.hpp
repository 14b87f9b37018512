// Cover contact between the slider's nose and the robot (its outline, or the plate of a bumper that it carries).
#pragma once

#include "outline.hpp"

namespace giveway::plant {

template <class T> struct Contact {
    T depth, depth_rate;
    Vector2<T> normal; // outward from the robot, base frame
    Vector2<T> point;  // on the robot, base frame
    T slip;            // slip speed of the robot's material point relative to the nose, along turned(normal)
};

template <class T> struct ContactForce {
    T normal_force;
    Vector2<T> on_robot; // base frame
    T moment;            // about the base's centre
    T dissipation, stored;
};

// The sliding body, in base axes, relative to the base's centre.
template <class T> struct Nose {
    Vector2<T> centre, velocity;
    Vector2<T> travel; // unit vector of its rail
};

// velocity: of the base, in its axes; compression of a plate on the robot, else 0.
template <class T, int Wheels>
Contact<T> locate_disc(const Parameters<T, Wheels> &p, const Derived<T> &d, const Nose<T> &nose, Vector2<T> velocity,
                       T omega, T compression, T compression_rate) {
    ClosestPoint<T> closest;
    Vector2<T> plate_velocity{T(0.0), T(0.0)};
    if (p.plate_on_robot()) {
        const Vector2<T> outward{d.plate_x, d.plate_y};
        const Vector2<T> plate = Vector2<T>{p.bumper_mount_x, p.bumper_mount_y} - compression * outward;
        const T distance = dot(nose.centre - plate, outward);
        closest = {distance, outward, nose.centre - distance * outward};
        plate_velocity = T(-1.0) * compression_rate * outward;
    } else {
        closest = closest_point(p, d, nose.centre);
    }
    const Vector2<T> relative = velocity + omega * turned(closest.point) + plate_velocity - nose.velocity;
    return {p.contact_nose_radius - closest.distance, dot(relative, closest.normal), closest.normal, closest.point,
            dot(relative, turned(closest.normal))};
}

// Hunt and Crossley (1975), exponent 1; tangential Coulomb friction, smooth over contact_friction_speed.
template <class T, int Wheels>
ContactForce<T> disc_force(const Parameters<T, Wheels> &p, const Contact<T> &c, T engaged) {
    const T spring = math::acting(engaged, c.depth) * p.contact_stiffness * c.depth;
    const T normal_force = math::max(T(0.0), spring * (T(1.0) + p.contact_damping * c.depth_rate));
    const T friction = math::where(math::less(T(0.0), normal_force), [&] {
        return p.contact_friction * normal_force * math::tanh(c.slip / p.contact_friction_speed);
    });
    const Vector2<T> force = T(-1.0) * normal_force * c.normal - friction * turned(c.normal);
    return {normal_force, force, cross(c.point, force), (normal_force - spring) * c.depth_rate + friction * c.slip,
            T(0.5) * spring * c.depth};
}

template <class T> struct Touch {
    Contact<T> contact;
    ContactForce<T> force;
};

// A long straight edge across the rail. It presses on every corner beyond it separately, so a side that lies flat is
// held at both ends. The contact's depth is that of the farthest corner; its point the centre of pressure, or that
// corner.
template <class T, int Wheels>
Touch<T> touch_edge(const Parameters<T, Wheels> &p, const Derived<T> &d, const Nose<T> &nose, Vector2<T> velocity,
                    T omega, T engaged) {
    const Vector2<T> normal = T(-1.0) * nose.travel;
    const Vector2<T> along = turned(normal);
    const Vector2<T> tip = nose.centre + p.contact_nose_radius * nose.travel;
    Touch<T> sum{};
    sum.contact.depth = T(-1e300);
    sum.contact.normal = normal;
    Vector2<T> pressure{T(0.0), T(0.0)};
    for_each_corner(p, d, [&](Vector2<T> corner) {
        const Vector2<T> relative = velocity + omega * turned(corner) - nose.velocity;
        const T depth = dot(corner - tip, normal);
        const Contact<T> one{depth, dot(relative, normal), normal, corner, dot(relative, along)};
        const auto farther = math::less(sum.contact.depth, depth);
        const auto pick = [farther](T a, T b) { return math::select(farther, a, b); };
        Contact<T> &far = sum.contact;
        far.depth = pick(depth, far.depth);
        far.depth_rate = pick(one.depth_rate, far.depth_rate);
        far.point = {pick(corner.x, far.point.x), pick(corner.y, far.point.y)};
        far.slip = pick(one.slip, far.slip);
        const ContactForce<T> force = disc_force(p, one, math::select(math::less(T(0.0), depth), engaged, T(0.0)));
        sum.force.normal_force = sum.force.normal_force + force.normal_force;
        sum.force.on_robot = sum.force.on_robot + force.on_robot;
        sum.force.moment = sum.force.moment + force.moment;
        sum.force.dissipation = sum.force.dissipation + force.dissipation;
        sum.force.stored = sum.force.stored + force.stored;
        pressure = pressure + force.normal_force * corner;
    });
    const auto pressed = math::less(T(0.0), sum.force.normal_force);
    const T divisor = math::max(sum.force.normal_force, T(1e-300));
    sum.contact.point = {math::select(pressed, pressure.x / divisor, sum.contact.point.x),
                         math::select(pressed, pressure.y / divisor, sum.contact.point.y)};
    return sum;
}

template <class T, int Wheels>
Contact<T> locate_contact(const Parameters<T, Wheels> &p, const Derived<T> &d, const Nose<T> &nose, Vector2<T> velocity,
                          T omega, T compression, T compression_rate) {
    return p.contact_nose_shape == NoseShape::edge
               ? touch_edge(p, d, nose, velocity, omega, T(0.0)).contact
               : locate_disc(p, d, nose, velocity, omega, compression, compression_rate);
}

template <class T, int Wheels>
Touch<T> touch(const Parameters<T, Wheels> &p, const Derived<T> &d, const Nose<T> &nose, Vector2<T> velocity, T omega,
               T compression, T compression_rate, T engaged) {
    if (p.contact_nose_shape == NoseShape::edge) {
        return touch_edge(p, d, nose, velocity, omega, engaged);
    }
    const Contact<T> contact = locate_disc(p, d, nose, velocity, omega, compression, compression_rate);
    return {contact, disc_force(p, contact, engaged)};
}

} // namespace giveway::plant
