"""Plans of arcs: some wheels swing and the others stand, so that the rollers roll at all speeds, forth and back.

They are what a robot drives for a log to calibrate on (Kim, Llado, Sentis 2016, 4.2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from giveway.base.checks import finite, whole
from giveway.base.errors import GivewayError
from giveway.robot.wheels import AZIMUTHS_RAD, WHEELS
from giveway.scenario.plan import MAXIMUM_HEADING_RAD, MAXIMUM_POSITION_M, MAXIMUM_TIME_S, PLAN_INPUTS

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

__all__ = ["EVERY_WHEEL", "MAXIMUM_SWINGS", "REST_S", "Arcs", "WheelArc", "wheels_of"]

Wheels = tuple[float, float, float]

EVERY_WHEEL: tuple[Wheels, ...] = (
    (1.0, 0.0, 0.0),
    (1.0, 1.0, 0.0),
    (0.0, 1.0, 0.0),
    (0.0, 1.0, 1.0),
    (0.0, 0.0, 1.0),
    (1.0, 0.0, 1.0),
)
"""Each wheel alone, and each two of them: arcs about six points, after which all rollers are known."""

REST_S = 0.5  # before an arc, for the controller's tare
MINIMUM_SWING_RAD, MAXIMUM_SWING_RAD = 1e-3, 100.0
MINIMUM_FREQUENCY_HZ, MAXIMUM_FREQUENCY_HZ = 1e-4, 100.0
MAXIMUM_SWINGS = 10_000
MAXIMUM_LENGTH_M = 10.0
LEAST_TURN = 1e-6  # of the wheels' shares together: below it the base goes straight on, about no point


@dataclass(frozen=True)
class WheelArc:
    """The base when some wheels swing and the others stand.

    Attributes:
        wheels: share of the swing of each wheel; their sum is not 0.
        swing_rad: half of a wheel's travel, rad.
        frequency_hz: swings per second.
        wheel_radius_m, wheel_distance_m: of the robot.
        rest_s: it stands before.
        x_m, y_m, theta_rad: pose at the start, and after every swing.
    """

    wheels: Wheels
    swing_rad: float
    frequency_hz: float
    wheel_radius_m: float
    wheel_distance_m: float
    rest_s: float = REST_S
    x_m: float = 0.0
    y_m: float = 0.0
    theta_rad: float = 0.0

    def __post_init__(self) -> None:
        for name in ("swing_rad", "frequency_hz", "wheel_radius_m", "wheel_distance_m", "rest_s"):
            finite(f"WheelArc.{name}", getattr(self, name), 0.0)

    @property
    def twist(self) -> tuple[float, float, float]:
        """Twist of the base per rate of the swinging wheels: x, y (m), yaw."""
        import numpy as np

        azimuth = np.array(AZIMUTHS_RAD)
        axes = (
            np.stack([-2.0 * np.sin(azimuth), 2.0 * np.cos(azimuth), np.full(WHEELS, 1.0 / self.wheel_distance_m)])
            / WHEELS
        )
        vx, vy, turn = self.wheel_radius_m * axes @ np.array(self.wheels)
        return float(vx), float(vy), float(turn)

    def __call__(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        import numpy as np

        vx, vy, turn = self.twist
        pivot = np.array([-vy, vx]) / turn  # pivot: the point of the base without velocity; it does not move

        omega = 2.0 * math.pi * self.frequency_hz
        phase = omega * np.maximum(time_s - self.rest_s, 0.0)
        theta = self.theta_rad + turn * self.swing_rad * (1.0 - np.cos(phase))
        rate = turn * self.swing_rad * omega * np.sin(phase)
        acceleration = turn * self.swing_rad * omega**2 * np.where(time_s >= self.rest_s, np.cos(phase), 0.0)
        arm = -_turned(theta, pivot)  # from the pivot to the base

        table = np.empty((len(time_s), len(PLAN_INPUTS)))
        start = np.array([self.x_m, self.y_m]) + _turned(np.array([self.theta_rad]), pivot)[:, 0]
        table[:, 0:2] = (start[:, None] + arm).T
        table[:, 2], table[:, 5], table[:, 8] = theta, rate, acceleration
        table[:, 3:5] = (rate * np.stack([-arm[1], arm[0]])).T
        table[:, 6:8] = (acceleration * np.stack([-arm[1], arm[0]]) - rate**2 * arm).T
        return table


def _turned(angle: NDArray[np.float64], vector: NDArray[np.float64]) -> NDArray[np.float64]:
    """``vector`` turned by each of the angles, shape (2, n)."""
    import numpy as np

    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack([cos * vector[0] - sin * vector[1], sin * vector[0] + cos * vector[1]])


@dataclass(frozen=True)
class Arcs:
    """One arc after the other, endlessly: a rest, some swings of the first wheels, a rest, some swings of the next.

    Attributes:
        wheels: for each arc the share of the swing of each wheel; their sum is not 0.
        swing_rad: half of a wheel's travel, rad.
        frequency_hz: swings per second.
        swings: of each arc, back to where it began.
        rest_s: before each arc.
        wheel_radius_m, wheel_distance_m: of the robot.
        x_m, y_m, theta_rad: pose at the start, and after every swing.
    """

    wheels: tuple[Wheels, ...]
    swing_rad: float
    frequency_hz: float
    swings: int
    rest_s: float
    wheel_radius_m: float
    wheel_distance_m: float
    x_m: float = 0.0
    y_m: float = 0.0
    theta_rad: float = 0.0

    def __post_init__(self) -> None:
        if not self.wheels:
            raise GivewayError("Arcs.wheels", "nothing", "one arc or more")
        for wheels in self.wheels:
            for share in wheels:
                finite("Arcs.wheels", share, -1.0, 1.0)
            if abs(sum(wheels)) < LEAST_TURN:
                allowed = "shares whose sum is not 0: the robot turns about a point"
                raise GivewayError("Arcs.wheels", list(wheels), allowed)
        finite("Arcs.swing_rad", self.swing_rad, MINIMUM_SWING_RAD, MAXIMUM_SWING_RAD, "rad")
        finite("Arcs.frequency_hz", self.frequency_hz, MINIMUM_FREQUENCY_HZ, MAXIMUM_FREQUENCY_HZ, "Hz")
        whole("Arcs.swings", self.swings, 1, MAXIMUM_SWINGS)
        finite("Arcs.rest_s", self.rest_s, 0.0, MAXIMUM_TIME_S, "s")
        for name in ("wheel_radius_m", "wheel_distance_m"):
            finite(f"Arcs.{name}", getattr(self, name), 1e-3, MAXIMUM_LENGTH_M, "m")
        for name in ("x_m", "y_m"):
            finite(f"Arcs.{name}", getattr(self, name), -MAXIMUM_POSITION_M, MAXIMUM_POSITION_M, "m")
        finite("Arcs.theta_rad", self.theta_rad, -MAXIMUM_HEADING_RAD, MAXIMUM_HEADING_RAD, "rad")

    @property
    def arc_s(self) -> float:
        """Time of one arc with the rest before it."""
        return self.rest_s + self.swings / self.frequency_hz

    @property
    def duration_s(self) -> float:
        """Time until each arc has been driven once."""
        return len(self.wheels) * self.arc_s

    def arc(self, number: int) -> WheelArc:
        """Arc ``number``; after the last one it begins anew."""
        return WheelArc(
            self.wheels[number % len(self.wheels)],
            self.swing_rad,
            self.frequency_hz,
            self.wheel_radius_m,
            self.wheel_distance_m,
            self.rest_s,
            self.x_m,
            self.y_m,
            self.theta_rad,
        )

    def __call__(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        import numpy as np

        table = np.empty((len(time_s), len(PLAN_INPUTS)))
        numbers = np.floor(time_s / self.arc_s).astype(np.int64)
        for number in np.unique(numbers).tolist():
            rows = numbers == number
            table[rows] = self.arc(number)(time_s[rows] - number * self.arc_s)
        return table


def wheels_of(robot: Path | None) -> tuple[float, float]:
    """Radius of the wheels and their distance from the centre, m, of a robot file; None: the default robot's."""
    from giveway.base import native
    from giveway.robot.robot_file import read_robot

    found = read_robot(native.robot() if robot is None else robot)
    return float(found.value("wheel.radius")), float(found.value("wheel.distance"))
