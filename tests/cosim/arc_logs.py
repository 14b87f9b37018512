"""Logs of free motion, made by the literal world-frame equations (13) to (30) of Kim et al. 2016."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from giveway.base import native
from giveway.identification.motion_log import MotionLog
from giveway.robot.robot_file import read_robot

_ROBOT = read_robot(native.robot())
R_W, R_R, DISTANCE, MASS, YAW, I_W, I_R = (
    float(_ROBOT.value(name))
    for name in (
        "wheel.radius",
        "roller.radius",
        "wheel.distance",
        "base.mass",
        "base.yaw_inertia",
        "wheel.inertia",
        "roller.inertia",
    )
)
B_R, ALPHA = 0.2, 0.4
STEP_S = 0.002

Swing = Callable[[np.ndarray], np.ndarray]


def sine(swing_rad: float, frequency_hz: float) -> Swing:
    return lambda t: swing_rad * (1.0 - np.cos(2.0 * math.pi * frequency_hz * t))


def jacobians(theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """J_c,w (15) and J_c,r (16) at every yaw ``theta``."""
    angle = theta[:, None] + np.arange(3) * 2.0 * math.pi / 3.0
    ones = np.ones_like(angle)
    wheel = np.stack([-np.sin(angle), np.cos(angle), DISTANCE * ones], axis=2) / R_W
    roller = np.stack([np.cos(angle), np.sin(angle), 0.0 * ones], axis=2) / R_R
    return wheel, roller


def world_torques(
    angle: np.ndarray, step_s: float, friction: Callable[[np.ndarray], np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Torques (27) and roller rates along wheel angles (n, 3); every derivative is a difference in the world frame."""
    wheel, roller = jacobians(angle.sum(axis=1) * R_W / (3.0 * DISTANCE))
    rate = np.gradient(angle, step_s, axis=0)
    twist = np.linalg.solve(wheel, rate[:, :, None])[:, :, 0]
    roller_rate = np.einsum("kij,kj->ki", roller, twist)
    acceleration = np.gradient(twist, step_s, axis=0)
    rollers = I_R * np.gradient(roller_rate, step_s, axis=0) + friction(roller_rate)
    wrench = np.array([MASS, MASS, YAW]) * acceleration + np.einsum("kji,kj->ki", roller, rollers)
    from_wheels = np.linalg.solve(wheel.transpose(0, 2, 1), wrench[:, :, None])[:, :, 0]
    return from_wheels + I_W * np.gradient(rate, step_s, axis=0), roller_rate


def arc_log(
    wheels: Sequence[float],
    swing: Swing,
    seconds: float,
    *,
    noise_nm: float = 0.03,
    offset_nm: Sequence[float] = (0.08, -0.05, 0.02),
    seed: int = 1,
    name: str = "arc.csv",
) -> MotionLog:
    """A robot with the friction (28) whose wheels follow ``swing`` times ``wheels``."""
    time = np.arange(0.0, seconds, STEP_S)
    angle = swing(time)[:, None] * np.array(wheels)
    torque, _ = world_torques(angle, STEP_S, lambda rate: B_R * np.tanh(ALPHA * rate))
    torque += np.array(offset_nm) + np.random.default_rng(seed).normal(0.0, noise_nm, angle.shape)
    return MotionLog(name, time, angle, torque)


def csv_lines(log: MotionLog) -> list[str]:
    """``log`` as the lines of a file that `giveway calibrate` reads."""
    header = ["time_s", *(f"wheel_angle_{i}_rad" for i in range(3)), *(f"torque_{i}_nm" for i in range(3))]
    rows = np.column_stack([log.time_s, log.wheel_angle_rad, log.torque_nm])
    return [",".join(header), *(",".join(f"{value:.9g}" for value in row) for row in rows)]
