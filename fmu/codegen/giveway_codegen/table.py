"""Reads and checks a variable table (TOML) against a robot file (TOML)."""

from __future__ import annotations

import hashlib
import math
import re
import tomllib
import uuid
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from .errors import TableError
from .types import Quantity, quantity_of
from .units import DISPLAY_UNITS, base_units, default_display_unit

__all__ = ["RETURNED", "Group", "Table", "Variable", "expanded", "read_table"]

SCHEMA_VERSION = 1
TIME_REFERENCE = 0  # the independent variable of FMI 3
INT32_MIN, INT32_MAX = -(2**31), 2**31 - 1

Value = float | int | bool

_MODEL_KEYS = {"name", "description", "step_size_s", "shares", "c_core"}
# Keys that a shared entry may have; the rest comes from the other table's entry.
_SHARED_KEYS = {"reference", "shared", "description", "minimum", "maximum", "dependencies"}
_STATE_KEYS = {"reference", "name", "count", "unit", "display_unit", "nominal", "dependencies", "description"}
_INDICATOR_KEYS = {"reference", "name", "count", "description"}
# A state and its derivative: der(x) has the reference of x plus this.
DERIVATIVE_OFFSET = 1000
# The last state of every model that has any; the shell counts with it (fmu/shell/instance.hpp).
_DISCONTINUITIES = {
    "name": "state.discontinuities",
    "reference": 2999,
    "unit": "1",
    "nominal": 1.0,
    "dependencies": [],
    "description": "Events of Model Exchange so far in which inputs or equations jumped; it changes with them, for "
    "importers that restart their solver only when a state has changed",
}
_VARIABLE_KEYS = {
    "reference", "name", "count", "causality", "type", "unit", "start", "minimum", "maximum", "nominal",
    "allow_nonfinite", "dependencies", "description", "display_unit", "plant",
    "choices", "c_core", "paper",
}  # fmt: skip
# Types of plant parameters by the types of their variables; an integer may also be an enumeration.
_PLANT_TYPES = {"real": ("number", "divisor", "wheels"), "integer": ("whole", "number"), "boolean": ("whole",)}
_ENUMERATION = re.compile(r"[A-Z][A-Za-z]*")
_NAME = re.compile(r"[a-z][a-z0-9_]*(\.[a-z][a-z0-9_]*)*")
# A member of a struct of c_core; `[i]` is the element of a variable with a count.
_MEMBER = re.compile(r"[a-z]\w*(\[i\])?(\.[a-z]\w*(\[i\])?)*")
RETURNED = "()"  # instead of a member: what a step returns


@dataclass(frozen=True)
class Variable:
    """One scalar variable, as an importer sees it."""

    reference: int
    name: str
    start: Value | None
    robot_path: str | None  # path of the start value in the robot file


@dataclass(frozen=True)
class Group:
    """One entry of the table: a scalar, or ``count`` scalars ``name[0]``, ``name[1]``, ..."""

    name: str
    identifier: str
    count: int | None
    causality: str
    type: str
    unit: str | None
    minimum: Value | None
    maximum: Value | None
    nominal: float | None
    allow_nonfinite: bool
    # Groups that an output depends on within the same instant: inputs and, in Model Exchange, states. None: all states.
    dependencies: tuple[str, ...] | None
    description: str
    variables: tuple[Variable, ...]
    role: str | None = None  # of a local variable: "state", "derivative" or "indicator"
    display_unit: str | None = None  # unit that an importer may show instead
    # Type of the plant's parameter of this name, if it is one. Importers do not see it, so it is not in the token.
    plant: str | None = field(default=None, repr=False)
    choices: tuple[str, ...] = field(default=(), repr=False)  # names of the values 0, 1, ... of an enumeration
    c_core: str | None = field(default=None, repr=False)  # member of the module's configuration, input or output

    @property
    def quantity(self) -> Quantity | None:
        """The type definition that it belongs to; event indicators have none."""
        found = None if self.role == "indicator" else quantity_of(self.type, self.unit, self.minimum)
        return None if found is None else found.shown_in(self.display_unit)

    @property
    def size(self) -> float | None:
        """Nominal value: the table's, or else that of its quantity; None for constants and for indicators."""
        if self.nominal is not None or self.type != "real" or self.causality == "parameter" or self.role == "indicator":
            return self.nominal
        return None if self.quantity is None else self.quantity.nominal


