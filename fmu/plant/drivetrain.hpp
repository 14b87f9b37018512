// Drivetrain of Fig. 6, one wheel, everything reflected to the wheel axle.
#pragma once

#include "state.hpp"

namespace giveway::plant {

// Torque on the wheel, which the sensor reads.
template <class T, int Wheels>
T sensed_torque(const Parameters<T, Wheels> &p, T motor_angle, T motor_speed, T wheel_angle, T wheel_speed) {
    return p.drivetrain_stiffness * (motor_angle - wheel_angle) + p.drivetrain_damping * (motor_speed - wheel_speed);
}

// The torque that the gear friction has to hold while the motor is stuck.
template <class T, int Wheels> T net_motor_torque(const Parameters<T, Wheels> &p, T motor_torque, T sensed) {
    return math::clamp(motor_torque, T(-1.0) * p.drivetrain_torque_limit, p.drivetrain_torque_limit) - sensed;
}

// While the motor turns in `direction`.
template <class T, int Wheels> T gear_friction(const Parameters<T, Wheels> &p, int wheel, T direction, T motor_speed) {
    return p.drivetrain_friction_scale[wheel] *
           (p.drivetrain_gear_coulomb * direction + p.drivetrain_gear_viscous * motor_speed);
}
template <class T, int Wheels> T gear_stiction(const Parameters<T, Wheels> &p, int wheel) {
    return p.drivetrain_friction_scale[wheel] * p.drivetrain_gear_stiction;
}

template <class T, int Wheels>
T motor_acceleration(const Parameters<T, Wheels> &p, int wheel, T direction, T net_torque, T motor_speed) {
    const T friction = gear_friction(p, wheel, direction, motor_speed);
    return direction * direction * (net_torque - friction) / p.drivetrain_motor_inertia;
}

template <class T, int Wheels>
T gear_dissipation(const Parameters<T, Wheels> &p, int wheel, T direction, T motor_speed) {
    return gear_friction(p, wheel, direction, motor_speed) * motor_speed;
}

// Positive while the mode holds.
template <class T, int Wheels>
T gear_indicator(const Parameters<T, Wheels> &p, int wheel, T direction, T net_torque, T motor_speed) {
    const T stuck = math::abs(direction);
    return math::select(math::less(T(0.5), stuck), motor_speed * direction,
                        gear_stiction(p, wheel) - math::abs(net_torque));
}

// Direction after the motor's speed came to zero, or after its stiction was overcome.
template <class T, int Wheels> T gear_direction_from_rest(const Parameters<T, Wheels> &p, int wheel, T net_torque) {
    return math::select(math::less(gear_stiction(p, wheel), math::abs(net_torque)), math::sign(net_torque), T(0.0));
}

} // namespace giveway::plant
