"""Torque from motor current: what a robot file states, what follows, and what the drives then sample."""

from __future__ import annotations

import math
from pathlib import Path

import giveway
import numpy as np
import pytest
from giveway import batch
from giveway.base import native
from giveway.base.errors import GivewayError
from giveway.robot.changes import NewValue, changed_robot
from giveway.robot.robot_file import read_robot
from giveway.robot.variables import table
from giveway.scenario.plan import Pushes, Straight, TimedPush
from motor_current_robot import trikey_by_current

QUIET = {"electronics.torque_noise": 0.0, "electronics.torque_resolution": 0.0}
STICTION_NM, COULOMB_NM, VISCOUS, RADIUS_M = 2.75, 2.75, 0.02, 0.1016


def test_the_torque_signal_follows_from_the_motors(tmp_path: Path) -> None:
    robot = read_robot(trikey_by_current(tmp_path))
    testbed, controller = (table(model).robot_values(robot) for model in ("testbed", "controller"))
    assert robot.motor_current
    assert testbed["drivetrain.sensing"] == 1
    per_ampere = 50.0 * 0.0433
    assert testbed["electronics.torque_noise"] == controller["estimator.torque_noise"] == per_ampere * 0.02
    assert testbed["electronics.torque_resolution"] == per_ampere * 0.005
    assert testbed["electronics.torque_range"] == controller["sensor_check.torque_limit"] == per_ampere * 12.0
    assert robot.follows_from("drivetrain.torque_noise") == "motor.current_noise"
    assert "drivetrain.torque_noise" not in dict(robot.entries())


def test_the_controller_is_told_of_gears_and_rotors(tmp_path: Path) -> None:
    robot = read_robot(trikey_by_current(tmp_path))
    testbed, controller = (table(model).robot_values(robot) for model in ("testbed", "controller"))
    assert controller["gear.coulomb_torque"] == testbed["drivetrain.gear_coulomb"] == COULOMB_NM
    assert controller["gear.viscous_damping"] == testbed["drivetrain.gear_viscous"] == VISCOUS
    both = testbed["wheel.inertia"] + testbed["drivetrain.motor_inertia"]
    assert controller["base.wheel_inertia"] == pytest.approx(both, rel=1e-15)
    assert robot.follows_from("controller.base.wheel_inertia") == "wheel.inertia and drivetrain.motor_inertia"
    by_sensor = table("controller").robot_values(read_robot(native.robot()))
    assert "gear.coulomb_torque" not in by_sensor
    assert by_sensor["base.wheel_inertia"] == testbed["wheel.inertia"]


def test_a_file_may_state_what_the_controller_believes(tmp_path: Path) -> None:
    own = '[controller.gear.coulomb_torque]\nvalue = 1.5\nunit = "N.m"\n\n[motor.gear_ratio]'
    robot = read_robot(trikey_by_current(tmp_path, ("[motor.gear_ratio]", own)))
    assert table("controller").robot_values(robot)["gear.coulomb_torque"] == 1.5
    assert table("testbed").robot_values(robot)["drivetrain.gear_coulomb"] == COULOMB_NM


def test_a_rotor_that_is_too_heavy_is_told_by_its_line(tmp_path: Path) -> None:
    path = trikey_by_current(tmp_path)
    text = path.read_text(encoding="utf-8")
    heavy = text.replace("[drivetrain.motor_inertia]\nvalue = 0.0523", "[drivetrain.motor_inertia]\nvalue = 11.0")
    assert heavy != text
    path.write_text(heavy, encoding="utf-8")
    with pytest.raises(GivewayError, match=r"by_current\.toml:\d+: .*from 0 to 10 kg\.m2"):
        table("controller").robot_values(read_robot(path))


