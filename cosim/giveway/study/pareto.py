"""Which designs no other one beats, and in which order they are worth a look."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["front", "scores"]

BLOCK = 64  # rows that are compared with all later ones at once


def front(costs: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which rows of ``costs`` (n, objectives; less is better) no other row beats: shape (n,).

    A row beats another if it is nowhere worse and somewhere better; rows with a NaN beat nothing and are beaten.
    Equal rows are all kept.
    """
    found = np.zeros(len(costs), dtype=bool)
    known = np.flatnonzero(~np.isnan(costs).any(axis=1))
    if not known.size or not costs.shape[1]:
        found[known] = True
        return found
    known = known[np.lexsort(costs[known].T[::-1])]  # nothing is beaten by what comes later
    ordered = costs[known]
    different = np.append(True, (ordered[1:] != ordered[:-1]).any(axis=1))
    on_front = _front_of_different(ordered[different])
    found[known] = on_front[np.cumsum(different) - 1]
    return found


def _front_of_different(rows: NDArray[np.float64]) -> NDArray[np.bool_]:
    """The same of rows that are all different and in lexicographic order.

    Then a row is beaten by an earlier one that is not larger anywhere but, at most, in the first column.
    """
    found = np.ones(len(rows), dtype=bool)
    columns = np.ascontiguousarray(rows.T[1:])
    if len(columns) == 0:
        found[1:] = False
        return found
    if len(columns) == 1:
        found[1:] = columns[0, 1:] < np.minimum.accumulate(columns[0])[:-1]
        return found
    left = np.arange(len(rows))
    while left.size:
        block, left = left[:BLOCK], left[BLOCK:]
        beaten = np.tril(_not_larger(columns[:, block], columns[:, block]).T, -1).any(axis=1)
        beaten_later = _not_larger(columns[:, block[~beaten]], columns[:, left]).any(axis=0)
        found[block[beaten]] = found[left[beaten_later]] = False
        left = left[~beaten_later]
    return found


def _not_larger(one: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which columns of ``one`` (k, m) are nowhere larger than which of ``other`` (k, n): shape (m, n)."""
    found: NDArray[np.bool_] = one[0][:, None] <= other[0]
    for a, b in zip(one[1:], other[1:], strict=True):
        found &= a[:, None] <= b
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
