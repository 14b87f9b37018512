"""`giveway tune`: the statistics of rare peaks against known ones, thresholds from logs, and every wrong input."""

from __future__ import annotations

import dataclasses
import html.parser
import math
from pathlib import Path

import giveway
import numpy as np
import pyarrow.parquet
import pytest
from cosim_helpers import Cli
from giveway import batch
from giveway.base.errors import FileError, GivewayError, InputFileError
from giveway.crowd.population import GROUPS, group_of
from giveway.identification.torque_model import TorqueModel
from giveway.replay.inputs import Steps
from giveway.replay.run_log import write_log
from giveway.replay.wheel_plan import WheelPlan
from giveway.robot.robot_file import read_robot
from giveway.robot.variables import table
from giveway.tuning.identified import identify
from giveway.tuning.judged import hits_of, judge, logs_of, rows
from giveway.tuning.logs import Log, Push, read_log, read_pushes, without_refused
from giveway.tuning.peaks import EXTRAPOLATION, Peaks, Tail, hours_to_count, joined, peaks_of
from giveway.tuning.thresholds import NAMES, RIPPLE, RIPPLES, alarms_in, choose, settings_of
from giveway.tuning.told import remarks
from giveway.tuning.tuned import check_hours, noticed
from scipy.ndimage import gaussian_filter1d

ROOT = Path(__file__).parents[2]
TRIKEY = ROOT / "robots" / "trikey.toml"

# Two arcs with a rest before each: enough for friction, noise and a rate of some alarms per hour.
ARCS = """
schema_version = 1
name = "arcs"
duration = 65.0
seed = 3
[plan]
kind = "arcs"
wheels = [[1, 0, 0], [1, 1, 0]]
swings = 3
rest = 2.5
[controller]
detector.kind = 1
detector.impulse_threshold = 1000.0
"""


