"""Logs from CSV files: columns, units, and every way to be wrong with its line."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow
import pyarrow.parquet
import pytest
from arc_logs import arc_log, csv_lines, sine
from giveway.base import native
from giveway.base.errors import FileError
from giveway.identification.motion_log import MotionLog, pieces, read_log
from giveway.robot.robot_file import Robot, read_robot

SHORT = arc_log((1.0, 0.5, 0.0), sine(4.0, 1.0), 1.0)


@pytest.fixture(scope="module")
def robot() -> Robot:
    return read_robot(native.robot())


@pytest.fixture
def write(tmp_path: Path) -> Callable[[list[str]], Path]:
    def to_file(lines: list[str]) -> Path:
        path = tmp_path / "log.csv"
        path.write_text("\n".join(lines) + "\n")
        return path

    return to_file


def table(**columns: np.ndarray) -> list[str]:
    rows = np.column_stack(list(columns.values()))
    return [",".join(columns), *(",".join(repr(float(value)) for value in row) for row in rows)]


def test_si_units(robot: Robot, write: Callable[[list[str]], Path]) -> None:
    path = write(csv_lines(SHORT))
    log = read_log(path, robot)
    assert log.name == "log.csv"
    assert len(log.sha256) == 64
    for name in ("time_s", "wheel_angle_rad", "torque_nm"):
        assert getattr(log, name) == pytest.approx(getattr(SHORT, name), rel=1e-8, abs=1e-8)  # 9 digits were written


def test_other_units_order_and_columns(robot: Robot, write: Callable[[list[str]], Path]) -> None:
    angle, torque = SHORT.wheel_angle_rad, SHORT.torque_nm
    lines = table(
        battery_v=np.full(len(SHORT.time_s), 24.0),
        torque_2_mnm=1e3 * torque[:, 2],
        torque_1_nm=torque[:, 1],
        torque_0_nm=torque[:, 0],
        wheel_angle_0_deg=np.rad2deg(angle[:, 0]),
        wheel_angle_1_rad=(angle[:, 1] + math.pi) % (2.0 * math.pi) - math.pi,
        wheel_angle_2_counts=(angle[:, 2] * 8500.0 / (2.0 * math.pi) + 2.0**31 - 5.0) % 2.0**32 - 2.0**31,
        time_ms=1e3 * SHORT.time_s,
    )
    log = read_log(write(lines), robot)
    assert log.time_s == pytest.approx(SHORT.time_s, abs=1e-12)
    assert log.torque_nm == pytest.approx(torque, abs=1e-12)
    assert log.wheel_angle_rad - log.wheel_angle_rad[0] == pytest.approx(angle - angle[0], abs=1e-6)  # of 1.6e6 rad


def test_nanoseconds(robot: Robot, write: Callable[[list[str]], Path]) -> None:
    columns = {f"wheel_angle_{i}_rad": SHORT.wheel_angle_rad[:, i] for i in range(3)}
    columns |= {f"torque_{i}_nm": SHORT.torque_nm[:, i] for i in range(3)}
    assert read_log(write(table(time_ns=1e9 * SHORT.time_s, **columns)), robot).time_s == pytest.approx(SHORT.time_s)


def test_the_log_of_a_run(robot: Robot, write: Callable[[list[str]], Path]) -> None:
    """Its heads, under comments, mean the same as those of a log of one's own; an error has the line of the file."""
    columns = {f"motor_angle_{i}_counts": np.rint(SHORT.wheel_angle_rad[:, i] * 1e3) for i in range(3)}
    columns |= {f"torque_{i}_nm": SHORT.torque_nm[:, i] for i in range(3)}
    own = table(time_s=SHORT.time_s, **columns)
    heads = ["time [s]", *(f"encoder_{i}" for i in range(3)), *(f"torque_{i} [N.m]" for i in range(3))]
    comments = ["# of a run", "# step_s = 0.001"]
    wanted, found = read_log(write(own), robot), read_log(write([*comments, ",".join(heads), *own[1:]]), robot)
    for name in ("time_s", "wheel_angle_rad", "torque_nm"):
        np.testing.assert_array_equal(getattr(found, name), getattr(wanted, name))
    with pytest.raises(FileError, match=r"line 5: torque_1 \[N\.m\] is nan"):
        read_log(write([*comments, ",".join(heads), own[1], "0.5,1,2,3,0.1,nan,0.2", *own[2:]]), robot)
    with pytest.raises(FileError, match=r"line 3: there is no column for torque_2"):
        read_log(write([*comments, ",".join(heads[:-1]), *own[1:]]), robot)


