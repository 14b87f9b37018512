"""The pushed path from above, as the paper's Fig. 12."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.style import context

from giveway.report.style import STYLE, TRUTH_COLOUR
from giveway.robot.variables import table
from giveway.scenario.approach import outline_of

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from giveway.simulation.push_response import PushResponse, Responses

__all__ = ["PUSH_COLOUR", "path"]

# controller.mode: its name in the legend, and its colour
MODES = {1: ("on the circle", "#0b64a8"), 2: ("giving way", "#c8500a"), 4: ("going back", "#0a8a63")}
PUSH_COLOUR = "#2b2f36"
METRES_PER_NEWTON = 0.006


def path(runs: Mapping[str, tuple[xarray.Dataset, Responses]], outline: NDArray[np.float64] | None = None) -> Figure:
    """The path of each run by name, its pushes and escapes; ``outline`` of the robot, None: the default one's."""
    if outline is None:
        outline = outline_of({v.name: v.start for v in table("testbed").select("parameter") if v.start is not None})
    with context(STYLE):
        figure = Figure(figsize=(9.6, 5.6), layout="constrained")
        panels = figure.subplots(1, len(runs), sharex=True, sharey=True, squeeze=False)[0]
        for axes, (name, (traces, found)) in zip(panels, runs.items(), strict=True):
            _draw_path(axes, traces, found, outline)
            axes.set(
                title=f"{name}:\n{found.detected} of {len(found.pushes)} noticed, {len(found.invented_s)} invented"
            )
            axes.set(xlabel="x (m)", aspect="equal")
        panels[0].set_ylabel("y (m)")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


def _draw_path(axes: Axes, traces: xarray.Dataset, found: Responses, outline: NDArray[np.float64]) -> None:
    x, y = (traces[f"testbed.truth.{axis}"].values for axis in "xy")
    mode = traces["controller.mode"].values
    planned = [traces[f"controller.plan.{axis}"].values for axis in "xy"]
    axes.plot(*planned, color=TRUTH_COLOUR, linewidth=1.0, linestyle=(0, (4, 3)), label="plan")
    for number, (label, colour) in MODES.items():
        shown = mode == number
        axes.plot(np.where(shown, x, np.nan), np.where(shown, y, np.nan), color=colour, label=label)
    for number, one in enumerate(found.pushes, start=1):
        row = int(np.searchsorted(traces["time"].values, one.detected_s or one.push.start_s))
        heading = float(traces["testbed.truth.theta"][row])
        _draw_push(axes, one, number, np.array([x[row], y[row]]), heading, outline)
    rows = np.searchsorted(traces["time"].values, found.invented_s)
    axes.plot(x[rows], y[rows], "x", color="#b00020", markersize=6, label="invented")


def _draw_push(
    axes: Axes,
    one: PushResponse,
    number: int,
    base: NDArray[np.float64],
    heading: float,
    outline: NDArray[np.float64],
) -> None:
    turn = np.array([[math.cos(heading), -math.sin(heading)], [math.sin(heading), math.cos(heading)]])
    corners = base + outline @ turn.T
    axes.fill(*corners.T, facecolor="none", edgecolor=TRUTH_COLOUR, linewidth=0.8)
    point = base + turn @ (one.push.point_x_m, one.push.point_y_m)
    along = np.array([math.cos(one.push.direction_rad), math.sin(one.push.direction_rad)])
    tail = point - METRES_PER_NEWTON * one.push.force_n * along
    axes.annotate(
        "",
        (point[0], point[1]),
        (tail[0], tail[1]),
        arrowprops={"arrowstyle": "-|>", "color": PUSH_COLOUR, "shrinkA": 0, "shrinkB": 0},
    )
    x, y = tail - 0.05 * along
    axes.update_datalim([(x, y)])  # arrows and text do not affect the limits automatically
    axes.text(x, y, str(number), ha="center", va="center", color=PUSH_COLOUR)
