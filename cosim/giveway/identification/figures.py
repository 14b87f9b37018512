"""Figures of a roller calibration: measurement, model, and residual."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure
from matplotlib.style import context

from giveway.report.style import STYLE, TRUTH_COLOUR

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from giveway.identification.roller_friction import Calibration, FittedLog

__all__ = ["WHEEL_COLOURS", "residual_figure", "torque_figure", "write_residuals"]

WHEEL_COLOURS = ("#c8500a", "#0b64a8", "#0a8a63")
ANGLE_COLOUR = "#2b2f36"
DPI = 110
ROW_IN = 2.1


def torque_figure(calibration: Calibration) -> Figure:
    """One row per log, as in the paper's Fig. 7: torques measured, and by the calibrated model."""
    logs = calibration.logs
    with context(STYLE):
        figure = Figure(figsize=(9.6, ROW_IN * 1.25 * len(logs) + 0.5), layout="constrained")
        axes = figure.subplots(len(logs), 2, squeeze=False, sharex="row", sharey="row")
        for (left, right), log in zip(axes, logs, strict=True):
            _draw_torques(left, log, log.torque_nm - log.offset_nm)
            _draw_torques(right, log, log.model_nm - log.offset_nm)
            left.set_title(f"{log.name}: measured")
            right.set_title("model (27) with the fitted friction")
            left.set_ylabel("wheel torque (N m)")
        for axis in axes[-1]:
            axis.set_xlabel("time (s)")
        figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def residual_figure(calibration: Calibration) -> Figure:
    """Measured minus model for each log, over time and over the speed of the fastest roller; left-out samples grey."""
    logs = calibration.logs
    with context(STYLE):
        figure = Figure(figsize=(9.6, ROW_IN * len(logs) + 0.5), layout="constrained")
        axes = figure.subplots(len(logs), 2, squeeze=False, sharey="row", width_ratios=(2, 1))
        for (over_time, over_speed), log in zip(axes, logs, strict=True):
            left = log.torque_nm - log.model_nm
            fastest = np.take_along_axis(
                log.roller_rate, np.abs(log.roller_rate).argmax(axis=1)[:, None], axis=1
            ).ravel()
            for axis, x in ((over_time, log.time_s), (over_speed, fastest)):
                _draw_residuals(axis, x, left, log)
            over_time.set_title(f"{log.name}: measured minus model")
            over_time.set_ylabel("torque (N m)")
        axes[-1, 0].set_xlabel("time (s)")
        axes[-1, 1].set_xlabel("rate of the fastest roller (rad/s)")
        figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4, markerscale=3.0)
    return figure


def write_residuals(path: Path, calibration: Calibration) -> None:
    """Save `residual_figure` as ``path`` (PNG)."""
    residual_figure(calibration).savefig(path, dpi=DPI)


def _draw_torques(axis: Axes, log: FittedLog, torque: NDArray[np.float64]) -> None:
    rows = log.sound
    for wheel, colour in enumerate(WHEEL_COLOURS):
        axis.plot(log.time_s[rows], torque[rows, wheel], color=colour, label=f"wheel {wheel}")
    moving = int(np.ptp(log.wheel_angle_rad, axis=0).argmax())
    angle = log.wheel_angle_rad[rows, moving]
    axis.plot(log.time_s[rows], angle - angle[0], ":", color=ANGLE_COLOUR, linewidth=1.0, label="JPos (rad)")


def _draw_residuals(axis: Axes, x: NDArray[np.float64], left: NDArray[np.float64], log: FittedLog) -> None:
    unused = log.sound & ~log.used
    for wheel, colour in enumerate(WHEEL_COLOURS):
        axis.plot(x[unused], left[unused, wheel], ".", color=TRUTH_COLOUR, markersize=2, alpha=0.6)
        axis.plot(x[log.used], left[log.used, wheel], ".", color=colour, markersize=2.5, label=f"wheel {wheel}")
    axis.plot([], [], ".", color=TRUTH_COLOUR, label="left out (near rest)")
    # The scale of the used samples; left-out samples may lie far outside.
    reach = float(np.abs(left[log.used]).max()) if log.used.any() else 1.0
    axis.set_ylim(-2.5 * reach, 2.5 * reach)
