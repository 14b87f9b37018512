"""The robot file: every number of a robot with its unit, source, confidence and provenance.

`read_robot` is the only reader. The variable tables define the entries of a robot file and the units of the returned
values; other units of the same kind ("lb", "mm") are converted. Besides the numbers of the robot, which are needed, a
file may set parameters of the controller, and some of the testbed, that have start values of their own
(``[controller.channels.fast_rest]``), and what the controller believes of the motors (``[controller.motor.inertia]``).
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

from giveway.base import native
from giveway.base.checks import finite
from giveway.base.errors import FileError, GivewayError, InputFileError, nearest_names
from giveway.base.shapes import Choice, Flag, Shape, Table, Text, Version
from giveway.base.toml_lines import line_of
from giveway.base.toml_sections import Section, lines_named, read_toml
from giveway.base.units import factor
from giveway.robot.motor_current import GEAR, MOTOR, MOTOR_CURRENT, SENSING, from_motor, stated_by
from giveway.robot.motor_observer import BELIEFS, BUS, DELAY, INERTIA, delay_ticks, longest_delay
from giveway.robot.table_files import entry_unit, read_table_file, robot_paths

__all__ = ["CONFIDENCE", "PROVENANCE", "Entry", "Robot", "read_robot", "robot_shape"]

SCHEMA_VERSION = 1
PROVENANCE = ("given", "sourced", "fitted", "assumed")
CONFIDENCE = ("high", "medium", "low")
_HEADER = ("schema_version", "robot")  # entries that are not numbers
EQUIPMENT = ("imu",)
"""Parts that a robot may have and a robot file may leave out."""
LATER = (SENSING,)
"""Entries that a file from before they were known may leave out."""
SETTINGS: Mapping[str, tuple[str, ...]] = MappingProxyType({"controller": ("",), "testbed": ("imu.", "base.com_")})
"""By model: how the names begin of parameters that a robot file may set though they have start values of their own."""
BODY_HEIGHT = "outline.height"  # of the body's top; no model needs it, `giveway robot check` uses it
OUTLINE_COUNT = "outline.count"  # follows from the lists of corners
NO_SETTINGS = (
    OUTLINE_COUNT,
    "controller.period",
    "estimator.tare_ticks",
)  # plans and contacts are timed by the last two
_Number = float | int


@dataclass(frozen=True)
class Entry:
    """One number, or list of numbers, of a robot file; true and false are the numbers 1 and 0.

    Attributes:
        values: in ``unit``; a single number is a tuple of one, and a word is its number in the variable table.
        is_list: the file states a list.
        unit: of the variable tables; "1" for what has none.
        text: value with unit as in the file.
        scale: factor from the stated value to ``unit``.
        provenance: given, sourced, fitted or assumed; "" if the file does not say.
        confidence: high, medium or low; "" likewise.
        source, note: in words; "" likewise.
        follows: the entries that it follows from; "" if the file states it.
    """

    values: tuple[_Number, ...]
    is_list: bool
    unit: str
    text: str
    scale: float
    provenance: str
    confidence: str
    source: str
    note: str
    follows: str = ""


class Robot:
    """A robot file that has been read; values are addressed by their table path (``base.mass``)."""

    def __init__(self, path: Path, text: str, name: str, entries: Mapping[str, Entry]) -> None:
        """The file's entries; those that follow from others are added."""
        self.path, self.name = path, name
        self._text, self._entries = text, dict(entries)
        self._derived: dict[str, Entry] = {}
        self._derived = self._follow()

    def __getitem__(self, name: str) -> Entry:
        """The entry at ``name``, stated or following from others; FileError if the file does not have it."""
        if name in self._derived:
            return self._derived[name]
        if name not in self._entries:
            near = nearest_names(name, self._entries)
            hint = f"the file has {' and '.join(near)}" if near else "every value of the robot is needed"
            raise FileError(self.path, f"{name} is missing", hint)
        return self._entries[name]

    def value(self, name: str, index: int = 0) -> float | int:
        """The value at ``name`` in the unit of the variable tables; ``index`` selects from a list value."""
        entry = self[name]
        if not entry.is_list:
            return entry.values[0]
        return entry.values[index] if index < len(entry.values) else 0.0  # with a shorter list the rest is unused

    def __contains__(self, name: str) -> bool:
        """Whether the file has the entry ``name``, or it follows from others."""
        return name in self._entries or name in self._derived

    def does_without(self, name: str) -> bool:
        """Whether ``name`` belongs to equipment of which the file says nothing: its start values stay."""
        part = name.partition(".")[0]
        equipment = part in EQUIPMENT and not any(entry.startswith(f"{part}.") for entry in self._entries)
        return equipment or (name in LATER and name not in self._entries)

    @property
    def motor_current(self) -> bool:
        """Torque is sensed by the motors' current: the gears' friction is in it."""
        return SENSING in self._entries and self._entries[SENSING].text == MOTOR_CURRENT

    def follows_from(self, name: str) -> str | None:
        """The entry that the number ``name`` follows from; None if the file states it itself."""
        return self._derived[name].follows if name in self._derived else None

    def entries(self) -> Iterator[tuple[str, Entry]]:
        """Every number that the file states, with its name, in the order of the file."""
        yield from ((name, entry) for name, entry in self._entries.items() if name != SENSING)

    def count(self, name: str) -> int:
        """Number of values at ``name``: the length of a list, 1 for a single number."""
        return len(self[name].values)

    def refusal(self, name: str, allowed: str) -> GivewayError:
        """The error, with file and line, for a value at ``name`` that is not ``allowed``."""
        entry = self[name]
        values = ", ".join(f"{value:g}" for value in entry.values)
        converted = f" ({values} {entry.unit})" if entry.scale != 1.0 else ""
        cause = GivewayError(name, entry.text + converted, allowed)
        stated = (self.follows_from(name) or name).partition(" ")[0]  # the first of several
        return InputFileError(self.path, line_of(self._text, f"{stated}.value"), cause)

    def _follow(self) -> dict[str, Entry]:
        """What follows from other entries."""
        return (self._follow_currents() if self.motor_current else {}) | self._follow_observer()

    def _follow_currents(self) -> dict[str, Entry]:
        """Where torque is sensed by current: the torque signal's numbers from those of the motors, and what the
        controller knows of the gears, unless the file states it, from the drivetrain's."""
        missing = [name for name in MOTOR if name not in self._entries]
        if missing:
            hint = f'with {SENSING} = "{MOTOR_CURRENT}" a robot file states {", ".join(MOTOR)}'
            raise FileError(self.path, f"{missing[0]} is missing", hint)
        found: dict[str, Entry] = {}
        for name, value in from_motor({key: float(self._entries[key].values[0]) for key in MOTOR}).items():
            if name in self._entries:
                allowed = f'left out: with {SENSING} = "{MOTOR_CURRENT}" it follows from {stated_by(name)}'
                raise self.refusal(name, allowed)
            found[name] = _derived(stated_by(name), value, "N.m", self._entries[stated_by(name)])
        for name, origins in GEAR.items():
            # A file without one of them is refused by who needs it.
            if name not in self._entries and all(origin in self._entries for origin in origins):
                value = sum(float(self._entries[origin].values[0]) for origin in origins)
                last = self._entries[origins[-1]]
                found[name] = _derived(stated_by(name), value, last.unit, last)
        return found

    def _follow_observer(self) -> dict[str, Entry]:
        """What the controller's observer of the motors is told, unless the file states it: when a command shows in the
        samples, and an inertia of 0 where it cannot work."""
        bus = self._entries.get(BUS)
        ticks = None if bus is None or DELAY in self._entries else delay_ticks(bus.values[0], bus.values[0])
        late = ticks is not None and ticks > longest_delay()
        cause = SENSING if self.motor_current else BUS if late else None
        found: dict[str, Entry] = {}
        if ticks is not None and not late:
            found[DELAY] = _derived(BUS, ticks, "1", self._entries[BUS])
        if cause is not None and INERTIA not in self._entries:
            found[INERTIA] = _derived(cause, 0.0, "kg.m2", self._entries[cause])
        elif cause is not None and self._entries[INERTIA].values[0] != 0.0:
            why = "motors are observed by the torque behind their gears"
            if cause == BUS:
                why = f"a command shows {ticks:g} ticks later, and the controller remembers {longest_delay()}"
            raise self.refusal(INERTIA, f"0: with {cause} = {self._entries[cause].text}, {why}")
        return found


