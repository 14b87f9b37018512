"""What the controllers of a study's designs know of their motors, beside the columns that a quantity names.

A quantity ``robot. ...`` is also what the controller believes. Two numbers of its observer are no entry of the robot
file as it is: how late the drives answer, and an inertia of 0, with which it observes no motors.
"""

from __future__ import annotations

from collections.abc import Set
from typing import TYPE_CHECKING

import numpy as np

from giveway.robot.motor_observer import BUS, DELAY, INERTIA, delay_ticks, longest_delay

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

__all__ = ["follow_motors", "following"]

_BUS = f"robot.{BUS}"
_WAYS = "testbed.electronics.sensor_delay", "testbed.electronics.command_delay"


def following(named: Set[str]) -> tuple[str, ...]:
    """The columns that follow from quantities of these names."""
    return tuple(name for name in (DELAY, INERTIA) if name not in named) if _BUS in named else ()


def follow_motors(
    values: NDArray[np.float64], index: Mapping[str, int], base: NDArray[np.float64], named: Set[str]
) -> None:
    """Complete the rows ``values`` (n, columns), in which quantities of these names vary.

    ``base`` is the row without them: a controller that observes no motors there, as the paper's, or that of a robot
    which senses by motor current, observes none for another inertia.
    """
    if _BUS in named:
        ticks = delay_ticks(*(values[:, index[way]] for way in _WAYS))
        if DELAY not in named:
            values[:, index[DELAY]] = np.minimum(ticks, longest_delay())
        if INERTIA not in named:
            values[ticks > longest_delay(), index[INERTIA]] = 0.0
    if base[index[INERTIA]] == 0.0 and INERTIA not in named:
        values[:, index[INERTIA]] = 0.0
