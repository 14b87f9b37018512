"""Work in parts that are stored as a whole or not at all: Ctrl-C keeps them, and the same command goes on."""

from __future__ import annotations

import hashlib
import json
import platform
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from giveway.base.errors import FileError
from giveway.base.parquet import open_parquet, read_table
from giveway.base.version import VERSION
from giveway.library.batch_library import library
from giveway.study.engine import Progress, Report
from giveway.study.store import Store, list_parts

__all__ = ["Done", "Interrupted", "Record", "Work", "go_on"]

KIND = "giveway crowd"

Record = dict[str, Any]
"""What is stored of a run: plain data."""


class Interrupted(Exception):
    """Ctrl-C came within a part."""


@dataclass(frozen=True)
class Work:
    """Runs that can be computed in any parts.

    Attributes:
        name: for the terminal.
        asked: everything that decides the results besides code and library, as plain data.
        count: of runs.
        part: runs per part.
        compute: the records of some runs, from numbers, threads and a function for the number of finished runs.
        code: files of this room that decide the records.
    """

    name: str
    asked: Mapping[str, Any]
    count: int
    part: int
    compute: Callable[[Sequence[int], int, Callable[[int], None]], list[Record]]
    code: tuple[str, ...]


@dataclass(frozen=True)
class Done:
    """What `go_on` found: the records so far in the order of numbers; of them ``ran`` now, in ``wall_s``."""

    records: list[Record]
    ran: int
    wall_s: float
    interrupted: bool


def go_on(work: Work, folder: Path, threads: int, progress: Report) -> Done:
    """Compute the parts that ``folder`` lacks. Ctrl-C ends it cleanly."""
    shared = {
        "giveway": VERSION,
        "code_sha256": _code(work.code),
        "tokens": {name: model.token for name, model in library().models.items()},
        "library_sha256": next(iter(library().models.values())).sha256,
        **work.asked,
    }
    fingerprint = hashlib.sha256(json.dumps(shared, sort_keys=True).encode()).hexdigest()
    store = Store(folder, fingerprint, KIND)
    began, ran, interrupted = time.perf_counter(), 0, False
    try:
        manifest = {"name": work.name, "fingerprint": fingerprint, "asked": shared, "platform": platform.platform()}
        store.write_manifest({**manifest, "complete": not store.missing(work.count)})
        before = work.count - sum(end - first for first, end in store.missing(work.count))

        def say(under_way: int) -> None:
            rate = (ran + under_way) / max(time.perf_counter() - began, 1e-6)
            progress(Progress(before + ran + under_way, work.count, 0, 0, rate))

        try:
            for first, end in list(store.missing(work.count)):
                for start in range(first, end, work.part):
                    numbers = range(start, min(start + work.part, end))
                    store.write_part(start, _table(numbers, work.compute(numbers, threads, say)))
                    ran += len(numbers)
                    say(0)
            store.write_manifest({**manifest, "complete": True})
        except (KeyboardInterrupt, Interrupted):
            interrupted = True
        return Done(read_records(store.parts_folder), ran, time.perf_counter() - began, interrupted)
    finally:
        store.close()


def read_records(parts_folder: Path) -> list[Record]:
    """The records of all parts in a folder, in the order of their numbers."""
    import pyarrow

    found: list[Record] = []
    for _, _, path in list_parts(parts_folder):
        try:
            with path.open("rb") as file:
                texts = read_table(open_parquet(file), ["record"])["record"].to_pylist()
        except (OSError, pyarrow.ArrowException) as error:
            raise FileError(path, f"cannot be read: {error}", "remove it; the same command computes it again") from None
        found += [json.loads(text) for text in texts]
    return found


def _table(numbers: Sequence[int], records: Sequence[Record]) -> Any:
    import pyarrow

    texts = [json.dumps(record, sort_keys=True) for record in records]
    return pyarrow.table({"number": pyarrow.array(list(numbers)), "record": pyarrow.array(texts)})


def _code(names: Sequence[str]) -> str:
    """Hash of files of this room."""
    found = hashlib.sha256()
    for name in names:
        found.update(name.encode() + (Path(__file__).parent / name).read_bytes())
    return found.hexdigest()
