"""The next generation of designs, from all that are known: NSGA-II with operators of pymoo.

A generation is a function of the designs and results before it, the seed and its number; nothing else is remembered,
so that a search goes on from what is stored. The first ones are a Sobol' sequence, until enough designs can be judged;
so is what parents cannot fill, because all their children have been tried. Parents are the best of all designs so far,
by rank and crowding; among those that break constraints, the less the better. Real numbers are mated by simulated
binary crossover and mutated polynomially, whole numbers and levels likewise and rounded, parts and other choices
uniformly.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.extras import extra
from giveway.study import designs as design_module
from giveway.study.designs import DesignPlan
from giveway.study.distributions import Varied

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["EXTRA", "Known", "Space", "next_generation", "pymoo_version"]

EXTRA = "optimise"
PARENTS = 2  # for each child
PARENTS_MIN = 4
DIGITS = 9  # of a coordinate on [0, 1]: designs that differ by less are the same
TRIES = 20  # matings, until a generation of new designs is complete
SOBOL_TRIES = 16  # points of the sequence for each new design


def pymoo_version() -> str:
    """Of the package that mates designs; MissingExtraError if it is not installed."""
    return str(extra("pymoo", EXTRA).__version__)


@dataclass(frozen=True)
class Known:
    """Designs that have been run.

    Attributes:
        designs: shape (n, quantities).
        costs: shape (n, objectives), less is better; NaN in rows of designs that cannot be judged: a run failed, or a
            metric is missing. Such designs are nobody's parents.
        violation: sum over the constraints, each in shares of its limit; 0: all are met.
    """

    designs: NDArray[np.float64]
    costs: NDArray[np.float64]
    violation: NDArray[np.float64]

    @property
    def judged(self) -> NDArray[np.bool_]:
        """Which designs can be compared."""
        return np.asarray(np.isfinite(self.costs).all(axis=1) & ~np.isnan(self.violation))

    @property
    def feasible(self) -> NDArray[np.bool_]:
        """Which of them meet all constraints."""
        return np.asarray(self.judged & (self.violation <= 0.0))


class Space:
    """What varies, as coordinates: real quantities on [0, 1], along a logarithm if they spread so; others by number."""

    def __init__(self, varied: Sequence[Varied]) -> None:
        self.varied = tuple(varied)

    def _continuous(self, one: Varied) -> bool:
        return one.spread is not None and not one.levels and one.quantity.kind == "real"

    def _ends(self, one: Varied) -> tuple[float, float]:
        assert one.spread is not None
        return one.spread.low, one.spread.high

    def _values(self, one: Varied) -> NDArray[np.float64]:
        """All values that a quantity can have which is not continuous."""
        if one.levels:
            return np.array(one.levels)
        low, high = self._ends(one)
        return np.arange(np.ceil(low), np.floor(high) + 1.0)

    def coordinates(self, designs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of ``designs``, shape (n, quantities)."""
        found = np.empty_like(designs)
        for j, one in enumerate(self.varied):
            value = designs[:, j]
            if not self._continuous(one):
                values = self._values(one)
                found[:, j] = np.abs(value[:, None] - values).argmin(axis=1)
                continue
            low, high = self._ends(one)
            if self._logarithmic(one):
                value, low, high = np.log(value), np.log(low), np.log(high)
            found[:, j] = np.round((value - low) / (high - low), DIGITS)
        return found

    def designs(self, coordinates: NDArray[np.float64]) -> NDArray[np.float64]:
        """The inverse, within the ranges."""
        found = np.empty_like(coordinates)
        for j, one in enumerate(self.varied):
            if not self._continuous(one):
                values = self._values(one)
                found[:, j] = values[np.clip(np.rint(coordinates[:, j]), 0, len(values) - 1).astype(np.intp)]
                continue
            low, high = self._ends(one)
            share = np.clip(np.round(coordinates[:, j], DIGITS), 0.0, 1.0)
            value = low * (high / low) ** share if self._logarithmic(one) else low + (high - low) * share
            found[:, j] = np.clip(value, low, high)
        return found

    def _logarithmic(self, one: Varied) -> bool:
        return one.spread is not None and one.spread.kind == "loguniform"

    def variables(self) -> dict[str, Any]:
        """The same for pymoo, by number."""
        from pymoo.core.variable import Choice, Integer, Real

        found: dict[str, Any] = {}
        for j, one in enumerate(self.varied):
            if self._continuous(one):
                found[f"{j}"] = Real(bounds=(0.0, 1.0))
            elif one.quantity.kind in ("choice", "boolean"):
                found[f"{j}"] = Choice(options=list(range(len(self._values(one)))))
            else:
                found[f"{j}"] = Integer(bounds=(0, len(self._values(one)) - 1))
        return found


