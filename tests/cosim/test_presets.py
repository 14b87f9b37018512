"""Presets of the controller: the default, and the paper's, which `reproduce` and `fit` keep."""

from __future__ import annotations

import dataclasses
import zipfile
from pathlib import Path

import giveway
import pytest
from cosim_helpers import Cli, short
from giveway import batch
from giveway.base import native
from giveway.base.errors import GivewayError, InputFileError
from giveway.experiments import all_experiments, circle
from giveway.fitting.quantities import Bench
from giveway.fmu_tools.ssp import write_ssp
from giveway.report import render
from giveway.robot.presets import NO_REFLEX, PRESETS, preset_values
from giveway.robot.variables import table
from giveway.simulation.summary import preset_line
from giveway.study import Study, study_file

PAPER = {
    "estimator.velocity_source": 0,
    "estimator.acceleration_source": 0,
    "estimator.creep_speed": 0.03,
    "estimator.friction_model": 0,
    "estimator.aligned": 0,
    "detector.kind": 1,
    "channels.lever": 0.01,
    "admittance.kind": 0,
    "admittance.tip_height": 0.0,
    "admittance.tip_share": 0.45,
    "admittance.smoothing": 0.0,
    "admittance.lead": 0.0,
    "admittance.brake_limit": 0.0,
    "admittance.push_share": 0.0,
    "admittance.ahead": 0.0,
    "channels.rocking": 0.0,
    "motor.inertia": 0.0,
}
SCENARIO_FILE = 'schema_version = 1\nduration = 0.3\npreset = "{}"\n'


def controller(scenario: giveway.Scenario) -> dict[str, object]:
    """All parameters of its controller that a preset sets."""
    variables, given = table("controller"), scenario.parameters("controller")
    return {name: given.get(name, variables[name].start) for name in PAPER}


def test_the_paper_s_is_the_reflex_of_before() -> None:
    assert preset_values("paper") == PAPER
    assert preset_values("default") == {}
    assert preset_values("paper", "testbed") == {}


def test_the_default_is_the_best() -> None:
    found = controller(giveway.Scenario("default", 1.0))
    assert (found["detector.kind"], found["admittance.kind"], found["estimator.aligned"]) == (2, 2, 1)
    assert found["admittance.tip_height"] == table("testbed")["base.com_height"].start


@pytest.mark.parametrize("name", [name for name, one in all_experiments().items() if one.is_single_run])
def test_an_experiment_has_the_preset_that_it_was_asked_for(name: str) -> None:
    bumper = all_experiments()[name].bumpers[-1]
    default = giveway.experiment(name).scenario(bumper)
    paper = giveway.experiment(name, preset="paper").scenario(bumper)
    assert (default.preset, paper.preset) == ("default", "paper")
    own = {parameter: value for parameter, value in paper.controller.items() if parameter in PAPER}
    assert controller(paper) == {**PAPER, **own}
    assert controller(default)["detector.kind"] == 2
    assert giveway.experiment(name).scenario(bumper, preset="paper") == paper
    assert giveway.experiment(name, preset="paper").scenario(bumper, preset="default") == default


def test_an_experiment_of_many_runs_has_no_scenario_in_any() -> None:
    with pytest.raises(GivewayError, match="does them all"):
        giveway.experiment("static_pushes", preset="paper").scenario("none")


def test_what_the_user_sets_wins() -> None:
    own = giveway.Scenario("own", 1.0, preset="paper", controller={"estimator.creep_speed": 0.05})
    assert controller(own) == {**PAPER, "estimator.creep_speed": 0.05}


def test_another_robot_has_its_own_height_and_the_paper_s_none(tmp_path: Path) -> None:
    text = native.robot().read_text(encoding="utf-8")
    before, height, after = text.partition("[base.com_height]\nvalue = 0.414\n")
    assert height
    tall = tmp_path / "tall.toml"
    tall.write_text(f"{before}{height.replace('0.414', '0.8')}{after}", encoding="utf-8")
    heights = [
        giveway.Scenario("tall", 1.0, robot=tall, preset=preset).parameters("controller")["admittance.tip_height"]
        for preset in PRESETS
    ]
    assert heights == [0.8, 0.0]


@pytest.mark.parametrize(
    "ask",
    [
        lambda: giveway.Scenario("x", 1.0, preset="papers"),
        lambda: giveway.experiment("motionless", preset="papers"),
        lambda: giveway.experiment("motionless").scenario("none", preset="papers"),
        lambda: circle.scenario(preset="papers"),
    ],
    ids=["scenario", "experiment", "its scenario", "circle"],
)
def test_an_unknown_one_is_refused_with_those_that_there_are(ask: object) -> None:
    with pytest.raises(GivewayError, match=r"^preset: papers is unknown; allowed: default, paper; did you mean paper"):
        ask()  # type: ignore[operator]


def test_a_scenario_file_has_one(tmp_path: Path) -> None:
    file = tmp_path / "case.toml"
    for preset in PRESETS:
        file.write_text(SCENARIO_FILE.format(preset))
        assert giveway.read_scenario(file).preset == preset
    file.write_text(SCENARIO_FILE.format("papers"))
    with pytest.raises(InputFileError, match=r"case\.toml:3: preset: papers is unknown; allowed: default, paper"):
        giveway.read_scenario(file)


