"""The variable tables of the FMUs: names, types, units, ranges; and checks of a user's settings."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from giveway.base import native
from giveway.base.errors import GivewayError, UnknownNameError
from giveway.robot.robot_file import OUTLINE_COUNT, Robot, read_robot
from giveway.robot.table_files import entry_unit, read_table_file

__all__ = ["Choices", "Value", "Variable", "VariableTable", "parse_assignments", "table"]

Value = float | int | bool
_TRUE, _FALSE = {"true", "1", "yes", "on"}, {"false", "0", "no", "off"}


@dataclass(frozen=True, slots=True)
class Variable:
    """One scalar variable of an FMU; ranges are inclusive, infinite where the table states none."""

    reference: int
    name: str
    type: str  # "real", "integer" or "boolean"
    causality: str  # "parameter", "input" or "output"
    unit: str  # "1" for dimensionless reals, "" for integers and booleans
    minimum: float
    maximum: float
    start: Value | None
    robot_path: str | None
    robot_index: int
    description: str
    paper: Value | None = None  # in the preset "paper", where that differs from the start value
    c_core: str = ""  # what it is in the C library: a member of its configuration, input or output

    @property
    def allowed(self) -> str:
        """The allowed values in words, with the unit."""
        if self.type == "boolean":
            return "true or false"
        unit = f" {self.unit}" if self.unit not in ("", "1") else ""
        kind = "a whole number" if self.type == "integer" else "a finite number"
        low, high = self.minimum, self.maximum
        if math.isinf(low) and math.isinf(high):
            return kind + (f" in{unit}" if unit else "")
        if math.isinf(high):
            return f"{kind}, at least {low:g}{unit}"
        if math.isinf(low):
            return f"{kind}, at most {high:g}{unit}"
        return f"{kind} from {low:g} to {high:g}{unit}"

    @property
    def range(self) -> dict[str, float | str]:
        """The same for a program: type, unit and what limits there are."""
        limits = {"minimum": self.minimum, "maximum": self.maximum}
        stated = {name: limit for name, limit in limits.items() if math.isfinite(limit) and self.type != "boolean"}
        return {"type": self.type, "unit": self.unit or "1", **stated}


class VariableTable:
    """All variables of one model, by name and in the order of their references."""

    def __init__(self, model: str, variables: list[Variable]) -> None:
        self.model = model
        self._by_name = {variable.name: variable for variable in variables}

    def __iter__(self) -> Iterator[Variable]:
        return iter(self._by_name.values())

    def __len__(self) -> int:
        return len(self._by_name)

    def __contains__(self, name: str) -> bool:
        return name in self._by_name

    def __getitem__(self, name: str) -> Variable:
        if name not in self._by_name:
            raise UnknownNameError(f"{self.model} variable", name, self._by_name)
        return self._by_name[name]

    def select(self, causality: str, kind: str | None = None) -> list[Variable]:
        """Variables of one causality and, if given, one type."""
        return [v for v in self if v.causality == causality and kind in (None, v.type)]

    def check(self, name: str, value: object) -> Value:
        """``value`` as the type of parameter ``name``; GivewayError if name, type or range is wrong."""
        field = f"{self.model}.{name}"
        if name not in self._by_name:
            parameters = [v.name for v in self.select("parameter")]
            raise UnknownNameError(f"{self.model} parameter", name, parameters)
        variable = self._by_name[name]
        if variable.causality != "parameter":
            allowed = f"a parameter ({field} is an {variable.causality})"
            raise GivewayError(field, value, allowed)
        converted = _convert(variable, value)
        if converted is None or not variable.minimum <= converted <= variable.maximum:
            raise GivewayError(field, value, variable.allowed)
        return converted

    def check_all(self, values: Mapping[str, object]) -> dict[str, Value]:
        """Every entry of ``values`` checked and converted."""
        return {name: self.check(name, value) for name, value in values.items()}

    def robot_value(self, robot: Robot, variable: Variable) -> Value:
        """The checked value of ``variable`` in ``robot``; an error names the line of the robot file."""
        path = self.robot_name(variable, robot)
        try:
            stated = robot.value(path, variable.robot_index)
            return self.check(variable.name, bool(stated) if variable.type == "boolean" else stated)
        except GivewayError as error:
            if error.field != f"{self.model}.{variable.name}":
                raise  # the file does not have it
            raise robot.refusal(path, error.allowed) from None

    def robot_name(self, variable: Variable, robot: Robot | None = None) -> str:
        """The entry of a robot file that states ``variable``: a number of the robot, or a setting of this model.

        In ``robot`` a setting that follows from several numbers counts more than one of them.
        """
        setting = f"{self.model}.{variable.name.partition('[')[0]}"
        follows = robot is not None and setting in robot
        return variable.robot_path if variable.robot_path is not None and not follows else setting

    def robot_values(self, robot: Robot) -> dict[str, Value]:
        """The values of ``robot`` for every parameter that it states."""
        values: dict[str, Value] = {}
        for variable in self:
            name = self.robot_name(variable, robot)
            if variable.robot_path is None and name not in robot:
                continue
            if robot.does_without(name):
                continue
            values[variable.name] = self.robot_value(robot, variable)
        if OUTLINE_COUNT in self:  # the only number that a robot file states by the length of a list
            values[OUTLINE_COUNT] = self.check(OUTLINE_COUNT, robot.count("outline.x"))
        return values


class Choices(Mapping[str, int]):
    """The names of a parameter's values and their numbers, from its variable table; read when first asked for."""

    def __init__(self, model: str, name: str) -> None:
        self._model, self._name = model, name

    def __getitem__(self, choice: str) -> int:
        return self._numbers[choice]

    def __iter__(self) -> Iterator[str]:
        return iter(self._numbers)

    def __len__(self) -> int:
        return len(self._numbers)

    @functools.cached_property
    def _numbers(self) -> dict[str, int]:
        entries = read_table_file(native.variables(self._model))["variable"]
        (choices,) = (entry["choices"] for entry in entries if entry["name"] == self._name)
        return {choice: number for number, choice in enumerate(choices)}


