"""Random collisions over a wide range, for the comparison of fixed steps with event-exact runs.

Every number of `FACTORS` is drawn around the robot file's value, by a factor that is uniform on a
logarithmic scale; places, directions and kinds are uniform.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from giveway.base.checks import whole
from giveway.base.gravity import GRAVITY_MPS2
from giveway.robot.presets import DEFAULT
from giveway.robot.variables import Value, table
from giveway.robot.wheels import WHEELS
from giveway.scenario.approach import Approach, edge_middle, meet, outline_of
from giveway.scenario.plan import Rest
from giveway.scenario.scenario import BUMPERS, ROBOT_BUMPERS, Scenario

__all__ = ["DURATION_S", "FACTORS", "random_collisions"]

DURATION_S = 0.6
FACTORS: Mapping[str, float] = MappingProxyType(
    {
        "base.mass": 1.5,
        "base.yaw_inertia": 1.5,
        "roller.coulomb_torque": 2.0,
        "roller.presliding_damping": 2.0,
        "roller.stribeck_speed": 2.0,
        "drivetrain.motor_inertia": 2.0,
        "drivetrain.stiffness": 3.0,
        "drivetrain.damping": 3.0,
        "drivetrain.gear_coulomb": 2.0,
        "drivetrain.gear_viscous": 2.0,
        "servo.kp": 1.5,
        "servo.kd": 1.5,
        "electronics.torque_noise": 3.0,
        "slider.mass": 4.0,
        "slider.friction": 3.0,
        "rope.hanging_mass": 2.0,
        "rope.stiffness": 3.0,
        "rope.damping": 3.0,
        "bumper.plate_mass": 2.0,
        "bumper.spring_rate": 4.0,
        "bumper.preload": 3.0,
        "bumper.damping": 3.0,
        "bumper.guide_friction": 2.0,
        "bumper.travel": 2.0,
        "bumper.latch_force": 2.0,
        "bumper.latch_gap": 3.0,
        "contact.stiffness": 10.0,
        "contact.damping": 3.0,
    }
)
"""Each of these is its start value times a random number from 1/factor to factor."""

PRESLIDING_FACTOR = 3.0
SPEED_RANGE_MPS = (0.1, 1.0)
CONTACT_RANGE_S = (0.12, 0.25)  # after the controller's tare
PLACE_SHARE = 0.6  # of a side's half length, from its middle
LONGEST_FALL_M = 0.15  # of the hanging weight before the hit
TILT_RAD = math.radians(35.0)  # from the side's normal


def random_collisions(count: int, seed: int, duration_s: float = DURATION_S, preset: str = DEFAULT) -> list[Scenario]:
    """``count`` scenarios ([0, 1e6]) of ``duration_s`` (s); each depends only on ``seed`` and its number."""
    whole("count", count, 0, 10**6)
    start = {variable.name: variable.start for variable in table("testbed") if variable.start is not None}
    return [_scenario(np.random.default_rng((seed, index)), start, index, duration_s, preset) for index in range(count)]


def _scenario(
    rng: np.random.Generator, start: Mapping[str, Value], index: int, duration_s: float, preset: str
) -> Scenario:
    values: dict[str, Value] = {name: float(start[name]) * _factor(rng, factor) for name, factor in FACTORS.items()}
    values["drivetrain.gear_stiction"] = float(values["drivetrain.gear_coulomb"]) * rng.uniform(1.0, 1.5)
    for wheel in range(WHEELS):
        name = f"roller.presliding_stiffness[{wheel}]"
        values[name] = float(start[name]) * _factor(rng, PRESLIDING_FACTOR)
    values["contact.friction"] = rng.uniform(0.0, 0.4)
    bumper = str(rng.choice(list(ROBOT_BUMPERS)))
    values["bumper.latch_model"] = int(rng.integers(2))
    values["electronics.seed"] = int(rng.integers(2**31))
    values |= _approach(rng, {**start, **values, "bumper.kind": BUMPERS[bumper]})
    del values["electronics.seed"]
    seed = int(rng.integers(2**31))
    return Scenario(f"random {index}", duration_s, bumper=bumper, testbed=values, seed=seed, preset=preset)


def _approach(rng: np.random.Generator, testbed: Mapping[str, Value]) -> dict[str, float | bool]:
    """The slider's start for a hit at a random place, from a random direction, with the rope or without."""
    outline = outline_of(testbed)
    edge = int(rng.integers(len(outline)))
    side = outline[(edge + 1) % len(outline)] - outline[edge]
    point = edge_middle(outline, edge, 0.5 * math.hypot(*side) * PLACE_SHARE * rng.uniform(-1.0, 1.0))
    inwards = math.atan2(side[0], -side[1])
    direction = inwards + TILT_RAD * rng.uniform(-1.0, 1.0)
    low, high = SPEED_RANGE_MPS
    speed = low * (high / low) ** rng.uniform()
    time_s = rng.uniform(*CONTACT_RANGE_S)
    approach = Approach(point, speed, direction, time_s)
    if rng.uniform() < 0.5:  # pulled from rest, in about that time
        weight, slider = float(testbed["rope.hanging_mass"]), float(testbed["slider.mass"])
        pull_mps2 = 0.9 * GRAVITY_MPS2 * weight / (weight + slider)
        speed = min(pull_mps2 * time_s, math.sqrt(2.0 * pull_mps2 * LONGEST_FALL_M))
        approach = Approach(point, speed, direction, rope=True)
    return meet(approach, testbed, Rest())


def _factor(rng: np.random.Generator, factor: float) -> float:
    return float(factor ** rng.uniform(-1.0, 1.0))
