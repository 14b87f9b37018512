"""What became of the pushes of a run: noticed or not, invented ones, where the robot went, and whether it came back."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.plan import TimedPush

__all__ = ["TRACES", "PushResponse", "Responses", "most_events", "responses"]

TRACKING, REACTING = 1, 2  # controller.mode
LATE_S = 0.25  # as in the metric "false detections": a detection is late by design, not by more

TRACES = (
    "controller.detection.count",
    "controller.detection.direction",
    "controller.mode",
    "controller.plan.x",
    "controller.plan.y",
    "testbed.truth.x",
    "testbed.truth.y",
    "testbed.truth.theta",
)
"""The variables that `responses` reads."""


@dataclass(frozen=True)
class PushResponse:
    """One push and what followed.

    Attributes:
        push: the push.
        detected_s: time of its detection in the run, s; None if it was missed.
        felt_error_deg: felt minus true direction of the push at detection, deg.
        escape_m: travel of the base from the detection to the end of the reaction, m.
        escape_error_deg: direction of that travel minus that of the push, deg.
        back_s: when the robot was on its path again, s; None if not before the next detection or the end.
    """

    push: TimedPush
    detected_s: float | None = None
    felt_error_deg: float = math.nan
    escape_m: float = math.nan
    escape_error_deg: float = math.nan
    back_s: float | None = None


@dataclass(frozen=True)
class Responses:
    """All pushes of a run.

    Attributes:
        pushes: one each, in order.
        invented_s: times of detections that no push explains, s: none acted in the 0.25 s before, or it was noticed
            already.
        off_path_m: distance of the base from its plan at the end of the run, m.
    """

    pushes: tuple[PushResponse, ...]
    invented_s: tuple[float, ...]
    off_path_m: float

    @property
    def detected(self) -> int:
        """Pushes that were noticed."""
        return sum(one.detected_s is not None for one in self.pushes)

    @property
    def returned(self) -> int:
        """Pushes after which the robot came back to its path."""
        return sum(one.back_s is not None for one in self.pushes)


def responses(
    pushes: Sequence[TimedPush], time_s: NDArray[np.float64], trace: Callable[[str], NDArray[np.float64]]
) -> Responses:
    """Judge a run by its traces (`TRACES`, each of the shape of ``time_s``)."""
    rows = np.flatnonzero(np.diff(trace("controller.detection.count"), prepend=0) > 0)
    position = np.stack([trace("testbed.truth.x"), trace("testbed.truth.y")], axis=1)
    heading, felt = trace("testbed.truth.theta"), trace("controller.detection.direction")
    mode = trace("controller.mode")
    unexplained = [int(row) for row in rows]
    found = []
    for push in pushes:
        caused = [row for row in unexplained if push.start_s <= time_s[row] <= push.end_s + LATE_S]
        if not caused:
            found.append(PushResponse(push))
            continue
        row = caused[0]
        unexplained.remove(row)
        later = rows[rows > row]
        end = int(later[0]) if later.size else len(time_s)
        over = row + _first(mode[row:end] != REACTING)
        travel = position[min(over, len(position) - 1)] - position[row]
        back = row + _first(mode[row:end] == TRACKING)
        found.append(
            PushResponse(
                push,
                float(time_s[row]),
                _wrapped_deg(heading[row] + felt[row] - push.direction_rad),
                math.hypot(*travel),
                _wrapped_deg(math.atan2(travel[1], travel[0]) - push.direction_rad),
                float(time_s[back]) if back < end else None,
            )
        )
    off_path = position[-1] - (trace("controller.plan.x")[-1], trace("controller.plan.y")[-1])
    return Responses(tuple(found), tuple(float(time_s[row]) for row in unexplained), math.hypot(*off_path))


def most_events(count: int, confidence: float = 0.95) -> float:
    """The largest mean number of events that could have left ``count`` of them, at ``confidence`` (Poisson, one-sided).

    For none it is -ln(1 - confidence): 3.0 at 95 %, the "rule of three".
    """
    low, high = 0.0, 10.0 + 10.0 * count
    for _ in range(60):  # halves down to rounding
        mean = 0.5 * (low + high)
        at_most = sum(math.exp(k * math.log(mean) - mean - math.lgamma(k + 1)) for k in range(count + 1))
        low, high = (mean, high) if at_most > 1.0 - confidence else (low, mean)
    return 0.5 * (low + high)


def _first(condition: NDArray[np.bool_]) -> int:
    """Index of the first true value; the length if there is none."""
    return int(np.argmax(condition)) if condition.any() else len(condition)


def _wrapped_deg(angle_rad: float) -> float:
    return math.degrees(math.remainder(angle_rad, 2.0 * math.pi))
