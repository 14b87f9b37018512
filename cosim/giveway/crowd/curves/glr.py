"""Generalised likelihood ratio of a step of unknown onset and size (Willsky and Jones, IEEE Trans. Autom. Control 21,
1976; with a window as Lai, J. R. Stat. Soc. B 57, 1995).

For an onset m ticks ago the best size of the step is found by least squares; twice the logarithm of the likelihood
ratio is then the squared normalised correlation with the step's signature, summed over the components. The statistic is
the root of the largest over the onsets in `AGES_S`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from giveway.crowd.curves.matched_filter import correlated
from giveway.crowd.curves.noise import PERIOD_S, Noise

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["AGES_S", "statistic"]

AGES_S = (0.004, 0.006, 0.01, 0.016, 0.025, 0.04, 0.063, 0.1)


def statistic(white: NDArray[np.float64], noise: Noise) -> NDArray[np.float64]:
    """Of whitened residuals (..., 3, n), shape (..., n)."""
    largest = np.zeros((*white.shape[:-2], white.shape[-1]))
    for age_s in AGES_S:
        step = np.ones(round(age_s / PERIOD_S))
        np.maximum(largest, correlated(white, noise.signature(step)), out=largest)
    return np.sqrt(largest)
