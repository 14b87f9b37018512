"""What logs of free motion say of a robot: roller friction, noise and drift of torque, error of the model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.errors import GivewayError
from giveway.base.stretches import stretches
from giveway.identification.motion_log import MotionLog, behind_drivetrain, pieces
from giveway.identification.roller_friction import Calibration, TouchedError, calibrate
from giveway.robot.variables import Value
from giveway.tuning.logs import TRACKING, Log

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.robot.robot_file import Robot

__all__ = ["Identified", "ModelError", "identify", "model_error"]

THIN_S = 0.01  # between samples of a log to calibrate on
REST_MIN_S = 2.0  # of standing, to tell the noise from
OUTER = 0.99
SETTLED_S = 0.5  # at the beginning of a rest what the robot swings is no noise


@dataclass(frozen=True)
class Identified:
    """Of some logs.

    Attributes:
        friction: of the rollers; None: the logs do not determine it.
        why: the reason for that.
        touched: it is that forces act which the friction of rollers does not explain.
        noise_nm: standard deviation of one torque sample, the largest of the wheels; None: too little rest.
        drift_nm: largest change of a resting torque signal between two rests of a log, per hour of it; None: no two.
    """

    friction: Calibration | None
    why: str
    noise_nm: float | None
    drift_nm_per_h: float | None
    touched: bool = False


@dataclass(frozen=True)
class ModelError:
    """The estimated force where nothing pushes, N: root mean square, and what 99 % of the time is below."""

    rms_n: float
    outer_n: float


def identify(logs: Sequence[Log], robot: Robot) -> Identified:
    """Everything that needs no controller."""
    friction, why, touched = None, "", False
    try:
        friction = calibrate([piece for log in logs for piece in pieces(_motion(log, robot))], robot)
    except GivewayError as error:
        why, touched = str(error), isinstance(error, TouchedError)
    noises, drifts = [], []
    for log in logs:
        rests = _rests(log)
        if log.as_logged and sum(end - begin for begin, end in rests) * log.step_s >= REST_MIN_S:
            steps = np.concatenate([np.diff(log.torque_nm[begin:end], axis=0) for begin, end in rests])
            noises.append(float(np.sqrt(0.5 * np.mean(steps**2, axis=0)).max()))
        drift = _drift(log, rests)
        if drift is not None:
            drifts.append(drift)
    return Identified(friction, why, max(noises, default=None), max(drifts, default=None), touched)


def _motion(log: Log, robot: Robot) -> MotionLog:
    """Thinned out: the calibration smooths over five times as long."""
    every = max(1, round(THIN_S / log.step_s))
    if log.pushes:
        raise GivewayError(log.name, "a log with pushes", "one without, to calibrate on")
    torque = log.torque_nm[::every]
    angle = behind_drivetrain(log.angle_rad[::every], torque, robot)
    return MotionLog(
        log.name, np.arange(len(torque), dtype=np.float64) * (every * log.step_s), angle, torque, log.sha256
    )


def _rests(log: Log) -> list[tuple[int, int]]:
    """Steps in which the robot stands and nothing pushes, without their beginning."""
    settled = round(SETTLED_S / log.step_s)
    still = stretches(~log.moving() & log.free())
    return [(begin + settled, end) for begin, end in still if end - begin > 2 * settled]


def _drift(log: Log, rests: Sequence[tuple[int, int]]) -> float | None:
    """Slope of the resting torques over the log: stuck gears hold another torque each time, which is noise here."""
    if len(rests) < 2:
        return None
    times = np.array([0.5 * (begin + end) * log.step_s for begin, end in rests])
    means = np.stack([np.median(log.torque_nm[begin:end], axis=0) for begin, end in rests])
    slope = np.polyfit(times, means, 1)[0]
    return float(np.abs(slope).max()) * 3600.0


def model_error(logs: Sequence[Log], parameters: Mapping[str, Value], moving: bool) -> ModelError | None:
    """What the controller estimates where nothing pushes, at rest or in motion; None: the logs have none of it."""
    found: list[NDArray[np.float64]] = []
    for log in logs:
        played = log.replayed(parameters, ("estimate.force_x", "estimate.force_y", "mode"))
        rows = log.free() & (log.moving() == moving) & (played["mode"] == TRACKING)
        found.append(np.hypot(played["estimate.force_x"], played["estimate.force_y"])[rows])
    forces = np.concatenate(found)
    if not len(forces):
        return None
    return ModelError(float(np.sqrt(np.mean(forces**2))), float(np.quantile(forces, OUTER)))
