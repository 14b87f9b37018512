"""Figures of a study: the trade-off, what each quantity does, what decides, and the traces of the chosen designs."""

from __future__ import annotations

import itertools
import math
import textwrap
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure

from giveway.base.units import WrittenUnit
from giveway.report.style import TRUTH_COLOUR
from giveway.study.limit_lines import DETECTION, FORCES, draw_limits, limit_lines, limits_of_metrics

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from giveway.simulation.result import Result
    from giveway.study.answers import Answers
    from giveway.study.distributions import Varied

__all__ = ["axis_label", "drawn", "effect_panels", "effects", "growth", "pairs", "sensitivities", "traces", "trade_off"]

FRONT_COLOUR, DESIGN_COLOUR, INFEASIBLE_COLOUR = "#0a8a63", "#0b64a8", "#d5d9de"
CHOSEN_COLOURS = ("#c8500a", "#0b64a8", "#0a8a63", "#7a2ea0", "#8a6d00")
POINTS_MAX = 20_000  # drawn in a panel; of more designs a sample
POINTS_OF_FIGURE_MAX = 60_000  # and in all panels of a figure
PIXELS_PER_IN = 160
PIXELS_FROM = 1000  # so many points are drawn as an image: it is smaller, and drawn faster
QUANTITIES_MAX = 5
CHOICES_LEVEL = 3  # so many names stand side by side under a panel; more are turned
CHOICE_IN = 0.11  # width of a turned name
BEFORE_MS, AFTER_MS = 20.0, 250.0
WIDTH_IN, LEFT_IN, RIGHT_IN, BOTTOM_IN = 9.6, 0.95, 0.15, 0.5
LEGEND_COLUMNS, LEGEND_IN = 5, 0.24  # entries in a line, and its height
PAIRS_BESIDE = 3  # panels of the trade-off side by side
MARKERS = "D^svPX*"


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


def pairs(answers: Answers) -> list[tuple[int, int]]:
    """Which goals the trade-off draws against each other: all objectives; a single one against what has a limit."""
    count = len(answers.setup.objectives)
    if count == 1:
        limited = range(count, count + len(answers.setup.constraints))
        return [(0, j) for j in limited if j in answers.columns]
    return list(itertools.combinations(range(count), 2))


