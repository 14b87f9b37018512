"""What the controller is told of the motors that it observes between two counts of their encoders (gw_motor.h)."""

from __future__ import annotations

from pathlib import Path

import giveway
import numpy as np
import pytest
from cosim_helpers import Cli
from giveway import batch
from giveway.base import native
from giveway.base.errors import GivewayError
from giveway.detectability.causes import without_gears
from giveway.detectability.robots import subject
from giveway.firmware.config_source import config_source
from giveway.firmware.settings import Settings
from giveway.robot.motor_observer import BELIEFS, BUS, DELAY, INERTIA, delay_ticks, longest_delay
from giveway.robot.robot_file import read_robot
from giveway.robot.variables import table
from giveway.scenario.plan import Straight
from motor_current_robot import trikey_by_current

ROBOTS = sorted(native.robots())
SAME = {
    "motor.coulomb_torque": "drivetrain.gear_coulomb",
    "motor.kp": "servo.kp",
    "motor.kd": "servo.kd",
    "motor.torque_limit": "drivetrain.torque_limit",
    "motor.derivative_cutoff": "servo.derivative_cutoff",
}
TRIKEY = native.robot().read_text(encoding="utf-8")
CYCLE = "[electronics.bus_delay]\nvalue = 1\n"
HERE = "[electronics.bus_delay]"
MINE = f'[controller.motor.inertia]\nvalue = {{}}\nunit = "kg.m2"\n\n{HERE}'


def changed(folder: Path, *changes: tuple[str, str]) -> Path:
    text = TRIKEY
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    path = folder / "mine.toml"
    path.write_text(text, encoding="utf-8")
    return path


def known(path: Path) -> dict[str, float | int | bool]:
    return table("controller").robot_values(read_robot(path))


@pytest.mark.parametrize("name", ROBOTS)
def test_each_robot_s_controller_knows_its_own_motors(name: str) -> None:
    robot = read_robot(native.robots()[name])
    testbed, controller = (table(model).robot_values(robot) for model in ("testbed", "controller"))
    assert {mine: controller[mine] for mine in SAME} == {mine: testbed[theirs] for mine, theirs in SAME.items()}
    ways = testbed["electronics.sensor_delay"], testbed["electronics.command_delay"]
    assert controller["motor.delay"] == sum(ways) + 1
    assert controller["motor.inertia"] == (0.0 if robot.motor_current else testbed["drivetrain.motor_inertia"])


def test_the_table_s_starts_are_trikey_s() -> None:
    assert table("controller")["motor.delay"].start == known(native.robot())["motor.delay"]


def test_by_motor_current_nothing_stands_behind_the_gear(tmp_path: Path) -> None:
    robot = read_robot(trikey_by_current(tmp_path))
    assert table("controller").robot_values(robot)["motor.inertia"] == 0.0
    assert robot.follows_from(INERTIA) == "drivetrain.sensing"
    path = trikey_by_current(tmp_path, (HERE, MINE.format(0.01)))
    with pytest.raises(GivewayError, match=r"current\.toml:\d+: controller\.motor\.inertia: 0\.01 .*allowed: 0: with"):
        read_robot(path)
    assert known(trikey_by_current(tmp_path, (HERE, MINE.format(0.0))))["motor.inertia"] == 0.0


@pytest.mark.parametrize("cycles", [0, 2, 3])
def test_the_delay_follows_from_the_bus(cycles: int, tmp_path: Path) -> None:
    robot = read_robot(changed(tmp_path, (CYCLE, CYCLE.replace("1", str(cycles)))))
    values = table("controller").robot_values(robot)
    assert (values["motor.delay"], values["motor.inertia"]) == (2 * cycles + 1, 0.0523)
    assert robot.follows_from(DELAY) == BUS
    assert type(values["motor.delay"]) is int


def test_a_bus_that_is_too_slow_leaves_the_counts_as_they_are(tmp_path: Path) -> None:
    slow = (CYCLE, CYCLE.replace("1", "4"))
    robot = read_robot(changed(tmp_path, slow))
    assert delay_ticks(4, 4) > longest_delay() == table("controller")["motor.delay"].maximum
    assert table("controller").robot_values(robot)["motor.inertia"] == 0.0
    assert robot.follows_from(INERTIA) == BUS
    batch.run(giveway.Scenario("slow", 0.05, bumper="none", robot=robot.path))  # it is a robot like others
    with pytest.raises(GivewayError, match=r"motor\.inertia: 0\.05 kg\.m2 .* a command shows 9 ticks later"):
        read_robot(changed(tmp_path, slow, (HERE, MINE.format(0.05))))
    own = f'[controller.motor.delay]\nvalue = 8\nunit = "1"\n\n{HERE}'
    values = known(changed(tmp_path, slow, (HERE, own)))  # who states it knows it
    assert (values["motor.delay"], values["motor.inertia"]) == (8, 0.0523)


