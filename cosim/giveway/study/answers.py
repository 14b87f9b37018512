"""First answers of a study: goals per design, constraints, the Pareto front, a ranking, sensitivities."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from giveway.base.errors import GivewayError
from giveway.base.in_notebooks import ShownInNotebooks
from giveway.base.units import WrittenUnit
from giveway.simulation.run_warnings import CUT_OFF, SEPARATOR
from giveway.study import frames
from giveway.study.designs import DesignPlan
from giveway.study.distributions import Varied
from giveway.study.engine import load_runs
from giveway.study.pareto import front, scores
from giveway.study.results_table import column_of, read_part
from giveway.study.runs import RunTable
from giveway.study.setup import Goal, Setup
from giveway.study.store import PARTS, list_parts

if TYPE_CHECKING:
    import pandas
    import xarray
    from numpy.typing import NDArray

    from giveway.simulation.result import Result

__all__ = [
    "Answers",
    "Block",
    "Sensitivities",
    "Sensitivity",
    "blocks_of",
    "costs_of",
    "cut_off_of",
    "goals_of",
    "load",
    "over_runs",
    "sensitivities_of",
    "whole",
    "why_no_sensitivities",
]

SAMPLES, MADE_FOR_IT = ("latin-hypercube", "sobol"), ("morris", "sobol-indices")  # kinds of designs that tell
GIVEN_DATA_MIN = 64  # designs, for indices from a sample that was not made for them


@dataclass(frozen=True)
class Sensitivity:
    """How much a quantity decides about a goal.

    Attributes:
        goal, quantity: which.
        main: share of the variance that is its alone (S1); Morris: mean of the absolute elementary effects (mu*).
        total: share that it has part in (ST); Morris: their standard deviation; None: not known from these designs.
        interval: half width of the 95 % interval of ``main``.
        total_interval: half width of that of ``total``, where it is a share; None: not known.
    """

    goal: str
    quantity: str
    main: float
    total: float | None
    interval: float
    total_interval: float | None = None

    @property
    def telling(self) -> bool:
        """An interval does not hold 0: the quantity decides something, and has a place in the ranking."""
        of_total = self.total is not None and self.total_interval is not None and self.total > self.total_interval
        return self.main > self.interval or of_total


class Sensitivities(list[Sensitivity]):
    """Sensitivities, and ``reason``: why there are none, or none of some objective; "" if nothing is missing."""

    def __init__(self, found: Iterable[Sensitivity], reason: str) -> None:
        super().__init__(found)
        self.reason = reason

    def __repr__(self) -> str:
        return super().__repr__() + (f" ({self.reason})" if self.reason else "")

    def table(self) -> pandas.DataFrame:
        """A line per objective and quantity."""
        return frames.sensitivity_table(self)


@dataclass(frozen=True)
class Answers(ShownInNotebooks):
    """What came out, one row per design.

    Attributes:
        folder, setup, runs, manifest: of the study.
        goals: objectives, then constraints, then what else is shown; the columns of ``values``.
        values: shape (designs, goals); NaN: it did not happen in some run, or a run failed; infinite: a share of a
            limit that allows nothing.
        stored, failed: runs per design that are stored, and that failed.
        reason: of the first run of a design that failed, by design.
        warnings: what happened otherwise than asked: by design, in how many of its runs which code (`run_warnings`).
        cut_off: a run ended during a contact, and an objective or constraint may be worse than its value says.
        feasible: all runs are there, none failed and nothing judged is cut off, and all constraints are met.
        pareto: feasible, and no other design is better in all objectives.
        order: designs, the best first; only feasible ones.
        score: distance from the best of every objective, in widths of the front; NaN: not feasible.
    """

    folder: Path
    setup: Setup
    runs: RunTable
    manifest: dict[str, Any]
    goals: tuple[Goal, ...]
    values: NDArray[np.float64]
    stored: NDArray[np.int64]
    failed: NDArray[np.int64]
    reason: dict[int, str]
    warnings: dict[int, dict[str, int]]
    cut_off: NDArray[np.bool_]
    feasible: NDArray[np.bool_]
    pareto: NDArray[np.bool_]
    order: NDArray[np.int64]
    score: NDArray[np.float64]

    @property
    def designs(self) -> NDArray[np.float64]:
        """Values of the varied quantities in our own units, shape (designs, quantities)."""
        return self.runs.designs

    @property
    def complete(self) -> bool:
        """All runs are stored."""
        return bool((self.stored == self.manifest["runs"] // max(1, len(self.designs))).all())

    def goal_name(self, index: int) -> str:
        """Name of the goal, with how it is taken over collisions and tolerances where there are several."""
        goal = self.goals[index]
        if goal.metric.of_design:
            return goal.metric.name
        over = []
        if len(self.setup.cases) > 1:
            over.append(f"{goal.collisions} collision")
        if self.manifest["tolerance_samples"] > 1:
            over.append("nominal" if goal.tolerances == "nominal" else f"{goal.tolerances} of tolerances")
        return goal.metric.name + (f", {', '.join(over)}" if over else "")

    def goal_unit(self, index: int) -> WrittenUnit:
        """The unit in which the goal is shown: of a constraint on its metric, if the user wrote one."""
        metric = self.goals[index].metric
        written = (one.written for one in self.setup.constraints if one.goal.metric.name == metric.name)
        return next((unit for unit in written if unit is not None), WrittenUnit(metric.unit))

    def shown_values(self, index: int) -> NDArray[np.float64]:
        """Values of a goal, one per design, in `goal_unit`."""
        return self.goal_unit(index).all_of(self.values[:, index])

    def shown_designs(self, index: int) -> NDArray[np.float64]:
        """Values of a varied quantity, one per design, in the unit in which the user wrote it."""
        return self.setup.varied[index].unit.all_of(self.designs[:, index])

    def effect_unit(self, goal: str) -> WrittenUnit:
        """The unit in which sensitivities of ``goal`` are shown: its own for Morris; others are shares."""
        names = [self.goal_name(index) for index in range(len(self.setup.objectives))]
        return self.goal_unit(names.index(goal)) if self.setup.plan.kind == "morris" else WrittenUnit("1")

    @property
    def columns(self) -> list[int]:
        """Which goals a table shows: an objective that is a constraint, too, once."""
        names = [self.goal_name(index) for index in range(len(self.goals))]
        return [index for index, name in enumerate(names) if name not in names[:index]]

    def warning_text(self, design: int) -> str:
        """What happened otherwise than asked in the runs of ``design``: "bumper bottomed (3 runs)"; empty: nothing."""
        found = self.warnings.get(design)
        if not found:
            return ""
        many = self.manifest["runs"] > len(self.designs)
        counted = ((code, f" ({runs} run{'s' if runs != 1 else ''})" if many else "") for code, runs in found.items())
        return SEPARATOR.join(f"{code}{runs}" for code, runs in counted)

    def check_design(self, design: int) -> int:
        """``design``, if there is one of that number."""
        if not 0 <= design < len(self.designs):
            raise GivewayError("--design", design, f"a whole number from 0 to {len(self.designs) - 1}")
        return design

    def table(self) -> xarray.Dataset:
        """Quantities, goals, ``feasible``, ``pareto`` and ``warnings`` over ``design``, in the user's units."""
        import xarray

        columns: dict[str, Any] = {}
        for j, one in enumerate(self.setup.varied):
            values: Any = self.shown_designs(j)
            if one.quantity.kind == "choice":
                values = np.array([one.quantity.text(value) for value in values])
            columns[one.quantity.name] = ("design", values, {"units": one.unit.name or "1"})
        for j in self.columns:
            columns[self.goal_name(j)] = ("design", self.shown_values(j), {"units": self.goal_unit(j).name})
        columns["feasible"], columns["pareto"] = ("design", self.feasible), ("design", self.pareto)
        warned = [self.warning_text(design) for design in range(len(self.designs))]
        columns["warnings"] = ("design", np.array(warned, dtype=np.str_))
        return xarray.Dataset(columns, coords={"design": np.arange(len(self.designs))})

    def ranking(self) -> pandas.DataFrame:
        """The designs that are allowed, the best first, in the user's units; their goals, ``pareto`` and ``score``."""
        return frames.ranking(self)

    def recommendation(self) -> pandas.DataFrame:
        """What to build, what limits it, what comes next: names and texts, as terminal and report begin."""
        return frames.recommendation(self)

    def margins(self, design: int | None = None) -> pandas.DataFrame:
        """How far a design, if left out the recommended one, is from every limit."""
        return frames.margins(self, design)

    def misfits(self) -> pandas.DataFrame:
        """The designs whose parts do not fit, and why."""
        return frames.misfits(self)

    def every_run(self, *metrics: str) -> xarray.Dataset:
        """Metrics of all stored runs over design, tolerance sample (0: nominal) and collision; none named: all."""
        return frames.every_run(self, metrics)

    def trace(self, design: int | None = None, *, collision: str | None = None, sample: int = 0) -> Result:
        """Simulate a design again, event-exact and with traces.

        Args:
            design: its number; left out: the recommended one.
            collision: by name; left out: the first.
            sample: of the tolerances; 0: nominal.
        """
        return frames.trace(self, design, collision, sample)

    def probability(
        self,
        design: int | None = None,
        *,
        runs: int | None = None,
        method: Literal["subset", "plain"] | None = None,
        threads: int | None = None,
    ) -> pandas.DataFrame:
        """How probable it is, within the tolerances, that a design exceeds any limit, and each, with a 95 % interval.

        Args:
            design: its number; left out: the recommended one.
            runs, method: at most so many samples, and how they are drawn; left out: as the study says.
            threads: native ones; None: all processors.
        """
        from giveway.study import certainty, sure

        number = frames.best_design(self) if design is None else self.check_design(design)
        plan = sure.plan_with(self.setup.sure, runs, method)
        return certainty.probability_frame(sure.probability(self, number, plan, threads=threads))

    def tolerance_indices(
        self, design: int | None = None, *, count: int | None = None, threads: int | None = None
    ) -> pandas.DataFrame:
        """Sobol' indices of limits and objectives within the tolerances of a design, with 95 % intervals.

        Args:
            design: its number; left out: the recommended one.
            count: base samples, times quantities + 2 runs; left out: as the study says.
            threads: native ones; None: all processors.
        """
        from giveway.study.certainty import index_frame
        from giveway.study.tolerance_indices import indices

        number = frames.best_design(self) if design is None else self.check_design(design)
        return index_frame(indices(self, number, count, threads=threads))

    def evidence(
        self, design: int | None = None, *, speeds: Sequence[float] | None = None, masses: Sequence[float] | None = None
    ) -> pandas.DataFrame:
        """Forces, pressures and travel of a design over speed (m/s), place and mass (kg), worst within tolerances.

        Left out: the recommended design, and speeds and masses around those of the study.
        """
        from giveway.study.evidence import evidence

        return evidence(self, design, speeds=speeds, masses=masses).table

    def sensitivities(self) -> Sensitivities:
        """Of the objectives, where the designs allow it: Morris and Sobol indices need a value of every design."""
        return self._sensitivities

    @functools.cached_property
    def _sensitivities(self) -> Sensitivities:
        setup, found, reasons = self.setup, [], []
        for index in range(len(setup.objectives)):
            values, name = self.values[:, index], self.goal_name(index)
            found += sensitivities_of(setup.plan, setup.varied, setup.seed, self.designs, values, name)
            reasons.append(why_no_sensitivities(setup.plan, setup.varied, values, name))
        if not setup.objectives:
            reasons = ["the study has no objective"]
        return Sensitivities(found, "; ".join(dict.fromkeys(reason for reason in reasons if reason)))


