"""How a robot is pushed: from every direction at the middle of the outline and towards both of its ends.

A force acts along a line across the outline (base axes), at the point where that line enters it. The robot stands, or
drives straight on at a steady speed in a direction of its own. A push rises and holds; an impulse is a short triangle.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway.detectability.robots import Subject
from giveway.robot.variables import Value
from giveway.scenario.approach import outline_of
from giveway.scenario.plan import Plan, Pushes, Rest, Straight, TimedPush
from giveway.scenario.scenario import Scenario

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["IMPULSE", "KINDS", "MOTION", "PLACES", "PUSH", "REST", "SITUATIONS", "Drive", "Probe", "places", "scenario"]

REST, MOTION = "at rest", "in motion"
SITUATIONS = (REST, MOTION)
PUSH, IMPULSE = "push", "impulse"
KINDS: Mapping[str, str] = {PUSH: "N", IMPULSE: "N.s"}
PLACES: Mapping[str, float] = {"middle": 0.0, "left": 0.8, "right": -0.8}
"""Distance of the force's line from the base's middle, as a share of the outline's half-width; left of the force."""

ACCELERATION_MPS2 = 0.6
SETTLED_S = 0.8  # after the tare, or at full speed: until nothing of the start is left in the controller's baselines
RISE_S, HELD_S = 0.1, 1.0
TRIANGLE_S = 0.02
PATIENCE_S = 0.25  # after the end of the force, as in the batch library's cause of a detection


@dataclass(frozen=True)
class Probe:
    """A line of force in base axes.

    Attributes:
        direction_rad: of the force.
        place: one of `PLACES`.
        point_m: where it enters the outline.
    """

    direction_rad: float
    place: str
    point_m: tuple[float, float]

    @property
    def from_deg(self) -> float:
        """The side from which it comes, 0 to 360 deg."""
        return math.degrees(self.direction_rad + math.pi) % 360.0


@dataclass(frozen=True)
class Drive:
    """How fast, and in which direction of the base."""

    speed_mps: float
    direction_rad: float


def places(whose: Subject, directions: int, names: Sequence[str] = tuple(PLACES)) -> list[Probe]:
    """Probes from ``directions`` sides all around, at the places called ``names``."""
    outline = outline_of(whose.testbed)
    found = []
    for number in range(directions):
        side = 2.0 * math.pi * number / directions
        for name in names:
            found.append(Probe(side - math.pi, name, _entry(outline, side - math.pi, PLACES[name])))
    return found


def _entry(outline: NDArray[np.float64], direction_rad: float, share: float) -> tuple[float, float]:
    """Where a line of this direction enters the convex outline; ``share`` of its half-width left of the middle."""
    along = np.array([math.cos(direction_rad), math.sin(direction_rad)])
    left = np.array([-along[1], along[0]])
    across = outline @ left
    # The middle is that of the base, which the outline holds: shares are of the width on their own side.
    offset = share * (float(across.max()) if share > 0.0 else -float(across.min()))
    reached = []
    for start, end in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        low, high = float(start @ left), float(end @ left)
        if (low - offset) * (high - offset) <= 0.0 and low != high:
            point = start + (end - start) * ((offset - low) / (high - low))
            reached.append((float(point @ along), point))
    entry = min(reached, key=lambda one: one[0])[1]
    return float(entry[0]), float(entry[1])


def scenario(
    whose: Subject,
    robot: Mapping[str, Value],
    number: int,
    drive: Drive | None,
    kind: str,
    probe: Probe | None,
    size: float,
    controller: Mapping[str, Value],
) -> Scenario:
    """Robot ``number`` pushed with ``size`` N or N s; without a probe it is not.

    ``drive``: None at rest. ``controller``: beside what the robot file and the settings say.
    """
    begin_s, plan = _until(whose, drive)
    lasts_s = TRIANGLE_S if kind == IMPULSE else RISE_S + HELD_S
    push = None
    if probe is not None:
        if kind == IMPULSE:
            timed = TimedPush(
                2.0 * size / TRIANGLE_S, probe.direction_rad, *probe.point_m, begin_s, TRIANGLE_S, 0.5 * TRIANGLE_S
            )
        else:
            # It has not fallen when the run ends.
            timed = TimedPush(size, probe.direction_rad, *probe.point_m, begin_s, 2.0 * (lasts_s + PATIENCE_S), RISE_S)
        push = Pushes((timed,))
    return Scenario(
        f"robot {number}",
        round(begin_s + lasts_s + PATIENCE_S, 3),
        bumper="none",
        testbed={**whose.changed["testbed"], **robot, "slider.present": False, "rope.attached": False},
        controller={**whose.changed["controller"], **controller},
        plan=plan,
        push=push,
        seed=1 + number,
    )


def _until(whose: Subject, drive: Drive | None) -> tuple[float, Plan]:
    """When the force begins, and the plan until then."""
    tare_s = float(whose.controller["estimator.tare_ticks"]) * float(whose.controller["controller.period"])
    if drive is None:
        return round(tare_s + SETTLED_S, 3), Rest()
    ramp_s = 0.5 * math.pi * drive.speed_mps / ACCELERATION_MPS2
    plan = Straight(drive.speed_mps, drive.direction_rad, acceleration_mps2=ACCELERATION_MPS2)
    return round(tare_s + ramp_s + SETTLED_S, 3), plan