def test_half_a_cycle_is_refused_by_its_line(tmp_path: Path) -> None:
    with pytest.raises(GivewayError, match=r"mine\.toml:\d+: .*a whole number from 1 to 8"):
        known(changed(tmp_path, (CYCLE, CYCLE.replace("1", "1.2"))))


def test_a_file_may_state_what_the_controller_believes_of_the_motors(tmp_path: Path) -> None:
    text = '[controller.motor.kp]\nvalue = 0.15\nunit = "kN.m/rad"\n\n' + MINE.format(0.0)
    path = changed(tmp_path, (HERE, text))
    assert known(path)["motor.kp"] == 150.0
    assert known(path)["motor.inertia"] == 0.0
    testbed = table("testbed").robot_values(read_robot(path))
    assert (testbed["servo.kp"], testbed["drivetrain.motor_inertia"]) == (189.0, 0.0523)
    # All of them, and nothing else that is a number of the robot.
    names = [one.name for one in table("controller").select("parameter") if one.name.startswith(BELIEFS)]
    for name in names:
        unit = table("controller")[name].unit or "1"
        own = f'[controller.{name}]\nvalue = 2\nunit = "{unit}"\n\n{HERE}'
        assert known(changed(tmp_path, (HERE, own)))[name] == 2
    wheel = f'[controller.base.wheel_inertia]\nvalue = 2\nunit = "kg.m2"\n\n{HERE}'
    with pytest.raises(GivewayError, match=r"controller\.base: base is unknown"):
        read_robot(changed(tmp_path, (HERE, wheel)))


def test_the_paper_s_reflex_observes_none() -> None:
    for robot in (None, native.robots()["delivery"]):
        paper = giveway.Scenario("paper", 1.0, robot=robot, preset="paper").parameters("controller")
        assert paper["motor.inertia"] == 0.0


@pytest.mark.parametrize(("there", "back"), [(1, 1), (0, 2), (3, 3), (0, 0)])
def test_a_command_shows_when_the_controller_is_told(there: int, back: int) -> None:
    """By motor current the servo's torque is the signal, and it answers a command at once."""
    testbed = {"drivetrain.sensing": 1, "electronics.torque_noise": 0.0, "electronics.torque_resolution": 0.0,
               "electronics.sensor_delay": there, "electronics.command_delay": back,
               "slider.present": False, "rope.attached": False}  # fmt: skip
    plan = Straight(0.2, 0.5, acceleration_mps2=1.0)
    drive = giveway.Scenario("drive", 0.3, bumper="none", testbed=testbed, plan=plan, preset="paper")
    traces = batch.run(drive).traces
    command, sensed = (
        np.flatnonzero(np.diff(traces[name].values) != 0.0)
        for name in ("controller.command.wheel_speed[0]", "testbed.sensor.torque[0]")
    )
    assert sensed[0] - command[0] == delay_ticks(there, back)


def test_a_firmware_says_where_it_knows_the_motors_from() -> None:
    words = {}
    for name in ROBOTS:
        text = " ".join(config_source(Settings.of(native.robots()[name])).replace("\n     *", "").split())
        words[name] = text
    assert "From delivery.toml, drivetrain.motor_inertia: " in words["delivery"]
    assert ".estimator.motor.inertia_kgm2 = 0.0375F," in words["delivery"]
    for name in ("robotino", "lekiwi"):
        assert f"From {name}.toml, controller.motor.inertia: " in words[name]
        assert "follows from drivetrain.sensing: " in words[name]
        assert ".estimator.motor.inertia_kgm2 = 0.0F," in words[name]
    assert "follows from electronics.bus_delay: half-duplex serial bus" in words["lekiwi"]
    assert ".estimator.motor.delay_ticks = 5U," in words["lekiwi"]
    paper = config_source(Settings.of(native.robots()["delivery"], "paper"))
    assert ".estimator.motor.inertia_kgm2 = 0.0F," in paper


def test_without_gears_the_controller_knows_that_motors_turn_freely() -> None:
    for name in ("trikey", "robotino"):
        assert without_gears(subject(native.robots()[name])).controller["motor.coulomb_torque"] == 0.0


def test_a_replay_says_whether_motors_are_observed(cli: Cli, tmp_path: Path) -> None:
    done = cli("run", "motionless", "--duration", "0.3", "--engine", "native", "--out", "out", "--log", "log.csv")
    assert done.returncode == 0, done.stderr
    told = [cli("replay", "log.csv", "--out", f"again{i}", *more).stdout for i, more in
            enumerate(((), ("--observe",), ("--robot", "robotino")))]  # fmt: skip
    lines = [[line.split(maxsplit=1)[1] for line in text.splitlines() if line.startswith("motors ")] for text in told]
    assert lines == [["between counts, if they follow the commands"], ["counts as they are: no commands"], []]
