"""The robots that are pushed: each differs from the robot file within what `robot.population` states.

All controllers believe the file. What a factor multiplies is the file's own value. Where torque comes from the motors'
current, the gain is that of their torque constants, which catalogues state to a tenth.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

import numpy as np

from giveway.base import native
from giveway.base.errors import GivewayError
from giveway.robot.population import GROUPS, POPULATION, Quantity, quantities_of
from giveway.robot.robot_file import read_robot
from giveway.robot.variables import Value, table

__all__ = ["CONSTANTS", "SEED", "Subject", "differing", "subject"]

SEED = 20261123
GAIN = "gain of each torque sensor"
CONSTANTS = Quantity(
    "torque constant of each motor", next(one.parameters for one in POPULATION if one.what == GAIN), 0.9, 1.1, each=True
)


@dataclass(frozen=True)
class Subject:
    """The robot file with the settings that are asked for.

    Attributes:
        path: of the file; None: the robot the FMUs were built with.
        name: of the robot.
        motor_current: torque is sensed by the motors' current.
        testbed, controller: all parameters.
        stated: the settings of both models beside the file's.
        changed: of both models, what differs from the models' own start values: what a run has to set.
    """

    path: Path | None
    name: str
    motor_current: bool
    testbed: Mapping[str, Value]
    controller: Mapping[str, Value]
    stated: Mapping[str, Mapping[str, Value]]
    changed: Mapping[str, Mapping[str, Value]]


def subject(path: Path | None, stated: Mapping[str, Mapping[str, Value]] | None = None) -> Subject:
    """The robot of the file ``path``, with ``stated`` parameters of testbed and controller."""
    robot = read_robot(native.robot() if path is None else path)
    own = {model: dict((stated or {}).get(model, {})) for model in native.MODELS}
    values, changed = {}, {}
    for model in native.MODELS:
        variables = table(model)
        starts = {v.name: v.start for v in variables.select("parameter") if v.start is not None}
        values[model] = MappingProxyType(starts | variables.robot_values(robot) | variables.check_all(own[model]))
        changed[model] = {name: value for name, value in values[model].items() if value != starts[name]}
    for name in ("base.tipping", "roller.arrangement", "imu.present", "slider.present"):
        if own["testbed"].get(name):
            raise GivewayError(f"testbed.{name}", own["testbed"][name], "0: pushes are those of the planar plant alone")
    sensed = int(values["testbed"]["drivetrain.sensing"]) == 1
    return Subject(path, robot.name, sensed, values["testbed"], values["controller"], own, changed)


def differing(whose: Subject, count: int) -> Sequence[Mapping[str, Value]]:
    """The parameters of ``count`` robots that differ from the file; a robot is the same among any number of others."""
    return [_one(whose, number) for number in range(count)]


def _one(whose: Subject, number: int) -> Mapping[str, Value]:
    rng = np.random.default_rng((SEED, number))
    values: dict[str, Value] = {}
    for quantity in quantities_of(GROUPS[0]):
        drawn = CONSTANTS if whose.motor_current and quantity.what == GAIN else quantity
        for name, found in drawn.at(rng.random((1, drawn.draws))):
            values[name] = float(found[0]) * float(whose.testbed[name]) if drawn.scales else float(found[0])
    for name, value in whose.stated["testbed"].items():
        values[name] = value  # what is asked for is not drawn
    variables = table("testbed")
    for name, value in values.items():
        low, high = variables[name].minimum, variables[name].maximum
        if not low <= float(value) <= high:
            raise GivewayError(
                f"testbed.{name}", value, f"{variables[name].allowed}: a robot that differs from the file"
            )
    return MappingProxyType(values)
