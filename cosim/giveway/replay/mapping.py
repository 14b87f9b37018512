"""Which column of a log is which quantity: by its name, by a file (`--columns`) or by flags (`--column`)."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from giveway.base.errors import FileError, GivewayError, UnknownNameError, nearest_names
from giveway.base.toml_sections import Section, lines_named, read_toml
from giveway.base.units import factor
from giveway.replay.quantities import ANGLES, CALIBRATION_UNITS, QUANTITIES, TIME, TORQUES, of_wheels
from giveway.replay.source import Head, Source
from giveway.robot.wheels import WHEELS

__all__ = ["Chosen", "Column", "Wishes", "choose", "read_wishes", "wish"]

_TEXT = re.compile(
    r"(?P<sign>-?)\s*(?P<name>[^\[\]]*[^\[\]\s](?:\[\d+\])?)\s*(?:\[\s*(?P<unit>[^\[\]\d][^\[\]]*?)\s*\])?"
)
_FMU = {one.controller: name for name, one in QUANTITIES.items() if one.controller is not None}
_AMPERE = {"A": 1.0, "mA": 1e-3}
_LISTS = (*ANGLES, *TORQUES)
_SINGLE = tuple(name for name in QUANTITIES if name.rpartition("_")[0] not in _LISTS)


@dataclass(frozen=True)
class Wish:
    """A column as the user wrote it: ``-torque_b [mN.m]``; ``key`` names it in messages."""

    key: str
    column: str
    unit: str | None
    sign: float


@dataclass(frozen=True)
class Wishes:
    """What the user says of the columns: per quantity; the joints of the wheels, in their order."""

    columns: Mapping[str, Wish] = field(default_factory=dict)
    joints: tuple[str, ...] | None = None


@dataclass(frozen=True)
class Column:
    """A column of the log for a quantity: ``scale`` converts it, with its sign."""

    quantity: str
    index: int
    head: Head
    scale: float

    @property
    def words(self) -> str:
        """For the report: "torque_1 = -tau_b, in mN.m"."""
        unit = f" [{self.head.unit}]" if self.head.unit not in (None, "1") else ""
        if self.scale > 0.0 and self.head.name == self.quantity:
            return f"{self.quantity}{unit}"
        return f"{self.quantity} = {'-' if self.scale < 0.0 else ''}{self.head.name}{unit}"


@dataclass(frozen=True)
class Chosen:
    """The columns of a log, and what was assumed of them, one sentence each.

    Attributes:
        angle, torque: which of `ANGLES` and `TORQUES` the log has.
    """

    columns: tuple[Column, ...]
    angle: str
    torque: str
    said: tuple[str, ...]

    def has(self, *quantities: str) -> bool:
        names = {column.quantity for column in self.columns}
        return all(name in names for name in quantities)


def wish(key: str, text: object) -> Wish:
    """A column as in ``text``."""
    allowed = "the name of a column, with its unit in brackets if the log does not state it, - before it turns the sign"
    found = _TEXT.fullmatch(text.strip()) if isinstance(text, str) else None
    if found is None:
        raise GivewayError(key, text, allowed)
    return Wish(key, found["name"], found["unit"], -1.0 if found["sign"] else 1.0)


def read_wishes(path: Path | None, flags: Sequence[str], joints: str | None) -> Wishes:
    """From the file of `--columns` and the flags `--column torque_1=NAME`, which win."""
    columns: dict[str, Wish] = {}
    named: tuple[str, ...] | None = None
    if path is not None:
        text, document = read_toml(path, "give a file that names columns (TOML)")
        with lines_named(path, text):
            top = Section("", document, (*_LISTS, *_SINGLE, "joints"))
            for key, value in top.values.items():
                if key == "joints":
                    named = _joints(key, value)
                elif key in _LISTS:
                    columns |= dict(zip(of_wheels(key), _list(key, value), strict=True))
                else:
                    columns[key] = wish(key, value)
    for flag in flags:
        name, equals, value = flag.partition("=")
        if not equals:
            raise GivewayError("--column", flag, "QUANTITY=COLUMN, e.g. torque_1=-tau_b [mN.m]")
        if name.strip() not in QUANTITIES:
            raise UnknownNameError("--column", name.strip(), QUANTITIES)
        columns[name.strip()] = wish(f"--column {name.strip()}", value)
    if joints is not None:
        named = _joints("--joints", [joint.strip() for joint in joints.split(",")])
    return Wishes(columns, named)


def _list(key: str, value: Any) -> list[Wish]:
    if not isinstance(value, list) or len(value) != WHEELS:
        raise GivewayError(key, value, f"a list of {WHEELS} columns, in the order of the wheels")
    return [wish(key, one) for one in value]


def _joints(key: str, value: Any) -> tuple[str, ...]:
    if not isinstance(value, list) or len(value) != WHEELS or not all(isinstance(one, str) and one for one in value):
        raise GivewayError(key, value, f"{WHEELS} names of joints, in the order of the wheels")
    return tuple(value)


def choose(source: Source, wishes: Wishes) -> Chosen:
    """The columns of ``source``; FileError or GivewayError names what is missing or does not go together."""
    found: dict[str, Column] = {}
    for index, head in enumerate(source.heads):
        quantity, unit = _quantity_of(head)
        if quantity is None or quantity in wishes.columns:
            continue
        if quantity in found:
            raise FileError(source.path, f"{head.name} and {found[quantity].head.name} say the same thing", "give one")
        found[quantity] = _column(source, quantity, index, Head(head.name, unit), 1.0)
    for quantity, wanted in wishes.columns.items():
        found[quantity] = _wished(source, quantity, wanted)
    if TIME not in found:
        raise _missing(source, TIME)
    said: list[str] = []
    angle, torque = (_kind(source, kinds, found, said) for kinds in (ANGLES, TORQUES))
    in_order = sorted(found.values(), key=lambda column: column.quantity != TIME)  # the time first
    return Chosen(tuple(in_order), angle, torque, tuple(said))


def _quantity_of(head: Head) -> tuple[str | None, str | None]:
    """The quantity that a head names without being asked, and its unit."""
    if head.name in QUANTITIES:
        return head.name, head.unit
    model, _, name = head.name.partition(".")
    if model in ("controller", "testbed") and name in _FMU:
        return _FMU[name], head.unit
    stem, _, ending = head.name.rpartition("_")
    if head.unit is None and ending in CALIBRATION_UNITS:
        # where `giveway calibrate` has counts on the motor side, they are the encoder's
        kind, _, wheel = stem.rpartition("_")
        if ending == "counts" and kind == "motor_angle":
            return f"encoder_{wheel}", "1"
        if stem in QUANTITIES:
            return stem, CALIBRATION_UNITS[ending]
    return None, None


def _wished(source: Source, quantity: str, wanted: Wish) -> Column:
    names = [head.name for head in source.heads]
    if wanted.column not in names:
        raise UnknownNameError(wanted.key, wanted.column, names)
    index = names.index(wanted.column)
    stated = _quantity_of(source.heads[index])[1] or source.heads[index].unit
    if wanted.unit is not None and stated is not None and wanted.unit != stated:
        raise GivewayError(wanted.key, f"{wanted.column} [{wanted.unit}]", f"{stated}, which the log states")
    return _column(source, quantity, index, Head(wanted.column, wanted.unit or stated), wanted.sign)


def _column(source: Source, quantity: str, index: int, head: Head, sign: float) -> Column:
    unit = QUANTITIES[quantity].unit
    if head.unit is None and unit != "1":
        allowed = f"its unit in brackets, {quantity} [{unit}]"
        raise FileError(source.path, f"column {index + 1}, {head.name}, states no unit", f"give {allowed}")
    if unit == "A" and head.unit in _AMPERE:
        scale = _AMPERE[head.unit]
    elif head.unit is None or (unit == "1" and head.unit in ("counts", "")):
        scale = 1.0
    else:
        try:
            scale = factor(head.name, head.unit, unit)
        except GivewayError as error:
            raise FileError(source.path, f"column {index + 1}, {error}") from None
    return Column(quantity, index, head, sign * scale)


def _kind(source: Source, kinds: Sequence[str], found: dict[str, Column], said: list[str]) -> str:
    """Which of ``kinds`` the log has, of every wheel; the others are left out, and said."""
    complete = [kind for kind in kinds if all(name in found for name in of_wheels(kind))]
    if not complete:
        begun = [kind for kind in kinds if any(name in found for name in of_wheels(kind))]
        missing = next(name for name in of_wheels((begun or kinds)[-1 if not begun else 0]) if name not in found)
        raise _missing(source, missing)
    for kind in kinds:
        if kind != complete[0] and any(found.pop(name, None) is not None for name in of_wheels(kind)):
            for name in of_wheels(kind):
                found.pop(name, None)
            said.append(f"the log has {complete[0]} and {kind}; {complete[0]} was taken")
    return complete[0]


def _missing(source: Source, quantity: str) -> FileError:
    unit = QUANTITIES[quantity].unit
    heads = [head.name for head in source.heads]
    near = nearest_names(quantity, heads)
    hint = f" (it has {' and '.join(near)})" if near else f" (it has {', '.join(heads[:12])})"
    alternatives = next((kinds for kinds in (ANGLES, TORQUES) if quantity.rpartition("_")[0] in kinds), ())
    others = [f"{kind}_0 ..." for kind in alternatives if not quantity.startswith(kind)]
    more = f", or {' or '.join(others)}" if others else ""
    unit_text = f" [{unit}]" if unit != "1" else ""
    return FileError(
        source.path,
        f"there is no column for {quantity}{hint}",
        f"needed: {quantity}{unit_text}{more}; --columns or --column says which column it is",
    )
