"""The designs of a study: which values its quantities take together. The samplers are SciPy's and SALib's."""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import GivewayError
from giveway.study.distributions import Tolerance, Varied
from giveway.study.search_plan import OPTIMISED

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["KINDS", "DesignPlan", "deviations", "deviations_at", "make", "problem", "shares"]

KINDS = ("factorial", "latin-hypercube", "sobol", "one-at-a-time", "morris", "sobol-indices", "csv", OPTIMISED)
COUNT_MAX = 20_000_000
OPTIONS: Mapping[str, tuple[str, ...]] = {
    "factorial": (),
    "latin-hypercube": ("count",),
    "sobol": ("count",),
    "one-at-a-time": (),
    "morris": ("trajectories", "grid"),
    "sobol-indices": ("count",),
    "csv": ("file",),
    OPTIMISED: (),
}
"""Options of each kind, by the key of the study file."""


@dataclass(frozen=True)
class DesignPlan:
    """Which designs are to be made.

    Attributes:
        kind: one of `KINDS`.
        count: designs of a Latin hypercube or a Sobol sequence, at most of a search; base samples of "sobol-indices".
        trajectories, grid: of the Morris method: how many, and levels per quantity (even).
        rows: the designs of a CSV file, shape (n, quantities).
    """

    kind: str
    count: int = 0
    trajectories: int = 0
    grid: int = 4
    rows: NDArray[np.float64] | None = None

    def size(self, varied: Sequence[Varied]) -> int:
        """Number of designs, known before they are made."""
        if self.kind == "factorial":
            return int(np.prod([len(one.levels) for one in varied], dtype=object))
        if self.kind == "one-at-a-time":
            return 1 + sum(len(_others(one)) for one in varied)
        if self.kind == "morris":
            return self.trajectories * (len(varied) + 1)
        if self.kind == "sobol-indices":
            return self.count * (len(varied) + 2)
        if self.rows is not None:
            return len(self.rows)
        return self.count


def _others(one: Varied) -> list[float]:
    """The levels but for the nominal value, which every other design has."""
    return [level for level in one.levels if level != one.nominal]


def problem(varied: Sequence[Varied]) -> dict[str, Any]:
    """The quantities as SALib wants them, on [0, 1]."""
    names = [one.quantity.name for one in varied]
    return {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}


def make(plan: DesignPlan, varied: Sequence[Varied], seed: int) -> NDArray[np.float64]:
    """All designs, shape (designs, quantities); the same for the same seed."""
    if plan.rows is not None:
        return plan.rows
    if not varied:
        return np.zeros((1, 0))
    if plan.kind == "factorial":
        grid = np.meshgrid(*(np.array(one.levels) for one in varied), indexing="ij")
        return np.stack([axis.ravel() for axis in grid], axis=1)
    if plan.kind == "one-at-a-time":
        return _one_at_a_time(varied)
    points = shares(plan, varied, seed)
    return np.stack([one.at(points[:, j]) for j, one in enumerate(varied)], axis=1)


def _one_at_a_time(varied: Sequence[Varied]) -> NDArray[np.float64]:
    nominal = []
    for one in varied:
        if one.nominal is None:
            raise GivewayError(f"{one.field}.nominal", "nothing", "its value while another quantity varies")
        nominal.append(one.nominal)
    rows = [nominal]
    for j, one in enumerate(varied):
        rows += [[*nominal[:j], level, *nominal[j + 1 :]] for level in _others(one)]
    return np.array(rows)


def shares(plan: DesignPlan, varied: Sequence[Varied], seed: int) -> NDArray[np.float64]:
    """Points of the unit cube, shape (designs, quantities)."""
    if plan.kind == "morris":
        from SALib.sample import morris

        return np.asarray(morris.sample(problem(varied), plan.trajectories, num_levels=plan.grid, seed=seed))
    if plan.kind == "sobol-indices":
        from SALib.sample import sobol

        with warnings.catch_warnings():  # it warns about other counts than powers of two
            warnings.simplefilter("ignore", UserWarning)
            found = sobol.sample(problem(varied), plan.count, calc_second_order=False, seed=seed)
        return np.asarray(found)
    return _filled(plan.kind, plan.count, len(varied), seed)


def _filled(kind: str, count: int, dimensions: int, seed: int) -> NDArray[np.float64]:
    """The points fill the space evenly."""
    from scipy.stats import qmc

    if kind == "latin-hypercube":
        return np.asarray(qmc.LatinHypercube(dimensions, rng=np.random.default_rng(seed)).random(count))
    with warnings.catch_warnings():  # it warns about other counts than powers of two
        warnings.simplefilter("ignore", UserWarning)
        return np.asarray(qmc.Sobol(dimensions, rng=np.random.default_rng(seed)).random(count))


def deviations(
    tolerances: Sequence[Tolerance], kind: str, count: int, seed: int, further: int = 0
) -> NDArray[np.float64]:
    """Deviations from the design, shape (1 + n, tolerances + further): first none at all, then the tolerance samples.

    Every design gets the same ones, so that designs differ by what they are and not by their luck. ``kind``
    "corners": every combination of both ends, whatever ``count``. ``further``: so many shares besides.
    """
    none = np.array([[math.nan if one.replaces else 0.0 for one in tolerances] + [math.nan] * further])
    if not tolerances and not further:
        return np.zeros((1, 0))
    if kind == "corners":
        ends = [(one.spread.low, one.spread.high) for one in tolerances]
        return np.concatenate([none, np.array(list(itertools.product(*ends)))])
    return np.concatenate([none, deviations_at(tolerances, _filled(kind, count, len(tolerances) + further, seed))])


def deviations_at(tolerances: Sequence[Tolerance], shares: NDArray[np.float64]) -> NDArray[np.float64]:
    """The deviations whose shares (n, tolerances + further), 0 to 1, are these; further ones stay as they are."""
    found = shares.copy()
    for j, one in enumerate(tolerances):
        found[:, j] = one.spread.at(shares[:, j])
    return found
