"""First-order sensitivity indices from any sample: random balance designs (RBD-FAST, as SALib's ``rbd_fast``).

Sorted by one quantity, up and down again, an objective is a period of what this quantity does; the share of its first
harmonics in the variance is the index (Plischke 2010), without the bias that noise adds (Tissot and Prieur 2012).
SALib sorts every one of the samples that the interval is made of; here the order is kept, which takes a tenth of it.
"""

from __future__ import annotations

from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["first_order"]

HARMONICS = 10
RESAMPLES = 100
CONFIDENCE = 0.95


def first_order(
    points: NDArray[np.float64], values: NDArray[np.float64], seed: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Share of the variance of ``values`` (n,) that each column of ``points`` (n, d) explains alone.

    Returns the indices and the half widths of their 95 % intervals, shape (d,) each.
    """
    rng = np.random.default_rng(seed)
    width = NormalDist().inv_cdf(0.5 + CONFIDENCE / 2.0)
    count = len(values)
    indices, intervals = [], []
    for column in points.T:
        in_order = values[np.argsort(column, kind="stable")]
        indices.append(_index(in_order))
        resampled = []
        for _ in range(RESAMPLES):  # half of the data each time, as SALib does it
            times = np.bincount(rng.integers(0, count, count // 2), minlength=count)
            resampled.append(_index(np.repeat(in_order, times)))
        intervals.append(width * float(np.std(resampled, ddof=1)))
    return np.array(indices), np.array(intervals)


def _index(in_order: NDArray[np.float64]) -> float:
    """Index of the quantity by which the values (n,) are in order."""
    up_and_down = np.concatenate([in_order[::2], in_order[1::2][::-1]])
    power = np.abs(np.fft.rfft(up_and_down)[1 : HARMONICS + 1]) ** 2
    total = len(in_order) * float(((in_order - in_order.mean()) ** 2).sum())  # Parseval: of all harmonics, both sides
    share = 2.0 * float(power.sum()) / total if total > 0.0 else 0.0
    bias = 2.0 * HARMONICS / len(in_order)
    return share - bias / (1.0 - bias) * (1.0 - share)
