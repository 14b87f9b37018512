"""A log, step by step through the controller."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import FileError, GivewayError
from giveway.library.replay import ReplayedController
from giveway.replay.checks import Findings, LogChecks
from giveway.replay.inputs import Inputs, Steps, columns_for, value_of
from giveway.replay.mapping import Chosen, Wishes, choose
from giveway.replay.sampling import Sampled, Sampling, Treatment
from giveway.replay.source import Block, Source
from giveway.replay.story import Detection, Story
from giveway.replay.wheel_plan import UNOBSERVED, WheelPlan
from giveway.robot.variables import Value

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["OUTPUTS", "Choice", "Played", "Replay", "is_of_ros", "open_log"]

OUTPUTS = (
    *("estimate.force_x", "estimate.force_y", "estimate.torque_z", "estimate.force", "estimate.direction"),
    *("estimate.point_x", "estimate.point_y", "estimate.on_outline", "estimate.lever_arm", "estimate.lever_arm_sigma"),
    *("estimate.valid", "estimate.acceleration_source", "imu.trusted", "detection.active", "detection.statistic"),
    *Story.OUTPUTS,
)
PART_S = 60.0
_ENDINGS = "CSV (.csv), Parquet (.parquet), MCAP (.mcap), rosbag2 (.db3 or its folder)"


@dataclass(frozen=True)
class Choice:
    """How a log is played.

    Attributes:
        parameters: of the controller.
        step_s: of the controller's rows, s.
        way: one of `sampling.RESAMPLING`.
        torque_constant: N m at the wheel per A, for currents.
        encoder_bits: at which counts wrap.
        observe: the drives stay off: nothing is planned, and the controller only watches.
    """

    parameters: Mapping[str, Value]
    step_s: float
    way: str = "auto"
    torque_constant: float | None = None
    encoder_bits: int = 32
    observe: bool = False


@dataclass(frozen=True)
class Played:
    """Some steps: what went in and came out, and the detections in them."""

    steps: Steps
    outputs: dict[str, NDArray[Any]]
    detections: list[Detection]


def is_of_ros(path: Path) -> bool:
    """Whether `open_log` takes it for a log of ROS, by the end of its name."""
    return path.is_dir() or path.suffix in (".mcap", ".db3")


def open_log(path: Path, wishes: Wishes, topic: str | None, angle: str, effort: str) -> Source:
    """The log at ``path``, by the end of its name."""
    if is_of_ros(path):
        from giveway.replay.ros_log import RosLog

        return RosLog(path, topic, wishes.joints, angle, effort)
    if path.suffix in (".parquet", ".pq"):
        from giveway.replay.parquet_log import ParquetLog

        return ParquetLog(path)
    if path.suffix in (".csv", ".txt"):
        from giveway.replay.csv_log import CsvLog

        return CsvLog(path)
    if not path.exists():
        raise FileError(path, "no such file", f"give the path of a log: {_ENDINGS}")
    raise FileError(path, "has a name with another ending", f"allowed: {_ENDINGS}")


def _short(block: Block) -> Iterator[Block]:
    """Parts of ``block`` of `PART_S` at most: pauses between rows become many steps, and these stand in memory."""
    number = np.nan_to_num(np.floor((block.values[:, 0] - block.values[:1, 0]) / PART_S))
    cuts = [0, *(np.flatnonzero(np.diff(number)) + 1).tolist(), len(number)]
    for begin, end in itertools.pairwise(cuts):
        yield Block(block.values[begin:end], block.first + begin)


class Replay:
    """Plays a source; a context manager.

    Attributes:
        observes: the drives are off.
        makes_plan: the drives are on, and the log has no plan: that is the motion of its wheels.
    """

    def __init__(self, source: Source, wishes: Wishes, choice: Choice, outputs: tuple[str, ...] = OUTPUTS) -> None:
        self.source, self.choice = source, choice
        self.chosen: Chosen = choose(source, wishes)
        parameters = dict(choice.parameters)
        self.inputs = Inputs(self.chosen, parameters, choice.torque_constant)
        self.observes = choice.observe
        self.makes_plan = not (self.observes or self.inputs.has_plan)
        if self.observes:
            parameters["controller.drives_enabled"] = False
        if self.makes_plan:
            parameters |= UNOBSERVED
        self.parameters = parameters
        self._plan = WheelPlan(parameters, choice.step_s) if self.makes_plan else None
        names, held, periods, angles = columns_for(self.chosen, choice.encoder_bits)
        self._scale = np.array([column.scale for column in self.chosen.columns])
        self._sampling = Sampling(source, names, held, periods, angles, choice.step_s, choice.way)
        self._checks = LogChecks(parameters, choice.step_s, (self.chosen.angle, self.chosen.torque))
        self.story = Story(choice.step_s)
        self._controller = ReplayedController(parameters, choice.step_s, outputs)
        self.wanted = [column.index for column in self.chosen.columns]

    def __enter__(self) -> Replay:
        return self

    def __exit__(self, *details: object) -> None:
        self._controller.__exit__(*details)

    @property
    def did(self) -> Treatment:
        """What was done to the rows."""
        return self._sampling.did

    @functools.cached_property
    def findings(self) -> Findings:
        """What the log shows of units, signs and order, when it is over."""
        found = self._checks.judge()
        if self.observes and self._checks.moved:
            found.wrong.append("the drives are off (--observe): what is noticed while the wheels turn means nothing")
        uses_imu = self.value("estimator.acceleration_source") == 3.0
        if uses_imu and not self.inputs.has_imu:
            found.open.append("the controller would use an IMU; the log has none, so it takes the encoders")
        if self.inputs.has_imu and not uses_imu:
            found.open.append("the log has an IMU, which the controller of this robot file does not use")
        return found

    def value(self, name: str) -> float:
        return value_of(self.parameters, name)

    def all(self) -> Iterator[Played]:
        """The whole log; the controller works while the log is read and what was found is dealt with."""
        with ThreadPoolExecutor(1) as pool:
            pending: tuple[Steps, Future[dict[str, NDArray[Any]]]] | None = None
            for steps in self._all_steps():
                working = pool.submit(self._play, steps)
                if pending is not None:
                    yield self._told(pending[0], pending[1].result())
                pending = steps, working
            if pending is not None:
                yield self._told(pending[0], pending[1].result())
        self.story.end(self.did.steps * self.choice.step_s)

    def _all_steps(self) -> Iterator[Steps]:
        for block in self.source.blocks(self.wanted):
            for part in _short(Block(block.values * self._scale, block.first)):
                if (steps := self._steps(self._sampling.feed(part))) is not None:
                    yield steps
        if (steps := self._steps(self._sampling.finish(), last=True)) is not None:
            yield steps

    def feed(self, values: NDArray[np.float64], row: int) -> Played | None:
        """Some rows, live."""
        steps = self._steps(self._sampling.feed(Block(values * self._scale, row)))
        return None if steps is None else self._told(steps, self._play(steps))

    def end(self) -> Played | None:
        """The end of what was fed."""
        steps = self._steps(self._sampling.finish(), last=True)
        played = None if steps is None else self._told(steps, self._play(steps))
        self.story.end(self.did.steps * self.choice.step_s)
        return played

    def _steps(self, sampled: Sampled | None, last: bool = False) -> Steps | None:
        """The next steps that can be played."""
        steps = None
        if sampled is not None and len(sampled.present):
            self.inputs.exact = self.did.way in ("as-is", "rows")
            steps = self.inputs.of(sampled)
            self._checks.add(steps)
        return steps if self._plan is None else self._plan.add(steps, last)

    def _play(self, steps: Steps) -> dict[str, NDArray[Any]]:
        try:
            return self._controller.play(steps.inputs)
        except GivewayError as error:
            if not error.field.startswith("row "):
                raise
            time_s = self._controller.rows * self.choice.step_s
            _, _, name = error.field.partition(": ")
            reason = f"{time_s:.6g} s after its begin {name} = {error.value} is not allowed"
            raise FileError(self.source.path, reason, f"allowed: {error.allowed}") from None

    def _told(self, steps: Steps, outputs: dict[str, NDArray[Any]]) -> Played:
        return Played(steps, outputs, self.story.add(steps.first, outputs))
