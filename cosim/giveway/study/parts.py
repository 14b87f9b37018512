"""Parts that a study chooses among: its tables ``[[parts]]``, each with a catalogue.

A choice is a quantity like any other one, whose values are the catalogue's parts. What a part is, stands in columns:
``sets`` says which parameter gets which of them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import GivewayError, UnknownNameError
from giveway.base.shapes import List, Names, Table, Text, Whole
from giveway.base.toml_sections import Section
from giveway.scenario.scenario_file import scalars
from giveway.study.catalogue import MAKER, MASS, PRICE, Catalogue, read_catalogue
from giveway.study.distributions import Varied
from giveway.study.metrics import MASS_OF_PARTS, PRICE_OF_PARTS, Metric, all_metrics
from giveway.study.quantities import Quantity, find, value_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "PARTS",
    "SUMS",
    "PartChoice",
    "PartLimit",
    "PartSetting",
    "choices_of",
    "known_sums",
    "part_lines",
    "part_metric",
    "part_sums",
    "parts_of",
]

COUNT_MAX = 1000
_PAIRS = 'a table: { "testbed.bumper.spring_rate" = "rate" }'
PARTS = Table(
    "",
    {
        "name": Text("what is chosen, such as spring"),
        "catalogue": Text("CSV file, a part per line; its path seen from this file"),
        "count": Whole("how many are built in (1)", 1, COUNT_MAX),
        "sets": Names("quantities, each with the column of its value", _PAIRS),
        "at_most": Names("quantities that a part limits, each with the column of the limit", _PAIRS),
        "at_least": Names("quantities that a part limits, each with the column of the limit", _PAIRS),
        "only": List("the parts admitted", Text(), "a list of parts' names", 1),
        "nominal": Text("the part while another quantity varies (one-at-a-time)"),
    },
    ("name", "catalogue"),
)
_NAME = re.compile(r"[^\W\d][\w -]{0,39}")
_COLUMN = re.compile(r"(.*?)(?:\s*([*/])\s*count)?")
_TAKEN = ("run", "design", "tolerance sample", "collision", "key", "status", "message", "warnings", "simulated",
          "plant step", "bumper", "temperature", "feasible", "pareto", "failed runs", "reason")  # fmt: skip
SUMS: Mapping[str, str] = {PRICE_OF_PARTS: PRICE, MASS_OF_PARTS: MASS}
"""Metric by metric, the column that is summed."""


@dataclass(frozen=True)
class PartSetting:
    """A quantity that gets its value from a part.

    Attributes:
        quantity: which.
        column: of the catalogue.
        share: of the whole that one of several equal parts carries: 1 / count where ``* count`` is written (side by
            side), count where ``/ count`` is (one behind the other).
        values: by part, in the quantity's unit.
    """

    quantity: Quantity
    column: str
    share: float
    values: NDArray[np.float64]


@dataclass(frozen=True)
class PartLimit:
    """A quantity that a part limits: at most (``sense`` 1) or at least (-1) its number in ``column``, by part."""

    quantity: Quantity
    sense: int
    column: str
    values: NDArray[np.float64]


@dataclass(frozen=True)
class PartChoice:
    """One of the tables ``[[parts]]``.

    Attributes:
        name: what is chosen: "spring".
        field: of the study file: "parts[0]".
        catalogue: where from.
        parts: which of its parts.
        count: how many of the chosen one are built in.
        settings, limits: what it sets, and what it allows.
    """

    name: str
    field: str
    catalogue: Catalogue
    parts: tuple[int, ...]
    count: int
    settings: tuple[PartSetting, ...]
    limits: tuple[PartLimit, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Of the parts."""
        return tuple(self.catalogue.names[part] for part in self.parts)

    def numbers(self, column: str, unit: str) -> NDArray[np.float64]:
        """What the catalogue states of each part."""
        return self.catalogue.numbers(self.field, column, unit, self.parts)

    def words(self, index: int) -> str:
        """A part with what a buyer wants to know: "2 of DF-0940 (Acme, 3.10 EUR, 14 g)"."""
        part, columns = self.parts[index], self.catalogue.columns
        told = [columns[MAKER].cells[part]] if MAKER in columns else []
        told += [f"{columns[name].cells[part]} {columns[name].unit}" for name in (PRICE, MASS)
                 if name in columns and columns[name].cells[part]]  # fmt: skip
        many = f"{self.count} of " if self.count > 1 else ""
        return f"{many}{self.names[index]}" + (f" ({', '.join(filter(None, told))})" if any(told) else "")