def test_steady_motion_leaves_no_force_in_the_estimate() -> None:
    """The gears' friction is 27 N for each wheel; an encoder's counts make the servo's torque jump."""
    plan = Straight(0.2, 0.5 * math.pi, acceleration_mps2=0.6)
    own = {**QUIET, "slider.present": False, "rope.attached": False, "drivetrain.sensing": 1}
    knows = {"gear.coulomb_torque": COULOMB_NM, "gear.viscous_damping": VISCOUS}
    runs = [
        giveway.Scenario("drive", 2.0, bumper="none", testbed=own, plan=plan,
                         controller={"channels.fast_creep": 1000.0, "channels.fast_motion": 1000.0,
                                     "channels.slow_creep": 1000.0, "channels.slow_motion": 1000.0, **more})
        for more in ({}, knows)
    ]  # fmt: skip
    names = ("controller.estimate.force_x", "controller.estimate.force_y")
    found = batch.run_many(runs, traces=names)
    blind, knowing = np.hypot(*(found[name].values[:, -500:].mean(axis=1) for name in names))
    # Along the second wheel: two thirds of the friction of one, a third of the two others, twice that of one in all.
    assert blind == pytest.approx(2.0 * (COULOMB_NM + VISCOUS * 0.2 / RADIUS_M) / RADIUS_M, rel=0.1)
    assert knowing < 0.1 * blind


def test_units_of_current_are_converted(tmp_path: Path) -> None:
    amperes = trikey_by_current(tmp_path, ('value = 0.005\nunit = "A"', 'value = 5\nunit = "mA"'))
    value = read_robot(amperes).value("drivetrain.torque_sensor_resolution")
    assert value == pytest.approx(50.0 * 0.0433 * 0.005, rel=1e-15)


def test_a_file_from_before_has_torque_sensors(tmp_path: Path) -> None:
    text = native.robot().read_text(encoding="utf-8")
    start = text.index("[drivetrain.sensing]")
    (tmp_path / "old.toml").write_text(text[:start] + text[text.index("[drivetrain.torque_sensor_limit]") :])
    robot = read_robot(tmp_path / "old.toml")
    assert not robot.motor_current
    assert "drivetrain.sensing" not in table("testbed").robot_values(robot)


