"""The paper in one run: every experiment's part of the reproduction, its table, and the table as JSON.

Failures and interruptions affect single experiments: the findings of the others are kept and written.
"""

from __future__ import annotations

import datetime
import hashlib
import json
import platform
import signal
import threading
import time
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from giveway import experiments
from giveway.base import native
from giveway.base.errors import GivewayError, UnknownNameError, one_line
from giveway.base.files import write_text
from giveway.base.version import VERSION
from giveway.experiments.reproduction.findings import CLASSES, REQUIREMENT, Effort, Findings, Row
from giveway.paper.printed import NOT_JUDGED

if TYPE_CHECKING:
    from types import FrameType

    from giveway.experiments import Experiment

__all__ = ["HEADER", "Chapter", "Reproduction", "chosen", "reproduce", "table_rows", "write_table"]

SCHEMA_VERSION = 1
HEADER = ("experiment", "quantity", "paper", "ours", "unit", "target", "met", "class", "provenance")
MISS_WITHOUT_REASON = "not yet known"

Progress = Callable[[str, float], None]
"""Called now and then with the experiment's name and its finished share, 0 to 1."""


@dataclass(frozen=True)
class Chapter:
    """One experiment of a reproduction.

    Attributes:
        experiment: which.
        findings: its rows, pictures and notes; empty if it failed.
        failure: why it failed, in one line; "" if it did not.
        wall_s: how long it took in s.
    """

    experiment: Experiment
    findings: Findings
    failure: str
    wall_s: float


@dataclass(frozen=True)
class Reproduction:
    """What `reproduce` found.

    Attributes:
        chapters: the experiments that were run, in the order of the paper's sections.
        interrupted: names of those that were not run, after an interruption by the user.
        manifest: versions, hashes and effort.
    """

    chapters: Sequence[Chapter]
    interrupted: Sequence[str]
    manifest: dict[str, Any]

    def rows(self) -> Iterator[tuple[Chapter, Row]]:
        """Every row with its chapter."""
        for chapter in self.chapters:
            for row in chapter.findings.rows:
                yield chapter, row

    def count(self, kind: str, met: bool) -> int:
        """Number of rows of a class in `CLASSES` that meet (or miss) their target."""
        return sum(row.kind == kind and row.met is met for _, row in self.rows())

    def summary(self) -> list[str]:
        """One line per class: how many of its targets are met."""
        lines = []
        for kind in CLASSES:
            met, missed = self.count(kind, True), self.count(kind, False)
            name = f"{kind}s" if kind == REQUIREMENT else kind
            lines.append(f"{name}: {met} met of {met + missed}")
        return lines

    @property
    def failed(self) -> bool:
        """Whether an experiment failed."""
        return any(chapter.failure for chapter in self.chapters)


def chosen(names: Sequence[str] = ()) -> list[Experiment]:
    """The experiments that take part, in the order of the paper; UnknownNameError for a name that does not."""
    able = {name: entry for name, entry in experiments.all_experiments().items() if entry.reproduce is not None}
    for name in names:
        if name not in able:
            raise UnknownNameError("--only", name, able)
    # Experiments that are not in the paper come last.
    picked = [entry for name, entry in able.items() if not names or name in names]
    return sorted(picked, key=lambda entry: (entry.section == "", entry.section, entry.name))


def reproduce(
    names: Sequence[str] = (), full: bool = True, threads: int = 2, progress: Progress | None = None
) -> Reproduction:
    """Run the experiments called ``names`` (all if empty).

    Args:
        names: experiments that have a ``reproduce``.
        full: False for the reduced version of each.
        threads: native threads, 1 to 256.
        progress: told the experiment and its finished share.

    An experiment that fails gives a chapter with the reason. Ctrl-C ends the run; the findings so far are returned.
    """
    if not 1 <= threads <= 256:
        raise GivewayError("threads", threads, "1 to 256")
    picked = chosen(names)
    chapters: list[Chapter] = []
    with _interruption() as interrupted:
        for experiment in picked:
            chapter = _chapter(experiment, full, threads, progress)
            if interrupted.is_set():  # its result or exception after an interruption is meaningless
                break
            chapters.append(chapter)
    left = [experiment.name for experiment in picked[len(chapters) :]]
    return Reproduction(chapters, left, _manifest(full, threads))


