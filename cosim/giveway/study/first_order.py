"""First-order sensitivity indices from any sample: random balance designs (RBD-FAST, as SALib's ``rbd_fast``).

Sorted by one quantity, up and down again, an objective is a period of what this quantity does; the share of its first
harmonics in the variance is the index (Plischke 2010), without the bias that noise adds (Tissot and Prieur 2012).
SALib sorts every one of the samples that the interval is made of; here the order is kept, which takes a tenth of it.
"""

from __future__ import annotations

import functools
from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["first_order"]

HARMONICS = 10
RESAMPLES = 100
BLOCK = 65_536  # values that are transformed at once
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
    power = np.abs(_harmonics(up_and_down)) ** 2
    total = len(in_order) * float(((in_order - in_order.mean()) ** 2).sum())  # Parseval: of all harmonics, both sides
    share = 2.0 * float(power.sum()) / total if total > 0.0 else 0.0
    bias = 2.0 * HARMONICS / len(in_order)
    return share - bias / (1.0 - bias) * (1.0 - share)


def _harmonics(series: NDArray[np.float64]) -> NDArray[np.complex128]:
    """The first ones of its Fourier transform: a product per block is faster than a transform of all."""
    count, found = len(series), np.zeros(HARMONICS, dtype=complex)
    waves, orders = _waves(count), np.arange(1, HARMONICS + 1)
    for start in range(0, count, BLOCK):
        block = series[start : start + BLOCK]
        cosine, sine = (waves[:, : len(block)] @ block).reshape(2, HARMONICS)
        found += (cosine - 1j * sine) * np.exp(-2j * np.pi * orders * start / count)
    return found


@functools.lru_cache(maxsize=2)  # all values, and half of them
def _waves(count: int) -> NDArray[np.float64]:
    """Cosines, then sines, of the harmonics at the first points of ``count``."""
    angle = 2.0 * np.pi / count * np.arange(1, HARMONICS + 1)[:, None] * np.arange(min(count, BLOCK))
    return np.concatenate([np.cos(angle), np.sin(angle)])
