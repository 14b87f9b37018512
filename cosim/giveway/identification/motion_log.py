"""A user's own log of wheel angles and wheel torques, from a CSV or Parquet file.

Columns are found by their names, in any order; other columns are ignored:

    time_s                                        also _ms, _us, _ns
    wheel_angle_0_rad  ..._1_rad  ..._2_rad       also _deg, _counts (the robot's drivetrain.encoder_counts per turn)
    torque_0_nm        ..._1_nm   ..._2_nm        also _mnm

`motor_angle_0_...` instead of `wheel_angle_0_...` means that the encoders are on the motor side of the torque sensors,
as on Trikey; the deflection T/k of the drivetrain is then subtracted. So does ``encoder_0``, as in the logs of
`giveway run --log` and `giveway replay`, whose heads ``time [s]`` and ``torque_0 [N.m]`` are understood, too. Angles
may wrap (at a turn, counts at 32 bits). Signs and order are those of the robot: wheel i at azimuth 120 i deg, positive
torque turns it towards positive angles.
"""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from giveway.base.errors import FileError, nearest_names
from giveway.base.stretches import stretches
from giveway.identification.log_rows import LogRows, read_rows
from giveway.robot.robot_file import Robot
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["MotionLog", "behind_drivetrain", "counts_to_rad", "pieces", "read_log"]

GAP_STEPS = 10.0  # a step longer than this many usual steps is a gap in the log
COUNT_WRAP = 2.0**32
STANDING_S = 0.8  # without motion: the robot stands between two arcs, it does not just turn back
STANDING_RAD = 2e-3  # in which wheels that stand move, between them two counts of an encoder
SHORTEST_PIECE_S = 2.0
_TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
_TORQUE = {"nm": 1.0, "mnm": 1e-3}
_ANGLE_UNITS = ("rad", "deg", "counts")


@dataclass(frozen=True)
class MotionLog:
    """Motion and torques of a robot's wheels.

    Attributes:
        name: for messages and figures.
        time_s: shape (n,), s, strictly rising.
        wheel_angle_rad: shape (n, 3), rad, without wraps.
        torque_nm: shape (n, 3), sensed torque of the drivetrain on each wheel, N m.
        sha256: hash of the file; "" if there is none.
    """

    name: str
    time_s: NDArray[np.float64]
    wheel_angle_rad: NDArray[np.float64]
    torque_nm: NDArray[np.float64]
    sha256: str = ""


@dataclass(frozen=True)
class _Column:
    """The column of a quantity, and its factor to SI units."""

    name: str
    index: int
    unit: str


def read_log(path: Path, robot: Robot) -> MotionLog:
    """Read ``path``; FileError names file, line and column of the fault.

    Args:
        path: a CSV file with a header line, or a Parquet file; see the module for its columns.
        robot: for encoder counts, and for the stiffness between motor and wheel.
    """
    import numpy as np

    try:
        content = path.read_bytes()
    except FileNotFoundError:
        raise FileError(path, "no such file", "give the path of a log (CSV, Parquet)") from None
    except OSError as error:
        raise FileError(path, f"cannot be read: {error}") from None
    rows = read_rows(path, content)
    header = [_own_name(name.strip()) for name in rows.header]
    time = _find(rows, header, r"time", _TIME)
    kind = "motor" if any(name.startswith("motor_angle_") for name in header) else "wheel"
    angles = [_find(rows, header, f"{kind}_angle_{wheel}", dict.fromkeys(_ANGLE_UNITS, 1.0)) for wheel in range(WHEELS)]
    torques = [_find(rows, header, f"torque_{wheel}", _TORQUE) for wheel in range(WHEELS)]
    values, numbers = rows.values([column.index for column in (time, *angles, *torques)])

    time_s = values[:, 0] * _TIME[time.unit]
    _check_time(rows, time_s, numbers)
    torque = np.stack([values[:, 4 + i] * _TORQUE[column.unit] for i, column in enumerate(torques)], axis=1)
    angle = np.stack([_radians(values[:, 1 + i], column, robot) for i, column in enumerate(angles)], axis=1)
    if kind == "motor":
        angle = behind_drivetrain(angle, torque, robot)
    return MotionLog(path.name, time_s, angle, torque, hashlib.sha256(content).hexdigest())


