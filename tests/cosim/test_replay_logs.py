"""Logs that no run wrote: columns, units, rows between the steps, what is missing, what looks wrong."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from pathlib import Path

import mcap.reader
import numpy as np
import pytest
from arc_logs import DISTANCE, R_W, arc_log, jacobians, sine
from cosim_helpers import Cli
from giveway.base import native
from giveway.base.errors import FileError, GivewayError
from giveway.identification.motion_log import MotionLog
from giveway.replay.mapping import Wishes, read_wishes
from giveway.replay.play import Choice, Replay, open_log

ROBOT = str(native.robot())
LOG = arc_log((1.0, 0.6, -0.3), sine(3.0, 0.5), 4.0, offset_nm=(0.0, 0.0, 0.0))
Columns = dict[str, np.ndarray]


def columns(log: MotionLog = LOG) -> Columns:
    """With a tenth of a second at rest before."""
    rest = np.arange(100) * 0.002
    still = np.zeros((100, 3))
    time = np.concatenate([rest, 0.2 + log.time_s])
    angle, torque = (np.concatenate([still, values]) for values in (log.wheel_angle_rad, log.torque_nm))
    found = {"time [s]": time}
    found |= {f"wheel_angle_{i} [rad]": angle[:, i] for i in range(3)}
    return found | {f"torque_{i} [N.m]": torque[:, i] for i in range(3)}


def csv(path: Path, values: Columns) -> Path:
    rows = zip(*(column.tolist() for column in values.values()), strict=True)
    path.write_text("\n".join([",".join(values), *(",".join(map(repr, row)) for row in rows)]) + "\n")
    return path


def played(path: Path, wishes: Wishes | None = None, **choice: object) -> Replay:
    wishes = wishes or Wishes()
    source = open_log(path, wishes, None, "motor_angle", "torque")
    with Replay(source, wishes, Choice({}, 1e-3, **choice)) as replay:  # type: ignore[arg-type]
        for _ in replay.all():
            pass
    return replay


def test_a_log_of_free_motion_is_resampled_and_found_in_order(tmp_path: Path) -> None:
    replay = played(csv(tmp_path / "log.csv", columns()))
    assert (replay.did.way, replay.did.rows, replay.did.steps) == ("linear", 2100, 4199)
    assert replay.makes_plan
    assert replay.findings.wrong == []
    assert "signs and order of torque fit the motion" in replay.findings.fine


Change = Callable[[Columns], Columns]


def swapped(values: Columns) -> Columns:
    return values | {"torque_1 [N.m]": values["torque_2 [N.m]"], "torque_2 [N.m]": values["torque_1 [N.m]"]}


def turned(values: Columns) -> Columns:
    return values | {"torque_0 [N.m]": -values["torque_0 [N.m]"]}


def dead(values: Columns) -> Columns:
    return values | {"torque_1 [N.m]": np.zeros_like(values["torque_1 [N.m]"])}


def in_deg_as_rad(values: Columns) -> Columns:
    return values | {f"wheel_angle_{i} [rad]": np.rad2deg(values[f"wheel_angle_{i} [rad]"]) for i in range(3)}


def in_mnm_as_nm(values: Columns) -> Columns:
    return values | {f"torque_{i} [N.m]": 1e3 * values[f"torque_{i} [N.m]"] for i in range(3)}


def with_yaw(sign: float) -> Change:
    def change(values: Columns) -> Columns:
        yaw = sum(values[f"wheel_angle_{i} [rad]"] for i in range(3)) * 0.1016 / (3.0 * 0.24)
        return values | {"yaw_rate [rad/s]": sign * np.gradient(yaw, values["time [s]"])}

    return change


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (swapped, "torque fits the motion better otherwise: torque_1 = torque_2, torque_2 = torque_1"),
        (turned, "torque fits the motion better otherwise: torque_0 = -torque_0"),
        (dead, "torque_1 never changes: all three sensors are needed"),
        (in_deg_as_rad, "is the unit of wheel_angle right, and have the encoders 8500 counts per turn?"),
        (in_mnm_as_nm, "where the robot's sensors saturate"),
        (with_yaw(-1.0), "the yaw rate is opposite to that of the wheels"),
        (with_yaw(180.0 / math.pi), "times that of the wheels: is it in deg/s?"),
    ],
)
def test_wrong_signs_orders_and_units_are_named(change: Change, said: str, tmp_path: Path) -> None:
    findings = played(csv(tmp_path / "log.csv", change(columns()))).findings
    assert any(said in line for line in findings.wrong), findings.wrong
    if change in (swapped, turned, dead):
        assert "signs and order of torque fit the motion" not in findings.fine


def with_plan(values: Columns) -> Columns:
    """What the wheels do, as the plan."""
    time = values["time [s]"]
    angle = np.stack([values[f"wheel_angle_{i} [rad]"] for i in range(3)], axis=1)
    theta = angle.sum(axis=1) * R_W / (3.0 * DISTANCE)
    rate = np.gradient(angle, time, axis=0)
    twist = np.linalg.solve(jacobians(theta)[0], rate[:, :, None])[:, :, 0]
    place = np.stack([*(np.cumsum(twist[:, :2], axis=0) * (time[1] - time[0])).T, theta])
    names = ("x [m]", "y [m]", "theta [rad]", "vx [m/s]", "vy [m/s]", "omega [rad/s]")
    more = ("ax [m/s2]", "ay [m/s2]", "alpha [rad/s2]")
    plan = np.concatenate([place, twist.T, np.gradient(twist, time, axis=0).T])
    return values | {f"plan_{name}": one for name, one in zip((*names, *more), plan, strict=True)}


def far(lines: list[str]) -> tuple[str, float, str]:
    """What a line says of how far the wheels turn: which, the factor, and the rest."""
    (said,) = [line for line in lines if "as far as the plan" in line]
    which, factor, rest = re.split(r" turns? ([\d.]+) times as far as the plan", said)
    return which, float(factor), rest


@pytest.mark.parametrize(("wheels", "factor"), [((0, 1, 2), 2.0), ((0, 1, 2), 0.5), ((1,), 1.5)])
def test_wheels_that_turn_otherwise_than_planned_are_named(
    wheels: tuple[int, ...], factor: float, tmp_path: Path
) -> None:
    """Differences over 0.1 s make less of sines of 0.5 Hz: 0.5 %."""
    values = with_plan(columns())
    path = tmp_path / "log.csv"
    assert far(played(csv(path, values)).findings.fine) == ("the wheels", pytest.approx(1.0, abs=0.015), "")
    names = [f"wheel_angle_{i} [rad]" for i in wheels]
    found = played(csv(path, values | {name: factor * values[name] for name in names})).findings
    which = "the wheels" if len(wheels) == 3 else f"wheel_angle_{wheels[0]}"
    hint = ": encoder counts, wheel radius or unit?"
    assert far(found.wrong) == (which, pytest.approx(factor, rel=0.015), hint)
    held = {name: np.minimum(values[name], 0.4) for name in values if name.startswith("wheel")}
    found = played(csv(path, values | held)).findings
    assert "how far the wheels turn against the plan: they do not follow it steadily" in found.open


def test_speeds_that_the_robot_does_not_have_are_named(tmp_path: Path) -> None:
    """0.6 m/s at a rim are none of them; five times the robot's 0.5 m/s are."""
    values = columns()
    fast = {name: 5.0 * values[name] for name in values if name.startswith("wheel")}
    wrong = played(csv(tmp_path / "log.csv", values | fast)).findings.wrong
    assert any("times the robot's reference.speed_limit of 0.5 m/s: is the unit of wheel_angle" in one for one in wrong)


