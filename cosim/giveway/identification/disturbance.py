"""Contacts with the robot in a log of free motion: forces that (27) does not explain.

The residual torques of the fit are interpreted as a force and a moment on the base, and judged like in the robot's
detector: the part above a leak is integrated, and above a certain impulse it cannot be an error of the model.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.identification.roller_fit import Fit, Samples
    from giveway.identification.torque_model import TorqueModel

__all__ = ["Disturbance", "Limits", "find_disturbance"]

NOISE = 4.0  # leak in addition, in medians of the residual: for noise and for permanent errors of the model
NEAR_REST = 2.0  # B_r: the largest sum of three rollers' friction of up to B_r each, at 120 degrees
OVER_S = 0.3  # a disturbance ends after this time below the leak


@dataclass(frozen=True)
class Limits:
    """When an unexplained force counts as a hit: ``leak_n`` (N) and ``impulse_newton_s`` (N s) of the detector."""

    leak_n: float
    impulse_newton_s: float


@dataclass(frozen=True)
class Disturbance:
    """A contact with the robot.

    Attributes:
        log: number of the log.
        begin_s, end_s: its begin and end, s.
        force_n: largest force that (27) leaves unexplained, N.
    """

    log: int
    begin_s: float
    end_s: float
    force_n: float


def find_disturbance(
    samples: Sequence[Samples], used: Sequence[NDArray[np.bool_]], found: Fit, model: TorqueModel, limits: Limits
) -> Disturbance | None:
    """The first disturbance in the first log that has one; None if all logs are free motion."""
    for log, (one, rows) in enumerate(zip(samples, used, strict=True)):
        friction = found.x[0] * np.tanh(found.x[1] * one.roller_rate) @ model.friction_gain.T
        if not rows.any():
            continue
        # Rollers near rest hold any force up to their friction, but these forces have no moment about the centre.
        friction[~rows] = 0.0
        held_n = np.where(rows, 0.0, NEAR_REST * abs(float(found.x[0])) / model.roller_radius_m)
        wrench = (one.torque_nm - one.rigid_nm - friction) @ model.wheel_jacobian
        wrench -= np.median(wrench[rows], axis=0)  # the tare; a lasting disturbance shifts that of the fit
        force = np.hypot(wrench[:, 0], wrench[:, 1])
        lever = np.abs(wrench[:, 2]) / model.wheel_distance_m
        above = np.maximum(
            force - (limits.leak_n + NOISE * float(np.median(force[rows])) + held_n),
            lever - (limits.leak_n + NOISE * float(np.median(lever[rows]))),
        )
        seen = _first(np.where(one.sound, above, 0.0), one.step_s, limits.impulse_newton_s)
        if seen is not None:
            largest = float(np.maximum(force, lever)[seen].max())
            return Disturbance(log, float(one.time_s[seen.start]), float(one.time_s[seen.stop - 1]), largest)
    return None


def _first(above: NDArray[np.float64], step_s: float, impulse: float) -> slice | None:
    """The rows from where ``above`` (N) begins to add up to ``impulse`` (N s) until it stays below 0; None if never."""
    total, begin = 0.0, 0
    for row, force in enumerate(above):
        if total <= 0.0:
            begin = row
        total = max(0.0, total + float(force) * step_s)
        if total > impulse:
            end = row
            for later in range(row, len(above)):
                if above[later] > 0.0:
                    end = later
                elif (later - end) * step_s > OVER_S:
                    break
            return slice(begin, end + 1)
    return None
