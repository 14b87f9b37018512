"""A drivetrain under its sampled servo, written from the equations without python-control: exact from tick to tick."""

from __future__ import annotations

import math

import numpy as np
from giveway.drivetrain.model import Drivetrain, Servo
from scipy.linalg import expm

TICK_S = 5e-4


def dynamics(p: Drivetrain) -> tuple[np.ndarray, np.ndarray]:
    """State: motor angle and speed, load angle and speed; input: motor and environment torque."""
    m, j, k, d = p.motor_inertia, p.load_inertia, p.stiffness, p.damping
    a = np.array(
        [
            [0.0, 1.0, 0.0, 0.0],
            [-k / m, -(d + p.gear_viscous) / m, k / m, d / m],
            [0.0, 0.0, 0.0, 1.0],
            [k / j, d / j, -k / j, -(d + p.load_viscous) / j],
        ]
    )
    return a, np.array([[0.0, 0.0], [1.0 / m, 0.0], [0.0, 0.0], [0.0, 1.0 / j]])


def held(p: Drivetrain) -> tuple[np.ndarray, np.ndarray]:
    """One tick with constant torques."""
    a, b = dynamics(p)
    both = expm(TICK_S * np.block([[a, b], [np.zeros((2, 6))]]))
    return both[:4, :4], both[:4, 4:]


def sensed(p: Drivetrain) -> np.ndarray:
    return np.array([p.stiffness, p.damping, -p.stiffness, -p.damping])


def simulate(p: Drivetrain, servo: Servo, torque: tuple[float, float], ticks: int, current: bool = False) -> np.ndarray:
    """Sensed torque at every tick after a step of torque; the servo as gw_servo.c has it, holding zero.

    ``current``: the servo's torque, read before it acts at that tick.
    """
    phi, gamma = held(p)
    gain = 1.0 - math.exp(-2.0 * math.pi * servo.derivative_cutoff * TICK_S)
    x, speed, last, queue, out, acts = np.zeros(4), 0.0, 0.0, [0.0] * servo.delay, [], 0.0
    for _ in range(ticks):
        out.append(acts if current else sensed(p) @ x)
        speed += gain * ((x[0] - last) / TICK_S - speed)
        last = x[0]
        queue.append(-servo.kp * x[0] - servo.kd * speed)
        acts = queue.pop(0)
        x = phi @ x + gamma @ [acts + torque[0], torque[1]]
    return np.array(out)


def largest_multiplier(p: Drivetrain, servo: Servo, loop_gain: float = 1.0, delay: int | None = None) -> float:
    """Size of the fastest growing motion per tick; the servo's torque is multiplied by ``loop_gain``."""
    phi, gamma = held(p)
    delay = servo.delay if delay is None else delay
    gain = 1.0 - math.exp(-2.0 * math.pi * servo.derivative_cutoff * TICK_S)
    # Appended states: last angle, filtered speed (both as of the tick before), torques under way.
    size = 6 + delay
    step = np.zeros((size, size))
    speed = np.zeros(size)
    speed[[0, 4, 5]] = gain / TICK_S, -gain / TICK_S, 1.0 - gain
    torque = -loop_gain * servo.kd * speed
    torque[0] -= loop_gain * servo.kp
    step[:4, :4] = phi
    step[4, 0] = 1.0
    step[5] = speed
    if delay == 0:
        step[:4] += np.outer(gamma[:, 0], torque)
    else:
        step[:4, 6] += gamma[:, 0]
        for place in range(delay - 1):
            step[6 + place, 7 + place] = 1.0
        step[-1] = torque
    return float(np.max(np.abs(np.linalg.eigvals(step))))
