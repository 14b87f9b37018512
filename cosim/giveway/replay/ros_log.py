"""Logs of ROS 2: joint states, perhaps an IMU, in MCAP or rosbag2; and the controller's inputs that a run wrote."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.errors import FileError, GivewayError, UnknownNameError
from giveway.replay.cdr import IMU, JOINT_STATE, MULTI_ARRAY, Layout, imu_layout, joint_layout, multi_array_layout
from giveway.replay.messages import Batch, batches, files_of
from giveway.replay.quantities import QUANTITIES
from giveway.replay.source import Block, Head, Origin, parameters_of
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["INPUTS_TOPIC", "ORIGIN_NAME", "RosLog"]

INPUTS_TOPIC = "/giveway/inputs"
ORIGIN_NAME = "giveway_log"
TOPICS_BATCHES = 20  # so far into a log its topics are looked for
_UNITS = {"position": "rad", "velocity": "rad/s", "effort": "N.m"}
_LAYOUTS: dict[str, Callable[[bytes], Layout]] = {
    **{JOINT_STATE: joint_layout, IMU: imu_layout, MULTI_ARRAY: multi_array_layout},
}


class RosLog:
    """Messages as rows.

    Args:
        path: a file or a folder.
        topic: of the joint states; None: the only one.
        joints: of the wheels, in their order; None: as the messages have them, if there are as many.
        angle: what a position is: "motor_angle" or "wheel_angle".
        effort: what an effort is: "torque" or "current".
    """

    def __init__(self, path: Path, topic: str | None, joints: Sequence[str] | None, angle: str, effort: str) -> None:
        self.path, self.said = path, list[str]()
        self._files = files_of(path)
        self.kind = "rosbag2" if path.is_dir() or path.suffix == ".db3" else "MCAP"
        first, imu = self._begin(topic)
        self._topic, self._begin_ns = first.topic, int(first.time_ns[0])
        layout = self._layout(first, 0)
        self.origin = self._origin(first)
        self._imu: str | None = None
        if first.topic.type == MULTI_ARRAY:
            self._names = layout.names
            self.heads = [Head(name, QUANTITIES[name].unit if name in QUANTITIES else None) for name in layout.names]
            self._stamped = False
            return
        self._names = layout.names
        stamp = np.frombuffer(first.message(0)[4:12], dtype="<u4")
        self._stamped = bool(stamp.any())
        if not self._stamped:
            self.said.append("the messages have no time stamps; the times at which they were logged were taken")
        if imu is not None:
            self._imu = imu.topic.name
            self.said.append(f"accelerations and yaw rate are the last ones of {self._imu} before each row")
        columns = [Head("time", "s"), *(Head(n, _UNITS[n.rpartition("/")[2]]) for n in self._names)]
        self.heads = self._named(columns, joints, angle, effort)
        if self._imu is not None:
            self.heads += [
                Head(name, QUANTITIES[name].unit) for name in ("yaw_rate", "acceleration_x", "acceleration_y")
            ]

    def _named(self, columns: list[Head], joints: Sequence[str] | None, angle: str, effort: str) -> list[Head]:
        """The heads, those of the wheels under the names of the quantities."""
        there = list(dict.fromkeys(name.rpartition("/")[0] for name in self._names))
        if joints is None:
            if len(there) != WHEELS:
                raise GivewayError("--joints", f"nothing, and {self._topic.name} has {', '.join(there)}",
                                   f"the joints of the {WHEELS} wheels, in their order")  # fmt: skip
            joints = there
            self.said.append(f"wheels 0 to {WHEELS - 1} are the joints {', '.join(joints)}, in the messages' order")
        for joint in joints:
            if joint not in there:
                raise UnknownNameError("--joints", joint, there)
        self.said.append(f"positions of {self._topic.name} are taken as {angle}, efforts as {effort}")
        unit = QUANTITIES[f"{effort}_0"].unit
        renamed = {f"{joint}/position": Head(f"{angle}_{wheel}", "rad") for wheel, joint in enumerate(joints)}
        renamed |= {f"{joint}/effort": Head(f"{effort}_{wheel}", unit) for wheel, joint in enumerate(joints)}
        return [renamed.get(head.name, head) for head in columns]

    def _begin(self, topic: str | None) -> tuple[Batch, Batch | None]:
        """The first messages of the topic, and of an IMU, in the first file."""
        seen: dict[str, Batch] = {}
        for count, batch in enumerate(batches(self._files[0])):
            seen.setdefault(batch.topic.name, batch)
            if INPUTS_TOPIC in seen or count >= TOPICS_BATCHES:
                break
        joints = (one for one in seen.values() if one.topic.type == JOINT_STATE)
        wanted = seen.get(INPUTS_TOPIC if topic is None else topic) or next(joints, None)
        if topic is not None and topic not in seen:
            raise UnknownNameError("--topic", topic, seen)
        if wanted is None:
            known = ", ".join(f"{name} ({one.topic.type})" for name, one in seen.items()) or "nothing"
            raise FileError(self.path, f"has no {JOINT_STATE} (it has {known})", "needed: the wheels' joint states")
        if wanted.topic.encoding != "cdr":
            raise FileError(self.path, f"{wanted.topic.name} is encoded as {wanted.topic.encoding}", "allowed: cdr")
        rivals = [name for name, one in seen.items() if one.topic.type == JOINT_STATE]
        if topic is None and wanted.topic.type == JOINT_STATE and len(rivals) > 1:
            raise GivewayError("--topic", f"nothing, and there are {' and '.join(rivals)}", "one of them")
        imu = next((one for one in seen.values() if one.topic.type == IMU), None)
        return wanted, imu

    def _origin(self, batch: Batch) -> Origin:
        stated = batch.metadata.get(ORIGIN_NAME)
        if stated is None:
            return Origin()
        try:
            return Origin(parameters_of(self.path, json.loads(stated["controller"])), float(stated["step_s"]))
        except (KeyError, ValueError) as error:
            raise FileError(self.path, f"its metadata {ORIGIN_NAME} cannot be read: {error}") from None

    def _layout(self, batch: Batch, index: int) -> Layout:
        try:
            return _LAYOUTS[batch.topic.type](batch.message(index))
        except KeyError:
            allowed = f"{JOINT_STATE}, or what `giveway run --log` writes"
            raise GivewayError("--topic", f"{batch.topic.name} ({batch.topic.type})", allowed) from None
        except GivewayError as error:
            raise FileError(self.path, f"{batch.topic.name}: {error}") from None

    def place(self, row: int) -> str:
        return f"message {row + 1} of {self._topic.name}"

    def blocks(self, wanted: Sequence[int]) -> Iterator[Block]:
        row = 0
        imu_s, imu = np.zeros(0), np.zeros((0, 3))
        for file in self._files:
            for batch in batches(file):
                if batch.topic.name == self._imu:
                    time_s, values = self._numbers(batch, 0, None)
                    imu_s, imu = np.concatenate([imu_s[-1:], time_s]), np.concatenate([imu[-1:], values])
                if batch.topic.name != self._topic.name:
                    continue
                try:
                    time_s, values = self._numbers(batch, row, self._names)
                except IndexError:
                    reason = f"{self.place(row)} or one after it is shorter than its kind"
                    raise FileError(self.path, reason, "whole messages") from None
                if self._topic.type != MULTI_ARRAY:
                    values = np.concatenate([time_s[:, None], values], axis=1)
                if self._imu is not None:
                    values = np.concatenate([values, _last_before(imu_s, imu, time_s)], axis=1)
                yield Block(values[:, list(wanted)], row)
                row += len(values)

    def _numbers(
        self, batch: Batch, row: int, names: tuple[str, ...] | None
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Times (s), and the numbers called ``names`` of all messages; those of equal length at once."""
        count = len(batch.time_ns)
        time_ns = batch.time_ns.copy()
        found: NDArray[np.float64] | None = None
        todo = np.ones(count, dtype=np.bool_)
        while todo.any():
            first = int(np.argmax(todo))
            layout = self._layout(batch, first)
            if names is not None and layout.names != names:
                reason = f"{self.place(row + first)} has other joints or numbers than the first one"
                raise FileError(self.path, reason, "the same in every message")
            mine = np.flatnonzero(todo & (batch.lengths == batch.lengths[first]))
            start = batch.offsets[mine]
            for begin, end in layout.fixed:
                here = batch.buffer[start[:, None] + np.arange(begin, end)]
                same = (here == batch.buffer[batch.offsets[first] + np.arange(begin, end)]).all(axis=1)
                mine, start = mine[same], start[same]
            if found is None:
                found = np.zeros((count, len(layout.offsets)))
            for column, offset in enumerate(layout.offsets):
                raw = np.ascontiguousarray(batch.buffer[start[:, None] + np.arange(offset, offset + 8)])
                found[mine, column] = raw.view("<f8")[:, 0]
            if layout.stamp_at is not None and (names is None or self._stamped):
                raw = np.ascontiguousarray(
                    batch.buffer[start[:, None] + np.arange(layout.stamp_at, layout.stamp_at + 8)]
                )
                stamp = raw.view("<u4").astype(np.int64)
                time_ns[mine] = stamp[:, 0] * 10**9 + stamp[:, 1]
            todo[mine] = False
        assert found is not None
        # a double has no room for ns since 1970
        time_s = np.asarray((time_ns - self._begin_ns) * 1e-9, dtype=np.float64)
        return time_s, found


def _last_before(
    time_s: NDArray[np.float64], values: NDArray[np.float64], at_s: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The last row of ``values`` before each time; NaN where there is none."""
    if not len(time_s):
        return np.full((len(at_s), values.shape[1]), np.nan)
    left = np.searchsorted(time_s, at_s, side="right") - 1
    return np.where((left >= 0)[:, None], values[np.maximum(left, 0)], np.nan)
