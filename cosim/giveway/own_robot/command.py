"""The commands `giveway robot new`, `check` and `list`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from giveway.base import native
from giveway.base.terminal import WRONG_INPUT, print_columns, print_written, wants_json

if TYPE_CHECKING:
    from giveway.own_robot.checked import Checked
    from giveway.own_robot.measured import Question

__all__ = ["robot_app"]

robot_app = typer.Typer(name="robot", help="Robot files: write a new one, check one, list the shipped ones.")


def _flag(name: str, words: str) -> typer.models.OptionInfo:
    option: typer.models.OptionInfo = typer.Option(f"--{name}", metavar="TEXT", help=words)
    return option


@robot_app.command("new")
def new(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Robot file (TOML) to write.")],
    name: Annotated[
        str | None, typer.Option("--name", help="What the robot is called; without it: as the file.")
    ] = None,
    mass: Annotated[str | None, _flag("mass", 'Needed: "34.7 kg", "76 lb"; a number alone is in SI units.')] = None,
    wheel_radius: Annotated[str | None, _flag("wheel-radius", 'Needed: "4 in", "101.6 mm", 0.1016')] = None,
    wheel_distance: Annotated[str | None, _flag("wheel-distance", "Needed: from the centre to the wheels.")] = None,
    outline: Annotated[
        str | None,
        _flag("outline", 'Needed: "circle 0.45", "triangle 0.61", "rectangle 0.5 x 0.4", corners "x,y x,y x,y", in m.'),
    ] = None,
    height: Annotated[str | None, _flag("height", "Needed: of the body's top above the floor.")] = None,
    clearance: Annotated[str | None, _flag("clearance", "Lowest height of the body.")] = None,
    com_height: Annotated[str | None, _flag("com-height", "Height of the centre of mass.")] = None,
    torque_limit: Annotated[str | None, _flag("torque-limit", "Of a drive, at its wheel.")] = None,
    gear_friction: Annotated[str | None, _flag("gear-friction", "At the wheel, unpowered.")] = None,
    torque_noise: Annotated[str | None, _flag("torque-noise", "Of the torque sensor at 1 kHz.")] = None,
    encoder_counts: Annotated[str | None, _flag("encoder-counts", "Per turn of the wheel.")] = None,
    torque_constant: Annotated[
        str | None, _flag("torque-constant", 'Of the motor, if its current is the torque sensor: "0.04 N.m/A".')
    ] = None,
    gear_ratio: Annotated[str | None, _flag("gear-ratio", "Of that motor to the wheel.")] = None,
    imu: Annotated[bool, typer.Option("--imu", help="It has accelerometer and gyro.")] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace FILE if it is there.")] = False,
) -> None:
    """Write a commented robot file: asks at a terminal for what no flag says; the rest is estimated and says so."""
    from giveway.base.errors import FileError, GivewayError
    from giveway.base.files import check_file, replace_file
    from giveway.own_robot.checked import check
    from giveway.own_robot.measured import measured
    from giveway.own_robot.new_file import robot_text

    if file.suffix != ".toml":
        raise GivewayError("FILE", file, "a file ending in .toml")
    check_file(file)
    if file.exists() and not force:
        raise FileError(file, "is there already", "give another name, or --force to replace it")
    answers = {
        **{"mass": mass, "wheel-radius": wheel_radius, "wheel-distance": wheel_distance, "outline": outline},
        **{"height": height, "clearance": clearance, "com-height": com_height, "torque-limit": torque_limit},
        **{"gear-friction": gear_friction, "torque-noise": torque_noise, "encoder-counts": encoder_counts},
        **{"torque-constant": torque_constant, "gear-ratio": gear_ratio},
    }
    asked = measured(name or file.stem, answers, imu, _ask if sys.stdin.isatty() else lambda _question: None)
    with replace_file(file) as temporary:
        temporary.write_text(robot_text(asked), encoding="utf-8")
        checked = check(temporary)
        if not checked.usable:
            raise GivewayError("giveway robot new", checked.refused.replace(str(temporary), str(file)), "other sizes")
    print_written(file)
    _say(check(file), brief=True)


def _ask(question: Question) -> str | None:
    """The answer at the terminal, asked again until it can be used; None: not known."""
    from giveway.base.errors import GivewayError

    unit = f" [{question.unit}]" if question.unit not in ("", "1") else ""
    while True:
        asked = f"{question.text}{unit}" + ("" if question.needed else f" (empty: {question.otherwise})")
        text = str(typer.prompt(asked, default="", err=True))
        if not text.strip():
            if not question.needed:
                return None
            continue
        try:
            question.read(f"--{question.key}", text)
        except GivewayError as error:
            typer.echo(str(error), err=True)
            continue
        return text


@robot_app.command("check")
def check_file_of_robot(
    file: Annotated[str, typer.Argument(metavar="FILE|NAME", help="Robot file (TOML), or a shipped robot.")],
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE", help="Page with drawing (.html), or the drawing (.svg, .png)."),
    ] = None,
) -> None:
    """Say what is missing, implausible or assumed in a robot file; exit code 2 if it cannot be used."""
    from giveway.base.files import check_file
    from giveway.own_robot.checked import check
    from giveway.own_robot.page import check_ending, write

    if out is not None:
        check_ending("--out", out)
        check_file(out)
    checked = check(native.robot_file("FILE", file))
    _say(checked)
    if not checked.usable:
        raise typer.Exit(WRONG_INPUT)
    if out is not None:
        write(out, checked)
        print_written(out)


def _say(checked: Checked, brief: bool = False) -> None:
    """What was found, on the terminal; ``brief``: without the list of what is assumed."""
    from giveway.base.words import counted
    from giveway.own_robot.page import summary

    path = checked.robot.path
    if checked.missing:
        print_columns(f"Missing in {path}", ("entry", "unit"), list(checked.missing))
        missing = counted(len(checked.missing), "number")
        typer.echo(f"giveway: {path}: cannot be used: {missing} missing", err=True)
        return
    if checked.refused:
        typer.echo(f"giveway: {checked.refused}", err=True)
        return
    for line, doubt in checked.doubts:
        typer.echo(f"{path}:{line}: {doubt.rule}: {doubt.words} ({', '.join(doubt.entries)})")
    uncertain = checked.uncertain()
    if uncertain and not brief:
        rows = [
            (name, entry.text, entry.provenance or "-", entry.confidence or "-", entry.source)
            for name, entry in uncertain
        ]
        header = ("entry", "value", "provenance", "confidence", "source")
        print_columns("Assumed, or of low confidence", header, rows)
    typer.echo(f"{path.name}: can be used; {summary(checked)}")


@robot_app.command("list")
def list_robots() -> None:
    """List the shipped robots: `--robot NAME` takes each of them."""
    from giveway.robot.robot_file import read_robot

    found = {name: read_robot(path) for name, path in native.robots().items()}
    if wants_json():
        rows = [(name, robot.name, f"{robot.value('base.mass'):g}") for name, robot in found.items()]
        print_columns("Shipped robots", ("name", "robot", "mass, kg"), rows)
        return
    for name, robot in found.items():
        typer.echo(f"{name}: {robot.name}, {robot.value('base.mass'):g} kg")
