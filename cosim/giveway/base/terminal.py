"""Terminal output of the commands: tables, and progress bars on stderr."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import typer

__all__ = [
    "FAILED",
    "INTERRUPTED",
    "WRONG_INPUT",
    "print_columns",
    "print_warnings",
    "progress_bar",
    "progress_bars",
    "working",
]

FAILED, WRONG_INPUT, INTERRUPTED = 1, 2, 130  # exit codes; the last: Ctrl-C ended it


def print_columns(title: str, header: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> None:
    """A table on stdout."""
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    terminal = Console(highlight=False)
    # A pipe has no width limit: there every row stays on one line.
    console = terminal if terminal.is_terminal else Console(highlight=False, width=1000)
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for index, name in enumerate(header):
        table.add_column(name, no_wrap=index == 0, overflow="fold")
    for row in rows:
        table.add_row(*(Text(cell) for cell in row))
    console.print(title, style="bold")
    console.print(table)


def print_warnings(lines: Sequence[str]) -> None:
    """Deviations from the request, one line each below "Warnings"; nothing if there are none."""
    if lines:
        typer.secho("Warnings", bold=True)
    for line in lines:
        typer.echo(f"  {line}")
    if lines:
        typer.echo()


@contextmanager
def progress_bar(title: str) -> Iterator[Callable[[float, float], None] | None]:
    """A bar on stderr at a terminal, for (simulated time, duration) in s; nothing elsewhere."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (BarColumn(), TextColumn("{task.completed:.2f} of {task.total:g} s"), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(title, total=None)
        yield lambda now_s, duration_s: bar.update(task, completed=now_s, total=duration_s)


@contextmanager
def working(name: str) -> Iterator[Callable[[float], None]]:
    """One bar of `progress_bars` for a single task; call the yielded function with the finished share."""
    with progress_bars((name,)) as progress:
        progress(name, 0.0)
        yield lambda share: progress(name, share)
        progress(name, 1.0)


@contextmanager
def progress_bars(names: Sequence[str]) -> Iterator[Callable[[str, float], None]]:
    """One progress bar per part of the work on stderr at a terminal, otherwise a line when a part begins.

    Call the yielded function with the part's name and its finished share, 0 to 1.
    """
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    if not sys.stderr.isatty():
        begun: set[str] = set()

        def say(name: str, _share: float) -> None:
            if name not in begun:
                begun.add(name)
                number = f"[{len(begun)} of {len(names)}] " if len(names) > 1 else ""
                typer.echo(f"{number}{name}", err=True)

        yield say
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.percentage:3.0f} %"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=Console(stderr=True)) as bars:
        tasks = {name: bars.add_task(name, total=1.0, start=False) for name in names}

        def draw(name: str, share: float) -> None:
            bars.start_task(tasks[name])
            bars.update(tasks[name], completed=share)

        yield draw
