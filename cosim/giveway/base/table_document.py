"""A printed table as JSON: numbers as numbers, units beside them, a row as an object by column."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from giveway.base.errors import GivewayError
from giveway.base.units import check_unit

__all__ = ["Shown", "table_document"]

FIRST = "name"  # of the first column, where its head is empty

_NUMBER = re.compile(r"[-+]?(0|[1-9]\d*|[1-9]\d{0,2}(,\d{3})+)(\.\d+)?(e[-+]?\d+)?")
_HEADS = (re.compile(r"(.+), (\S+(?: \S+)?)"), re.compile(r"(.+) [(\[](\S+(?: \S+)?)[)\]]"))  # "force, N", "min (ms)"
_WORDS = {"-": None, "": None, "True": True, "False": False}


class Shown(str):
    """A cell that knows what it stands for, of which it shows less.

    Attributes:
        data: that, as JSON has it: a number in full, or an object.
    """

    data: Any

    def __new__(cls, text: str, data: Any) -> Shown:
        shown = super().__new__(cls, text)
        shown.data = data
        return shown


def table_document(title: str, header: Sequence[str], rows: Sequence[Sequence[str]]) -> dict[str, Any]:
    """``title``, ``units`` by column, ``rows``: an object each, with ``unit`` if its label has one ("speed, m/s")."""
    columns, units = [], {}
    for index, head in enumerate(header):
        name, unit = _split(head)
        name = name or (FIRST if index == 0 else f"column {index + 1}")
        if name in columns:
            name = f"{name} ({index + 1})"
        columns.append(name)
        if unit:
            units[name] = unit
    return {"title": title, "units": units, "rows": [_row(columns, row) for row in rows]}


def _row(columns: Sequence[str], row: Sequence[str]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for index, (column, cell) in enumerate(zip(columns, row, strict=True)):
        if index == 0 and column == FIRST:
            found[column], unit = _split(cell)
            if unit and "unit" not in columns:
                found["unit"] = unit
        else:
            found[column] = _value(cell)
    return found


def _split(label: str) -> tuple[str, str]:
    """Name and unit of "contact speed, m/s"; the unit is "" if there is none."""
    for pattern in _HEADS:
        found = pattern.fullmatch(label)
        if found and (unit := _unit(found[2])):
            return found[1], unit
    return label, ""


def _unit(word: str) -> str:
    """``word`` as giveway writes units, with dots; "" if it is none."""
    unit = word.replace(" ", ".")
    try:
        check_unit("", unit, "")
    except GivewayError:
        return ""
    return "" if unit == "1" else unit


def _value(cell: str) -> Any:
    """What a `Shown` stands for; a number, {value, unit}, true or false, null for "-" and nothing, or the text."""
    if isinstance(cell, Shown):
        return cell.data
    if cell in _WORDS:
        return _WORDS[cell]
    number, _, unit = cell.partition(" ")
    if not _NUMBER.fullmatch(number) or (unit and not _unit(unit)):
        return cell
    plain = number.replace(",", "")
    value: float = float(plain) if re.search("[.e]", plain) else int(plain)
    return {"value": value, "unit": _unit(unit)} if unit else value