def _derived(origin: str, value: float, unit: str, stated: Entry) -> Entry:
    """An entry with this value that follows from ``origin``, and the remarks of ``stated``, which is part of that."""
    source = f"follows from {origin}: {stated.source}" if stated.source else f"follows from {origin}"
    text = f"{value:g}" if unit == "1" else f"{value:g} {unit}"
    return Entry((value,), False, unit, text, 1.0, stated.provenance, stated.confidence, source, stated.note, origin)


def read_robot(path: Path) -> Robot:
    """Read and check the robot file ``path``.

    Raises:
        FileError: the file cannot be read.
        InputFileError: it is not TOML, or a table, key, word or unit in it is unknown, or of the wrong type or kind;
            names file and line.
    """
    text, document = read_toml(path, "give the path of a robot file (TOML)")
    with lines_named(path, text):
        known = _known()
        top = Section("", document, robot_shape())
        top.required("schema_version", str(SCHEMA_VERSION))
        header = top.table("robot")
        name = "" if header is None else header.text("name", "")
        entries = {name: _entry(name, values, known[name]) for name, values in _stated(top)}
        x, y = entries.get("outline.x"), entries.get("outline.y")
        if x is not None and y is not None and len(x.values) != len(y.values):
            allowed = f"as many as outline.x has, {len(x.values)}: every corner has both"
            raise GivewayError("outline.y.value", f"{len(y.values)} numbers", allowed)
    return Robot(path, text, name, entries)


