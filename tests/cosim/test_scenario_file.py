"""Scenario files: every example runs; every wrong file is refused in one line with file, line and key."""

from __future__ import annotations

import html
import math
from pathlib import Path

import giveway
import numpy as np
import pytest
from cosim_helpers import Cli, folder_content
from giveway import batch
from giveway.base.errors import InputFileError
from giveway.base.toml_lines import flatten, line_of
from giveway.scenario.arcs import EVERY_WHEEL, Arcs, wheels_of
from giveway.scenario.plan import Circle, Pushes, Straight
from giveway.scenario.scenario_file import read_scenario

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.toml"))

GOOD = """\
schema_version = 1
name = "a case"
duration = 2.0
bumper = "spring"

[collision]
mass = 12.0
speed = 0.4
edge = 0
offset = 0.05
time = 0.6

[testbed]
slider.friction = 2.0
electronics.torque_offset = [
    0.1,
    0.0,
    -0.1,
]
"""


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_every_example_runs_and_is_noticed(path: Path) -> None:
    scenario = giveway.read_scenario(path)
    result = batch.run(scenario)
    if isinstance(scenario.plan, Arcs):
        assert float(np.abs(result.traces["testbed.truth.theta"]).max()) > 0.3
        return
    if scenario.push is not None:
        found = [{metric.name: metric.value for metric in push} for push in result.pushes]
        assert [push["detections"] for push in found] == [1.0] * len(scenario.push.pushes)  # type: ignore[attr-defined]
        return
    assert result.metric("detection time").value is not None
    asked = {"trolley": 0.4, "weight_and_rope": 0.5, "into_a_leg": 0.22}.get(path.stem)
    # 1 % is the last millisecond before contact, at the rope's 3 m/s2.
    assert asked is None or result.metric("contact speed").value == pytest.approx(asked, rel=0.01)


def test_there_are_examples() -> None:
    assert len(EXAMPLES) >= 4


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "case.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_file_becomes_a_scenario(tmp_path: Path) -> None:
    scenario = read_scenario(written(tmp_path, GOOD))
    assert (scenario.name, scenario.duration_s, scenario.bumper, scenario.seed) == ("a case", 2.0, "spring", None)
    found = scenario.parameters("testbed")
    assert found["slider.mass"] == 12.0
    assert found["slider.friction"] == 2.0
    assert found["electronics.torque_offset[2]"] == -0.1
    assert found["rope.attached"] is False
    assert found["slider.speed"] == pytest.approx(0.4 + 2.0 / 12.0 * 0.6, rel=1e-12)  # v + F t/m
    assert found["slider.direction"] == pytest.approx(math.radians(-120.0), abs=1e-6)  # corners to micrometres


@pytest.mark.parametrize("tare_ticks", [0, 50, 400])
def test_a_moving_robot_is_met_in_time_however_long_the_tare_holds_it(tare_ticks: int, tmp_path: Path) -> None:
    text = f"""
schema_version = 1
duration = 1.7
[plan]
kind = "straight"
speed = 0.2
direction = 60
[collision]
speed = 0.0
edge = 0
time = 1.6
[controller]
estimator.tare_ticks = {tare_ticks}
"""
    traces = batch.run(read_scenario(written(tmp_path, text))).traces
    # The robot lags its plan by up to 5 mm (see test_approach.py); 50 ms of tare are 10 mm.
    late_s = float(traces["testbed.truth.first_contact_time"][-1]) - 1.6
    assert 0.0 < late_s < 5e-3 / 0.2


def test_a_height_lets_the_base_tip(tmp_path: Path) -> None:
    assert "base.tipping" not in read_scenario(written(tmp_path, GOOD)).testbed
    found = read_scenario(written(tmp_path, GOOD.replace("mass = 12.0", "mass = 12.0\nheight = 0.45"))).testbed
    assert found["base.tipping"] is True
    assert found["contact.height"] == 0.45


STATED = """\
schema_version = 1
duration = 0.4
bumper = "spring"
judge_as = "lower leg"

[testbed]
slider = { present = true, speed = 0.5, run_up = 0.05, mass = 7.0 }
rope.attached = false
electronics.seed = 7
"start.theta" = 0.1
"""


