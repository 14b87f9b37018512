"""A robot file as a drawing: from above with wheels and centre of mass, and from the side with heights."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.report.style import STYLE
from giveway.robot.footprint import wheel_corners
from giveway.robot.wheels import AZIMUTHS_RAD

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from giveway.own_robot.plausible import Numbers

__all__ = ["draw"]

BODY, WHEEL, MASS, TIP = "#0b64a8", "#4a5568", "#c8500a", "#8a8f98"
IMU: dict[str, Any] = {"mec": "#0a8a63", "mfc": "none", "mew": 1.5, "ms": 10}  # around the centre of mass, not over it


def draw(numbers: Numbers, name: str) -> Figure:
    """Both views, lengths in mm."""
    from matplotlib.figure import Figure
    from matplotlib.style import context

    with context(STYLE):
        figure = Figure(figsize=(9.6, 5.0), layout="constrained")
        above, side = figure.subplots(1, 2)
        for axes in (above, side):
            axes.set_axisbelow(True)
        _above(above, numbers)
        _side(side, numbers)
        figure.suptitle(f"{name}: {numbers.mass:g} kg", x=0.02, ha="left", fontsize=11)
        handles, labels = above.get_legend_handles_labels()
        more = dict(zip(*side.get_legend_handles_labels()[::-1], strict=True))
        shown = {**dict(zip(labels, handles, strict=True)), **more}
        figure.legend(shown.values(), shown.keys(), loc="outside lower center", ncols=5, fontsize=8.5)
    return figure


def _above(axes: Axes, n: Numbers) -> None:
    from matplotlib.patches import Polygon

    axes.add_patch(Polygon(1e3 * n.outline, closed=True, fc="#0b64a81a", ec=BODY, lw=1.5, label="body"))
    for index, corners in enumerate(wheel_corners(n.values["testbed"])):
        axes.add_patch(
            Polygon(1e3 * corners, closed=True, fc="#4a556833", ec=WHEEL, label="wheels" if not index else None)
        )
        azimuth = AZIMUTHS_RAD[index]
        where = (1e3 * n.distance * math.cos(azimuth), 1e3 * n.distance * math.sin(azimuth))
        axes.annotate(str(index), where, ha="center", va="center", fontsize=8)
    centres = 1e3 * n.distance * np.array([[math.cos(a), math.sin(a)] for a in (*AZIMUTHS_RAD, AZIMUTHS_RAD[0])])
    axes.plot(*centres.T, ":", color=TIP, lw=1.0, label="tips over these lines")
    axes.plot(1e3 * n.com[0], 1e3 * n.com[1], "o", color=MASS, label="centre of mass")
    if n.values["testbed"]["imu.present"]:
        axes.plot(1e3 * n["imu.x"], 1e3 * n["imu.y"], "s", **IMU, label="IMU")
    reach = 1e3 * max(n.plate.reach_m, n.distance + n.radius)
    axes.annotate("", (0.45 * reach, 0.0), (0.0, 0.0), arrowprops={"arrowstyle": "->", "color": TIP})
    axes.text(0.47 * reach, 0.0, "x", color=TIP, va="center", fontsize=8.5)
    axes.set(xlim=(-1.08 * reach, 1.08 * reach), ylim=(-1.08 * reach, 1.08 * reach))
    axes.set(xlabel="x, forward (mm)", ylabel="y, left (mm)", title="from above", aspect="equal")


def _side(axes: Axes, n: Numbers) -> None:
    from matplotlib.patches import Circle, Rectangle

    left, right = 1e3 * float(n.outline[:, 0].min()), 1e3 * float(n.outline[:, 0].max())
    low, top = 1e3 * n["outline.clearance"], 1e3 * n.height
    edge = "-" if n.height_is_stated else "--"
    axes.add_patch(Rectangle((left, low), right - left, top - low, fc="#0b64a81a", ec=BODY, lw=1.5, ls=edge))
    for azimuth in AZIMUTHS_RAD:
        # As wide as its shadow: a disc that turns about a radial axle.
        x, wide = 1e3 * n.distance * math.cos(azimuth), 1e3 * abs(math.sin(azimuth)) * n.radius
        half = max(wide, 0.5e3 * n["wheel.width"])
        axes.add_patch(Rectangle((x - half, 0.0), 2.0 * half, 2e3 * n.radius, fc="#4a556833", ec=WHEEL))
    axes.add_patch(Circle((1e3 * n.com[0], 1e3 * n.com_height), 0.012 * max(top, right - left), color=MASS))
    if n.values["testbed"]["imu.present"]:
        axes.plot(1e3 * n["imu.x"], 1e3 * n["imu.height"], "s", **IMU)
    axes.axhline(0.0, color="#2b2f36", lw=1.2)
    heights = {"body's top" if n.height_is_stated else "top, not stated": top}
    heights |= {"centre of mass": 1e3 * n.com_height, "clearance": low, "wheel": 2e3 * n.radius}
    _label_heights(axes, heights, right, max(top, 2e3 * n.radius))
    reach = max(-left, right, 1e3 * (n.distance + n.radius))
    axes.set(xlim=(-1.08 * reach, 2.1 * reach), ylim=(-0.04 * top, 1.08 * max(top, 2e3 * n.radius)))
    axes.set(xlabel="x, forward (mm)", ylabel="height (mm)", title="from the side", aspect="equal")


def _label_heights(axes: Axes, heights: dict[str, float], right: float, top: float) -> None:
    """Their names beside the body, moved apart where they would touch."""
    least, below = 0.055 * top, -math.inf
    for name, height in sorted(heights.items(), key=lambda item: item[1]):
        shown = max(height, below + least)
        below = shown
        axes.annotate(
            f"{name} {height:.0f}",
            (right, height),
            (1.12 * right, shown),
            fontsize=8,
            va="center",
            arrowprops={"arrowstyle": "-", "color": TIP, "lw": 0.7},
        )
