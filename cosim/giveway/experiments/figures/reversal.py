"""The paper's Fig. 11: a moving robot hits and reverses; positions, speeds, the torque of wheel 0 and forces."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.style import context

from giveway.report.runs import Run
from giveway.report.style import STYLE, TRUTH_COLOUR

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from giveway.simulation.result import Result

__all__ = ["draw"]

SHOWN_MS = (-200.0, 800.0)
WHEEL = 0
INK = "#2b2f36"
SLIDER_COLOUR = "#c8500a"


def draw(label: str, result: Result) -> Figure:
    """The figure for one result; ``label`` has a colour in `giveway.report.style`. Forward is where it drove."""
    run = Run(label, result)
    with context(STYLE):
        figure = Figure(figsize=(9.6, 7.4), layout="constrained")
        positions, speeds, torques = figure.subplots(3, 1, sharex=True)
        _positions(positions, run)
        _speeds(speeds, run)
        _torques(torques, run)
        for axes in (positions, speeds, torques):
            run.mark_detection(axes)
            axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
        torques.set(xlabel="time since contact (ms)", xlim=SHOWN_MS)
    return figure


def _plot(axes: Axes, run: Run, values: NDArray[np.float64], label: str, colour: str, style: str = "-") -> None:
    rows = (run.time_ms >= SHOWN_MS[0]) & (run.time_ms <= SHOWN_MS[1])
    axes.plot(run.time_ms[rows], values[rows], color=colour, linestyle=style, label=label)


def _positions(axes: Axes, run: Run) -> None:
    slider = run.hit["testbed.truth.slider_position"]
    wheel = run.hit[f"testbed.truth.wheel_angle[{WHEEL}]"]
    turned = wheel - wheel[run.contact_row]
    # A wheel at 30 deg to the direction of travel turns by cos(30 deg) of it.
    sign = 1.0 if turned[run.contact_row - 1] < 0.0 else -1.0
    radius = float(run.parameters["testbed"]["wheel.radius"])
    _plot(axes, run, -1e3 * run.position("testbed.truth"), "robot", run.colour)
    _plot(axes, run, -1e3 * run.travel(run.nose), "bumper end", TRUTH_COLOUR)
    _plot(axes, run, -1e3 * (slider - slider[run.contact_row]), "slider", SLIDER_COLOUR)
    _plot(axes, run, 1e3 * run.hit["testbed.truth.bumper_compression"], "spring deflection", INK)
    _plot(axes, run, 1e3 * sign * radius * turned, f"wheel {WHEEL}, at its rim", INK, ":")
    axes.set(title="positions since contact (mm), forward is up")


def _speeds(axes: Axes, run: Run) -> None:
    along = [np.stack([run.hit[f"{source}.v{axis}"] for axis in "xy"], axis=1) @ run.along for source in _SOURCES]
    _plot(axes, run, -along[0], "robot", run.colour)
    _plot(axes, run, -along[1], "reference", INK, ":")
    _plot(axes, run, -run.hit["testbed.truth.slider_speed"], "slider", SLIDER_COLOUR)
    axes.set(title="speeds (m/s)")


_SOURCES = ("testbed.truth", "controller.reference")


def _torques(axes: Axes, run: Run) -> None:
    sign = run.hit.impact_sign(WHEEL)
    _plot(axes, run, sign * run.hit[f"testbed.sensor.torque[{WHEEL}]"], f"torque of wheel {WHEEL} (N m)", run.colour)
    _plot(axes, run, run.hit["controller.estimate.force"] / 10.0, "force, estimated (10 N)", INK)
    _plot(axes, run, run.hit["testbed.truth.contact_force"] / 10.0, "force, true (10 N)", TRUTH_COLOUR)
    axes.set(title="torque (positive: as the impact makes it) and force")
