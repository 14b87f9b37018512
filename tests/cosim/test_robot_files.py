"""The shipped robots, by name and by path: sources for every number, and experiments that are theirs."""

from __future__ import annotations

import json
from pathlib import Path

import giveway
import pytest
from cosim_helpers import Cli, folder_content
from giveway import batch
from giveway.base import native
from giveway.experiments import all_experiments, get
from giveway.own_robot.checked import check
from giveway.robot.changes import NewValue, changed_robot
from giveway.robot.robot_file import read_robot
from giveway.robot.variables import table

ROOT = Path(__file__).parents[2]
FILES = sorted((ROOT / "robots").glob("*.toml"))
OTHERS = [path.stem for path in FILES if path.stem != "trikey"]
FEELING = [name for name in OTHERS if name != "lekiwi"]
STUDY = """
schema_version = 1
name = "small"
[scenario]
duration = 0.6
bumper = "spring"
robot = "NAME"
[[collision]]
name = "front"
speed = 0.3
edge = 0
time = 0.3
[designs]
kind = "sobol"
count = 2
[[vary]]
quantity = "testbed.bumper.spring_rate"
low = 0.5
high = 2.0
unit = "N/mm"
[[objective]]
metric = "peak force of the run"
"""
SINGLE = [name for name, one in all_experiments().items() if one.is_single_run]


def test_all_of_them_are_shipped() -> None:
    assert {name: path.read_bytes() for name, path in native.robots().items()} == {
        path.stem: path.read_bytes() for path in FILES
    }


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_number_has_its_source_and_nothing_is_implausible(path: Path) -> None:
    found = check(path)
    assert found.usable
    assert found.doubts == ()
    for name, entry in found.robot.entries():
        assert entry.source, name
        assert entry.confidence, name
        assert entry.provenance, name


@pytest.mark.parametrize("name", OTHERS)
def test_each_file_says_that_its_robot_was_not_tried(name: str) -> None:
    head = (ROOT / "robots" / f"{name}.toml").read_text(encoding="utf-8").partition("schema_version")[0]
    assert "tried on hardware" in " ".join(head.replace("#", " ").split())


@pytest.mark.parametrize("name", FEELING)
@pytest.mark.parametrize("experiment", [name for name in SINGLE if name != "circle"])
def test_experiments_are_the_robots_own(experiment: str, name: str) -> None:
    result = batch.run(get(experiment).scenario("magnetic", robot=native.robots()[name]))
    assert {warning.code for warning in result.warnings} <= {"motor saturated"}  # the contact is as stated
    assert result.metric("false detections").value == 0
    assert result.metric("detection time").value is not None


def test_lekiwi_shows_what_hobby_servos_cannot_feel() -> None:
    """A gear of 345:1 holds what the magnetic bumper lets through; the bare hit of the same slider passes it."""
    robot = native.robots()["lekiwi"]
    delays = {}
    for experiment, bumper in (("motionless", "magnetic"), ("motionless", "none"), ("moving", "magnetic")):
        result = batch.run(get(experiment).scenario(bumper, robot=robot))
        assert result.warnings == ()
        assert result.metric("false detections").value == 0
        delays[experiment, bumper] = result.metric("detection time").value
    assert delays["motionless", "magnetic"] is None
    assert delays["moving", "magnetic"] is None
    assert delays["motionless", "none"] == pytest.approx(32.0, abs=3.0)  # three times as late as Trikey


@pytest.mark.parametrize("name", OTHERS)
def test_other_commands_take_it(name: str, cli: Cli, tmp_path: Path) -> None:
    for command in (("drivetrain", "--robot", name), ("ssp", "--robot", name, "--out", "a.ssp")):
        done = cli(*command)
        assert done.returncode == 0, done.stderr
    (tmp_path / "study.toml").write_text(STUDY.replace("NAME", name))
    done = cli("sweep", "study.toml", "--out", "out")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "robot.toml").read_bytes() == native.robots()[name].read_bytes()


@pytest.mark.parametrize("name", FEELING)
def test_pushes_on_the_circle_suit_its_sides_and_weight(name: str) -> None:
    robot = native.robots()[name]
    scenario = get("circle").scenario(robot=robot, pushes=2)
    mass = read_robot(robot).value("base.mass")
    assert all(push.force_n <= 60.0 * min(1.0, mass / 34.7) for push in scenario.push.pushes)
    result = batch.run(scenario)
    assert result.metric("false detections").value == 0
    detections = [{metric.name: metric.value for metric in push}["detections"] for push in result.pushes]
    assert detections == [1.0, 1.0]


def test_a_shipped_robot_by_its_name(cli: Cli, tmp_path: Path) -> None:
    done = cli("run", "motionless", "--robot", "delivery", "--engine", "native", "--duration", "0.1", "--out", "out")
    assert done.returncode == 0, done.stderr
    assert json.loads((tmp_path / "out" / "manifest.json").read_text())["robot"]["file"] == "delivery.toml"
    (tmp_path / "case.toml").write_text('schema_version = 1\nduration = 0.1\nrobot = "delivery"\n')
    assert giveway.read_scenario(tmp_path / "case.toml").parameters("testbed")["base.mass"] == 60.0
    # A file of the user that has this name is his.
    own = native.robot().read_text(encoding="utf-8").replace("value = 34.7", "value = 41.0")
    (tmp_path / "delivery").write_text(own)
    assert giveway.read_scenario(tmp_path / "case.toml").parameters("testbed")["base.mass"] == 41.0


