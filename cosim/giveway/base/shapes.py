"""What a file may hold, as data: `toml_sections.Section` checks by it, and `giveway schema` writes it for editors."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from giveway.base.checks import finite, whole
from giveway.base.errors import GivewayError, UnknownNameError

__all__ = [
    "Angle",
    "Choice",
    "Either",
    "Flag",
    "List",
    "Measure",
    "Names",
    "Nothing",
    "Number",
    "Pair",
    "Rows",
    "Shape",
    "Table",
    "Text",
    "Variants",
    "Version",
    "Whole",
]

Schema = dict[str, Any]


@dataclass(frozen=True)
class Shape:
    """One value; ``about`` is what an editor shows."""

    about: str = ""

    def check(self, field: str, value: Any) -> None:
        """Refuse what it cannot be; tables are checked where they are opened."""

    def schema(self) -> Schema:
        """The same in JSON Schema, 2020-12."""
        return {"description": self.about} if self.about else {}


@dataclass(frozen=True)
class Number(Shape):
    """A finite number from ``low`` to ``high``."""

    low: float = -math.inf
    high: float = math.inf
    unit: str = ""

    def check(self, field: str, value: Any) -> None:
        finite(field, finite(field, value), self.low, self.high, self.unit)

    def schema(self) -> Schema:
        about = f"{self.about}{', ' if self.about else ''}{self.unit}" if self.unit else self.about
        limits = {name: end for name, end in (("minimum", self.low), ("maximum", self.high)) if math.isfinite(end)}
        return {**({"description": about} if about else {}), "type": "number", **limits}


def Angle(about: str) -> Number:
    """Degrees."""
    return Number(about, -360.0, 360.0, "deg")


@dataclass(frozen=True)
class Version(Shape):
    """The number of the format."""

    number: int = 1

    def check(self, field: str, value: Any) -> None:
        if isinstance(value, bool) or value != self.number:
            raise GivewayError(field, value, str(self.number))

    def schema(self) -> Schema:
        return super().schema() | {"const": self.number}


@dataclass(frozen=True)
class Whole(Shape):
    """A whole number."""

    low: int = 0
    high: int = 2**31 - 1

    def check(self, field: str, value: Any) -> None:
        whole(field, value, self.low, self.high)

    def schema(self) -> Schema:
        return super().schema() | {"type": "integer", "minimum": self.low, "maximum": self.high}


@dataclass(frozen=True)
class Flag(Shape):
    """True or false."""

    def check(self, field: str, value: Any) -> None:
        if not isinstance(value, bool):
            raise GivewayError(field, value, "true or false")

    def schema(self) -> Schema:
        return super().schema() | {"type": "boolean"}


@dataclass(frozen=True)
class Nothing(Shape):
    """JSON's null."""

    def check(self, field: str, value: Any) -> None:
        if value is not None:
            raise GivewayError(field, value, "null")

    def schema(self) -> Schema:
        return super().schema() | {"type": "null"}


@dataclass(frozen=True)
class Text(Shape):
    """A text; with ``longest``, of 1 to so many characters."""

    longest: int = 0

    def check(self, field: str, value: Any) -> None:
        if not isinstance(value, str):
            raise GivewayError(field, value, "a text in quotes")
        if self.longest and not 1 <= len(value) <= self.longest:
            raise GivewayError(field, value, f"1 to {self.longest} characters")

    def schema(self) -> Schema:
        length = {"minLength": 1, "maxLength": self.longest} if self.longest else {}
        return super().schema() | {"type": "string"} | length


@dataclass(frozen=True)
class List(Shape):
    """A list of values of the same kind; ``allowed`` in words."""

    item: Shape = field(default_factory=Shape)
    allowed: str = "a list"
    least: int = 0

    def check(self, field: str, value: Any) -> None:
        if not isinstance(value, list) or len(value) < self.least:
            raise GivewayError(field, value, self.allowed)
        for index, one in enumerate(value):
            self.item.check(f"{field}[{index}]", one)

    def schema(self) -> Schema:
        return super().schema() | {"type": "array", "items": self.item.schema(), "minItems": self.least}