def load(folder: Path | str, progress: Callable[[float], None] | None = None) -> Answers:
    """The answers of the study in ``folder``, as far as it has been run.

    ``progress``, if given, is called with the share of the runs that is read, 0 to 1.

    Raises:
        FileError: there is no study, or it was written by another version.
    """
    setup, table, manifest = load_runs(folder)
    goals = goals_of(setup)
    count = len(table.designs)
    values = np.full((count, len(goals)), np.nan)
    stored, failed = np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int64)
    reason: dict[int, str] = {}
    warnings: dict[int, dict[str, int]] = {}
    parts_folder = Path(folder) / PARTS / manifest["fingerprint"][:16]
    if progress is not None:
        progress(0.0)
    for block in blocks_of(parts_folder, table, goals):
        if progress is not None:
            progress(block.first / max(1, count))
        part = slice(block.first, block.first + len(block.stored))
        values[part], stored[part], failed[part] = block.values, block.stored, block.failed
        reason |= block.reason
        warnings |= block.warnings
    cut_off = cut_off_of(setup, warnings, range(count))
    feasible = whole(table.per_design, stored, failed, cut_off)
    offset = len(setup.objectives)
    for index, constraint in enumerate(setup.constraints):
        column = values[:, offset + index]
        feasible &= (column >= constraint.minimum) & (column <= constraint.maximum)  # NaN meets nothing
    costs = costs_of(setup, values)
    feasible &= np.isfinite(costs).all(axis=1)
    costs[~feasible] = np.nan
    on_front = front(costs) if offset else np.zeros(count, dtype=bool)
    score = scores(costs, on_front, np.array([goal.weight for goal in setup.objectives]))
    candidates = np.flatnonzero(feasible)
    order = candidates[np.lexsort((score[candidates], ~on_front[candidates]))]
    judged = (cut_off, feasible, on_front, order, score)
    return Answers(Path(folder), setup, table, manifest, goals, values, stored, failed, reason, warnings, *judged)