@dataclass(frozen=True)
class Table:
    """A checked table; ``groups`` in the order of their references."""

    name: str
    description: str
    step_size: float
    groups: tuple[Group, ...]
    # The module of c_core whose configuration, input and output the variables are.
    c_core: str | None = field(default=None, repr=False)

    @property
    def scalars(self) -> list[tuple[Group, Variable]]:
        return [(group, variable) for group in self.groups for variable in group.variables]

    def members(self, names: tuple[str, ...]) -> list[Variable]:
        """The scalars of the groups called ``names``, in the order of the table."""
        return [variable for group, variable in self.scalars if group.name in names]

    def with_role(self, role: str) -> list[tuple[Group, Variable]]:
        """States, their derivatives, or event indicators, in the order in which an importer gets them."""
        return [(group, variable) for group, variable in self.scalars if group.role == role]

    @property
    def has_equations(self) -> bool:
        """Whether it has states, so Model Exchange besides Co-Simulation."""
        return any(group.role == "state" for group in self.groups)

    @property
    def plant_parameters(self) -> list[Group]:
        """The groups that are parameters of the plant."""
        return [group for group in self.groups if group.plant is not None]

    def followed(self, group: Group) -> list[Variable]:
        """What ``group``, an output or a derivative, depends on within the same instant: inputs and states."""
        if group.dependencies is None:
            return [v for group, v in self.with_role("state") if group.name != _DISCONTINUITIES["name"]]
        return self.members(group.dependencies)

    @property
    def quantities(self) -> list[Quantity]:
        """The types in use, by name."""
        used = {group.quantity for group in self.groups} - {None}
        return sorted((q for q in used if q is not None), key=lambda quantity: quantity.name)

    @property
    def units(self) -> dict[str, dict[str, int]]:
        """The units in use with their SI exponents, always including the second (the unit of time)."""
        names = {group.unit for group in self.groups if group.unit} | {"s"}
        return {name: base_units(name) for name in sorted(names)}

    @property
    def token(self) -> str:
        """Instantiation token: a hash of everything in the table, resolved start values included."""
        text = repr(self).encode()
        return "{" + str(uuid.UUID(bytes=hashlib.sha256(text).digest()[:16])) + "}"


def _read_toml(path: Path) -> dict[str, Any]:
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise TableError(f"{path}: cannot be read: {error.strerror}") from error
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise TableError(f"{path}: not valid TOML: {error}") from error
    if document.get("schema_version") != SCHEMA_VERSION:
        found = document.get("schema_version")
        raise TableError(f"{path}: schema_version: {found!r}, but this version reads {SCHEMA_VERSION}")
    return document


def _robot_entry(robot: dict[str, Any], path: str) -> dict[str, Any] | None:
    entry: Any = robot
    for part in path.split("."):
        entry = entry.get(part) if isinstance(entry, dict) else None
    return entry if isinstance(entry, dict) and "value" in entry else None


class _Entry:
    """One [[variable]] during its check."""

    def __init__(self, file: Path, position: int, raw: dict[str, Any]) -> None:
        self.file = file
        self.raw = raw
        self.label = str(raw.get("name", raw.get("shared", f"number {position}")))

    def fail(self, key: str, message: str) -> TableError:
        return TableError(f"{self.file}: variable {self.label}: {key}: {message}")

    def choice(self, key: str, allowed: tuple[str, ...]) -> str:
        value = self.raw.get(key)
        if value not in allowed:
            raise self.fail(key, f"{value!r}, but must be one of {', '.join(allowed)}")
        return str(value)

    def whole(self, key: str, minimum: int, maximum: int) -> int:
        value = self.raw.get(key)
        if isinstance(value, bool) or not isinstance(value, int) or not minimum <= value <= maximum:
            raise self.fail(key, f"{value!r}, but must be a whole number from {minimum} to {maximum}")
        return value

    def value(self, key: str, kind: str, value: Any) -> Value:
        """``value`` as Python value of variable type ``kind``."""
        if kind == "boolean":
            if isinstance(value, bool):
                return value
            raise self.fail(key, f"{value!r}, but must be true or false")
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            raise self.fail(key, f"{value!r}, but must be a finite number")
        if kind == "real":
            return float(value)
        if value != int(value) or not INT32_MIN <= value <= INT32_MAX:
            raise self.fail(key, f"{value!r}, but must be a whole number of 32 bits")
        return int(value)


