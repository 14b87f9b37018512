"""How robots differ from the robot file that their controllers believe: `POPULATION` states every distribution.

It was written before any detector was tuned; the controller never sees any of it. `giveway crowd` draws its robots from
it, and a study the robots of ``robot = "crowd"``.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from giveway.robot.robot_file import read_robot
from giveway.robot.variables import Value, table
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "GROUPS",
    "POPULATION",
    "Quantity",
    "group_of_plant",
    "quantities_of",
    "start_value",
    "start_values",
]

GROUPS = ("planar", "tipping", "single rollers")
"""The plants of robots: only some quantities differ in all of them."""


@dataclass(frozen=True)
class Quantity:
    """One line of the population: uniform from ``low`` to ``high``, in one draw for all of ``parameters``, or each.

    Attributes:
        what: in words.
        parameters: of the testbed.
        low, high: in the parameters' unit, or as factors of the robot file's values.
        scales: they are factors.
        each: every parameter has a draw of its own.
        polar: the draw is a distance in any direction, the two parameters are its components.
        only: in this plant of `GROUPS` alone; None: in all.
        grows_with: a parameter of the testbed: the range is Trikey's, another robot's is in proportion to it.
    """

    what: str
    parameters: tuple[str, ...]
    low: float
    high: float
    scales: bool = False
    each: bool = False
    polar: bool = False
    only: str | None = None
    grows_with: str = ""

    def of(self, robot: Path | None) -> Quantity:
        """The same line for the robots that a robot file means; None: Trikey's."""
        if robot is None or not self.grows_with:
            return self
        share = start_value(self.grows_with, robot=robot) / start_value(self.grows_with)
        return dataclasses.replace(self, low=self.low * share, high=self.high * share)

    @property
    def draws(self) -> int:
        """Numbers from 0 to 1 that it takes."""
        return len(self.parameters) if self.each else 2 if self.polar else 1

    def at(self, share: NDArray[np.float64]) -> Iterator[tuple[str, NDArray[np.float64]]]:
        """Its parameters, and their values or factors for shares (n, `draws`) of the ranges."""
        values = self.low + (self.high - self.low) * share
        if self.polar:
            angles = [math.pi * (-1.0 + 2.0 * one) for one in share[:, 1].tolist()]  # of math: bits of every platform
            for name, turn in zip(self.parameters, (math.cos, math.sin), strict=True):
                yield name, values[:, 0] * np.array([turn(angle) for angle in angles])
            return
        for index, name in enumerate(self.parameters):
            yield name, values[:, index if self.each else 0]

    def drawn(self, rng: np.random.Generator, robot: Path | None = None) -> Iterator[tuple[str, float]]:
        """Its parameters and their values; factors are of the robot file's numbers."""
        if self.each:
            rng.random()  # every robot that was ever drawn has this one unused
        for name, value in self.at(rng.random((1, self.draws))):
            yield name, float(value[0]) * start_value(name, robot=robot) if self.scales else float(value[0])


def wheels(name: str) -> tuple[str, ...]:
    """A parameter that each wheel has."""
    return tuple(f"{name}[{wheel}]" for wheel in range(WHEELS))


TURN = 2.0 * math.pi

POPULATION: tuple[Quantity, ...] = (
    Quantity("rollers' friction, common", ("roller.coulomb_torque",), 0.7, 1.3, scales=True),
    Quantity("payload", ("base.mass",), 0.95, 1.25, scales=True),
    Quantity("yaw inertia", ("base.yaw_inertia",), 0.8, 1.2, scales=True),
    Quantity("wheel radius", ("wheel.radius",), 0.99, 1.01, scales=True),
    Quantity("gear friction, each drivetrain", wheels("drivetrain.friction_scale"), 0.7, 1.3, each=True),
    Quantity(
        "zero error of each torque sensor, N m",
        wheels("electronics.torque_offset"),
        -0.1,
        0.1,
        each=True,
        grows_with="electronics.torque_range",
    ),
    Quantity("rollers' friction, each wheel", wheels("roller.friction_scale"), 0.85, 1.15, each=True),
    Quantity("share of the rollers' friction that grows with the load", ("roller.load_growth",), 0.0, 1.0),
    Quantity(
        "centre of mass off by, m", ("base.com_x", "base.com_y"), 0.0, 0.03, polar=True, grows_with="wheel.distance"
    ),
    Quantity("gain of each torque sensor", wheels("electronics.torque_gain"), 0.97, 1.03, each=True),
    Quantity(
        "drift of each torque sensor's zero, N m/s",
        wheels("electronics.torque_drift"),
        -1e-3,
        1e-3,
        each=True,
        grows_with="electronics.torque_range",
    ),
    Quantity("each encoder within a count", wheels("electronics.encoder_phase"), 0.0, 1.0, each=True),
    Quantity("slope of the floor, rad", ("floor.slope",), 0.0, math.radians(1.0)),
    Quantity("direction of the slope, rad", ("floor.azimuth",), -math.pi, math.pi),
    Quantity("height of the centre of mass", ("base.com_height",), 0.9, 1.1, scales=True, only="tipping"),
    Quantity("angle of each wheel, rad", wheels("roller.phase"), 0.0, TURN, each=True, only="single rollers"),
    Quantity("play between rollers", ("roller.radius_dip",), 0.0, 2.0, scales=True, only="single rollers"),
    Quantity(
        "scatter from roller to roller", ("roller.friction_scatter",), 0.0, 2.0, scales=True, only="single rollers"
    ),
)


def group_of_plant(tipping: bool, single_rollers: bool) -> str:
    """The one of `GROUPS` that a plant with these properties belongs to."""
    return GROUPS[2] if single_rollers else GROUPS[1] if tipping else GROUPS[0]


def quantities_of(group: str, robot: Path | None = None) -> tuple[Quantity, ...]:
    """The lines of `POPULATION` in which robots of ``group`` differ, of a robot file's robots."""
    return tuple(quantity.of(robot) for quantity in POPULATION if quantity.only in (None, group))


@functools.cache
def start_values(model: str = "testbed", robot: Path | None = None) -> Mapping[str, Value]:
    """Start values of a model's variables: those of the robot file, where it has one; None: of Trikey's."""
    values = {v.name: v.start for v in table(model) if v.start is not None}
    return MappingProxyType(values if robot is None else values | table(model).robot_values(read_robot(robot)))


def start_value(name: str, model: str = "testbed", robot: Path | None = None) -> float:
    """The start value of one parameter of a model; UnknownNameError if it has none of this name."""
    values = start_values(model, robot)
    return float(values[name] if name in values else table(model)[name].start or 0.0)
