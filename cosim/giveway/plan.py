"""Planned motions and external pushes, as tables over time.

A plan is any callable that maps path times ``t`` (shape (n,), s) to an array of shape (n, 9) with the columns
x, y (m), theta (rad), vx, vy (m/s), omega (rad/s), ax, ay (m/s2), alpha (rad/s2), all in the world frame. Path time
stands still while the robot reacts to a collision: the controller owns that clock.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from giveway.checks import finite

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["PLAN_INPUTS", "PUSH_INPUTS", "Plan", "Push", "Rest", "Straight"]

PLAN_INPUTS = tuple(f"plan.{column}" for column in ("x", "y", "theta", "vx", "vy", "omega", "ax", "ay", "alpha"))
PUSH_INPUTS = ("push.force_x", "push.force_y", "push.point_x", "push.point_y")

Plan = Callable[["NDArray[np.float64]"], "NDArray[np.float64]"]
"""Path times (n,) in s to (n, 9): the columns of ``PLAN_INPUTS``."""

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
    """From rest at the origin of the world along a straight line, with constant acceleration up to a constant speed.

    Attributes:
        speed_mps: speed that is reached and kept, in m/s.
        direction_rad: direction of travel in the world frame, in rad; the heading stays 0.
        acceleration_mps2: on the way to that speed, in m/s2.
    """

    speed_mps: float
    direction_rad: float = 0.0
    acceleration_mps2: float = 0.2

    def __post_init__(self) -> None:
        finite("Straight.speed_mps", self.speed_mps, 0.0, 10.0, "m/s")
        finite("Straight.direction_rad", self.direction_rad)
        finite("Straight.acceleration_mps2", self.acceleration_mps2, 1e-3, 100.0, "m/s2")

    @property
    def ramp_s(self) -> float:
        """Time from rest to full speed, s."""
        return self.speed_mps / self.acceleration_mps2

    @property
    def ramp_m(self) -> float:
        """Way from rest to full speed, m."""
        return 0.5 * self.speed_mps * self.ramp_s

    def __call__(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        import numpy as np

        rising = np.minimum(time_s, self.ramp_s)
        along = (
            0.5 * self.acceleration_mps2 * rising**2 + self.speed_mps * (time_s - rising),
            self.acceleration_mps2 * rising,
            np.where(time_s < self.ramp_s, self.acceleration_mps2, 0.0),
        )
        table = np.zeros((len(time_s), len(PLAN_INPUTS)))
        for column, values in zip((0, 3, 6), along, strict=True):
            table[:, column] = values * math.cos(self.direction_rad)
            table[:, column + 1] = values * math.sin(self.direction_rad)
        return table
