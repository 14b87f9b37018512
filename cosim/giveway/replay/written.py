"""What a replay found, written while it runs: Parquet of every step, MCAP for ROS tools."""

from __future__ import annotations

from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from giveway.identification.torque_model import TorqueModel
from giveway.library.replay import controller_outputs
from giveway.replay.arrow_columns import column_of
from giveway.replay.inputs import value_of
from giveway.replay.story import Envelope
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from giveway.replay.play import Played, Replay
    from giveway.robot.variables import Value

__all__ = ["CURVES", "Curves", "McapFile", "ParquetFile", "residual_torques"]

MCAP_STEP_S = 0.01
_WHEELS = range(WHEELS)
CURVES = (
    *(f"torque[{wheel}]" for wheel in _WHEELS),
    *(f"residual[{wheel}]" for wheel in _WHEELS),
    *("force", "torque_z", "statistic"),
)


def residual_torques(outputs: Mapping[str, NDArray[Any]], parameters: Mapping[str, Value]) -> NDArray[np.float64]:
    """What the model does not explain of each wheel's torque, N m, (n, wheels): the estimated wrench at the wheels."""

    def value(name: str) -> float:
        return value_of(parameters, name)

    model = TorqueModel(value("geometry.wheel_radius"), value("geometry.wheel_distance"), 1.0, 0.0, 0.0, 0.0, 0.0)
    azimuth = value("geometry.azimuth")
    x, y = outputs["estimate.force_x"], outputs["estimate.force_y"]
    cos, sin = np.cos(azimuth), np.sin(azimuth)
    wrench = np.stack([cos * x + sin * y, cos * y - sin * x, outputs["estimate.torque_z"]], axis=1)
    # without the threads of BLAS, which would wait for the controller's
    at_slots = -np.einsum("ij,jk->ik", wrench, np.linalg.inv(model.wheel_jacobian))
    slots = [int(value(f"geometry.wheel_slot[{wheel}]")) for wheel in _WHEELS]
    return np.asarray(at_slots[:, slots])


class Curves:
    """Envelopes for the page."""

    def __init__(self, step_s: float) -> None:
        self.envelope = Envelope(len(CURVES), step_s)

    def add(self, played: Played, residual: NDArray[np.float64]) -> None:
        outputs = played.outputs
        columns = [*played.steps.torque_nm.T, *residual.T]
        columns += [outputs[f"{name}"] for name in ("estimate.force", "estimate.torque_z", "detection.statistic")]
        values = np.stack(columns, axis=1)
        values[~np.isfinite(values)] = np.nan
        self.envelope.add(played.steps.first, values)


class ParquetFile:
    """Time, inputs and outputs of every step."""

    def __init__(self, path: Path, replay: Replay, outputs: tuple[str, ...]) -> None:
        self._path, self._replay, self._outputs = path, replay, outputs
        self._writer: Any = None
        self._stream: IO[bytes] | None = None

    def add(self, played: Played, residual: NDArray[np.float64]) -> None:
        import pyarrow
        import pyarrow.parquet

        steps = played.steps
        columns: dict[str, tuple[NDArray[Any], str]] = {
            "time": ((steps.first + np.arange(len(steps.present))) * self._replay.choice.step_s, "s"),
        }
        for wheel in _WHEELS:
            columns[f"sensor.torque[{wheel}]"] = (steps.inputs[f"sensor.torque[{wheel}]"], "N.m")
        for wheel in _WHEELS:
            columns[f"sensor.encoder[{wheel}]"] = (steps.inputs[f"sensor.encoder[{wheel}]"], "1")
        columns["sensor.present"] = (steps.present, "1")
        for wheel in _WHEELS:
            columns[f"residual.torque[{wheel}]"] = (residual[:, wheel], "N.m")
        for name in self._outputs:
            columns[name] = (played.outputs[name], controller_outputs()[name].unit or "1")
        if self._writer is None:
            fields = [
                pyarrow.field(name, pyarrow.from_numpy_dtype(values.dtype), metadata={"units": unit})
                for name, (values, unit) in columns.items()
            ]
            self._schema = pyarrow.schema(fields)
            self._stream = self._path.open("wb")
            self._writer = pyarrow.parquet.ParquetWriter(
                self._stream, self._schema, compression="lz4", use_dictionary=False, write_statistics=False
            )
        data = [column_of(values) for values, _ in columns.values()]
        self._writer.write_table(pyarrow.Table.from_arrays(data, schema=self._schema))

    def close(self) -> None:
        if self._writer is not None and self._stream is not None:
            self._writer.close()
            self._stream.close()


class McapFile:
    """Wrench, place and state every 10 ms, and every detection."""

    STATE = ("mode", "status", "detection.count", "detection.statistic", "estimate.lever_arm_sigma", "estimate.valid")

    def __init__(self, path: Path, replay: Replay) -> None:
        from giveway.replay.cdr import multi_array_template, stamped_template
        from giveway.replay.mcap_writer import Channel, McapWriter

        self._step_s = replay.choice.step_s
        self._every = max(1, round(MCAP_STEP_S / self._step_s))
        self._did = replay.did
        self._stream = path.open("wb")
        residual = [f"residual.torque[{wheel}]" for wheel in _WHEELS]
        hit = ("force_x", "force_y", "torque_z", "point_x", "point_y", "point_sigma", "channel")
        self._wrench = Channel("/giveway/wrench", stamped_template("WrenchStamped", 6))
        self._place = Channel("/giveway/place", stamped_template("PointStamped", 3))
        self._state = Channel("/giveway/state", multi_array_template([*self.STATE, *residual]))
        self._hit = Channel("/giveway/detection", multi_array_template(hit))
        self._hits = hit
        channels = [self._wrench, self._place, self._state, self._hit]
        self._writer = McapWriter(self._stream, channels, {})

    def add(self, played: Played, residual: NDArray[np.float64]) -> None:
        outputs, first = played.outputs, played.steps.first
        numbers = first + np.arange(len(residual))
        rows = np.flatnonzero(numbers % self._every == 0)
        time_ns = np.rint((numbers[rows] * self._step_s + self._did.stamps_from_s) * 1e9).astype(np.int64)

        def columns(*names: str) -> NDArray[np.float64]:
            taken = [outputs[name][rows].astype(np.float64) if name else np.zeros(len(rows)) for name in names]
            return np.stack(taken, axis=1)

        wrench = columns("estimate.force_x", "estimate.force_y", "", "", "", "estimate.torque_z")
        self._writer.write(self._wrench, time_ns, wrench)
        valid = rows[outputs["estimate.valid"][rows]]
        point = np.stack([outputs["estimate.point_x"][valid], outputs["estimate.point_y"][valid], 0.0 * valid], axis=1)
        self._writer.write(self._place, time_ns[outputs["estimate.valid"][rows]], point)
        self._writer.write(self._state, time_ns, np.concatenate([columns(*self.STATE), residual[rows]], axis=1))
        begin_s = self._did.stamps_from_s
        hits = np.array([round((one.time_s + begin_s) * 1e9) for one in played.detections], dtype=np.int64)
        at = [round(one.time_s / self._step_s) - first for one in played.detections]
        values = np.stack([outputs[f"detection.{name}"][at].astype(np.float64) for name in self._hits], axis=1)
        self._writer.write(self._hit, hits, values)

    def close(self) -> None:
        self._writer.close()
        self._stream.close()
