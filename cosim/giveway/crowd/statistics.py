"""Counts and percentiles with their 95 % intervals."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

__all__ = ["CONFIDENCE", "Estimate", "count_interval", "mean", "percentile", "rate_interval", "rate_upper_bound"]

CONFIDENCE = 0.95

Estimate = tuple[float, float, float]
"""A value and both ends of its interval."""


def count_interval(count: int, of: int) -> tuple[float, float]:
    """Clopper and Pearson's interval of the probability behind ``count`` of ``of``."""
    from scipy.special import betaincinv

    tail = 0.5 * (1.0 - CONFIDENCE)
    low = 0.0 if count == 0 else float(betaincinv(count, of - count + 1, tail))
    high = 1.0 if count == of else float(betaincinv(count + 1, of - count, 1.0 - tail))
    return low, high


def rate_upper_bound(count: int, duration: float) -> float:
    """Upper 95 % bound of a Poisson rate: ``count`` events in ``duration``, per unit of it."""
    from scipy.special import gammaincinv

    return float(gammaincinv(count + 1, CONFIDENCE)) / duration


def rate_interval(count: int, duration: float) -> Estimate:
    """A Poisson rate per unit of ``duration`` with its exact interval (Garwood); of none: 0 and its upper bound."""
    from scipy.special import gammaincinv

    if not count:
        return 0.0, 0.0, rate_upper_bound(0, duration)
    tail = 0.5 * (1.0 - CONFIDENCE)
    low, high = float(gammaincinv(count, tail)), float(gammaincinv(count + 1, 1.0 - tail))
    return count / duration, low / duration, high / duration


def percentile(values: Sequence[float], share: float) -> Estimate | None:
    """The ``share`` quantile, which is one of the values (infinite ones count), and its interval by order statistics.

    None if there are no values; an end that the sample does not determine is infinite (below: the smallest value).
    """
    from scipy.special import bdtr

    if not len(values):
        return None
    ranked = np.sort(np.asarray(values, dtype=np.float64))
    count, tail = len(ranked), 0.5 * (1.0 - CONFIDENCE)
    at = ranked[min(max(math.ceil(share * count), 1), count) - 1]
    below = bdtr(np.arange(count, dtype=np.float64), count, share)  # at most k values lie below the quantile
    low = int(np.searchsorted(below, tail, side="right"))  # P(at most low - 1 below) <= tail
    high = int(np.searchsorted(below, 1.0 - tail))
    return (
        float(at),
        float(ranked[max(low - 1, 0)]),
        float(ranked[high]) if high < count else math.inf,
    )


def mean(values: Sequence[float]) -> Estimate | None:
    """Mean and normal interval; None without values."""
    from scipy.special import ndtri

    if not len(values):
        return None
    found = np.asarray(values, dtype=np.float64)
    centre = float(found.mean())
    half = float(ndtri(0.5 + 0.5 * CONFIDENCE)) * float(found.std()) / math.sqrt(len(found))
    return centre, centre - half, centre + half
