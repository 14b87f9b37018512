"""ROS 2 logs against other people's writers and readers: rosbags (both storages), mcap."""

from __future__ import annotations

import contextlib
import io
import math
import shutil
from pathlib import Path

import giveway
import mcap.reader
import mcap.writer
import numpy as np
import pytest
from cosim_helpers import Cli, short
from giveway.base.errors import FileError, GivewayError, UnknownNameError
from giveway.replay.mapping import Wishes
from giveway.replay.play import Choice, Replay, open_log
from giveway.replay.run_log import write_log
from giveway.simulation.result import Result
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

TYPES = get_typestore(Stores.ROS2_HUMBLE)
BEGIN_NS = 1_700_000_000_123_456_789
JOINTS = ("left", "arm", "front", "right")  # wheels 1, none, 0, 2
WHEELS = ("front", "left", "right")
JOINT_STATE = "sensor_msgs/msg/JointState"


@pytest.fixture(scope="module")
def result() -> Result:
    return giveway.run(short(), engine="native")


def stamp(time_ns: int) -> object:
    return TYPES.types["builtin_interfaces/msg/Time"](time_ns // 10**9, time_ns % 10**9)


def header(time_ns: int) -> object:
    return TYPES.types["std_msgs/msg/Header"](stamp(time_ns), "base_link")


def joint_state(time_ns: int, angle: np.ndarray, torque: np.ndarray, joints: tuple[str, ...] = JOINTS) -> bytes:
    order = [WHEELS.index(joint) if joint in WHEELS else None for joint in joints]
    position, effort = ([0.0 if at is None else float(one[at]) for at in order] for one in (angle, torque))
    kind = TYPES.types[JOINT_STATE]
    message = kind(header(time_ns), list(joints), np.array(position), np.zeros(len(joints)), np.array(effort))
    return bytes(TYPES.serialize_cdr(message, JOINT_STATE))


def imu(time_ns: int, yaw_rate: float) -> bytes:
    vector, quaternion = (TYPES.types[f"geometry_msgs/msg/{name}"] for name in ("Vector3", "Quaternion"))
    nothing = np.zeros(9)
    message = TYPES.types["sensor_msgs/msg/Imu"](
        header(time_ns),
        quaternion(0.0, 0.0, 0.0, 1.0),
        nothing,
        vector(0.0, 0.0, yaw_rate),
        nothing,
        vector(1.0, 2.0, 9.81),
        nothing,
    )
    return bytes(TYPES.serialize_cdr(message, "sensor_msgs/msg/Imu"))


def samples(result: Result) -> list[tuple[int, np.ndarray, np.ndarray]]:
    traces = result.traces
    counts, torque = (
        np.stack([traces[f"testbed.sensor.{name}[{i}]"].values for i in range(3)], axis=1)
        for name in ("encoder", "torque")
    )
    times = BEGIN_NS + np.rint(traces["time"].values * 1e9).astype(np.int64)
    return [(int(t), a, b) for t, a, b in zip(times, counts * (2.0 * math.pi / 8500.0), torque, strict=True)]


def bag(folder: Path, plugin: StoragePlugin, result: Result) -> Path:
    with Writer(folder, version=9, storage_plugin=plugin) as writer:
        joints = writer.add_connection("/joint_states", JOINT_STATE, typestore=TYPES)
        gyro = writer.add_connection("/imu", "sensor_msgs/msg/Imu", typestore=TYPES)
        for number, (time_ns, angle, torque) in enumerate(samples(result)):
            if number % 10 == 0:
                writer.write(gyro, time_ns, imu(time_ns, 0.01 * number))
            writer.write(joints, time_ns + 300_000, joint_state(time_ns, angle, torque))
    return folder


def played(path: Path, joints: tuple[str, ...] | None = WHEELS) -> tuple[Replay, dict[str, np.ndarray]]:
    wishes = Wishes(joints=joints)
    source = open_log(path, wishes, None, "motor_angle", "torque")
    with Replay(source, wishes, Choice({}, 1e-3)) as replay:
        parts = [played.steps.inputs for played in replay.all()]
    return replay, {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def same_as_the_run(inputs: dict[str, np.ndarray], result: Result) -> None:
    for wheel in range(3):
        for name in (f"sensor.torque[{wheel}]", f"sensor.encoder[{wheel}]"):
            assert inputs[name].tobytes() == result.traces[f"testbed.{name}"].values.tobytes(), name


@pytest.mark.parametrize("plugin", list(StoragePlugin))
def test_a_bag_of_another_writer(plugin: StoragePlugin, result: Result, tmp_path: Path) -> None:
    path = bag(tmp_path / "bag", plugin, result)
    replay, inputs = played(path)
    assert (replay.did.way, replay.did.rows) == ("as-is", 501)
    same_as_the_run(inputs, result)
    assert inputs["sensor.yaw_rate"][[0, 9, 10, 499]].tolist() == [0.0, 0.0, 0.1, 4.9]
    assert inputs["sensor.acceleration[1]"].tolist() == [2.0] * 501
    said = " ".join(replay.source.said)
    assert "efforts as torque" in said
    assert "/imu" in said
    one = next(file for file in path.iterdir() if file.suffix in (".db3", ".mcap"))
    same_as_the_run(played(one)[1], result)
    with pytest.raises(GivewayError, match="--joints: nothing, and /joint_states has left, arm, front, right"):
        played(path, None)
    with pytest.raises(UnknownNameError, match="--joints: back is unknown"):
        played(path, ("front", "left", "back"))


@pytest.mark.parametrize("compression", list(mcap.writer.CompressionType))
@pytest.mark.parametrize("indexed", [True, False])
def test_an_mcap_of_another_writer(
    compression: mcap.writer.CompressionType, indexed: bool, result: Result, tmp_path: Path
) -> None:
    path = tmp_path / "log.mcap"
    index = mcap.writer.IndexType.ALL if indexed else mcap.writer.IndexType.NONE
    with path.open("wb") as file:
        writer = mcap.writer.Writer(
            file, compression=compression, index_types=index, chunk_size=20_000, use_chunking=indexed
        )
        writer.start("ros2")
        schema = writer.register_schema(JOINT_STATE, "ros2msg", b"")
        channel = writer.register_channel("/joint_states", "cdr", schema)
        for time_ns, angle, torque in samples(result):
            data = joint_state(time_ns, angle, torque, WHEELS)
            writer.add_message(channel, time_ns, data, time_ns)
        writer.finish()
    replay, inputs = played(path, None)
    same_as_the_run(inputs, result)
    assert "wheels 0 to 2 are the joints front, left, right, in the messages' order" in replay.source.said


def test_another_reader_reads_what_is_written(result: Result, cli: Cli, tmp_path: Path) -> None:
    write_log(tmp_path / "run.mcap", result)
    with (tmp_path / "run.mcap").open("rb") as file:
        reader = mcap.reader.make_reader(file, validate_crcs=True)
        messages = list(reader.iter_messages(topics="/joint_states"))
        assert reader.get_summary().statistics.message_count == 2 * 501
    for (_, _, message), (time_ns, angle, torque) in zip(messages, samples(result), strict=True):
        found = TYPES.deserialize_cdr(message.data, JOINT_STATE)
        assert message.log_time == time_ns - BEGIN_NS
        assert (found.position.tolist(), found.effort.tolist()) == (angle.tolist(), torque.tolist())
    done = cli("replay", "run.mcap", "--out", "out")
    assert done.returncode == 0, done.stderr
    topics: dict[str, list[object]] = {}
    with (tmp_path / "out/replay.mcap").open("rb") as file:
        for schema, channel, message in mcap.reader.make_reader(file, validate_crcs=True).iter_messages():
            assert schema is not None
            topics.setdefault(channel.topic, []).append(TYPES.deserialize_cdr(message.data, schema.name))
    wrench = [one.wrench.force.x for one in topics["/giveway/wrench"]]  # type: ignore[attr-defined]
    assert wrench == result.traces["controller.estimate.force_x"].values[::10].tolist()
    assert [len(topics[name]) for name in ("/giveway/state", "/giveway/detection")] == [51, 1]
    assert topics["/giveway/place"]


def test_a_file_that_is_cut_off(result: Result, tmp_path: Path) -> None:
    write_log(tmp_path / "run.mcap", result)
    whole = (tmp_path / "run.mcap").read_bytes()
    rng = np.random.default_rng(1)
    for length in (9, 30, 2000, len(whole) // 2):
        (tmp_path / "cut.mcap").write_bytes(whole[:length])
        with pytest.raises(FileError, match=r"cut\.mcap"):
            played(tmp_path / "cut.mcap", None)
    for _ in range(30):
        broken = bytearray(whole)
        for at in rng.integers(8, 3000, 3):
            broken[at] ^= int(rng.integers(1, 256))
        (tmp_path / "broken.mcap").write_bytes(bytes(broken))
        with contextlib.suppress(GivewayError):  # it is named, or what changed does not matter
            played(tmp_path / "broken.mcap", None)


def test_bags_that_cannot_be_read(result: Result, tmp_path: Path) -> None:
    path = bag(tmp_path / "bag", StoragePlugin.SQLITE3, result)
    listing = path / "metadata.yaml"
    text = listing.read_text()
    listing.write_text(text.replace("bag.db3", "other.db3"))
    with pytest.raises(FileError, match=r"names other\.db3, which is not there"):
        played(path)
    listing.write_text("")
    with pytest.raises(FileError, match="names no files"):
        played(path)
    shutil.rmtree(path)
    path.mkdir()
    with pytest.raises(FileError, match=r"is a folder without metadata\.yaml"):
        played(path)
    file = io.BytesIO()
    writer = mcap.writer.Writer(file)
    writer.start("ros2")
    schema = writer.register_schema("std_msgs/msg/String", "ros2msg", b"")
    writer.add_message(writer.register_channel("/talk", "cdr", schema), 0, b"\0\1\0\0\1\0\0\0\0", 0)
    writer.finish()
    (tmp_path / "talk.mcap").write_bytes(file.getvalue())
    with pytest.raises(FileError, match=r"has no sensor_msgs/msg/JointState \(it has /talk \(std_msgs/msg/String\)\)"):
        played(tmp_path / "talk.mcap")