def test_what_collides_may_be_stated_by_its_parameters(tmp_path: Path) -> None:
    scenario = read_scenario(written(tmp_path, STATED))
    found = scenario.parameters("testbed")
    stated = {"slider.present": True, "slider.speed": 0.5, "slider.run_up": 0.05, "slider.mass": 7.0}
    stated |= {"rope.attached": False, "electronics.seed": 7, "start.theta": 0.1, "bumper.kind": 1}
    assert {name: found[name] for name in stated} == stated
    assert batch.run(scenario).metric("peak force of the run").value > 10.0  # type: ignore[operator]


@pytest.mark.parametrize(
    ("line", "instead", "field"),
    [
        ("[testbed]", "seed = 3\n[testbed]", "testbed.electronics.seed"),
        ("[testbed]", '[plan]\nkind = "rest"\n[testbed]', "testbed.start.theta"),
        ("present = true", "present = false", "bumper"),
        ("rope.attached = false", "bumper.kind = 2", "testbed.bumper.kind"),
    ],
)
def test_what_is_stated_has_one_place(tmp_path: Path, line: str, instead: str, field: str) -> None:
    with pytest.raises(InputFileError, match=field):
        read_scenario(written(tmp_path, STATED.replace(line, instead)))


def test_without_a_collision_there_is_no_slider(tmp_path: Path) -> None:
    scenario = read_scenario(written(tmp_path, "schema_version = 1\nduration = 1"))
    assert scenario.name == "case"
    assert scenario.bumper == "none"
    assert scenario.parameters("testbed")["slider.present"] is False


def test_plans_and_pushes(tmp_path: Path) -> None:
    head = "schema_version = 1\nduration = 9.0\n"
    line = read_scenario(written(tmp_path, head + '[plan]\nkind = "straight"\nspeed = 0.2\ndirection = 90\ny = -1\n'))
    assert line.plan == Straight(0.2, math.pi / 2, 0.0, -1.0, 0.0, 0.2)
    assert line.testbed["start.y"] == -1.0
    text = """
[plan]
kind = "circle"
diameter = 2
speed = -0.3
centre = [1, 2]
start = 180
heading = 45
turning = true
acceleration = 0.5
[[push]]
force = 30
direction = 180
point = [0.3, 0]
start = 2
duration = 0.5
ramp = 0.1
"""
    round_ = read_scenario(written(tmp_path, head + text))
    assert round_.plan == Circle(2.0, -0.3, 1.0, 2.0, math.pi, "turning", math.pi / 4, 0.5)
    steady = read_scenario(written(tmp_path, head + text.replace("turning = true\n", "")))
    assert steady.plan == Circle(2.0, -0.3, 1.0, 2.0, math.pi, "fixed", math.pi / 4, 0.5)
    assert isinstance(round_.push, Pushes)
    arcs = read_scenario(
        written(tmp_path, head + '[plan]\nkind = "arcs"\nwheels = [[1, 0, 0], [1, 1, 0]]\nswing = 90\n')
    )
    assert arcs.plan == Arcs(((1.0, 0.0, 0.0), (1.0, 1.0, 0.0)), math.pi / 2, 0.1, 2, 1.0, 0.1016, 0.24)
    light = read_scenario(written(tmp_path, head + 'robot = "lekiwi"\n[plan]\nkind = "arcs"\nfrequency = 0.05\n'))
    assert light.plan == Arcs(EVERY_WHEEL, 1.5, 0.05, 2, 1.0, *wheels_of(light.robot))
    np.testing.assert_allclose(round_.push(np.array([2.2]))[0], [-30.0, 0.0, 0.3, 0.0], atol=1e-12)


def test_robot_files_are_found_beside_the_scenario(tmp_path: Path) -> None:
    robot = (Path(__file__).parents[2] / "robots" / "trikey.toml").read_text(encoding="utf-8")
    (tmp_path / "mine.toml").write_text(robot.replace("value = 34.7", "value = 41.0"), encoding="utf-8")
    scenario = read_scenario(written(tmp_path, 'robot = "mine.toml"\n' + GOOD))
    assert scenario.parameters("testbed")["base.mass"] == 41.0


