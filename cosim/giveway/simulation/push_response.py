"""The response to the pushes of a run: noticed or not, false detections, the escape, and the return to the path."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.library.recorded import windows
from giveway.scenario.plan import TimedPush
from giveway.simulation.metrics import Metric

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

__all__ = ["TRACES", "PushResponse", "Responses", "most_events", "push_metrics", "responses", "responses_of"]

TRACKING, REACTING = 1, 2  # controller.mode

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
    """One push and the response to it.

    Attributes:
        push: the push.
        detected_s: time of its first detection in the run, s; None if it was missed.
        again_s: times of further detections that it caused, s: the robot mistook it for another push.
        felt_error_deg: felt minus true direction of the push at detection, deg.
        escape_m: travel of the base from the detection to the end of the reaction, m.
        escape_error_deg: direction of that travel minus that of the push, deg.
        back_s: time of the return to the path, s; None if not before the next detection or the end.
    """

    push: TimedPush
    detected_s: float | None = None
    again_s: tuple[float, ...] = ()
    felt_error_deg: float = math.nan
    escape_m: float = math.nan
    escape_error_deg: float = math.nan
    back_s: float | None = None


@dataclass(frozen=True)
class Responses:
    """All pushes of a run.

    Attributes:
        pushes: one each, in order.
        false_s: times of detections that no push caused, s: none acted in the 0.25 s before, as in the metric "false
            detections".
        off_path_m: distance of the base from its plan at the end of the run, m.
    """

    pushes: tuple[PushResponse, ...]
    false_s: tuple[float, ...]
    off_path_m: float

    @property
    def invented_s(self) -> tuple[float, ...]:
        """Times of all detections but the first of each push, s."""
        return tuple(sorted((*self.false_s, *(time_s for one in self.pushes for time_s in one.again_s))))

    @property
    def detected(self) -> int:
        """Pushes that were noticed."""
        return sum(one.detected_s is not None for one in self.pushes)

    @property
    def returned(self) -> int:
        """Pushes after which the robot returned to its path."""
        return sum(one.back_s is not None for one in self.pushes)


def responses(
    pushes: Sequence[TimedPush], time_s: NDArray[np.float64], trace: Callable[[str], NDArray[np.float64]]
) -> Responses:
    """Judge a run by its traces (`TRACES`, each of the shape of ``time_s``)."""
    rows = np.flatnonzero(np.diff(trace("controller.detection.count"), prepend=0) > 0)
    position = np.stack([trace("testbed.truth.x"), trace("testbed.truth.y")], axis=1)
    heading, felt = trace("testbed.truth.theta"), trace("controller.detection.direction")
    mode = trace("controller.mode")
    caused = _caused(pushes, time_s[rows])
    found = []
    for number, push in enumerate(pushes):
        mine = rows[caused == number]
        if not mine.size:
            found.append(PushResponse(push))
            continue
        row = int(mine[0])
        later = rows[rows > row]
        end = int(later[0]) if later.size else len(time_s)
        over = row + _first(mode[row:end] != REACTING)
        travel = position[min(over, len(position) - 1)] - position[row]
        back = row + _first(mode[row:end] == TRACKING)
        found.append(
            PushResponse(
                push,
                float(time_s[row]),
                tuple(time_s[mine[1:]].tolist()),
                _wrapped_deg(heading[row] + felt[row] - push.direction_rad),
                math.hypot(*travel),
                _wrapped_deg(math.atan2(travel[1], travel[0]) - push.direction_rad),
                float(time_s[back]) if back < end else None,
            )
        )
    off_path = position[-1] - (trace("controller.plan.x")[-1], trace("controller.plan.y")[-1])
    return Responses(tuple(found), tuple(time_s[rows[caused < 0]].tolist()), math.hypot(*off_path))


def _caused(pushes: Sequence[TimedPush], detected_s: NDArray[np.float64]) -> NDArray[np.int64]:
    """The push that caused each detection: the last one begun, if it ended less than 0.25 s before; otherwise -1."""
    found, cause_s = np.full(len(detected_s), -1), windows().cause_s
    for number, push in enumerate(pushes):
        found[(detected_s >= push.start_s) & (detected_s <= push.end_s + cause_s)] = number
    return found


def responses_of(traces: xarray.Dataset, manifest: Mapping[str, Any]) -> Responses:
    """`responses` to the scheduled pushes that ``manifest`` lists."""
    schedule = [TimedPush(**push) for push in manifest["scenario"].get("pushes", ())]  # older manifests have none
    return responses(schedule, traces["time"].values, lambda name: traces[name].values)


def push_metrics(
    response: PushResponse, traces: xarray.Dataset, parameters: Mapping[str, Mapping[str, Any]]
) -> tuple[Metric, ...]:
    """The estimate of a push compared with the truth, base frame; None if the push was not felt.

    "felt after" counts from the push's start, when its force begins to rise. Force and impulse are those of
    `metrics`: the filtered estimate at detection against the true force averaged over the same window, and the
    integral of the estimate from the push's start to the detection against the true impulse.
    """
    time_s = traces["time"].values

    def trace(name: str) -> NDArray[np.float64]:
        values: NDArray[np.float64] = traces[name].values
        return values

    push, felt = response.push, response.detected_s is not None
    row = int(np.searchsorted(time_s, response.detected_s or 0.0))
    step_s = float(time_s[1] - time_s[0])
    controller = parameters["controller"]
    window_s = float(controller["estimator.average_window"]) * float(controller["controller.period"])
    # Row k of the push acts from t_k on: the push up to a row is in the rows before it.
    acted = slice(max(0, row - max(1, round(window_s / step_s))), row)
    since = slice(int(np.searchsorted(time_s, push.start_s)), row)
    mean = [float(trace(f"testbed.push.force_{axis}")[acted].mean()) if felt else 0.0 for axis in "xy"]
    impulse = [float(trace(f"testbed.push.force_{axis}")[since].sum()) * step_s for axis in "xy"]
    estimated = [float(trace(f"controller.estimate.force_{axis}")[since].sum()) * step_s for axis in "xy"]
    heading = float(trace("testbed.truth.theta")[row])
    truth_deg = _wrapped_deg(push.direction_rad - heading)
    x, y = (float(trace(f"controller.detection.point_{axis}")[row]) for axis in "xy")
    off_mm = 1e3 * math.hypot(x - push.point_x_m, y - push.point_y_m)
    back_s = None if response.back_s is None else response.back_s - push.start_s

    def known(value: float | None) -> float | None:
        return value if felt else None

    return (
        Metric("felt after", known(1e3 * ((response.detected_s or 0.0) - push.start_s)), "ms", decimals=1),
        Metric("detections", float(len(response.again_s) + felt), "1", decimals=0),
        Metric("force direction", known(truth_deg + response.felt_error_deg), "deg", known(truth_deg), 1),
        Metric(
            "force at detection",
            known(float(trace("controller.estimate.force")[row])),
            "N",
            known(math.hypot(*mean)),
            1,
        ),
        Metric("impulse at detection", known(math.hypot(*estimated)), "N.s", known(math.hypot(*impulse))),
        Metric("contact point x", known(1e3 * x), "mm", known(1e3 * push.point_x_m), 1),
        Metric("contact point y", known(1e3 * y), "mm", known(1e3 * push.point_y_m), 1),
        Metric("location error", known(off_mm), "mm", known(0.0), 1),
        Metric("gives way by", known(response.escape_m), "m", decimals=3),
        Metric("back on the path after", known(back_s), "s", decimals=2),
    )


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
