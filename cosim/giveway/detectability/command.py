"""The command `giveway detectability`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from giveway.base import native
from giveway.base.options import ThreadsOption
from giveway.base.terminal import print_columns, print_written, progress_bars

__all__ = ["detectability"]


def detectability(
    robot: Annotated[
        str, typer.Argument(metavar="[FILE|NAME]", help="Robot file (TOML), or the name of a shipped one.")
    ] = "trikey",
    robots: Annotated[int, typer.Option("--robots", help="Robots that differ from the file.")] = 40,
    directions: Annotated[int, typer.Option("--directions", help="Sides from which they are pushed.")] = 6,
    speed: Annotated[float, typer.Option("--speed", metavar="M/S", help="Of the robots in motion.")] = 0.2,
    hours: Annotated[float, typer.Option("--hours", help="Of free motion, for the rate of false alarms.")] = 4.0,
    rate: Annotated[
        float,
        typer.Option("--false-alarms", metavar="PER_HOUR", help="Wished rate: thresholds are raised until it is kept."),
    ] = 1.0,
    assignments: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="MODEL.NAME=VALUE", help="Set a parameter."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder for table.json, smallest.csv and polar.png.")
    ] = None,
    threads: ThreadsOption = None,
) -> None:
    """The smallest push and impulse that a robot notices all around, at rest and in motion, and what limits them."""
    from giveway.base.checks import whole
    from giveway.base.files import check_output, replace_folder
    from giveway.detectability.found import Asked, detect, parts
    from giveway.detectability.record import HEADER, cause_rows, remarks, rows, title, write_csv, write_json
    from giveway.detectability.robots import subject
    from giveway.library.batch_library import THREADS_MAX
    from giveway.library.work import default_threads
    from giveway.robot.variables import parse_assignments

    asked = Asked(robots, directions, speed, hours, rate)
    used = default_threads() if threads is None else whole("--threads", threads, 1, THREADS_MAX)
    whose = subject(native.robot_file("ROBOT", robot), parse_assignments(assignments or []))
    if out is not None:
        check_output(out)
    with progress_bars(parts(asked)) as progress:
        found = detect(whose, asked, used, progress)
    print_columns(title(found), HEADER, rows(found.stated))
    if found.told is not found.stated:
        print_columns(f"With thresholds {found.told.factor:g} times as high", HEADER, rows(found.told))
    limits = "What limits the push at the middle: 95 % of directions and robots that are not alarmed by themselves"
    print_columns(limits, ("", "at rest", "in motion"), cause_rows(found))
    for line in remarks(found):
        typer.echo(line)
    if out is not None:
        from giveway.detectability.figure import write_figure

        with replace_folder(out) as folder:
            write_json(folder / "table.json", found)
            write_csv(folder / "smallest.csv", found)
            write_figure(folder / "polar.png", found)
        print_written(*(out / name for name in ("table.json", "smallest.csv", "polar.png")))
