"""The definitions by which a run of the crowd is judged, and their evaluation from its traces.

- Contact: the true force, of slider and push together, is above `TOUCH_N`. A pure moment counts as the force that makes
  it at the wheels' distance. Touches less than the library's contact gap apart are one contact: a plate bounces.
- Impulse: the integral of the true force over the contact, as a vector.
- Hit: a contact whose impulse passes `IMPULSE_NS`, unless it begins within the lock-out of a detection before it.
- Missed: no detection from the start of the contact to `PATIENCE_S` after its impulse passed `IMPULSE_NS`, or to its
  end, whichever is later. What the run's end cuts off is not judged.
- Delay: from the start of the contact to the detection.
- False: a detection without a contact in the `CAUSE_S` before it.
- Towards: in a reaction, the commanded velocity has a component against the push that caused it (for a false one, the
  last push there was). What the robot had when it decided counts only as far as it brakes more slowly than with
  `BRAKING_SHARE` of what the controller's limits leave: of the acceleration, of tipping, of its low-passes.
- Errors: of the detection's direction and contact point against the true impulse and the mean true contact point up to
  then, in the base frame; once at the decision, once `LATER_S` later.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.gravity import GRAVITY_MPS2
from giveway.crowd.population import start_value
from giveway.library.recorded import windows

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.robot.variables import Value

    Numbers = NDArray[np.float64]

__all__ = [
    "CAUSE_S",
    "IMPULSE_NS",
    "LATER_S",
    "LOCK_OUT_S",
    "PATIENCE_S",
    "RECORDED",
    "TOUCH_N",
    "Contact",
    "Judged",
    "Limits",
    "judge",
    "limits",
]

TOUCH_N = 0.5
IMPULSE_NS = 1.0
PATIENCE_S = 0.3
CAUSE_S = 0.1
LOCK_OUT_S = 0.3
LATER_S = 0.03
STILL_MPS = 5e-3  # a commanded speed that counts as none
BRAKING_SHARE = 0.5  # the change of velocity points aside where the motion does
ESCAPE, ESCAPE_LOW_PASSES = 2, 2  # admittance.kind; a ramp is late by the sum of their time constants
LEAST_TIP_MPS2 = 0.05
MODES_REACTING = (2, 3)

DETECTION = tuple(f"controller.detection.{name}" for name in ("direction", "point_x", "point_y"))
RECORDED = (
    *(f"testbed.truth.contact_{name}" for name in ("force", "force_x", "force_y", "base_x", "base_y")),
    *(f"testbed.truth.contact_impulse_{axis}" for axis in "xy"),
    "testbed.truth.theta",
    *(f"testbed.push.{name}" for name in ("force_x", "force_y", "point_x", "point_y")),
    "controller.detection.count",
    *DETECTION,
    "controller.mode",
    "controller.reference.vx",
    "controller.reference.vy",
)
"""What `judge` reads."""


@dataclass(frozen=True)
class Limits:
    """What `judge` needs besides traces.

    Attributes:
        acceleration_mps2: with which a reaction changes the velocity in whatever direction.
        late_s: how much later.
        arm_m: at which a moment counts as a force.
        moment: the run's push is a pure moment.
    """

    acceleration_mps2: float
    late_s: float
    arm_m: float
    moment: bool = False


def limits(
    controller: Mapping[str, Value], wheel_distance_m: float, moment: bool = False, robot: Path | None = None
) -> Limits:
    """Those of a controller with these parameters: of tipping as in c_core's gw_tip.c, towards a wheel."""

    def value(name: str) -> float:
        return float(controller.get(f"admittance.{name}", start_value(f"admittance.{name}", "controller", robot)))

    acceleration = value("acceleration_limit")
    height = value("tip_height")
    if height > 0.0:
        edge = 0.5 * wheel_distance_m - value("tip_offset") - value("tip_slope") * height
        acceleration = min(acceleration, max(value("tip_share") * GRAVITY_MPS2 * edge / height, LEAST_TIP_MPS2))
    late = ESCAPE_LOW_PASSES * value("smoothing") if value("kind") == ESCAPE else 0.0
    return Limits(acceleration, late, wheel_distance_m, moment)


