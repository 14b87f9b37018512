"""Cumulative sums (Page, Biometrika 41, 1954; Basseville and Nikiforov, Detection of Abrupt Changes, 1993, 2.2).

For a change of the mean by d along a unit vector u in white noise of variance 1 the logarithm of the likelihood ratio
of a sample x is d (u x - d/2), and g_k = max(0, g_{k-1} + u x_k - d/2) trips above a threshold. Directions are unknown:
the largest of a bank of u, evenly spread over the forces, and both signs of the moment.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["CHANGE", "page", "statistic"]

CHANGE = 1.0  # the d to be noticed, standard deviations of a whitened sample
DIRECTIONS = 8


def page(increments: NDArray[np.float64]) -> NDArray[np.float64]:
    """g_k = max(0, g_{k-1} + increment_k): the sum less its smallest value so far (Lindley), from g = 0."""
    total = np.cumsum(increments, axis=-1)
    return np.asarray(total - np.minimum(np.minimum.accumulate(total, axis=-1), 0.0))


def statistic(white: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of whitened residuals (..., 3, n), shape (..., n)."""
    angles = 2.0 * math.pi * np.arange(DIRECTIONS) / DIRECTIONS
    bank = [(math.cos(angle), math.sin(angle), 0.0) for angle in angles] + [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0)]
    largest = np.zeros((*white.shape[:-2], white.shape[-1]))
    for direction in bank:
        along = np.einsum("i,...in->...n", np.array(direction), white)
        np.maximum(largest, page(along - 0.5 * CHANGE), out=largest)
    return largest
