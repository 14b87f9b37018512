"""What a replay shows, in bounded memory: detections, time in each mode, and envelopes of curves."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["MODES", "STATUSES", "Detection", "Envelope", "Span", "Story"]

MODES = ("taring", "tracking", "reacting", "settled", "rejoining", "stopped", "sensor fault")
STATUSES: Mapping[int, str] = {
    **{3: "not started", 4: "sensors missing", 5: "sensors stale", 6: "not finite", 7: "torque saturated"},
    **{8: "encoder jump", 9: "recovering", 10: "plan invalid", 11: "tare refused"},
}
BUCKETS = 512
DETECTIONS_KEPT = 10_000
SPANS_KEPT = 10_000


@dataclass(frozen=True)
class Detection:
    """A hit that the controller noticed: SI units, base frame; ``channel`` 1 fast, 2 slow."""

    number: int
    time_s: float
    force_x_n: float
    force_y_n: float
    torque_nm: float
    direction_deg: float
    point_x_mm: float
    point_y_mm: float
    sigma_mm: float
    on_outline: bool
    channel: int

    @property
    def force_n(self) -> float:
        return math.hypot(self.force_x_n, self.force_y_n)

    @property
    def words(self) -> str:
        return (
            f"t = {self.time_s:.3f} s: hit {self.number}: {self.force_n:.1f} N towards {self.direction_deg:.0f} deg, "
            f"at x = {self.point_x_mm:.0f}, y = {self.point_y_mm:.0f} mm (sigma {self.sigma_mm:.0f} mm)"
        )


@dataclass(frozen=True)
class Span:
    """A time in which a mode or status lasts."""

    value: int
    start_s: float
    end_s: float


class Envelope:
    """Least and largest value of curves per bucket of time; buckets double when there are too many."""

    def __init__(self, curves: int, step_s: float) -> None:
        self._step_s, self._width, self._filled = step_s, 1, 0
        self.least = np.full((2 * BUCKETS, curves), np.inf)
        self.largest = np.full((2 * BUCKETS, curves), -np.inf)

    def add(self, first: int, values: NDArray[np.float64]) -> None:
        """The next samples, (n, curves), from number ``first``; what is not finite is left out."""
        while (first + len(values) - 1) // self._width >= 2 * BUCKETS:
            self._double()
        bucket = np.arange(first, first + len(values)) // self._width
        starts = np.flatnonzero(np.diff(bucket, prepend=-1))
        at = bucket[starts]
        self.least[at] = np.fmin(self.least[at], np.fmin.reduceat(values, starts, axis=0))
        self.largest[at] = np.fmax(self.largest[at], np.fmax.reduceat(values, starts, axis=0))
        self._filled = int(at[-1]) + 1

    def _double(self) -> None:
        for values, reduce, empty in ((self.least, np.minimum, np.inf), (self.largest, np.maximum, -np.inf)):
            values[:BUCKETS] = reduce(values[0::2], values[1::2])
            values[BUCKETS:] = empty
        self._width *= 2

    @property
    def time_s(self) -> NDArray[np.float64]:
        """Middle of each bucket."""
        return np.asarray((np.arange(self._filled) + 0.5) * self._width * self._step_s, dtype=np.float64)

    def curve(self, index: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Least and largest per bucket; NaN where there was nothing."""
        least, largest = self.least[: self._filled, index], self.largest[: self._filled, index]
        there = least <= largest
        return np.where(there, least, np.nan), np.where(there, largest, np.nan)


@dataclass
class _Spans:
    """Successive values as spans."""

    kept: list[Span] = field(default_factory=list)
    total_s: dict[int, float] = field(default_factory=dict)
    count: int = 0
    _value: int | None = None
    _start_s: float = 0.0

    def add(self, first: int, values: NDArray[Any], step_s: float) -> None:
        changes = np.flatnonzero(np.diff(values, prepend=values[0] - 1 if self._value is None else self._value))
        for at in changes:
            self.end((first + int(at)) * step_s)
            self._value, self._start_s = int(values[at]), (first + int(at)) * step_s

    def end(self, time_s: float) -> None:
        if self._value is None:
            return
        self.count += 1
        self.total_s[self._value] = self.total_s.get(self._value, 0.0) + time_s - self._start_s
        if len(self.kept) < SPANS_KEPT:
            self.kept.append(Span(self._value, self._start_s, time_s))
        self._value = None


class Story:
    """Fed with the controller's outputs, step by step."""

    OUTPUTS: Sequence[str] = (
        *("detection.count", "detection.force_x", "detection.force_y", "detection.torque_z", "detection.direction"),
        *("detection.point_x", "detection.point_y", "detection.point_sigma", "detection.on_outline"),
        *("detection.channel", "mode", "status"),
    )

    def __init__(self, step_s: float) -> None:
        self._step_s = step_s
        self.detections: list[Detection] = []
        self.count = 0
        self.modes, self.statuses = _Spans(), _Spans()

    def add(self, first: int, outputs: Mapping[str, NDArray[Any]]) -> list[Detection]:
        """The next steps; the detections in them."""
        count = outputs["detection.count"]
        new = []
        for at in np.flatnonzero(np.diff(count, prepend=self.count)):
            new.append(self._detection(first, int(at), outputs))
        self.count = int(count[-1])
        self.detections += new[: DETECTIONS_KEPT - len(self.detections)]
        self.modes.add(first, outputs["mode"], self._step_s)
        self.statuses.add(first, outputs["status"], self._step_s)
        return new

    def _detection(self, first: int, at: int, outputs: Mapping[str, NDArray[Any]]) -> Detection:
        def value(name: str) -> float:
            return float(outputs[f"detection.{name}"][at])

        return Detection(
            number=int(outputs["detection.count"][at]),
            time_s=(first + at) * self._step_s,
            force_x_n=value("force_x"),
            force_y_n=value("force_y"),
            torque_nm=value("torque_z"),
            direction_deg=math.degrees(value("direction")),
            point_x_mm=1e3 * value("point_x"),
            point_y_mm=1e3 * value("point_y"),
            sigma_mm=1e3 * value("point_sigma"),
            on_outline=bool(value("on_outline")),
            channel=int(value("channel")),
        )

    def end(self, time_s: float) -> None:
        """The log is over."""
        self.modes.end(time_s)
        self.statuses.end(time_s)
