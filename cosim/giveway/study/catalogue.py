"""Catalogues of parts: CSV files with one part per line, checked with file, line and column.

    # Made up.
    name,     maker,  price [EUR], mass [g], rate [N/mm]
    DF-0940,  Acme,   3.10,        14,       0.94

A column with a unit holds numbers (`[1]`: without a unit), any other one text. `name` is needed, `maker`, `price` and
`mass` are known, all others are what the catalogue's owner likes. An empty cell is not stated, which is refused where
it is needed. Lines that begin with # are comments.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.csv_rows import check_widths, head_parts, number_of, read_rows, title_of
from giveway.base.errors import GivewayError, InputFileError, UnknownNameError
from giveway.base.units import check_unit, factor

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["MAKER", "MASS", "NAME", "PRICE", "Catalogue", "Column", "read_catalogue"]

NAME, MAKER, PRICE, MASS = "name", "maker", "price", "mass"
NAME_MAX, PARTS_MAX = 60, 100_000
_CURRENCY = re.compile(r"[A-Z]{3}")
A_UNIT = "1 or a unit, such as N/mm"
A_CURRENCY = "a currency of three capital letters, such as EUR"


@dataclass(frozen=True)
class Column:
    """A column of a catalogue.

    Attributes:
        name: its head, without the unit.
        position: from 1.
        unit: of its numbers, as written; None: it holds text.
        cells: text of each part's cell.
        numbers: the same as numbers, in `unit`; NaN where the cell is empty, and of text.
    """

    name: str
    position: int
    unit: str | None
    cells: tuple[str, ...]
    numbers: NDArray[np.float64]

    @property
    def title(self) -> str:
        """What messages call it."""
        return title_of(self.position, self.name, self.unit)


@dataclass(frozen=True)
class Catalogue:
    """The parts of a file: ``lines`` has the line of each, ``columns`` what is stated of it, by name."""

    path: Path
    head_line: int
    lines: tuple[int, ...]
    columns: Mapping[str, Column]

    @property
    def names(self) -> tuple[str, ...]:
        """Of the parts."""
        return self.columns[NAME].cells

    def column(self, field: str, name: str) -> Column:
        """The column ``name``; the error names ``field``."""
        if name not in self.columns:
            raise UnknownNameError(field, name, self.columns)
        return self.columns[name]

    def wrong(self, part: int, column: Column, allowed: str) -> InputFileError:
        """The error about a part's cell."""
        cell = column.cells[part] or "nothing"
        return InputFileError(self.path, self.lines[part], GivewayError(column.title, cell, allowed))

    def numbers(self, field: str, name: str, unit: str, parts: Iterable[int]) -> NDArray[np.float64]:
        """Numbers of the column ``name`` for ``parts``, in ``unit``; ``field`` is what asks for them."""
        column = self.column(field, name)
        if column.unit is None:
            allowed = f"a column of numbers, its unit in the head: {name} [{unit or '1'}]"
            raise GivewayError(field, f"{name} of {self.path.name}", allowed)
        try:
            scale = 1.0 if column.unit == unit else factor(column.title, column.unit, unit)
        except GivewayError as error:
            raise InputFileError(self.path, self.head_line, error) from None
        found = []
        for part in parts:
            if math.isnan(column.numbers[part]):
                raise self.wrong(part, column, f"a number: {field} needs it")
            found.append(float(column.numbers[part]) * scale)
        return np.array(found)


def read_catalogue(path: Path) -> Catalogue:
    """The catalogue in the file ``path``, checked.

    Raises:
        FileError: it cannot be read.
        InputFileError: something in it is wrong; names line and column.
    """
    rows = read_rows(path, "a catalogue")
    if not 2 <= len(rows) <= PARTS_MAX + 1:
        wrong = GivewayError("parts", max(0, len(rows) - 1), f"1 to {PARTS_MAX}, below a line of column names")
        raise InputFileError(path, rows[0][0] if rows else 1, wrong)
    (head_line, head), *parts = rows
    lines = tuple(line for line, _ in parts)
    units: dict[str, str | None] = {}
    try:
        for position, cell in enumerate(head, 1):
            name, unit = _head(f"column {position}", cell, units)
            units[name] = unit
        if NAME not in units:
            raise GivewayError("columns", ", ".join(head), f"a column {NAME!r} and others, divided by commas")
    except GivewayError as error:
        raise InputFileError(path, head_line, error) from None
    check_widths(path, rows)
    columns = {}
    for j, (name, unit) in enumerate(units.items()):
        cells = tuple(row[j] for _, row in parts)
        numbers = np.full(len(cells), np.nan)
        columns[name] = Column(name, j + 1, unit, cells, numbers)
        for part, cell in enumerate(cells):
            try:
                numbers[part] = math.nan if unit is None else _number(columns[name], cell)
            except GivewayError as error:
                raise InputFileError(path, lines[part], error) from None
    _check_names(path, lines, columns[NAME])
    return Catalogue(path, head_line, lines, MappingProxyType(columns))


def _head(field: str, cell: str, known: Mapping[str, str | None]) -> tuple[str, str | None]:
    """Name and unit of a column."""
    found = head_parts(cell)
    if found is None:
        raise GivewayError(field, cell or "nothing", "a name, and for numbers a unit: rate [N/mm]")
    name, unit = found
    if name in known:
        raise GivewayError(field, name, "a name of its own")
    if name in (NAME, MAKER) and unit is not None:
        raise GivewayError(field, cell, f"{name}, without a unit")
    if name == PRICE:
        if unit is None or not _CURRENCY.fullmatch(unit):
            raise GivewayError(field, cell, f"{PRICE} [EUR]: {A_CURRENCY}")
    elif name == MASS:
        factor(field, unit or "1", "kg")
    elif unit is not None:
        check_unit(field, unit, A_UNIT)
    return name, unit


def _number(column: Column, cell: str) -> float:
    """A cell as a number; NaN if it is empty."""
    if not cell:
        return math.nan
    found = number_of(column.title, cell)
    if found < 0.0 and column.name in (PRICE, MASS):
        raise GivewayError(column.title, cell, "0 or more")
    return found


def _check_names(path: Path, lines: tuple[int, ...], column: Column) -> None:
    seen: dict[str, int] = {}
    for line, name in zip(lines, column.cells, strict=True):
        if not 1 <= len(name) <= NAME_MAX or not name.isprintable():
            allowed = f"1 to {NAME_MAX} printable characters"
        elif name in seen:
            allowed = f"a name of its own: line {seen[name]} has it, too"
        else:
            seen[name] = line
            continue
        raise InputFileError(path, line, GivewayError(column.title, name or "nothing", allowed))
