"""One picture of a collision: the robot from above before, at and after detection, and the forces."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon, Rectangle
from matplotlib.style import context
from matplotlib.transforms import Affine2D

from giveway.report.obstacle import SLIDER_M
from giveway.report.runs import IMPACT_MS, Run, force_window_ms
from giveway.report.style import STYLE, TRUTH_COLOUR
from giveway.robot.wheels import AZIMUTHS_RAD
from giveway.simulation.summary import table_rows

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from giveway.simulation.result import Result

__all__ = ["numbers", "overview", "write_overview"]

INK = "#2b2f36"
ESCAPED_S = 2.0  # the last of the three poses, after contact
ARROW_M_PER_N = 0.01
ESTIMATE_COLOUR = "#c8500a"
WHEEL_WIDTH_M = 0.04


def write_overview(path: Path, results: Mapping[str, Result]) -> None:
    """Write a PNG of `overview`."""
    with context(STYLE):
        # The picture contains its numbers, so that an outdated copy can be recognised.
        overview(results).savefig(path, dpi=130, metadata={"Software": None, "Description": numbers(results)})


def overview(results: Mapping[str, Result]) -> Figure:
    """Of ``results`` (by label): top view of the last one, contact force and escape of all."""
    runs = [Run(label, result) for label, result in results.items()]
    with context(STYLE):
        figure = Figure(figsize=(10.5, 4.6), layout="constrained")
        grid = figure.add_gridspec(2, 2, width_ratios=(1.0, 1.35))
        _top_view(figure.add_subplot(grid[:, 0]), runs[-1])
        _forces(figure.add_subplot(grid[0, 1]), runs)
        _escapes(figure.add_subplot(grid[1, 1]), runs)
    return figure


def numbers(results: Mapping[str, Result]) -> str:
    """The table as text, without rounding noise."""
    noise = {metric.name for metric in next(iter(results.values())).metrics if metric.decimals is None}
    return "\n".join(" | ".join(row) for row in table_rows(results) if row[0] not in noise)


def _top_view(axes: Axes, run: Run) -> None:
    rows = {"contact": run.contact_row, "escaped": int(np.searchsorted(run.time_s, ESCAPED_S))}
    rows["escaped"] = min(rows["escaped"], len(run.time_s) - 1)
    _draw_robot(axes, run, rows["escaped"], 0.35)
    _draw_robot(axes, run, rows["contact"], 1.0)
    _draw_slider(axes, run, rows["contact"])
    if run.hit.detected is not None:
        _draw_estimate(axes, run, run.hit.detected)
    axes.set_aspect("equal")
    axes.grid(False)
    axes.set(title=f"{run.label}: at contact and (faint) {ESCAPED_S:g} s later", xlabel="x (m)", ylabel="y (m)")
    axes.autoscale_view()
    axes.margins(0.04)


def _parameters(run: Run) -> dict[str, Any]:
    return dict(run.parameters["testbed"])


def _pose(run: Run, row: int) -> Affine2D:
    x, y, theta = (float(run.hit[f"testbed.truth.{name}"][row]) for name in ("x", "y", "theta"))
    return Affine2D().rotate(theta).translate(x, y)


def _draw_robot(axes: Axes, run: Run, row: int, strength: float) -> None:
    parameters, pose = _parameters(run), _pose(run, row)
    corners = [[parameters[f"outline.{axis}[{i}]"] for axis in "xy"] for i in range(int(parameters["outline.count"]))]
    radius, distance = float(parameters["wheel.radius"]), float(parameters["wheel.distance"])
    for azimuth in AZIMUTHS_RAD:
        turn = Affine2D().translate(distance - WHEEL_WIDTH_M / 2, -radius).rotate(azimuth) + pose
        corner = Rectangle((0.0, 0.0), WHEEL_WIDTH_M, 2.0 * radius, color=TRUTH_COLOUR, alpha=0.6 * strength, lw=0)
        corner.set_transform(turn + axes.transData)
        axes.add_patch(corner)
    outline = pose.transform(np.asarray(corners, dtype=float))
    axes.add_patch(Polygon(outline, closed=True, facecolor="#eef2f7", edgecolor=INK, lw=1.3, alpha=strength))
    axes.update_datalim(outline)


def _draw_slider(axes: Axes, run: Run, row: int) -> None:
    angle = math.atan2(run.along[1], run.along[0])
    nose_radius = float(_parameters(run)["contact.nose_radius"])
    place = Affine2D().rotate(angle).translate(*run.nose[row])
    length, width = SLIDER_M
    shapes = (
        Rectangle((-0.06 - length, -width / 2), length, width, facecolor="#d6dbe3", edgecolor=INK, lw=1.0),
        Rectangle((-0.06, -0.004), 0.06 - nose_radius, 0.008, color=TRUTH_COLOUR, lw=0),
        Circle((-nose_radius, 0.0), nose_radius, color=run.colour, lw=0),
    )
    for shape in shapes:
        shape.set_transform(place + axes.transData)
        axes.add_patch(shape)
    axes.update_datalim([tuple(run.nose[row] - (0.06 + length) * run.along)])


def _draw_estimate(axes: Axes, run: Run, row: int) -> None:
    """Point and mean force up to detection: true, and as the detector estimated them."""
    pose = _pose(run, row)
    turn = Affine2D().rotate(float(run.hit["testbed.truth.theta"][row]))
    lasted_s = max(float(run.time_s[row]), 1e-3)
    impulse = run.hit.true_impulse()
    pairs = [
        ("true", run.hit.true_point(), None if impulse is None else impulse / lasted_s, INK, 4.5),
        (
            "estimated from wheel torques",
            np.array([run.hit[f"controller.detection.point_{axis}"][row] for axis in "xy"]),
            np.array([run.hit[f"controller.detection.force_{axis}"][row] for axis in "xy"]),
            ESTIMATE_COLOUR,
            1.8,
        ),
    ]
    for label, point, force, colour, width in pairs:
        if point is None or force is None:
            continue
        tip = pose.transform(point)
        tail = tip - ARROW_M_PER_N * turn.transform(force)
        axes.annotate(
            "", xy=tuple(tip), xytext=tuple(tail), arrowprops={"arrowstyle": "-|>", "color": colour, "lw": width}
        )
        axes.update_datalim([tuple(tail)])
        axes.plot([], [], color=colour, linewidth=width, label=label)
    axes.legend(loc="lower right", title="mean push up to detection", title_fontsize=9)


def _forces(axes: Axes, runs: list[Run]) -> None:
    window = force_window_ms(runs)
    for run in runs:
        noticed = "not noticed" if run.detected_ms is None else f"noticed after {run.detected_ms:.0f} ms"
        run.draw_force(axes, window, f"{run.label}: {noticed}")
        run.mark_detection(axes)
    axes.set(xlabel="time since contact (ms)", ylabel="contact force (N)", xlim=window)
    axes.margins(y=0.12)
    axes.set_ylim(bottom=0.0)
    axes.legend(loc="center", bbox_to_anchor=(0.7, 0.75), fontsize=8)


def _escapes(axes: Axes, runs: list[Run]) -> None:
    for run in runs:
        rows = (run.time_s >= IMPACT_MS[0] / 1e3) & (run.time_s <= 5.0)
        axes.plot(run.time_s[rows], run.position("testbed.truth")[rows], color=run.colour)
    axes.set(xlabel="time since contact (s)", ylabel="robot gives way (m)", xlim=(IMPACT_MS[0] / 1e3, 5.0))
