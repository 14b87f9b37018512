"""The force of a hit over time as a recording of one would have it: the second hit of a run, where there is no slider.

A mass meets the robot's cover alone, or with a bumper in front: the cover's half sine until a latch gives way, then the
spring with its preload, until the mass flies off. The robot counts as a free mass.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from giveway.crowd.population import start_value
from giveway.scenario.plan import PUSH_INPUTS

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Blow"]

ONSET_S = 0.003  # of the spring's preload, and from the latch's force to the spring's


@dataclass(frozen=True)
class Blow:
    """One hit as an external push.

    Attributes:
        bumper: "none", "spring" or "magnetic".
        mass_kg, speed_mps: of what hits, speed relative to the robot.
        direction_rad: of the force, world frame.
        point_m: base frame.
        start_s: time of the first touch.
        robot: whose mass, cover and bumper these are: a robot file; None: Trikey's.
    """

    bumper: str
    mass_kg: float
    speed_mps: float
    direction_rad: float
    point_m: tuple[float, float]
    start_s: float
    robot: Path | None = None

    def __call__(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        force = self.force(time_s - self.start_s)
        pushed = np.zeros((len(time_s), len(PUSH_INPUTS)))
        rows = force > 0.0
        pushed[rows, 0] = math.cos(self.direction_rad) * force[rows]
        pushed[rows, 1] = math.sin(self.direction_rad) * force[rows]
        pushed[rows, 2:] = self.point_m
        return pushed

    def force(self, since_s: NDArray[np.float64]) -> NDArray[np.float64]:
        """Magnitude in N at times since the first touch (n,), shape (n,)."""

        def value(name: str) -> float:
            return start_value(name, robot=self.robot)

        mass = 1.0 / (1.0 / self.mass_kg + 1.0 / value("base.mass"))
        cover = _Spring(value("contact.stiffness"), 0.0, mass, self.speed_mps)
        if self.bumper == "none":
            return cover.force(since_s)
        spring = _Spring(value("bumper.spring_rate"), value("bumper.preload"), mass, self.speed_mps)
        if self.bumper == "spring":
            return np.clip(since_s / ONSET_S, 0.0, 1.0) * spring.force(since_s)
        latch = value("bumper.latch_force")
        if cover.peak <= latch:
            return cover.force(since_s)
        gives_way = cover.reaches_s(latch)
        share = np.clip((since_s - gives_way) / ONSET_S, 0.0, 1.0)
        held = np.where(since_s <= gives_way, cover.force(since_s), latch)
        return (1.0 - share) * held + share * spring.force(since_s)


class _Spring:
    """A mass that meets a spring at a speed: m x'' = -(preload + k x) as long as that is a push."""

    def __init__(self, stiffness: float, preload: float, mass: float, speed: float) -> None:
        self._rate = math.sqrt(stiffness / mass)
        self._sine, self._cosine = speed * math.sqrt(stiffness * mass), preload
        self._end_s = (math.pi - math.atan2(preload, self._sine)) / self._rate

    @property
    def peak(self) -> float:
        return math.hypot(self._sine, self._cosine)

    def reaches_s(self, force: float) -> float:
        """When a spring without preload has this force."""
        return math.asin(force / self._sine) / self._rate

    def force(self, since_s: NDArray[np.float64]) -> NDArray[np.float64]:
        phase = self._rate * since_s
        found = self._sine * np.sin(phase) + self._cosine * np.cos(phase)
        return np.where((since_s > 0.0) & (since_s < self._end_s), np.maximum(found, 0.0), 0.0)
