"""The command `giveway calibrate`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from giveway.base.terminal import print_columns, print_written

__all__ = ["calibrate"]


def calibrate(
    logs: Annotated[
        list[Path], typer.Argument(metavar="LOG...", help="Logs of free motion, CSV or Parquet: arcs, without contact.")
    ],
    robot: Annotated[
        str,
        typer.Option("--robot", metavar="FILE|NAME", help="Robot file (TOML) of the logs' robot, or a shipped one."),
    ],
    out: Annotated[Path, typer.Option("--out", metavar="NEW.toml", help="The new robot file; NEW.png lies beside it.")],
) -> None:
    """Fit the roller friction to logs of wheel angles and torques; write a new robot file and a residual plot."""
    from giveway.base import native
    from giveway.identification.calibrated_robot import calibrate_robot, table_rows

    calibration, written = calibrate_robot(logs, native.robot_file("--robot", robot), out)
    title = f"Roller friction (28) from {', '.join(log.name for log in calibration.logs)}"
    print_columns(title, ("", "value", "95 % interval", "unit"), table_rows(calibration))
    print_written(*written)