def test_a_parquet_log_is_read_like_a_csv(robot: Robot, tmp_path: Path) -> None:
    """As `giveway run --log` writes it, units beside the names; rows count from 1."""
    columns = {"time": SHORT.time_s} | {f"encoder_{i}": np.rint(SHORT.wheel_angle_rad[:, i] * 1e3) for i in range(3)}
    columns |= {f"torque_{i}": SHORT.torque_nm[:, i] for i in range(3)}
    units = {"time": "s"} | {f"torque_{i}": "N.m" for i in range(3)}

    def written(name: str) -> Path:
        fields = [pyarrow.field(one, pyarrow.float64(), metadata={"units": units.get(one, "1")}) for one in columns]
        path = tmp_path / name
        pyarrow.parquet.write_table(pyarrow.table(list(columns.values()), schema=pyarrow.schema(fields)), path)
        return path

    lines = table(**{f"{name} [{units[name]}]" if name in units else name: one for name, one in columns.items()})
    (tmp_path / "log.csv").write_text("\n".join(lines), encoding="utf-8")
    wanted, found = read_log(tmp_path / "log.csv", robot), read_log(written("log.parquet"), robot)
    for name in ("time_s", "wheel_angle_rad", "torque_nm"):
        np.testing.assert_array_equal(getattr(found, name), getattr(wanted, name))
    columns["torque_1"] = np.where(np.arange(len(SHORT.time_s)) == 6, math.nan, columns["torque_1"])
    with pytest.raises(FileError, match=r"row 7: torque_1 \[N\.m\] is nan"):
        read_log(written("nan.parquet"), robot)
    del columns["torque_2"]
    with pytest.raises(FileError, match="the columns: there is no column for torque_2"):
        read_log(written("less.parquet"), robot)


def test_a_log_is_cut_where_the_robot_stands() -> None:
    time = np.arange(0.0, 30.0, 0.01)
    swing = np.where((time > 1.0) & (time < 11.0), 1.0 - np.cos(0.2 * math.pi * (time - 1.0)), 0.0)
    later = np.where((time > 14.0) & (time < 24.0), 1.0 - np.cos(0.2 * math.pi * (time - 14.0)), 0.0)
    angle = np.stack([swing, later, np.zeros_like(time)], axis=1)
    log = MotionLog("two.csv", time, angle, np.zeros_like(angle))
    found = pieces(log)  # with the rest of 0.3 s on either side
    assert [(one.time_s[0], one.time_s[-1]) for one in found] == [
        (pytest.approx(0.7, abs=0.1), pytest.approx(11.3, abs=0.1)),
        (pytest.approx(13.7, abs=0.1), pytest.approx(24.3, abs=0.1)),
    ]
    assert found[1].name.startswith("two.csv, 13.")
    one = MotionLog("one.csv", time[:1300], angle[:1300], np.zeros((1300, 3)))
    assert pieces(one) == [one]


def test_counts_go_on_over_their_wrap(robot: Robot, write: Callable[[list[str]], Path]) -> None:
    counts = np.arange(len(SHORT.time_s)) * 40.0 + 2.0**31 - 400.0
    wrapped = (counts + 2.0**31) % 2.0**32 - 2.0**31
    columns = {f"wheel_angle_{i}_counts": wrapped for i in range(3)} | {
        f"torque_{i}_nm": SHORT.torque_nm[:, i] for i in range(3)
    }
    log = read_log(write(table(time_s=SHORT.time_s, **columns)), robot)
    assert np.diff(log.wheel_angle_rad, axis=0) == pytest.approx(40.0 * 2.0 * math.pi / 8500.0, rel=1e-6)


