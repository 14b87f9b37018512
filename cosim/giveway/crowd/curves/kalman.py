"""Kalman filter (Kalman, J. Basic Eng. 82, 1960) as disturbance observer: the unknown force is a state that wanders.

States of each component: displacement q, rate v, and force d, with q'' = d/M, d wandering freely; q is measured with
white noise. The residual is M q'' (measured, as the encoders are in it) through low-passes, so the steady-state filter
from q to d, of third order, acts on the residual as its low-pass part: the double derivative cancels. The statistic is
the force in standard deviations that it has when nothing touches.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from giveway.crowd.curves.noise import PERIOD_S, Noise, second_difference_gain

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["WANDERING", "observed", "observer_poles", "statistic"]

WANDERING = (50.0**2 / 0.02, 50.0**2 / 0.02, 10.0**2 / 0.02)
"""How fast the disturbance wanders: 50 N and 10 N m within 20 ms, squared over time."""


def observer_poles(wandering: float, position_variance: float) -> NDArray[np.complex128]:
    """Poles of the steady-state filter of one component with mass 1."""
    from scipy.linalg import solve_discrete_are

    # States q, v h, d h^2: in their own units the equation is badly conditioned.
    a = np.array([[1.0, 1.0, 0.5], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]])
    c = np.array([[1.0, 0.0, 0.0]])
    wanders = np.diag([0.0, 0.0, wandering * PERIOD_S * PERIOD_S**4])
    noise = np.array([[position_variance]])
    covariance = solve_discrete_are(a.T, c.T, wanders, noise)
    correct = covariance @ c.T / (c @ covariance @ c.T + noise)
    return np.asarray(np.linalg.eigvals(a - a @ correct @ c), dtype=np.complex128)


def observed(passed: NDArray[np.float64], noise: Noise) -> NDArray[np.float64]:
    """The observer's wrench from high-passed residuals (..., 3, n)."""
    from scipy.signal import lfilter

    rows = []
    for index, wandering in enumerate(WANDERING):
        # With mass 1, position noise is what makes the residual's noise through the low-passes.
        variance = noise.variance[index] / second_difference_gain()
        denominator = np.real(np.poly(observer_poles(wandering, variance)))
        rows.append(lfilter([float(denominator.sum())], denominator, passed[..., index, :], axis=-1))
    return np.stack(rows, axis=-2)


def statistic(wrench: NDArray[np.float64], variance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Length of observed wrenches (..., 3, n) in standard deviations, shape (..., n)."""
    return np.asarray(np.sqrt(np.einsum("...in,i->...n", wrench**2, 1.0 / variance)))
