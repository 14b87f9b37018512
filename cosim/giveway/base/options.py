"""Options that commands of several rooms take."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from giveway.base import native

__all__ = ["DaskOption", "FmiOption", "RobotOption", "ThreadsOption"]

FmiOption = Annotated[int, typer.Option("--fmi", help="FMI version of the FMUs: 3 or 2.")]
ThreadsOption = Annotated[int | None, typer.Option("--threads", help="Native threads; without it: all processors.")]
DaskOption = Annotated[
    str | None,
    typer.Option(
        "--dask",
        metavar="ADDRESS",
        help='Runs go to the workers of this Dask scheduler; "local": to processes of this machine.',
    ),
]


def _robot_file(text: str) -> Path:
    return native.robot_file("--robot", text)


RobotOption = Annotated[
    Path | None,
    typer.Option(
        "--robot",
        metavar="FILE|NAME",
        help="Robot file (TOML), or the name of a shipped one: `giveway robot list`.",
        parser=_robot_file,
    ),
]