def test_a_study_has_one(tmp_path: Path) -> None:
    setups = []
    for preset in ("paper", None):
        study = Study("one", duration=0.8, bumper="none", preset=preset)  # type: ignore[arg-type]
        study.collision("front", speed=0.5, edge=0).vary("collision.speed", values=[0.4, 0.5]).designs("factorial")
        setups.append(study_file.check(study.document, tmp_path))
    assert [setup.cases[0].scenario.preset for setup in setups] == ["paper", "default"]


def test_a_study_runs_it(tmp_path: Path) -> None:
    times = []
    for preset in ("paper", "default"):
        study = Study("one", duration=0.8, bumper="none", preset=preset)  # type: ignore[arg-type]
        study.collision("front", speed=0.5, edge=0).vary("collision.mass", values=[9.08]).designs("factorial")
        answers = study.objective("detection time").run(tmp_path / preset, progress=False)
        times.append(float(answers.shown_values(0)[0]))
    assert times[0] > 2.0 * times[1] > 0.0


def test_the_manifest_and_the_user_are_told() -> None:
    paper, default = batch.run(short("none", preset="paper")), batch.run(short("none"))
    assert [run.manifest["scenario"]["preset"] for run in (paper, default)] == ["paper", "default"]
    line = preset_line({"none": paper})
    assert line.startswith('The controller has the preset "paper": ')
    assert preset_line({"none": default}) == ""
    assert "preset &#34;paper&#34;" in render("title", "summary", [paper])
    assert "has the preset" not in render("title", "summary", [default])
    older = dataclasses.replace(paper, manifest={**paper.manifest, "scenario": {"bumper": "none"}})
    assert preset_line({"none": older}) == line  # from before there were presets


def test_the_command_line_chooses_it(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(SCENARIO_FILE.format("paper"))
    asked = ("run", "motionless", "--duration", "0.3", "--engine", "native", "--out", "out")
    kinds = {}
    for name, arguments in {
        "default": asked,
        "paper": (*asked, "--preset", "paper"),
        "set": (*asked, "--preset", "paper", "--set", "controller.detector.kind=0"),
        "file": ("run", "./case.toml", "--engine", "native", "--out", "out"),
        "file, other": ("run", "./case.toml", "--preset", "default", "--engine", "native", "--out", "out"),
    }.items():
        said = cli(*arguments)
        assert said.returncode == 0, said.stderr
        manifest = giveway.load(tmp_path / "out").manifest
        kinds[name] = (manifest["scenario"]["preset"], manifest["parameters"]["controller"]["detector.kind"])
    assert kinds == {
        "default": ("default", 2),
        "paper": ("paper", 1),
        "set": ("paper", 0),
        "file": ("paper", 1),
        "file, other": ("default", 2),
    }
    for command in (("run", "motionless", "--out", "x"), ("demo", "--out", "x"), ("variables", "controller")):
        said = cli(*command, "--preset", "papers")
        assert said.returncode == 2
        assert "--preset: papers is unknown; allowed: default, paper" in said.stderr
    assert not (tmp_path / "x").exists()


def test_variables_are_listed_as_a_preset_has_them(cli: Cli) -> None:
    asked = ("variables", "controller", "--grep", "admittance.lead")
    listed = [cli(*asked, *more).stdout for more in ((), ("--preset", "paper"))]
    assert "0.04" in listed[0]
    assert "preset paper" in listed[1]
    assert " 0.0 " in listed[1]


def test_a_package_carries_the_paper_s(tmp_path: Path) -> None:
    write_ssp(tmp_path / "giveway.ssp")
    with zipfile.ZipFile(tmp_path / "giveway.ssp") as archive:
        text = archive.read("resources/paper.controller.ssv").decode()
        assert not [name for name in archive.namelist() if name.endswith(".ssd") and b"paper" in archive.read(name)]
    for name, value in PAPER.items():
        assert f'<ssv:Parameter name="{name}">' in text
        assert f'value="{value!r}"' in text


@pytest.mark.parametrize("preset", PRESETS)
def test_a_controller_without_reflexes_never_reacts(preset: str) -> None:
    result = batch.run(short("none", preset=preset, controller=NO_REFLEX))
    assert float(result.traces["testbed.truth.contact_force"].max()) > 100.0
    assert int(result.traces["controller.detection.count"].max()) == 0


def test_the_fit_s_controllers_are_the_paper_s() -> None:
    bench = Bench()
    _, controller_values = bench._overrides({}, {model: {} for model in native.MODELS})
    assert {name: controller_values[name] for name in PAPER} == PAPER
    assert {one.preset for one in (*bench._collisions, bench._moving, bench._push)} == {"paper"}


def test_the_circle_s_estimators_belong_to_the_paper_s() -> None:
    full = circle.scenario(preset="paper", pushes=1)
    assert full.controller["estimator.average_window"] == 50
    assert circle.scenario(pushes=1).controller == {"supervisor.after_settled": 1}
    with pytest.raises(GivewayError, match='only beside preset = "paper"'):
        circle.scenario(estimator=circle.FULL)


def test_no_estimator_of_the_default_takes_its_own_motion_for_a_push() -> None:
    """Planted: with the planned acceleration the paper's does, when the robot starts at once."""
    plan = giveway.scenario.plan.Straight(0.3, acceleration_mps2=1.0)
    runs = [
        giveway.Scenario("start", 2.0, bumper="none", testbed={"slider.present": False}, plan=plan, preset=preset)
        for preset in PRESETS
    ]
    alarms = batch.run_many(runs)["false detections"].values
    assert alarms[0] == 0.0
    assert alarms[1] > 0.0
