"""Inputs of `giveway fmu run` to an FMU: values set once (--set), and inputs over time from a CSV file (--input)."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import FileError, GivewayError, InputFileError, UnknownNameError
from giveway.fmu_tools.description import REALS, Description, VariableEntry, effective

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Settable", "assigned", "column_name", "read_inputs"]

Settable = float | bool | str
_TRUTH = {"true": True, "1": True, "false": False, "0": False}
_TIME = ("time", "s")


def column_name(name: str, unit: str) -> str:
    """The head of a column in a CSV file, as `giveway fmu run` writes it and `read_inputs` reads it."""
    return f"{name} [{unit}]" if unit not in ("", "1") else name


def assigned(description: Description, assignments: Sequence[str]) -> dict[str, Settable]:
    """ "NAME=VALUE" checked against the bounds in the model description, before anything runs."""
    settable = {
        v.name: v for v in description.variables if v.causality in ("input", "parameter", "structuralParameter")
    }
    values: dict[str, Settable] = {}
    for assignment in assignments:
        name, equals, text = assignment.partition("=")
        if not equals:
            raise GivewayError("--set", assignment, "NAME=VALUE")
        if name not in settable:
            raise UnknownNameError("--set", name, settable)
        values[name] = _value(description, settable[name], text)
    return values


def read_inputs(path: Path, description: Description) -> NDArray[Any]:
    """The inputs over time: a structured array, field "time" in s, then one per column of the file.

    The first column is time in s, which must not decrease; where it repeats, an input jumps. The others have the names
    of inputs, with their unit in brackets if they have one: "push.force_x [N]". Between rows reals are interpolated,
    other types are held. Otherwise FileError or InputFileError is raised.
    """
    rows = list(_rows(path))
    if len(rows) < 2:
        raise FileError(path, "has no row of values", "a line of names, then a line for each time")
    (_, head), *body = rows
    columns = [_column(path, description, text, index) for index, text in enumerate(head)]
    if len({name for name, _ in columns}) < len(columns):
        raise FileError(path, "has two columns of the same name")
    found = np.zeros(len(body), dtype=[(name, _dtype(description, entry)) for name, entry in columns])
    before = -math.inf
    for row, (line, cells) in enumerate(body):
        if len(cells) != len(columns):
            raise InputFileError(
                path, line, GivewayError("row", f"{len(cells)} cells", f"{len(columns)}, as in line 1")
            )
        for (name, entry), text in zip(columns, cells, strict=True):
            try:
                found[name][row] = _time(text, before) if entry is None else _value(description, entry, text.strip())
            except GivewayError as error:
                raise InputFileError(path, line, error) from None
        before = float(found["time"][row])
    return found


def _rows(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Line number and cells of each row that is not empty."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as stream:
            reader = csv.reader(stream)
            for cells in reader:
                if any(cell.strip() for cell in cells):
                    yield reader.line_num, cells
    except FileNotFoundError:
        raise FileError(path, "no such file", "give the path of a CSV file of inputs") from None
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise FileError(path, f"cannot be read: {error}") from None


def _column(path: Path, description: Description, text: str, index: int) -> tuple[str, VariableEntry | None]:
    found = re.fullmatch(r"(.*?)(?: \[(.*)\])?", text.strip())
    name, unit = (found[1], found[2]) if found else (text, None)
    if index == 0:
        if name != _TIME[0] or unit not in (None, _TIME[1]):
            raise InputFileError(path, 1, GivewayError("first column", text, "time or time [s]"))
        return name, None
    entry = description.by_name.get(name)
    if entry is None or entry.causality != "input":
        inputs = [v.name for v in description.variables if v.causality == "input"]
        raise InputFileError(path, 1, UnknownNameError("column", name, inputs))
    own = effective(description, entry, "unit")
    if unit is not None and unit != (own or "1"):
        raise InputFileError(path, 1, GivewayError(f"unit of {name}", unit, own or "no unit"))
    if entry.is_array or entry.type in ("String", "Binary", "Clock"):
        raise InputFileError(path, 1, GivewayError(name, entry.type, "an input that is one number or true or false"))
    return name, entry


def _dtype(description: Description, entry: VariableEntry | None) -> Any:
    if entry is None or entry.type in REALS:
        return np.float64
    if entry.type == "Boolean":
        return np.bool_
    return np.int32 if description.version == 2 else np.int64


def _time(text: str, before: float) -> float:
    allowed = "a time in s that is finite and not before the row above"
    try:
        time = float(text)
    except ValueError:
        raise GivewayError("time", text, allowed) from None
    if not math.isfinite(time) or time < before:
        raise GivewayError("time", text, allowed)
    return time


def _value(description: Description, variable: VariableEntry, text: str) -> Settable:
    if variable.type == "Boolean":
        if text.lower() not in _TRUTH:
            raise GivewayError(variable.name, text, "true or false")
        return _TRUTH[text.lower()]
    if variable.type in ("String", "Binary"):
        return text
    return _number(description, variable, text)


def _number(description: Description, variable: VariableEntry, text: str) -> float:
    low, high = (_bound(effective(description, variable, n), e) for n, e in (("min", -math.inf), ("max", math.inf)))
    whole = variable.type not in REALS
    unit = effective(description, variable, "unit")
    allowed = f"a {'whole' if whole else 'finite'} number from {low:g} to {high:g}{f' {unit}' if unit else ''}"
    try:
        value = float(text)
    except ValueError:
        raise GivewayError(variable.name, text, allowed) from None
    if not math.isfinite(value) or not low <= value <= high or (whole and value != int(value)):
        raise GivewayError(variable.name, text, allowed)
    return int(value) if whole else value


def _bound(text: str, default: float) -> float:
    try:
        return float(text)
    except ValueError:
        return default
