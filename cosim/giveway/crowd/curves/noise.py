"""What textbook detectors stand behind: a high-pass, and filters that make the residual's noise white.

A residual is the wrench of the balance of forces: force x and y, moment; arrays of shape (..., 3, n).
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.float64]

__all__ = ["CUTOFF_RADPS", "HIGH_PASS_S", "PERIOD_S", "Noise", "high_passed", "learned", "low_passed", "restarted"]

PERIOD_S = 1e-3  # of the controller
CUTOFF_RADPS = 200.0  # corner of the estimator's two low-passes, estimator.rate_cutoff
HIGH_PASS_S = 0.3
ORDER = 32  # of the whitening filter
ZERO_S = 0.1  # mean that is the new zero, as estimator.retare_ticks


def high_passed(values: Numbers) -> Numbers:
    """``values`` less what a low-pass of `HIGH_PASS_S` follows: y_k = a y_{k-1} + x_k - x_{k-1}, from rest."""
    from scipy.signal import lfilter

    keep = math.exp(-PERIOD_S / HIGH_PASS_S)
    return np.asarray(lfilter([1.0, -1.0], [1.0, -keep], values, axis=-1))


def restarted(passed: Numbers, at: Numbers | NDArray[np.intp] | list[int]) -> Numbers:
    """High-passed values (3, n) whose baseline is set anew in the rows ``at``, to the mean of the last `ZERO_S`.

    The high-pass is linear: a step of its input adds a decaying step of its output.
    """
    found = passed.copy()
    rows = round(ZERO_S / PERIOD_S)
    decay = np.exp(-PERIOD_S / HIGH_PASS_S * np.arange(passed.shape[-1]))
    for row in np.asarray(at, dtype=np.intp).tolist():
        zero = found[:, max(row - rows, 0) : max(row, 1)].mean(axis=-1)
        found[:, row:] -= zero[:, None] * decay[: passed.shape[-1] - row]
    return found


def low_passed(values: Numbers) -> Numbers:
    """The estimator's two equal low-passes in a row."""
    from scipy.signal import lfilter

    keep = math.exp(-CUTOFF_RADPS * PERIOD_S)
    once = lfilter([1.0 - keep], [1.0, -keep], values, axis=-1)
    return np.asarray(lfilter([1.0 - keep], [1.0, -keep], once, axis=-1))


@dataclass(frozen=True)
class Noise:
    """Of the high-passed residual in one situation.

    Attributes:
        variance: of each component, (3,).
        whitening: coefficients of each component's whitening filter over its innovation, (3, `ORDER` + 1).
    """

    variance: tuple[float, ...]
    whitening: tuple[tuple[float, ...], ...]

    def whitened(self, passed: Numbers) -> Numbers:
        """High-passed residuals as white noise of variance 1, plus what a contact leaves of itself."""
        from scipy.signal import lfilter

        rows = [lfilter(self.whitening[index], [1.0], passed[..., index, :], axis=-1) for index in range(3)]
        return np.stack(rows, axis=-2)

    def signature(self, force: Numbers) -> Numbers:
        """What a force (n,) through the estimator leaves behind high-pass and whitening, in each component, (3, n)."""
        return self.whitened(np.broadcast_to(high_passed(low_passed(force)), (3, len(force))))


def learned(passed: list[Numbers]) -> Noise:
    """The noise of quiet high-passed pieces (3, n) by Yule and Walker's equations; both forces are one process."""
    from scipy.linalg import solve_toeplitz

    products = np.zeros((3, ORDER + 1))
    count = 0
    for piece in passed:
        if piece.shape[-1] <= ORDER:
            continue
        count += piece.shape[-1]
        for lag in range(ORDER + 1):
            products[:, lag] += np.einsum("in,in->i", piece[:, lag:], piece[:, : piece.shape[-1] - lag])
    if not count:
        raise ValueError("no quiet piece is long enough")
    products /= count
    products[:2] = products[:2].mean(axis=0)
    whitening = []
    for r in products:
        r = r.copy()
        r[0] *= 1.0 + 1e-9
        coefficients = solve_toeplitz(r[:-1], r[1:])
        innovation = math.sqrt(max(float(r[0] - coefficients @ r[1:]), 1e-300))
        whitening.append(tuple(np.concatenate([[1.0], -coefficients]) / innovation))
    return Noise(tuple(map(float, products[:, 0])), tuple(whitening))


@functools.cache
def second_difference_gain() -> float:
    """Variance of the residual's force over mass^2 and variance of a position's white noise, 1/s^4."""
    impulse = np.zeros(400)
    impulse[2] = 1.0
    response = low_passed(np.diff(impulse, 2) / PERIOD_S**2)
    return float(response @ response)
