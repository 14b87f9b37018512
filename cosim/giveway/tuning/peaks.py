"""How often a correlated statistic goes above a level: peaks over a threshold, their tail, and how sure that is.

Peaks less than `APART_S` apart are one. Those above a base level are counted, and their heights follow a generalised
Pareto distribution, whose shape is taken to be near that of an exponential (`SHAPE_SIGMA`). Peaks come in bunches: what
the counts of blocks scatter more than independent ones would is what the peaks are worth less.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["CONFIDENCE", "EXTRAPOLATION", "Peaks", "Tail", "hours_to_count", "joined", "peaks_of"]

APART_S = 1.0
BLOCK_S = 30.0  # longer than what makes peaks come in bunches: a start, a stop, a turn
CONFIDENCE = 0.95
MOST_PEAKS = 60  # above the base level: more of them would be no tail
LEAST_PEAKS = 8
SHAPE_SIGMA = 0.15
SHAPES = np.linspace(-0.45, 0.45, 61)
NO_SHAPE = 1e-6
SCALES = np.geomspace(0.2, 5.0, 121)  # times the mean excess
SAMPLES = 5000
SEED = 20261123
EXTRAPOLATION = 10.0  # of the hours: rarer events than one in so many times the hours are promised by nobody


@dataclass(frozen=True)
class Peaks:
    """Peaks of one statistic.

    Attributes:
        times_s: of each peak, without what does not count; of several logs one after the other.
        heights: of each.
        alarmed: it raised an alarm, which cut it off: it would have been at least as high.
        duration_s: in which they were found.
    """

    times_s: NDArray[np.float64]
    heights: NDArray[np.float64]
    alarmed: NDArray[np.bool_]
    duration_s: float

    @property
    def hours(self) -> float:
        return self.duration_s / 3600.0

    def above(self, level: float) -> int:
        """Peaks above ``level``."""
        return int(np.count_nonzero(self.heights > level))


def peaks_of(
    statistic: NDArray[np.float64], counts: NDArray[np.bool_], alarms: NDArray[np.bool_], step_s: float
) -> Peaks:
    """The peaks of a series where ``counts`` is true, `APART_S` or more apart; ``alarms``: where one is raised."""
    width = max(1, round(APART_S / step_s))
    shown = np.where(counts, statistic, 0.0)
    begins = np.arange(0, len(counts), width)
    blocks, ended = (np.logical_or.reduceat(one, begins) for one in (counts, alarms & counts))
    tops = np.maximum.reduceat(shown, begins)
    at: NDArray[np.float64] = step_s * np.cumsum(counts).astype(np.float64)[::width]
    # The top of a block is a peak if no neighbour's is higher: two of one bunch are never counted twice.
    padded = np.concatenate(([-1.0], tops, [-1.0]))
    highest = (tops >= padded[:-2]) & (tops > padded[2:]) & blocks & (tops > 0.0)
    return Peaks(at[highest], tops[highest], ended[highest], float(np.count_nonzero(counts)) * step_s)


def joined(found: list[Peaks]) -> Peaks:
    """The peaks of several logs, one after the other."""
    begin_s, times = 0.0, []
    for one in found:
        times.append(begin_s + one.times_s)
        begin_s += one.duration_s
    return Peaks(
        np.concatenate([np.zeros(0), *times]),
        np.concatenate([np.zeros(0), *(one.heights for one in found)]),
        np.concatenate([np.zeros(0, dtype=np.bool_), *(one.alarmed for one in found)]),
        sum(one.duration_s for one in found),
    )


@dataclass(frozen=True)
class Tail:
    """The rare peaks of `Peaks`.

    Attributes:
        peaks: all of them.
    """

    peaks: Peaks

    @cached_property
    def base(self) -> float:
        """Peaks above it are the tail."""
        ranked = np.sort(self.peaks.heights)[::-1]
        most = min(MOST_PEAKS, len(ranked) // 2)
        return float(ranked[most]) if most < len(ranked) and len(ranked) else 0.0

    @cached_property
    def excesses(self) -> NDArray[np.float64]:
        return self.peaks.heights[self.peaks.heights > self.base] - self.base

    @cached_property
    def _cut(self) -> NDArray[np.bool_]:
        return self.peaks.alarmed[self.peaks.heights > self.base]

    @property
    def enough(self) -> bool:
        """There are peaks enough to fit a tail to."""
        return len(self.excesses) >= LEAST_PEAKS

    @cached_property
    def bunching(self) -> float:
        """Variance over mean of the tail's peaks in blocks of `BLOCK_S`, at least 1."""
        number = max(1, math.floor(self.peaks.duration_s / BLOCK_S))
        times = self.peaks.times_s[self.peaks.heights > self.base]
        if number < 2 or not len(times):
            return 1.0
        counts = np.bincount(np.minimum((times / BLOCK_S).astype(np.int64), number - 1), minlength=number)
        return max(1.0, float(counts.var(ddof=1) / counts.mean()))

    @cached_property
    def _drawn(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Shape, scale and peaks per hour above the base: what the logs leave possible, `SAMPLES` times."""
        rng = np.random.default_rng(SEED)
        worth = 1.0 / self.bunching
        count = len(self.excesses)
        rate = rng.gamma(worth * count + 0.5, size=SAMPLES) / (worth * self.peaks.hours)
        mean = float(self.excesses.mean())
        shape, scale = (grid.ravel() for grid in np.meshgrid(SHAPES, SCALES * mean, indexing="ij"))
        shape = np.where(np.abs(shape) < NO_SHAPE, NO_SHAPE, shape)  # the exponential is a limit
        inside = 1.0 + shape[:, None] * self.excesses[None, :] / scale[:, None]
        with np.errstate(invalid="ignore", divide="ignore"):
            # The density of a peak, and the probability of at least this height where an alarm cut it off.
            power = np.where(self._cut[None, :], 1.0 / shape[:, None], 1.0 + 1.0 / shape[:, None])
            each = np.where(inside > 0.0, -power * np.log(inside), -np.inf)
        whole = count - np.count_nonzero(self._cut)
        likelihood = worth * (each.sum(axis=1) - whole * np.log(scale)) - 0.5 * (shape / SHAPE_SIGMA) ** 2
        weight = np.exp(likelihood - likelihood.max())
        chosen = rng.choice(len(weight), size=SAMPLES, p=weight / weight.sum())
        return shape[chosen], scale[chosen], rate

    def rates(self, level: float) -> NDArray[np.float64]:
        """Peaks per hour above ``level``, each as possible as the others; ``level`` not below the base."""
        shape, scale, rate = self._drawn
        inside = np.maximum(1.0 + shape * max(level - self.base, 0.0) / scale, 0.0)
        with np.errstate(divide="ignore"):
            return np.asarray(rate * np.where(inside > 0.0, inside ** (-1.0 / shape), 0.0))

    def rate(self, level: float) -> tuple[float, float, float]:
        """Peaks per hour above ``level``: the median, and both ends of the interval of `CONFIDENCE`."""
        found = self.rates(level)
        tail = 0.5 * (1.0 - CONFIDENCE)
        middle, low, high = np.quantile(found, (0.5, tail, 1.0 - tail))
        return float(middle), float(low), float(high)

    def upper(self, level: float) -> float:
        """Peaks per hour above ``level`` with `CONFIDENCE` at most; never less than the hours may be asked for."""
        return max(float(np.quantile(self.rates(level), CONFIDENCE)), 1.0 / (EXTRAPOLATION * self.peaks.hours))

    def level(self, rate_per_hour: float, share: float = CONFIDENCE) -> float:
        """The level above which peaks are rarer than ``rate_per_hour``, with the certainty ``share``."""
        low, high = self.base, self.base + 200.0 * float(self.excesses.mean())
        for _ in range(40):
            middle = 0.5 * (low + high)
            if float(np.quantile(self.rates(middle), share)) > rate_per_hour:
                low = middle
            else:
                high = middle
        return high

    def counts(self, level: float, hours: float) -> tuple[int, int]:
        """Between how many peaks above ``level`` other ``hours`` have, with `CONFIDENCE`."""
        rng = np.random.default_rng(SEED + 1)
        spread = self.rates(level) * hours
        if self.bunching > 1.0:  # bunches: the counts scatter more than those of independent peaks
            spread = rng.gamma(spread / (self.bunching - 1.0) + 1e-12, self.bunching - 1.0)
        found = rng.poisson(spread)
        tail = 0.5 * (1.0 - CONFIDENCE)
        low, high = np.quantile(found, (tail, 1.0 - tail), method="inverted_cdf")
        return int(low), int(high)


def hours_to_count(rate_per_hour: float) -> float:
    """Hours that show the rate by counting alone: no event in them bounds it with `CONFIDENCE`."""
    return -math.log(1.0 - CONFIDENCE) / rate_per_hour
