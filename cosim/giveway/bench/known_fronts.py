"""Three test problems whose fronts are known, for the search of the best designs: constrained, and mixed with parts.

Costs have shape (n, 2), constraints shape (n, c) and are met up to 0.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from giveway.study.designs import DesignPlan, make
from giveway.study.distributions import Spread, Varied
from giveway.study.hypervolume import hypervolume
from giveway.study.optimiser import Known, Space, next_generation
from giveway.study.quantities import Quantity
from giveway.study.search_plan import SearchPlan

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Judged = tuple[NDArray[np.float64], NDArray[np.float64]]

__all__ = ["HEADER", "PROBLEMS", "Problem", "measure", "part", "real", "searched"]

HEADER = ("known front", "quantities", "runs", "share of the front's hypervolume", "of the even sample's")


@dataclass(frozen=True)
class Problem:
    """A problem: costs and constraints of designs, what varies, its front, and the point of hypervolumes."""

    judge: Callable[[NDArray[np.float64]], Judged]
    varied: tuple[Varied, ...]
    front: Callable[[], NDArray[np.float64]]
    reference: tuple[float, float]

    def volume(self, costs: NDArray[np.float64], constraints: NDArray[np.float64]) -> float:
        """Hypervolume of those that meet the constraints."""
        return hypervolume(costs[(constraints <= 0.0).all(axis=1)], np.array(self.reference))


def real(name: str, low: float, high: float) -> Varied:
    """A continuous quantity."""
    return Varied(Quantity(name, "1", "real", low, high), spread=Spread("uniform", low, high))


def part(name: str, count: int) -> Varied:
    """One of some parts."""
    names = tuple(f"{name} {index}" for index in range(count))
    quantity = Quantity(name, "", "choice", 0.0, count - 1.0, (), names)
    return Varied(quantity, levels=tuple(float(index) for index in range(count)))


def binh_korn(x: NDArray[np.float64]) -> Judged:
    """Binh and Korn (1997), often called BNH: two quantities, two constraints."""
    a, b = x.T
    constraints = [(a - 5.0) ** 2 + b**2 - 25.0, 7.7 - (a - 8.0) ** 2 - (b + 3.0) ** 2]
    return np.stack([4.0 * a**2 + 4.0 * b**2, (a - 5.0) ** 2 + (b - 5.0) ** 2], 1), np.stack(constraints, 1)


def front_of_binh_korn() -> NDArray[np.float64]:
    """Along the diagonal, then along the upper end of the second quantity."""
    first, second = np.linspace(0.0, 3.0, 5001), np.linspace(3.0, 5.0, 5001)
    return binh_korn(np.concatenate([np.stack([first, first], 1), np.stack([second, np.full_like(second, 3.0)], 1)]))[0]


def zitzler_with_a_gap(x: NDArray[np.float64]) -> Judged:
    """ZDT1 of Zitzler, Deb and Thiele (2000), best where all but the first number are 0, with a gap in its front."""
    a, rest = x[:, 0], 1.0 + 9.0 * x[:, 1:].mean(axis=1)
    return np.stack([a, rest * (1.0 - np.sqrt(a / rest))], 1), 0.01 - (a[:, None] - 0.5) ** 2


_WIDTHS = np.random.default_rng(5).permutation(np.linspace(0.0, 1.0, 12))  # of parts, in no order


def zitzler_of_parts(x: NDArray[np.float64]) -> Judged:
    """The same with one of twelve parts for the second and for the third number."""
    numbers = x.copy()
    numbers[:, 1:3] = _WIDTHS[x[:, 1:3].astype(int)]
    return zitzler_with_a_gap(numbers)


def front_with_a_gap() -> NDArray[np.float64]:
    """Of both."""
    a = np.linspace(0.0, 1.0, 20001)
    a = a[np.abs(a - 0.5) >= 0.1]
    return np.stack([a, 1.0 - np.sqrt(a)], 1)


_LEVELS = Varied(Quantity("d", "1", "real", 0.0, 1.0), levels=tuple(np.linspace(0.0, 1.0, 11).tolist()))
_MIXED = (real("a", 0.0, 1.0), part("b", 12), part("c", 12), _LEVELS, real("e", 0.0, 1.0))
_SIX = tuple(real(name, 0.0, 1.0) for name in "abcdef")
PROBLEMS: Mapping[str, Problem] = MappingProxyType(
    {
        "Binh-Korn": Problem(binh_korn, (real("a", 0.0, 5.0), real("b", 0.0, 3.0)), front_of_binh_korn, (140.0, 50.0)),
        "ZDT1 with a gap": Problem(zitzler_with_a_gap, _SIX, front_with_a_gap, (1.1, 1.1)),
        "ZDT1 of parts": Problem(zitzler_of_parts, _MIXED, front_with_a_gap, (1.1, 1.1)),
    }
)


def searched(problem: Problem, seed: int, count: int) -> Known:
    """``count`` designs of a search, found as `giveway.study.optimum` finds them."""
    space, number, population = Space(problem.varied), 0, SearchPlan().population
    known = Known(np.empty((0, len(problem.varied))), np.empty((0, 2)), np.empty(0))
    while len(known.designs) < count:
        size = min(population, count - len(known.designs))
        new = next_generation(space, known, seed, number, size)
        costs, constraints = problem.judge(new)
        known = Known(
            np.concatenate([known.designs, new]),
            np.concatenate([known.costs, costs]),
            np.append(known.violation, np.maximum(constraints, 0.0).sum(axis=1)),
        )
        number += 1
    return known


def measure(sample: int, runs: int, seeds: int, say: Callable[[float], None]) -> Iterator[tuple[str, ...]]:
    """Rows under `HEADER`: medians over the seeds."""
    done = 0
    for name, problem in PROBLEMS.items():
        best = hypervolume(problem.front(), np.array(problem.reference))
        evenly = problem.volume(*problem.judge(make(DesignPlan("sobol", count=sample), problem.varied, 1)))
        volumes = []
        for seed in range(1, seeds + 1):
            found = searched(problem, seed, runs)
            volumes.append(hypervolume(found.costs[found.feasible], np.array(problem.reference)))
            done += 1
            say(done / (seeds * len(PROBLEMS)))
        median = float(np.median(volumes))
        against = f"{median / evenly:.4f}" if evenly > 0.0 else "-"
        yield name, f"{len(problem.varied)}", f"{runs:,}", f"{median / best:.4f}", against
