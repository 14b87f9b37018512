"""What the controller got in a run, as a log that replays to the same bits: CSV, Parquet or MCAP."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import GivewayError
from giveway.replay.arrow_columns import column_of
from giveway.replay.quantities import QUANTITIES, TIME, of_wheels
from giveway.robot.variables import Value, table
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.simulation.result import Result

__all__ = ["LOG_ENDINGS", "check_log_path", "write_log"]

LOG_ENDINGS = (".csv", ".parquet", ".mcap")


def check_log_path(path: Path) -> None:
    """GivewayError or FileError, before any work, if no log can be written to ``path``."""
    from giveway.base.files import check_file

    if path.suffix not in LOG_ENDINGS:
        raise GivewayError("--log", path.name, f"a name that ends in {', '.join(LOG_ENDINGS)}")
    check_file(path)


def write_log(path: Path, result: Result) -> None:
    """Write every input of the controller in ``result``, with the controller's parameters and the step."""
    from giveway.base.files import replace_file

    check_log_path(path)
    columns = _columns(result)
    parameters = dict(result.manifest["parameters_set"]["controller"])
    step_s = float(result.manifest["scenario"]["step_s"])
    write = {".csv": _write_csv, ".parquet": _write_parquet, ".mcap": _write_mcap}[path.suffix]
    with replace_file(path) as temporary:
        write(temporary, columns, parameters, step_s)


def _columns(result: Result) -> dict[str, NDArray[Any]]:
    """By quantity; inputs that a run never sets are left out."""
    traces = result.traces
    found: dict[str, NDArray[Any]] = {TIME: traces["time"].values}
    for name, quantity in QUANTITIES.items():
        for model in ("controller", "testbed"):
            if f"{model}.{quantity.controller}" in traces:
                found[name] = traces[f"{model}.{quantity.controller}"].values
    imu = ("acceleration_x", "acceleration_y", "yaw_rate", "imu_counter", "imu_present")
    if all((found[name] == table("controller")[str(QUANTITIES[name].controller)].start).all() for name in imu):
        for name in imu:  # the robot has none: its controller gets the start values, as in a replay
            del found[name]
    return found


def _head(name: str) -> str:
    unit = QUANTITIES[name].unit
    return name if unit == "1" else f"{name} [{unit}]"


def _write_csv(path: Path, columns: Mapping[str, NDArray[Any]], parameters: Mapping[str, Value], step_s: float) -> None:
    numbers = [values.astype(np.int64) if values.dtype.kind in "biu" else values for values in columns.values()]
    with path.open("w", encoding="utf-8") as file:
        file.write("# The controller's inputs in a run: `giveway replay` gives the run's bits.\n")
        file.write(f"# step_s = {step_s!r}\n")
        file.writelines(f"# controller.{name} = {value!r}\n" for name, value in parameters.items())
        file.write(",".join(_head(name) for name in columns) + "\n")
        file.writelines(",".join(map(repr, row)) + "\n" for row in zip(*(one.tolist() for one in numbers), strict=True))


def _write_parquet(
    path: Path, columns: Mapping[str, NDArray[Any]], parameters: Mapping[str, Value], step_s: float
) -> None:
    import pyarrow
    import pyarrow.parquet

    from giveway.replay.parquet_log import ORIGIN_KEY

    fields = [
        pyarrow.field(name, pyarrow.from_numpy_dtype(values.dtype), metadata={"units": QUANTITIES[name].unit})
        for name, values in columns.items()
    ]
    origin = json.dumps({"step_s": step_s, "controller": dict(parameters)})
    schema = pyarrow.schema(fields, metadata={ORIGIN_KEY: origin})
    with path.open("wb") as file:
        pyarrow.parquet.write_table(
            pyarrow.Table.from_arrays([column_of(values) for values in columns.values()], schema=schema),
            file,
            compression="zstd",
        )


def _write_mcap(
    path: Path, columns: Mapping[str, NDArray[Any]], parameters: Mapping[str, Value], step_s: float
) -> None:
    """Inputs with every bit as numbers, and beside them joint states, for other tools."""
    from giveway.replay.cdr import joint_template, multi_array_template
    from giveway.replay.mcap_writer import Channel, McapWriter
    from giveway.replay.ros_log import INPUTS_TOPIC, ORIGIN_NAME

    inputs = Channel(INPUTS_TOPIC, multi_array_template(list(columns)))
    joints = Channel("/joint_states", joint_template([f"wheel_{wheel}" for wheel in range(WHEELS)]))
    time_ns = np.rint(columns[TIME] * 1e9).astype(np.int64)
    counts = parameters.get("estimator.encoder_counts", table("controller")["estimator.encoder_counts"].start)
    angle = np.stack([columns[name] for name in of_wheels("encoder")], axis=1) * (2.0 * math.pi / float(counts or 1))
    torque = np.stack([columns[name] for name in of_wheels("torque")], axis=1)
    origin = {"step_s": repr(step_s), "controller": json.dumps(dict(parameters))}
    with path.open("wb") as file:
        writer = McapWriter(file, [inputs, joints], {ORIGIN_NAME: origin})
        for start in range(0, len(time_ns), 1 << 14):
            rows = slice(start, start + (1 << 14))
            values = np.stack([one[rows].astype(np.float64) for one in columns.values()], axis=1)
            writer.write(inputs, time_ns[rows], values)
            writer.write(joints, time_ns[rows], np.concatenate([angle[rows], torque[rows]], axis=1))
        writer.close()
