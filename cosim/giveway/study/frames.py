"""The answers of a study as tables of pandas and xarray."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import GivewayError, UnknownNameError

if TYPE_CHECKING:
    import pandas
    import xarray

    from giveway.simulation.result import Result
    from giveway.study.answers import Answers, Sensitivities

__all__ = ["best_design", "every_run", "margins", "misfits", "ranking", "recommendation", "sensitivity_table", "trace"]


def _titled(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit not in ("", "1") else name


def ranking(answers: Answers) -> pandas.DataFrame:
    """The designs that are allowed, the best first, by their number, in the user's units."""
    import pandas

    order = answers.order
    columns: dict[str, Any] = {}
    for j, one in enumerate(answers.setup.varied):
        values: Any = answers.shown_designs(j)[order]
        if one.quantity.kind == "choice":
            values = np.array(one.quantity.choices, dtype=object)[values.astype(np.intp)]
        columns[_titled(one.quantity.name, one.unit.shown)] = values
    for j in answers.columns:
        columns[_titled(answers.goal_name(j), answers.goal_unit(j).shown)] = answers.shown_values(j)[order]
    columns |= {"pareto": answers.pareto[order], "score": answers.score[order]}
    return pandas.DataFrame(columns, index=pandas.Index(order, name="design"))


def best_design(answers: Answers) -> int:
    """The recommended design.

    Raises:
        GivewayError: no design is allowed.
    """
    if not len(answers.order):
        why = "is recommended, and some are cut off" if answers.cut_off.any() else "meets all constraints"
        raise GivewayError("design", "nothing", f"its number: no design {why}")
    return int(answers.order[0])


def margins(answers: Answers, design: int | None) -> pandas.DataFrame:
    """A line per constraint: value, limit, margin (negative: beyond it), its share of the limit, unit."""
    import pandas

    from giveway.study.limits import margins_of

    number = best_design(answers) if design is None else answers.check_design(design)
    rows = [
        (one.name, one.allowed, one.value, one.limit, one.room, one.share, one.unit.name)
        for one in margins_of(answers, number)
    ]
    return pandas.DataFrame(rows, columns=["limit", "allowed", "value", "at", "margin", "share", "unit"])


def recommendation(answers: Answers) -> pandas.DataFrame:
    """What terminal and report begin with: a line per name, and its text."""
    import pandas

    from giveway.study.advice import advice

    found = advice(answers)
    return pandas.DataFrame([("recommended", found.title), *found.lines], columns=["name", "text"])


def misfits(answers: Answers) -> pandas.DataFrame:
    """Every design whose parts do not fit: which part, which rule, and its numbers."""
    import pandas

    from giveway.study.part_rules import misfit

    told = ((design, misfit(reason)) for design, reason in sorted(answers.reason.items()))
    rows = [(design, *words) for design, words in told if words is not None]
    return pandas.DataFrame(rows, columns=["design", "part", "does not fit", "numbers"])


def sensitivity_table(found: Sensitivities) -> pandas.DataFrame:
    """A line per objective and quantity."""
    import pandas

    names = ["goal", "quantity", "main", "total", "interval", "total_interval", "telling"]
    return pandas.DataFrame([[getattr(one, name) for name in names] for one in found], columns=names)


def every_run(answers: Answers, metrics: Sequence[str]) -> xarray.Dataset:
    """Metrics of all stored runs over design, tolerance sample and collision; NaN: not stored, or it did not happen."""
    import xarray

    from giveway.study.metrics import DRIVETRAIN, all_metrics
    from giveway.study.results_table import read_runs

    kept = answers.setup.derived  # of the linear drivetrain, only what was asked for is stored
    known = {name: one for name, one in all_metrics().items() if name not in DRIVETRAIN or name in kept}
    for name in metrics:
        if name not in known:
            raise UnknownNameError("metrics", name, known)
    wanted = {name: known[name] for name in metrics or [name for name, one in known.items() if one.truth is None]}
    columns = sorted({column for one in wanted.values() for column in one.columns})
    runs = read_runs(answers.folder, ["run", *columns])
    where = runs["run"].astype(np.int64)
    shape = (len(answers.designs), answers.runs.samples, len(answers.setup.cases))
    data: dict[str, Any] = {}
    for name, one in wanted.items():
        flat = np.full(answers.runs.count, np.nan)
        flat[where] = one.of(runs)
        data[name] = (("design", "sample", "collision"), flat.reshape(shape), {"units": one.unit})
    names = [case.name for case in answers.setup.cases]
    return xarray.Dataset(
        data, coords={"design": np.arange(shape[0]), "sample": np.arange(shape[1]), "collision": names}
    )


def trace(answers: Answers, design: int | None, collision: str | None, sample: int) -> Result:
    """One run of a design again, event-exact and with traces."""
    from giveway.base.checks import whole
    from giveway.simulation.runner import run
    from giveway.study.chosen import scenario_of_run

    number = best_design(answers) if design is None else answers.check_design(design)
    names = [case.name for case in answers.setup.cases]
    if collision is not None and collision not in names:
        raise UnknownNameError("collision", collision, names)
    case = 0 if collision is None else names.index(collision)
    whole("sample", sample, 0, answers.runs.samples - 1)
    return run(scenario_of_run(answers.setup, answers.runs, number, sample, case), engine="native")
