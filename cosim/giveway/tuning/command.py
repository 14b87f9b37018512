"""The command `giveway tune`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from giveway.base.options import ThreadsOption
from giveway.base.terminal import FAILED, print_columns, print_written, working

if TYPE_CHECKING:
    from giveway.tuning.tuned import Tuned

__all__ = ["tune"]


def tune(
    logs: Annotated[
        list[Path],
        typer.Argument(metavar="LOG...", help="Logs in which nothing touched the robot: CSV, Parquet, MCAP."),
    ],
    robot: Annotated[
        str,
        typer.Option("--robot", metavar="FILE|NAME", help="Robot file (TOML) of the logs' robot, or a shipped one."),
    ],
    false_alarms: Annotated[
        str, typer.Option("--false-alarms", metavar="RATE", help="At most so many, with 95 % confidence: 0.1/h.")
    ],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="NEW.toml", help="The robot file with all of it.")
    ] = None,
    report: Annotated[Path | None, typer.Option("--report", metavar="PAGE.html", help="The tables as a page.")] = None,
    pushes: Annotated[
        Path | None,
        typer.Option(
            "--pushes",
            metavar="FILE.csv",
            help="Times of pushes, since the first row of the log: start \\[s],end \\[s] (,log).",
        ),
    ] = None,
    columns: Annotated[
        Path | None, typer.Option("--columns", metavar="FILE", help="TOML that says which column is what.")
    ] = None,
    smallest: Annotated[
        bool, typer.Option("--smallest/--no-smallest", help="Also what is noticed then, by simulated pushes.")
    ] = True,
    threads: ThreadsOption = None,
) -> None:
    """Friction, noise and thresholds of your own robot from its logs, for a wished rate of false alarms."""
    from giveway.base import native
    from giveway.base.checks import whole
    from giveway.library.batch_library import THREADS_MAX
    from giveway.library.work import default_threads
    from giveway.replay.mapping import read_wishes
    from giveway.tuning.told import remarks, tables
    from giveway.tuning.tuned import tune_robot

    rate = rate_of(false_alarms)
    path = native.robot_file("--robot", robot)
    wishes = read_wishes(columns, (), None)
    used = default_threads() if threads is None else whole("--threads", threads, 1, THREADS_MAX)
    with working("tuning"):
        tuned, written = tune_robot(
            logs,
            path,
            rate,
            out,
            report,
            pushes=pushes,
            smallest=smallest,
            wishes=wishes,
            threads=used,
        )
    for title, header, rows in tables(tuned):
        print_columns(title, header, rows)
    for line in remarks(tuned):
        typer.echo(line)
    if written:
        print_written(*written)
    _end(tuned)


def _end(tuned: Tuned) -> None:
    if not tuned.keeps:
        raise typer.Exit(FAILED)


def rate_of(text: str) -> float:
    """``0.1/h``: false alarms per hour."""
    from giveway.base.errors import GivewayError

    number, slash, unit = text.partition("/")
    try:
        if slash and unit.strip() != "h":
            raise ValueError
        return float(number)
    except ValueError:
        raise GivewayError("--false-alarms", text, "a number per hour, such as 0.1/h") from None
