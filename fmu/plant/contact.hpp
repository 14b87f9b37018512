// Cover contact between the slider's nose and the robot (its outline, or the plate of a bumper that it carries).
#pragma once

#include "outline.hpp"

namespace giveway::plant {

template <class T> struct Contact {
    T depth, depth_rate;
    Vector2<T> normal; // outward from the robot, base frame
    Vector2<T> point;  // on the robot, base frame
    T slip;            // of the robot's material point past the nose, along turned(normal)
};

template <class T> struct ContactForce {
    T normal_force;
    Vector2<T> on_robot; // base frame
    T dissipation, stored;
};

// nose, nose_velocity, velocity: base axes, the position relative to the base's centre; compression of a plate on the robot, else 0.
template <class T>
Contact<T> locate_contact(const Parameters<T>& p, const Derived<T>& d, Vector2<T> nose, Vector2<T> nose_velocity,
                          Vector2<T> velocity, T omega, T compression, T compression_rate) {
    ClosestPoint<T> closest;
    Vector2<T> plate_velocity{T(0.0), T(0.0)};
    if (p.plate_on_robot()) {
        const Vector2<T> outward{d.plate_x, d.plate_y};
        const Vector2<T> plate = Vector2<T>{p.mount_x, p.mount_y} - compression * outward;
        const T distance = dot(nose - plate, outward);
        closest = {distance, outward, nose - distance * outward};
        plate_velocity = T(-1.0) * compression_rate * outward;
    } else {
        closest = closest_point(p, d, nose);
    }
    const Vector2<T> relative = velocity + omega * turned(closest.point) + plate_velocity - nose_velocity;
    return {p.nose_radius - closest.distance, dot(relative, closest.normal), closest.normal, closest.point,
            dot(relative, turned(closest.normal))};
}

// Hunt and Crossley (1975), exponent 1; tangential Coulomb friction, smooth over contact_friction_speed.
template <class T> ContactForce<T> contact_force(const Parameters<T>& p, const Contact<T>& c, T engaged) {
    const T spring = engaged * p.contact_stiffness * c.depth;
    const T normal_force = math::max(T(0.0), spring * (T(1.0) + p.contact_damping * c.depth_rate));
    const T friction = p.contact_friction * normal_force * math::tanh(c.slip / p.contact_friction_speed);
    const Vector2<T> force = T(-1.0) * normal_force * c.normal - friction * turned(c.normal);
    return {normal_force, force, (normal_force - spring) * c.depth_rate + friction * c.slip, T(0.5) * spring * c.depth};
}

} // namespace giveway::plant
