"""What the controller's observer of the motors (gw_motor.h) is told that no entry of a robot file says as it is.

It computes from the commands how the motors move, and needs the torque behind the gears. So it has to know when a
command shows in the samples, and it is switched off, by an inertia of 0, where the motors' current stands for torque or
where that is later than it can remember.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, TypeVar

from giveway.base import native
from giveway.robot.table_files import read_table_file

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["BELIEFS", "BUS", "DELAY", "INERTIA", "delay_ticks", "longest_delay"]

BUS = "electronics.bus_delay"
DELAY, INERTIA = "controller.motor.delay", "controller.motor.inertia"
BELIEFS = "motor."
"""How the names of the controller's parameters begin that a file may state beside the robot's number that they have."""


_Ticks = TypeVar("_Ticks", float, "NDArray[np.float64]")


def delay_ticks(to_controller: _Ticks, to_drives: _Ticks) -> _Ticks:
    """From a command to the first sample that it may have changed: both ways over the bus, and the tick it acts in."""
    return to_controller + to_drives + 1


@functools.cache
def longest_delay() -> int:
    """The longest that the controller can be told, ticks."""
    entries = read_table_file(native.variables("controller"))["variable"]
    (entry,) = (entry for entry in entries if f"controller.{entry['name']}" == DELAY)
    return int(entry["maximum"])