def _stated(top: Section) -> Iterator[tuple[str, Any]]:
    """Name and table of every entry, in the order of the file."""
    for part in top.values:
        section = top.table(part) if part not in _HEADER else None
        for key in section.values if section is not None else ():
            assert section is not None
            if part not in SETTINGS:
                yield section.full(key), section.values[key]
                continue
            group = section.table(key)
            assert group is not None
            yield from ((group.full(name), value) for name, value in group.values.items())


@functools.cache
def robot_shape() -> Table:
    """What a robot file may hold."""
    parts: dict[str, dict[str, Shape]] = {}
    settings: dict[str, dict[str, dict[str, Shape]]] = {}
    for name, known in _known().items():
        part, _, key = name.partition(".")
        if part in SETTINGS:
            group, _, setting = key.partition(".")
            settings.setdefault(part, {}).setdefault(group, {})[setting] = _entry_shape(known)
        else:
            parts.setdefault(part, {})[key] = _entry_shape(known)
    about = "parameters of this model that have start values of their own"
    return Table(
        "a robot, each number with its unit and where it comes from",
        {
            "schema_version": Version("of this format", SCHEMA_VERSION),
            "robot": Table("", {"name": Text("what it is called")}),
            **{part: Table("", keys) for part, keys in parts.items()},
            **{
                model: Table(about, {key: Table("", one) for key, one in found.items()})
                for model, found in settings.items()
            },
        },
        ("schema_version",),
    )


def _entry_shape(known: _Known) -> Table:
    """The table of an entry."""
    alone = known.is_flag or bool(known.words)
    value: Shape = Choice("", known.words) if known.words else Flag() if known.is_flag else _Values("", known)
    keys = {
        "value": value,
        "unit": Text("left out" if alone else f"{known.unit}, or a unit of the same kind"),
        "provenance": Choice("where it comes from", PROVENANCE),
        "confidence": Choice("how sure it is", CONFIDENCE),
        "source": Text("in words"),
        "note": Text("in words"),
    }
    return Table("", keys, ("value",) if alone else ("value", "unit"))