def test_the_yaw_rate_of_the_wheels_is_in_order(tmp_path: Path) -> None:
    found = played(csv(tmp_path / "log.csv", with_yaw(1.0)(columns()))).findings
    assert found.wrong == []
    assert any("times that of the wheels" in line for line in found.fine)


def test_other_names_units_and_signs_give_the_same(tmp_path: Path) -> None:
    values = columns()
    time, angle, torque = values["time [s]"], "wheel_angle_{} [rad]", "torque_{} [N.m]"
    other = {"t": 1e3 * time, "battery [1]": time}
    other |= {f"a{i} [deg]": np.rad2deg(values[angle.format(i)]) for i in range(3)}
    other |= {f"tau{i}": -1e3 * values[torque.format(i)] for i in range(3)}
    (tmp_path / "map.toml").write_text(
        'time = "t [ms]"\nwheel_angle = ["a0", "a1", "a2"]\ntorque = ["-tau0 [mN.m]", "-tau1 [mN.m]", "x"]\n'
    )
    wishes = read_wishes(tmp_path / "map.toml", ["torque_2=-tau2 [mN.m]"], None)
    one = played(csv(tmp_path / "one.csv", values))
    two = played(csv(tmp_path / "two.csv", other), wishes)
    assert two.did.steps == one.did.steps
    assert "torque_2 = -tau2 [mN.m]" in [column.words for column in two.chosen.columns]
    assert two.findings.fine == one.findings.fine


