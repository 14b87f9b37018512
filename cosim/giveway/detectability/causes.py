"""What limits the smallest push: the same robots, with one limit after the other taken away.

The one without which a smaller push is noticed limits it. What a controller believes of noise and rollers goes with it;
its thresholds are halved, as without any it would always be alarmed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from giveway.detectability.robots import Subject
from giveway.robot.variables import Value, table
from giveway.robot.wheels import WHEELS

__all__ = ["CAUSES", "GEAR_CAUSE", "THRESHOLDS", "THRESHOLD_CAUSE", "Changed", "raised", "without_gears"]

THRESHOLDS: Mapping[int, tuple[str, ...]] = MappingProxyType(
    {
        0: ("detector.force_threshold",),
        1: ("detector.impulse_threshold", "detector.leak_rest", "detector.leak_creep", "detector.leak_motion"),
        2: (
            *(f"channels.{channel}_{when}" for channel in ("fast", "slow") for when in ("rest", "creep", "motion")),
            "channels.noise_multiple",
            "channels.model_multiple",
        ),
    }
)
"""What is compared with the estimated force, or with its impulse, by ``detector.kind``."""

GEAR_CAUSE, THRESHOLD_CAUSE = "gear friction", "thresholds"
LEAST_FRICTION = 0.01  # of the rollers: none at all is another plant
LEAST_GEAR_FRICTION = 0.1  # without any, encoder counts keep a resting servo moving


@dataclass(frozen=True)
class Changed:
    """Parameters that take away one limit.

    Attributes:
        testbed, controller: beside those of a robot, which they replace.
    """

    testbed: Mapping[str, Value]
    controller: Mapping[str, Value]


def _each(name: str, value: Value) -> dict[str, Value]:
    return {f"{name}[{wheel}]": value for wheel in range(WHEELS)}


def _noise(whose: Subject) -> Changed:
    believed = table("controller")["estimator.torque_noise"].minimum
    return Changed({"electronics.torque_noise": 0.0}, {"estimator.torque_noise": believed})


def _resolution(whose: Subject) -> Changed:
    return Changed({"electronics.torque_resolution": 0.0}, {})


def _with_gears(whose: Subject, share: float) -> Changed:
    names = ("gear.coulomb_torque", "gear.viscous_damping", "motor.coulomb_torque")
    known = {name: share * float(whose.controller[name]) for name in names}
    return Changed(_each("drivetrain.friction_scale", share), known)


def _gears(whose: Subject) -> Changed:
    return _with_gears(whose, LEAST_GEAR_FRICTION)


def without_gears(whose: Subject) -> Changed:
    """No friction in the gears, as the controller knows."""
    return _with_gears(whose, 0.0)


def _rollers(whose: Subject) -> Changed:
    # Their stiffness at rest, too: bristles that stay as stiff follow a sliding robot faster than fixed steps can.
    known = float(whose.controller["friction.coulomb_torque"])
    return Changed(
        {**_each("roller.friction_scale", LEAST_FRICTION), **_least(whose.testbed, "testbed", "roller")},
        {"friction.coulomb_torque": LEAST_FRICTION * known, **_least(whose.controller, "controller", "estimator")},
    )


def _least(values: Mapping[str, Value], model: str, group: str) -> dict[str, Value]:
    names = [f"{group}.presliding_stiffness[{wheel}]" for wheel in range(WHEELS)]
    return {name: max(LEAST_FRICTION * float(values[name]), table(model)[name].minimum) for name in names}


def _thresholds(whose: Subject) -> Changed:
    return Changed({}, raised(whose, 0.5))


CAUSES: Mapping[str, tuple[str, Callable[[Subject], Changed]]] = MappingProxyType(
    {
        "noise": ("without noise of the torque signal", _noise),
        "resolution": ("without its quantum", _resolution),
        GEAR_CAUSE: ("with a tenth of the gears' friction", _gears),
        "roller friction": ("with a hundredth of the rollers' friction", _rollers),
        THRESHOLD_CAUSE: ("with half the thresholds", _thresholds),
    }
)
"""By name: in words, and what it changes."""


def raised(whose: Subject, factor: float) -> dict[str, Value]:
    """The thresholds of the controller times ``factor``, within the ranges that it allows."""
    variables = table("controller")
    found: dict[str, Value] = {}
    for name in THRESHOLDS[int(whose.controller["detector.kind"])]:
        low, high = variables[name].minimum, variables[name].maximum
        found[name] = min(max(float(whose.controller[name]) * factor, low), high)
    return found