def test_motor_angles_lose_the_deflection(robot: Robot, write: Callable[[list[str]], Path]) -> None:
    stiffness = float(robot.value("drivetrain.stiffness"))
    motor = dataclasses.replace(SHORT, wheel_angle_rad=SHORT.wheel_angle_rad + SHORT.torque_nm / stiffness)
    lines = csv_lines(motor)
    lines[0] = lines[0].replace("wheel_angle", "motor_angle")
    assert read_log(write(lines), robot).wheel_angle_rad == pytest.approx(SHORT.wheel_angle_rad, abs=1e-7)


def changed(line: int, old: str, new: str) -> list[str]:
    """The good file with something replaced in one line, counted from 1."""
    lines = csv_lines(SHORT)
    assert old in lines[line - 1]
    lines[line - 1] = lines[line - 1].replace(old, new, 1)
    return lines


def cell(line: int, column: int, text: str) -> list[str]:
    lines = csv_lines(SHORT)
    cells = lines[line - 1].split(",")
    cells[column] = text
    lines[line - 1] = ",".join(cells)
    return lines


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        (changed(1, "torque_2_nm", "torque_3_nm"), "line 1: there is no column for torque_2"),
        (changed(1, "time_s", "time"), "column time states no unit; allowed: time_s or time_ms"),
        (changed(1, "torque_0_nm", "torque_0_lbft"), "column torque_0_lbft has the unit lbft; allowed: torque_0_nm"),
        (changed(1, "wheel_angle_1_rad", "wheel_angle_1_turns"), "unit turns; allowed: wheel_angle_1_rad or"),
        (changed(1, "torque_2_nm", "torque_1_mnm"), "torque_1_nm and torque_1_mnm say the same thing"),
        (cell(7, 2, ""), "line 7: wheel_angle_1_rad is empty"),
        (cell(8, 5, "NaN"), "line 8: torque_1_nm is NaN"),
        (cell(9, 0, "soon"), "line 9: time_s is soon"),
        (cell(10, 6, "inf"), "line 10: torque_2_nm is inf"),
        (cell(11, 0, "0.001"), "line 11: time goes from 0.016 s to 0.001 s; it has to rise"),
        (cell(11, 0, "0.016"), "line 11: time goes from 0.016 s to 0.016 s"),
        (csv_lines(SHORT)[:100] + csv_lines(SHORT)[200:], "line 101: 0.202 s since the line before, 101 times"),
        ([*csv_lines(SHORT)[:20], "0.04,1,2"], "line 21: 3 values"),
        (csv_lines(SHORT)[:5], "has 4 lines of data"),
        ([], "line 1: there is no column for time"),
    ],
)
def test_refusals_name_file_line_and_column(
    lines: list[str], words: str, robot: Robot, write: Callable[[list[str]], Path]
) -> None:
    path = write(lines)
    with pytest.raises(FileError) as refusal:
        read_log(path, robot)
    assert words in str(refusal.value)
    assert str(path) in str(refusal.value)


def test_empty_lines_do_not_shift_the_count(robot: Robot, write: Callable[[list[str]], Path]) -> None:
    lines = cell(8, 5, "NaN")
    lines[3:3] = ["", "   "]
    with pytest.raises(FileError, match="line 10: torque_1_nm is NaN"):
        read_log(write(lines), robot)


def test_unreadable_files(robot: Robot, tmp_path: Path) -> None:
    with pytest.raises(FileError, match="no such file"):
        read_log(tmp_path / "none.csv", robot)
    (tmp_path / "binary.csv").write_bytes(b"\xff\xfe\x00\x01" * 10)
    with pytest.raises(FileError, match="cannot be read: it is no text; give a log as CSV or Parquet"):
        read_log(tmp_path / "binary.csv", robot)
    (tmp_path / "broken.parquet").write_bytes(b"PAR1" * 10)
    with pytest.raises(FileError, match=r"broken\.parquet: cannot be read: .*give a log as CSV or Parquet"):
        read_log(tmp_path / "broken.parquet", robot)
