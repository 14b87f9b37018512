"""Is a trajectory within a tube in time and value around a reference?

A pointwise difference fails wherever a jump or a steep flank comes a few microseconds earlier: there a tolerance in
time is what is meant.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Excess:
    """Where a trajectory is farthest from its tube.

    Attributes:
        time_s: when.
        value: by how much it is outside, in its unit; negative: inside.
    """

    time_s: float
    value: float


def excess(time_s: Array, values: Array, reference_s: Array, reference: Array, width_s: float, height: float) -> Excess:
    """How far ``values`` leave the tube around ``reference``.

    The tube at t spans the reference over [t - width_s, t + width_s], widened by ``height`` to either side.

    Args:
        time_s, values: shape (n,); reference_s, reference: shape (m,), times rising.
        width_s: in s.
        height: in the unit of ``reference``.
    """
    ends = [np.interp(time_s + side, reference_s, reference) for side in (-width_s, 0.0, width_s)]
    lowest, highest = np.minimum.reduce(ends), np.maximum.reduce(ends)
    first = np.searchsorted(reference_s, time_s - width_s)
    last = np.searchsorted(reference_s, time_s + width_s, side="right")
    for k in np.flatnonzero(last > first):
        lowest[k] = min(lowest[k], reference[first[k] : last[k]].min())
        highest[k] = max(highest[k], reference[first[k] : last[k]].max())
    outside = np.maximum(lowest - values, values - highest) - height
    worst = int(outside.argmax())
    return Excess(float(time_s[worst]), float(outside[worst]))


def at(time_s: Array, values: Array, wanted_s: Array) -> Array:
    """``values`` at ``wanted_s``, after the events of that instant."""
    return values[np.searchsorted(time_s, wanted_s + 1e-9, side="right") - 1]
