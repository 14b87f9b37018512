"""The command `giveway calibrate`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from giveway.base.terminal import print_columns, print_written

__all__ = ["calibrate"]


def calibrate(
    logs: Annotated[
        list[Path], typer.Argument(metavar="LOG.csv...", help="Logs of free motion: arcs, without contact.")
    ],
    robot: Annotated[Path, typer.Option("--robot", metavar="FILE", help="Robot file (TOML) of the robot of the logs.")],
    out: Annotated[Path, typer.Option("--out", metavar="NEW.toml", help="The new robot file; NEW.png lies beside it.")],
) -> None:
    """Fit the roller friction to logs of wheel angles and torques; write a new robot file and a residual plot."""
    from giveway.identification.calibrated_robot import calibrate_robot, table_rows

    calibration, written = calibrate_robot(logs, robot, out)
    title = f"Roller friction (28) from {', '.join(log.name for log in calibration.logs)}"
    print_columns(title, ("", "value", "95 % interval", "unit"), table_rows(calibration))
    print_written(*written)
