"""Wheels that lift: of a robot that can tip, against the same run with the reaction blocked.

From `AFTER_S` after a contact has ended no wheel shall lift; while it lasts none that would not have lifted with the
reaction blocked. A blocked reflex (`NO_REFLEX`) notices nothing: the robot goes on with its plan.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.crowd.judged import Judged
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["AFTER_S", "RECORDED", "lifts"]

AFTER_S = 0.1
RECORDED = tuple(f"testbed.truth.wheel_load[{wheel}]" for wheel in range(WHEELS))

Traces = Mapping[str, "NDArray[Any]"]


def lifts(step_s: float, own: Traces, judged: Judged, blocked: Traces, judged_blocked: Judged) -> dict[str, float]:
    """What lifted in a run, from the `RECORDED` traces of both runs, which may have ended at different times.

    ``late_s``: for how long a wheel was up from `AFTER_S` after a contact, ``late_blocked_s``: in the blocked run;
    ``caused``: wheels that lifted during a contact, but not in the blocked run until its contact ended.
    """
    up, up_blocked = _up(own), _up(blocked)
    caused = 0
    for contact in judged.contacts:
        rows = slice(round(contact.start_s / step_s), round(contact.end_s / step_s) + 1)
        same = [other.end_s for other in judged_blocked.contacts if other.start_s <= contact.end_s]
        until = max([contact.end_s, *same])
        excused = up_blocked[:, rows.start : round(until / step_s) + 1].any(axis=1)
        caused += int((up[:, rows].any(axis=1) & ~excused).sum())
    return {
        "late_s": step_s * float(_late(step_s, up, judged).sum()),
        "late_blocked_s": step_s * float(_late(step_s, up_blocked, judged_blocked).sum()),
        "caused": caused,
    }


def _up(traces: Traces) -> NDArray[np.bool_]:
    """Which wheel is up, (wheels, rows)."""
    return np.stack([np.asarray(traces[name]) <= 0.0 for name in RECORDED])


def _late(step_s: float, up: NDArray[np.bool_], judged: Judged) -> NDArray[np.bool_]:
    """Rows in which a wheel is up though the last contact is over."""
    late = np.asarray(up.any(axis=0))
    spans = [(one.start_s, one.end_s) for one in judged.contacts]
    time_s = step_s * np.arange(len(late))
    late &= time_s > (spans[0][1] if spans else np.inf)
    for start_s, end_s in spans:
        late &= ~((time_s >= start_s) & (time_s <= end_s + AFTER_S))
    return late
