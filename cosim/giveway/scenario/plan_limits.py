"""Plans that the controller cannot follow, refused before anything runs.

The controller's reference keeps ``controller.reference.*_limit``: beyond these limits the reference lags the plan, so
the robot is behind the planned position, and slower.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from giveway.base.errors import GivewayError
from giveway.scenario.arcs import Arcs
from giveway.scenario.plan import Circle, Straight

if TYPE_CHECKING:
    from giveway.robot.variables import Value
    from giveway.scenario.plan import Plan
    from giveway.scenario.scenario import Scenario

__all__ = ["LIMIT_NAMES", "Limits", "check_plan", "check_plan_of", "limits_of"]

EXCESS = 0.02  # of both accelerations together: the reference corrects this small excess within a millimetre
SAMPLES = 1001  # of the time in which a circle's speed is reached


@dataclass(frozen=True)
class Limits:
    """Limits of the controller's reference.

    Attributes:
        speed_mps, acceleration_mps2: along the path.
        yaw_rate_radps, yaw_acceleration_radps2: of the heading.
    """

    speed_mps: float
    acceleration_mps2: float
    yaw_rate_radps: float
    yaw_acceleration_radps2: float


_NAMES = {
    "speed_mps": ("reference.speed_limit", "m/s"),
    "acceleration_mps2": ("reference.acceleration_limit", "m/s2"),
    "yaw_rate_radps": ("reference.yaw_rate_limit", "rad/s"),
    "yaw_acceleration_radps2": ("reference.yaw_acceleration_limit", "rad/s2"),
}


LIMIT_NAMES = tuple(name for name, _ in _NAMES.values())
"""The controller's parameters that `limits_of` reads."""


def limits_of(controller: Mapping[str, Value]) -> Limits:
    """The limits among the controller's parameters ``controller``; a missing one has its start value."""
    from giveway.robot.variables import table

    variables = table("controller")
    values = {key: controller.get(name, variables[name].start) for key, (name, _) in _NAMES.items()}
    return Limits(**{key: float(value or 0.0) for key, value in values.items()})


def check_plan_of(scenario: Scenario) -> None:
    """`check_plan` of the scenario's plan, with its robot file and overrides."""
    check_plan(scenario.plan, limits_of(scenario.parameters("controller")))


def check_plan(plan: Plan, limits: Limits) -> None:
    """Refuse a `Straight`, `Circle` or `Arcs` beyond ``limits``; other plans are not checked.

    Raises:
        GivewayError: naming the plan's field (``Straight.speed_mps``), its value and the limit.
    """
    name = type(plan).__name__
    if isinstance(plan, Straight):
        _refuse(f"{name}.speed_mps", plan.speed_mps, plan.speed_mps, "speed_mps", limits)
        if plan.acceleration_mps2 is not None:
            at = f"{name}.acceleration_mps2"
            _refuse(at, plan.acceleration_mps2, plan.acceleration_mps2, "acceleration_mps2", limits)
    elif isinstance(plan, Circle):
        _check_circle(plan, limits)
    elif isinstance(plan, Arcs):
        _check_arcs(plan, limits)


def _check_arcs(plan: Arcs, limits: Limits) -> None:
    """The quickest moments of every arc; accelerations are largest at its ends or in its middle, or between."""
    omega = 2.0 * math.pi * plan.frequency_hz
    rate, growth = plan.swing_rad * omega, plan.swing_rad * omega**2
    at = "Arcs.frequency_hz"
    for number in range(len(plan.wheels)):
        vx, vy, turn = plan.arc(number).twist
        along, turn = math.hypot(vx, vy), abs(turn)
        largest = max(
            math.hypot(growth * along * math.cos(phase), (rate * math.sin(phase)) ** 2 * along * turn)
            for phase in (0.5 * math.pi * index / (SAMPLES - 1) for index in range(SAMPLES))
        )
        for asked, limit, what in (
            (rate * along, "speed_mps", "speed"),
            (largest, "acceleration_mps2", "acceleration"),
            (rate * turn, "yaw_rate_radps", "yaw rate"),
            (growth * turn, "yaw_acceleration_radps2", "yaw acceleration"),
        ):
            _refuse(at, plan.frequency_hz, asked, limit, limits, what)


def _check_circle(plan: Circle, limits: Limits) -> None:
    radius_m, speed = 0.5 * plan.diameter_m, abs(plan.speed_mps)
    at = "Circle.speed_mps"
    _refuse(at, plan.speed_mps, speed, "speed_mps", limits)
    _refuse(at, plan.speed_mps, speed**2 / radius_m, "acceleration_mps2", limits, "centripetal acceleration")
    turning = plan.heading == "turning"
    if turning:
        _refuse(at, plan.speed_mps, speed / radius_m, "yaw_rate_radps", limits, "yaw rate")
    along = plan.acceleration_mps2
    if along is None or speed == 0.0:
        return
    at = "Circle.acceleration_mps2"
    _refuse(at, along, along, "acceleration_mps2", limits)
    _refuse(
        at,
        along,
        _largest_acceleration(along, speed, radius_m),
        "acceleration_mps2",
        limits,
        "with the way round",
        EXCESS,
    )
    if turning:
        _refuse(at, along, along / radius_m, "yaw_acceleration_radps2", limits, "yaw acceleration")


def _largest_acceleration(along_mps2: float, speed_mps: float, radius_m: float) -> float:
    """Of a circle started from rest: half a sine wave along the path, and the growing centripetal acceleration,
    m/s2."""
    largest = 0.0
    for index in range(SAMPLES):
        phase = math.pi * index / (SAMPLES - 1)
        inwards = (0.5 * speed_mps * (1.0 - math.cos(phase))) ** 2 / radius_m
        largest = max(largest, math.hypot(along_mps2 * math.sin(phase), inwards))
    return largest


def _refuse(
    field: str, value: float, asked: float, limit: str, limits: Limits, what: str = "", excess: float = 0.0
) -> None:
    """Refuse ``value``, which requires ``asked`` (a quantity ``what`` that follows from it, if not itself)."""
    most, (name, unit) = getattr(limits, limit), _NAMES[limit]
    if asked > most * (1.0 + excess):
        found: object = value if not what else f"{value:g} ({what}: {asked:.3g} {unit})"
        raise GivewayError(field, found, f"at most {most:g} {unit}, controller.{name}")
