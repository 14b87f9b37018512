"""Torque from motor current: what a robot file states of the motors, and the torque signal that follows.

The sensed torque of a wheel is the gear's ratio times the motor's torque constant times the sampled current, so the
noise, the quantum and the range of the current are those of the torque signal by the same factor. Between motor and
wheel stand the gear's friction and the rotor's inertia: the controller is told of both.
"""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["GEAR", "MOTOR", "MOTOR_CURRENT", "SENSING", "from_motor", "stated_by"]

SENSING, MOTOR_CURRENT = "drivetrain.sensing", "motor current"
RATIO, CONSTANT = "motor.gear_ratio", "motor.torque_constant"
MOTOR: Mapping[str, tuple[str, float, float]] = {
    RATIO: ("1", 0.1, 1e4),
    CONSTANT: ("N.m/A", 1e-5, 100.0),
    "motor.current_noise": ("A", 0.0, 1000.0),
    "motor.current_resolution": ("A", 0.0, 1000.0),
    "motor.current_range": ("A", 1e-3, 1e4),
}
"""Unit and range of each number: turns of the motor per turn of the wheel, torque at its shaft per ampere; standard
deviation of a sample, its quantum, and where it saturates."""
_TORQUE_SIGNAL = {
    "drivetrain.torque_noise": "motor.current_noise",
    "drivetrain.torque_sensor_resolution": "motor.current_resolution",
    "drivetrain.torque_sensor_limit": "motor.current_range",
}
GEAR: Mapping[str, tuple[str, ...]] = {
    "controller.gear.coulomb_torque": ("drivetrain.gear_coulomb",),
    "controller.gear.viscous_damping": ("drivetrain.gear_viscous",),
    "controller.base.wheel_inertia": ("wheel.inertia", "drivetrain.motor_inertia"),
}
"""What the controller knows of gears and rotors: the sum of these entries."""


def from_motor(motor: Mapping[str, float]) -> dict[str, float]:
    """The torque signal's numbers at the wheel axle, N m, from those of ``MOTOR``."""
    torque_per_ampere = motor[RATIO] * motor[CONSTANT]
    return {name: torque_per_ampere * motor[key] for name, key in _TORQUE_SIGNAL.items()}


def stated_by(name: str) -> str:
    """What a number of the torque signal, or one that the controller knows of the gears, follows from."""
    return " and ".join(GEAR[name]) if name in GEAR else _TORQUE_SIGNAL[name]