@dataclass(frozen=True)
class Choice(Shape):
    """One of some words."""

    names: Iterable[str] = ()

    def check(self, field: str, value: Any) -> None:
        if not isinstance(value, str):
            raise GivewayError(field, value, "a text in quotes")
        if value not in tuple(self.names):
            raise UnknownNameError(field, value, self.names)

    def schema(self) -> Schema:
        return super().schema() | {"enum": list(self.names)}


@dataclass(frozen=True)
class Pair(Shape):
    """A point, [x, y] in m, each from -``reach`` to ``reach``."""

    reach: float = math.inf

    def check(self, field: str, value: Any) -> None:
        if not isinstance(value, list) or len(value) != 2:
            raise GivewayError(field, value, "two numbers, [x, y] in m")
        for one in value:
            finite(field, one, -self.reach, self.reach, "m")

    def schema(self) -> Schema:
        items = Number("", -self.reach, self.reach).schema()
        return super().schema() | {"type": "array", "items": items, "minItems": 2, "maxItems": 2}


@dataclass(frozen=True)
class Table(Shape):
    """A table with these keys; those ``needed`` must be there."""

    keys: Mapping[str, Shape] = field(default_factory=dict)
    needed: tuple[str, ...] = ()

    def schema(self) -> Schema:
        properties = {key: shape.schema() for key, shape in self.keys.items()}
        found = super().schema() | {"type": "object", "properties": properties, "additionalProperties": False}
        return found | ({"required": list(self.needed)} if self.needed else {})


def Measure(about: str, value: Shape | None = None) -> Table:
    """A number with its unit."""
    keys = {"value": value or Number(), "unit": Text('its unit, such as "mm"')}
    return Table(about, keys, ("value", "unit"))


@dataclass(frozen=True)
class Rows(Shape):
    """One or more tables of the same kind."""

    row: Table = field(default_factory=Table)

    def schema(self) -> Schema:
        return super().schema() | {"type": "array", "items": self.row.schema()}


@dataclass(frozen=True)
class Names(Shape):
    """A table of texts, whose keys are names that may have dots."""

    allowed: str = "a table"

    def check(self, field: str, value: Any) -> None:
        if not isinstance(value, Mapping):
            raise GivewayError(field, value, self.allowed)

    def schema(self) -> Schema:
        return super().schema() | {"type": "object", "additionalProperties": {"type": ["string", "object"]}}


@dataclass(frozen=True)
class Variants(Shape):
    """A table whose other keys depend on the word at ``key``, which is needed."""

    key: str = "kind"
    tables: Mapping[str, Table] = field(default_factory=dict)

    def table(self, word: str) -> Table:
        """The keys that go with ``word``, ``key`` among them."""
        chosen = self.tables[word]
        return Table(self.about, {self.key: Choice(names=self.tables), **chosen.keys}, (self.key, *chosen.needed))

    def schema(self) -> Schema:
        every = {name: shape.schema() for word in self.tables for name, shape in self.tables[word].keys.items()}
        return super().schema() | {
            "type": "object",
            "properties": {self.key: {"enum": list(self.tables)}, **{key: {} for key in every}},
            "required": [self.key],
            "allOf": [
                {
                    "if": {"properties": {self.key: {"const": word}}, "required": [self.key]},
                    "then": self.table(word).schema(),
                }
                for word in self.tables
            ],
        }


@dataclass(frozen=True)
class Either(Shape):
    """One of several kinds of value, told apart by their types: a text, a number, a list or a table."""

    shapes: tuple[Shape, ...] = ()

    def check(self, field: str, value: Any) -> None:
        for shape in self.shapes:
            if _suits(shape, value):
                return shape.check(field, value)
        self.shapes[0].check(field, value)
        return None

    def schema(self) -> Schema:
        return super().schema() | {"anyOf": [shape.schema() for shape in self.shapes]}


def _suits(shape: Shape, value: Any) -> bool:
    """Whether ``value`` has the type of ``shape``."""
    if isinstance(value, bool):
        return isinstance(shape, Flag)
    if isinstance(value, str):
        return isinstance(shape, Text | Choice)
    if isinstance(value, int | float):
        return isinstance(shape, Number | Whole)
    if isinstance(value, Mapping):
        return isinstance(shape, Table | Variants | Names)
    return isinstance(shape, Rows | List | Pair)
