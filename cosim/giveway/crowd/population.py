"""The robots of the crowd: how each differs from the robot file that its controller believes.

`POPULATION` is the whole statement of the distributions. It was written before any detector was tuned; the controller
never sees any of it. A robot depends on the draw and on its number alone.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from giveway.base.errors import UnknownNameError
from giveway.robot.variables import Value, table
from giveway.robot.wheels import WHEELS

__all__ = [
    "DRAWS",
    "GROUPS",
    "POPULATION",
    "Quantity",
    "Robot",
    "group_of",
    "robot",
    "robot_of",
    "start_value",
    "start_values",
]

DRAWS: Mapping[str, int] = MappingProxyType({"tuning": 20160401, "judging": 20260917})
"""Seeds. Detectors may be chosen with the first draw; the second one is not looked at until they are."""

GROUPS = ("planar", "tipping", "single rollers")
"""The plants of the crowd, with figures apart: see `group_of`."""

GROUP_PATTERN = (2, 1, 0, 0, 1, 0, 0, 0, 0, 0)  # of every ten robots: one with single rollers, two that tip


def scale(value: float, drawn: float) -> float:
    """The robot file's value times what was drawn."""
    return value * drawn


def replace(value: float, drawn: float) -> float:
    """What was drawn instead of the start value."""
    return drawn


@dataclass(frozen=True)
class Quantity:
    """One line of the population: uniform from ``low`` to ``high``, in one draw for all of ``parameters``, or each.

    Attributes:
        what: in words.
        parameters: of the testbed.
        low, high: in the parameters' unit, or as factors of the robot file's values.
        apply: `scale` or `replace`.
        each: every parameter has a draw of its own.
    """

    what: str
    parameters: tuple[str, ...]
    low: float
    high: float
    apply: Callable[[float, float], float] = scale
    each: bool = False


def wheels(name: str) -> tuple[str, ...]:
    """A parameter that each wheel has."""
    return tuple(f"{name}[{wheel}]" for wheel in range(WHEELS))


POPULATION: tuple[Quantity, ...] = (
    Quantity("rollers' friction, common", ("roller.coulomb_torque",), 0.7, 1.3),
    Quantity("payload", ("base.mass",), 0.95, 1.25),
    Quantity("yaw inertia", ("base.yaw_inertia",), 0.8, 1.2),
    Quantity("wheel radius", ("wheel.radius",), 0.99, 1.01),
    Quantity(
        "gear friction",
        ("drivetrain.gear_coulomb", "drivetrain.gear_stiction", "drivetrain.gear_viscous"),
        0.7,
        1.3,
    ),
    Quantity("zero error of each torque sensor, N m", wheels("electronics.torque_offset"), -0.1, 0.1, replace, True),
)


@functools.cache
def start_values(model: str = "testbed") -> Mapping[str, Value]:
    """Start values of a model's variables: the robot file's, where there is one."""
    return MappingProxyType({v.name: v.start for v in table(model) if v.start is not None})


def start_value(name: str, model: str = "testbed") -> float:
    """The start value of one parameter of a model; UnknownNameError if it has none of this name."""
    values = start_values(model)
    return float(values[name] if name in values else table(model)[name].start or 0.0)


@dataclass(frozen=True)
class Robot:
    """One robot of the crowd.

    Attributes:
        number: from 0.
        group: one of `GROUPS`.
        testbed: parameters that make it differ from the robot file.
    """

    number: int
    group: str
    testbed: Mapping[str, Value]


def group_of(number: int) -> str:
    """The plant of robot ``number``."""
    return GROUPS[GROUP_PATTERN[number % len(GROUP_PATTERN)]]


def robot(draw: str, number: int) -> Robot:
    """Robot ``number`` of ``draw`` (a name in `DRAWS`).

    Raises:
        UnknownNameError: a parameter of `POPULATION` is not one of the testbed; none is skipped.
    """
    return robot_of(draw, number, group_of(number))


def robot_of(draw: str, number: int, group: str) -> Robot:
    """Robot ``number`` with the plant of ``group``, whatever it has in the crowd."""
    if draw not in DRAWS:
        raise UnknownNameError("draw", draw, DRAWS)
    rng = np.random.default_rng((DRAWS[draw], 0, number))
    values: dict[str, Value] = {}
    for quantity in POPULATION:
        common = rng.uniform(quantity.low, quantity.high)
        for name in quantity.parameters:
            drawn = rng.uniform(quantity.low, quantity.high) if quantity.each else common
            values[name] = quantity.apply(start_value(name), drawn)
    if group == "tipping":
        values["base.tipping"] = True
    return Robot(number, group, MappingProxyType(values))