@dataclass(frozen=True)
class _Values(Shape):
    """A number, or a list of them."""

    known: _Known = field(default_factory=lambda: _Known(""))

    @property
    def _least(self) -> int:
        return self.known.least or 1

    def check(self, field: str, value: Any) -> None:
        count = self.known.count
        if isinstance(value, list) and not (count is not None and self._least <= len(value) <= count):
            numbers = f"{count} numbers" if self.known.least == count else f"1 to {count} numbers"
            raise GivewayError(field, value, "one number" if count is None else f"a list of {numbers}")
        for index, item in enumerate(value if isinstance(value, list) else [value]):
            finite(f"{field}[{index}]" if isinstance(value, list) else field, item)

    def schema(self) -> dict[str, Any]:
        number = {"type": "number"}
        if self.known.count is None:
            return number
        return {
            "anyOf": [number, {"type": "array", "items": number, "minItems": self._least, "maxItems": self.known.count}]
        }


def _entry(name: str, values: Any, known: _Known) -> Entry:
    """The entry ``name``, converted to the unit of its table."""
    unit, count = known.unit, known.count
    if not isinstance(values, dict):
        alone = known.is_flag or known.words
        stated = "value = ..." if alone else f'value = ..., unit = "{unit}"'
        raise GivewayError(name, values, f"a table with value{'' if alone else ' and unit'}, {name} = {{ {stated} }}")
    section = Section(name, values, _entry_shape(known))
    if known.words:
        word = section.choice("value", known.words)
        if "unit" in section.values:
            raise GivewayError(section.full("unit"), section.values["unit"], "left out: it is a word")
        return Entry((known.words.index(word),), False, "1", word, 1.0, *_remarks(section))
    if known.is_flag:
        section.required("value", "true or false")
        flag = section.flag("value", False)
        return Entry((int(flag),), False, "1", str(flag).lower(), 1.0, *_remarks(section))
    stated = section.required("value", "a finite number" if count is None else f"up to {count} finite numbers")
    items = stated if isinstance(stated, list) else [stated]
    field = section.full("value")
    section.required("unit", f'"{unit}"' + (", or a unit of the same kind" if unit != "1" else ""))
    stated_unit = section.text("unit")
    scale = 1.0 if stated_unit == unit else factor(section.full("unit"), stated_unit, unit)
    if name in MOTOR:
        _, low, high = MOTOR[name]
        finite(field, items[0] * scale, low, high, unit)
    shown = ", ".join(f"{item:g}" for item in items)
    return Entry(
        tuple(items) if scale == 1.0 else tuple(item * scale for item in items),
        isinstance(stated, list),
        unit,
        shown if stated_unit == "1" else f"{shown} {stated_unit}",
        scale,
        *_remarks(section),
    )


def _remarks(section: Section) -> tuple[str, str, str, str]:
    """Provenance, confidence, source and note of an entry."""
    return (
        section.choice("provenance", PROVENANCE) if "provenance" in section.values else "",
        section.choice("confidence", CONFIDENCE) if "confidence" in section.values else "",
        section.text("source", ""),
        section.text("note", ""),
    )


@dataclass(frozen=True)
class _Known:
    """What a robot file may state under a name: how many numbers (None: one), how many at least in a list, or words."""

    unit: str
    count: int | None = None
    least: int | None = None
    is_flag: bool = False
    words: tuple[str, ...] = ()  # one of them instead of a number


@functools.cache
def _known() -> Mapping[str, _Known]:
    """Every name that a robot file may have."""
    known: dict[str, _Known] = {
        BODY_HEIGHT: _Known("m"),
        **{name: _Known(unit) for name, (unit, _, _) in MOTOR.items()},
    }
    settings: dict[str, _Known] = {}
    for model in (*native.MODELS, *native.COMPONENTS):
        for variable in read_table_file(native.variables(model))["variable"]:
            unit, count = entry_unit(variable) or "1", variable.get("count")
            paths = list(robot_paths(variable))
            for name in paths:
                words = tuple(choice.replace("_", " ") for choice in variable.get("choices", ()))
                known.setdefault(name, _Known(unit, count, words=words))
            beginnings = SETTINGS.get(model, ())
            own = not paths or variable["name"].startswith(BELIEFS)
            free = variable["causality"] == "parameter" and own and variable["name"] not in NO_SETTINGS
            if free and variable["name"].startswith(beginnings):
                name = f"{model}.{variable['name']}"
                settings[name] = _Known(unit, count, count, variable["type"] == "boolean")
    return known | settings