@pytest.fixture(scope="module")
def arcs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The log of a run."""
    folder = tmp_path_factory.mktemp("tuning")
    (folder / "arcs.toml").write_text(ARCS, encoding="utf-8")
    path = folder / "arcs.parquet"
    write_log(path, batch.run(giveway.read_scenario(folder / "arcs.toml")))
    return path


@pytest.fixture(scope="module")
def logs() -> list[Log]:
    """Two minutes of a robot of the crowd."""
    return logs_of("tuning", 0, 2.0, 0, 1)


def parameters() -> dict[str, float | int | bool]:
    return table("controller").robot_values(read_robot(TRIKEY))


def exponential(rng: np.random.Generator, hours: float, bunch: int = 1) -> Peaks:
    """300 peaks per hour, or bunches of them, with heights 0.5 plus an exponential of mean 0.1."""
    count = rng.poisson(300.0 * hours / bunch) * bunch
    times = np.repeat(np.sort(rng.uniform(0.0, 3600.0 * hours, count // bunch)), bunch)
    heights = 0.5 + np.repeat(rng.exponential(0.1, count // bunch), bunch) + rng.uniform(0.0, 1e-3, count)
    return Peaks(times, heights, np.zeros(count, dtype=np.bool_), 3600.0 * hours)


def test_peaks_lie_apart_and_count_only_where_they_may() -> None:
    time = np.arange(0.0, 20.0, 0.001)
    series = 0.1 + 0.9 * np.exp(-(((time - 5.3) / 0.05) ** 2)) + 0.7 * np.exp(-(((time - 5.6) / 0.05) ** 2))
    series += 0.6 * np.exp(-(((time - 12.5) / 0.05) ** 2)) + 5.0 * np.exp(-(((time - 17.5) / 0.05) ** 2))
    counts = time < 16.0
    alarms = np.zeros_like(counts)
    alarms[12500] = True
    found = peaks_of(series, counts, alarms, 0.001)
    high = found.heights > 0.5
    assert found.heights[high] == pytest.approx([1.0, 0.7], abs=1e-3)  # the second one of 5 s belongs to the first
    assert found.alarmed[high].tolist() == [False, True]
    assert found.duration_s == pytest.approx(16.0)
    both = joined([found, found])
    assert both.duration_s == pytest.approx(32.0)
    assert both.above(0.5) == 4


def test_the_rate_of_known_peaks_lies_in_its_interval() -> None:
    """300/h exp(-(u - 0.5)/0.1) above u; 40 logs: 95 % miss more than 5 of them once in 70 times."""
    rng = np.random.default_rng(7)
    truth = 300.0 * math.exp(-(1.0 - 0.5) / 0.1)
    tails = [Tail(exponential(rng, 0.5)) for _ in range(40)]
    held = sum(tail.rate(1.0)[1] <= truth <= tail.rate(1.0)[2] for tail in tails)
    assert held >= 35
    assert sum(tail.upper(1.0) >= truth for tail in tails) >= 35
    width = np.median([tail.rate(1.0)[2] / tail.rate(1.0)[0] for tail in tails])
    assert width < 8.0  # not so wide that it says nothing


def test_peaks_that_an_alarm_cut_off_count_as_higher() -> None:
    rng = np.random.default_rng(3)
    whole = exponential(rng, 2.0)
    cut = dataclasses.replace(whole, heights=np.minimum(whole.heights, 0.8), alarmed=whole.heights > 0.8)
    truth = 300.0 * math.exp(-(1.0 - 0.5) / 0.1)
    low, high = Tail(cut).rate(1.0)[1:]
    assert low < truth < high
    forgotten = Tail(dataclasses.replace(cut, alarmed=np.zeros_like(cut.alarmed)))
    assert forgotten.rate(1.0)[0] < 0.5 * Tail(cut).rate(1.0)[0]


def test_bunches_make_it_less_sure() -> None:
    rng = np.random.default_rng(5)
    alone, bunched = Tail(exponential(rng, 1.0)), Tail(exponential(rng, 1.0, bunch=6))
    assert alone.bunching < 2.0
    assert bunched.bunching > 3.0
    spread = [tail.rate(1.0)[2] / max(tail.rate(1.0)[1], 1e-9) for tail in (alone, bunched)]
    assert spread[1] > spread[0]


def test_a_level_keeps_to_its_rate_and_no_more_is_promised_than_the_hours_allow() -> None:
    tail = Tail(exponential(np.random.default_rng(1), 1.0))
    for rate in (20.0, 2.0, 0.5):
        assert tail.upper(tail.level(rate)) == pytest.approx(rate, rel=0.02)
    assert tail.upper(50.0) == pytest.approx(1.0 / EXTRAPOLATION)
    low, high = tail.counts(tail.base, 1.0)
    assert low < tail.peaks.above(tail.base) < high


def test_a_rate_that_the_hours_do_not_support_is_refused() -> None:
    assert hours_to_count(0.1) == pytest.approx(30.0, rel=0.01)  # the rule of three
    check_hours(1.0, 0.1)
    with pytest.raises(GivewayError) as caught:
        check_hours(0.5, 0.1)
    said = str(caught.value)
    assert "--false-alarms: 0.1/h is not allowed; allowed: at least 0.2/h with 0.5 h" in said
    assert "takes 1 h of logs, and 30 h" in said


def test_thresholds_of_a_robot_keep_to_the_rate_on_its_logs(logs: list[Log]) -> None:
    chosen = choose(logs, {}, 200.0)
    assert set(chosen.thresholds) == set(NAMES)
    assert chosen.upper_per_hour <= 200.0
    alarms, hours = alarms_in(logs, dict(chosen.thresholds))
    assert alarms <= 200.0 * hours + 3.0 * math.sqrt(200.0 * hours)
    before = settings_of({})
    assert any(chosen.thresholds[name] < before[name] for name in NAMES)  # a whole crowd's are higher than one robot's
    quieter = choose(logs, {}, 4.0 / EXTRAPOLATION / chosen.tail.peaks.hours)
    assert quieter.alarms <= chosen.alarms


def uneven(log: Log) -> Log:
    """``log`` with rollers that have all of their friction each: a wheel's is twice as large for a fifth of the way
    from one roller to the next."""
    robot = read_robot(TRIKEY)
    model, rollers = TorqueModel.of(robot), float(robot.value("roller.rows")) * float(robot.value("roller.per_row"))
    pitch = 2.0 * np.pi / rollers
    rate = np.gradient(gaussian_filter1d(log.angle_rad, 20, axis=0), log.step_s, axis=0)
    roller_rate, _ = model.motion(rate, np.zeros_like(rate))
    friction_nm, slope_s_rad = (float(robot.value(f"roller.{name}")) for name in ("coulomb_torque", "tanh_slope"))
    more = (log.angle_rad % pitch < 0.2 * pitch) * friction_nm * np.tanh(slope_s_rad * roller_rate)
    torque = {f"sensor.torque[{wheel}]": one for wheel, one in enumerate((more @ model.friction_gain.T).T)}
    return dataclasses.replace(
        log, inputs={**log.inputs, **{name: log.inputs[name] + one for name, one in torque.items()}}
    )


def test_ripple_is_expected_where_the_logs_have_it(logs: list[Log]) -> None:
    assert choose(logs, {}, 200.0).thresholds[RIPPLE] == 0.0
    assert choose([uneven(log) for log in logs], {}, 200.0).thresholds[RIPPLE] == RIPPLES[-1]


def test_hits_are_those_of_the_crowd_with_the_tuned_thresholds() -> None:
    first = next(number for number in range(10) if group_of(number) == GROUPS[0])
    told: list[int] = []
    (one,) = judge("tuning", 1, 1.0, 300.0, 2, told.append)
    assert (one.number, told, one.refused) == (first, [1], "")
    assert one.hits_before == hits_of("tuning", first, {}, 1)
    deaf = {name: 1000.0 for name in settings_of({}) if name.startswith(("channels.fast", "channels.slow"))}
    shown = dict(rows([dataclasses.replace(one, hits=hits_of("tuning", first, deaf, 1))], 300.0))
    missed, _, hits = shown["hits missed, tuned"].partition(" of ")
    assert missed == hits != "0"  # these very thresholds are used


@pytest.mark.parametrize("minutes", [0.5, 61.0, math.nan])
def test_logs_of_the_judged_are_neither_too_short_nor_too_long(minutes: float) -> None:
    with pytest.raises(GivewayError, match="--minutes"):
        judge("tuning", 1, minutes, 300.0, 1)


@pytest.mark.parametrize("rate_per_hour", [0.0, -1.0, 1001.0, math.nan])
def test_nobody_wishes_for_such_a_rate(rate_per_hour: float) -> None:
    with pytest.raises(GivewayError, match="--false-alarms"):
        judge("tuning", 1, 6.0, rate_per_hour, 1)


def without_plan(log: Log, rows: slice = slice(None)) -> Steps:
    own = {name: values[rows] for name, values in log.inputs.items() if not name.startswith("plan.")}
    arrays = (log.angle_rad[rows], log.torque_nm[rows], own["sensor.present"])
    return Steps(rows.start or 0, own, *arrays, None)


def with_plan(log: Log) -> Log:
    made = WheelPlan({}, log.step_s).add(without_plan(log), last=True)
    assert made is not None
    return dataclasses.replace(log, inputs=made.inputs, planned=False)


def test_a_log_without_a_plan_gets_that_of_its_wheels(logs: list[Log]) -> None:
    log = logs[0]
    made = with_plan(log)
    rows = slice(200, None)
    made_mps, planned_mps = (np.hypot(one.inputs["plan.vx"], one.inputs["plan.vy"])[rows] for one in (made, log))
    # The robot differs from its file, and lags its plan; it goes 0.4 m/s at most.
    assert np.abs(made_mps - planned_mps).max() < 0.08
    assert alarms_in([made], {})[0] == 0
    # Its commands are not those that the motors got: they are not observed.
    names = ("estimate.force_x", "estimate.force_y")
    as_own, found = dataclasses.replace(made, planned=True), made.replayed({}, names)
    off, on = as_own.replayed({"motor.inertia": 0.0}, names), as_own.replayed({}, names)
    assert all(np.array_equal(found[name], off[name]) for name in names)
    assert not any(np.array_equal(found[name], on[name]) for name in names)


def test_the_plan_of_the_wheels_is_the_same_in_parts(logs: list[Log]) -> None:
    plan, parts, at = WheelPlan({}, logs[0].step_s), [], 0
    for size in (1, 40, 700, 3, 5000, 1, 2, 9000, 12000):
        parts.append(plan.add(without_plan(logs[0], slice(at, at + size)), last=False))
        at += size
    parts.append(plan.add(None, last=True))
    known = [part for part in parts if part is not None]
    assert [part.first for part in known] == np.cumsum([0, *(len(part.present) for part in known[:-1])]).tolist()
    whole = with_plan(logs[0]).inputs
    for name in whole:
        found = np.concatenate([part.inputs[name] for part in known])
        # the last rows do not know what is ahead of them in the whole log
        assert np.array_equal(found[: at - 400], whole[name][: at - 400]), name


def test_jumps_and_missing_samples_are_no_motion(logs: list[Log]) -> None:
    log, begin, end = logs[0], 8000, 8400
    present = log.inputs["sensor.present"].copy()
    present[begin:end] = False
    angle, encoder = log.angle_rad.copy(), log.inputs["sensor.encoder[1]"].copy()
    angle[begin:end], encoder[begin:end] = 0.0, 0
    angle[12000:, 1] += 1e3
    inputs = {**log.inputs, "sensor.present": present, "sensor.encoder[1]": encoder}
    found = with_plan(dataclasses.replace(log, inputs=inputs, angle_rad=angle)).inputs
    wanted = with_plan(log).inputs
    for name in ("plan.vx", "plan.vy"):  # 0.1 m/s: what the robot may do otherwise in 0.4 s without a sample
        assert np.abs(found[name] - wanted[name]).max() < 0.1


def test_a_replay_of_the_logs_has_the_alarms_of_the_tuning(cli: Cli, arcs: Path, tmp_path: Path) -> None:
    """Both see the same, with the plan that both make of the wheels' motion."""
    table_of = pyarrow.parquet.read_table(arcs)
    own = [name for name in table_of.column_names if not name.startswith("plan_")]
    pyarrow.parquet.write_table(table_of.select(own).replace_schema_metadata(), tmp_path / "log.parquet")
    log = read_log(tmp_path / "log.parquet", read_robot(TRIKEY), parameters())
    alarms, hours = alarms_in([log], parameters())
    assert hours > 0.0
    done = cli("replay", "log.parquet", "--robot", str(TRIKEY), "--out", "out")
    assert done.returncode == 0, done.stderr
    assert "taken to be the motion of its wheels" in done.stdout
    assert f"\n{alarms} detections\n" in done.stdout
    assert "means nothing" not in done.stdout
    done = cli("replay", "log.parquet", "--robot", str(TRIKEY), "--out", "out", "--observe")
    assert "the drives are off (--observe): what is noticed while the wheels turn means nothing" in done.stdout