def _parse_entry(entry: _Entry, robot: dict[str, Any], robot_file: Path) -> Group:
    raw = entry.raw
    name = raw.get("name")
    if not isinstance(name, str) or not _NAME.fullmatch(name) or name == "time":
        raise entry.fail("name", f"{name!r}, but must be words of a-z, 0-9 and _ joined by dots, and not 'time'")
    for key in raw:
        if key not in _VARIABLE_KEYS:
            raise entry.fail(key, f"unknown key; known are {', '.join(sorted(_VARIABLE_KEYS))}")
    count = entry.whole("count", 1, 1024) if "count" in raw else None
    reference = entry.whole("reference", TIME_REFERENCE + 1, 2**31 - 1 - (count or 1))
    causality = entry.choice("causality", ("parameter", "input", "output"))
    kind = entry.choice("type", ("real", "integer", "boolean"))
    description = raw.get("description")
    if not isinstance(description, str) or not description.strip():
        raise entry.fail("description", "missing")

    unit = raw.get("unit")
    if kind == "real":
        if not isinstance(unit, str):
            raise entry.fail("unit", 'missing; dimensionless variables have unit = "1"')
        try:
            base_units(unit)
        except ValueError as error:
            raise entry.fail("unit", f"{unit!r}: {error}") from error
    elif "unit" in raw:
        raise entry.fail("unit", f"a variable of type {kind} has no unit")

    if kind == "boolean":
        for key in ("minimum", "maximum"):
            if key in raw:
                raise entry.fail(key, "a boolean has no range")
    if kind != "real":
        for key in ("nominal", "allow_nonfinite"):
            if key in raw:
                raise entry.fail(key, "only for variables of type real")
    minimum = entry.value("minimum", kind, raw["minimum"]) if "minimum" in raw else None
    maximum = entry.value("maximum", kind, raw["maximum"]) if "maximum" in raw else None
    if minimum is not None and maximum is not None and minimum > maximum:
        raise entry.fail("minimum", f"{minimum} is above the maximum {maximum}")
    nominal = float(entry.value("nominal", kind, raw["nominal"])) if "nominal" in raw else None
    if nominal is not None and nominal <= 0:
        raise entry.fail("nominal", f"{nominal} is not positive")
    allow_nonfinite = raw.get("allow_nonfinite", False)
    if not isinstance(allow_nonfinite, bool) or (allow_nonfinite and causality != "input"):
        raise entry.fail("allow_nonfinite", f"{allow_nonfinite!r}, but must be true or false, and true only for inputs")

    if "dependencies" in raw and causality != "output":
        raise entry.fail("dependencies", "only an output has them")
    dependencies = _dependencies(entry) if "dependencies" in raw else None

    plant, choices = _plant(entry, kind, causality, maximum)
    starts = _starts(entry, kind, unit, causality, count, robot, robot_file)
    for start, _ in starts:
        if start is None or kind == "boolean":
            continue
        if (minimum is not None and start < minimum) or (maximum is not None and start > maximum):
            raise entry.fail("start", f"{start} is outside {minimum} to {maximum}")
    _check_paper(entry, kind, causality, (minimum, maximum), [start for start, _ in starts])
    variables = tuple(
        Variable(reference + i, name if count is None else f"{name}[{i}]", start, path)
        for i, (start, path) in enumerate(starts)
    )
    return Group(
        name, name.replace(".", "_"), count, causality, kind, unit, minimum, maximum, nominal, allow_nonfinite,
        dependencies, " ".join(description.split()), variables, display_unit=_display_unit(entry, unit),
        plant=plant, choices=choices, c_core=_c_core(entry, causality, count),
    )  # fmt: skip


def _check_paper(
    entry: _Entry, kind: str, causality: str, bounds: tuple[Value | None, Value | None], starts: list[Value | None]
) -> None:
    """The value that the preset of the paper has instead of the start value. Importers do not see it."""
    if "paper" not in entry.raw:
        return
    if causality != "parameter":
        raise entry.fail("paper", "only a parameter has another value in a preset")
    value, (minimum, maximum) = entry.value("paper", kind, entry.raw["paper"]), bounds
    if (minimum is not None and value < minimum) or (maximum is not None and value > maximum):
        raise entry.fail("paper", f"{value} is outside {minimum} to {maximum}")
    if all(start == value for start in starts):
        raise entry.fail("paper", f"{value} is the start value; leave it out")


