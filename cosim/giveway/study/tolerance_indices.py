"""What decides within the tolerances of a design: Sobol' indices, first and total, of its limits and objectives.

The share of a metric's variance that an uncertain quantity explains alone (first), or has part in (total). Samples and
estimates are SALib's, the intervals its bootstrap. A robot of the crowd and the sensor noise are quantities like the
tolerances: each line of `robot.population` is one, however many numbers it draws.
"""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import GivewayError
from giveway.study.designs import deviations_at
from giveway.study.engine import Report
from giveway.study.sure import Samples, about, concluded

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.study.answers import Answers
    from giveway.study.setup import Goal, Setup

__all__ = [
    "TELLING",
    "Index",
    "Indices",
    "has_several_inputs",
    "indices",
    "indices_of",
    "inputs_of",
    "points_of",
    "several_inputs",
    "stored_indices",
]

RESAMPLES = 1000
TELLING = 0.01  # of the variance: what may have a smaller part in it decides nothing
NOISE_SEEDS = 2.0**30
NOISE = "sensor noise"
PURPOSE = "indices"


@dataclass(frozen=True)
class Index:
    """Of one metric and one uncertain quantity.

    Attributes:
        metric, quantity: which.
        first, first_interval: share of the variance that is its alone, and half width of the 95 % interval.
        total, total_interval: share that it has part in, and half width of that.
        rank: from 1, by ``total``; 0: the interval of ``total`` begins below `TELLING`, so that it has nothing to say.
    """

    metric: str
    quantity: str
    first: float
    first_interval: float
    total: float
    total_interval: float
    rank: int = 0


@dataclass(frozen=True)
class Indices:
    """Of a design; ``reason``: why there are none, or none of some metric."""

    design: int
    found: tuple[Index, ...]
    reason: str


def inputs_of(setup: Setup) -> list[str]:
    """Per uncertain number, the quantity that it belongs to."""
    names = [one.quantity.name for one in setup.tolerances]
    names += [f"robot: {one.what}" for one in setup.crowd for _ in range(one.draws)]
    return [*names, *([NOISE] if setup.noise_seeds else [])]


def has_several_inputs(setup: Setup) -> bool:
    """Are there quantities to be told apart?"""
    return len(set(inputs_of(setup))) > 1


def several_inputs(setup: Setup) -> list[str]:
    """`inputs_of`; GivewayError if fewer than two quantities are uncertain."""
    groups = inputs_of(setup)
    if not has_several_inputs(setup):
        raise GivewayError("tolerance", f"{len(set(groups))} uncertain quantities", "at least two, to tell them apart")
    return groups


def indices_of(groups: Sequence[str], values: NDArray[np.float64], metric: str, seed: int) -> list[Index]:
    """The indices of ``values`` at the points of `points_of`, ranked."""
    from SALib.analyze import sobol

    names = list(dict.fromkeys(groups))
    told = sobol.analyze(_problem(groups), values, calc_second_order=False, num_resamples=RESAMPLES, seed=seed)
    columns = [np.asarray(told[name], dtype=float).tolist() for name in ("S1", "S1_conf", "ST", "ST_conf")]
    found = [Index(metric, name, *numbers) for name, *numbers in zip(names, *columns, strict=True)]
    found.sort(key=lambda one: -one.total)
    telling = [one for one in found if one.total - one.total_interval > TELLING]
    rest = [one for one in found if one not in telling]
    return [*(dataclasses.replace(one, rank=place) for place, one in enumerate(telling, 1)), *rest]


def points_of(groups: Sequence[str], count: int, seed: int) -> NDArray[np.float64]:
    """Where the metric has to be known: ``count`` times quantities + 2 points of the unit cube."""
    from SALib.sample import sobol

    with warnings.catch_warnings():  # it warns about other counts than powers of two
        warnings.simplefilter("ignore", UserWarning)
        return np.asarray(sobol.sample(_problem(groups), count, calc_second_order=False, seed=seed))


def _problem(groups: Sequence[str]) -> dict[str, Any]:
    names = [f"{name} {number}" for number, name in enumerate(groups)]
    bounds = [[0.0, 1.0]] * len(groups)
    return {"num_vars": len(groups), "names": names, "groups": list(groups), "bounds": bounds}


def indices(
    answers: Answers,
    design: int,
    count: int | None = None,
    *,
    threads: int | None = None,
    progress: Report | None = None,
) -> Indices:
    """The indices of a design; what is stored is not run again.

    Args:
        answers: of the study.
        design: its number.
        count: base samples, times quantities + 2 runs; None: the study's.
        threads: native ones; None: all processors.
        progress: called now and then.

    Raises:
        GivewayError: fewer than two quantities are uncertain.
        KeyboardInterrupt: after Ctrl-C; what is stored is kept.
    """
    import importlib.metadata

    setup = answers.setup
    count = setup.sure.indices if count is None else count
    groups = several_inputs(setup)
    goals = _goals(setup)
    names = [goal.metric.name for goal in goals]
    decides = {
        "indices": count,
        "metrics": names,
        "SALib": importlib.metadata.version("SALib"),
        "about": about(answers, design),
    }
    known = stored_indices(answers, design, decides)
    if known is not None:
        return known
    points = points_of(groups, count, setup.seed)
    metrics = [goal.metric for goal in goals]
    with Samples(answers, design, PURPOSE, decides, metrics, len(points), threads, progress) as samples:
        noise = np.floor(points[:, -1] * NOISE_SEEDS) if setup.noise_seeds else None
        width = len(groups) - setup.noise_seeds
        found, _ = samples.run(deviations_at(setup.tolerances, points[:, :width]), noise)
        result = _judged(design, groups, goals, found, setup.seed)
        samples.conclude(result)
        return result


def _goals(setup: Setup) -> list[Goal]:
    """Limits, then objectives, each metric once, without those of a design alone."""
    goals = [*(one.goal for one in setup.constraints), *setup.objectives]
    return list({goal.metric.name: goal for goal in reversed(goals) if not goal.metric.of_design}.values())[::-1]


def _judged(
    design: int, groups: Sequence[str], goals: Sequence[Goal], found: Sequence[NDArray[np.float64]], seed: int
) -> Indices:
    rows: list[Index] = []
    reasons = []
    for goal, values in zip(goals, found, strict=True):
        worst = np.max if goal.sense > 0 else np.min
        each = worst(values, axis=1) if goal.collisions == "worst" else values.mean(axis=1)
        name, missing = goal.metric.name, int((~np.isfinite(each)).sum())
        if missing:
            reasons.append(f"{missing:,} of {len(each):,} samples have no {name}, and the indices need it of all")
        elif np.ptp(each) == 0.0:
            reasons.append(f"{name} is the same in all samples")
        else:
            rows += indices_of(groups, each, name, seed)
    return Indices(design, tuple(rows), "; ".join(reasons))


def stored_indices(answers: Answers, design: int, decides: dict[str, Any] | None = None) -> Indices | None:
    """What is known of a design; ``decides``: only if they were found in this way."""
    told = concluded(answers, design, PURPOSE, decides)
    if told is None:
        return None
    return Indices(told["design"], tuple(Index(**one) for one in told["found"]), told["reason"])
