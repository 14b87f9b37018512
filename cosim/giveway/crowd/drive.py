"""Plans of legs: the robot starts, drives straight, around a circle or on the spot, and stops, any number of times."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.checks import finite
from giveway.base.errors import GivewayError
from giveway.crowd.population import start_value
from giveway.scenario.plan import PLAN_INPUTS, travel_from_rest

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Drive", "Leg", "fastest", "tare_s"]

SPEED_SHARE = 0.8  # of the limit: the rest is for the way back to the plan


def tare_s() -> float:
    """Length of the controller's first tare: the plan begins after it."""
    return start_value("estimator.tare_ticks", "controller") * start_value("controller.period", "controller")


def fastest(robot: Path | None) -> float:
    """The highest speed that plans ask of the robots of a robot file, m/s; infinite for Trikey's."""
    return math.inf if robot is None else SPEED_SHARE * start_value("reference.speed_limit", "controller", robot)


@dataclass(frozen=True)
class Leg:
    """A motion from rest to rest; acceleration and deceleration are half a sine wave over time.

    Attributes:
        start_s: path time at which it begins.
        speed_mps: along the path, above 0; on the spot: rad/s.
        acceleration_mps2: the largest, above 0; on the spot: rad/s2.
        cruise_s: time at full speed; infinite: it never stops.
        direction_rad: of travel at its start, world frame.
        curvature_pm: of the path, 1/m, positive to the left; 0: straight on.
        turning: the heading turns with the path.
        on_the_spot: only the heading turns, in the direction of the sign of ``curvature_pm`` (0: to the left).
    """

    start_s: float
    speed_mps: float
    acceleration_mps2: float
    cruise_s: float = math.inf
    direction_rad: float = 0.0
    curvature_pm: float = 0.0
    turning: bool = False
    on_the_spot: bool = False

    def __post_init__(self) -> None:
        finite("Leg.start_s", self.start_s, 0.0)
        for name in ("speed_mps", "acceleration_mps2"):
            finite(f"Leg.{name}", getattr(self, name), 1e-3, 1e3)
        for name in ("direction_rad", "curvature_pm"):
            finite(f"Leg.{name}", getattr(self, name))
        if not self.cruise_s >= 0.0:
            raise GivewayError("Leg.cruise_s", self.cruise_s, "at least 0 s")

    @property
    def ramp_s(self) -> float:
        """Time from rest to full speed, and from there to rest."""
        return 0.5 * math.pi * self.speed_mps / self.acceleration_mps2

    @property
    def cruise_from_s(self) -> float:
        """Path time at which it has its full speed."""
        return self.start_s + self.ramp_s

    @property
    def cruise_to_s(self) -> float:
        """Path time at which it begins to slow down."""
        return self.cruise_from_s + self.cruise_s

    @property
    def end_s(self) -> float:
        """Path time at which it stands again."""
        return self.cruise_to_s + self.ramp_s

    def _risen(self, time_s: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        """Travel, speed and acceleration of a start at time 0 that never stops."""
        return travel_from_rest(np.maximum(time_s, 0.0), self.speed_mps, self.acceleration_mps2)

    def travel(self, time_s: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        """Travel, speed and acceleration along the path at path times (n,), each of shape (n,)."""
        up = self._risen(time_s - self.start_s)
        if math.isinf(self.cruise_s):
            return up
        down = self._risen(time_s - self.cruise_to_s)
        return tuple(a - b for a, b in zip(up, down, strict=True))


@dataclass(frozen=True)
class Drive:
    """Legs one after the other from a pose.

    Attributes:
        legs: in the order of time; each begins when the one before it has ended.
        theta_rad: heading at the start.
    """

    legs: tuple[Leg, ...]
    theta_rad: float = 0.0

    def __post_init__(self) -> None:
        end_s = 0.0
        for leg in self.legs:
            if leg.start_s < end_s:
                raise GivewayError("Leg.start_s", leg.start_s, f"at least {end_s:g} s: one leg after the other")
            end_s = leg.end_s

    def __call__(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        found = np.zeros((len(time_s), len(PLAN_INPUTS)))
        found[:, 2] = self.theta_rad
        for leg in self.legs:
            found += _moved(leg, time_s)
        return found


def _moved(leg: Leg, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
    """What a leg adds to the pose, speed and acceleration, shape (n, 9)."""
    travel, speed, acceleration = leg.travel(time_s)
    added = np.zeros((len(time_s), len(PLAN_INPUTS)))
    if leg.on_the_spot:
        added[:, 2::3] = math.copysign(1.0, leg.curvature_pm) * np.stack([travel, speed, acceleration], axis=1)
        return added
    bend = leg.curvature_pm
    angle = leg.direction_rad + bend * travel
    ahead = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    left = np.stack([-ahead[:, 1], ahead[:, 0]], axis=1)
    if bend == 0.0:
        added[:, 0:2] = travel[:, None] * ahead
    else:
        first = np.array([-math.sin(leg.direction_rad), math.cos(leg.direction_rad)])
        added[:, 0:2] = (first - left) / bend
    added[:, 3:5] = speed[:, None] * ahead
    added[:, 6:8] = acceleration[:, None] * ahead + (bend * speed**2)[:, None] * left
    if leg.turning:
        added[:, 2], added[:, 5], added[:, 8] = bend * travel, bend * speed, bend * acceleration
    return added
