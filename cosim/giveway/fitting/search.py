"""The fit: the box of parameters is sampled evenly, then the best points are improved by least squares.

Minimised is the sum of squares of the quantities' deviations in tolerances and the parameters' deviations from their
estimates in factors. Nothing is random: the same code gives the same values.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.checks import whole
from giveway.fitting.parameters import FREE, from_unit, limits, rounded, to_unit
from giveway.fitting.quantities import QUANTITIES, Bench

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["STAGES", "Fit", "Progress", "evaluate", "search"]

STAGES = ("sampling the box", "improving the best samples", "judging")
SAMPLES = 1024  # of the box; best 2^n, which a Sobol sequence spreads evenly
STARTS = 8  # best samples that are improved
STEPS = 40  # of an improvement, at most
CHUNK = 32  # samples between two reports
DIFFERENCE = 0.05  # step of the differences, in factors: far above the runs' own rounding
SEEDS = tuple(range(1, 21))

Progress = Callable[[str, float], None]
"""Called with the stage and its finished share, 0 to 1."""


@dataclass(frozen=True)
class Fit:
    """A set of values with its quality and uncertainty.

    Attributes:
        values: by path of the robot file.
        quantities: shape (quantities,), without noise.
        spread: shape (2, quantities), lowest and highest over the seeds of the noise.
        jacobian: of the quantities' residuals by the parameters' deviations, shape (quantities, parameters).
    """

    values: dict[str, float]
    quantities: NDArray[np.float64]
    spread: NDArray[np.float64]
    jacobian: NDArray[np.float64]

    @property
    def residuals(self) -> NDArray[np.float64]:
        """Deviations of the quantities from their aims, in tolerances."""
        return _residuals(self.quantities)

    @property
    def cost(self) -> float:
        """What was minimised."""
        return float(np.sum(self.residuals**2) + np.sum(to_unit(self.values) ** 2))

    @property
    def singular_values(self) -> NDArray[np.float64]:
        """Singular values of the Jacobian: parameter combinations with values above 1 are determined by the paper's
        numbers."""
        return np.asarray(np.linalg.svd(self.jacobian, compute_uv=False))

    @property
    def uncertainty(self) -> NDArray[np.float64]:
        """Standard deviation of each parameter in factors, if tolerances and factors are standard deviations."""
        information = self.jacobian.T @ self.jacobian + np.eye(len(FREE))
        return np.asarray(np.sqrt(np.diag(np.linalg.inv(information))))


def evaluate(bench: Bench, values: dict[str, float], seeds: tuple[int, ...] = SEEDS) -> Fit:
    """Evaluate ``values`` without changing them."""
    noisy = bench.seeds(values, seeds)
    return Fit(
        values,
        bench.measure([values])[0],
        np.stack([noisy.min(axis=0), noisy.max(axis=0)]),
        _jacobian(bench, to_unit(values)),
    )


def search(bench: Bench, progress: Progress, samples: int = SAMPLES) -> Fit:
    """The best values, rounded for a robot file, and evaluated."""
    from scipy.optimize import least_squares

    whole("samples", samples, 1, 2**16)
    starts = min(STARTS, samples)
    lower, upper = limits()
    best: tuple[float, NDArray[np.float64]] | None = None
    for number, start in enumerate(_promising(bench, progress, samples, starts)):
        progress(STAGES[1], number / starts)
        found = least_squares(
            lambda point: _all_residuals(bench.measure([from_unit(point)])[0], point),
            start,
            jac=lambda point: np.concatenate([_jacobian(bench, point), np.eye(len(FREE))]),
            bounds=(lower, upper),
            max_nfev=STEPS,
            xtol=1e-3,  # a thousandth of a factor: finer than the values are rounded
        )
        if best is None or found.cost < best[0]:
            best = float(found.cost), found.x
    assert best is not None
    progress(STAGES[2], 0.0)
    return evaluate(bench, rounded(from_unit(best[1])))


def _promising(bench: Bench, progress: Progress, samples: int, starts: int) -> list[NDArray[np.float64]]:
    """The best of an even sample of the box that begins with the estimates themselves."""
    from scipy.stats import qmc

    lower, upper = limits()
    points = qmc.scale(qmc.Sobol(len(FREE), scramble=False).random(samples), lower, upper)
    points[0] = 0.0  # the sequence begins in a corner, where every value is extreme
    costs = []
    for first in range(0, samples, CHUNK):
        progress(STAGES[0], first / samples)
        chunk = points[first : first + CHUNK]
        found = bench.measure([from_unit(point) for point in chunk])
        costs += [float(np.sum(_all_residuals(q, p) ** 2)) for q, p in zip(found, chunk, strict=True)]
    return [points[index] for index in np.argsort(costs)[:starts]]


def _residuals(quantities: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.array([quantity.residual(value) for quantity, value in zip(QUANTITIES, quantities, strict=True)])


def _all_residuals(quantities: NDArray[np.float64], point: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.concatenate([_residuals(quantities), point])


def _jacobian(bench: Bench, point: NDArray[np.float64]) -> NDArray[np.float64]:
    """Central differences of the residuals, all of them run at once."""
    steps = DIFFERENCE * np.eye(len(FREE))
    found = bench.measure([from_unit(point + sign * step) for step in steps for sign in (1.0, -1.0)])
    residuals = np.array([_residuals(quantities) for quantities in found])
    return np.asarray((residuals[0::2] - residuals[1::2]).T / (2.0 * DIFFERENCE))
