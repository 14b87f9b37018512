"""The paper's Fig. 10: one hit with each bumper; travel, forces and the torque of wheel 0 in common panels."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.style import context

from giveway.report.runs import Run
from giveway.report.style import STYLE

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from giveway.simulation.result import Result

__all__ = ["draw"]

SHOWN_MS = (-40.0, 500.0)
WHEEL = 0


def draw(results: Mapping[str, Result]) -> Figure:
    """The figure for ``results`` by label, each with a colour in `giveway.report.style`."""
    runs = [Run(label, result) for label, result in results.items()]
    with context(STYLE):
        figure = Figure(figsize=(9.6, 6.2), layout="constrained")
        panels = figure.subplots(2, 2, sharex=True)
        _panel(panels[0, 0], runs, "travel of the robot (mm)", lambda run: 1e3 * run.position("testbed.truth"))
        _panel(panels[0, 1], runs, "force, estimated (N)", lambda run: run.hit["controller.estimate.force"])
        _panel(panels[1, 0], runs, f"torque of wheel {WHEEL}, measured (N m); the impact is positive", _torque)
        _panel(panels[1, 1], runs, "force, true (N)", lambda run: run.hit["testbed.truth.contact_force"])
        for axes in panels[1]:
            axes.set(xlabel="time since contact (ms)", xlim=SHOWN_MS)
        handles, labels = panels[1, 1].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


def _panel(axes: Axes, runs: list[Run], title: str, values: Callable[[Run], NDArray[np.float64]]) -> None:
    for run in runs:
        rows = (run.time_ms >= SHOWN_MS[0]) & (run.time_ms <= SHOWN_MS[1])
        noticed = "" if run.detected_ms is None else f": noticed after {run.detected_ms:.0f} ms"
        axes.plot(run.time_ms[rows], values(run)[rows], color=run.colour, label=f"{run.label}{noticed}")
        run.mark_detection(axes)
    axes.set(title=title)


def _torque(run: Run) -> NDArray[np.float64]:
    sign = run.hit.impact_sign(WHEEL)
    return np.asarray(sign * run.hit[f"testbed.sensor.torque[{WHEEL}]"])
