"""Logs of a robot, read as by `giveway replay`, ready to be replayed many times."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.checks import finite
from giveway.base.csv_rows import check_widths, number_of, read_rows
from giveway.base.errors import FileError, GivewayError, InputFileError
from giveway.base.stretches import stretches
from giveway.identification.motion_log import COUNT_WRAP
from giveway.library.replay import ReplayedController
from giveway.replay.inputs import wrapped
from giveway.replay.mapping import Wishes
from giveway.replay.play import Choice, Replay, open_log
from giveway.replay.source import file_hash
from giveway.replay.story import STATUSES
from giveway.replay.wheel_plan import UNOBSERVED, moving, over_gaps
from giveway.robot.variables import Value
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.robot.robot_file import Robot

__all__ = ["Log", "Push", "read_log", "read_pushes", "without_refused"]

AFTER_S = 2.0  # a push, until the robot is undisturbed again; refused sensors, until the detector is armed and calm
BEFORE_PUSH_S = 0.2
BRIDGED_S = 0.2  # of refused samples in motion: straight lines over so little time change nothing
REFUSED = (4, 5, 6, 7, 8)  # statuses of samples that the controller does not use
TRACKING = 1  # the controller's mode in which it looks for hits


@dataclass(frozen=True)
class Push:
    """A time in which something pushed the robot, s since the first row of the log."""

    start_s: float
    end_s: float


@dataclass(frozen=True)
class Log:
    """One log.

    Attributes:
        name: for messages.
        step_s: of the controller.
        inputs: of the controller by name, each of shape (n,).
        angle_rad: of the motors at the wheel axle, (n, wheels).
        torque_nm: (n, wheels).
        pushes: what is known to have pushed it.
        sha256: of the file.
        as_logged: each step is a row of the log, nothing was interpolated.
        planned: its plan is the robot's own, and not made of the wheels' motion (`wheel_plan`).
        refused: steps whose samples the controller refuses: straight lines stand there; None: there are none.
        said: what was assumed.
    """

    name: str
    step_s: float
    inputs: Mapping[str, NDArray[Any]]
    angle_rad: NDArray[np.float64]
    torque_nm: NDArray[np.float64]
    pushes: tuple[Push, ...] = ()
    sha256: str = ""
    as_logged: bool = True
    planned: bool = True
    refused: NDArray[np.bool_] | None = None
    said: tuple[str, ...] = field(default=())

    @property
    def steps(self) -> int:
        return len(self.torque_nm)

    @property
    def duration_s(self) -> float:
        return self.steps * self.step_s

    def moving(self) -> NDArray[np.bool_]:
        """Whether a wheel turns, or does so soon or did a moment ago."""
        return moving(self.inputs, self.step_s)

    def free(self) -> NDArray[np.bool_]:
        """Whether nothing is known to push it, and the controller has had its sensors for a while."""
        found = np.ones(self.steps, dtype=np.bool_)
        if self.refused is not None:
            found = ~_until(self.refused, round(AFTER_S / self.step_s))
        for push in self.pushes:
            begin = max(0, round((push.start_s - BEFORE_PUSH_S) / self.step_s))
            found[begin : round((push.end_s + AFTER_S) / self.step_s)] = False
        return found

    def replayed(self, parameters: Mapping[str, Value], outputs: Sequence[str]) -> dict[str, NDArray[Any]]:
        """Outputs of the controller with ``parameters`` on this log."""
        known = parameters if self.planned else {**parameters, **UNOBSERVED}
        with ReplayedController(known, self.step_s, outputs) as controller:
            return controller.play(self.inputs)


def read_log(path: Path, robot: Robot, parameters: Mapping[str, Value], wishes: Wishes | None = None) -> Log:
    """Read ``path`` as `giveway replay` does; FileError or GivewayError name what is wrong, and where."""
    wishes = wishes or Wishes()
    source = open_log(path, wishes, None, "motor_angle", "torque")
    stated = {name for name, _ in robot.entries()}
    constant = None
    if {"motor.torque_constant", "motor.gear_ratio"} <= stated:
        constant = float(robot.value("motor.torque_constant")) * float(robot.value("motor.gear_ratio"))
    step_s = float(parameters.get("controller.period", 1e-3))
    choice = Choice(parameters, step_s, torque_constant=constant)
    with Replay(source, wishes, choice) as replay:
        all_played = list(replay.all())
        played = [one.steps for one in all_played]
        if not played:
            raise FileError(path, "has no step", "a log of some minutes")
        if replay.findings.wrong:
            raise FileError(path, replay.findings.wrong[0], "`giveway replay` shows what the log holds")
        planned = not replay.makes_plan
        as_logged = replay.did.way in ("as-is", "rows")
    log = Log(
        path.name,
        step_s,
        {name: np.concatenate([steps.inputs[name] for steps in played]) for name in played[0].inputs},
        np.concatenate([steps.angle_rad for steps in played]),
        np.concatenate([steps.torque_nm for steps in played]),
        sha256=file_hash(path),
        as_logged=as_logged,
        planned=planned,
        said=() if planned else (f"{path.name} has no plan: the plan was taken to be the motion of its wheels",),
    )
    return without_refused(log, np.concatenate([one.outputs["status"] for one in all_played]))


def without_refused(log: Log, status: NDArray[np.int32]) -> Log:
    """``log`` without the samples that the controller refuses, as its ``status`` says.

    An alarm after them would hide the rest of the log, so straight lines take their place.

    Raises:
        GivewayError: there are too many in a row while the robot drives.
    """
    refused = np.isin(status, REFUSED)
    if not refused.any():
        return log
    good = ~refused
    inputs = dict(log.inputs)
    for wheel in range(WHEELS):
        torque, encoder = f"sensor.torque[{wheel}]", f"sensor.encoder[{wheel}]"
        inputs[torque] = over_gaps(inputs[torque][:, None], good)[:, 0]
        counts = np.zeros((log.steps, 1))
        counts[good, 0] = np.unwrap(inputs[encoder][good].astype(np.float64), period=COUNT_WRAP)
        inputs[encoder] = wrapped(np.rint(over_gaps(counts, good)[:, 0]))
    inputs["sensor.present"] = np.ones_like(good)
    inputs["sensor.counter"] = np.arange(log.steps, dtype=np.int32)
    found = replace(log, inputs=inputs, refused=refused, angle_rad=over_gaps(log.angle_rad, good),
                    torque_nm=over_gaps(log.torque_nm, good))  # fmt: skip
    driven = found.moving()
    for begin, end in stretches(refused):
        if (end - begin) * log.step_s > BRIDGED_S and driven[begin:end].any():
            reason = f"no good sample from {begin * log.step_s:.3f} to {end * log.step_s:.3f} s, and the wheels turn"
            raise GivewayError(log.name, reason, "give what is before and after as logs that begin at rest")
    why = ", ".join(f"{STATUSES[one]} {count}" for one in REFUSED if (count := np.count_nonzero(status == one)))
    left_out_s = np.count_nonzero(~found.free()) * log.step_s
    said = (
        f"{log.name}: the controller refuses {np.count_nonzero(refused)} samples ({why}); these, and {AFTER_S:g} s "
        f"after each, were left out: {left_out_s:.3g} of {log.duration_s:.3g} s"
    )
    return replace(found, said=(*log.said, said))


def _until(rows: NDArray[np.bool_], more: int) -> NDArray[np.bool_]:
    """``rows``, and so many ``more`` after each."""
    numbers = np.arange(len(rows))
    last = np.maximum.accumulate(np.where(rows, numbers, -more - 1))
    return np.asarray(numbers - last <= more)


def read_pushes(path: Path, logs: Mapping[str, float]) -> dict[str, tuple[Push, ...]]:
    """By the log's name the pushes in ``path``: a CSV file with the columns start [s], end [s], and log if several.

    Args:
        path: of the file; its times count from the first row of the log.
        logs: how long each is, s.
    """
    rows = read_rows(path, "times of pushes")
    if not rows:
        raise FileError(path, "is empty", "heads first: start [s],end [s], and log if there are several logs")
    check_widths(path, rows)
    (line, head), *others = rows
    needed = ["start [s]", "end [s]", *(["log"] if len(logs) > 1 else [])]
    for name in needed:
        if name not in head:
            raise FileError(path, f"line {line}: there is no column {name}", f"needed: {', '.join(needed)}")
    found: dict[str, list[Push]] = {name: [] for name in logs}
    for line, row in others:
        cells = dict(zip(head, row, strict=True))
        try:
            start, end = (number_of(name, cells[name]) for name in needed[:2])
            finite("start [s]", start, 0.0)
            if end <= start:
                raise GivewayError("end [s]", end, f"above the start, {start:g} s")
            log = cells.get("log", next(iter(logs)))
            if log not in found:
                raise GivewayError("log", log, ", ".join(logs))
            for name, at_s in (("start [s]", start), ("end [s]", end)):
                if at_s > logs[log]:
                    raise GivewayError(name, at_s, f"0 to {logs[log]:.6g} s: since the first row of {log}")
        except GivewayError as error:
            raise InputFileError(path, line, error) from None
        found[log].append(Push(start, end))
    return {name: tuple(pushes) for name, pushes in found.items()}