def test_times_in_nanoseconds_of_the_epoch(tmp_path: Path) -> None:
    """As ROS and many loggers have them; 64 bits of a float keep 0.24 us of them."""
    values = columns()
    time_ns = np.rint(1.7e18 + 1e9 * values.pop("time [s]"))
    did = played(csv(tmp_path / "log.csv", {"time [ns]": time_ns, **values})).did
    assert did.duration_s == pytest.approx(4.198, abs=1e-6)
    assert did.steps in (4198, 4199)


def test_missing_rows_repeated_rows_and_empty_cells_are_named(tmp_path: Path) -> None:
    path = csv(tmp_path / "log.csv", columns())
    lines = path.read_text().splitlines()
    cells = lines[1001].split(",")
    lines[1001] = ",".join([cells[0], "", *cells[2:4], "nan", *cells[5:]])
    lines.insert(500, lines[499])
    del lines[701:711]
    lines.insert(300, "# a comment")
    path.write_text("\n".join(lines) + "\n")
    replay = played(path)
    did = replay.did
    assert (did.repeated, did.gap_count) == (1, 1)
    assert did.gaps[0].place == "line 703"
    assert did.gaps[0].length_s == pytest.approx(0.022)
    assert did.not_finite == {"wheel_angle_0": 1, "torque_0": 1}
    assert did.missing_steps == 21 + 3
    assert replay.story.statuses.total_s[4] == pytest.approx(0.024)


def test_a_wrong_unit_of_time_is_refused_before_it_fills_the_memory(cli: Cli, tmp_path: Path) -> None:
    values = columns()
    path = csv(tmp_path / "log.csv", values | {"time [s]": 1e3 * values["time [s]"]})
    for command in (("replay", "--out", "out"), ("tune", "--false-alarms", "60/h")):
        done = cli(command[0], "log.csv", *command[1:], "--robot", ROBOT)
        assert done.returncode == 2
        said = "log.csv: time step: 2 s is not allowed; allowed: at most 0.05 s between rows; is the unit of its times"
        assert said in done.stderr
    assert played(path, way="rows").did.steps == 2100  # whatever their time


@pytest.mark.parametrize("step_s", [0.05, 0.0509])
def test_twenty_rows_a_second_are_enough(step_s: float, tmp_path: Path) -> None:
    time = step_s * np.arange(100)
    values = {name: one[::20][:100] for name, one in columns().items()} | {"time [s]": time}
    assert played(csv(tmp_path / "log.csv", values)).did.usual_s == pytest.approx(step_s)
    with pytest.raises(GivewayError, match=r"time step: 0\.0515 s is not allowed"):
        played(csv(tmp_path / "log.csv", values | {"time [s]": 0.0515 * np.arange(100)}))


