"""Experiments with another robot: what collides is placed by its own outline, at the speed that the experiment says."""

from __future__ import annotations

import math
from pathlib import Path

import giveway
import pytest
from cosim_helpers import Cli, folder_content
from giveway import batch
from giveway.base import native
from giveway.experiments import all_experiments, get
from giveway.experiments.command import _scenario
from giveway.experiments.placement import outline_of_robot
from giveway.fmu_tools.ssp import parameter_set
from giveway.robot.robot_file import read_robot
from giveway.scenario.plan import Pushes

TRIKEY = native.robot().read_text(encoding="utf-8")
X, Y = "value = [0.352184, -0.176092, -0.176092]", "value = [0.0, 0.305, -0.305]"
# Half Trikey's size in x; its side between corners 0 and 1 looks ahead.
BOX = {X: "value = [0.16, 0.16, -0.16, -0.16]", Y: "value = [-0.25, 0.25, 0.25, -0.25]"}


def robot_file(folder: Path, changes: dict[str, str]) -> Path:
    text = TRIKEY
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new, 1)
    path = folder / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("experiment", "bumper", "speed_mps"),
    [
        ("motionless", "none", 0.5),
        ("tipping", "magnetic", 0.5),
        ("moving", "magnetic", 0.22),
        ("clamping", "none", 0.22),
    ],
)
def test_another_outline_is_hit_in_its_middle_as_fast(
    experiment: str, bumper: str, speed_mps: float, tmp_path: Path
) -> None:
    result = batch.run(get(experiment).scenario(bumper, robot=robot_file(tmp_path, BOX)))
    # The rope is elastic, and the run-up is that up to the touch, while the metric is of the row before.
    assert result.metric("contact speed").value == pytest.approx(speed_mps, rel=0.02)
    row = int(result.traces["testbed.truth.contact"].values.argmax())
    x, y = (float(result.traces[f"testbed.truth.contact_base_{axis}"][row]) for axis in "xy")
    assert x == pytest.approx(0.16, abs=1e-9)  # on the outline
    assert y == pytest.approx(0.0, abs=1e-3)  # where the robot moves, its lag shifts the place
    assert result.metric("false detections").value == 0


def test_another_weight_or_slider_makes_the_same_speed(tmp_path: Path) -> None:
    heavy = robot_file(tmp_path, {"value = 9.08": "value = 14.0"})
    result = batch.run(get("motionless").scenario("none", robot=heavy))
    assert result.metric("contact speed").value == pytest.approx(0.5, rel=0.02)


def test_the_run_up_of_the_robot_file_stands_if_it_makes_the_speed(tmp_path: Path) -> None:
    near = robot_file(tmp_path, {"value = 0.0395": "value = 0.0402"})
    assert get("motionless").scenario("none", robot=near).parameters("testbed")["slider.run_up"] == 0.0402
    far = robot_file(tmp_path, {"value = 0.0395": "value = 0.06"})
    assert get("motionless").scenario("none", robot=far).parameters("testbed")["slider.run_up"] == pytest.approx(
        0.0395, rel=0.01
    )


@pytest.mark.parametrize("experiment", ["motionless", "moving", "clamping", "tipping", "circle"])
def test_trikey_starts_as_in_the_paper_to_the_last_bit(experiment: str, tmp_path: Path) -> None:
    own, same = get(experiment).scenario("none"), get(experiment).scenario("none", robot=native.robot())
    assert same.testbed == own.testbed
    assert same.plan == own.plan
    assert same.push == own.push
    heavy = get(experiment).scenario("none", robot=robot_file(tmp_path, {"value = 34.7": "value = 50.0"}))
    assert heavy.testbed == own.testbed
    assert heavy.parameters("testbed")["base.mass"] == 50.0


