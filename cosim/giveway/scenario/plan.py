"""Planned motions and external pushes, as tables over time.

A plan is any callable that maps path times ``t`` (shape (n,), s) to an array of shape (n, 9) with the columns
x, y (m), theta (rad), vx, vy (m/s), omega (rad/s), ax, ay (m/s2), alpha (rad/s2), all in the world frame. Path time
stands still while the robot reacts to a collision: the controller owns that clock.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from giveway.base.checks import finite
from giveway.base.errors import GivewayError, UnknownNameError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = [
    "HEADINGS",
    "PLAN_INPUTS",
    "PUSH_INPUTS",
    "Circle",
    "Plan",
    "Push",
    "Pushes",
    "Rest",
    "Straight",
    "TimedPush",
    "start_values",
    "travel_from_rest",
]

PLAN_INPUTS = tuple(f"plan.{column}" for column in ("x", "y", "theta", "vx", "vy", "omega", "ax", "ay", "alpha"))
PUSH_INPUTS = ("push.force_x", "push.force_y", "push.point_x", "push.point_y")

Plan = Callable[["NDArray[np.float64]"], "NDArray[np.float64]"]
"""Path times (n,) in s to (n, 9): the columns of ``PLAN_INPUTS``."""

HEADINGS = ("fixed", "turning")
"""The heading on a circle: constant, or turning with the path."""

MAXIMUM_POSITION_M = 1e4  # of the controller's and the testbed's variable tables, as are the next two
MAXIMUM_HEADING_RAD = 10.0
MAXIMUM_SPEED_MPS = 10.0
MAXIMUM_ACCELERATION_MPS2 = 1e3
MAXIMUM_PUSH_N = 1e5
MAXIMUM_ARM_M = 100.0
MAXIMUM_TIME_S = 3600.0

Push = Callable[["NDArray[np.float64]"], "NDArray[np.float64]"]
"""Times (n,) in s to (n, 4): force x, y (N, world frame), point x, y (m, base frame)."""


@dataclass(frozen=True)
class Rest:
    """Stand still at a pose of the world frame.

    Attributes:
        x_m, y_m: position in m.
        theta_rad: heading in rad.
    """

    x_m: float = 0.0
    y_m: float = 0.0
    theta_rad: float = 0.0

    def __post_init__(self) -> None:
        for name in ("x_m", "y_m", "theta_rad"):
            finite(f"Rest.{name}", getattr(self, name))

    def __call__(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        import numpy as np

        table = np.zeros((len(time_s), len(PLAN_INPUTS)))
        table[:, :3] = self.x_m, self.y_m, self.theta_rad
        return table


@dataclass(frozen=True)
class Straight:
    """Move endlessly along a straight line with a fixed heading.

    Attributes:
        speed_mps: in m/s, at least 0.
        direction_rad: of travel, world frame, in rad.
        x_m, y_m: position at path time 0, in m.
        theta_rad: heading in rad.
        acceleration_mps2: from rest with at most this, in m/s2 (half a sine wave over time); None: already moving,
            which starts with a jolt, since the servo has to lag behind to make its torque.
    """

    speed_mps: float
    direction_rad: float = 0.0
    x_m: float = 0.0
    y_m: float = 0.0
    theta_rad: float = 0.0
    acceleration_mps2: float | None = 0.2

    def __post_init__(self) -> None:
        finite("Straight.speed_mps", self.speed_mps, 0.0, MAXIMUM_SPEED_MPS, "m/s")
        _check_pose(self, ("x_m", "y_m"), ("direction_rad", "theta_rad"))
        _check_acceleration("Straight.acceleration_mps2", self.acceleration_mps2)

    @property
    def ramp_s(self) -> float:
        """Time from rest to full speed, s."""
        return 0.0 if self.acceleration_mps2 is None else 0.5 * math.pi * self.speed_mps / self.acceleration_mps2

    @property
    def ramp_m(self) -> float:
        """Travel from rest to full speed, m."""
        return 0.5 * self.speed_mps * self.ramp_s

    def __call__(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        import numpy as np

        travel = travel_from_rest(time_s, self.speed_mps, self.acceleration_mps2)
        table = np.zeros((len(time_s), len(PLAN_INPUTS)))
        for derivative, along in enumerate(travel):
            table[:, 3 * derivative] = math.cos(self.direction_rad) * along
            table[:, 3 * derivative + 1] = math.sin(self.direction_rad) * along
        table[:, :3] += self.x_m, self.y_m, self.theta_rad
        return table


@dataclass(frozen=True)
class Circle:
    """Move endlessly around a circle; anticlockwise for a positive speed.

    Attributes:
        diameter_m: in m, above 0.
        speed_mps: along the circle in m/s; negative: clockwise.
        centre_x_m, centre_y_m: in m.
        start_rad: position at path time 0, as the angle about the centre in the world frame, in rad.
        heading: "fixed", or "turning" at the rate of the path: the same side of the robot looks ahead all the time.
        theta_rad: heading at path time 0 in rad.
        acceleration_mps2: from rest with at most this along the path, in m/s2 (half a sine wave over time); None:
            already moving, see `Straight`. The centripetal acceleration, speed^2 over radius, is added to it.
    """

    diameter_m: float
    speed_mps: float
    centre_x_m: float = 0.0
    centre_y_m: float = 0.0
    start_rad: float = 0.0
    heading: str = "fixed"
    theta_rad: float = 0.0
    acceleration_mps2: float | None = 0.2

    def __post_init__(self) -> None:
        finite("Circle.diameter_m", self.diameter_m, 1e-3, MAXIMUM_POSITION_M, "m")
        finite("Circle.speed_mps", self.speed_mps, -MAXIMUM_SPEED_MPS, MAXIMUM_SPEED_MPS, "m/s")
        _check_pose(self, ("centre_x_m", "centre_y_m"), ("start_rad", "theta_rad"))
        _check_acceleration("Circle.acceleration_mps2", self.acceleration_mps2)
        if self.heading not in HEADINGS:
            raise UnknownNameError("Circle.heading", self.heading, HEADINGS)

    def __call__(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        import numpy as np

        radius = 0.5 * self.diameter_m
        travel = travel_from_rest(time_s, self.speed_mps, self.acceleration_mps2)
        turned, rate, growth = (along / radius for along in travel)
        angle = self.start_rad + turned
        outward = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        ahead = radius * np.stack([-np.sin(angle), np.cos(angle)], axis=1)
        table = np.zeros((len(time_s), len(PLAN_INPUTS)))
        table[:, 0:2] = outward + np.array([self.centre_x_m, self.centre_y_m])
        table[:, 2] = self.theta_rad
        table[:, 3:5] = ahead * rate[:, None]
        table[:, 6:8] = ahead * growth[:, None] - outward * (rate**2)[:, None]
        if self.heading == "turning":
            table[:, 2] += turned
            table[:, 5], table[:, 8] = rate, growth
        return table


@dataclass(frozen=True)
class TimedPush:
    """One push: the force rises linearly, holds, and falls linearly.

    Attributes:
        force_n: held force, in N, at least 0.
        direction_rad: of the force on the robot, world frame, in rad.
        point_x_m, point_y_m: where it acts, base frame, in m.
        start_s: start of the rise, in s.
        duration_s: from first to last force in s, above 0.
        ramp_s: of the rise and of the fall, each in s; at most half the duration.
    """

    force_n: float
    direction_rad: float
    point_x_m: float
    point_y_m: float
    start_s: float
    duration_s: float
    ramp_s: float = 0.0

    def __post_init__(self) -> None:
        finite("TimedPush.force_n", self.force_n, 0.0, MAXIMUM_PUSH_N, "N")
        finite("TimedPush.direction_rad", self.direction_rad)
        finite("TimedPush.point_x_m", self.point_x_m, -MAXIMUM_ARM_M, MAXIMUM_ARM_M, "m")
        finite("TimedPush.point_y_m", self.point_y_m, -MAXIMUM_ARM_M, MAXIMUM_ARM_M, "m")
        finite("TimedPush.start_s", self.start_s, 0.0, MAXIMUM_TIME_S, "s")
        finite("TimedPush.duration_s", self.duration_s, 1e-3, MAXIMUM_TIME_S, "s")
        finite("TimedPush.ramp_s", self.ramp_s, 0.0, 0.5 * self.duration_s, "s")

    @property
    def end_s(self) -> float:
        """End of the force, in s."""
        return self.start_s + self.duration_s

    @property
    def impulse_newton_s(self) -> float:
        """Impulse of the whole push, in N s."""
        return self.force_n * (self.duration_s - self.ramp_s)

    def force(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Magnitude in N at times of shape (n,), shape (n,)."""
        import numpy as np

        inside = (time_s >= self.start_s) & (time_s < self.end_s)
        if self.ramp_s == 0.0:
            return np.where(inside, self.force_n, 0.0)
        to_nearer_end = np.minimum(time_s - self.start_s, self.end_s - time_s)
        return self.force_n * np.clip(to_nearer_end / self.ramp_s, 0.0, 1.0)


