"""CSV files that users write: heads of columns with units, ``rate [N/mm]``, then rows; # begins a comment line."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from giveway.base.errors import FileError, GivewayError, InputFileError

__all__ = ["Row", "check_widths", "head_parts", "number_of", "read_rows", "rows_of", "title_of"]

Row = tuple[int, list[str]]
"""Line and stripped cells."""

_HEAD = re.compile(r"([^\[\]]*[^\[\]\s])\s*(?:\[\s*([^\[\]]*?)\s*\])?")


def read_rows(path: Path, what: str) -> list[Row]:
    """The rows of ``what`` that are not empty, the heads first.

    Raises:
        FileError: it cannot be read.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as stream:
            return list(rows_of(stream))
    except FileNotFoundError:
        hint = f"give the path of {what} (CSV), seen from the file that names it"
        raise FileError(path, "no such file", hint) from None
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise FileError(path, f"cannot be read: {error}") from None


def rows_of(stream: Iterable[str]) -> Iterator[Row]:
    """The rows of lines that are not empty and no comments; lines count from 1."""
    return ((line, row) for line, row in _rows(stream) if any(row))


def _rows(stream: Iterable[str]) -> Iterator[Row]:
    """Comments as empty rows."""
    reader = csv.reader(("\n" if text.lstrip().startswith("#") else text for text in stream), strict=True,
                        skipinitialspace=True)  # fmt: skip
    line = 1
    for row in reader:
        yield line, [cell.strip() for cell in row]
        line = reader.line_num + 1


def check_widths(path: Path, rows: Sequence[Row]) -> None:
    """InputFileError unless every row has a cell for each head."""
    (head_line, head), *others = rows
    for line, row in others:
        if len(row) != len(head):
            wrong = GivewayError("columns", len(row), f"{len(head)}, as in line {head_line}")
            raise InputFileError(path, line, wrong)


def head_parts(cell: str) -> tuple[str, str | None] | None:
    """Name and unit of a head (None: it has none), if it is one."""
    found = _HEAD.fullmatch(cell)
    return None if found is None else (found[1], found[2])


def title_of(position: int, name: str, unit: str | None) -> str:
    """What messages call a column; ``position`` from 1."""
    return f"column {position}, {name if unit is None else f'{name} [{unit}]'}"


def number_of(title: str, cell: str) -> float:
    """A cell as a finite number, else GivewayError."""
    try:
        found = math.nan if "_" in cell else float(cell)
    except ValueError:
        found = math.nan
    if not math.isfinite(found):
        raise GivewayError(title, cell or "nothing", "a finite number")
    return found
