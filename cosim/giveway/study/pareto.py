"""Which designs no other one beats, and in which order they are worth a look."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["front", "scores"]


def front(costs: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which rows of ``costs`` (n, objectives; less is better) no other row beats: shape (n,).

    A row beats another if it is nowhere worse and somewhere better; rows with a NaN beat nothing and are beaten.
    Equal rows are all kept.
    """
    found = np.zeros(len(costs), dtype=bool)
    left = np.flatnonzero(~np.isnan(costs).any(axis=1))
    left = left[np.lexsort(costs[left].T[::-1])]  # nothing is beaten by what comes later
    while left.size:
        first, rest = left[0], left[1:]
        found[first] = True
        better = (costs[rest] < costs[first]).any(axis=1)
        same = (costs[rest] == costs[first]).all(axis=1)
        found[rest[same]] = True
        left = rest[better]
    return found


def scores(
    costs: NDArray[np.float64], on_front: NDArray[np.bool_], weights: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Distance of each row from the best of all, in widths of the front, shape (n,); less is better, NaN stays NaN."""
    if not on_front.any():
        return np.full(len(costs), np.nan)
    best, worst = costs[on_front].min(axis=0), costs[on_front].max(axis=0)
    width = np.where(worst > best, worst - best, 1.0)
    return np.asarray(np.sqrt((weights * ((costs - best) / width) ** 2).sum(axis=1)))
