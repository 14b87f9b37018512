"""The robots of the crowd: how each differs from the robot file that its controller believes.

`POPULATION` is the whole statement of the distributions. It was written before any detector was tuned; the controller
never sees any of it. A robot depends on the draw and on its number alone. With an IMU it is the same robot, and `IMU`
states how its accelerometer and gyro differ from what their data sheet promises.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from giveway.base.errors import UnknownNameError
from giveway.robot.variables import Value, table
from giveway.robot.wheels import WHEELS

__all__ = [
    "DRAWS",
    "GROUPS",
    "GROUP_PATTERN",
    "IMU",
    "IMU_CONTROLLER",
    "POPULATION",
    "TABLES",
    "Quantity",
    "Robot",
    "controller_of",
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

WITH_IMU = ", IMU"
TABLES = (*GROUPS, *(f"{group}{WITH_IMU}" for group in GROUPS))
"""The plants again, and each with an IMU."""

GROUP_PATTERN = (2, 1, 0, 0, 1, 0, 0, 0, 0, 0)  # of every ten robots: one with single rollers, two that tip


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
    """

    what: str
    parameters: tuple[str, ...]
    low: float
    high: float
    scales: bool = False
    each: bool = False
    polar: bool = False
    only: str | None = None

    def drawn(self, rng: np.random.Generator) -> Iterator[tuple[str, float]]:
        """Its parameters and their values."""
        common = rng.uniform(self.low, self.high)
        if self.polar:
            angle = math.pi * rng.uniform(-1.0, 1.0)
            yield from zip(self.parameters, (common * math.cos(angle), common * math.sin(angle)), strict=True)
            return
        for name in self.parameters:
            value = rng.uniform(self.low, self.high) if self.each else common
            start = start_value(name)
            yield name, value * start if self.scales else value


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
    Quantity("zero error of each torque sensor, N m", wheels("electronics.torque_offset"), -0.1, 0.1, each=True),
    Quantity("rollers' friction, each wheel", wheels("roller.friction_scale"), 0.85, 1.15, each=True),
    Quantity("share of the rollers' friction that grows with the load", ("roller.load_growth",), 0.0, 1.0),
    Quantity("centre of mass off by, m", ("base.com_x", "base.com_y"), 0.0, 0.03, polar=True),
    Quantity("gain of each torque sensor", wheels("electronics.torque_gain"), 0.97, 1.03, each=True),
    Quantity("drift of each torque sensor's zero, N m/s", wheels("electronics.torque_drift"), -1e-3, 1e-3, each=True),
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

IMU: tuple[Quantity, ...] = (
    Quantity("place off by, m", ("imu.x", "imu.y"), 0.0, 0.02, polar=True),
    Quantity("height", ("imu.height",), 0.8, 1.2, scales=True),
    Quantity("turned by, rad", ("imu.azimuth",), -math.radians(2.0), math.radians(2.0)),
    Quantity("zero of each axis, m/s2", ("imu.acceleration_bias[0]", "imu.acceleration_bias[1]"), -0.4, 0.4, each=True),
    Quantity("scale of each axis", ("imu.acceleration_scale[0]", "imu.acceleration_scale[1]"), 0.99, 1.01, each=True),
    Quantity("noise", ("imu.acceleration_noise",), 0.7, 1.5, scales=True),
    Quantity("zero of the gyro, rad/s", ("imu.gyro_bias",), -math.radians(1.0), math.radians(1.0)),
    Quantity("scale of the gyro", ("imu.gyro_scale",), 0.99, 1.01),
    Quantity("noise of the gyro", ("imu.gyro_noise",), 0.7, 1.5, scales=True),
    Quantity("vibration", ("imu.vibration",), 0.5, 2.0, scales=True),
    Quantity("growth of the vibration with the speed", ("imu.vibration_growth",), 0.5, 2.0, scales=True),
    Quantity("natural frequency of the structure", ("imu.vibration_frequency",), 0.7, 1.4, scales=True),
    Quantity("share of samples that are lost", ("imu.dropout",), 0.0, 0.005),
)

IMU_CONTROLLER: Mapping[str, Value] = MappingProxyType({"imu.use": 1, "estimator.acceleration_source": 3})
"""What the controller of a robot with an IMU is told about it."""


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
        imu: it has an IMU.
    """

    number: int
    group: str
    testbed: Mapping[str, Value]
    imu: bool = False

    @property
    def table(self) -> str:
        """The one of `TABLES` that it belongs to."""
        return f"{self.group}{WITH_IMU}" if self.imu else self.group


def group_of(number: int) -> str:
    """The plant of robot ``number``."""
    return GROUPS[GROUP_PATTERN[number % len(GROUP_PATTERN)]]


def robot(draw: str, number: int, imu: bool = False) -> Robot:
    """Robot ``number`` of ``draw`` (a name in `DRAWS`).

    Raises:
        UnknownNameError: a parameter of `POPULATION` is not one of the testbed; none is skipped.
    """
    return robot_of(draw, number, group_of(number), imu)


def robot_of(draw: str, number: int, group: str, imu: bool = False) -> Robot:
    """Robot ``number`` with the plant of ``group``, whatever it has in the crowd."""
    if draw not in DRAWS:
        raise UnknownNameError("draw", draw, DRAWS)
    rng = np.random.default_rng((DRAWS[draw], 0, number))
    values: dict[str, Value] = {}
    for quantity in POPULATION:
        if quantity.only in (None, group):
            values.update(quantity.drawn(rng))
    if group == "tipping":
        values["base.tipping"] = True
    if group == "single rollers":
        values |= {"roller.arrangement": 1, "roller.seed": int(rng.integers(2**31))}
    if imu:
        own = np.random.default_rng((DRAWS[draw], 4, number))  # all else stays as it is without
        values["imu.present"] = True
        for quantity in IMU:
            values.update(quantity.drawn(own))
    return Robot(number, group, MappingProxyType(values), imu)


def controller_of(whose: Robot, controller: Mapping[str, Value]) -> Mapping[str, Value]:
    """What the controller of this robot is set to: ``controller``, but for what it is told about its IMU."""
    return {**controller, **IMU_CONTROLLER} if whose.imu else controller
