"""Alarms of a detector that does not react, for many thresholds at once.

An alarm: the statistic rises above the threshold, `LOCK_OUT_S` or more after the last alarm. A contact is noticed by
the first alarm from its start to its deadline; it is not judged if an alarm came in the lock-out before it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from giveway.crowd.judged import LOCK_OUT_S

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

__all__ = ["LOCKED", "alarms", "delay_ms"]

LOCKED = -1.0  # instead of a delay: an alarm came just before


def alarms(statistic: NDArray[np.float64], threshold: float, step_s: float) -> NDArray[np.intp]:
    """Rows of the alarms; what is above from the first row on rises there."""
    above = statistic > threshold
    rises = np.flatnonzero(above & ~np.concatenate([[False], above[:-1]]))
    locked = round(LOCK_OUT_S / step_s)
    kept: list[int] = []
    at = 0
    while at < len(rises):
        kept.append(int(rises[at]))
        at = int(np.searchsorted(rises, kept[-1] + locked))
    return np.array(kept, dtype=np.intp)


def delay_ms(rows: Sequence[int] | NDArray[np.intp], step_s: float, start_s: float, deadline_s: float) -> float:
    """From a contact's start to the first of the alarms in ``rows``; infinite: missed; `LOCKED`: not judged."""
    times = np.asarray(rows, dtype=np.float64) * step_s
    if ((times < start_s) & (times > start_s - LOCK_OUT_S)).any():
        return LOCKED
    within = times[(times >= start_s) & (times <= deadline_s)]
    return 1e3 * (float(within[0]) - start_s) if within.size else math.inf
