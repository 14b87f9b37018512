"""What a study can vary: parameters of both models, numbers of the robot file, the hit, the bumper, causes.

A run is a row of a table with one column per parameter of the controller and the testbed. Most quantities are some of
its columns; those of the hit (speed, place, direction) are turned into the slider's start by `scenario.approach`, and
the causes of `study.influences` (temperature, gear ratio) multiply several columns.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base import native
from giveway.base.checks import finite
from giveway.base.errors import GivewayError, UnknownNameError
from giveway.robot.variables import Variable, table
from giveway.scenario.scenario import BUMPERS
from giveway.scenario.scenario_file import SET_BY
from giveway.study.influences import INFLUENCES

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["HIT", "Columns", "Quantity", "columns", "find", "value_of"]


@dataclass(frozen=True)
class Quantity:
    """Something that varies.

    Attributes:
        name: as the user writes it.
        unit: of its values; "" for whole numbers, truth values and choices.
        kind: "real", "integer", "boolean" or "choice".
        minimum, maximum: inclusive.
        columns: of the run table that its value is written to; none for what is computed with.
        choices: name per value of a choice.
    """

    name: str
    unit: str
    kind: str
    minimum: float
    maximum: float
    columns: tuple[int, ...] = ()
    choices: tuple[str, ...] = ()

    @property
    def allowed(self) -> str:
        """The allowed values in words."""
        if self.kind == "choice":
            return ", ".join(self.choices)
        return Variable(0, "", self.kind, "", self.unit, self.minimum, self.maximum, None, None, 0, "").allowed

    def text(self, value: float) -> str:
        """``value`` as a user would write it."""
        if self.kind == "choice":
            return self.choices[int(value)]
        if self.kind == "boolean":
            return "true" if value else "false"
        return f"{int(value)}" if self.kind == "integer" else repr(float(value))


HIT: Mapping[str, Quantity] = MappingProxyType(
    {
        quantity.name: quantity
        for quantity in (
            Quantity("collision.speed", "m/s", "real", 0.0, 20.0),
            Quantity("collision.time", "s", "real", 0.0, 60.0),
            Quantity("collision.offset", "m", "real", -10.0, 10.0),  # its range is that of the side
            Quantity("collision.around", "1", "real", 0.0, 1.0),
            Quantity("collision.direction", "deg", "real", -360.0, 360.0),
            Quantity("collision.angle", "deg", "real", -90.0, 90.0),
        )
    }
)
"""Of the hit; ``around`` is the share of the outline's length from corner 0 on, ``angle`` is from straight into it."""

_ALIASES = {"collision.mass": "testbed.slider.mass", "collision.height": "testbed.contact.height"}


@dataclass(frozen=True)
class Columns:
    """The columns of the run table.

    Attributes:
        names: ``testbed.slider.mass``.
        variables: of each column.
        model, reference: how the batch library calls them.
        start: what the models have if nothing is set.
        whole: which columns hold no fractions.
    """

    names: tuple[str, ...]
    variables: tuple[Variable, ...]
    model: NDArray[np.uint32]
    reference: NDArray[np.uint32]
    start: NDArray[np.float64]
    whole: NDArray[np.bool_]
    index: Mapping[str, int]

    def testbed(self, row: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """Columns of the testbed by name, of a table of shape (n, columns)."""
        return {name.partition(".")[2]: row[:, i] for name, i in self.index.items() if name.startswith("testbed.")}


@functools.cache
def columns() -> Columns:
    """The columns for the models that are there."""
    found = [(number, model, v) for number, model in enumerate(native.MODELS) for v in table(model).select("parameter")]
    names = tuple(f"{model}.{v.name}" for _, model, v in found)
    return Columns(
        names,
        tuple(v for _, _, v in found),
        np.array([number for number, _, _ in found], dtype=np.uint32),
        np.array([v.reference for _, _, v in found], dtype=np.uint32),
        np.array([float(v.start or 0.0) for _, _, v in found]),
        np.array([v.type != "real" for _, _, v in found]),
        MappingProxyType({name: i for i, name in enumerate(names)}),
    )


def find(field: str, name: str) -> Quantity:
    """The quantity ``name``; errors name ``field`` and offer the nearest names."""
    if name in HIT:
        return HIT[name]
    if name in INFLUENCES:
        cause = INFLUENCES[name]
        return Quantity(name, cause.unit, "real", cause.minimum, cause.maximum)
    all_columns = columns()
    if name == "bumper":
        where = (all_columns.index["testbed.bumper.kind"],)
        return Quantity(name, "", "choice", 0.0, len(BUMPERS) - 1.0, where, tuple(BUMPERS))
    if name.startswith("robot."):
        return _of_robot(field, name)
    column = _ALIASES.get(name, name)
    if column not in all_columns.index:
        raise UnknownNameError(field, name, _all_names())
    _refuse_what_is_set_elsewhere(field, name)
    variable = all_columns.variables[all_columns.index[column]]
    low, high = (0.0, 1.0) if variable.type == "boolean" else (variable.minimum, variable.maximum)
    return Quantity(name, variable.unit, variable.type, low, high, (all_columns.index[column],))


def value_of(field: str, value: Any, quantity: Quantity, scale: float = 1.0, whole_needed: bool = True) -> float:
    """``value`` of a quantity, checked, in its own unit: ``scale`` is the factor to it; errors name ``field``."""
    if quantity.kind == "choice":
        if value not in quantity.choices:
            raise UnknownNameError(field, str(value), quantity.choices)
        return float(quantity.choices.index(value))
    if quantity.kind == "boolean":
        if not isinstance(value, bool):
            raise GivewayError(field, value, quantity.allowed)
        return float(value)
    number = finite(field, value) * scale
    fraction = quantity.kind == "integer" and whole_needed and number != round(number)
    if fraction or not quantity.minimum <= number <= quantity.maximum:
        raise GivewayError(field, value if scale == 1.0 else f"{value} (= {number:g})", quantity.allowed)
    return number


def _refuse_what_is_set_elsewhere(field: str, name: str) -> None:
    model, _, variable = name.partition(".")
    if model == "testbed" and variable in SET_BY and variable != "electronics.seed":
        raise GivewayError(field, name, f"another name for it: {SET_BY[variable]}")
    if variable.startswith("outline."):
        raise GivewayError(field, name, "a quantity that does not change the robot's outline")


def _of_robot(field: str, name: str) -> Quantity:
    """A number of the robot file: all variables of both models that take it from there, first what the robot has."""
    path = name.removeprefix("robot.")
    all_columns = columns()
    where = [i for i, variable in enumerate(all_columns.variables) if variable.robot_path == path]
    where.sort(key=lambda i: not all_columns.names[i].startswith("testbed."))
    if not where:
        raise UnknownNameError(field, name, _all_names())
    if path.startswith("outline."):
        raise GivewayError(field, name, "a quantity that does not change the robot's outline")
    variables = [all_columns.variables[i] for i in where]
    low, high = max(v.minimum for v in variables), min(v.maximum for v in variables)
    return Quantity(name, variables[0].unit, variables[0].type, low, high, tuple(where))


@functools.cache
def _all_names() -> tuple[str, ...]:
    paths = {variable.robot_path for variable in columns().variables if variable.robot_path}
    return (
        *columns().names,
        *HIT,
        *_ALIASES,
        *sorted(f"robot.{path}" for path in paths),
        "bumper",
        *INFLUENCES,
    )
