"""The figures of a report, with all bumpers in one panel as in the paper's Fig. 10; time starts at the first
contact."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.style import context

from giveway.report.figure_data import figure_data
from giveway.report.runs import IMPACT_MS, Run, force_window_ms
from giveway.report.style import STYLE, TRUTH_COLOUR
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from giveway.simulation.result import Result

__all__ = ["NamedFigure", "figures"]

WIDTH_IN = 9.6
LEFT_IN, RIGHT_IN, TOP_IN, BOTTOM_IN = 0.72, 0.12, 0.3, 0.48  # around the panels: axis labels and titles fit in
LEGEND_IN = 0.28  # below them
BETWEEN_IN = (0.2, 0.5)  # columns, whose numbers are those of the first one; rows


@dataclass(frozen=True)
class NamedFigure:
    """A figure with its texts; ``data``: of `figure_data`, for the page's script."""

    title: str
    caption: str
    data: dict[str, Any]


def figures(results: Mapping[str, Result]) -> list[NamedFigure]:
    """All figures for ``results`` by label."""
    runs = [Run(label, result) for label, result in results.items()]
    drawn = []
    with context(STYLE):
        for title, caption, draw in _FIGURES:
            drawn.append(NamedFigure(title, caption, figure_data(draw(runs))))
    return drawn


def _contact_force(runs: list[Run]) -> Figure:
    figure, panels = _panels(1, 1, 3.3)
    axes = panels[0, 0]
    window = force_window_ms(runs)
    for run in runs:
        run.draw_force(axes, window, run.label)
        run.mark_detection(axes)
    axes.set(xlabel="time since contact (ms)", ylabel="contact force (N)", xlim=window)
    axes.set_ylim(bottom=0.0)
    axes.margins(y=0.12)
    axes.legend(loc="upper right")
    return figure


def _wheel_torques(runs: list[Run]) -> Figure:
    figure, panels = _panels(1, WHEELS, 3.2, legend=True)
    for wheel, axes in enumerate(panels[0]):
        for run in runs:
            torque = run.hit[f"testbed.truth.wheel_torque[{wheel}]"]
            axes.plot(run.time_ms[run.impact], torque[run.impact], color=run.colour, label=run.label)
            run.mark_detection(axes)
        axes.set(title=f"wheel {wheel}", xlabel="time since contact (ms)", xlim=IMPACT_MS)
    panels[0, 0].set_ylabel("wheel torque (N m)")
    _legend_below(figure, panels[0, 0])
    return figure


def _positions(runs: list[Run]) -> Figure:
    figure, panels = _panels(2, len(runs), 5.4)
    for column, run in enumerate(runs):
        base, reference = run.position("testbed.truth"), run.position("controller.reference")
        nose = run.travel(run.nose)
        escape = run.time_s >= IMPACT_MS[0] / 1e3
        for axes, rows, time, scale in (
            (panels[0, column], run.impact, run.time_ms, 1.0),
            (panels[1, column], escape, run.time_s, 1e-3),
        ):
            axes.plot(time[rows], 1e3 * nose[rows], color=TRUTH_COLOUR, linewidth=1.2, label="slider nose")
            axes.plot(time[rows], 1e3 * base[rows], color=run.colour, label="robot base")
            axes.plot(
                time[rows], 1e3 * reference[rows], color="#2b2f36", linewidth=1.0, linestyle=":", label="reference"
            )
            run.mark_detection(axes, scale)
        panels[0, column].set(title=run.label, xlabel="time since contact (ms)", xlim=IMPACT_MS)
        panels[1, column].set(xlabel="time since contact (s)", xlim=(IMPACT_MS[0] / 1e3, float(run.time_s[-1])))
    panels[0, 0].legend(loc="upper left")
    for row in range(2):
        panels[row, 0].set_ylabel("travel (mm)")
    return figure


def _estimates(runs: list[Run]) -> Figure:
    figure, panels = _panels(2, len(runs), 5.0)
    for column, run in enumerate(runs):
        hit, rows, time = run.hit, run.impact, run.time_ms
        step_s = float(run.time_s[1] - run.time_s[0])
        since = (run.time_s >= 0.0).astype(float)
        estimated = [np.cumsum(hit[f"controller.estimate.force_{axis}"] * since) * step_s for axis in "xy"]
        true = [hit[f"testbed.truth.contact_impulse_{axis}"] for axis in "xy"]
        for axes, truth, estimate in (
            (panels[0, column], hit["testbed.truth.contact_force"], hit["controller.estimate.force"]),
            (panels[1, column], np.hypot(*true), np.hypot(*estimated)),
        ):
            axes.fill_between(time[rows], truth[rows], color=TRUTH_COLOUR, alpha=0.25, linewidth=0)
            axes.plot(time[rows], truth[rows], color=TRUTH_COLOUR, linewidth=1.2, label="true")
            axes.plot(time[rows], estimate[rows], color=run.colour, label="estimated")
            run.mark_detection(axes)
        panels[0, column].set(title=run.label, xlim=IMPACT_MS)
        panels[1, column].set(xlabel="time since contact (ms)", xlim=IMPACT_MS)
    panels[0, 0].legend(loc="upper right")
    panels[0, 0].set_ylabel("force (N)")
    panels[1, 0].set_ylabel("impulse (N s)")
    return figure


_FIGURES: tuple[tuple[str, str, Callable[[list[Run]], Figure]], ...] = (
    (
        "Contact force",
        "True force between cover and robot. Dashed: the moment the controller decides that this is a collision.",
        _contact_force,
    ),
    (
        "Wheel torques",
        "True drivetrain torque at each wheel: first the impact, then the drive away from it. Dashed: detection.",
        _wheel_torques,
    ),
    (
        "Positions along the impact",
        "Travel of base, slider nose and the reference since contact; above the impact, below the whole escape.",
        _positions,
    ),
    (
        "Estimate against truth",
        (
            "Contact force and its impulse: estimated from wheel torques alone, and as the testbed knows them (grey). "
            "After detection the robot accelerates, which an estimate with planned acceleration takes for force."
        ),
        _estimates,
    ),
)


def _panels(rows: int, columns: int, height_in: float, legend: bool = False) -> tuple[Figure, NDArray[Any]]:
    """A figure with fixed margins: a layout engine would take as long as the drawing."""
    figure = Figure(figsize=(WIDTH_IN, height_in))
    bottom_in = BOTTOM_IN + (LEGEND_IN if legend else 0.0)
    panel_in = (
        (WIDTH_IN - LEFT_IN - RIGHT_IN - (columns - 1) * BETWEEN_IN[0]) / columns,
        (height_in - TOP_IN - bottom_in - (rows - 1) * BETWEEN_IN[1]) / rows,
    )
    figure.subplots_adjust(
        left=LEFT_IN / WIDTH_IN,
        right=1.0 - RIGHT_IN / WIDTH_IN,
        top=1.0 - TOP_IN / height_in,
        bottom=bottom_in / height_in,
        wspace=BETWEEN_IN[0] / panel_in[0],
        hspace=BETWEEN_IN[1] / panel_in[1],
    )
    return figure, figure.subplots(rows, columns, sharey="row", squeeze=False)


def _legend_below(figure: Figure, axes: Axes) -> None:
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=len(labels))
