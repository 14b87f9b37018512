"""ROS 2 messages in CDR (little endian): templates that are filled with numbers, and joint states that are read."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.errors import GivewayError

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "IMU",
    "JOINT_STATE",
    "MULTI_ARRAY",
    "Layout",
    "Template",
    "imu_layout",
    "joint_layout",
    "joint_template",
    "multi_array_layout",
    "multi_array_template",
    "stamped_template",
]

ENCAPSULATION = b"\x00\x01\x00\x00"
JOINT_STATE, IMU, MULTI_ARRAY = "sensor_msgs/msg/JointState", "sensor_msgs/msg/Imu", "std_msgs/msg/Float64MultiArray"
_SEPARATOR = "=" * 80
_HEADER = f"""
{_SEPARATOR}
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
{_SEPARATOR}
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
_VECTOR = f"""{_SEPARATOR}
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
"""
DEFINITIONS = {
    JOINT_STATE: f"""std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
{_HEADER}""",
    MULTI_ARRAY: f"""MultiArrayLayout layout
float64[] data

{_SEPARATOR}
MSG: std_msgs/MultiArrayLayout
MultiArrayDimension[] dim
uint32 data_offset
{_SEPARATOR}
MSG: std_msgs/MultiArrayDimension
string label
uint32 size
uint32 stride
""",
    "geometry_msgs/msg/WrenchStamped": f"""std_msgs/Header header
Wrench wrench
{_HEADER}{_SEPARATOR}
MSG: geometry_msgs/Wrench
Vector3 force
Vector3 torque
{_VECTOR}""",
    "geometry_msgs/msg/PointStamped": f"""std_msgs/Header header
Point point
{_HEADER}{_SEPARATOR}
MSG: geometry_msgs/Point
float64 x
float64 y
float64 z
""",
}