# Also of a box with sides of 0.32 m at the most, which have no place 0.2 m from their middles.
@pytest.mark.parametrize("changes", [BOX, {**BOX, Y: "value = [-0.1, 0.1, 0.1, -0.1]"}])
def test_the_robots_own_sides_are_pushed_on_the_circle(changes: dict[str, str], tmp_path: Path) -> None:
    box = robot_file(tmp_path, changes)
    scenario = get("circle").scenario("none", robot=box)
    assert isinstance(scenario.push, Pushes)
    (left, top), *_ = outline_of_robot(box)
    for push in scenario.push.pushes:
        on_x = math.isclose(abs(push.point_x_m), abs(left), abs_tol=1e-12)
        on_y = math.isclose(abs(push.point_y_m), abs(top), abs_tol=1e-12)
        assert on_x or on_y
        assert abs(push.point_x_m) <= abs(left)
        assert abs(push.point_y_m) <= abs(top)


def test_a_light_robot_is_pushed_less_and_by_a_lighter_slider(tmp_path: Path) -> None:
    light = robot_file(tmp_path, {**BOX, "value = 34.7": "value = 17.35", "value = 9.08": "value = 4.54"})
    forces = [push.force_n for push in get("circle").scenario(robot=light).push.pushes]
    assert forces == [0.5 * push.force_n for push in get("circle").scenario().push.pushes]
    assert get("moving").scenario("none", robot=light).parameters("testbed")["slider.mass"] == 6.81
    low = robot_file(tmp_path, {**BOX, "value = 0.414": "value = 0.207"})
    assert get("tipping").scenario("none", robot=low).parameters("testbed")["contact.height"] == 0.29


@pytest.mark.parametrize(
    ("experiment", "changes", "words"),
    [
        ("motionless", {"value = 4.54": "value = 0.2"}, ("motionless", "hanging weight")),
    ],
)
def test_what_cannot_be_done_with_a_robot_is_refused_by_name(
    experiment: str, changes: dict[str, str], words: tuple[str, ...], cli: Cli, tmp_path: Path
) -> None:
    robot_file(tmp_path, changes)
    done = cli("run", experiment, "--robot", "mine.toml", "--out", "out")
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    for word in ("robot: mine.toml", *words):
        assert word in done.stderr
    assert folder_content(tmp_path) == ["mine.toml"]


def test_a_scenario_without_a_mass_has_the_robot_files_slider(tmp_path: Path) -> None:
    robot_file(tmp_path, {"value = 9.08": "value = 14.0"})
    (tmp_path / "case.toml").write_text(
        'schema_version = 1\nduration = 1\nrobot = "mine.toml"\n[collision]\nspeed = 0.3\nedge = 0\n'
    )
    assert giveway.read_scenario(tmp_path / "case.toml").parameters("testbed")["slider.mass"] == 14.0


def test_the_package_of_another_robot_hits_it_as_fast(tmp_path: Path) -> None:
    box = robot_file(tmp_path, BOX)
    values = parameter_set("none", read_robot(box))
    placed = get("motionless").scenario("none", robot=box).testbed
    assert {name: values[f"testbed.{name}"] for name in placed if name != "slider.present"} == {
        name: value for name, value in placed.items() if name != "slider.present"
    }
    assert "testbed.slider.target_x" not in parameter_set("none", read_robot(native.robot()))


def test_the_fit_is_for_the_papers_outline(cli: Cli, tmp_path: Path) -> None:
    robot_file(tmp_path, BOX)
    done = cli("fit", "--robot", "mine.toml", "--out", "new.toml")
    assert done.returncode == 2
    assert "robot: mine.toml" in done.stderr
    assert "outline of the paper's" in done.stderr
    assert folder_content(tmp_path) == ["mine.toml"]


@pytest.mark.parametrize("name", [name for name, one in all_experiments().items() if one.is_single_run])
def test_without_a_bumper_an_experiment_has_the_magnetic_one_or_its_own(name: str) -> None:
    own = get(name).bumpers
    bumper = "magnetic" if not own or "magnetic" in own else own[0]
    scenario, _ = _scenario(name, None, None, None)
    assert scenario.bumper == bumper
    assert scenario == get(name).scenario(bumper)