def test_what_logs_say_of_a_robot(arcs: Path) -> None:
    robot = read_robot(TRIKEY)
    log = read_log(arcs, robot, parameters())
    assert log.as_logged
    assert log.said == ()
    found = identify([log], robot)
    assert found.friction is not None, found.why
    assert found.friction.coulomb_torque_nm.value == pytest.approx(0.2, rel=0.05)
    assert found.noise_nm == pytest.approx(float(robot.value("drivetrain.torque_noise")), rel=0.1)


def test_a_robot_file_from_a_log(process: Cli, arcs: Path, tmp_path: Path) -> None:
    out, report = tmp_path / "new.toml", tmp_path / "tuned.html"
    answer = process(
        "tune", str(arcs), "--robot", str(TRIKEY), "--false-alarms", "30/h", "--no-smallest",
        "--out", str(out), "--report", str(report),
    )  # fmt: skip
    assert answer.returncode == 0, answer.stderr
    for words in ("channels.fast_rest", "upper 95 % bound", "EXTRAPOLATED", "roller friction B_r"):
        assert words in answer.stdout
    robot = read_robot(out)
    values = table("controller").robot_values(robot)
    assert values["channels.fast_rest"] != 3.0
    text = out.read_text(encoding="utf-8")
    assert "arcs.parquet (sha256 " in text
    assert "for 30 false alarms per hour; upper 95 % bound" in text
    old = TRIKEY.read_text(encoding="utf-8")
    assert all(line in text for line in old.splitlines() if line.startswith("#"))
    page = report.read_text(encoding="utf-8")
    html.parser.HTMLParser().feed(page)
    assert "EXTRAPOLATED" in page