def _c_core(entry: _Entry, causality: str, count: int | None) -> str | None:
    """The member of a struct of c_core that the variable is."""
    member = entry.raw.get("c_core")
    if member is None or (member == RETURNED and causality == "output"):
        return member
    if not isinstance(member, str) or not _MEMBER.fullmatch(member) or ("[i]" in member) != (count is not None):
        raise entry.fail("c_core", f"{member!r}, but must be a member, with [i] if the variable has a count")
    return member


def _plant(entry: _Entry, kind: str, causality: str, maximum: Value | None) -> tuple[str | None, tuple[str, ...]]:
    """Type of the plant's parameter, and the names of its choices if that is an enumeration."""
    plant, choices = entry.raw.get("plant"), entry.raw.get("choices")
    if plant == "wheels" and "count" not in entry.raw:
        raise entry.fail("plant", "'wheels' is a number for each wheel: it has a count")
    if plant is None and (choices is None or kind != "integer" or causality != "parameter"):
        if choices is not None:
            raise entry.fail("choices", "only a parameter of type integer has them")
        return None, ()
    if plant is None:
        return None, _choices(entry, maximum)
    known = _PLANT_TYPES[kind]
    enumeration = kind == "integer" and isinstance(plant, str) and _ENUMERATION.fullmatch(plant) is not None
    if causality != "parameter" or not (plant in known or enumeration):
        other = " or the name of an enumeration" if kind == "integer" else ""
        raise entry.fail("plant", f"{plant!r}, but must be {' or '.join(known)}{other}, and of a parameter")
    if not enumeration:
        if choices is not None:
            raise entry.fail("choices", "only an enumeration of the plant has them")
        return plant, ()
    return plant, _choices(entry, maximum)


def _choices(entry: _Entry, maximum: Value | None) -> tuple[str, ...]:
    choices = entry.raw.get("choices")
    names = choices if isinstance(choices, list) else []
    words = all(isinstance(name, str) and _NAME.fullmatch(name) for name in names)
    if not words or len(names) - 1 != maximum:
        raise entry.fail("choices", f"{choices!r}, but must be a word for each value from 0 to the maximum {maximum}")
    return tuple(names)


def _display_unit(entry: _Entry, unit: str | None) -> str | None:
    if "display_unit" not in entry.raw:
        return default_display_unit(unit)
    name = entry.raw["display_unit"]
    known = DISPLAY_UNITS.get(unit or "", {})
    if name not in known:
        raise entry.fail("display_unit", f"{name!r}, but must be one of {', '.join(known) or 'none'} for {unit!r}")
    return str(name)


def _dependencies(entry: _Entry) -> tuple[str, ...]:
    names = entry.raw.get("dependencies")
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise entry.fail("dependencies", f"{names!r}, but must be a list of inputs and states")
    return tuple(names)


def _local(entry: _Entry, role: str, keys: set[str], offset: int, form: str, unit: str) -> Group:
    """A group of states, derivatives or indicators: real variables that the importer reads."""
    raw = entry.raw
    name = raw.get("name")
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise entry.fail("name", f"{name!r}, but must be words of a-z, 0-9 and _ joined by dots")
    for key in raw:
        if key not in keys:
            raise entry.fail(key, f"unknown key; known are {', '.join(sorted(keys))}")
    count = entry.whole("count", 1, 1024) if "count" in raw else None
    reference = entry.whole("reference", TIME_REFERENCE + 1, 2**31 - 1 - (count or 1) - offset) + offset
    description = raw.get("description")
    if not isinstance(description, str) or not description.strip():
        raise entry.fail("description", "missing")
    variables = tuple(
        Variable(reference + i, form.format(name if count is None else f"{name}[{i}]"), None, None)
        for i in range(count or 1)
    )
    return Group(
        form.format(name), "", count, "local", "real", unit, None, None, None, False, None,
        " ".join(description.split()), variables, role,
    )  # fmt: skip


