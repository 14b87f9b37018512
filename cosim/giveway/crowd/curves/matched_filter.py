"""Bank of matched filters (Kay, Fundamentals of Statistical Signal Processing II, 1998, 4.3 and 4.4).

In white noise the best linear detector of a known course s is the correlation with s; in coloured noise both are
whitened before. The courses: a force that has been rising like a quarter of a sine for each of `RISES_S`, which is all
of a hit that can have been seen when it is to be decided. Size and direction are unknown: the statistic is the root of
the sum of the squared normalised correlations of the three components, the largest of the bank.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from giveway.crowd.curves.noise import PERIOD_S, Noise

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["RISES_S", "correlated", "courses", "statistic"]

RISES_S = (0.006, 0.012, 0.025, 0.05, 0.1)


def courses() -> list[NDArray[np.float64]]:
    """The forces of the bank."""
    found = []
    for rise_s in RISES_S:
        ticks = round(rise_s / PERIOD_S)
        found.append(np.sin(0.5 * np.pi * (np.arange(ticks) + 1.0) / ticks))
    return found


def correlated(white: NDArray[np.float64], signature: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sum over components of squared normalised correlations with a signature (3, m) that ends now, shape (..., n)."""
    from scipy.signal import oaconvolve

    squares = np.zeros((*white.shape[:-2], white.shape[-1]))
    for index, course in enumerate(signature):
        filtered = oaconvolve(
            white[..., index, :], np.broadcast_to(course[::-1], (*white.shape[:-2], len(course))), axes=-1
        )
        squares += filtered[..., : white.shape[-1]] ** 2 / float(course @ course)
    return squares


def statistic(white: NDArray[np.float64], noise: Noise) -> NDArray[np.float64]:
    """Of whitened residuals (..., 3, n), shape (..., n)."""
    largest = np.zeros((*white.shape[:-2], white.shape[-1]))
    for force in courses():
        np.maximum(largest, correlated(white, noise.signature(force)), out=largest)
    return np.sqrt(largest)