def test_short_logs_that_raise_thresholds_say_so(arcs: Path) -> None:
    tuned = giveway.tune([arcs], TRIKEY, 30.0, smallest=False)
    now = {name: float(value) for name, value in tuned.chosen.thresholds.items()}

    def said(factor: float) -> list[str]:
        before = {name: factor * value for name, value in now.items()}
        return [one for one in remarks(dataclasses.replace(tuned, before=before)) if one.startswith("HIGHER")]

    assert tuned.extrapolated
    assert said(1.0) == []
    (told,) = said(0.9)
    assert all(name in told for name in NAMES if now[name] > 0.0)


WRONG: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "rate": (("--false-alarms", "rare"), ("--false-alarms: rare", "0.1/h")),
    "rate per day": (("--false-alarms", "1/d"), ("--false-alarms: 1/d", "0.1/h")),
    "no rate": (("--false-alarms", "0/h"), ("--false-alarms: 0.0", "1/h")),
    "too few hours": (("--false-alarms", "0.1/h"), ("--false-alarms: 0.1/h", "at least", "h of logs")),
    "over the old file": (("--false-alarms", "30/h", "--out", str(TRIKEY)), ("--out", "another file")),
    "no robot file": (("--false-alarms", "30/h", "--out", "new.txt"), ("--out: new.txt", ".toml")),
    "no page": (("--false-alarms", "30/h", "--report", "page.pdf"), ("--report: page.pdf", ".html")),
    "no pushes": (("--false-alarms", "30/h", "--pushes", "none.csv"), ("none.csv", "no such file")),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_input_writes_nothing(name: str, cli: Cli, arcs: Path, tmp_path: Path) -> None:
    arguments, words = WRONG[name]
    extra = () if "--out" in arguments else ("--out", "new.toml")
    answer = cli("tune", str(arcs), "--robot", str(TRIKEY), *arguments, *extra, "--no-smallest")
    assert answer.returncode == 2
    for word in words:
        assert word in answer.stderr, answer.stderr
    assert not list(tmp_path.glob("new.*"))