def choices_of(varied: Sequence[Varied]) -> list[PartChoice]:
    """Those of ``varied`` that are parts."""
    return [one.parts for one in varied if one.parts is not None]


def parts_of(sections: Sequence[Section], folder: Path) -> tuple[Varied, ...]:
    """The choices that the tables ``[[parts]]`` state; catalogues' paths start at ``folder``."""
    found: list[Varied] = []
    for section in sections:
        choice = _choice(section, folder)
        if choice.name in [one.quantity.name for one in found]:
            raise GivewayError(section.full("name"), choice.name, "a name of its own")
        quantity = Quantity(choice.name, "", "choice", 0.0, len(choice.parts) - 1.0, (), choice.names)
        nominal = None
        if "nominal" in section.values:
            nominal = value_of(section.full("nominal"), section.values["nominal"], quantity)
        levels = tuple(float(level) for level in range(len(choice.parts)))
        found.append(Varied(quantity, nominal, levels, field=section.name, parts=choice))
    return tuple(found)


def _choice(section: Section, folder: Path) -> PartChoice:
    section.required("name", "what is chosen, such as spring")
    name = section.text("name")
    if not _NAME.fullmatch(name):
        raise GivewayError(section.full("name"), name, "a letter, then up to 39 letters, digits, spaces, _ and -")
    if name in (*_TAKEN, *SUMS, *all_metrics()):
        raise GivewayError(section.full("name"), name, "a name that means nothing else in a study")
    section.required("catalogue", "a CSV file, its path seen from this file")
    file = folder / section.text("catalogue")
    if not file.is_file():
        raise GivewayError(section.full("catalogue"), section.values["catalogue"], "a CSV file, seen from this file")
    catalogue = read_catalogue(file)
    parts = _only(section, catalogue)
    count = section.whole("count", 1)
    settings = [_setting(field, name, text, catalogue, parts, count) for field, name, text in _pairs(section, "sets")]
    limits = [
        PartLimit(*_limit(field, name, text, catalogue, parts, sense))
        for key, sense in (("at_most", 1), ("at_least", -1))
        for field, name, text in _pairs(section, key)
    ]
    written = [column for one in settings for column in one.quantity.columns or (one.quantity.name,)]
    if len(set(written)) != len(written):
        raise GivewayError(section.full("sets"), "twice the same parameter", "each of them once")
    return PartChoice(name, section.name, catalogue, parts, count, tuple(settings), tuple(limits))


def _only(section: Section, catalogue: Catalogue) -> tuple[int, ...]:
    """The parts that the table admits."""
    if "only" not in section.values:
        return tuple(range(len(catalogue.lines)))
    names = section.values["only"]
    for index, name in enumerate(names):
        field = f"{section.full('only')}[{index}]"
        if name not in catalogue.names:
            raise UnknownNameError(field, str(name), catalogue.names)
        if name in names[:index]:
            raise GivewayError(field, name, "each part once")
    return tuple(catalogue.names.index(name) for name in names)


def _pairs(section: Section, key: str) -> list[tuple[str, str, str]]:
    """Field, quantity and column's name of each line of a table of the parts."""
    found = []
    for name, column in scalars(section.values.get(key, {})):
        field = f"{section.full(key)}.{name}"
        if not isinstance(column, str):
            raise GivewayError(field, column, "the name of a column in quotes")
        found.append((field, name, column))
    return found


