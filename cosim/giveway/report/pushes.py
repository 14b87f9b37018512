"""Figures of a run with pushes: each push with its estimate, and the path from above."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.style import context

from giveway.report import push_path
from giveway.report.figure_data import figure_data
from giveway.report.figures import NamedFigure
from giveway.report.style import STYLE, TRUTH_COLOUR
from giveway.scenario.approach import outline_of
from giveway.simulation.push_response import responses_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from giveway.simulation.push_response import PushResponse
    from giveway.simulation.result import Result

__all__ = ["figures"]

WIDTH_IN, PANEL_IN, ACROSS = 9.6, 2.6, 3
BEFORE_S, AFTER_S = 0.1, 0.4  # shown around each push
FELT_COLOUR, DETECTED_COLOUR = "#0b64a8", "#c8500a"


def figures(result: Result) -> list[NamedFigure]:
    """The figures of one run; none without scheduled pushes."""
    found = responses_of(result.traces, result.manifest)
    if not found.pushes:
        return []
    outline = outline_of(result.manifest["parameters"]["testbed"])
    name = result.manifest["scenario"]["name"]
    with context(STYLE):
        forces = figure_data(_forces(result, found.pushes))
    above = figure_data(push_path.path({name: (result.traces, found)}, outline))
    return [
        NamedFigure(
            "Each push",
            "Grey: the force that pushed; line: the estimate from wheel torques alone. Dashed: when the controller "
            "decides that it is pushed.",
            forces,
        ),
        NamedFigure(
            "Path and pushes from above",
            "Motion of the base as the testbed knows it. Arrows: pushes, with the robot where it felt them; crosses: "
            "what it felt besides, once more or with nothing there.",
            above,
        ),
    ]


def _forces(result: Result, pushes: tuple[PushResponse, ...]) -> Figure:
    rows, columns = math.ceil(len(pushes) / ACROSS), min(ACROSS, len(pushes))
    figure = Figure(figsize=(WIDTH_IN, 0.6 + PANEL_IN * rows), layout="constrained")
    panels = figure.subplots(rows, columns, sharey=True, squeeze=False).ravel()
    for number, (one, axes) in enumerate(zip(pushes, panels, strict=False), 1):
        _draw(axes, result, number, one)
    for axes in panels[len(pushes) :]:
        axes.set_visible(False)
    for axes in panels[::columns]:
        axes.set_ylabel("force (N)")
    panels[0].legend(loc="upper right")
    return figure


def _draw(axes: Axes, result: Result, number: int, one: PushResponse) -> None:
    traces, push = result.traces, one.push
    since_s = traces["time"].values - push.start_s
    shown = (since_s >= -BEFORE_S) & (since_s <= push.duration_s + AFTER_S)
    true = np.hypot(*(traces[f"testbed.push.force_{axis}"].values[shown] for axis in "xy"))
    axes.fill_between(since_s[shown], true, color=TRUTH_COLOUR, alpha=0.3, linewidth=0, label="true")
    axes.plot(since_s[shown], traces["controller.estimate.force"].values[shown], color=FELT_COLOUR, label="estimated")
    detections = [one.detected_s, *one.again_s] if one.detected_s is not None else []
    for time_s in detections:
        axes.axvline(time_s - push.start_s, color=DETECTED_COLOUR, linestyle=(0, (4, 3)), linewidth=1.0)
    felt = "not felt" if one.detected_s is None else f"felt after {1e3 * (one.detected_s - push.start_s):.0f} ms"
    axes.set(title=f"{number}: {push.force_n:g} N, {felt}", xlabel=f"time since {push.start_s:g} s (s)")
    axes.set_ylim(bottom=0.0)