def test_many_pauses_do_not_stand_in_memory_together(tmp_path: Path) -> None:
    values = {name: one[:110] for name, one in columns().items()}
    values["time [s]"] = np.concatenate([0.002 * np.arange(100), 50.0 * np.arange(1, 11)])
    path, longest = csv(tmp_path / "log.csv", values), 0
    with Replay(open_log(path, Wishes(), None, "motor_angle", "torque"), Wishes(), Choice({}, 1e-3)) as replay:
        for one in replay.all():
            longest = max(longest, len(one.steps.present))
    assert replay.did.steps == 500_001
    assert longest <= 120_000


@pytest.mark.parametrize("begin_s", [-5.0, 1e12])
def test_times_that_mcap_cannot_say_begin_at_zero(begin_s: float, cli: Cli, tmp_path: Path) -> None:
    values = {name: one[:300] for name, one in columns().items()}
    csv(tmp_path / "log.csv", values | {"time [s]": begin_s + values["time [s]"]})
    done = cli("replay", "log.csv", "--robot", ROBOT, "--out", "out")
    assert done.returncode == 0, done.stderr
    assert f"begin at {begin_s:.9g} s, which MCAP cannot say: in replay.mcap at 0 s" in done.stdout
    with (tmp_path / "out/replay.mcap").open("rb") as file:
        summary = mcap.reader.make_reader(file).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_start_time == 0
    assert summary.statistics.message_end_time == pytest.approx(590_000_000, abs=10_000_000)


@pytest.mark.parametrize("way", ["hold", "rows"])
def test_other_ways_to_steps(way: str, tmp_path: Path) -> None:
    did = played(csv(tmp_path / "log.csv", columns()), way=way).did
    assert did.steps == {"hold": 4199, "rows": 2100}[way]


def test_currents_take_a_torque_constant(tmp_path: Path) -> None:
    values = {name.replace("torque", "current").replace("N.m", "mA"): one for name, one in columns().items()}
    path = csv(tmp_path / "log.csv", {n: 1e3 * v / 2.0 if "mA" in n else v for n, v in values.items()})
    with pytest.raises(GivewayError, match="--torque-constant: nothing is not allowed"):
        played(path)
    assert played(path, torque_constant=2.0).findings.wrong == []


