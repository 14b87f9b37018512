"""Terminal output of the commands: tables, as text or JSON, and progress bars on stderr."""

from __future__ import annotations

import io
import json
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

import typer

if TYPE_CHECKING:
    from rich.console import Console

__all__ = [
    "DONE",
    "EXIT_CODES",
    "FAILED",
    "INTERRUPTED",
    "WRONG_INPUT",
    "begin_output",
    "console_on",
    "end_output",
    "is_quiet",
    "print_columns",
    "print_document",
    "print_warnings",
    "print_written",
    "progress_bar",
    "progress_bars",
    "shows_progress",
    "want_json",
    "want_quiet",
    "wants_json",
    "working",
]

DONE, FAILED, WRONG_INPUT, INTERRUPTED = 0, 1, 2, 130
EXIT_CODES = {
    DONE: "done",
    FAILED: "a run failed, a fault was found (`doctor`, `fmu check`), or a result could not be written",
    WRONG_INPUT: "wrong input: one line on stderr, nothing written",
    INTERRUPTED: "interrupted; computed results are kept",
}
"""All that a command may end with."""

SCHEMA_VERSION = 1  # of `--json`


@dataclass
class _Output:
    """What becomes of a command's output.

    Attributes:
        stdout: the real one, while another stands in its place; None: none does.
        json, quiet: the options of these names.
        tables, warnings, written: what the JSON document has; notes are what else was printed.
        answered: the command printed a document of its own.
    """

    stdout: TextIO | None = None
    json: bool = False
    quiet: bool = False
    tables: list[dict[str, Any]] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    written: list[str] = field(default_factory=list)
    answered: bool = False


_output = _Output()


def begin_output() -> None:
    """A command begins, with text on stdout unless an option says otherwise."""
    global _output
    _output = _Output()


def want_json() -> None:
    """Stdout gets one JSON document when the command ends, and nothing else."""
    _output.json = True
    _take_stdout()


def want_quiet() -> None:
    """No progress and nothing on stdout but a JSON document."""
    _output.quiet = True
    _take_stdout()


def wants_json() -> bool:
    return _output.json


def is_quiet() -> bool:
    return _output.quiet


def _take_stdout() -> None:
    if _output.stdout is None:
        _output.stdout, sys.stdout = sys.stdout, io.StringIO()


def end_output(answers: bool) -> None:
    """A command has ended: stdout is itself again; the JSON document is printed if it ``answers``."""
    if _output.stdout is None:
        return
    said = sys.stdout.getvalue() if isinstance(sys.stdout, io.StringIO) else ""
    sys.stdout, _output.stdout = _output.stdout, None
    if _output.json and answers and not _output.answered:
        notes = [line.strip() for line in said.splitlines() if line.strip()]
        found = {"tables": _output.tables, "warnings": _output.warnings, "notes": notes, "written": _output.written}
        typer.echo(json.dumps({"schema_version": SCHEMA_VERSION, **found}, indent=2))


def print_document(document: Any, indent: int | None = 2) -> None:
    """The answer of a command that has a JSON document of its own (or, without ``indent``, a line of it)."""
    _output.answered = True
    typer.echo(json.dumps(document, indent=indent), file=_output.stdout)
    (_output.stdout or sys.stdout).flush()


def print_written(*paths: Path, then: str = "") -> None:
    """The files that a command has written; ``then``: what to do with them."""
    if _output.json:
        _output.written += [str(path) for path in paths]
        if then:
            typer.echo(then)
        return
    *first, last = (str(path) for path in paths)
    typer.echo(f"Written: {', '.join(first)}{' and ' if first else ''}{last}{'; ' if then else ''}{then}")


def console_on(stderr: bool = False, width: int | None = None) -> Console:
    """A console; escape codes only at a terminal, and no colours if NO_COLOR is set (no-color.org)."""
    from rich.console import Console

    colours = None if os.environ.get("NO_COLOR") else "auto"
    return Console(stderr=stderr, highlight=False, width=width, color_system=colours)  # type: ignore[arg-type]


def print_columns(title: str, header: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> None:
    """A table on stdout, or in the JSON document; a cell `table_document.Shown` keeps its number there."""
    if _output.json:
        from giveway.base.table_document import table_document

        _output.tables.append(table_document(title, header, rows))
        return
    if _output.quiet:
        return
    from rich.box import SIMPLE_HEAD
    from rich.table import Table
    from rich.text import Text

    terminal = console_on()
    # A pipe has no width limit: there every row stays on one line.
    console = terminal if terminal.is_terminal else console_on(width=1000)
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for index, name in enumerate(header):
        table.add_column(name, no_wrap=index == 0, overflow="fold")
    for row in rows:
        table.add_row(*(Text(cell) for cell in row))
    console.print(title, style="bold")
    console.print(table)


def print_warnings(lines: Sequence[str]) -> None:
    """Deviations from the request, one line each below "Warnings"; nothing if there are none."""
    if _output.json:
        _output.warnings += lines
        return
    if lines:
        console_on().print("Warnings", style="bold")
    for line in lines:
        typer.echo(f"  {line}")
    if lines:
        typer.echo()


def shows_progress() -> bool:
    """Whether progress is drawn as bars; otherwise lines tell it, and none with `--quiet`."""
    return sys.stderr.isatty() and not _output.quiet


@contextmanager
def progress_bar(title: str) -> Iterator[Callable[[float, float], None] | None]:
    """A bar on stderr at a terminal, for (simulated time, duration) in s; nothing elsewhere."""
    if not shows_progress():
        yield None
        return
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (BarColumn(), TextColumn("{task.completed:.2f} of {task.total:g} s"), TimeRemainingColumn())
    with Progress(*columns, console=console_on(stderr=True), transient=True) as bar:
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
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    if not shows_progress():
        begun: set[str] = set()

        def say(name: str, _share: float) -> None:
            if name not in begun and not _output.quiet:
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
    with Progress(*columns, console=console_on(stderr=True)) as bars:
        tasks = {name: bars.add_task(name, total=1.0, start=False) for name in names}

        def draw(name: str, share: float) -> None:
            bars.start_task(tasks[name])
            bars.update(tasks[name], completed=share)

        yield draw
