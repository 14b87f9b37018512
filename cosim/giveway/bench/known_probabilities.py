"""Subset simulation on limits whose probability is known exactly: does the interval hold it as often as it says?

Each limit is exceeded with the same probability. Beside it stands what a first-order approximation (FORM) says, which
knows nothing but the nearest point of the limit.
"""

from __future__ import annotations

import importlib
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.study.subset import subset

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["HEADER", "KNOWN", "PROBABILITY", "REPEATS", "Coverage", "KnownLimit", "cover", "measure", "openturns_rows"]

HEADER = (
    "limit", "numbers", "samples at most", "holds it", "interval ends at", "scatter", "bias", "FORM", "ms",
)  # fmt: skip
PROBABILITY = 1e-4
RUNS = (20_000, 50_000)
CURVATURE = 0.3
REPEATS = 200
OPENTURNS_SIZE = 434  # samples at once, as `subset` has with 20,000


@dataclass(frozen=True)
class KnownLimit:
    """A limit in the space of independent standard normal numbers.

    Attributes:
        name: in words.
        dimensions: how many numbers.
        excess: of samples (n, dimensions), above 0 beyond the limit.
        distance: of its nearest point from the origin.
    """

    name: str
    dimensions: int
    excess: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    distance: float

    @property
    def first_order(self) -> float:
        """What FORM says."""
        from scipy.stats import norm

        return float(norm.sf(self.distance))


def _plane(dimensions: int) -> KnownLimit:
    from scipy.stats import norm

    at = float(norm.isf(PROBABILITY))
    return KnownLimit("plane", dimensions, lambda x: x.sum(axis=1) / math.sqrt(dimensions) - at, at)


def _two_sides(dimensions: int) -> KnownLimit:
    from scipy.stats import norm

    at = float(norm.isf(0.5 * PROBABILITY))
    return KnownLimit("two sides", dimensions, lambda x: np.abs(x.sum(axis=1)) / math.sqrt(dimensions) - at, at)


def _sphere(dimensions: int) -> KnownLimit:
    from scipy.stats import chi2

    at = float(math.sqrt(chi2.isf(PROBABILITY, dimensions)))
    return KnownLimit("sphere", dimensions, lambda x: np.sqrt((x**2).sum(axis=1)) - at, at)


def _parabola(dimensions: int) -> KnownLimit:
    """Bent towards the origin in three directions."""
    from scipy.integrate import quad
    from scipy.optimize import brentq
    from scipy.stats import chi2, norm

    def beyond(at: float) -> float:
        found, _ = quad(lambda q: chi2.pdf(q, 3) * norm.sf(at - 0.5 * CURVATURE * q), 0.0, 80.0, limit=200)
        return float(found) - PROBABILITY

    at = float(brentq(beyond, 2.0, 12.0))
    nearest = min(at, math.sqrt(2.0 * at / CURVATURE - 1.0 / CURVATURE**2)) if at > 1.0 / CURVATURE else at
    return KnownLimit(
        "parabola", dimensions, lambda x: x[:, 0] + 0.5 * CURVATURE * (x[:, 1:4] ** 2).sum(axis=1) - at, nearest
    )


def _corner(dimensions: int) -> KnownLimit:
    """Any of as many planes as there are numbers."""
    from scipy.stats import norm

    at = float(norm.isf(-math.expm1(math.log1p(-PROBABILITY) / dimensions)))
    return KnownLimit("any of the planes", dimensions, lambda x: x.max(axis=1) - at, at)


KNOWN: tuple[Callable[[int], KnownLimit], ...] = (_plane, _two_sides, _sphere, _parabola, _corner)
DIMENSIONS = (5, 30)


@dataclass(frozen=True)
class Coverage:
    """Of many repeats on one known limit.

    Attributes:
        holds: share of the intervals that hold the probability.
        low, high: medians of both ends, as shares of the estimate above it.
        scatter, bias: standard deviation and mean error of the estimates, as shares of the probability.
        samples: most that a repeat took.
        own_ms: wall time of a repeat.
    """

    holds: float
    low: float
    high: float
    scatter: float
    bias: float
    samples: int
    own_ms: float


