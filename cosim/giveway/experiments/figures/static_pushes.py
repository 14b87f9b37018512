"""Figures of the static pushes: four of them in the manner of Fig. 9, all as a cloud, and groups of four."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle
from matplotlib.style import context

from giveway.experiments.reproduction.findings import Picture
from giveway.experiments.static_push_study.groups import GROUP, PAPER_FORCE_N, PRINTED, group_values, percentile_of
from giveway.experiments.static_push_study.placements import default_outline
from giveway.experiments.static_push_study.trials import WEIGHT_N, Readings
from giveway.report.style import STYLE, TRUTH_COLOUR

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from giveway.experiments.static_push_study.study import Study

__all__ = ["pictures"]

BEFORE, AFTER, DRIFTED, INK = "#c8500a", "#0a8a63", "#0b64a8", "#2b2f36"
_LEGEND = ((TRUTH_COLOUR, "true push"), (BEFORE, "felt, rollers unknown"), (AFTER, "felt, rollers calibrated"))
THICK, THIN = 2.6, 1.4
PAPER_FILL = "#dfe7f1"
WIDTH_IN = 9.6
LOCATION_SHOWN_CM = 20.0
METRES_PER_NEWTON = 0.022  # length of an arrow on the outline
NUMBERS = "1234"


def pictures(study: Study) -> list[Picture]:
    """All of them."""
    with context({**STYLE, "axes.axisbelow": True, "figure.dpi": 200.0}):
        return [_placements(study), _clouds(study), _groups(study)]


def _ordinary_robot(study: Study) -> slice:
    """The trials of the robot whose largest location error in the placements of Fig. 9 is the median one."""
    largest = study.paper.location_error_cm.reshape(-1, GROUP).max(axis=1)
    number = int(np.argsort(largest)[len(largest) // 2])
    return slice(number * GROUP, (number + 1) * GROUP)


def _placements(study: Study) -> Picture:
    rows = _ordinary_robot(study)
    figure = Figure(figsize=(WIDTH_IN, 3.9), layout="constrained")
    forces, before, after = figure.subplots(1, 3)
    _draw_forces(forces, study, rows)
    _draw_contacts(before, study.paper, rows, BEFORE, "contact: rollers unknown (paper)")
    _draw_contacts(after, study.paper_compensated, rows, AFTER, "contact: rollers calibrated")
    for colour, label in _LEGEND:
        forces.plot([], [], color=colour, linewidth=2.0, label=label)
    figure.legend(*forces.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return Picture(
        "placements",
        "Four static pushes, felt through the wheel torques alone",
        "Left: the forces from a common origin; the ring is 10 N. Middle and right: where each push acted and where "
        "the robot believes it acted, base frame; a hollow dot is the nearest point of an outline that the "
        "zero-moment line misses. The robot is the one whose largest location error is the median one.",
        figure,
        paper=(
            ("magnitude", "5.5 to 10 N"),
            ("direction error, largest", "12 deg"),
            ("location error, largest", "11 cm"),
            ("location error, mean", "4.5 cm"),
        ),
    )


def _draw_forces(axes: Axes, study: Study, rows: slice) -> None:
    ring = np.linspace(0.0, 2.0 * np.pi, 181)
    axes.plot(10.0 * np.cos(ring), 10.0 * np.sin(ring), color="#c3c8cf", linewidth=0.8)
    true = _unit(study.paper.true_direction_rad[rows])
    origin = np.zeros_like(true)
    _arrows(axes, origin, WEIGHT_N * true, TRUTH_COLOUR, THICK)
    for readings, colour in ((study.paper, BEFORE), (study.paper_compensated, AFTER)):
        _arrows(axes, origin, readings.force_n[rows, None] * _unit(readings.direction_rad[rows]), colour, THIN)
    for index, direction in enumerate(true):
        # Pushes of one direction share an arrow: their numbers stand behind each other.
        shared = int(np.sum(true[:index] @ direction > 0.999))
        x, y = (11.0 + 1.3 * shared) * direction
        axes.text(x, y, NUMBERS[index], ha="center", va="center", color=INK)
    axes.set(aspect="equal", xlim=(-0.5, 14.0), ylim=(-8.0, 8.0), xlabel="x (N)", ylabel="y (N)", title="force")


def _draw_contacts(axes: Axes, readings: Readings, rows: slice, colour: str, title: str) -> None:
    axes.add_patch(Polygon(default_outline(), closed=True, facecolor="#f4f5f7", edgecolor=INK, linewidth=1.2))
    true, felt, hit = readings.true_point_m[rows], readings.point_m[rows], readings.on_outline[rows]
    push = METRES_PER_NEWTON * WEIGHT_N * _unit(readings.true_direction_rad[rows])
    _arrows(axes, true - push, true, TRUTH_COLOUR, THICK)
    push = METRES_PER_NEWTON * readings.force_n[rows, None] * _unit(readings.direction_rad[rows])
    _arrows(axes, felt - push, felt, colour, THIN)
    axes.plot(*true.T, "o", color=TRUTH_COLOUR, markersize=6)
    axes.plot(*felt[hit].T, "o", color=colour, markersize=4)
    axes.plot(*felt[~hit].T, "o", color=colour, markersize=4, markerfacecolor="white")
    for number, point in zip(NUMBERS, true, strict=True):
        axes.text(point[0] + 0.025, point[1], number, ha="left", va="center", color=INK)
    errors = readings.location_error_cm[rows]
    axes.set(aspect="equal", xlim=(-0.42, 0.38), ylim=(-0.37, 0.37), xlabel="x (m)", ylabel="y (m)")
    axes.set(title=f"{title}\nerror {errors.mean():.1f} cm mean, {errors.max():.1f} cm largest")


def _unit(direction_rad: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.stack([np.cos(direction_rad), np.sin(direction_rad)], axis=1)


def _arrows(axes: Axes, tails: NDArray[np.float64], tips: NDArray[np.float64], colour: str, width: float) -> None:
    shape = {"arrowstyle": "-|>", "color": colour, "linewidth": width, "shrinkA": 0, "shrinkB": 0}
    for tail, tip in zip(tails, tips, strict=True):
        axes.annotate("", tip, tail, arrowprops=shape)


def _clouds(study: Study) -> Picture:
    figure = Figure(figsize=(WIDTH_IN, 4.4), layout="constrained")
    direction, location = figure.subplots(1, 2)
    before, after = study.random, study.random_compensated
    for axes, name, low, high in (
        (direction, "direction_error_deg", -12.0, 12.0),
        (location, "location_error_cm", 0.0, 11.0),
    ):
        paper = Rectangle((0.55, low), 0.45, high - low, color=PAPER_FILL, zorder=0, label="range of the paper's four")
        axes.add_patch(paper)
        for readings, (colour, label) in zip((before, after), _LEGEND[1:], strict=True):
            ratio, error, hit = readings.force_n / PAPER_FORCE_N, getattr(readings, name), readings.on_outline
            # Thousands of dots: as pixels they are a tenth of their size as vectors.
            dots = {"alpha": 0.6, "rasterized": True}
            axes.scatter(ratio[hit], error[hit], s=8, color=colour, linewidths=0, label=label, **dots)
            rings = {"facecolors": "none", "edgecolors": colour, "linewidths": 0.7, **dots}
            axes.scatter(ratio[~hit], error[~hit], s=10, **rings)
        axes.axvline(WEIGHT_N / PAPER_FORCE_N, color=INK, linewidth=0.8, linestyle=":")
        axes.set(xlabel="felt force / 10 N", xlim=(0.25, 1.1))
    direction.set(ylabel="direction error (deg)", title="magnitude and direction")
    location.set(ylabel="location error (cm)", title="magnitude and location", ylim=(0.0, LOCATION_SHOWN_CM))
    figure.legend(*direction.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    missed = [100.0 * float(np.mean(~readings.on_outline)) for readings in (before, after)]
    beyond = [int(np.sum(readings.location_error_cm > LOCATION_SHOWN_CM)) for readings in (before, after)]
    return Picture(
        "clouds",
        "Every push before and after presliding compensation",
        f"{len(before.trials)} random pushes on {len(study.robots)} robots whose rollers differ; dotted: the true "
        "9.81 N. The compensated cloud is the very same pushes, felt with each robot's three stiffnesses, which come "
        f"from three other pushes. Rings: the zero-moment line misses the outline ({missed[0]:.0f} % before, "
        f"{missed[1]:.0f} % after). {beyond[0]} points before and {beyond[1]} after lie beyond {LOCATION_SHOWN_CM:g} "
        "cm: lines along a side, to which either corner may be the nearer one.",
        figure,
        paper=(("magnitude", "5.5 to 10 N of 10 N"), ("direction error", "up to 12 deg"), ("location", "up to 11 cm")),
    )


def _groups(study: Study) -> Picture:
    figure = Figure(figsize=(WIDTH_IN, 4.6), layout="constrained")
    ordinary, drifted = group_values(study.random), group_values(study.drifted)
    panels = figure.subplots(2, 3)
    for column, (axes, printed) in enumerate(zip(panels.T.flat, PRINTED, strict=True)):
        _distribution(axes, ordinary[:, column], BEFORE, "rollers that differ")
        _distribution(axes, drifted[:, column], DRIFTED, f"and torque zeros that drift by {study.drift_nm:g} N m")
        axes.axvline(printed.value, color=INK, linewidth=1.2, linestyle="--", label="paper")
        at = percentile_of(printed.value, ordinary[:, column])
        quantity, which = printed.name.split(", ")
        axes.set(title=f"{which}\npaper at percentile {at:.0f}", xlabel=f"{quantity} ({printed.unit})")
        axes.set_ylim(0.0, 100.0)
    figure.supylabel("groups of four below (%)", fontsize=9.5)
    figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return Picture(
        "groups",
        "Where the paper's four pushes lie among groups of four",
        f"Distribution over {len(ordinary)} groups of four random pushes, each on one robot, without compensation; and "
        f"over {len(drifted)} groups whose torque signals moved between tare and reading.",
        figure,
        paper=[(printed.name, f"{printed.value:g} {printed.unit}") for printed in PRINTED],
    )


def _distribution(axes: Axes, values: NDArray[np.float64], colour: str, label: str) -> None:
    share = 100.0 * (np.arange(len(values)) + 0.5) / len(values)
    axes.step(np.sort(values), share, color=colour, where="mid", label=label)
