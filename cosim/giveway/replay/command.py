"""The command `giveway replay`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from giveway.base.errors import GivewayError, UnknownNameError
from giveway.base.options import RobotOption, refuse_stated
from giveway.base.terminal import INTERRUPTED

if TYPE_CHECKING:
    from giveway.replay.mapping import Wishes
    from giveway.replay.play import Choice
    from giveway.replay.source import Source

__all__ = ["replay"]

ANGLES = ("motor", "wheel")
EFFORTS = ("torque", "current")
OF_ROS = ("--joints", "--topic", "--angles", "--efforts")


def replay(
    context: typer.Context,
    log: Annotated[
        Path | None,
        typer.Argument(metavar="LOG", help="CSV, Parquet, MCAP, or rosbag2 (folder or .db3); none with --follow."),
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", metavar="DIR", help="Folder for report, Parquet, MCAP.")] = None,
    robot: RobotOption = None,
    preset: Annotated[str | None, typer.Option("--preset", help="The controller's reflex: default, or paper.")] = None,
    assignments: Annotated[
        list[str] | None, typer.Option("--set", metavar="controller.NAME=VALUE", help="Set one of its parameters.")
    ] = None,
    columns: Annotated[
        Path | None, typer.Option("--columns", metavar="FILE", help="TOML that says which column is what.")
    ] = None,
    column: Annotated[
        list[str] | None, typer.Option("--column", metavar="QUANTITY=COLUMN", help='torque_1="-tau_b \\[mN.m]"')
    ] = None,
    joints: Annotated[
        str | None, typer.Option("--joints", metavar="A,B,C", help="ROS: the wheels' joints, in their order.")
    ] = None,
    topic: Annotated[str | None, typer.Option("--topic", help="ROS: the joint states, if there are several.")] = None,
    angles: Annotated[str, typer.Option("--angles", help="ROS: positions are of the motor or of the wheel.")] = "motor",
    efforts: Annotated[str, typer.Option("--efforts", help="ROS: efforts are a torque or a current.")] = "torque",
    torque_constant: Annotated[
        float | None, typer.Option("--torque-constant", metavar="NM/A", help="At the wheel, for currents.")
    ] = None,
    encoder_bits: Annotated[int, typer.Option("--encoder-bits", help="At which counts wrap.")] = 32,
    resample: Annotated[str, typer.Option("--resample", help="auto, as-is, linear, hold or rows.")] = "auto",
    observe: Annotated[
        bool, typer.Option("--observe/--react", help="Drives off: for a log in which the robot only stands; or on.")
    ] = False,
    every_output: Annotated[
        bool, typer.Option("--every-output", help="Every output of the controller in replay.parquet.")
    ] = False,
    follow: Annotated[
        bool, typer.Option("--follow", help="Read CSV lines on standard input; print detections as they happen.")
    ] = False,
) -> None:
    """Play a log of wheel angles and torques through the controller; report, every step as Parquet, MCAP."""
    from giveway.replay.mapping import read_wishes
    from giveway.replay.play import is_of_ros, open_log

    if follow or (log is not None and log.exists() and not is_of_ros(log)):
        refuse_stated(context, "only for ROS (.mcap, .db3 or its folder); other logs name their columns", OF_ROS)
    wishes = read_wishes(columns, column or (), joints)
    for name, value, known in (("--angles", angles, ANGLES), ("--efforts", efforts, EFFORTS)):
        if value not in known:
            raise UnknownNameError(name, value, known)
    extra = _Extra(wishes, robot, preset, tuple(assignments or ()), resample, torque_constant, encoder_bits, observe)
    if follow:
        from giveway.replay.follow import follow_lines

        if log is not None or out is not None:
            raise GivewayError("--follow", log or f"--out {out}", "neither LOG nor --out: lines come on standard input")
        follow_lines(wishes, extra.choice)
        return
    if log is None or out is None:
        missing, what = ("LOG", "the path of a log") if log is None else ("--out", "a folder to write to")
        raise GivewayError(missing, "nothing", f"{what}, or --follow")
    source = open_log(log, wishes, topic, f"{angles}_angle", efforts)
    from giveway.replay.written_folder import play_into

    ended = play_into(out, source, wishes, *extra.choice(source), every_output)
    if ended:
        raise typer.Exit(INTERRUPTED)


class _Extra:
    """The options that make a `Choice`."""

    def __init__(
        self,
        wishes: Wishes,
        robot: Path | None,
        preset: str | None,
        assignments: tuple[str, ...],
        way: str,
        torque_constant: float | None,
        encoder_bits: int,
        observe: bool,
    ) -> None:
        from giveway.base.checks import finite, whole
        from giveway.replay.sampling import RESAMPLING

        if way not in RESAMPLING:
            raise UnknownNameError("--resample", way, RESAMPLING)
        if torque_constant is not None:
            finite("--torque-constant", torque_constant, -1e4, 1e4, "N.m/A")
        whole("--encoder-bits", encoder_bits, 8, 32)
        self._wishes, self._robot, self._preset, self._assignments = wishes, robot, preset, assignments
        self._way, self._constant, self._bits, self._observe = way, torque_constant, encoder_bits, observe

    def choice(self, source: Source) -> tuple[Choice, str]:
        """How to play ``source``, and where the controller's parameters come from, in words."""
        from giveway.replay.mapping import choose
        from giveway.replay.play import Choice
        from giveway.robot.presets import DEFAULT, check_preset, preset_values
        from giveway.robot.robot_file import read_robot
        from giveway.robot.variables import parse_assignments, table

        overrides = parse_assignments(list(self._assignments))
        if overrides["testbed"]:
            raise GivewayError("--set", f"testbed.{next(iter(overrides['testbed']))}", "parameters of the controller")
        variables, origin = table("controller"), source.origin
        constant = self._constant
        if constant is not None and choose(source, self._wishes).torque != "current":
            raise GivewayError("--torque-constant", constant, "only for a log of currents: this one has torques")
        if self._robot is None:
            if origin.parameters is None:
                allowed = "the robot file of the log's robot; only a log of `giveway run --log` has its own"
                raise GivewayError("--robot", "nothing", allowed)
            if self._preset is not None:
                raise GivewayError("--preset", self._preset, "only with --robot: the log has the run's parameters")
            parameters, words = dict(origin.parameters), "the log's own, as in the run"
        else:
            preset = self._preset or DEFAULT
            check_preset(preset, "--preset")
            robot = read_robot(self._robot)
            parameters = variables.robot_values(robot) | preset_values(preset)
            words = f"{self._robot.name}{f' ({robot.name})' if robot.name else ''}, preset {preset}"
            stated = {name for name, _ in robot.entries()}
            if constant is None and {"motor.torque_constant", "motor.gear_ratio"} <= stated:
                constant = float(robot.value("motor.torque_constant")) * float(robot.value("motor.gear_ratio"))
        parameters |= overrides["controller"]
        words += "".join(f", {name} = {value}" for name, value in overrides["controller"].items())
        period = parameters.get("controller.period", variables["controller.period"].start)
        step_s = float(period or 1e-3) if origin.step_s is None else origin.step_s
        return Choice(parameters, step_s, self._way, constant, self._bits, self._observe), words
