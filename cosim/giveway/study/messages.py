"""What `giveway sweep` and `giveway study` say: progress, what was done, what was written."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from giveway.base.terminal import console_on, is_quiet, shows_progress
from giveway.base.words import counted
from giveway.study.engine import Outcome, Progress, Report

if TYPE_CHECKING:
    from giveway.study.answers import Answers
    from giveway.study.runs import RunTable
    from giveway.study.setup import Setup

__all__ = ["CHOSEN", "REPORT", "SURE", "duration", "overview", "search_sizes", "showing", "sizes", "write_all"]

SAY_EVERY_S = 5.0  # without a terminal
CHOSEN, REPORT = "chosen designs", "report"  # what `write_all` does
SURE = "how sure"  # what `certainty.make_sure` does


@contextmanager
def showing(name: str) -> Iterator[Report]:
    """Progress on stderr with rate and time left: a bar at a terminal, else a line every few seconds."""
    if not shows_progress():
        said = time.monotonic()

        def say(progress: Progress) -> None:
            nonlocal said
            if is_quiet():
                return
            if progress.done == progress.runs or time.monotonic() - said >= SAY_EVERY_S:
                said = time.monotonic()
                print(f"{name}: {_words(progress)}", file=sys.stderr, flush=True)

        yield say
        return
    from rich.progress import BarColumn, TextColumn
    from rich.progress import Progress as Bars

    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[words]}"))
    with Bars(*columns, console=console_on(stderr=True)) as bars:
        task = bars.add_task(name, total=None, words="")

        def draw(progress: Progress) -> None:
            bars.update(task, completed=progress.done, total=progress.runs, words=_words(progress))

        yield draw


def _words(progress: Progress) -> str:
    left = progress.left_s
    words = f"{progress.done:,} of {counted(progress.runs, 'run')}"
    if left is not None and progress.done < progress.runs:
        words += f", {progress.rate:,.0f} per second, {duration(left)} left"
    if progress.failed:
        words += f", {progress.failed:,} failed"
    return words


def duration(seconds: float) -> str:
    """Seconds in words that can be read at a glance."""
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 5400.0 else f"{seconds / 3600.0:.1f} h"


def overview(setup: Setup, outcome: Outcome) -> str:
    """One line about a sweep that has ended."""
    are = "is" if outcome.runs == 1 else "are"
    words = f"{setup.name}: {outcome.stored:,} of {counted(outcome.runs, 'run')} {are} stored in {outcome.folder}"
    words += f"; {outcome.ran:,} run now in {duration(outcome.wall_s)}"
    if outcome.reused:
        words += f", {outcome.reused:,} taken from equal runs"
    words += f", {outcome.failed:,} failed" if outcome.failed else ""
    if outcome.removed:
        words += f"; removed, of the study that was there before: {', '.join(map(str, outcome.removed))}"
    return words


def sizes(setup: Setup, table: RunTable) -> str:
    """One line about a study that has not been run."""
    return (
        f"{setup.name}: {counted(len(table.designs), 'design')}, {counted(len(table.cases), 'collision')}, "
        f"{counted(table.samples, 'sample')} with the nominal one: {counted(table.count, 'run')}{_sure(setup)}"
    )


def search_sizes(setup: Setup) -> str:
    """One line about a search that has not been run."""
    per_design = len(setup.cases) * (1 + setup.tolerance_count)
    return (
        f"{setup.name}: at most {counted(setup.search.designs, 'design')}, {setup.search.population} in a generation, "
        f"{counted(per_design, 'run')} each{_sure(setup)}"
    )


def _sure(setup: Setup) -> str:
    """What it takes besides to say how sure the recommendation is."""
    from giveway.study.sure import uncertain

    if not setup.sure.probability or uncertain(setup):
        return ""
    return f"; how sure: at most {counted(setup.sure.runs * len(setup.cases), 'run')} for each of {setup.sure.designs}"


def write_all(
    answers: Answers, simulate_chosen: bool = True, progress: Callable[[str, float], None] = lambda name, share: None
) -> list[Path]:
    """Simulate the best designs event-exact with traces; write report.html, designs table and figures.

    ``progress`` is called with `CHOSEN` or `REPORT` and the share of it that is done.
    """
    from giveway.study.chosen import simulate
    from giveway.study.export import export_table
    from giveway.study.report import write_report

    if simulate_chosen and answers.setup.chosen:
        best = answers.order[: answers.setup.chosen].tolist()
        for index, design in enumerate(best):
            progress(CHOSEN, index / len(best))
            simulate(answers.setup, answers.runs, answers.folder, design)
        progress(CHOSEN, 1.0)
    progress(REPORT, 0.0)
    table_file, report = answers.folder / "table.csv", answers.folder / "report.html"
    export_table(answers, table_file)
    write_report(report, answers)
    progress(REPORT, 1.0)
    return [report, table_file]
