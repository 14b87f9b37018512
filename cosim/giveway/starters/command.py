"""The commands `giveway new scenario`, `new study` and `new robot`, which is `giveway robot new`."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Annotated

import typer

from giveway.base.terminal import print_written
from giveway.own_robot.command import new

__all__ = ["new_app"]

new_app = typer.Typer(name="new", help="Write a commented file to start from.", no_args_is_help=True)

_Robot = Annotated[
    str | None, typer.Option("--robot", metavar="FILE|NAME", help="Robot file (TOML), or the name of a shipped one.")
]
_Target = Annotated[Path | None, typer.Argument(metavar="[FILE]", help="What to write; it must not be there yet.")]


@new_app.command()
def scenario(file: _Target = None, robot: _Robot = None) -> None:
    """Write a scenario file with its usual keys: what the robot does, what collides with it, pushes, parameters."""
    _write("scenario", file, robot, "giveway run {file} --out out/first")


@new_app.command()
def study(file: _Target = None, robot: _Robot = None) -> None:
    """Write a study file with its usual tables: designs, tolerances, objectives, limits."""
    _write("study", file, robot, "giveway sweep {file}")


new_app.command("robot")(new)


def _write(kind: str, given: Path | None, robot: str | None, use: str) -> None:
    from giveway.base.errors import FileError
    from giveway.base.files import check_file, write_text

    file = given or Path(f"{kind}.toml")
    check_file(file)
    if file.exists():
        raise FileError(file, "is there already", "give another name")
    if file.suffix != ".toml":
        raise FileError(file, "is no name of a TOML file", f"give one that ends in .toml, such as {kind}.toml")
    text = (Path(__file__).parent / f"{kind}.toml").read_text(encoding="utf-8").replace("FILE", str(file))
    if robot is not None:
        text = text.replace(
            '# robot = "ROBOT.toml" ', f"robot = {json.dumps(_robot(robot, file), ensure_ascii=False)} "
        )
    write_text(file, text)
    print_written(file, then=f"run it with: {use.format(file=file)}")


def _robot(stated: str, file: Path) -> str:
    """The robot as ``file`` names it: a shipped one by its name, a path seen from there."""
    from giveway.base import native
    from giveway.robot.robot_file import read_robot

    path = native.robot_file("--robot", stated)
    read_robot(path)  # refuses what is none
    if path in native.robots().values():
        return stated
    return Path(os.path.relpath(path, file.parent)).as_posix()
