"""Studies of drivetrains: metrics that follow from parameters beside measured ones, in tables, goals and files."""

from __future__ import annotations

import math
import shutil
from pathlib import Path
from typing import Any

import giveway
import numpy as np
import pytest
from giveway.base.errors import GivewayError, InputFileError
from giveway.drivetrain.analysis import analyse
from giveway.drivetrain.model import read as linear
from giveway.study import Study
from giveway.study.answers import load
from giveway.study.catalogue import read_catalogue
from giveway.study.engine import plan_runs, sweep
from giveway.study.metrics import DRIVETRAIN
from giveway.study.quantities import columns
from giveway.study.results_table import read_runs
from giveway.study.study_file import read

EXAMPLES = Path(__file__).parents[2] / "examples"
STIFFNESS, INERTIA = "robot.drivetrain.stiffness", "testbed.drivetrain.motor_inertia"
NEAR = 1e-4  # the command's curves are straight between their points


def small(**keys: Any) -> Study:
    study = Study("drivetrain", duration=0.3, bumper=keys.pop("bumper", "none"), method="fixed-step", **keys)
    study.collision("front", speed=0.5, mass=9.08, edge=0, time=0.15)
    return study.report(chosen=0)


def test_the_metrics_of_the_robot_are_those_of_the_command(tmp_path: Path) -> None:
    study = small().drivetrain(servo_delay=2).vary(STIFFNESS, values=[3000.0, 721.0])
    answers = study.run(tmp_path / "out", threads=1, progress=False)
    values = {answers.goals[j].metric.name: answers.values[:, j] for j in range(len(answers.goals))}
    assert set(DRIVETRAIN) <= set(values)
    analysis = analyse(*linear(delay=2))
    margins, channel = analysis.margins, analysis.cases["servo"].channels["environment"]
    assert margins.gain is not None
    assert margins.delay_s is not None
    assert values["servo gain margin"][1] == pytest.approx(20.0 * math.log10(margins.gain), rel=NEAR)
    assert values["servo phase margin"][1] == pytest.approx(margins.phase_deg, rel=NEAR)
    assert values["servo delay margin"][1] == pytest.approx(1e3 * margins.delay_s, rel=NEAR)
    assert values["torque bandwidth"][1] == pytest.approx(channel.bandwidth_hz, rel=NEAR)
    # The inertia that moves with the base, and the wheels' motors, on three wheels (test_linear_drivetrain.py).
    drivetrain = linear()[0]
    radius = columns().start[columns().index["testbed.wheel.radius"]]
    both = 1.5 * (drivetrain.load_inertia + drivetrain.motor_inertia) / radius**2
    assert values["reflected inertia"] == pytest.approx(both, rel=1e-12)
    # A stiffer sensor changes the loop; what is stored is what is shown.
    stored = read_runs(tmp_path / "out", ["torque bandwidth", "servo phase margin"])
    assert stored["torque bandwidth"].tolist() == values["torque bandwidth"].tolist()
    assert stored["servo phase margin"][0] != stored["servo phase margin"][1]


def test_the_impact_force_is_that_of_two_masses_and_a_spring(tmp_path: Path) -> None:
    study = small().vary("bumper", values=["none", "spring", "magnetic"]).objective("impact force")
    table = plan_runs(study.setup())
    answers = study.run(tmp_path / "out", threads=1, progress=False)
    start = {name: columns().start[columns().index[f"testbed.{name}"]] for name in
             ("contact.stiffness", "bumper.spring_rate", "bumper.preload", "bumper.latch_force")}  # fmt: skip
    radius = columns().start[columns().index["testbed.wheel.radius"]]
    robot = 1.5 * (linear()[0].load_inertia + linear()[0].motor_inertia) / radius**2
    speed = float(table.rows(np.array([0]), np.array([0]), 0).stated.contact_speed_mps[0])
    energy = speed**2 * robot * 9.08 / (robot + 9.08)  # twice
    none, spring, magnetic = answers.values[:, 0]
    assert none == pytest.approx(math.sqrt(start["contact.stiffness"] * energy), rel=1e-9)
    series = 1.0 / (1.0 / start["contact.stiffness"] + 1.0 / start["bumper.spring_rate"])
    assert spring == pytest.approx(math.sqrt(start["bumper.preload"] ** 2 + series * energy), rel=1e-9)
    assert magnetic == max(spring, start["bumper.latch_force"])
    # Without loss, in line with the middle, and with a rigid drivetrain no run hits harder.
    peak = read_runs(tmp_path / "out", ["peak force of the run"])["peak force of the run"][0]
    assert 0.9 * none < peak < none