PUSH = "[[push]]\npoint=[0,0]\nforce=1\ndirection=0\nstart={}\nduration=1\n"
# What replaces what in GOOD; the line; words of the message.
WRONG: dict[str, tuple[str, str, int, tuple[str, ...]]] = {
    "syntax": ("mass = 12.0", "mass = = 12.0", 7, ("Invalid value",)),
    "end": ("\n]\n", "\n", 18, ("not TOML",)),
    "twice": ("speed = 0.4", "mass = 1.0", 8, ("overwrite",)),
    "height": ("mass = 12.0", "height = -0.1", 7, ("collision.height: -0.1", "0")),
    "tips twice": ("slider.friction = 2.0", "base.tipping = true", 14, ("testbed.base.tipping", "collision.height")),
    "no version": ("schema_version = 1\n", "", 1, ("schema_version: nothing", "needed")),
    "other version": ("schema_version = 1", "schema_version = 2", 1, ("schema_version: 2", "allowed: 1")),
    "no duration": ("duration = 2.0\n", "", 1, ("duration: nothing",)),
    "negative duration": ("duration = 2.0", "duration = -2.0", 3, ("duration: -2.0", "0 to 3600 s")),
    "infinite duration": ("duration = 2.0", "duration = inf", 3, ("duration: inf", "finite")),
    "unknown key": ("mass = 12.0", "weight = 1", 7, ("collision.weight", "unknown")),
    "misspelt key": ("speed = 0.4", "sped = 0.4", 8, ("collision.sped", "did you mean speed")),
    "misspelt table": ("[collision]", "[colision]", 6, ("colision", "did you mean collision")),
    "unknown bumper": ('"spring"', '"sprnig"', 4, ("bumper: sprnig", "did you mean spring")),
    "text for a number": ("speed = 0.4", 'speed = "fast"', 8, ("collision.speed: fast", "number")),
    "number for a text": ('name = "a case"', "name = 3", 2, ("name: 3", "text")),
    "truth for a number": ("speed = 0.4", "speed = true", 8, ("collision.speed: True", "number")),
    "negative speed": ("speed = 0.4", "speed = -1", 8, ("collision.speed: -1.0", "0 to 20 m/s")),
    "no speed": ("speed = 0.4\n", "", 6, ("collision.speed: nothing",)),
    "mass out of range": ("mass = 12.0", "mass = 1e6", 7, ("collision.mass: 1000000.0", "0.1 to 1000 kg")),
    "edge out of range": ("edge = 0", "edge = 3", 9, ("collision.edge: 3", "0 to 2")),
    "offset too long": ("offset = 0.05", "offset = 0.5", 10, ("collision.offset: 0.5", "0.305 m")),
    "edge and point": ("edge = 0", "edge = 0\npoint = [0, 0]", 9, ("collision.edge", "one place")),
    "offset without edge": ("edge = 0", "point = [0.088046, 0.1525]", 10, ("collision.offset", "only with edge")),
    "point beside the robot": ("edge = 0\noffset = 0.05", "point = [0.2, 0.2]", 9, ("collision.point", "nearest is")),
    "point of one number": ("edge = 0\noffset = 0.05", "point = [0.2]", 9, ("collision.point", "[x, y]")),
    "away from the robot": ("time = 0.6", "time = 0.6\ndirection = 60", 12, ("collision.direction", "approach")),
    "direction too large": ("time = 0.6", "time = 0.6\ndirection = 999", 12, ("collision.direction: 999", "360 deg")),
    "rope and time": ("time = 0.6", "time = 0.6\nrope = true", 11, ("collision.time", "rope")),
    "rope too slow": ("speed = 0.4\nedge = 0\noffset = 0.05\ntime = 0.6", "speed = 9\nrope = true\nedge = 0", 8,
                      ("collision.speed: 9.0", "at most")),
    "set twice": ("slider.friction = 2.0", "slider.mass = 2.0", 14, ("testbed.slider.mass", "collision.mass")),
    "bumper set twice": ("slider.friction = 2.0", "bumper.kind = 2", 14, ("testbed.bumper.kind", "bumper")),
    "misspelt parameter": ("slider.friction = 2.0", "slider.frictoin = 2.0", 14,
                           ("testbed.slider.frictoin", "did you mean slider.friction")),
    "parameter out of range": ("slider.friction = 2.0", "slider.friction = -2.0", 14, ("slider.friction: -2.0", "N")),
    "list out of range": ("    -0.1,", "    -1e9,", 15, ("testbed.electronics.torque_offset[2]", "N.m")),
    "an output": ("slider.friction = 2.0", "truth.x = 1.0", 14, ("testbed.truth.x", "is an output")),
    "no robot": ('name = "a case"', 'robot = "nowhere.toml"', 2, ("robot: nowhere.toml", "robot file")),
    "seed": ('name = "a case"', "seed = -1", 2, ("seed: -1",)),
    "unknown body region": ('name = "a case"', 'body_region = "lower lag"', 2, ("body_region: lower lag", "lower leg")),
    "another mass than the region's": ('name = "a case"', 'body_region = "hand"', 7,
        ("collision.mass: 12.0", "0.6 kg", "leave it out", 'judge_as = "hand"')),
    "area without unit": ('name = "a case"', 'judge_as = "hand"\ncontact_area = { value = 3 }', 3,
        ("contact_area.unit: nothing", "cm2")),
    "area in metres": ('name = "a case"', 'judge_as = "hand"\ncontact_area = { value = 3, unit = "cm" }', 3,
        ("contact_area.unit: cm", "m2")),
    "area of nothing": ('name = "a case"', 'judge_as = "hand"\ncontact_area = { value = 0, unit = "cm2" }', 3,
        ("contact_area: 0.0", "1e-06 to 1 m2")),
    "judged as nothing known": ('name = "a case"', 'judge_as = "hnad"', 2, ("judge_as: hnad", "hand")),
    "body region of nothing": (GOOD[GOOD.index('bumper'):], 'body_region = "hand"', 4, ("body_region: hand",)),
    "no name": ('name = "a case"', 'name = ""', 2, ("name", "1 to 80")),
    "bumper without a collision": (GOOD[GOOD.index("[coll"):], "", 4, ("bumper: spring", "without [collision]")),
    "plan is no table": ("[collision]", "plan = 3\n[collision]", 6, ("plan: 3", "table")),
    "plan without kind": ("[collision]", "[plan]\nx = 1\n[collision]", 6, ("plan.kind",)),
    "unknown plan": ("[collision]", '[plan]\nkind = "cirle"\n[collision]', 7, ("plan.kind", "did you mean circle")),
    "key of another plan": ("[collision]", '[plan]\nkind = "rest"\nspeed = 1\n[collision]', 8, ("plan.speed",)),
    "plan out of range": ("[collision]", '[plan]\nkind = "circle"\nspeed = 1\ndiameter = 0\n[collision]', 9,
                          ("plan.diameter: 0.0", "m")),
    "arcs of nothing": ("[collision]", '[plan]\nkind = "arcs"\nwheels = [[1, 0]]\n[collision]', 8,
                        ("plan.wheels: [[1, 0]]", "every wheel")),
    "arcs about no point": ("[collision]", '[plan]\nkind = "arcs"\nwheels = [[1, -1, 0]]\n[collision]', 8,
                            ("plan.wheels", "sum is not 0")),
    "arcs too quick": ("[collision]", '[plan]\nkind = "arcs"\nfrequency = 2\n[collision]', 8,
                       ("plan.frequency: 2 (speed", "at most")),
    "half a swing": ("[collision]", '[plan]\nkind = "arcs"\nswings = 0.5\n[collision]', 8,
                     ("plan.swings: 0.5", "whole")),
    "plan too fast": ("[collision]", '[plan]\nkind = "straight"\nspeed = 99\n[collision]', 8, ("plan.speed: 99.0",)),
    "push is no list": ("[collision]", "push = 1\n[collision]", 6, ("push: 1", "[[push]]")),
    "push without force": ("[collision]", "[[push]]\npoint = [0, 0]\n[collision]", 6, ("push[0].force: nothing",)),
    "second push too early": (
        "[collision]",
        "".join(PUSH.format(start) for start in (1, 1.5)) + "[collision]",
        16, ("push[1].start: 1.5", "one at a time")),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_file_is_refused_with_line_and_key(case: str, tmp_path: Path) -> None:
    old, new, line, words = WRONG[case]
    assert GOOD.count(old) == 1
    path = written(tmp_path, GOOD.replace(old, new))
    with pytest.raises(InputFileError) as caught:
        read_scenario(path)
    message = str(caught.value)
    assert message.startswith(f"{path}:{line}: "), message
    assert "\n" not in message
    for word in words:
        assert word in message


def test_the_command_line_refuses_with_one_line_and_writes_nothing(cli: Cli, tmp_path: Path) -> None:
    written(tmp_path, GOOD.replace("speed = 0.4", "speed = -1"))
    done = cli("run", "case.toml", "--out", "out")
    assert done.returncode == 2
    assert done.stderr.splitlines() == [
        "giveway: case.toml:8: collision.speed: -1.0 is not allowed; allowed: a number from 0 to 20 m/s"
    ]
    assert not done.stdout
    assert folder_content(tmp_path) == ["case.toml"]
    assert "no such file" in cli("run", "./nowhere", "--out", "out").stderr
    assert "--bumper: rubber is unknown" in cli("run", "case.toml", "--bumper", "rubber", "--out", "out").stderr


def test_the_contact_is_judged_as_a_body_region(cli: Cli, tmp_path: Path) -> None:
    written(tmp_path, 'judge_as = "hand"\ncontact_area = { value = 4.0, unit = "cm2" }\n' + GOOD)
    done = cli("run", "case.toml", "--out", "out")
    assert done.returncode == 0, done.stderr
    (line,) = (one for one in done.stdout.splitlines() if one.startswith("hand: "))
    result = giveway.load(tmp_path / "out")
    peak = float(result.traces["testbed.truth.contact_force"].max())
    assert f"peak {peak:.0f} N (allowed: 280 N)" in line  # twice the quasi-static 140 N
    assert f"mean pressure on 4 cm2: peak {peak / 4.0:.1f} N/cm2 (allowed: 380 N/cm2)" in line
    assert result.manifest["scenario"]["judge_as"] == "hand"
    assert str(result.judgement) == line
    assert line in html.unescape((tmp_path / "out" / "report.html").read_text(encoding="utf-8"))


def test_the_command_line_runs_a_file(cli: Cli, tmp_path: Path) -> None:
    written(tmp_path, GOOD)
    done = cli(
        "run", "case.toml", "--bumper", "magnetic", "--seed", "4", "--set", "testbed.base.mass=40", "--out", "out"
    )
    assert done.returncode == 0, done.stderr
    assert "a case" in done.stdout
    result = giveway.load(tmp_path / "out")
    assert result.manifest["scenario"]["bumper"] == "magnetic"
    assert result.manifest["seed"] == 4
    assert result.manifest["parameters"]["testbed"]["base.mass"] == 40.0
    assert result.metric("contact speed").value == pytest.approx(0.4, rel=0.01)
    assert "<h1>A case</h1>" in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")


LINES = """\
# a comment
a = 1

[b]
c = [
  1,
  2,
]   # after it
# another
d.e = "x"
[[f]]
g = 1
[[f]]
g = '''
h = 1
'''
"""


@pytest.mark.parametrize(
    ("name", "line"),
    [("a", 2), ("b", 4), ("b.c", 5), ("b.c[1]", 5), ("b.d.e", 10), ("b.d", 10), ("f[0].g", 12), ("f[1]", 13),
     ("f[1].g", 14), ("f[1].h", 13), ("f[7].g", 11), ("b.d.nothing", 10), ("b.missing.entirely", 4), ("nothing", 1)],
)  # fmt: skip
def test_a_name_is_found_in_its_line(name: str, line: int) -> None:
    assert line_of(LINES, name) == line


def test_tables_are_flattened_with_the_names_of_messages() -> None:
    names = [name for name, _ in flatten({"a": {"b": [{"c": 1}]}})]
    assert names == ["a", "a.b", "a.b[0]", "a.b[0].c"]