@dataclass(frozen=True)
class Template:
    """Messages of one type that differ in their stamp and their numbers alone.

    Attributes:
        stamp_at: offset of seconds and nanoseconds; None: the type has none.
        numbers_at: offset of each float64.
    """

    type: str
    bytes: bytes
    stamp_at: int | None
    numbers_at: tuple[int, ...]

    @property
    def definition(self) -> str:
        return DEFINITIONS[self.type]

    def fill(self, time_ns: NDArray[np.int64], values: NDArray[np.float64]) -> NDArray[np.uint8]:
        """One message per time, (n, size)."""
        count = len(time_ns)
        found = np.tile(np.frombuffer(self.bytes, dtype=np.uint8), (count, 1))
        if self.stamp_at is not None:
            stamp = np.stack([time_ns // 10**9, time_ns % 10**9], axis=1).astype("<u4")
            found[:, self.stamp_at : self.stamp_at + 8] = stamp.view(np.uint8).reshape(count, 8)
        numbers = np.ascontiguousarray(values, dtype="<f8").view(np.uint8).reshape(count, -1, 8)
        for index, at in enumerate(self.numbers_at):
            found[:, at : at + 8] = numbers[:, index]
        return found


class _Builder:
    def __init__(self) -> None:
        self.data = bytearray(ENCAPSULATION)
        self.numbers: list[int] = []

    def align(self, size: int) -> None:
        self.data += bytes(-(len(self.data) - len(ENCAPSULATION)) % size)

    def u32(self, value: int) -> None:
        self.align(4)
        self.data += struct.pack("<I", value)

    def text(self, text: str) -> None:
        raw = text.encode() + b"\0"
        self.u32(len(raw))
        self.data += raw

    def floats(self, count: int) -> None:
        if count:
            self.align(8)
        for _ in range(count):
            self.numbers.append(len(self.data))
            self.data += bytes(8)

    def header(self, frame: str) -> None:
        self.u32(0)
        self.u32(0)
        self.text(frame)

    def template(self, name: str, stamp_at: int | None) -> Template:
        return Template(name, bytes(self.data), stamp_at, tuple(self.numbers))


def stamped_template(kind: str, numbers: int, frame: str = "base") -> Template:
    """A header and float64: WrenchStamped has 6, PointStamped 3."""
    built = _Builder()
    built.header(frame)
    built.floats(numbers)
    return built.template(f"geometry_msgs/msg/{kind}", len(ENCAPSULATION))


def joint_template(joints: Sequence[str]) -> Template:
    """Positions and efforts of ``joints``, in this order of numbers; no velocities."""
    built = _Builder()
    built.header("")
    built.u32(len(joints))
    for joint in joints:
        built.text(joint)
    for count in (len(joints), 0, len(joints)):
        built.u32(count)
        built.floats(count)
    return built.template(JOINT_STATE, len(ENCAPSULATION))


def multi_array_template(names: Sequence[str]) -> Template:
    """A number for each of ``names``, which stand in the label of the one dimension, with commas."""
    built = _Builder()
    built.u32(1)
    built.text(",".join(names))
    built.u32(len(names))
    built.u32(len(names))
    built.u32(0)
    built.u32(len(names))
    built.floats(len(names))
    return built.template(MULTI_ARRAY, None)


@dataclass(frozen=True)
class Layout:
    """Where the numbers of a message are: the names of its columns, and their offsets; the stamp's, if there is one.

    ``fixed``: bytes that are the same in every message of this layout, as (begin, end).
    """

    names: tuple[str, ...]
    offsets: tuple[int, ...]
    stamp_at: int | None
    fixed: tuple[tuple[int, int], ...]


class _Reader:
    def __init__(self, data: bytes) -> None:
        if data[:2] != ENCAPSULATION[:2]:
            raise GivewayError("message", f"encapsulation {data[:2].hex()}", "CDR, little endian (0001)")
        self.data, self.at = data, len(ENCAPSULATION)

    def align(self, size: int) -> None:
        self.at += -(self.at - len(ENCAPSULATION)) % size

    def u32(self) -> int:
        self.align(4)
        self._need(4)
        (value,) = struct.unpack_from("<I", self.data, self.at)
        self.at += 4
        return int(value)

    def text(self) -> str:
        length = self.u32()
        self._need(length)
        raw = self.data[self.at : self.at + length]
        self.at += length
        return raw.rstrip(b"\0").decode("utf-8", "replace")

    def floats(self, count: int) -> list[int]:
        """Offsets."""
        if count:
            self.align(8)
            self._need(8 * count)
        found = [self.at + 8 * index for index in range(count)]
        self.at += 8 * count
        return found

    def header(self) -> None:
        self.u32()
        self.u32()
        self.text()

    def _need(self, count: int) -> None:
        if self.at + count > len(self.data):
            raise GivewayError("message", f"{len(self.data)} bytes", f"at least {self.at + count}")


def joint_layout(data: bytes) -> Layout:
    """Of a JointState: columns JOINT/position, JOINT/velocity, JOINT/effort, as far as they are there."""
    reader = _Reader(data)
    reader.header()
    joints = [reader.text() for _ in range(reader.u32())]
    fixed = [(len(ENCAPSULATION) + 8, reader.at)]
    names: list[str] = []
    offsets: list[int] = []
    for what in ("position", "velocity", "effort"):
        reader.align(4)
        begin = reader.at
        count = reader.u32()
        fixed.append((begin, reader.at))
        found = reader.floats(count)
        if count == len(joints):
            names += [f"{joint}/{what}" for joint in joints]
            offsets += found
        elif count:
            raise GivewayError("message", f"{count} numbers of {what}", f"{len(joints)}, one per joint, or none")
    return Layout(tuple(names), tuple(offsets), len(ENCAPSULATION), tuple(fixed))


def imu_layout(data: bytes) -> Layout:
    """Of an Imu: yaw_rate and the two axes of the acceleration."""
    reader = _Reader(data)
    reader.header()
    frame = (len(ENCAPSULATION) + 8, reader.at)
    reader.floats(4 + 9)
    angular = reader.floats(3)
    reader.floats(9)
    linear = reader.floats(3)
    names = ("yaw_rate", "acceleration_x", "acceleration_y")
    return Layout(names, (angular[2], linear[0], linear[1]), len(ENCAPSULATION), (frame,))


def multi_array_layout(data: bytes) -> Layout:
    """Of a Float64MultiArray with one dimension, whose label names the numbers, with commas."""
    reader = _Reader(data)
    if (dimensions := reader.u32()) != 1:
        raise GivewayError("layout.dim", f"{dimensions} of them", "1, whose label names the numbers")
    names = reader.text().split(",")
    reader.u32()
    reader.u32()
    reader.u32()
    count = reader.u32()
    fixed = ((len(ENCAPSULATION), reader.at),)
    if count != len(names):
        raise GivewayError("data", f"{count} numbers", f"{len(names)}, as many as the label names")
    return Layout(tuple(names), tuple(reader.floats(count)), None, fixed)
