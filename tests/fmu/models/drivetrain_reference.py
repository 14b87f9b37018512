"""Fig. 6 once more, from its equations: scipy, restarted at every event, every servo tick and every change of torque.

It is not derived from the C++: gear friction is a set of three smooth systems (stuck, turning forwards, turning
backwards) with transitions, and the servo implements the text of gw_servo.h in double precision.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp


@dataclass
class Parameters:
    """Trikey's numbers and a load of the base's size."""

    motor_inertia: float = 0.0523
    stiffness: float = 668.0
    damping: float = 1.0
    gear_coulomb: float = 2.8
    gear_stiction: float = 3.2
    gear_viscous: float = 0.02
    torque_limit: float = 20.0
    load_inertia: float = 0.24
    coulomb: float = 1.5
    tanh_slope: float = 0.4
    viscous: float = 0.05
    kp: float = 203.0
    kd: float = 8.0
    derivative_cutoff: float = 60.0
    encoder_counts: int = 8500
    delay: int = 0

    def as_variables(self) -> dict[str, float]:
        """The same numbers as parameters of the FMU."""
        groups = {
            "drivetrain": "motor_inertia stiffness damping gear_coulomb gear_stiction gear_viscous torque_limit",
            "load": "coulomb tanh_slope viscous",
            "servo": "kp kd derivative_cutoff encoder_counts delay",
        }
        named = {f"{group}.{name}": getattr(self, name) for group, names in groups.items() for name in names.split()}
        return {**named, "load.inertia": self.load_inertia}


@dataclass
class Servo:
    """Proportional-derivative on encoder counts at 2 kHz, in double precision."""

    p: Parameters
    speed: float = 0.0
    last_count: int | None = None
    desired: float = 0.0
    desired_speed: float = 0.0
    pipe: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.pipe = [0.0] * self.p.delay

    def tick(self, angle: float, reference: tuple[float, float] | None) -> float:
        period = 1.0 / 2000.0
        quantum = 2.0 * math.pi / self.p.encoder_counts
        count = math.floor(angle / quantum)
        moved = 0 if self.last_count is None else count - self.last_count
        self.last_count = count
        gain = 1.0 - math.exp(-2.0 * math.pi * self.p.derivative_cutoff * period)
        self.speed += gain * (moved * quantum / period - self.speed)
        if reference is not None:
            self.desired, self.desired_speed = reference
        else:
            self.desired += self.desired_speed * period
        error = math.remainder(self.desired - count * quantum, 2.0 * math.pi)
        torque = self.p.kp * error + self.p.kd * (self.desired_speed - self.speed)
        self.pipe.append(max(-self.p.torque_limit, min(self.p.torque_limit, torque)))
        return self.pipe.pop(0)


@dataclass
class Trace:
    """States (motor angle and speed, load angle and speed) and sensed torque at the grid; event times."""

    states: np.ndarray
    sensed: np.ndarray
    events: list[float]


def simulate(
    p: Parameters,
    torques: Callable[[float], tuple[float, float]],
    grid: np.ndarray,
    start: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
    reference: Callable[[float], tuple[float, float]] | None = None,
) -> Trace:
    """``torques(t)``: motor and environment, constant from one point of the grid to the next.

    ``reference(t)``: angle and speed for the servo, which ticks at every point of the grid.
    """
    state = np.array(start)
    mode = int(np.sign(state[1]))
    servo = Servo(p)
    rows = [state.copy()]
    events: list[float] = []
    for k, (begin, end) in enumerate(pairwise(grid)):
        motor, environment = torques(begin)
        if reference is not None:
            motor += servo.tick(state[0], reference(begin) if k % 2 == 0 else None)
        motor = max(-p.torque_limit, min(p.torque_limit, motor))
        if mode == 0 and abs(motor - _sensed(p, state)) > p.gear_stiction:
            mode = int(np.sign(motor - _sensed(p, state)))
        state, mode, found = _advance(p, begin, end, state, mode, motor, environment)
        events += found
        rows.append(state.copy())
    states = np.array(rows)
    return Trace(states, np.array([_sensed(p, row) for row in states]), events)


def _sensed(p: Parameters, x: np.ndarray) -> float:
    return float(p.stiffness * (x[0] - x[2]) + p.damping * (x[1] - x[3]))


def _advance(
    p: Parameters, begin: float, end: float, state: np.ndarray, mode: int, motor: float, environment: float
) -> tuple[np.ndarray, int, list[float]]:
    def rate(_: float, x: np.ndarray) -> list[float]:
        sensed = _sensed(p, x)
        drag = p.coulomb * math.tanh(p.tanh_slope * x[3]) + p.viscous * x[3]
        turning = (motor - sensed - p.gear_coulomb * mode - p.gear_viscous * x[1]) / p.motor_inertia
        return [x[1], turning if mode else 0.0, x[3], (sensed - drag + environment) / p.load_inertia]

    def leaves(t: float, x: np.ndarray) -> float:
        if mode:
            return float(x[1] * mode)
        return p.gear_stiction - abs(motor - _sensed(p, x))

    leaves.terminal = True  # type: ignore[attr-defined]
    leaves.direction = -1  # type: ignore[attr-defined]
    found: list[float] = []
    time = begin
    while time < end:
        tolerance = {"rtol": 1e-11, "atol": 1e-13}
        step = solve_ivp(rate, (time, end), state, method="DOP853", events=leaves, **tolerance)
        assert step.success, step.message
        time, state = float(step.t[-1]), step.y[:, -1].copy()
        if step.status == 1:
            found.append(time)
            net = motor - _sensed(p, state)
            if mode:
                state[1] = 0.0
                mode = int(np.sign(net)) if abs(motor - _sensed(p, state)) > p.gear_stiction else 0
            else:
                mode = int(np.sign(net))
    return state, mode, found