def test_they_are_goals_like_others_and_tolerances_count(tmp_path: Path) -> None:
    study = small().vary("testbed.servo.kd", values=[3.5, 7.0]).tolerance("testbed.servo.kd", relative=0.3)
    study.tolerances(samples=4, kind="corners").objective("servo phase margin", goal="maximise")
    study.constraint("torque bandwidth", minimum=0.001, unit="kHz")
    study.report(metrics=["servo gain margin"], chosen=0)
    answers = study.run(tmp_path / "out", threads=1, progress=False)
    stored = read_runs(tmp_path / "out", ["design", "servo phase margin", "servo gain margin"])
    shown = [goal.metric.name for goal in answers.goals].index("servo gain margin")
    for design in (0, 1):
        assert answers.values[design, shown] == stored["servo gain margin"][stored["design"] == design].min()
        mine = stored["servo phase margin"][stored["design"] == design]
        assert len(set(mine.tolist())) > 1
        assert answers.values[design, 0] == mine.min()  # the worst of what should be large
    assert answers.goal_unit(1).name == "kHz"
    assert answers.feasible.all()
    assert answers.order[0] == int(np.argmax(answers.values[:, 0]))


def test_another_goal_takes_the_stored_runs_and_adds_its_column(tmp_path: Path) -> None:
    before = small().vary(INERTIA, values=[0.02, 0.05]).objective("detection time")
    assert sweep(before.setup(), tmp_path / "out", threads=1).ran == 2
    after = small().vary(INERTIA, values=[0.02, 0.05]).objective("detection time").objective("reflected inertia")
    outcome = sweep(after.setup(), tmp_path / "out", threads=1)
    assert (outcome.ran, outcome.reused) == (0, 2)
    assert np.isfinite(load(tmp_path / "out").values).all()
    delayed = after.drivetrain(servo_delay=3)
    assert sweep(delayed.setup(), tmp_path / "out", threads=1).reused == 2
    slow = load(tmp_path / "out").values.copy()
    assert sweep(delayed.drivetrain(servo_delay=0).setup(), tmp_path / "out", threads=1).reused == 2
    assert (load(tmp_path / "out").values != slow).any()


def test_by_motor_current_the_smallest_push_is_refused_and_the_bandwidth_another(tmp_path: Path) -> None:
    sensing = "testbed.drivetrain.sensing"
    by_current = Study("current", duration=0.3, method="fixed-step", testbed={"drivetrain.sensing": 1})
    by_current.collision("front", speed=0.5, mass=9.08, edge=0, time=0.15).vary(STIFFNESS, values=[721.0])
    shown = [goal.metric.name for goal in by_current.drivetrain().setup().shown]
    assert "torque bandwidth" in shown
    assert "smallest detectable push" not in shown
    with pytest.raises(GivewayError, match=r"objective\[0\]\.metric: smallest detectable push .*giveway detectability"):
        by_current.objective("smallest detectable push").setup()
    # Designs that choose between both: what it cannot be said of is not ranked.
    study = small().vary(sensing, values=[0, 1]).objective("smallest detectable push")
    study.report(metrics=["torque bandwidth"], chosen=0)
    answers = study.run(tmp_path / "out", threads=1, progress=False)
    assert np.isnan(answers.values[:, 0]).tolist() == [False, True]
    assert answers.feasible.tolist() == [True, False]
    bandwidth = read_runs(tmp_path / "out", ["torque bandwidth"])["torque bandwidth"]
    analyses = [analyse(*linear(), motor_current=chosen) for chosen in (False, True)]
    wanted = [one.cases["servo"].channels["environment"].bandwidth_hz for one in analyses]
    assert bandwidth == pytest.approx(wanted, rel=NEAR)
    assert bandwidth[0] != pytest.approx(bandwidth[1], rel=0.01)