@dataclass(frozen=True)
class Pushes:
    """A schedule of pushes, one at a time: the testbed takes one force at one point. Times are those of the run.

    Attributes:
        pushes: in the order of time.
    """

    pushes: tuple[TimedPush, ...]

    def __post_init__(self) -> None:
        for earlier, later in itertools.pairwise(self.pushes):
            if later.start_s < earlier.end_s:
                allowed = f"at least {earlier.end_s:g} s, when the push before it ends: one at a time, in order"
                raise GivewayError("TimedPush.start_s", later.start_s, allowed)

    def __call__(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        import numpy as np

        table = np.zeros((len(time_s), len(PUSH_INPUTS)))
        for push in self.pushes:
            force = push.force(time_s)
            rows = force > 0.0
            table[rows, 0] = math.cos(push.direction_rad) * force[rows]
            table[rows, 1] = math.sin(push.direction_rad) * force[rows]
            table[rows, 2:] = push.point_x_m, push.point_y_m
        return table


def start_values(plan: Plan) -> dict[str, float]:
    """The testbed's ``start.*`` parameters for the pose and the speed of ``plan`` at path time 0."""
    import numpy as np

    names = ("x", "y", "theta", "vx", "vy", "omega")
    return {f"start.{name}": float(value) for name, value in zip(names, plan(np.zeros(1))[0], strict=False)}


def _check_pose(plan: Straight | Circle, positions: tuple[str, ...], angles: tuple[str, ...]) -> None:
    name = type(plan).__name__
    for field in positions:
        finite(f"{name}.{field}", getattr(plan, field), -MAXIMUM_POSITION_M, MAXIMUM_POSITION_M, "m")
    for field in angles:
        finite(f"{name}.{field}", getattr(plan, field), -MAXIMUM_HEADING_RAD, MAXIMUM_HEADING_RAD, "rad")


def _check_acceleration(field: str, value: float | None) -> None:
    if value is not None:
        finite(field, value, 1e-3, MAXIMUM_ACCELERATION_MPS2, "m/s2")


def travel_from_rest(
    time_s: NDArray[np.float64], speed_mps: float, acceleration_mps2: float | None
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Distance, speed and acceleration along a path, each of shape (n,).

    From rest, the acceleration is half a sine wave with the given peak, so that it never jumps: v = V (1 - cos(w t))/2
    until w t = pi, with w = 2 a/V.
    """
    import numpy as np

    if acceleration_mps2 is None or speed_mps == 0.0:
        return speed_mps * time_s, np.full_like(time_s, speed_mps), np.zeros_like(time_s)
    rate = 2.0 * acceleration_mps2 / abs(speed_mps)
    phase = np.minimum(rate * time_s, math.pi)
    distance = 0.5 * speed_mps * (phase - np.sin(phase)) / rate + speed_mps * (time_s - phase / rate)
    speed = 0.5 * speed_mps * (1.0 - np.cos(phase))
    acceleration = math.copysign(acceleration_mps2, speed_mps) * np.where(phase < math.pi, np.sin(phase), 0.0)
    return distance, speed, acceleration