def _setting(field: str, name: str, text: str, catalogue: Catalogue, parts: tuple[int, ...], count: int) -> PartSetting:
    quantity = find(field, name)
    found = _COLUMN.fullmatch(text.strip())
    assert found is not None
    title, times = found[1], {"*": float(count), "/": 1.0 / count, None: 1.0}[found[2]]
    if times != 1.0 and quantity.kind != "real":
        raise GivewayError(field, text, f"a column alone: {name} is no real number")
    column = catalogue.column(field, title)
    real = quantity.kind == "real"
    values = catalogue.numbers(field, title, quantity.unit, parts) if real else np.zeros(len(parts))
    for index, part in enumerate(parts):
        cell = values[index] * times if real else _whole_or_text(column.cells[part], quantity)
        try:
            values[index] = value_of(column.title, cell, quantity)
        except GivewayError as error:
            raise catalogue.wrong(part, column, f"{error.allowed}, {name}") from None
    return PartSetting(quantity, title, 1.0 / times, values)


def _whole_or_text(cell: str, quantity: Quantity) -> Any:
    if quantity.kind == "boolean":
        return {"true": True, "false": False}.get(cell.lower(), cell)
    if quantity.kind == "integer" and re.fullmatch(r"-?\d+", cell):
        return int(cell)
    return cell


def _limit(
    field: str, name: str, title: str, catalogue: Catalogue, parts: tuple[int, ...], sense: int
) -> tuple[Quantity, int, str, NDArray[np.float64]]:
    quantity = find(field, name)
    if quantity.kind != "real":
        raise GivewayError(field, name, "a quantity of real numbers")
    return quantity, sense, title, catalogue.numbers(field, title, quantity.unit, parts)


def part_metric(field: str, name: str, choices: Sequence[PartChoice]) -> Metric:
    """Price or mass of all parts of a design; errors name ``field``."""
    column = SUMS[name]
    if not choices:
        raise GivewayError(field, name, "[[parts]] whose catalogues state it")
    for choice in choices:
        choice.catalogue.column(choice.field, column)
    if column == MASS:
        for choice in choices:
            choice.numbers(MASS, "kg")
        return Metric(name, "kg", name)
    units = [choice.catalogue.columns[PRICE].unit or "" for choice in choices]
    for choice, unit in zip(choices, units, strict=True):
        if unit != units[0]:
            raise GivewayError(f"{choice.field}.catalogue", unit, f"{units[0]}, the other catalogues' currency")
        choice.numbers(PRICE, unit)
    return Metric(name, units[0], name)


def part_lines(varied: Sequence[Varied], design: NDArray[np.float64]) -> list[str]:
    """A line per choice: which part ``design`` has."""
    return [f"{one.parts.name}: {one.parts.words(int(value))}" for one, value in zip(varied, design, strict=True)
            if one.parts is not None]  # fmt: skip


def known_sums(choices: Sequence[PartChoice]) -> list[Metric]:
    """Those of `SUMS` that every catalogue states."""
    found = []
    for name in SUMS:
        try:
            found.append(part_metric("", name, choices))
        except GivewayError:
            continue
    return found


def part_sums(varied: Sequence[Varied], designs: NDArray[np.float64]) -> dict[str, tuple[NDArray[np.float64], str]]:
    """Price and mass of all parts of each design, as far as the catalogues state them, and their units."""
    found = {}
    for metric in known_sums(choices_of(varied)):
        total = np.zeros(len(designs))
        for j, one in enumerate(varied):
            if one.parts is not None:
                each = one.parts.numbers(SUMS[metric.name], metric.unit)
                total += one.parts.count * each[designs[:, j].astype(np.intp)]
        found[metric.name] = (total, metric.unit)
    return found