def pieces(log: MotionLog) -> list[MotionLog]:
    """The motions of ``log`` between times at which the robot stands; ``log`` itself if it has only one.

    Arcs about several points then count as logs of their own: each has other rollers that roll.
    """
    import numpy as np
    from scipy.ndimage import maximum_filter1d, minimum_filter1d

    step_s = float(np.median(np.diff(log.time_s)))
    width = max(2, round(STANDING_S / step_s))
    span = maximum_filter1d(log.wheel_angle_rad, width, axis=0) - minimum_filter1d(log.wheel_angle_rad, width, axis=0)
    standing = (span < STANDING_RAD).all(axis=1)
    found = [
        (begin, end)
        for begin, end in stretches(~standing)
        if log.time_s[end - 1] - log.time_s[begin] >= SHORTEST_PIECE_S
    ]
    if len(found) < 2:
        return [log]
    return [
        MotionLog(
            f"{log.name}, {log.time_s[begin]:.1f} to {log.time_s[end - 1]:.1f} s",
            log.time_s[begin:end],
            log.wheel_angle_rad[begin:end],
            log.torque_nm[begin:end],
            log.sha256,
        )
        for begin, end in found
    ]


def behind_drivetrain(
    motor_angle_rad: NDArray[np.float64], torque_nm: NDArray[np.float64], robot: Robot
) -> NDArray[np.float64]:
    """Wheel angles from motor angles at the wheel axle and sensed torques, all of shape (n, 3): q_w = th_m - T/k."""
    return motor_angle_rad - torque_nm / float(robot.value("drivetrain.stiffness"))


def counts_to_rad(counts: NDArray[np.float64], robot: Robot) -> NDArray[np.float64]:
    """Encoder counts over time (first axis), 32-bit wraps undone, in rad."""
    import numpy as np

    turn = float(robot.value("drivetrain.encoder_counts"))
    return np.asarray(np.unwrap(counts, period=COUNT_WRAP, axis=0)) * (2.0 * math.pi / turn)


def _own_name(name: str) -> str:
    """The name of a column as the logs of `giveway run --log` have it, as one of these logs."""
    if re.fullmatch(r"encoder_\d", name):
        return f"motor_angle_{name.removeprefix('encoder_')}_counts"
    found = re.fullmatch(r"(time|torque_\d) \[(\w+|m?N\.m)\]", name)
    return f"{found[1]}_{found[2].replace('.', '').lower()}" if found else name


def _find(rows: LogRows, header: list[str], quantity: str, units: Mapping[str, float]) -> _Column:
    """The one column of ``quantity``; its unit is the end of its name."""
    allowed = " or ".join(f"{quantity}_{unit}" for unit in units)
    found = [i for i, name in enumerate(header) if re.fullmatch(rf"{quantity}(_[^_]*)?", name)]
    if not found:
        near = nearest_names(f"{quantity}_{next(iter(units))}", header)
        hint = f" (the header has {' and '.join(near)})" if near else ""
        raise FileError(rows.path, f"{rows.head}: there is no column for {quantity}{hint}", f"needed: {allowed}")
    if len(found) > 1:
        names = " and ".join(header[i] for i in found)
        raise FileError(rows.path, f"{rows.head}: {names} say the same thing", f"give one of: {allowed}")
    name = header[found[0]]
    unit = name.removeprefix(quantity).removeprefix("_")
    if unit not in units:
        reason = (
            f"{rows.head}: column {name} has the unit {unit}" if unit else f"{rows.head}: column {name} states no unit"
        )
        raise FileError(rows.path, reason, f"allowed: {allowed}")
    return _Column(name, found[0], unit)


def _check_time(rows: LogRows, time_s: NDArray[np.float64], numbers: list[int]) -> None:
    import numpy as np

    steps = np.diff(time_s)
    back = np.flatnonzero(steps <= 0.0)
    if back.size:
        row = int(back[0]) + 1
        rows.refuse(numbers[row], f"time goes from {time_s[row - 1]:.9g} s to {time_s[row]:.9g} s; it has to rise")
    usual = float(np.median(steps))
    gaps = np.flatnonzero(steps > GAP_STEPS * usual)
    if gaps.size:
        row = int(gaps[0]) + 1
        reason = (
            f"{steps[row - 1]:.3g} s since the {rows.word} before, {steps[row - 1] / usual:.0f} times the usual step"
        )
        rows.refuse(numbers[row], f"{reason}; give the pieces as logs of their own")


def _radians(values: NDArray[np.float64], column: _Column, robot: Robot) -> NDArray[np.float64]:
    """Angles in rad; every jump of more than half a period counts as a wrap."""
    import numpy as np

    if column.unit == "counts":
        return counts_to_rad(values, robot)
    if column.unit == "deg":
        values = np.deg2rad(values)
    return np.asarray(np.unwrap(values))
