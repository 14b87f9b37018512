"""Scenes from above: the robot with its wheels, the obstacle, and the estimated contact point."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from matplotlib.style import context

from giveway.report.obstacle import EDGE_DEPTH_M, EDGE_M, rail
from giveway.report.style import STYLE, TRUTH_COLOUR
from giveway.robot.footprint import wheel_corners
from giveway.scenario.approach import outline_of
from giveway.simulation.metrics import Collision

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from giveway.simulation.result import Result

__all__ = ["scenes_figure"]

INK, ESTIMATE_COLOUR = "#2b2f36", "#c8500a"
ARROW_M_PER_N = 0.004
WIDTH_M, HEIGHT_M = 1.3, 1.6  # of a panel


def scenes_figure(results: Mapping[str, Result]) -> Figure:
    """One panel per scene, by title."""
    with context(STYLE):
        figure = Figure(figsize=(9.6, 4.6), layout="constrained")
        for axes, (title, result) in zip(
            figure.subplots(1, len(results), squeeze=False)[0], results.items(), strict=True
        ):
            _draw(
                axes, Collision(result.traces, result.manifest["parameters"]), result.manifest["parameters"]["testbed"]
            )
            axes.set_title(title, fontsize=8.5)
        figure.axes[0].set_ylabel("y (m)")
        handles, labels = axes.get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure


def _draw(axes: Axes, hit: Collision, testbed: Mapping[str, Any]) -> None:
    contact = hit.start
    corners = np.concatenate([
        _draw_robot(axes, hit, testbed, row, alpha) for row, alpha in ((-1, 0.3), (contact, 1.0))
    ])  # fmt: skip
    _draw_obstacle(axes, hit, testbed, contact)
    true = hit.true_point()
    if true is not None and hit.detected is not None:
        place = _to_world(hit, contact, true[None, :])[0]
        axes.plot(*place, "x", color=INK, markersize=8, markeredgewidth=2, label="true contact point")
        estimate = [[hit[f"controller.detection.point_{axis}"][hit.detected] for axis in "xy"]]
        estimated = _to_world(hit, contact, np.array(estimate))[0]
        axes.plot(*estimated, "o", color=ESTIMATE_COLOUR, fillstyle="none", markersize=9, label="estimate")
        force = [[hit[f"controller.detection.force_{axis}"][hit.detected] for axis in "xy"]]
        arrow = (
            ARROW_M_PER_N * (_to_world(hit, contact, np.array(force)) - _to_world(hit, contact, np.zeros((1, 2))))[0]
        )
        axes.annotate("", estimated + arrow, estimated, arrowprops={"arrowstyle": "->", "color": ESTIMATE_COLOUR})
    path = np.stack([hit["testbed.truth.x"], hit["testbed.truth.y"]])
    axes.plot(*path[:, :contact], ":", color=INK, linewidth=1.0, label="path before contact")
    axes.plot(*path[:, contact:], color=ESTIMATE_COLOUR, linewidth=1.2, label="path after contact")
    axes.set_aspect("equal")
    # Panels of equal size for any escape.
    middle = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    axes.set(xlim=middle[0] + np.array([-0.5, 0.5]) * WIDTH_M, ylim=middle[1] + np.array([-0.5, 0.5]) * HEIGHT_M)
    axes.set_xlabel("x (m)")


def _draw_robot(axes: Axes, hit: Collision, testbed: Mapping[str, Any], row: int, alpha: float) -> NDArray[np.float64]:
    """Body and wheels at ``row``; returns the corners of the body in the world."""
    body = _to_world(hit, row, outline_of(testbed))
    axes.add_patch(Polygon(body, closed=True, facecolor="#dfe5ec", edgecolor=INK, alpha=alpha, linewidth=1.2))
    for wheel in wheel_corners(testbed):
        axes.add_patch(Polygon(_to_world(hit, row, wheel), closed=True, color=INK, alpha=0.75 * alpha))
    return body


def _draw_obstacle(axes: Axes, hit: Collision, testbed: Mapping[str, Any], row: int) -> None:
    along = np.array(rail(testbed))
    tip = np.array([hit[f"testbed.truth.nose_{axis}"][row] for axis in "xy"])
    across = np.array([-along[1], along[0]])
    if testbed["contact.nose_shape"] == 1:
        half, back = 0.5 * EDGE_M * across, -EDGE_DEPTH_M * along
        edge = [tip - half, tip + half, tip + half + back, tip - half + back]
        axes.add_patch(Polygon(edge, closed=True, color=TRUTH_COLOUR, alpha=0.7))
    else:
        radius = float(testbed["contact.nose_radius"])
        axes.add_patch(Circle(tuple(tip - radius * along), radius, color=TRUTH_COLOUR, alpha=0.7))
    axes.plot(*np.stack([tip, tip - 0.5 * along]).T, "--", color=TRUTH_COLOUR, linewidth=0.8)


def _to_world(hit: Collision, row: int, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points of the base frame, shape (n, 2), m, in the world at ``row``."""
    theta = hit["testbed.truth.theta"][row]
    turn = np.array([[math.cos(theta), -math.sin(theta)], [math.sin(theta), math.cos(theta)]])
    place = np.array([hit["testbed.truth.x"][row], hit["testbed.truth.y"][row]])
    return np.asarray(points @ turn.T + place)