def test_the_same_log_twice_is_refused(cli: Cli, arcs: Path, tmp_path: Path) -> None:
    copy = tmp_path / "copy.parquet"
    copy.write_bytes(arcs.read_bytes())
    for second, words in ((arcs, "each log once"), (copy, "the same content as arcs.parquet")):
        answer = cli("tune", str(arcs), str(second), "--robot", str(TRIKEY), "--false-alarms", "30/h")
        assert answer.returncode == 2
        assert words in answer.stderr


def test_marked_pushes(tmp_path: Path) -> None:
    path = tmp_path / "pushes.csv"
    path.write_text("# by hand\nstart [s],end [s]\n2,2.5\n4,4.5\n", encoding="utf-8")
    assert read_pushes(path, {"a.csv": 4.5}) == {"a.csv": (Push(2.0, 2.5), Push(4.0, 4.5))}
    for text, line, words in (
        ("start [s],end [s]\n2,1\n", 2, ("end [s]: 1.0", "above the start")),
        ("start [s],end [s]\n2,x\n", 2, ("end [s]: x",)),
        ("start [s],end [s]\n-2,1\n", 2, ("start [s]: -2.0",)),
        ("start [s],end [s]\n2,3\n9,11\n", 3, ("end [s]: 11.0", "0 to 10 s: since the first row of a.csv")),
        ("start [s],end [s]\n1.7e9,1700000001\n", 2, ("start [s]: 1700000000.0", "0 to 10 s: since the first row")),
        ("start [s],end [s]\n2,3\n2\n", 3, ("columns",)),
    ):
        path.write_text(text, encoding="utf-8")
        with pytest.raises(InputFileError) as caught:
            read_pushes(path, {"a.csv": 10.0})
        assert f"pushes.csv:{line}:" in str(caught.value)
        assert all(word in str(caught.value) for word in words)
    path.write_text("start [s],end [s]\n2,3\n", encoding="utf-8")
    with pytest.raises(FileError, match="there is no column log"):
        read_pushes(path, {"a.csv": 10.0, "b.csv": 10.0})
    path.write_text("log,start [s],end [s]\nc.csv,2,3\n", encoding="utf-8")
    with pytest.raises(InputFileError, match=r"log: c\.csv"):
        read_pushes(path, {"a.csv": 10.0, "b.csv": 10.0})