@pytest.mark.parametrize(
    ("line", "text", "said"),
    [
        (1, "time,a", "column 1, time, states no unit; give its unit in brackets, time [s]"),
        (1, "time [s],torque_0 [N.m]", "there is no column for wheel_angle_0"),
        (1, "time [N]" + ",x" * 6, "column 1, time: N is not allowed; allowed: s"),
        (5, "0.01,1,2", "log.csv:5: columns: 3 is not allowed; allowed: 7, as in line 1"),
        (5, "0.01,1,2,3,4,5,six", "log.csv:5: column 7, torque_2 [N.m]: six is not allowed"),
        (5, "0.001,1,2,3,4,5,6", "line 5: time goes back from 0.004 s to 0.001 s"),
        (5, ",1,2,3,4,5,6", "line 5: time is nan; needed: a time"),
        (2101, "1e3,1,2,3,4,5,6", "line 2101: 996 s since the row before; give the pieces as logs of their own"),
    ],
)
def test_what_cannot_be_used_is_refused_with_its_line(
    line: int, text: str, said: str, cli: Cli, tmp_path: Path
) -> None:
    path = csv(tmp_path / "log.csv", columns())
    lines = path.read_text().splitlines()
    lines[line - 1] = text
    path.write_text("\n".join(lines) + "\n")
    done = cli("replay", "log.csv", "--robot", ROBOT, "--out", "out")
    assert done.returncode == 2
    assert said in done.stderr
    assert done.stderr.count("\n") == 1
    assert [one.name for one in tmp_path.iterdir()] == ["log.csv"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["log.csv", "--out", "out"], "--robot: nothing is not allowed"),
        (["log.csv", "--robot", ROBOT], "--out: nothing is not allowed"),
        (["--robot", ROBOT, "--out", "out"], "LOG: nothing is not allowed"),
        (["log.csv", "--follow", "--robot", ROBOT], "--follow: log.csv is not allowed"),
        (["none.csv", "--robot", ROBOT, "--out", "out"], "none.csv: no such file"),
        (["log.bag", "--robot", ROBOT, "--out", "out"], "give the path of a log: CSV (.csv), Parquet (.parquet)"),
        (["log.csv", "--robot", ROBOT, "--out", "out", "--resample", "up"], "--resample: up is unknown"),
        (["log.csv", "--robot", ROBOT, "--out", "out", "--column", "torque_1"], "--column: torque_1 is not allowed"),
        (["log.csv", "--robot", ROBOT, "--out", "out", "--column", "tork=a"], "--column: tork is unknown"),
        (["log.csv", "--robot", ROBOT, "--out", "out", "--column", "torque_1=a"], "--column torque_1: a is unknown"),
        (["log.csv", "--robot", ROBOT, "--out", "out", "--columns", "map.toml"], "map.toml:1: torque: ['a'] is not"),
        (
            ["log.csv", "--robot", ROBOT, "--out", "out", "--set", "testbed.slider.mass=1"],
            "parameters of the controller",
        ),
        (["log.csv", "--robot", ROBOT, "--out", "out", "--encoder-bits", "7"], "--encoder-bits: 7 is not allowed"),
        (["log.csv", "--robot", ROBOT, "--out", "out", "--efforts", "current"], "--efforts: current is not allowed"),
        (["--follow", "--robot", ROBOT, "--joints", "a,b,c"], "--joints: a,b,c is not allowed; allowed: only for ROS"),
        (["log.csv", "--robot", ROBOT, "--out", "out", "--torque-constant", "2"], "only for a log of currents"),
    ],
)
def test_wrong_options_are_refused(arguments: list[str], said: str, cli: Cli, tmp_path: Path) -> None:
    csv(tmp_path / "log.csv", columns())
    (tmp_path / "map.toml").write_text('torque = ["a"]\n')
    done = cli("replay", *arguments)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert said in done.stderr
    assert not (tmp_path / "out").exists()


def test_a_report_tells_what_was_done(cli: Cli, tmp_path: Path) -> None:
    csv(tmp_path / "log.csv", swapped(columns()))
    done = cli("replay", "log.csv", "--robot", ROBOT, "--out", "out")
    assert done.returncode == 0, done.stderr
    for told in (done.stdout, (tmp_path / "out/report.html").read_text()):
        assert "torque_1 = torque_2, torque_2 = torque_1" in told
        assert "rounded to encoder counts, 8500 per turn, and the twist of the drivetrain added" in told
    manifest = json.loads((tmp_path / "out/manifest.json").read_text())
    assert len(manifest["warnings"]) == 1


def test_a_text_that_is_no_log(tmp_path: Path) -> None:
    for name in ("a.parquet", "a.mcap", "a.db3"):
        (tmp_path / name).write_text("no log\n")
        with pytest.raises(FileError, match=name):
            open_log(tmp_path / name, Wishes(), None, "motor_angle", "torque")


def test_the_example_of_columns_is_read(tmp_path: Path) -> None:
    values = columns()
    time, names = values["time [s]"], ("front", "left", "right")
    other = {"stamp": 1e3 * time}
    other |= {f"{name}.pos": np.rad2deg(values[f"wheel_angle_{i} [rad]"]) for i, name in enumerate(names)}
    signs = (1.0, -1.0, 1.0)
    other |= {f"{name}.tau": 1e3 * signs[i] * values[f"torque_{i} [N.m]"] for i, name in enumerate(names)}
    other |= {name: np.zeros(len(time)) for name in ("gyro.z", "acc.x", "acc.y")}
    example = Path(__file__).parents[2] / "examples" / "logs" / "columns.toml"
    replay = played(csv(tmp_path / "log.csv", other), read_wishes(example, [], None))
    assert "signs and order of torque fit the motion" in replay.findings.fine
    assert replay.inputs.has_imu