def next_generation(space: Space, known: Known, seed: int, number: int, size: int) -> NDArray[np.float64]:
    """``size`` designs that have not been tried, fewer if there are no more; none: every design has been tried.

    ``number`` is that of the generation, from 0.
    """
    pymoo_version()
    tried = {row.tobytes() for row in space.coordinates(known.designs)}
    found = np.empty((0, len(space.varied)))
    if int(known.judged.sum()) >= max(PARENTS_MIN, size // 4):
        with warnings.catch_warnings():  # of a division by a width of 0, where all are equal in an objective
            warnings.simplefilter("ignore", RuntimeWarning)
            found = _mated(space, known, tried, np.random.default_rng([seed, number]), size)
    if len(found) < size:
        found = np.concatenate([found, _sobol(space, tried, seed, len(known.designs), size - len(found))])
    return found


def _sobol(space: Space, tried: set[bytes], seed: int, begun: int, size: int) -> NDArray[np.float64]:
    """The following designs of the sequence that have not been tried."""
    points = design_module.make(DesignPlan("sobol", count=begun + SOBOL_TRIES * size), space.varied, seed)[begun:]
    return _new(space, points, tried)[:size]


def _new(space: Space, designs: NDArray[np.float64], tried: set[bytes]) -> NDArray[np.float64]:
    """Those of ``designs`` that are not among ``tried``, to which they are added."""
    kept = []
    for index, row in enumerate(space.coordinates(designs)):
        key = row.tobytes()
        if key not in tried:
            tried.add(key)
            kept.append(index)
    return designs[kept]


def _candidates(known: Known, size: int) -> NDArray[np.intp]:
    """The designs among which the best ``size`` are: pymoo takes long for each that it has to look at."""
    from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting

    feasible = np.flatnonzero(known.feasible)
    fronts = NonDominatedSorting().do(known.costs[feasible], n_stop_if_ranked=size) if len(feasible) else []
    found = [feasible[one] for one in fronts]
    broken = np.flatnonzero(known.judged & ~known.feasible)
    found.append(broken[np.argsort(known.violation[broken], kind="stable")][: max(0, size - len(feasible))])
    return np.sort(np.concatenate(found))


def _mated(space: Space, known: Known, tried: set[bytes], rng: np.random.Generator, size: int) -> NDArray[np.float64]:
    """Children of the best designs."""
    from pymoo.algorithms.moo.nsga2 import RankAndCrowdingSurvival, binary_tournament
    from pymoo.core.duplicate import NoDuplicateElimination
    from pymoo.core.mixed import MixedVariableMating
    from pymoo.core.population import Population
    from pymoo.core.problem import Problem
    from pymoo.operators.selection.tournament import TournamentSelection

    objectives = known.costs.shape[1]
    problem = Problem(vars=space.variables(), n_obj=objectives, n_ieq_constr=1)
    judged = _candidates(known, PARENTS * size)
    rows = space.coordinates(known.designs[judged])
    best = Population.new(
        X=[{f"{j}": value for j, value in enumerate(row)} for row in rows.tolist()],
        F=known.costs[judged],
        G=np.minimum(known.violation[judged], 1e30)[:, None],
    )
    for individual in best:
        individual.evaluated = {"F", "G"}
    survival = RankAndCrowdingSurvival(crowding_func="pcd" if objectives <= 2 else "mnn")
    parents = survival.do(problem, best, n_survive=min(PARENTS * size, len(best)), random_state=rng)
    mating = MixedVariableMating(
        selection=TournamentSelection(func_comp=binary_tournament),
        eliminate_duplicates=NoDuplicateElimination(),
    )
    state = SimpleNamespace(random_state=rng, tournament_type="comp_by_dom_and_crowding")
    found: list[NDArray[np.float64]] = []
    for _ in range(TRIES):
        children = mating.do(problem, parents, size, algorithm=state, random_state=rng)
        made = np.array([[float(one.X[f"{j}"]) for j in range(len(space.varied))] for one in children])
        found.append(_new(space, space.designs(made), tried))
        if sum(len(one) for one in found) >= size:
            break
    return np.concatenate(found)[:size]