def test_a_marked_push_is_noticed_and_is_no_false_alarm(logs: list[Log]) -> None:
    """A torque on all wheels as of a turn, while the robot stands before its first leg or drives."""
    begin, end = 8000, 8400
    torque = {name: values.copy() for name, values in logs[1].inputs.items() if name.startswith("sensor.torque")}
    for values in torque.values():
        values[begin:end] += 2.0
    unmarked = dataclasses.replace(logs[1], inputs={**logs[1].inputs, **torque})
    marked = dataclasses.replace(unmarked, pushes=(Push(8.0, 8.4), Push(20.0, 20.2)))
    first, second = (noticed(marked, push, {}) for push in marked.pushes)
    assert first.delay_s is not None
    assert 0.0 <= first.delay_s < 0.1
    assert second.delay_s is None
    assert alarms_in([unmarked], {})[0] == 1
    assert alarms_in([marked], {})[0] == 0


def test_what_pushes_does_not_count(logs: list[Log]) -> None:
    marked = dataclasses.replace(logs[0], pushes=(Push(5.0, 6.0),))
    free = marked.free()
    assert not free[5000]
    assert not free[7900]
    assert free[4700]
    assert free[8100]


def test_samples_that_the_controller_refuses_raise_no_threshold(arcs: Path, tmp_path: Path) -> None:
    """One torque beyond the sensor and 100 that are no numbers, in motion: nothing is learnt from them."""
    table_of = pyarrow.parquet.read_table(arcs)
    torque = table_of["torque_1"].to_numpy().copy()
    torque[20000], torque[40000:40100] = 1000.0, np.nan
    at = table_of.column_names.index("torque_1")
    damaged = table_of.set_column(at, table_of.schema.field("torque_1"), pyarrow.array(torque))
    pyarrow.parquet.write_table(damaged, tmp_path / "damaged.parquet")
    sound, log = (read_log(path, read_robot(TRIKEY), parameters()) for path in (arcs, tmp_path / "damaged.parquet"))
    (said,) = log.said
    assert said.startswith("damaged.parquet: the controller refuses 101 samples (not finite 100, torque saturated 1)")
    assert said.endswith("were left out: 4.1 of 65 s")
    free = log.free()
    assert free[19999]
    assert not free[20000:22000].any()
    assert free[22001]
    assert set(log.replayed(parameters(), ("status",))["status"].tolist()) == {0}
    wanted, found = (choose([one], parameters(), 60.0).thresholds for one in (sound, log))
    assert found == pytest.approx(wanted, rel=0.05)  # 6 % of the time less
    friction = identify([log], read_robot(TRIKEY)).friction
    assert friction is not None
    assert friction.coulomb_torque_nm.value == pytest.approx(0.2, rel=0.05)


