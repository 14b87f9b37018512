"""Options that commands of several rooms take."""

from __future__ import annotations

from collections.abc import Container
from pathlib import Path
from typing import Annotated

import typer

from giveway.base import native
from giveway.base.errors import GivewayError
from giveway.base.output_options import OUTPUT_OPTIONS

__all__ = ["DaskOption", "FmiOption", "RobotOption", "ThreadsOption", "refuse_stated"]

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


def refuse_stated(context: typer.Context, allowed: str, names: Container[str] | None = None) -> None:
    """No option is left aside in silence: GivewayError if one of ``names`` (default: any) is on the command line.

    ``names`` are as the user writes them, ``"--hours"``; ``allowed`` is the error's. Those of the output may stand
    anywhere.
    """
    for option in context.command.params:
        name = option.name or ""
        source = context.get_parameter_source(name)
        stated = source is not None and source.name == "COMMANDLINE" and name not in OUTPUT_OPTIONS
        if stated and (names is None or option.opts[0] in names):
            raise GivewayError(option.opts[0], context.params[name], allowed)