def _convert(variable: Variable, value: object) -> Value | None:
    """``value`` (number, boolean or text) in the variable's type, None if it does not fit."""
    text = str(value).strip().lower()
    if variable.type == "boolean":
        return True if text in _TRUE else False if text in _FALSE else None
    if isinstance(value, bool):
        return None
    try:
        number = float(text)
    except ValueError:
        return None
    if not math.isfinite(number):
        return None
    if variable.type == "integer":
        return int(number) if number == int(number) else None
    return number


def parse_assignments(assignments: list[str]) -> dict[str, dict[str, Value]]:
    """Checked overrides per model from texts such as ``testbed.slider.mass=9.08``."""
    overrides: dict[str, dict[str, Value]] = {model: {} for model in native.MODELS}
    for assignment in assignments:
        target, equals, text = assignment.partition("=")
        model, dot, name = target.strip().partition(".")
        if not equals or not dot or not name:
            raise GivewayError("--set", assignment, "MODEL.PARAMETER=VALUE, e.g. testbed.slider.mass=9.08")
        if model not in overrides:
            raise UnknownNameError("--set model", model, native.MODELS)
        overrides[model][name] = table(model).check(name, text)
    return overrides


def table(model: str) -> VariableTable:
    """The variable table of ``model``, with the start values of the default robot."""
    known = (*native.MODELS, *native.COMPONENTS)
    if model not in known:
        raise UnknownNameError("model", model, known)
    return _read_table(native.variables(model), native.robot())


@functools.cache
def _read_table(path: Path, robot_path: Path) -> VariableTable:
    document = read_table_file(path)
    robot = read_robot(robot_path)
    variables: list[Variable] = []
    for entry in document["variable"]:
        variables.extend(_expand(entry, robot))
    variables.sort(key=lambda variable: variable.reference)
    return VariableTable(document["model"]["name"], variables)


def _expand(entry: Mapping[str, Any], robot: Robot) -> Iterator[Variable]:
    """The scalars of one table entry: ``count = 3`` makes ``name[0]`` to ``name[2]``."""
    count = entry.get("count")
    for index in range(count if count is not None else 1):
        start = entry.get("start")
        if isinstance(start, list):
            start = start[index]
        robot_path = start["robot"] if isinstance(start, dict) else None
        if robot_path is not None:
            start = robot.value(robot_path, index)
        yield Variable(
            reference=entry["reference"] + index,
            name=entry["name"] if count is None else f"{entry['name']}[{index}]",
            type=entry["type"],
            causality=entry["causality"],
            unit=entry_unit(entry),
            minimum=float(entry.get("minimum", -math.inf)),
            maximum=float(entry.get("maximum", math.inf)),
            start=start,
            robot_path=robot_path,
            robot_index=index,
            description=entry.get("description", ""),
            paper=entry.get("paper"),
            c_core=entry.get("c_core", "").replace("[i]", f"[{index}]"),
        )
