"""In which situation a tick of a planned motion is: `SITUATIONS`. A threshold belongs to one situation.

At rest: the plan has stood for `STANDING_S`, or since the start. In motion: faster than `MOVING_MPS` at a speed that
has been constant for `STEADY_S`; on circles and on the spot, too. Starting and stopping: all other ticks.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["MOTION", "REST", "SITUATIONS", "STARTING", "situations", "ticks_since"]

SITUATIONS = ("at rest", "in motion", "starting and stopping")
REST, MOTION, STARTING = range(3)

STANDING_MPS = 2e-3  # the controller's estimator.rest_speed
STANDING_S = 0.3  # and its rest_ticks: the zero has been taken again
MOVING_MPS = 0.06  # rollers slide steadily
STEADY_MPS2 = 0.01
STEADY_S = 0.2


def situations(speed_mps: NDArray[np.float64], rim_mps: NDArray[np.float64], step_s: float) -> NDArray[np.int8]:
    """Situation of each tick from the planned speeds of the centre and of the wheels' circle, shape (..., n)."""
    fastest = np.maximum(np.abs(speed_mps), np.abs(rim_mps))
    change = np.zeros_like(fastest)
    for speed in (np.abs(speed_mps), np.abs(rim_mps)):
        change = np.maximum(change, np.abs(np.diff(speed, axis=-1, prepend=speed[..., :1])))
    standing = ticks_since(fastest > STANDING_MPS) >= round(STANDING_S / step_s)
    steady = ticks_since(change > STEADY_MPS2 * step_s) >= round(STEADY_S / step_s)
    found = np.full(fastest.shape, STARTING, dtype=np.int8)
    found[steady & (fastest > MOVING_MPS)] = MOTION
    found[standing] = REST
    return found


def ticks_since(event: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Ticks since the last ``event`` along the last axis; very many before the first."""
    at = np.arange(event.shape[-1])
    last = np.maximum.accumulate(np.where(event, at, -(10**9)), axis=-1)
    return np.asarray(at - last)
