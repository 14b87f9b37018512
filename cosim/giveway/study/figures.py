"""Figures of a study: how a search went, and what decides."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from giveway.report.style import TRUTH_COLOUR

if TYPE_CHECKING:
    from giveway.study.answers import Answers

__all__ = ["axis_label", "growth", "sensitivities"]

FRONT_COLOUR, DESIGN_COLOUR = "#0a8a63", "#0b64a8"


def axis_label(name: str, unit: str) -> str:
    """Name and unit."""
    return f"{name} ({unit})" if unit not in ("", "1") else name


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
    grid[0].invert_yaxis()  # of all: they share it
    grid[0].legend()
    return figure