def test_an_unknown_name_offers_the_nearest(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text('schema_version = 1\nduration = 0.1\nrobot = "delivry"\n')
    for arguments in (
        ("run", "motionless", "--robot", "delivry", "--out", "out"),
        ("run", "case.toml", "--out", "out"),
    ):
        done = cli(*arguments)
        assert done.returncode == 2
        assert len(done.stderr.splitlines()) == 1
        assert "delivry" in done.stderr
        assert "did you mean delivery?" in done.stderr
    assert folder_content(tmp_path) == ["case.toml"]


def test_the_demo_hits_the_robot_that_is_asked_for(cli: Cli, tmp_path: Path) -> None:
    text = native.robot().read_text(encoding="utf-8")
    (tmp_path / "mine.toml").write_text(text.replace("value = 4.54", "value = 0.2"))
    done = cli("demo", "--robot", "mine.toml", "--engine", "native", "--out", "out")
    assert done.returncode == 2
    assert "robot: mine.toml" in done.stderr
    assert "hanging weight" in done.stderr
    assert folder_content(tmp_path) == ["mine.toml"]


@pytest.mark.deep
@pytest.mark.parametrize("name", OTHERS)
def test_the_demo_of_another_robot(name: str, cli: Cli, tmp_path: Path) -> None:
    done = cli("demo", "--robot", name, "--engine", "native", "--out", "out")
    assert done.returncode == 0, done.stderr
    for bumper in ("none", "spring", "magnetic"):
        manifest = json.loads((tmp_path / "out" / bumper / "manifest.json").read_text())
        assert manifest["robot"]["file"] == f"{name}.toml"


def test_the_list_names_robots_and_whose_experiments(cli: Cli) -> None:
    said = cli("robot", "list").stdout
    assert all(f"{path.stem}: {read_robot(path).name}, " in said for path in FILES)
    experiments = cli("list").stdout.splitlines()
    assert [line.partition(":")[0] for line in experiments if "Of Trikey alone" not in line] == SINGLE


SETTING = '\n[controller.channels.fast_rest]\nvalue = 0.5\nunit = "lbf"\n\n[testbed.imu.present]\nvalue = true\n'


def settings(folder: Path, text: str) -> Path:
    path = folder / "mine.toml"
    path.write_text(native.robot().read_text(encoding="utf-8") + text, encoding="utf-8")
    return path


def test_a_robot_file_may_set_what_has_a_start_value(tmp_path: Path) -> None:
    path = settings(tmp_path, SETTING)
    for preset in ("default", "paper"):
        scenario = giveway.Scenario("x", 0.1, robot=path, preset=preset)
        assert scenario.parameters("controller")["channels.fast_rest"] == pytest.approx(2.2241108)
        assert scenario.parameters("testbed")["imu.present"] is True
    paper = settings(tmp_path, "\n[controller.detector.kind]\nvalue = 0\nunit = '1'\n")
    kinds = [
        giveway.Scenario("x", 0.1, robot=paper, preset=preset).parameters("controller")["detector.kind"]
        for preset in ("default", "paper")
    ]
    assert kinds == [0, 1]  # a preset wins, and what a scenario sets wins over both
    own = giveway.Scenario("x", 0.1, robot=path, controller={"channels.fast_rest": 9.0})
    assert own.parameters("controller")["channels.fast_rest"] == 9.0
    assert batch.run(giveway.Scenario("x", 0.1, robot=path)).metric("false detections").value == 0


WRONG = {
    "unknown": ('[controller.channels.fast_rset]\nvalue = 1\nunit = "N"\n', ("fast_rset", "did you mean fast_rest")),
    "of the run": ("[testbed.slider.present]\nvalue = true\n", ("testbed.slider", "allowed: base, imu")),
    "of the robot": ('[controller.base.mass]\nvalue = 1\nunit = "kg"\n', ("controller.base", "base")),
    "corners": ("[controller.outline.count]\nvalue = 4\nunit = '1'\n", ("controller.outline", "outline")),
    "out of range": (
        '[controller.channels.fast_rest]\nvalue = -1\nunit = "N"\n',
        ("channels.fast_rest", "0.01 to 1000"),
    ),
    "a number for a word": ("[testbed.imu.present]\nvalue = 1\n", ("testbed.imu.present.value: 1", "true or false")),
    "short list": ("[testbed.imu.acceleration_bias]\nvalue = [1.0]\nunit = 'm/s2'\n", ("a list of 2 numbers",)),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_settings_name_file_line_and_key(case: str, tmp_path: Path) -> None:
    text, words = WRONG[case]
    path = settings(tmp_path, f"\n{text}")
    with pytest.raises(giveway.GivewayError) as caught:
        [table(model).robot_values(read_robot(path)) for model in native.MODELS]
    message = str(caught.value)
    line = int(message.removeprefix(f"{path}:").partition(":")[0])
    assert line > native.robot().read_text(encoding="utf-8").count("\n")
    for word in words:
        assert word in message


def test_a_byte_order_mark_is_left_out(cli: Cli, tmp_path: Path) -> None:
    """Some editors of Windows write one; scenario, study and column files are read by the same function."""
    (tmp_path / "own.toml").write_bytes(b"\xef\xbb\xbf" + native.robot().read_bytes())
    done = cli("robot", "check", "own.toml")
    assert done.returncode == 0, done.stderr
    own = read_robot(tmp_path / "own.toml")
    assert dict(own.entries()) == dict(read_robot(native.robot()).entries())
    changed = changed_robot(tmp_path / "own.toml", {"base.mass": NewValue(41.0, "scales", "measured", "high")})
    assert changed == changed_robot(native.robot(), {"base.mass": NewValue(41.0, "scales", "measured", "high")})