def goals_of(setup: Setup) -> tuple[Goal, ...]:
    """Objectives, then constraints, then what else is shown."""
    return (*setup.objectives, *(one.goal for one in setup.constraints), *setup.shown)


def costs_of(setup: Setup, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """The objectives among ``values`` (n, goals) so that less is better."""
    return np.asarray(values[:, : len(setup.objectives)] * np.array([goal.sense for goal in setup.objectives]))


def cut_off_of(setup: Setup, warnings: Mapping[int, Mapping[str, int]], designs: Sequence[int]) -> NDArray[np.bool_]:
    """Which of ``designs`` have a run that ended during a contact, if the study judges what then may still grow."""
    judged = (*setup.objectives, *(one.goal for one in setup.constraints))
    if not any(goal.metric.of_whole_contact for goal in judged):
        return np.zeros(len(designs), dtype=bool)
    return np.array([CUT_OFF in warnings.get(design, ()) for design in designs], dtype=bool)


def whole(
    per_design: int, stored: NDArray[np.int64], failed: NDArray[np.int64], cut_off: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Which designs can be judged: all of their ``per_design`` runs are there, none failed, none was cut off."""
    return np.asarray((stored == per_design) & (failed == 0) & ~cut_off)


@dataclass
class Block:
    """Some designs that follow each other: `Answers` has the same attributes for all."""

    first: int
    values: NDArray[np.float64]
    stored: NDArray[np.int64]
    failed: NDArray[np.int64]
    reason: dict[int, str]
    warnings: dict[int, dict[str, int]]


def blocks_of(parts_folder: Path, table: RunTable, goals: tuple[Goal, ...], first_design: int = 0) -> Iterator[Block]:
    """The stored runs, design by design; a design may begin in one part and end in the next.

    ``first_design`` has to be the first one of a part.
    """
    names = sorted({name for goal in goals for name in goal.metric.columns})
    pending: dict[str, Any] = {}
    for begin, _, path in list_parts(parts_folder):
        if begin < first_design * table.per_design:
            continue
        part = read_part(path, ["run", "status", "message", "warnings", *names])
        found: dict[str, Any] = {name: column_of(part, name) for name in ("run", *names)}
        found["ok"] = np.array(part["status"].to_pylist()) == "ok"
        found["message"] = np.array(part["message"].to_pylist(), dtype=object)
        found["warnings"] = np.array(part["warnings"].to_pylist(), dtype=object)
        pending = {name: np.concatenate([pending[name], found[name]]) for name in found} if pending else found
        whole = int(pending["run"][-1] + 1) // table.per_design * table.per_design
        done = int(np.searchsorted(pending["run"], whole))
        if done:
            yield from _blocks({name: column[:done] for name, column in pending.items()}, table, goals)
        pending = {name: column[done:] for name, column in pending.items()}
    if pending and len(pending["run"]):
        yield from _blocks(pending, table, goals)


def _blocks(runs: dict[str, Any], table: RunTable, goals: tuple[Goal, ...]) -> Iterator[Block]:
    size = table.per_design
    first = int(runs["run"][0]) // size
    count = int(runs["run"][-1]) // size - first + 1
    where = runs["run"] - first * size
    stored = np.bincount(where // size, minlength=count)
    failed = np.bincount(where[~runs["ok"]] // size, minlength=count)
    reason: dict[int, str] = {}
    for index in np.flatnonzero(~runs["ok"]):
        reason.setdefault(first + int(where[index]) // size, str(runs["message"][index]))
    warnings: dict[int, dict[str, int]] = {}
    for index in np.flatnonzero(runs["warnings"] != ""):
        mine = warnings.setdefault(first + int(where[index]) // size, {})
        for code in runs["warnings"][index].split(SEPARATOR):
            mine[code] = mine.get(code, 0) + 1
    shape = (count, table.samples, len(table.cases))
    values = np.full((count, len(goals)), np.nan)
    for j, goal in enumerate(goals):
        flat = np.full(count * size, np.nan)
        flat[where] = goal.metric.of(runs)
        values[:, j] = over_runs(goal, flat.reshape(shape))
    yield Block(first, values, stored, failed, reason, warnings)


def over_runs(goal: Goal, runs: NDArray[np.float64]) -> NDArray[np.float64]:
    """One number per design from ``runs`` (designs, tolerance samples, collisions); NaN if one that counts is NaN.

    The first sample is the nominal one: it counts among the worst, but not in the mean, which is the distribution's.
    """
    worst = np.max if goal.sense > 0 else np.min
    found = worst(runs, axis=2) if goal.collisions == "worst" else runs.mean(axis=2)
    if goal.tolerances == "nominal" or found.shape[1] == 1:
        return np.asarray(found[:, 0])
    return np.asarray(worst(found, axis=1) if goal.tolerances == "worst" else found[:, 1:].mean(axis=1))


def sensitivities_of(
    plan: DesignPlan,
    varied: Sequence[Varied],
    seed: int,
    designs: NDArray[np.float64],
    values: NDArray[np.float64],
    goal: str,
) -> list[Sensitivity]:
    """How much each quantity decides about ``values``, one per design; nothing if `why_no_sensitivities` says why."""
    from giveway.study.designs import problem, shares

    if why_no_sensitivities(plan, varied, values, goal):
        return []
    known = np.isfinite(values)
    designs, values = designs[known], values[known]
    names = [one.quantity.name for one in varied]
    described = problem(varied)
    total: list[float | None]
    widths: list[float | None] = [None] * len(names)
    if plan.kind == "morris":
        from SALib.analyze import morris

        points = shares(plan, varied, seed)
        found = morris.analyze(described, points, values, num_levels=plan.grid, seed=seed)
        main, interval, total = found["mu_star"], found["mu_star_conf"], list(found["sigma"])
    elif plan.kind == "sobol-indices":
        from SALib.analyze import sobol

        found = sobol.analyze(described, values, calc_second_order=False, seed=seed)
        main, interval, total = found["S1"], found["S1_conf"], list(found["ST"])
        widths = [_finite(float(width)) for width in found["ST_conf"]]
    else:
        from giveway.study.first_order import first_order

        main, interval = first_order(designs, values, seed)
        total = [None] * len(names)
    return [
        Sensitivity(
            goal, name, float(main[j]), None if one is None else float(one), _finite(float(interval[j])), widths[j]
        )
        for j, (name, one) in enumerate(zip(names, total, strict=True))
    ]


def why_no_sensitivities(plan: DesignPlan, varied: Sequence[Varied], values: NDArray[np.float64], goal: str) -> str:
    """Why these designs do not tell what decides about ``values``, one per design; "" if they do."""
    known = np.isfinite(values)
    count, missing = int(known.sum()), int((~known).sum())
    if plan.kind not in (*SAMPLES, *MADE_FOR_IT):
        kinds = f"{' or '.join(SAMPLES)} with {GIVEN_DATA_MIN} designs or more, {' or '.join(MADE_FOR_IT)}"
        return f"designs of the kind {plan.kind} do not tell; {kinds} do"
    if len(varied) < 2:
        return "only one quantity varies"
    if plan.kind in MADE_FOR_IT and missing:
        return f"{missing} of {len(values)} designs have no {goal}, and {plan.kind} needs it of all"
    if plan.kind in SAMPLES and count < GIVEN_DATA_MIN:
        return f"{count} designs have a {goal}, and it takes {GIVEN_DATA_MIN}"
    if np.ptp(values[known]) == 0.0:
        return f"{goal} is the same in all designs"
    return ""


def _finite(value: float) -> float:
    return value if math.isfinite(value) else 0.0