WRONG = {
    "unknown word": ('"motor current"', '"current"', "drivetrain.sensing.value: current is unknown"),
    "a number": ('"motor current"', "1", "drivetrain.sensing.value: 1"),
    "a unit": ('"motor current"', '"motor current"\nunit = "1"', "drivetrain.sensing.unit"),
    "no motor": ("[motor.gear_ratio]", "[robot.gear_ratio]", "robot.gear_ratio"),
    "one is missing": ('[motor.current_noise]\nvalue = 0.02\nunit = "A"', "", "motor.current_noise is missing"),
    "out of range": ("value = 0.0433", "value = 0.0", "motor.torque_constant.value: 0.0 is not allowed"),
    "another kind": ('value = 0.02\nunit = "A"', 'value = 0.02\nunit = "N.m"', "motor.current_noise.unit"),
    "both": (
        "[motor.gear_ratio]",
        '[drivetrain.torque_noise]\nvalue = 0.03\nunit = "N.m"\n\n[motor.gear_ratio]',
        "it follows from motor.current_noise",
    ),
    "too small a range for the plant": ("value = 12.0", "value = 0.01", "motor.current_range"),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_files_are_refused(case: str, tmp_path: Path) -> None:
    old, new, words = WRONG[case]
    path = trikey_by_current(tmp_path, (old, new))
    with pytest.raises(GivewayError) as caught:
        table("testbed").robot_values(read_robot(path))
    assert str(caught.value).startswith(f"{path}:")
    line = str(caught.value).removeprefix(f"{path}:").partition(":")[0]
    if case == "too small a range for the plant":  # told by the line that states it
        assert words in path.read_text().splitlines()[int(line) - 2]
    else:
        assert words in str(caught.value)


def test_what_follows_cannot_be_replaced(tmp_path: Path) -> None:
    path = trikey_by_current(tmp_path)
    with pytest.raises(GivewayError, match=r"drivetrain\.torque_noise cannot be replaced: it follows from motor"):
        changed_robot(path, {"drivetrain.torque_noise": NewValue(0.1, "a log", "fitted")})
    assert "value = 0.03\n" in changed_robot(path, {"motor.current_noise": NewValue(0.03, "a log", "fitted")})


def pushed(force_n: float, sensing: int, **testbed: object) -> giveway.Scenario:
    """At rest, in the direction in which each wheel carries its most: that of wheel 0's rolling."""
    push = Pushes((TimedPush(force_n, 0.5 * math.pi, 0.0, 0.0, 0.3, 2.0, 0.2),))
    own = {**QUIET, "slider.present": False, "rope.attached": False, "drivetrain.sensing": sensing, **testbed}
    quiet = {"detector.kind": 1, "detector.impulse_threshold": 1000.0}
    return giveway.Scenario("push", 1.0, bumper="none", testbed=own, controller=quiet, push=push)


TRACES = ("testbed.sensor.torque[0]", "testbed.truth.wheel_torque[0]", "testbed.truth.motor_torque[0]",
          "testbed.truth.gear_stuck[0]", "testbed.energy.residual", "testbed.truth.contact_impulse_x")  # fmt: skip


def test_a_push_below_the_gears_stiction_does_not_reach_the_motor() -> None:
    """Two thirds of the force are on wheel 0; a third of each of the others, at 60 deg."""
    breaks_away_n = 1.5 * STICTION_NM / RADIUS_M
    runs = [pushed(share * breaks_away_n, 1) for share in (0.9, 1.6)]
    found = batch.run_many([*runs, pushed(0.9 * breaks_away_n, 0)], traces=TRACES)
    felt, behind = (found[name].values for name in TRACES[:2])
    assert np.all(felt[0] == 0.0)  # not even a little
    assert found[TRACES[3]].values[0].all()
    assert np.abs(behind[0]).max() > 0.5 * STICTION_NM  # which a torque sensor shows
    assert np.abs(felt[2]).max() > 0.5 * STICTION_NM
    assert np.abs(felt[1]).max() > 0.3  # what the gear leaves of it
    assert np.abs(found["testbed.energy.residual"].values).max() < 1e-6
    # A cycle late, the torque of the half millisecond before; a row of the truth has the one before its servo tick.
    motor = found[TRACES[2]].values[1]
    assert felt[1][1:].tolist() == motor[:-1].tolist()


def test_in_steady_motion_the_gears_friction_is_in_it() -> None:
    plan = Straight(0.2, 0.5 * math.pi, acceleration_mps2=0.6)
    own = {**QUIET, "slider.present": False, "rope.attached": False}
    quiet = {"detector.kind": 1, "detector.impulse_threshold": 1000.0}
    runs = [
        giveway.Scenario(
            "drive", 2.0, bumper="none", testbed={**own, "drivetrain.sensing": s}, controller=quiet, plan=plan
        )
        for s in (0, 1)
    ]
    found = batch.run_many(runs, traces=TRACES)
    sensor, current = found[TRACES[0]].values[:, -500:].mean(axis=1)
    friction = COULOMB_NM + VISCOUS * 0.2 / RADIUS_M
    # Mean over half a second: the encoder's counts make the servo's torque jump.
    assert current - sensor == pytest.approx(friction, rel=0.02)


def test_a_start_in_motion_has_its_steady_current() -> None:
    found = batch.run_many([pushed(0.0, s, **{"start.vy": 0.2}) for s in (0, 1)], traces=TRACES)
    sensor, current = found[TRACES[0]].values[:, 0]
    assert current - sensor == pytest.approx(COULOMB_NM + VISCOUS * 0.2 / RADIUS_M, rel=1e-6)


def test_the_same_side_by_side() -> None:
    """Lanes sample the same current; only the plant's integration differs."""
    runs = [pushed(force, 1) for force in (20.0, 60.0, 90.0)]
    exact, fixed = (batch.run_many(runs, traces=TRACES, method=method) for method in ("event-exact", "fixed-step"))
    assert set(fixed["method"].values) == {"fixed-step"}
    felt = [one[TRACES[0]].values for one in (exact, fixed)]
    assert np.array_equal(felt[0][0], felt[1][0])  # stuck: nothing
    # An encoder's count more or less is 0.14 N m through kp, and 5 through kd for a tick.
    assert (
        np.abs(np.cumsum(felt[0] - felt[1], axis=1)).max() * 1e-3
        < 0.02 * np.abs(np.cumsum(felt[0], axis=1)).max() * 1e-3
    )