@dataclass(frozen=True)
class Contact:
    """One contact of a run; times in s, NaN or None for what was not.

    Attributes:
        start_s, end_s: of the contact.
        impulse_ns: of all of it.
        passed_s: when it passed `IMPULSE_NS`.
        verdict: "noticed", "missed", "light" (never passes `IMPULSE_NS`), "locked" (begins within the lock-out) or
            "cut" (the run ends before it could be called missed).
        detection_s: time of the detection.
        delay_ms: from start to detection.
        mode: of the controller when it begins.
        direction_deg, place_mm: errors at the decision.
        later_direction_deg, later_place_mm: errors `LATER_S` later.
    """

    start_s: float
    end_s: float
    impulse_ns: float
    passed_s: float | None
    verdict: str
    mode: int
    detection_s: float | None = None
    delay_ms: float | None = None
    direction_deg: float | None = None
    place_mm: float | None = None
    later_direction_deg: float | None = None
    later_place_mm: float | None = None


@dataclass(frozen=True)
class Judged:
    """One run.

    Attributes:
        contacts: in the order of time.
        detections_s: times of all detections.
        false_s: times of the false ones.
        towards_s: times of the detections whose reactions went towards what hit the robot.
    """

    contacts: tuple[Contact, ...]
    detections_s: tuple[float, ...]
    false_s: tuple[float, ...]
    towards_s: tuple[float, ...]

    def record(self) -> dict[str, Any]:
        """As plain data."""
        return dataclasses.asdict(self)

    @classmethod
    def of(cls, record: Mapping[str, Any]) -> Judged:
        """The inverse of `record`."""
        contacts = tuple(Contact(**one) for one in record["contacts"])
        return cls(contacts, *(tuple(record[name]) for name in ("detections_s", "false_s", "towards_s")))


def judge(time_s: Numbers, traces: Mapping[str, NDArray[Any]], limits: Limits) -> Judged:
    """Judge a run from its times (n,) and its `RECORDED` traces, each of shape (n,)."""
    return _Run(time_s, traces, limits).judged()


