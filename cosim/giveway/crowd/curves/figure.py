"""The one figure of the curves: delay over false alarms per hour, a column for each situation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.style import context
from matplotlib.ticker import NullLocator

from giveway.crowd.curves.curve import Curve, Point, usable
from giveway.crowd.curves.situations import SITUATIONS
from giveway.report.style import STYLE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from giveway.crowd.statistics import Estimate

__all__ = ["LONGEST_MS", "draw", "write_figure"]

COLOURS = {
    "two channels": "#c8500a",
    "matched filters": "#0b64a8",
    "GLR": "#0a8a63",
    "CUSUM": "#8a6d00",
    "Kalman observer": "#7a2ea0",
    "force average": "#2b2f36",
    "force average, paper's estimator": "#8a8f98",
    "leaky impulse, paper's estimator": "#c0407a",
}
INK = "#555b65"
ROWS = (("median", "delay, median (ms)"), ("p95", "delay, 95th percentile (ms)"))
SHORTEST_MS = 5.0
LONGEST_MS = {"median": 300.0, "p95": 1000.0}
TICKS_MS = (5, 10, 20, 50, 100, 200, 500, 1000)
MOST_PER_HOUR = 3600.0
SIZE_IN = (11.0, 7.4)


def write_figure(path: Path, title: str, curves: Sequence[Curve]) -> None:
    """Write the PNG ``path``."""
    with context(STYLE):
        draw(title, curves).savefig(path, dpi=130, metadata={"Software": None})


def draw(title: str, curves: Sequence[Curve]) -> Figure:
    """A panel for each situation and percentile. Beyond `LONGEST_MS`, and where hits are missed, a line ends."""
    figure = Figure(figsize=SIZE_IN, layout="constrained")
    panels = figure.subplots(len(ROWS), len(SITUATIONS), sharex="col", sharey="row", squeeze=False)
    for (what, label), row in zip(ROWS, panels, strict=True):
        for situation, axes in zip(SITUATIONS, row, strict=True):
            for curve in curves:
                if curve.situation == situation:
                    _curve(axes, curve, what)
            axes.set(xscale="log", yscale="log", ylim=(SHORTEST_MS, LONGEST_MS[what]))
            axes.set_yticks([at for at in TICKS_MS if at <= LONGEST_MS[what]], minor=False)
            axes.yaxis.set_major_formatter("{x:g}")
            axes.yaxis.set_minor_locator(NullLocator())
            axes.set_xlim(right=MOST_PER_HOUR)
        row[0].set_ylabel(label)
    for situation, above, below in zip(SITUATIONS, panels[0], panels[-1], strict=True):
        above.set_title(situation)
        below.set_xlabel("false alarms (1/h)")
    figure.suptitle(title, x=0.01, ha="left", fontsize=10)
    names = {curve.candidate.name: COLOURS[curve.candidate.name] for curve in curves}
    for name, colour in names.items():
        panels[0][0].plot([], [], color=colour, label=name, linewidth=2.2 if name == "two channels" else 1.5)
    panels[0][0].plot([], [], "<", color=INK, markerfacecolor="none", label="no alarm: 95 % bound of the rate")
    figure.legend(*panels[0][0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
    return figure


def drawn(curve: Curve, what: str) -> tuple[list[tuple[float, Estimate]], tuple[float, float] | None]:
    """Rate and delay (ms) of the points with alarms, in the order of thresholds; bound and delay without an alarm."""
    points = [(point, estimate) for point in usable(curve) if (estimate := _delay(point, what)) is not None]
    shown = [(point, estimate) for point, estimate in points if estimate[0] <= LONGEST_MS[what]]
    some = [(point.per_hour[0], estimate) for point, estimate in shown if 0 < point.per_hour[0] <= MOST_PER_HOUR]
    none = [(point.per_hour[2], estimate[0]) for point, estimate in shown if not point.alarms]
    return some, none[0] if none and none[0][0] <= MOST_PER_HOUR else None


def _delay(point: Point, what: str) -> Estimate | None:
    return point.median_ms if what == "median" else point.p95_ms


def _curve(axes: Axes, curve: Curve, what: str) -> None:
    some, none = drawn(curve, what)
    name = curve.candidate.name
    colour, ours = COLOURS[name], name == "two channels"
    if some:
        rate = np.array([one for one, _ in some])
        at, low, high = (np.array([estimate[index] for _, estimate in some]) for index in range(3))
        high = np.minimum(high, LONGEST_MS[what])
        axes.fill_between(rate, low, high, color=colour, alpha=0.1, linewidth=0)
        axes.plot(rate, at, color=colour, marker="o" if ours else "", markersize=4.0, linewidth=2.2 if ours else 1.5)
        ends = {point.per_hour[0]: point.per_hour for point in curve.points}
        for one, delay in ((rate[-1], at[-1]), (rate[0], at[0])) if len(rate) > 1 else ((rate[-1], at[-1]),):
            axes.hlines(delay, *ends[float(one)][1:], color=colour, alpha=0.5, linewidth=0.9)
    if none is not None and math.isfinite(none[1]):
        axes.plot(*none, marker="<", color=colour, markerfacecolor="none", markersize=8.0 if ours else 6.0)