def test_a_log_without_samples_in_motion_is_refused(logs: list[Log]) -> None:
    status = np.zeros(logs[0].steps, dtype=np.int32)
    moving = int(np.flatnonzero(logs[0].moving())[0]) + 1000
    status[moving : moving + 150] = 4
    assert without_refused(logs[0], status).refused is not None
    status[moving : moving + 300] = 4
    with pytest.raises(GivewayError, match=r"no good sample from .* s, and the wheels turn is not allowed"):
        without_refused(logs[0], status)


def changed(arcs: Path, path: Path, wheel: int, rows: slice, factor: float, more_nm: float) -> Path:
    """The log with another torque of a wheel."""
    table_of = pyarrow.parquet.read_table(arcs)
    torque = table_of[f"torque_{wheel}"].to_numpy().copy()
    torque[rows] = factor * torque[rows] + more_nm
    at = table_of.column_names.index(f"torque_{wheel}")
    column = table_of.schema.field(at)
    pyarrow.parquet.write_table(table_of.set_column(at, column, pyarrow.array(torque)), path)
    return path


def test_a_dead_sensor_is_refused(cli: Cli, arcs: Path, tmp_path: Path) -> None:
    changed(arcs, tmp_path / "dead.parquet", 2, slice(None), 0.0, 0.3)
    answer = cli("tune", "dead.parquet", "--robot", str(TRIKEY), "--false-alarms", "60/h", "--out", "new.toml")
    assert answer.returncode == 2
    assert "dead.parquet: torque_2 never changes: all three sensors are needed" in answer.stderr
    assert not (tmp_path / "new.toml").exists()


def test_a_touch_is_told_with_the_result_and_in_the_file(cli: Cli, arcs: Path, tmp_path: Path) -> None:
    """2 N m more at one wheel for half a second, while it drives."""
    changed(arcs, tmp_path / "touched.parquet", 0, slice(12000, 12500), 1.0, 2.0)
    answer = cli(
        "tune",
        "touched.parquet",
        "--robot",
        str(TRIKEY),
        "--false-alarms",
        "60/h",
        "--no-smallest",
        "--out",
        "new.toml",
    )
    assert answer.returncode == 0, answer.stderr
    touched = " ".join(answer.stdout.split())
    assert "TOUCHED? touched.parquet" in touched
    assert "something touched the robot" in touched
    assert "TOUCHED? touched.parquet" in (tmp_path / "new.toml").read_text(encoding="utf-8")


def test_logs_without_free_motion_say_why(cli: Cli, arcs: Path, tmp_path: Path) -> None:
    changed(arcs, tmp_path / "nan.parquet", 0, slice(None), 1.0, math.nan)
    answer = cli("tune", "nan.parquet", "--robot", str(TRIKEY), "--false-alarms", "60/h")
    assert answer.returncode == 2
    assert "logs: no free motion; nan.parquet: the controller refuses 65001 samples (not finite 65001)" in answer.stderr
    (tmp_path / "pushes.csv").write_text("start [s],end [s]\n0,65\n", encoding="utf-8")
    answer = cli("tune", str(arcs), "--robot", str(TRIKEY), "--false-alarms", "60/h", "--pushes", "pushes.csv")
    assert answer.returncode == 2
    assert "logs: no free motion is not allowed; allowed: some minutes in which nothing pushes" in answer.stderr