class _Run:
    def __init__(self, time_s: Numbers, traces: Mapping[str, NDArray[Any]], limits: Limits) -> None:
        self._time, self._limits = time_s, limits
        self._step = float(time_s[1] - time_s[0])
        get = {name.partition(".")[2]: np.asarray(traces[name]) for name in RECORDED}
        self._get = get
        push = np.stack([get["push.force_x"], get["push.force_y"]])
        pushed = np.hypot(*push)
        self._scale = 1.0
        if limits.moment:
            arm = np.hypot(get["push.point_x"], get["push.point_y"])
            self._scale = float(np.max(arm)) / limits.arm_m
        self._force = get["truth.contact_force"] + self._scale * pushed
        # A push acts from its row to the next: its impulse is there one row later.
        by_push = self._scale * self._step * np.concatenate([np.zeros((2, 1)), np.cumsum(push, axis=1)[:, :-1]], axis=1)
        self._impulse = np.stack([get["truth.contact_impulse_x"], get["truth.contact_impulse_y"]]) + by_push
        self._weights = (get["truth.contact_force"], pushed)
        count = get["detection.count"]
        self._detected = np.flatnonzero(np.diff(count, prepend=count[:1]) > 0)

    def judged(self) -> Judged:
        touching = np.flatnonzero(self._force > TOUCH_N)
        spans = self._spans(touching)
        contacts = tuple(self._contact(first, last) for first, last in spans)
        false = [row for row in self._detected.tolist() if not self._caused(row, touching)]
        towards = [row for row in self._detected.tolist() if self._towards(row, spans)]
        return Judged(
            contacts, *(tuple(float(self._time[row]) for row in rows) for rows in (self._detected, false, towards))
        )

    def _spans(self, touching: NDArray[np.intp]) -> list[tuple[int, int]]:
        """First and last row of each contact."""
        if not len(touching):
            return []
        gap = round(windows().contact_gap_s / self._step)
        breaks = np.flatnonzero(np.diff(touching) >= gap)
        return list(zip(touching[np.r_[0, breaks + 1]].tolist(), touching[np.r_[breaks, -1]].tolist(), strict=True))

    def _caused(self, row: int, touching: NDArray[np.intp]) -> bool:
        last = int(np.searchsorted(touching, row, side="right")) - 1
        return last >= 0 and (row - touching[last]) * self._step <= CAUSE_S + 0.5 * self._step

    def _start_s(self, first: int) -> float:
        """When the force passed `TOUCH_N`, between two rows; a push begins in its row."""
        if first == 0 or self._weights[1][first] > 0.0:
            return float(self._time[first])
        before, after = self._force[first - 1], self._force[first]
        return float(self._time[first] - self._step * (after - TOUCH_N) / (after - before))

    def _since(self, first: int, row: int) -> Numbers:
        """Impulse from the start of a contact to a row."""
        return np.asarray(self._impulse[:, row] - self._impulse[:, max(first - 1, 0)])

    def _contact(self, first: int, last: int) -> Contact:
        start_s = self._start_s(first)
        over = min(last + 1, len(self._time) - 1)
        grown = np.hypot(*(self._impulse[:, first : over + 1] - self._impulse[:, [max(first - 1, 0)]]))
        passed = np.flatnonzero(grown >= IMPULSE_NS)
        end_s, end_of_run_s = float(self._time[over]), float(self._time[-1])
        passed_s = float(self._time[first + passed[0]]) if passed.size else None
        common = (start_s, end_s, float(grown[-1]), passed_s)
        mode = int(self._get["mode"][max(first - 1, 0)])
        before = self._detected[self._detected < first]
        if before.size and start_s - self._time[before[-1]] < LOCK_OUT_S:
            return Contact(*common, "locked", mode)
        deadline_s = end_s if passed_s is None else max(end_s, passed_s + PATIENCE_S)
        within = self._detected[(self._detected >= first) & (self._time[self._detected] <= deadline_s)]
        if passed_s is None:
            return Contact(*common, "light", mode)
        if not within.size:
            return Contact(*common, "cut" if deadline_s > end_of_run_s else "missed", mode)
        row = int(within[0])
        later = min(row + round(LATER_S / self._step), len(self._time) - 1)
        detection_s = float(self._time[row])
        timing = (detection_s, 1e3 * (detection_s - start_s))
        return Contact(
            *common, "noticed", mode, *timing, *self._errors(first, last, row), *self._errors(first, last, later)
        )

    def _errors(self, first: int, last: int, row: int) -> tuple[float | None, float | None]:
        """Of direction, deg, and place, mm, of what the controller says in ``row``."""
        if self._limits.moment:
            return None, None
        get, upto = self._get, min(row, last) + 1
        impulse = self._since(first, row)
        true_rad = math.atan2(impulse[1], impulse[0]) - float(get["truth.theta"][row])
        said_rad, said_x, said_y = (float(get[name.partition(".")[2]][row]) for name in DETECTION)
        direction = abs(math.remainder(said_rad - true_rad, 2.0 * math.pi))
        place = np.zeros(2)
        weight = 0.0
        for force, names in zip(self._weights, ("truth.contact_base", "push.point"), strict=True):
            span = force[first:upto]
            place += [float(span @ get[f"{names}_{axis}"][first:upto]) for axis in "xy"]
            weight += float(span.sum())
        if weight <= 0.0:
            return math.degrees(direction), None
        place /= weight
        return math.degrees(direction), 1e3 * math.hypot(said_x - place[0], said_y - place[1])

    def _towards(self, row: int, spans: Sequence[tuple[int, int]]) -> bool:
        """Whether the reaction to the detection in ``row`` goes against the push behind it."""
        begun = [span for span in spans if span[0] <= row]
        if not begun or self._limits.moment:
            return False
        first, last = begun[-1]
        push = self._since(first, min(row, last + 1))
        length = math.hypot(*push)
        if length == 0.0:
            return False
        get = self._get
        following = self._detected[self._detected > row]
        end = int(following[0]) if following.size else len(self._time)
        quiet = np.flatnonzero(~np.isin(get["mode"][row:end], MODES_REACTING))
        end = row + int(quiet[0]) if quiet.size else end
        if end <= row:
            return False
        speed = (push[0] * get["reference.vx"][row:end] + push[1] * get["reference.vy"][row:end]) / length
        since_s = np.maximum(self._time[row:end] - self._time[row] - self._limits.late_s, 0.0)
        brakes = BRAKING_SHARE * self._limits.acceleration_mps2 * since_s
        return bool((speed < np.minimum(0.0, speed[0] + brakes) - STILL_MPS).any())