def cover(limit: KnownLimit, runs: int, repeats: int, first_seed: int = 0) -> Coverage:
    """What `subset` finds of ``limit`` with ``runs`` samples at most, with so many seeds."""
    began = time.perf_counter()
    found = [subset(limit.excess, limit.dimensions, runs, first_seed + seed) for seed in range(repeats)]
    wall_ms = 1e3 * (time.perf_counter() - began) / repeats
    ends = np.array([(one.value, one.low, one.high) for one in found])
    return _coverage(ends, max(one.samples for one in found), wall_ms)


def _coverage(ends: NDArray[np.float64], samples: int, wall_ms: float) -> Coverage:
    value, low, high = ends.T
    return Coverage(
        float(((low <= PROBABILITY) & (high >= PROBABILITY)).mean()),
        float(np.median(low / value) - 1.0),
        float(np.median(high / value) - 1.0),
        float(value.std(ddof=1) / PROBABILITY),
        float(value.mean() / PROBABILITY - 1.0),
        samples,
        wall_ms,
    )


def measure(repeats: int, say: Callable[[float], None]) -> Iterator[tuple[str, ...]]:
    """Rows below `HEADER`: every limit, in two dimensions, with few and with many samples."""
    limits = [make(dimensions) for make in KNOWN for dimensions in DIMENSIONS]
    for number, (limit, runs) in enumerate([(limit, runs) for runs in RUNS for limit in limits]):
        say(number / (len(RUNS) * len(limits)))
        yield _row(limit, runs, cover(limit, runs, repeats), "")
    say(1.0)


def _row(limit: KnownLimit, runs: int, found: Coverage, words: str) -> tuple[str, ...]:
    """A row below `HEADER`; ``words``: after the limit's name."""
    return (
        limit.name + words,
        f"{limit.dimensions}",
        f"{runs:,}",
        f"{found.holds:.3f}",
        f"{100.0 * found.low:+.0f} %, {100.0 * found.high:+.0f} %",
        f"{100.0 * found.scatter:.0f} %",
        f"{100.0 * found.bias:+.1f} %",
        f"{limit.first_order:.1e}",
        f"{found.own_ms:.0f}",
    )


def openturns_rows(repeats: int, say: Callable[[float], None]) -> Iterator[tuple[str, ...]]:
    """The same of OpenTURNS' subset sampling with as many samples per level; nothing if it is not installed."""
    try:
        openturns = importlib.import_module("openturns")
    except ModuleNotFoundError:
        return
    openturns.Log.Show(openturns.Log.NONE)
    limits = [make(dimensions) for make in (_plane, _parabola, _corner) for dimensions in DIMENSIONS]
    for number, limit in enumerate(limits):
        say(number / len(limits))
        began = time.perf_counter()
        told = [_openturns(openturns, limit, seed) for seed in range(1, repeats + 1)]
        wall_ms = 1e3 * (time.perf_counter() - began) / repeats
        known = np.array([one for one in told if one is not None])
        failed = repeats - len(known)
        words = ", OpenTURNS" + (f", {failed} of {repeats} raise an error" if failed else "")
        if len(known) > 1:
            yield _row(limit, RUNS[0], _coverage(known[:, :3], int(known[:, 3].max()), wall_ms), words)
        else:
            yield (limit.name + words, f"{limit.dimensions}", *[""] * (len(HEADER) - 2))
    say(1.0)


def _openturns(openturns: Any, limit: KnownLimit, seed: int) -> tuple[float, float, float, int] | None:
    openturns.RandomGenerator.SetSeed(seed)
    judged = openturns.PythonFunction(
        limit.dimensions,
        1,
        func=lambda point: [float(limit.excess(np.array([point]))[0])],
        func_sample=lambda points: limit.excess(np.asarray(points))[:, None],
    )
    vector = openturns.CompositeRandomVector(judged, openturns.RandomVector(openturns.Normal(limit.dimensions)))
    sampling = openturns.SubsetSampling(openturns.ThresholdEvent(vector, openturns.Greater(), 0.0))
    sampling.setMaximumOuterSampling(10)
    sampling.setBlockSize(OPENTURNS_SIZE)
    try:
        sampling.run()
    except TypeError:  # it says that a variance estimate must not be negative
        return None
    result = sampling.getResult()
    value, half = float(result.getProbabilityEstimate()), 0.5 * float(result.getConfidenceLength(0.95))
    return value, value - half, value + half, int(judged.getEvaluationCallsNumber())