def test_an_unstable_servo_is_no_design(tmp_path: Path) -> None:
    study = small().vary("testbed.servo.kd", values=[7.0, 700.0]).objective("servo gain margin", goal="maximise")
    answers = study.run(tmp_path / "out", threads=1, progress=False)
    assert answers.feasible.tolist() == [True, False]
    assert math.isnan(answers.values[1, 0])


@pytest.mark.parametrize(("old", "new", "words"), [
    ('metric = "servo phase margin"', 'metric = "servo phase margn"', "objective[2].metric: servo phase margn"),
    ("servo_delay = 2 ", "servo_delay = 65 ", "drivetrain.servo_delay: 65 is not allowed; allowed: a whole number"),
    ("servo_delay = 2 ", 'load = "locked" ', "drivetrain.load: locked is unknown; allowed: base, wheel"),
    ("servo_delay = 2 ", "delay = 2 ", "drivetrain.delay: delay is unknown; allowed: load, servo_delay"),
    ('unit = "dB"', 'unit = "Hz"', "constraint[0].unit: Hz is not allowed; allowed: dB"),
    ('= "friction"', '= "fricton"', 'parts[0].sets.robot.drivetrain.gear_coulomb: fricton is unknown'),
])  # fmt: skip
def test_wrong_keys_are_refused_with_their_line(tmp_path: Path, old: str, new: str, words: str) -> None:
    shutil.copytree(EXAMPLES / "catalogues", tmp_path / "catalogues")
    (tmp_path / "studies").mkdir()
    path = tmp_path / "studies" / "drivetrain.toml"
    text = (EXAMPLES / "studies" / "drivetrain.toml").read_text(encoding="utf-8")
    assert text.count(old) >= 1
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InputFileError) as refused:
        read(path)
    assert words in str(refused.value)
    line = int(str(refused.value).split("drivetrain.toml:")[1].split(":")[0])
    assert new.split(" = ")[0].strip() in path.read_text(encoding="utf-8").splitlines()[line - 1] or "sets" in words


def test_an_impact_needs_a_hit() -> None:
    study = giveway.Study("push", duration=0.3).vary(INERTIA, values=[0.02, 0.05]).objective("impact force")
    with pytest.raises(
        giveway.GivewayError, match=r"objective\[0\]\.metric: impact force .* without \[\[collision\]\]"
    ):
        study.setup()


def test_the_made_up_gear_motors_are_of_one_piece() -> None:
    """Everything at the axle grows with the ratio as gears have it: inertia with its square, counts with it."""
    catalogue = read_catalogue(EXAMPLES / "catalogues" / "gear_motors_made_up.csv")
    parts = range(len(catalogue.names))
    ratio, inertia, counts = (catalogue.numbers("x", name, unit, parts) for name, unit in
                              (("ratio", "1"), ("inertia", "kg.m2"), ("counts", "1")))  # fmt: skip
    assert counts == pytest.approx(170.0 * ratio)
    assert inertia / ratio**2 == pytest.approx(2.09e-5, rel=0.05)  # a rotor, and what the gear adds


def test_the_example_has_real_trade_offs(tmp_path: Path) -> None:
    setup = read(EXAMPLES / "studies" / "drivetrain.toml")
    assert setup.derived == tuple(DRIVETRAIN)
    sweep(setup, tmp_path / "out", threads=1)
    answers = load(tmp_path / "out")
    best = answers.values[answers.pareto][:, : len(setup.objectives)]
    assert len(best) >= 5
    for j in range(len(setup.objectives)):
        # On the front nobody is the best of all, and each objective differs by more than 3 %.
        assert np.ptp(best[:, j]) > 0.03 * np.abs(best[:, j]).max()
