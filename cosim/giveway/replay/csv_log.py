"""Logs as CSV: a line of heads, ``torque_0 [N.m]``, then rows; # begins a comment line."""

from __future__ import annotations

import io
import itertools
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.csv_rows import Row, head_parts, rows_of, title_of
from giveway.base.errors import FileError, GivewayError, InputFileError
from giveway.replay.arrow_columns import numbers_of
from giveway.replay.source import Block, Head, Origin, Places, parameters_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["CsvLog", "LineLog", "cell_value"]

BLOCK_BYTES = 8 << 20
LINES = 200_000  # of a block that is read row by row
MISSING = ("", "nan", "na", "null", "none")
_STATED = re.compile(r"#\s*(?:controller\.(?P<name>\S+)|(?P<step>step_s))\s*=\s*(?P<value>\S+)\s*")


def cell_value(title: str, cell: str) -> float:
    """The number in a cell; NaN where there is none, which is a missing sample; else GivewayError."""
    if cell.lower() in MISSING:
        return math.nan
    try:
        return float(cell if "_" not in cell else "?")
    except ValueError:
        raise GivewayError(title, cell, "a number, or nothing where a sample is missing") from None


class _Begin:
    """Comments and heads of a log, taken from its lines."""

    def __init__(self, path: Path, lines: Iterable[str]) -> None:
        stated: dict[str, object] = {}
        step_s: float | None = None
        heads: Row | None = None
        for number, line in enumerate(lines, 1):
            if (found := _STATED.fullmatch(line.strip())) is not None:
                if found["step"]:
                    step_s = float(found["value"])
                else:
                    stated[found["name"]] = found["value"]
            elif (row := next(rows_of([line]), None)) is not None:
                heads = number, row[1]
                break
        if heads is None:
            raise FileError(path, "has no line of heads", "a log begins with them: time [s], torque_0 [N.m], ...")
        self.line, cells = heads
        self.heads = [_head(path, self.line, position, cell) for position, cell in enumerate(cells, 1)]
        ours = bool(stated) or step_s is not None  # a run with the start values states no parameter
        parameters = parameters_of(path, stated) if ours else None
        self.origin = Origin(parameters, step_s)


def _head(path: Path, line: int, position: int, cell: str) -> Head:
    parts = head_parts(cell)
    if parts is None:
        wrong = GivewayError(f"column {position}", cell or "nothing", "a name, with its unit in brackets if it has one")
        raise InputFileError(path, line, wrong)
    return Head(*parts)


class _RowReader:
    """Rows as numbers, the slow way, which knows what is wrong where."""

    def __init__(self, path: Path, heads: Sequence[Head], head_line: int, wanted: Sequence[int]) -> None:
        self._path, self._heads, self._head_line = path, heads, head_line
        self._wanted = [(column, title_of(column + 1, heads[column].name, heads[column].unit)) for column in wanted]

    def numbers(self, line: int, cells: list[str]) -> list[float]:
        try:
            if len(cells) != len(self._heads):
                raise GivewayError("columns", len(cells), f"{len(self._heads)}, as in line {self._head_line}")
            return [cell_value(title, cells[column]) for column, title in self._wanted]
        except GivewayError as error:
            raise InputFileError(self._path, line, error) from None