def _chapter(experiment: Experiment, full: bool, threads: int, progress: Progress | None) -> Chapter:
    def told(share: float) -> None:
        if progress is not None:
            progress(experiment.name, min(max(share, 0.0), 1.0))

    findings, failure = Findings(()), ""
    started = time.perf_counter()
    told(0.0)
    try:
        assert experiment.reproduce is not None  # `chosen` takes no others
        findings = experiment.reproduce(Effort(full, threads, told))
        told(1.0)
    except KeyboardInterrupt:
        failure = "interrupted"
    except GivewayError as error:
        failure = str(error)
    except Exception as error:
        # A fault of one experiment must not cost the minutes of the others; its place is named.
        place = traceback.extract_tb(error.__traceback__)[-1]
        failure = one_line(f"{type(error).__name__} in {Path(place.filename).name}:{place.lineno}: {error}")
    return Chapter(experiment, findings, failure, time.perf_counter() - started)


@contextmanager
def _interruption() -> Iterator[threading.Event]:
    """An event that is set by Ctrl-C, which also interrupts the running code; if Ctrl-C is ignored, it stays
    ignored."""
    event = threading.Event()
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or before is signal.SIG_IGN:
        yield event
        return

    def interrupt(number: int, frame: FrameType | None) -> None:
        event.set()
        signal.default_int_handler(number, frame)

    signal.signal(signal.SIGINT, interrupt)
    try:
        yield event
    finally:
        signal.signal(signal.SIGINT, before)


def _manifest(full: bool, threads: int) -> dict[str, Any]:
    def sha256(path: Path) -> dict[str, str]:
        return {"file": path.name, "sha256": hashlib.sha256(path.read_bytes()).hexdigest()}

    return {
        "created": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        "effort": "full" if full else "reduced",
        "threads": threads,
        "versions": {"giveway": VERSION, "python": platform.python_version()},
        "platform": platform.platform(),
        "robot": sha256(native.robot()),
        "library": sha256(native.batch_library()),
    }


def number(value: float | str | None, decimals: int) -> str:
    """A cell: fixed digits after the point, words as they are, "-" for a missing value."""
    if value is None:
        return "-"
    return value if isinstance(value, str) else f"{value:z.{decimals}f}"


def table_rows(reproduction: Reproduction) -> list[tuple[str, ...]]:
    """The printed table, one tuple per row in the order of `HEADER`; a failed experiment has one row."""
    lines: list[tuple[str, ...]] = []
    for chapter in reproduction.chapters:
        name = f"{chapter.experiment.section} {chapter.experiment.name}".strip()
        if chapter.failure:
            lines.append((name, f"failed: {chapter.failure}", *[""] * (len(HEADER) - 2)))
        for row in chapter.findings.rows:
            cells = (number(row.papers, row.decimals), number(row.ours, row.decimals))
            met = {True: "yes", False: "MISS", None: ""}[row.met]
            target = "" if row.target is None else row.target.text
            unit = "" if row.unit == "1" else row.unit
            lines.append((name, row.quantity, *cells, unit, target, met, row.kind, row.provenance))
    return lines


def write_table(path: Path, reproduction: Reproduction) -> None:
    """Write every row at full precision as JSON, atomically."""
    table = {
        "schema_version": SCHEMA_VERSION,
        "rows": [
            {
                "experiment": chapter.experiment.name,
                "quantity": row.quantity,
                "paper": row.papers,
                "ours": row.ours,
                "unit": row.unit,
                "target": None if row.target is None else row.target.text,
                "met": row.met,
                "class": row.kind,
                "provenance": row.provenance,
                "reason": row.reason or (MISS_WITHOUT_REASON if row.met is False else ""),
            }
            for chapter, row in reproduction.rows()
        ],
        "counts": {
            kind: {"met": reproduction.count(kind, True), "missed": reproduction.count(kind, False)} for kind in CLASSES
        },
        "not_judged": dict(NOT_JUDGED),
        "experiments": [
            {
                "name": chapter.experiment.name,
                "section": chapter.experiment.section,
                "wall_s": round(chapter.wall_s, 3),
                "failure": chapter.failure,
                "notes": list(chapter.findings.notes),
            }
            for chapter in reproduction.chapters
        ],
        "interrupted": list(reproduction.interrupted),
        "manifest": reproduction.manifest,
    }
    write_text(path, json.dumps(table, indent=2, ensure_ascii=False, allow_nan=False) + "\n")
