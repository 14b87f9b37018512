"""Options that commands of several rooms take."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["FmiOption", "RobotOption"]

FmiOption = Annotated[int, typer.Option("--fmi", help="FMI version of the FMUs: 3 or 2.")]
RobotOption = Annotated[Path | None, typer.Option("--robot", metavar="FILE", help="Robot file (TOML).")]
