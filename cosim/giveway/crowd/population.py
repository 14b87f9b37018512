"""The robots of the crowd: how each differs from the robot file that its controller believes.

`robot.population` states the distributions. A robot depends on the draw and on its number alone. With an IMU it is the
same robot, and `IMU` states how its accelerometer and gyro differ from what their data sheet promises.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np

from giveway.base.errors import GivewayError, UnknownNameError
from giveway.robot.population import GROUPS, POPULATION, Quantity, quantities_of, start_value, start_values
from giveway.robot.variables import Value

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
    "check_same",
    "controller_of",
    "group_of",
    "robot",
    "robot_of",
    "start_value",
    "start_values",
]

DRAWS: Mapping[str, int] = MappingProxyType({"tuning": 20160401, "judging": 20260917})
"""Seeds. Detectors may be chosen with the first draw; the second one is not looked at until they are."""

WITH_IMU = ", IMU"
TABLES = (*GROUPS, *(f"{group}{WITH_IMU}" for group in GROUPS))
"""The plants again, and each with an IMU."""

GROUP_PATTERN = (2, 1, 0, 0, 1, 0, 0, 0, 0, 0)  # of every ten robots: one with single rollers, two that tip

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

NO_IMU_CONTROLLER: Mapping[str, Value] = MappingProxyType({"imu.use": 0, "estimator.acceleration_source": 1})
"""What that of a robot without one is told, where the robot file has one."""


@dataclass(frozen=True)
class Robot:
    """One robot of the crowd.

    Attributes:
        number: from 0.
        group: one of `GROUPS`.
        testbed: parameters that make it differ from the robot file.
        imu: it has an IMU.
        file: the robot file that it differs from; None: Trikey's.
    """

    number: int
    group: str
    testbed: Mapping[str, Value]
    imu: bool = False
    file: Path | None = None

    @property
    def table(self) -> str:
        """The one of `TABLES` that it belongs to."""
        return f"{self.group}{WITH_IMU}" if self.imu else self.group


def group_of(number: int) -> str:
    """The plant of robot ``number``."""
    return GROUPS[GROUP_PATTERN[number % len(GROUP_PATTERN)]]


def robot(draw: str, number: int, imu: bool = False, file: Path | None = None) -> Robot:
    """Robot ``number`` of ``draw`` (a name in `DRAWS`), one of those that the robot file ``file`` means.

    Raises:
        UnknownNameError: a parameter of `POPULATION` is not one of the testbed; none is skipped.
    """
    return robot_of(draw, number, group_of(number), imu, file)


def robot_of(draw: str, number: int, group: str, imu: bool = False, file: Path | None = None) -> Robot:
    """Robot ``number`` with the plant of ``group``, whatever it has in the crowd."""
    if draw not in DRAWS:
        raise UnknownNameError("draw", draw, DRAWS)
    rng = np.random.default_rng((DRAWS[draw], 0, number))
    values: dict[str, Value] = {}
    for quantity in quantities_of(group, file):
        values.update(quantity.drawn(rng, file))
    if group == "tipping":
        values["base.tipping"] = True
    if group == "single rollers":
        values |= {"roller.arrangement": 1, "roller.seed": int(rng.integers(2**31))}
    if imu:
        own = np.random.default_rng((DRAWS[draw], 4, number))  # all else stays as it is without
        values["imu.present"] = True
        for quantity in IMU:
            values.update(quantity.drawn(own, file))
    elif file is not None:
        values["imu.present"] = False
    return Robot(number, group, MappingProxyType(values), imu, file)


ROBOTS_OWN = ("base.", "wheel.", "roller.", "drivetrain.", "servo.", "electronics.", "floor.", "imu.")
OF_THE_PLANT = ("base.tipping", "roller.arrangement", "imu.present")


def check_same(same: Mapping[str, Value]) -> None:
    """GivewayError if one of these parameters of the testbed is not the robot's, or is what its table is for."""
    for name, value in same.items():
        if not name.startswith(ROBOTS_OWN) or name in OF_THE_PLANT:
            allowed = f"parameters of the robot ({', '.join(ROBOTS_OWN)}) but not {', '.join(OF_THE_PLANT)}"
            raise GivewayError(f"testbed.{name}", value, allowed)


def controller_of(whose: Robot, controller: Mapping[str, Value]) -> Mapping[str, Value]:
    """What the controller of this robot is set to: ``controller``, but for what it is told about its IMU."""
    if whose.imu:
        return {**controller, **IMU_CONTROLLER}
    return controller if whose.file is None else {**controller, **NO_IMU_CONTROLLER}
