"""From the rows of a log to one sample per step of the controller; `Treatment` keeps what was done to them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.errors import FileError, UnknownNameError
from giveway.identification.roller_fit import check_step
from giveway.replay.source import Block, Source, place_error

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["RESAMPLING", "Gap", "Sampled", "Sampling", "Treatment"]

RESAMPLING = {
    "auto": "as they are where a row comes once per control period, else linear",
    "as-is": "every row is a step; the times must be those of the steps",
    "linear": "between the two rows beside a step",
    "hold": "the last row before a step",
    "rows": "every row is a step, whatever its time",
}
"""How rows become steps."""
ON_GRID = 0.02  # of a step: so near to the steps' times rows are taken as they are
OFF_GRID = 0.25
DECIDE_ROWS = 50  # enough for the usual time between rows
GAP_STEPS = 2.5  # rows further apart than so many usual ones have others missing between them
GAPS_KEPT = 1000
PAUSE_S = 60.0
LATEST_S = 2.0**31  # a ROS stamp counts seconds with a sign, in 32 bits


@dataclass(frozen=True)
class Gap:
    """Missing rows: ``start_s`` since the begin of the log; ``place`` of the row after them."""

    start_s: float
    length_s: float
    place: str


@dataclass
class Treatment:
    """What was found in the rows of a log and done about it."""

    rows: int = 0
    steps: int = 0
    duration_s: float = 0.0
    begin_s: float = 0.0
    way: str = "auto"
    usual_s: float = math.nan
    jitter_s: float = 0.0
    repeated: int = 0
    wraps: int = 0
    missing_steps: int = 0
    gap_count: int = 0
    gaps: list[Gap] = field(default_factory=list)
    not_finite: dict[str, int] = field(default_factory=dict)

    @property
    def stamps_from_s(self) -> float:
        """The time of the first row in files whose times cannot be negative, nor later than their seconds reach."""
        return self.begin_s if 0.0 <= self.begin_s <= LATEST_S else 0.0

    def add_gap(self, gap: Gap) -> None:
        self.gap_count += 1
        if len(self.gaps) < GAPS_KEPT:
            self.gaps.append(gap)


@dataclass(frozen=True)
class Sampled:
    """Samples of successive steps: ``values`` (n, columns), and whether there is one."""

    first: int
    values: NDArray[np.float64]
    present: NDArray[np.bool_]


class Sampling:
    """Rows in, steps out.

    Args:
        source: for messages.
        names: of the columns, the time first.
        held: columns that are not interpolated: counters, flags.
        periods: where they wrap, per column: 2 pi, 2^32; None: they do not.
        angles: columns without which a sample is missing.
        step_s: of the controller.
    """

    def __init__(
        self,
        source: Source,
        names: list[str],
        held: list[int],
        periods: dict[int, float],
        angles: list[int],
        step_s: float,
        way: str = "auto",
    ) -> None:
        if way not in RESAMPLING:
            raise UnknownNameError("--resample", way, RESAMPLING)
        self._source, self._names, self._held, self._periods = source, names, held, periods
        self._angles, self._step_s = angles, step_s
        self.did = Treatment(way=way)
        self._waiting: list[tuple[NDArray[np.float64], NDArray[np.int64]]] = []
        self._decided = False
        self._last: NDArray[np.float64] | None = None  # row, time since the begin
        self._finite: dict[int, float] = {}  # last value of a column that wraps, and its turns
        self._turns: dict[int, float] = {}
        self._newest: float | None = None
        self._next = 0
        self._longest_s = math.inf

    def feed(self, block: Block) -> Sampled | None:
        """The steps that are known after the rows of ``block``."""
        values, rows = self._in_order(block)
        if not self._decided:
            self._waiting.append((values, rows))
            if sum(len(part) for part, _ in self._waiting) < DECIDE_ROWS:
                return None
            values, rows = self._decide()
        return self._steps(values, rows)

    def finish(self) -> Sampled | None:
        """The last steps; FileError if there were not enough rows."""
        if not self._decided:
            values, rows = self._decide()
            return self._steps(values, rows)
        return None

    def _in_order(self, block: Block) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Rows whose time rises, and their numbers."""
        values, rows = block.values, block.first + np.arange(len(block.values))
        time_s = values[:, 0]
        bad = np.flatnonzero(~np.isfinite(time_s))
        if bad.size:
            raise place_error(
                self._source, int(rows[bad[0]]), f"{self._names[0]} is {time_s[bad[0]]}", "needed: a time"
            )
        if self.did.rows == 0:
            self.did.begin_s = float(time_s[0])
        self.did.rows += len(values)
        values = values.copy()
        values[:, 0] = time_s = time_s - self.did.begin_s
        before = np.concatenate(([-math.inf if self._newest is None else self._newest], time_s[:-1]))
        back = np.flatnonzero(time_s < before)
        if back.size:
            at = int(back[0])
            reason = f"time goes back from {before[at]:.9g} s to {time_s[at]:.9g} s (since the begin)"
            raise place_error(self._source, int(rows[at]), reason, "it has to rise")
        again = time_s == before
        self._newest = float(time_s[-1])
        if again.any():
            self.did.repeated += int(again.sum())
            values, rows = values[~again], rows[~again]
        return values, rows

    def _decide(self) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        values = np.concatenate([part for part, _ in self._waiting]) if self._waiting else np.zeros((0, 1))
        rows = np.concatenate([part for _, part in self._waiting]) if self._waiting else np.zeros(0, np.int64)
        self._waiting, self._decided = [], True
        if len(values) < 2:
            raise FileError(self._source.path, f"has {len(values)} rows with a time of their own", "a log needs two")
        steps = np.diff(values[:, 0])
        usual = self.did.usual_s = float(np.median(steps))
        if self.did.way != "rows":  # whatever their time
            check_step(self._source.path.name, usual)
        self._longest_s = GAP_STEPS * usual
        if self.did.way == "auto":
            place = values[:, 0] / self._step_s
            regular = np.abs(place - np.rint(place)).max() <= ON_GRID and abs(usual / self._step_s - 1.0) <= ON_GRID
            self.did.way = "as-is" if regular else "linear"
        return values, rows

    def _steps(self, values: NDArray[np.float64], rows: NDArray[np.int64]) -> Sampled | None:
        if not len(values):
            return None
        self._note_times(values[:, 0], rows)
        for column, name in enumerate(self._names):
            if count := int(np.count_nonzero(~np.isfinite(values[:, column]))):
                self.did.not_finite[name] = self.did.not_finite.get(name, 0) + count
        self._unwrap(values)
        if self.did.way == "rows":
            found = Sampled(self._next, values, np.ones(len(values), dtype=np.bool_))
            self._last = values[-1]
        elif self.did.way == "as-is":
            found = self._on_grid(values, rows)
        else:
            found = self._between(values)
        present = found.present & np.isfinite(found.values[:, self._angles]).all(axis=1)
        self.did.missing_steps += int(np.count_nonzero(~present))
        self._next += len(present)
        self.did.steps = self._next
        return Sampled(found.first, found.values, present)

    def _note_times(self, time_s: NDArray[np.float64], rows: NDArray[np.int64]) -> None:
        before = -math.inf if self._last is None else float(self._last[0])
        steps = np.diff(time_s, prepend=before) if math.isfinite(before) else np.diff(time_s)
        first = 0 if math.isfinite(before) else 1
        usual = self.did.usual_s
        near = steps[steps <= self._longest_s]
        if near.size:
            self.did.jitter_s = max(self.did.jitter_s, float(np.abs(near - usual).max()))
        for at in np.flatnonzero(steps > self._longest_s):
            row = int(at) + first
            start_s = float(time_s[row] - steps[at])
            if steps[at] > PAUSE_S:
                reason = f"{steps[at]:.3g} s since the row before"
                raise place_error(self._source, int(rows[row]), reason, "give the pieces as logs of their own")
            self.did.add_gap(Gap(start_s, float(steps[at]), self._source.place(int(rows[row]))))
        self.did.duration_s = float(time_s[-1])

    def _unwrap(self, values: NDArray[np.float64]) -> None:
        """Jumps of more than half a period are wraps; what is not finite is passed over."""
        for column, period in self._periods.items():
            good = np.flatnonzero(np.isfinite(values[:, column]))
            if not good.size:
                continue
            wrapped = values[good, column]
            before = self._finite.get(column, float(wrapped[0]))
            turns = np.cumsum(np.rint(np.diff(wrapped, prepend=before) / period))
            self.did.wraps += int(np.count_nonzero(np.diff(turns, prepend=self._turns.get(column, 0.0))))
            values[good, column] = wrapped - turns * period
            self._finite[column], self._turns[column] = float(values[good[-1], column]), float(turns[-1])

    def _on_grid(self, values: NDArray[np.float64], rows: NDArray[np.int64]) -> Sampled:
        place = values[:, 0] / self._step_s
        step = np.rint(place).astype(np.int64)
        taken = np.diff(step, prepend=self._next - 1) < 1
        off = np.flatnonzero((np.abs(place - step) > OFF_GRID) | taken)
        if off.size:
            at = int(off[0])
            reason = f"time {values[at, 0]:.9g} s (since the begin) is not that of the next step of {self._step_s:g} s"
            raise place_error(self._source, int(rows[at]), reason, "--resample linear takes such rows")
        count = int(step[-1]) + 1 - self._next
        if count == len(values):
            self._last = values[-1]
            return Sampled(self._next, values, np.ones(count, dtype=np.bool_))
        before = values[0] if self._last is None else self._last
        source = np.zeros(count, dtype=np.int64)  # 0: the row before this block
        present = np.zeros(count, dtype=np.bool_)
        source[step - self._next] = np.arange(1, len(values) + 1)
        present[step - self._next] = True
        found = np.concatenate([before[None, :], values])[np.maximum.accumulate(source)]
        self._last = values[-1]
        return Sampled(self._next, found, present)

    def _between(self, values: NDArray[np.float64]) -> Sampled:
        """Interpolated, or held, at the steps up to the last row."""
        known = values if self._last is None else np.concatenate([self._last[None, :], values])
        self._last = values[-1]
        time_s = known[:, 0]
        end = math.floor(float(time_s[-1]) / self._step_s * (1.0 + 1e-12) + 1e-9)
        steps = np.arange(self._next, max(end + 1, self._next))
        at_s = steps * self._step_s
        left = np.clip(np.searchsorted(time_s, at_s + 1e-9 * self._step_s, side="right") - 1, 0, len(known) - 1)
        right = np.minimum(left + 1, len(known) - 1)
        apart_s = time_s[right] - time_s[left]
        share = np.divide(at_s - time_s[left], apart_s, out=np.zeros(len(steps)), where=apart_s > 0.0)
        share = np.clip(share, 0.0, 1.0)
        found = known[left]
        if self.did.way == "linear":
            on_row = share * apart_s <= 1e-9 * self._step_s  # its own value, even beside one that is not finite
            mixed = found + share[:, None] * (known[right] - found)
            mixed[on_row] = found[on_row]
            mixed[:, self._held] = found[:, self._held]
            found = mixed
        present = (apart_s <= self._longest_s) | (share * apart_s <= 0.5 * self._step_s)
        return Sampled(self._next, found, present)
