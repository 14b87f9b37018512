"""Figures of a study: the trade-off, what each quantity does, what decides, and the traces of the chosen designs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from giveway.report.style import TRUTH_COLOUR

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from giveway.simulation.result import Result
    from giveway.study.answers import Answers

__all__ = ["axis_label", "drawn", "effect_panels", "effects", "growth", "sensitivities", "traces", "trade_off"]

FRONT_COLOUR, DESIGN_COLOUR, INFEASIBLE_COLOUR = "#0a8a63", "#0b64a8", "#d5d9de"
CHOSEN_COLOURS = ("#c8500a", "#0b64a8", "#0a8a63", "#7a2ea0", "#8a6d00")
POINTS_MAX = 3000  # drawn in a panel; of more designs a sample
POINTS_OF_FIGURE_MAX = 9000  # and in all panels of a figure
QUANTITIES_MAX = 5
CHOICES_LEVEL = 3  # so many names stand side by side under a panel; more are turned
CHOICES_NAMED = 26  # turned names that a panel has room for
BEFORE_MS, AFTER_MS = 20.0, 250.0


def axis_label(name: str, unit: str) -> str:
    """Name and unit."""
    return f"{name} ({unit})" if unit not in ("", "1") else name


def drawn(answers: Answers, panels: int = 1) -> NDArray[np.int64]:
    """Which designs are drawn in each of so many panels: all, or a sample that is the same every time."""
    known = np.flatnonzero(np.isfinite(answers.values[:, : len(answers.setup.objectives)]).all(axis=1))
    count = min(POINTS_MAX, POINTS_OF_FIGURE_MAX // panels)
    if len(known) > count:
        known = np.random.default_rng(1).choice(known, count, replace=False)
    return known


def effect_panels(answers: Answers) -> tuple[int, int]:
    """Rows and columns of `effects`: objectives and quantities."""
    return len(answers.setup.objectives), len(answers.setup.varied[:QUANTITIES_MAX])


def trade_off(answers: Answers) -> Figure:
    """The first two objectives against each other."""
    figure = Figure(figsize=(9.6, 4.2), layout="constrained")
    axes = figure.subplots()
    shown = drawn(answers)
    x, y = answers.shown_values(0), answers.shown_values(1)
    for mask, colour, label in (
        (~answers.feasible, INFEASIBLE_COLOUR, "constraints not met"),
        (answers.feasible & ~answers.pareto, DESIGN_COLOUR, "designs"),
    ):
        which = shown[mask[shown]]
        if which.size:
            axes.scatter(x[which], y[which], s=11, color=colour, alpha=0.7, linewidths=0, label=label)
    on_front = np.flatnonzero(answers.pareto)
    on_front = on_front[np.argsort(x[on_front], kind="stable")]
    on_front = on_front[:: 1 + len(on_front) // POINTS_MAX]
    line = "-" if len(answers.setup.objectives) == 2 else ""
    axes.plot(x[on_front], y[on_front], f"o{line}", color=FRONT_COLOUR, ms=4, lw=1.2, label="Pareto front")
    for rank, design in enumerate(answers.order[: answers.setup.chosen].tolist()):
        axes.annotate(
            f"{design}", (x[design], y[design]), xytext=(6, 6 + 12 * rank), textcoords="offset points", fontsize=9
        )
    for set_label, index in ((axes.set_xlabel, 0), (axes.set_ylabel, 1)):
        set_label(axis_label(answers.goal_name(index), answers.goal_unit(index).shown))
    axes.legend()
    return figure


def growth(answers: Answers) -> Figure | None:
    """The hypervolume of a search over its designs, in shares of the last; None if there was no search."""
    told = answers.manifest.get("optimum")
    if not told or not told["hypervolume"] or not told["hypervolume"][-1]:
        return None
    figure = Figure(figsize=(9.6, 3.0), layout="constrained")
    axes = figure.subplots()
    share = 100.0 * np.array(told["hypervolume"]) / told["hypervolume"][-1]
    axes.plot(told["designs"], share, "o-", color=FRONT_COLOUR, ms=3, lw=1.2)
    axes.set_xlabel("designs")
    axes.set_ylabel("hypervolume, share of the last (%)")
    return figure


def effects(answers: Answers) -> Figure:
    """Every objective over every quantity: one point per design."""
    varied = answers.setup.varied[:QUANTITIES_MAX]
    rows, columns = effect_panels(answers)
    figure = Figure(figsize=(9.6, 0.5 + 2.3 * rows), layout="constrained")
    grid = figure.subplots(rows, columns, squeeze=False, sharey="row", sharex="col")
    shown = drawn(answers, rows * columns)
    good, bad = shown[answers.feasible[shown]], shown[~answers.feasible[shown]]
    x = [answers.shown_designs(j) for j in range(columns)]
    y = [answers.shown_values(i) for i in range(rows)]
    for i in range(rows):
        for j, one in enumerate(varied):
            axes: Axes = grid[i, j]
            for which, colour in ((bad, INFEASIBLE_COLOUR), (good, DESIGN_COLOUR)):
                axes.scatter(x[j][which], y[i][which], s=8, color=colour, alpha=0.6, lw=0)
            quantity, spread = one.quantity, one.spread
            if spread is not None and spread.kind == "loguniform":
                axes.set_xscale("log")
                axes.minorticks_off()
                ticks = np.geomspace(one.unit.of(spread.low), one.unit.of(spread.high), 3)
                axes.set_xticks(ticks, [f"{tick:.4g}" for tick in ticks])
            if quantity.kind == "choice":
                every = 1 + (len(quantity.choices) - 1) // CHOICES_NAMED
                many = len(quantity.choices) > CHOICES_LEVEL
                axes.set_xticks(
                    range(0, len(quantity.choices), every),
                    quantity.choices[::every],
                    rotation=90 if many else 0,
                    fontsize=5 if many else None,
                )
            if i == rows - 1:
                axes.set_xlabel(axis_label(quantity.name.removeprefix("testbed."), one.unit.shown))
            if j == 0:
                axes.set_ylabel(axis_label(answers.goals[i].metric.name, answers.goal_unit(i).shown))
    return figure


def sensitivities(answers: Answers) -> Figure | None:
    """How much each quantity decides; None where the designs do not tell."""
    found = answers.sensitivities()
    if not found:
        return None
    goals = list(dict.fromkeys(one.goal for one in found))
    figure = Figure(figsize=(9.6, 0.9 + 0.32 * len(answers.setup.varied)), layout="constrained")
    grid = figure.subplots(1, len(goals), squeeze=False, sharey=True)[0]
    morris = answers.setup.plan.kind == "morris"
    for axes, goal in zip(grid, goals, strict=True):
        mine = [one for one in found if one.goal == goal]
        unit, at = answers.effect_unit(goal), np.arange(len(mine))
        main, interval = [unit.of(one.main) for one in mine], [unit.of(one.interval) for one in mine]
        axes.barh(at - 0.18, main, 0.34, xerr=interval, color=DESIGN_COLOUR, ecolor=TRUTH_COLOUR,
                  label="mean effect" if morris else "alone (S1)")  # fmt: skip
        if mine[0].total is not None:
            total = [unit.of(one.total or 0.0) for one in mine]
            axes.barh(at + 0.18, total, 0.34, color=FRONT_COLOUR, label="its spread" if morris else "in all (ST)")
        axes.set_yticks(at, [one.quantity.removeprefix("testbed.") for one in mine])
        axes.set_title(axis_label(goal, unit.shown))
        axes.invert_yaxis()
    grid[0].legend()
    return figure


def traces(results: Mapping[int, Mapping[str, Result]]) -> Figure:
    """Contact force of the chosen designs over the time since the contact, one panel per collision."""
    names = list(next(iter(results.values())))
    figure = Figure(figsize=(9.6, 0.6 + 2.4 * len(names)), layout="constrained")
    grid = figure.subplots(len(names), 1, squeeze=False, sharex=True)[:, 0]
    for axes, name in zip(grid, names, strict=True):
        for colour, (design, by_collision) in zip(CHOSEN_COLOURS * 4, results.items(), strict=False):
            result = by_collision[name]
            contact_s = float(result.traces["testbed.truth.first_contact_time"].values[-1])
            time_ms = 1e3 * (result.traces["time"].values - max(contact_s, 0.0))
            shown = (time_ms >= -BEFORE_MS) & (time_ms <= AFTER_MS)
            force = result.traces["testbed.truth.contact_force"].values
            axes.plot(time_ms[shown], force[shown], color=colour, label=f"design {design}")
            detected = result.metric("detection time").value
            if detected is not None:
                axes.axvline(detected, color=colour, ls="--", lw=0.9)
        axes.set_ylabel("contact force (N)")
        axes.set_title(name)
    grid[0].legend()
    grid[-1].set_xlabel("time since the contact (ms)")
    return figure