def trade_off(answers: Answers) -> Figure:
    """Every two objectives against each other, with their limits; the best ranked designs have marks."""
    wanted = pairs(answers)
    columns = min(PAIRS_BESIDE, len(wanted))
    rows = math.ceil(len(wanted) / columns)
    best = answers.order[: max(1, answers.setup.chosen)].tolist()
    height = 3.6 if columns == 1 else 2.7
    figure, grid = _panels(rows, columns, height, 3 + len(best), (0.8, 0.75), bottom_in=0.7)
    shown = drawn(answers, len(wanted))
    on_front = np.flatnonzero(answers.pareto)
    on_front = on_front[:: 1 + len(on_front) // POINTS_MAX]
    for (i, j), axes in zip(wanted, grid.flat, strict=False):
        x, y = answers.shown_values(i), answers.shown_values(j)
        for mask, colour, label in (
            (~answers.feasible, INFEASIBLE_COLOUR, "constraints not met"),
            (answers.feasible & ~answers.pareto, DESIGN_COLOUR, "designs"),
        ):
            _points(axes, x, y, shown[mask[shown]], colour, label)
        along = on_front[np.argsort(x[on_front], kind="stable")]
        line = "-" if len(answers.setup.objectives) == 2 else ""
        axes.plot(x[along], y[along], f"o{line}", color=FRONT_COLOUR, ms=4, lw=1.2, label="Pareto front")
        for rank, (design, colour) in enumerate(zip(best, CHOSEN_COLOURS * 4, strict=False)):
            ring = {"marker": "o", "ms": 14, "mfc": "none", "mec": colour, "mew": 2.2}  # seen around all others
            mark = {"marker": MARKERS[rank % len(MARKERS)], "ms": 7, "mfc": colour, "mec": "white", "mew": 0.8}
            style: dict[str, Any] = mark if rank else ring
            axes.plot(x[[design]], y[[design]], ls="", zorder=5, label=f"design {design}", **style)
        for set_label, index, inches in ((axes.set_xlabel, i, WIDTH_IN / columns), (axes.set_ylabel, j, height)):
            set_label(_wrapped(axis_label(answers.goal_name(index), answers.goal_unit(index).shown), inches - 0.5))
        draw_limits(axes, limit_lines(answers, i), "x")
        draw_limits(axes, limit_lines(answers, j), "y")
    for axes in grid.flat[len(wanted) :]:
        axes.set_axis_off()
    _legend(figure, grid.flat[0])
    return figure


def _panels(
    rows: int, columns: int, height_in: float, entries: int, between_in: tuple[float, float], **shared: Any
) -> tuple[Figure, NDArray[Any]]:
    """Panels of ``height_in`` with fixed margins and room for so many ``entries`` of a legend above them.

    A layout engine would take as long as the drawing.
    """
    top = 0.12 + LEGEND_IN * math.ceil(entries / LEGEND_COLUMNS)
    bottom = shared.pop("bottom_in", BOTTOM_IN)
    whole = top + bottom + rows * height_in + (rows - 1) * between_in[1]
    panel = (WIDTH_IN - LEFT_IN - RIGHT_IN - (columns - 1) * between_in[0]) / columns
    figure = Figure(figsize=(WIDTH_IN, whole), dpi=PIXELS_PER_IN)
    figure.subplots_adjust(
        left=LEFT_IN / WIDTH_IN,
        right=1.0 - RIGHT_IN / WIDTH_IN,
        top=1.0 - top / whole,
        bottom=bottom / whole,
        wspace=between_in[0] / panel,
        hspace=between_in[1] / height_in,
    )
    grid = figure.subplots(rows, columns, squeeze=False, **shared)
    for axes in grid.flat:
        axes.ticklabel_format(useOffset=False)  # "+1.256e1" in a corner is overlooked
    return figure, grid


def _points(
    axes: Axes, x: NDArray[np.float64], y: NDArray[np.float64], which: NDArray[np.int64], colour: str, label: str
) -> None:
    if which.size:
        size = 11.0 if which.size < PIXELS_FROM else 4.0
        cloud = axes.scatter(x[which], y[which], s=size, color=colour, alpha=0.7, linewidths=0, label=label, zorder=1.8)
        cloud.set_rasterized(which.size >= PIXELS_FROM)


def _legend(figure: Figure, axes: Axes) -> None:
    """Above the panels, where it hides nothing."""
    handles, labels = axes.get_legend_handles_labels()
    legend = figure.legend(handles, labels, loc="upper left", ncols=LEGEND_COLUMNS, fontsize=8.5, borderaxespad=0.2)
    for handle in legend.legend_handles:
        if isinstance(handle, PathCollection):
            handle.set_sizes([20.0])


def _wrapped(label: str, inches: float) -> str:
    """A label that is no longer than its axis."""
    return textwrap.fill(label, max(16, int(inches / 0.07)), break_long_words=False)


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
    """Every objective over every quantity: one point per design, with its limits."""
    varied = answers.setup.varied[:QUANTITIES_MAX]
    rows, columns = effect_panels(answers)
    turned = [one for one in varied if len(one.quantity.choices) > CHOICES_LEVEL]
    longest = max((len(name) for one in turned for name in one.quantity.choices), default=0)
    room = {"bottom_in": BOTTOM_IN + 0.06 * longest, "sharey": "row", "sharex": "col"}
    figure, grid = _panels(rows, columns, 2.0, 2, (0.15, 0.2), **room)
    shown = drawn(answers, rows * columns)
    good, bad = shown[answers.feasible[shown]], shown[~answers.feasible[shown]]
    x = [answers.shown_designs(j) for j in range(columns)]
    y = [answers.shown_values(i) for i in range(rows)]
    width = WIDTH_IN / columns
    for i in range(rows):
        for j, one in enumerate(varied):
            axes: Axes = grid[i, j]
            for which, colour, label in (
                (bad, INFEASIBLE_COLOUR, "constraints not met"),
                (good, DESIGN_COLOUR, "designs"),
            ):
                _points(axes, x[j], y[i], which, colour, label)
            if i == rows - 1:
                _quantity_ticks(axes, one, width)
                name = axis_label(one.quantity.name.removeprefix("testbed."), one.unit.shown)
                axes.set_xlabel(_wrapped(name, width))
            if j == 0:
                axes.set_ylabel(_wrapped(axis_label(answers.goals[i].metric.name, answers.goal_unit(i).shown), 1.8))
        for j in range(columns):
            draw_limits(grid[i, j], limit_lines(answers, i), "y", named=j == columns - 1)
    _legend(figure, grid[0, 0])
    return figure


def _quantity_ticks(axes: Axes, one: Varied, width_in: float) -> None:
    quantity, spread = one.quantity, one.spread
    if spread is not None and spread.kind == "loguniform":
        axes.set_xscale("log")
        axes.minorticks_off()
        ticks = np.geomspace(one.unit.of(spread.low), one.unit.of(spread.high), 3)
        axes.set_xticks(ticks, [f"{tick:.4g}" for tick in ticks])
    if quantity.kind == "choice":
        many = len(quantity.choices) > CHOICES_LEVEL
        every = 1 + int((len(quantity.choices) - 1) * CHOICE_IN / width_in) if many else 1
        axes.set_xticks(
            range(0, len(quantity.choices), every),
            quantity.choices[::every],
            rotation=90 if many else 0,
            fontsize=6.5 if many else None,
        )


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


def traces(results: Mapping[int, Mapping[str, Result]], answers: Answers | None = None) -> Figure:
    """Contact force of the chosen designs over the time since the contact, one panel per collision.

    ``answers`` have the limits of forces and of the detection time, and the units of both.
    """
    names = list(next(iter(results.values())))
    figure, grid = _panels(len(names), 1, 2.2, len(results), (0.2, 0.45), sharex=True)
    force_unit = _unit_of(answers, FORCES, "N")
    time_unit = _unit_of(answers, (DETECTION,), "ms")
    before, after = time_unit.of(-BEFORE_MS), time_unit.of(AFTER_MS)
    for axes, name in zip(grid[:, 0], names, strict=True):
        for colour, (design, by_collision) in zip(CHOSEN_COLOURS * 4, results.items(), strict=False):
            result = by_collision[name]
            contact_s = float(result.traces["testbed.truth.first_contact_time"].values[-1])
            time = 1e3 * (result.traces["time"].values - max(contact_s, 0.0)) / time_unit.scale
            shown = (time >= before) & (time <= after)
            force = result.traces["testbed.truth.contact_force"].values / force_unit.scale
            axes.plot(time[shown], force[shown], color=colour, label=f"design {design}")
            detected = result.metric(DETECTION).value
            if detected is not None:
                axes.axvline(time_unit.of(detected), color=colour, ls="--", lw=0.9)
        axes.set_ylabel(axis_label("contact force", force_unit.shown))
        axes.set_title(name)
        if answers is not None:
            draw_limits(axes, limits_of_metrics(answers, FORCES, force_unit), "y")
            draw_limits(axes, limits_of_metrics(answers, (DETECTION,), time_unit), "x")
    _legend(figure, grid[0, 0])
    grid[-1, 0].set_xlabel(axis_label("time since the contact", time_unit.shown))
    return figure


def _unit_of(answers: Answers | None, metrics: tuple[str, ...], unit: str) -> WrittenUnit:
    """The unit that the user wrote for one of these metrics; left out: ``unit``."""
    constraints = answers.setup.constraints if answers is not None else ()
    written = (one.written for one in constraints if one.goal.metric.name in metrics)
    return next((found for found in written if found is not None), WrittenUnit(unit))