def _parse_state(entry: _Entry) -> list[Group]:
    """A state and its derivative."""
    unit = entry.raw.get("unit")
    if not isinstance(unit, str):
        raise entry.fail("unit", 'missing; dimensionless variables have unit = "1"')
    for name in (unit, f"{unit}/s"):
        try:
            base_units(name)
        except ValueError as error:
            raise entry.fail("unit", f"{unit!r}: {error}") from error
    nominal = float(entry.value("nominal", "real", entry.raw.get("nominal")))
    if nominal <= 0:
        raise entry.fail("nominal", f"{nominal} is not positive")
    state = _local(entry, "state", _STATE_KEYS, 0, "{}", unit)
    rate = _local(entry, "derivative", _STATE_KEYS, DERIVATIVE_OFFSET, "der({})", "1/s" if unit == "1" else f"{unit}/s")
    rate = replace(
        rate,
        dependencies=_dependencies(entry),
        description=f"Derivative: {state.description}",
        display_unit=default_display_unit(rate.unit),
    )
    return [replace(state, nominal=nominal, display_unit=_display_unit(entry, unit)), rate]


def _parse_indicator(entry: _Entry) -> Group:
    return _local(entry, "indicator", _INDICATOR_KEYS, 0, "{}", "1")


def _starts(
    entry: _Entry,
    kind: str,
    unit: str | None,
    causality: str,
    count: int | None,
    robot: dict[str, Any],
    robot_file: Path,
) -> list[tuple[Value | None, str | None]]:
    """Start value and robot path of each element."""
    size = count or 1
    if causality == "output":
        if "start" in entry.raw:
            raise entry.fail("start", "an output has no start value")
        return [(None, None)] * size
    if "start" not in entry.raw:
        raise entry.fail("start", "missing")
    raw = entry.raw["start"]
    if isinstance(raw, list):
        if count is None or len(raw) != count:
            raise entry.fail("start", f"a list of {len(raw)} values for {size} variables")
        items = raw
    else:
        items = [raw] * size
    starts: list[tuple[Value | None, str | None]] = []
    for index, item in enumerate(items):
        path = None
        if isinstance(item, dict):
            path = item.get("robot")
            if set(item) != {"robot"} or not isinstance(path, str):
                raise entry.fail("start", f'{item!r}, but must be a value or {{ robot = "path" }}')
            item = _robot_value(entry, path, index, count, unit or "1", robot, robot_file)
            if isinstance(item, str):
                item = _number_of(entry, path, item, robot_file)
        starts.append((entry.value("start", kind, item), path))
    return starts


def _robot_value(
    entry: _Entry, path: str, index: int, count: int | None, unit: str, robot: dict[str, Any], robot_file: Path
) -> Any:
    found = _robot_entry(robot, path)
    if found is None:
        raise entry.fail("start", f"{robot_file} has no value {path}")
    if isinstance(found["value"], str):
        return found["value"]
    if found.get("unit") != unit:
        raise entry.fail("start", f"{path} of {robot_file} is in {found.get('unit')!r}, the variable in {unit!r}")
    value = found["value"]
    if not isinstance(value, list):
        return value
    if count is None or len(value) > count:
        raise entry.fail("start", f"{path} of {robot_file} has {len(value)} values for {count or 1} variables")
    # If the robot has fewer elements than there are variables (an outline's vertices), the rest is unused.
    return value[index] if index < len(value) else 0


def _number_of(entry: _Entry, path: str, word: str, robot_file: Path) -> int:
    """The number of a choice that the robot file states in words, with spaces instead of underscores."""
    choices = [choice.replace("_", " ") for choice in entry.raw.get("choices", [])]
    if word not in choices:
        allowed = " or ".join(choices) or "a number"
        raise entry.fail("start", f"{path} of {robot_file} is {word!r}, but may be {allowed}")
    return choices.index(word)


def expanded(table_file: Path) -> dict[str, Any]:
    """The table's document, with the entries shared with another table filled in."""
    document = _read_toml(table_file)
    shares = document.get("model", {}).pop("shares", None)
    if shares is not None and not isinstance(shares, str):
        raise TableError(f"{table_file}: model: shares: {shares!r}, but must be the path of a table")
    theirs: dict[str, dict[str, Any]] = {}
    if shares is not None:
        theirs = {raw["name"]: raw for raw in expanded(table_file.parent / shares)["variable"]}
    variables = document.get("variable", [])
    for position, raw in enumerate(variables):
        if "shared" in raw:
            variables[position] = _written_out(_Entry(table_file, position + 1, raw), theirs)
    return document