class CsvLog:
    """A CSV file."""

    kind = "CSV"

    def __init__(self, path: Path) -> None:
        self.path, self.said = path, list[str]()
        try:
            with path.open(encoding="utf-8-sig", newline="") as stream:
                begin = _Begin(path, stream)
        except FileNotFoundError:
            raise FileError(path, "no such file", "give the path of a log") from None
        except (OSError, UnicodeDecodeError) as error:
            raise FileError(path, f"cannot be read: {error}") from None
        self.heads, self.origin, self._head_line = begin.heads, begin.origin, begin.line
        self._places = Places()

    def place(self, row: int) -> str:
        return f"line {self._places.line(row)}"

    def blocks(self, wanted: Sequence[int]) -> Iterator[Block]:
        slow = _RowReader(self.path, self.heads, self._head_line, wanted)
        row, line = 0, self._head_line + 1
        try:
            for part in self._parts():
                lines = part.count(b"\n") + (not part.endswith(b"\n"))
                values = _fast(part, len(self.heads), wanted)
                if values is not None and len(values) == lines:
                    self._places.add(row, line)
                else:  # comments, empty lines, or something wrong
                    values = self._slowly(part, slow, row, line)
                if len(values):
                    yield Block(values, row)
                row, line = row + len(values), line + lines
        except OSError as error:
            raise FileError(self.path, f"cannot be read: {error}") from None

    def _parts(self) -> Iterator[bytes]:
        """What follows the heads, in whole lines."""
        with self.path.open("rb") as stream:
            for _ in range(self._head_line):
                stream.readline()
            while part := stream.read(BLOCK_BYTES):
                yield part + stream.readline()

    def _slowly(self, part: bytes, reader: _RowReader, row: int, line: int) -> NDArray[np.float64]:
        try:
            text = part.decode("utf-8")
        except UnicodeDecodeError as error:
            at = line + part[: error.start].count(b"\n")
            raise FileError(self.path, f"line {at}: cannot be read: {error.reason}") from None
        rows: list[list[float]] = []
        for number, cells in rows_of(io.StringIO(text, newline="")):
            self._places.add(row + len(rows), line + number - 1)
            rows.append(reader.numbers(line + number - 1, cells))
        return np.array(rows, dtype=np.float64).reshape(len(rows), -1)


def _fast(part: bytes, columns: int, wanted: Sequence[int]) -> NDArray[np.float64] | None:
    """The same for rows of numbers; None if there is anything else in ``part``."""
    import pyarrow
    from pyarrow import csv

    if b"#" in part or b'"' in part:
        return None
    names = [str(column) for column in range(columns)]
    used = [str(column) for column in wanted]
    try:
        found = csv.read_csv(
            pyarrow.BufferReader(part),
            read_options=csv.ReadOptions(column_names=names),
            parse_options=csv.ParseOptions(ignore_empty_lines=False, newlines_in_values=False),
            convert_options=csv.ConvertOptions(
                column_types=dict.fromkeys(used, pyarrow.float64()),
                include_columns=used,
                null_values=["", *MISSING, "NaN", "NA", "NULL", "None"],
                check_utf8=False,
            ),
        )
    except pyarrow.ArrowException:
        return None
    return np.stack([numbers_of(found.column(name)) for name in used], axis=1)


class LineLog:
    """Lines that come one by one, as on standard input: `rows` gives them as they come."""

    kind = "CSV lines"

    def __init__(self, lines: Iterable[str], name: str = "standard input") -> None:
        self.path, self.said = Path(name), list[str]()
        rest = iter(lines)
        first = next(rest, "").removeprefix("\ufeff")  # a byte order mark, as `CsvLog` leaves out
        self._lines = itertools.chain([first], rest)
        begin = _Begin(self.path, self._lines)
        self.heads, self.origin, self._head_line = begin.heads, begin.origin, begin.line
        self._places = Places()

    def place(self, row: int) -> str:
        return f"line {self._places.line(row)}"

    def blocks(self, wanted: Sequence[int]) -> Iterator[Block]:
        for row, values in self.rows(wanted):
            yield Block(np.array([values]), row)

    def rows(self, wanted: Sequence[int]) -> Iterator[tuple[int, list[float]]]:
        """Number and values of each row."""
        reader = _RowReader(self.path, self.heads, self._head_line, wanted)
        row = 0
        for number in itertools.count(self._head_line + 1):
            line = next(self._lines, None)
            if line is None:
                return
            for _, cells in rows_of([line]):
                self._places.add(row, number)
                yield row, reader.numbers(number, cells)
                row += 1
