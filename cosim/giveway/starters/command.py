"""The commands `giveway new scenario`, `new study` and `new robot`, which is `giveway robot new`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from giveway.base.terminal import print_written
from giveway.own_robot.command import new

__all__ = ["new_app"]

new_app = typer.Typer(name="new", help="Write a commented file to start from.", no_args_is_help=True)

_Target = Annotated[Path | None, typer.Argument(metavar="[FILE]", help="What to write; it must not be there yet.")]


@new_app.command()
def scenario(file: _Target = None) -> None:
    """Write a scenario file with its usual keys: what the robot does, what collides with it, pushes, parameters."""
    _write("scenario", file, "giveway run {file} --out out/first")


@new_app.command()
def study(file: _Target = None) -> None:
    """Write a study file with its usual tables: designs, tolerances, objectives, limits."""
    _write("study", file, "giveway sweep {file}")


new_app.command("robot")(new)


def _write(kind: str, given: Path | None, use: str) -> None:
    from giveway.base.errors import FileError
    from giveway.base.files import check_file, write_text

    file = given or Path(f"{kind}.toml")
    check_file(file)
    if file.exists():
        raise FileError(file, "is there already", "give another name")
    if file.suffix != ".toml":
        raise FileError(file, "is no name of a TOML file", f"give one that ends in .toml, such as {kind}.toml")
    text = (Path(__file__).parent / f"{kind}.toml").read_text(encoding="utf-8")
    write_text(file, text.replace("FILE", str(file)))
    print_written(file, then=f"run it with: {use.format(file=file)}")