def _written_out(entry: _Entry, theirs: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """A shared entry: that of the other table, updated with its own keys."""
    name = entry.raw["shared"]
    if name not in theirs:
        raise entry.fail("shared", f"{name!r}, but must be a variable of the table that `shares` of [model] names")
    for key in entry.raw:
        if key not in _SHARED_KEYS:
            raise entry.fail(key, f"not in an entry with `shared`; it may have {', '.join(sorted(_SHARED_KEYS))}")
    own = {key: value for key, value in entry.raw.items() if key != "shared"}
    return theirs[name] | {"reference": None} | own


def read_table(table_file: Path, robot_file: Path) -> Table:
    """The checked table; TableError if anything is wrong."""
    document = expanded(table_file)
    robot = _read_toml(robot_file)
    model = document.get("model", {})
    for key in model:
        if key not in _MODEL_KEYS:
            raise TableError(f"{table_file}: model: {key}: unknown key; known are {', '.join(sorted(_MODEL_KEYS))}")
    name, description, step_size = (model.get(key) for key in ("name", "description", "step_size_s"))
    if not isinstance(name, str) or not re.fullmatch(r"[a-z][a-z0-9_]*", name):
        raise TableError(f"{table_file}: model: name: {name!r}, but must be a word of a-z, 0-9 and _")
    if not isinstance(description, str) or not description.strip():
        raise TableError(f"{table_file}: model: description: missing")
    if isinstance(step_size, bool) or not isinstance(step_size, float) or not 0 < step_size < math.inf:
        raise TableError(f"{table_file}: model: step_size_s: {step_size!r}, but must be a positive number of seconds")

    groups: list[Group] = []
    references: dict[int, str] = {}
    identifiers: dict[str, str] = {}
    parsed: list[tuple[_Entry, Group]] = []
    for position, raw in enumerate(document.get("variable", []), start=1):
        entry = _Entry(table_file, position, raw)
        parsed.append((entry, _parse_entry(entry, robot, robot_file)))
    states = document.get("state", [])
    for position, raw in enumerate([*states, _DISCONTINUITIES] if states else [], start=1):
        entry = _Entry(table_file, position, raw)
        parsed += [(entry, group) for group in _parse_state(entry)]
    for position, raw in enumerate(document.get("indicator", []), start=1):
        entry = _Entry(table_file, position, raw)
        parsed.append((entry, _parse_indicator(entry)))
    for entry, group in parsed:
        for variable in group.variables:
            if variable.reference in references:
                taken = references[variable.reference]
                raise entry.fail("reference", f"{variable.reference} is taken by {taken}")
            references[variable.reference] = variable.name
        identifier = group.identifier or group.name  # locals have no member of their own
        if identifier in identifiers:
            raise entry.fail("name", f"taken or too like {identifiers[identifier]}")
        identifiers[identifier] = group.name
        groups.append(group)
    if not groups:
        raise TableError(f"{table_file}: no [[variable]]")
    known = {group.name for group in groups if group.causality == "input" or group.role == "state"}
    for group in groups:
        for dependency in group.dependencies or ():
            if dependency not in known:
                label = f"{table_file}: variable {group.name}"
                raise TableError(f"{label}: dependencies: there is no input or state {dependency!r}")
    module = model.get("c_core")
    if module is not None and (not isinstance(module, str) or not re.fullmatch(r"gw_[a-z_]+", module)):
        raise TableError(f"{table_file}: model: c_core: {module!r}, but must be the name of a header without .h")
    for entry, group in parsed:
        if (group.c_core is None) == (module is not None):
            raise entry.fail("c_core", "missing" if module else "only if [model] names a module with `c_core`")
    groups.sort(key=lambda group: group.variables[0].reference)
    states = [group.name for group in groups if group.role == "state"]
    if states and states[-1] != _DISCONTINUITIES["name"]:
        last = _DISCONTINUITIES["reference"]
        raise TableError(f"{table_file}: variable {states[-1]}: reference: states must have references below {last}")
    return Table(name, " ".join(description.split()), step_size, tuple(groups), module)
