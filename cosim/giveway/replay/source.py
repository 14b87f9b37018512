"""A log as columns of numbers, read in parts, whatever its file is."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from giveway.base.errors import FileError, GivewayError
from giveway.robot.variables import Value, table

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["Block", "Head", "Origin", "Places", "Source", "file_hash", "parameters_of", "place_error"]


@dataclass(frozen=True)
class Head:
    """A column as the log names it; ``unit`` None: the log does not say."""

    name: str
    unit: str | None


@dataclass(frozen=True)
class Block:
    """Some rows: ``values`` (n, wanted), NaN where nothing is; ``first``: number of the first one, from 0."""

    values: NDArray[np.float64]
    first: int


@dataclass(frozen=True)
class Origin:
    """What a log of `giveway run --log` says of its run.

    Attributes:
        parameters: of the controller; None: the log says nothing.
        step_s: time between rows, s, likewise.
    """

    parameters: Mapping[str, Value] | None = None
    step_s: float | None = None


class Source(Protocol):
    """An open log.

    Attributes:
        path: the file or folder.
        kind: of the log, in words.
        heads: its columns.
        origin: of the log, if it is a run's.
        said: what was assumed while it was opened, one sentence each.
    """

    path: Path
    kind: str
    heads: list[Head]
    origin: Origin
    said: list[str]

    def blocks(self, wanted: Sequence[int]) -> Iterator[Block]:
        """The columns ``wanted`` of all rows, in order; at any time only one block is in memory."""
        ...

    def place(self, row: int) -> str:
        """Where row ``row``, from 0, is in the log: "line 17"."""
        ...


@dataclass
class Places:
    """Numbers of lines of rows: the first row of every run of rows without a line between them, and its line."""

    rows: list[int] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)

    def add(self, row: int, line: int) -> None:
        if not self.rows or line - row != self.lines[-1] - self.rows[-1]:
            self.rows.append(row)
            self.lines.append(line)

    def line(self, row: int) -> int:
        import bisect

        at = bisect.bisect_right(self.rows, row) - 1
        return row - self.rows[at] + self.lines[at]


def place_error(source: Source, row: int, reason: str, allowed: str = "") -> FileError:
    """The error of a row."""
    return FileError(source.path, f"{source.place(row)}: {reason}", allowed)


def parameters_of(path: Path, stated: Mapping[str, object]) -> dict[str, Value]:
    """The controller's parameters that a log states, checked."""
    try:
        return table("controller").check_all(stated)
    except GivewayError as error:
        raise FileError(path, f"states {error}", "written by another version? give --robot instead") from None


def file_hash(path: Path) -> str:
    """SHA-256 of a file, or of all files of a folder in the order of their names."""
    found = hashlib.sha256()
    files = sorted(one for one in path.rglob("*") if one.is_file()) if path.is_dir() else [path]
    for one in files:
        with one.open("rb") as stream:
            while part := stream.read(1 << 20):
                found.update(part)
    return found.hexdigest()
