"""How probable it is that a limit is exceeded: plain sampling, and subset simulation for what is rare.

All that is uncertain is a function of independent standard normal numbers; a sample is a point of their space. Subset
simulation (Au and Beck 2001) goes towards the limit in levels: of a level's samples, the tenth that is nearest to the
limit begins Markov chains that stay as near, and their states are the next level's samples. A step of a chain is that
of Papaioannou et al. (2015) with one width for all directions: it keeps a normal point normal, whatever its dimension.

The interval comes from lineages. All samples of a level descend from some of the first ones; how unevenly the last
samples are shared among those ancestors is the estimate's variance (Lee and Whiteley 2018), the dependence within and
between the levels with it. `giveway bench --probability` shows the interval's coverage for limits whose probability is
known.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["CONFIDENCE", "SAMPLER", "Sampled", "binomial_interval", "level_size", "plain", "subset"]

SAMPLER = 1
"""Grows when the same seed gives other samples."""

CONFIDENCE = 0.95
STEPS = 10  # states of a chain: a tenth of the samples begins one
LEVELS = 4  # at most, after the first: down to 1e-4 by levels, and about 1e-6 within the last one
ACCEPTED = 0.44  # share of a chain's steps that the width of the steps aims at
WIDTH_MIN = 0.05
BLOCK = 65_536  # plain samples at once

Excess = Callable[["NDArray[np.float64]"], "NDArray[np.float64]"]
"""How far samples (n, d) are beyond the limit: above 0 it is exceeded; infinite: nothing is known but that."""

State = tuple["NDArray[np.float64]", "NDArray[np.float64]", "NDArray[np.int64]"]
"""Of all chains: points, excess, numbers of the samples."""


@dataclass(frozen=True)
class Sampled:
    """A probability.

    Attributes:
        value, low, high: of the probability, and the ends of its interval; 0 if the limit was never exceeded.
        samples: that were judged.
        levels: after the first.
        exceeded, plainly: in how many of the plain samples the limit is exceeded, and how many there are.
        beyond: numbers of the samples, in the order in which they were judged, that stand for those beyond the limit.
    """

    value: float
    low: float
    high: float
    samples: int
    levels: int
    exceeded: int
    plainly: int
    beyond: NDArray[np.int64]

    @property
    def agrees(self) -> bool:
        """The plain samples alone do not contradict it."""
        low, high = binomial_interval(self.exceeded, self.plainly)
        return self.low <= high and low <= self.high


def binomial_interval(count: int, of: int) -> tuple[float, float]:
    """The interval (Clopper and Pearson) of a probability that happened ``count`` times ``of`` so many."""
    from scipy.stats import beta

    tail = 0.5 * (1.0 - CONFIDENCE)
    low = float(beta.ppf(tail, count, of - count + 1)) if count else 0.0
    return low, float(beta.isf(tail, count + 1, of - count)) if count < of else 1.0


def plain(excess: Excess, dimensions: int, runs: int, seed: int) -> Sampled:
    """The probability from ``runs`` independent samples."""
    rng, beyond, done = np.random.default_rng(seed), [np.empty(0, dtype=np.int64)], 0
    while done < runs:
        size = min(BLOCK, runs - done)
        beyond.append(done + np.flatnonzero(excess(rng.standard_normal((size, dimensions))) > 0.0))
        done += size
    return _plain(np.concatenate(beyond), runs)


def _plain(beyond: NDArray[np.int64], samples: int) -> Sampled:
    count = len(beyond)
    return Sampled(count / samples, *binomial_interval(count, samples), samples, 0, count, samples, beyond)


def level_size(runs: int) -> int:
    """How many samples a level of `subset` has, so that it takes no more than ``runs``."""
    return STEPS * max(1, runs // (STEPS + LEVELS * (STEPS - 1)))


def subset(excess: Excess, dimensions: int, runs: int, seed: int) -> Sampled:
    """The probability from at most ``runs`` samples; from the first, plain ones alone if it is above a tenth."""
    rng = np.random.default_rng(seed)
    size = level_size(runs)
    chains = size // STEPS
    points = rng.standard_normal((size, dimensions))
    values, numbers, ancestors = excess(points), np.arange(size), np.arange(size)
    exceeded = int((values > 0.0).sum())
    if exceeded >= chains:
        return _plain(numbers[values > 0.0], size)
    probability, level, width, judged = 1.0, 0, 1.0, size
    while True:
        near = np.sort(values)[-chains]
        inside = np.flatnonzero(values >= near)  # more than the chains where values are equal
        if len(inside) == len(values):
            break  # nothing is nearer to the limit than anything else
        probability, level = probability * len(inside) / len(values), level + 1
        begin = inside if len(inside) == chains else np.sort(rng.choice(inside, chains, replace=False))
        state = (points[begin], values[begin], numbers[begin])
        ancestors, kept = ancestors[begin], [state]
        while len(kept) < STEPS:
            moved = math.sqrt(1.0 - width**2) * state[0] + width * rng.standard_normal((chains, dimensions))
            found = excess(moved)
            taken = found >= near
            state = (
                np.where(taken[:, None], moved, state[0]),
                np.where(taken, found, state[1]),
                np.where(taken, judged + np.arange(chains), state[2]),
            )
            judged += chains
            change = (float(taken.mean()) - ACCEPTED) / math.sqrt(len(kept))
            width = min(1.0, max(WIDTH_MIN, width * math.exp(change)))
            kept.append(state)
        points, values, numbers = (np.concatenate([one[part] for one in kept]) for part in range(3))
        ancestors = np.tile(ancestors, STEPS)
        if level == LEVELS or int((values > 0.0).sum()) >= len(values) / STEPS:
            break
    beyond = numbers[values > 0.0]
    if not len(beyond):
        # As if every chain were one sample: those of a chain are alike.
        _, high = binomial_interval(0, chains)
        return Sampled(0.0, 0.0, probability * high, judged, level, exceeded, size, beyond)
    value = probability * len(beyond) / len(values)
    return Sampled(
        value, *_interval(value, ancestors[values > 0.0], size, level), judged, level, exceeded, size, beyond
    )


def _interval(value: float, ancestors: NDArray[np.int64], size: int, level: int) -> tuple[float, float]:
    """Both ends, from the ancestors of the samples beyond the limit; a level has ``size`` samples."""
    from scipy.stats import t

    together = float(((np.bincount(ancestors) / len(ancestors)) ** 2).sum())
    variance = 1.0 - (size / (size - 1.0)) ** (level + 1) * (1.0 - together)
    variance = max(variance, 1.0 / len(ancestors) - 1.0 / size)  # never less than if they were independent
    quantile = float(t.isf(0.5 * (1.0 - CONFIDENCE), max(1.0, 1.0 / together - 1.0)))  # few ancestors tell less
    half = 0.5 * quantile * math.sqrt(variance)  # of the estimate's square root, which is nearly normal
    return value * max(0.0, 1.0 - half) ** 2, min(1.0, value * (1.0 + half) ** 2)
