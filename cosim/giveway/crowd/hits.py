"""What happens to the robots of the crowd: hits all around, slow pushes and moments, while they stand, drive or react.

`DRAWN` states every distribution. A hit depends on the draw and on its number alone; hit ``number`` belongs to robot
``number // PER_ROBOT``. A draw that cannot be (slider and robot would not approach each other at this place, the weight
is too light for this speed) is drawn again.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.errors import GivewayError
from giveway.base.gravity import GRAVITY_MPS2
from giveway.crowd.blow import Blow
from giveway.crowd.drive import Drive, Leg, fastest, tare_s
from giveway.crowd.population import (
    DRAWS,
    GROUP_PATTERN,
    Robot,
    check_same,
    controller_of,
    robot,
    start_value,
    start_values,
)
from giveway.robot.variables import Value
from giveway.scenario.approach import Approach, edge_middle, meet_as_stated, outline_of
from giveway.scenario.plan import Plan, Pushes, Rest, TimedPush
from giveway.scenario.scenario import BUMPERS, ROBOT_BUMPERS, Scenario
from giveway.scenario.stated_contact import StatedContact

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["DRAWN", "PATTERN", "PER_ROBOT", "SITUATIONS", "Hit", "hit"]

PATTERN: tuple[tuple[str, str], ...] = (
    ("rest", "free"),
    ("rest", "free"),
    ("rest", "pulled"),
    ("motion", "free"),
    ("motion", "free"),
    ("motion", "pulled"),
    ("motion", "clamped"),
    ("starting", "free"),
    ("stopping", "free"),
    ("reacting", "free"),
    ("rest or motion", "slow push"),
    ("rest or motion", "moment"),
)
"""Situation and kind of each robot's hits. The first ten are hits; ``rest or motion``: by the robot's number."""

PER_ROBOT = len(PATTERN)
SITUATIONS = tuple(dict.fromkeys(situation for situation, _ in PATTERN))

DRAWN: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "heading, rad": (-math.pi, math.pi),
        "speed of the robot, m/s": (0.08, 0.4),
        "acceleration of the robot, m/s2": (0.3, 1.0),
        "diameter of a circle, m": (0.8, 3.0),  # half of the plans; clockwise or not; half of them turn the heading
        "start of the motion, s": (0.2, 0.5),
        "place, share of the outline": (0.0, 1.0),
        "speed of what hits, m/s": (0.2, 1.0),  # in every third hit exactly `STATED_MPS`
        "mass of what hits, kg, logarithmic": (2.0, 75.0),
        "direction from the side's normal, rad": (-math.pi / 6.0, math.pi / 6.0),
        "friction of the cover": (0.0, 0.3),
        "height of the contact with tipping, m": (0.1, 0.9),
        "contact at rest, s": (0.8, 1.2),
        "contact after full speed, s": (0.2, 0.7),
        "contact in a ramp, share": (0.0, 1.0),  # while starting; while stopping, up to `STANDING_S` after it
        "hanging weight over what hits, at rest": (0.1, 0.5),
        "run-up on the rope, in motion, s": (1.3, 2.3),
        "gap between what is clamped and its wall, m, logarithmic": (0.001, 0.02),
        "second hit after the first, s": (0.5, 1.5),
        "rise of a slow push, s": (0.1, 0.3),
        "slow push after the start, s": (10.0, 10.5),
        "moment, N m": (4.0, 8.0),
    }
)

STATED_MPS = 0.5  # the speed for which delays are promised
STATED_EVERY = 3
STANDING_S = 0.3
SHORTEST_RUN_UP_S = 0.4  # at rest: after the controller's tare, and a while
LONGEST_RAMP_S = 1.2
PUSH_N, PUSH_S = 20.0, 2.0
MOMENT_N = 1.0  # a force so small at an arm so long that it is hardly more than its moment
DURATION_S, PUSHED_AT_REST_S, PUSHED_IN_MOTION_S = 4.5, 4.0, 14.0
TRIES = 1000
SECOND_SPEED = (0.2, 1.0)


@dataclass(frozen=True)
class Hit:
    """One run of the crowd.

    Attributes:
        number: from 0.
        robot: who is hit.
        situation: "rest", "motion", "starting", "stopping" or "reacting".
        kind: "free", "pulled", "clamped", "slow push" or "moment".
        bumper: "none", "spring" or "magnetic".
        speed_mps, mass_kg: of what hits; of the second hit while reacting; 0 of a push.
        stated: its speed is `STATED_MPS`.
        moment_nm: of a pure moment; else 0.
        scenario: the whole input of the run.
    """

    number: int
    robot: Robot
    situation: str
    kind: str
    bumper: str
    speed_mps: float
    mass_kg: float
    stated: bool
    moment_nm: float
    scenario: Scenario


def hit(
    draw: str,
    number: int,
    controller: Mapping[str, Value] | None = None,
    *,
    imu: bool = False,
    file: Path | None = None,
    same: Mapping[str, Value] | None = None,
) -> Hit:
    """Hit ``number`` of ``draw`` with these parameters of the controller; ``imu``: of a robot that has one.

    ``file``: robots of this robot file instead of Trikey's. What hits a lighter one is as much lighter, a push and a
    moment as much weaker, and none drives faster than `drive.SPEED_SHARE` of its limit or is hit above its body.
    ``same``: parameters of the testbed that every robot has alike, whatever was drawn.
    """
    whose = robot(draw, number // PER_ROBOT, imu, file)
    if same:
        check_same(same)
        whose = dataclasses.replace(whose, testbed=MappingProxyType({**whose.testbed, **same}))
    situation, kind = PATTERN[number % PER_ROBOT]
    if situation == "rest or motion":
        # Half of the robots of every plant, which repeat after ten.
        situation = "motion" if (whose.number + whose.number // len(GROUP_PATTERN)) % 2 else "rest"
    return _Draw(draw, number, whose, situation, kind).hit(controller_of(whose, controller or {}))


@functools.cache
def _outline(file: Path | None) -> NDArray[np.float64]:
    return outline_of(start_values(robot=file))


@functools.cache
def _lighter(file: Path | None) -> float:
    """Mass of the robot over Trikey's, at most 1."""
    return 1.0 if file is None else min(1.0, start_value("base.mass", robot=file) / start_value("base.mass"))


@functools.cache
def _met(file: Path | None) -> Mapping[str, Value]:
    """What the place and the start of a slider depend on, of the testbed."""
    rooms = ("outline.", "slider.", "rope.", "bumper.", "contact.")
    return MappingProxyType({name: value for name, value in start_values(robot=file).items() if name.startswith(rooms)})


class _Draw:
    """The draws of one hit."""

    def __init__(self, draw: str, number: int, whose: Robot, situation: str, kind: str) -> None:
        self._rng = np.random.default_rng((DRAWS[draw], 1, number))
        self._number, self._robot, self._situation, self._kind = number, whose, situation, kind
        self._file, self._outline, self._lighter = whose.file, _outline(whose.file), _lighter(whose.file)
        self._bumper = str(self._rng.choice(list(ROBOT_BUMPERS)))
        self._seed = int(self._rng.integers(2**31))
        self._stated = int(self._rng.integers(STATED_EVERY)) == 0

    def _uniform(self, what: str) -> float:
        return float(self._rng.uniform(*DRAWN[what]))

    def _logarithmic(self, what: str) -> float:
        low, high = DRAWN[what]
        return float(low * (high / low) ** self._rng.uniform())

    def _mass(self) -> float:
        return self._lighter * self._logarithmic("mass of what hits, kg, logarithmic")

    def _coin(self) -> bool:
        return bool(self._rng.uniform() < 0.5)

    def hit(self, controller: Mapping[str, Value]) -> Hit:
        for _ in range(TRIES):
            try:
                return self._try(controller)
            except GivewayError as error:
                if error.field not in ("direction_rad", "speed_mps", "point_m"):
                    raise
        raise GivewayError(f"hit {self._number}", f"refused {TRIES} times", "a hit that can be")

    def _try(self, controller: Mapping[str, Value]) -> Hit:
        if self._kind in ("slow push", "moment"):
            return self._pushed(controller)
        plan, contact_s = self._motion()
        mass, speed = self._mass(), self._speed()
        slider, stated, contact_s = self._slider(plan, contact_s, mass, speed)
        scenario = self._scenario(plan, DURATION_S, {**slider, "slider.mass": mass}, controller)
        scenario = dataclasses.replace(scenario, contact=stated)
        if self._situation == "reacting":
            mass, speed = self._mass(), self._speed()
            point, inward = self._place()
            direction = self._heading_at(plan, contact_s) + inward
            start_s = contact_s + self._uniform("second hit after the first, s")
            blow = Blow(self._bumper, mass, speed, direction, point, start_s, self._file)
            scenario = dataclasses.replace(scenario, push=blow)
        return self._made(scenario, speed, mass, 0.0)

    def _made(self, scenario: Scenario, speed: float, mass: float, moment: float) -> Hit:
        drawn = (self._bumper, speed, mass, self._stated, moment)
        return Hit(self._number, self._robot, self._situation, self._kind, *drawn, scenario)

    def _scenario(
        self, plan: Plan, duration_s: float, testbed: Mapping[str, Value], controller: Mapping[str, Value]
    ) -> Scenario:
        height = self._uniform("height of the contact with tipping, m") * self._lower()
        own = {**self._robot.testbed, **testbed, "contact.height": height, "push.height": height}
        start = plan(np.zeros(1))[0]
        own["start.theta"] = float(start[2])
        return Scenario(
            f"crowd {self._number}",
            duration_s,
            bumper=self._bumper,
            testbed=own,
            controller=controller,
            plan=plan,
            seed=self._seed,
            robot=self._file,
        )

    def _lower(self) -> float:
        """Height of the centre of mass over Trikey's, at most 1."""
        if self._file is None:
            return 1.0
        return min(1.0, start_value("base.com_height", robot=self._file) / start_value("base.com_height"))

    def _speed(self) -> float:
        drawn = self._uniform("speed of what hits, m/s")
        return STATED_MPS if self._stated else drawn

    def _motion(self) -> tuple[Plan, float]:
        """The plan, and when the contact is to be."""
        heading = self._uniform("heading, rad")
        if self._situation == "rest" or (self._situation == "reacting" and self._coin()):
            return Rest(0.0, 0.0, heading), self._uniform("contact at rest, s")
        leg = self._leg(math.inf)
        tare = tare_s()
        share = self._uniform("contact in a ramp, share")
        after = self._uniform("contact after full speed, s")
        if self._situation == "starting":
            return Drive((leg,), heading), tare + leg.start_s + share * leg.ramp_s
        if self._situation == "stopping":
            leg = dataclasses.replace(leg, cruise_s=after)
            return Drive((leg,), heading), tare + leg.cruise_to_s + share * (leg.ramp_s + STANDING_S)
        return Drive((leg,), heading), tare + leg.cruise_from_s + after

    def _leg(self, cruise_s: float, *, circle: bool | None = None, turning: bool | None = None) -> Leg:
        speed = min(self._uniform("speed of the robot, m/s"), fastest(self._file))
        acceleration = self._uniform("acceleration of the robot, m/s2")
        bend = 2.0 / self._uniform("diameter of a circle, m") * (1.0 if self._coin() else -1.0)
        round_it, turned = self._coin(), self._coin()
        return Leg(
            self._uniform("start of the motion, s"),
            speed,
            max(acceleration, 0.5 * math.pi * speed / LONGEST_RAMP_S),
            cruise_s,
            self._uniform("heading, rad"),
            bend if (round_it if circle is None else circle) else 0.0,
            turned if turning is None else turning,
        )

    def _place(self) -> tuple[tuple[float, float], float]:
        """A point of the outline, and a direction into the robot there, both in the base frame."""
        sides: NDArray[np.float64] = np.roll(self._outline, -1, axis=0) - self._outline
        lengths = [math.hypot(*side) for side in sides]
        along = self._uniform("place, share of the outline") * sum(lengths)
        edge = 0
        while edge < len(lengths) - 1 and along > lengths[edge]:
            along -= lengths[edge]
            edge += 1
        half = 0.5 * lengths[edge]
        point = edge_middle(self._outline, edge, min(max(along - half, -half), half))
        inward = math.atan2(sides[edge][0], -sides[edge][1])
        return point, inward + self._uniform("direction from the side's normal, rad")

    def _heading_at(self, plan: Plan, time_s: float) -> float:
        return float(plan(np.array([max(time_s - tare_s(), 0.0)]))[0, 2])

    def _slider(
        self, plan: Plan, contact_s: float, mass: float, speed: float
    ) -> tuple[dict[str, Value], StatedContact, float]:
        """Parameters of the slider, the stated contact and its time."""
        own: dict[str, Value] = {"contact.friction": self._uniform("friction of the cover")}
        rope = self._kind == "pulled"
        if rope:
            own |= self._weight(mass, speed)
        if self._kind == "clamped":
            speed = 0.0
            gap = self._logarithmic("gap between what is clamped and its wall, m, logarithmic")
            own |= {"wall.present": True, "wall.distance": gap}
        point, inward = self._place()
        when = None if rope else contact_s
        heading = self._heading_at(plan, contact_s)
        approach = Approach(point, speed, math.remainder(heading + inward, 2.0 * math.pi), when, rope)
        testbed = {**_met(self._file), **own, "slider.mass": mass, "bumper.kind": BUMPERS[self._bumper]}
        slider, stated, time_s = meet_as_stated(approach, testbed, plan, tare_s())
        return {**own, **slider}, stated, time_s

    def _weight(self, mass: float, speed: float) -> dict[str, Value]:
        """The weight that pulls, so light that its run-up takes as long as it should."""
        heavy = mass * self._uniform("hanging weight over what hits, at rest")
        run_up_s = self._uniform("run-up on the rope, in motion, s")
        wanted = speed / (SHORTEST_RUN_UP_S if self._situation == "rest" else run_up_s)
        weight = (mass * wanted + start_value("slider.friction", robot=self._file)) / (GRAVITY_MPS2 - wanted)
        return {
            "rope.hanging_mass": min(heavy, weight) if self._situation == "rest" else weight,
            "rope.drop_height": 2.0,
        }

    def _pushed(self, controller: Mapping[str, Value]) -> Hit:
        """A slow push or a pure moment."""
        moving = self._situation == "motion"
        heading = self._uniform("heading, rad")
        start_s = self._uniform("slow push after the start, s")
        plan: Plan = Rest(0.0, 0.0, heading)
        duration_s = PUSHED_IN_MOTION_S
        if moving:
            # A force of the world at a point of the base: with a turning heading it would not stay at its angle.
            leg = self._leg(math.inf, turning=False)
            plan, start_s = Drive((leg,), heading), start_s + tare_s() + leg.start_s
        else:
            start_s, duration_s = self._uniform("contact at rest, s"), PUSHED_AT_REST_S
        point, inward = self._place()
        force, moment = PUSH_N * self._lighter, 0.0
        if self._kind == "moment":
            moment = self._uniform("moment, N m") * (1.0 if self._coin() else -1.0) * self._lighter
            arm, force = moment / MOMENT_N, MOMENT_N
            point = (arm * math.sin(inward), -arm * math.cos(inward))
        rise_s = self._uniform("rise of a slow push, s")
        push = Pushes((TimedPush(force, heading + inward, *point, start_s, PUSH_S, rise_s),))
        scenario = self._scenario(plan, duration_s, {"slider.present": False, "rope.attached": False}, controller)
        return self._made(dataclasses.replace(scenario, push=push), 0.0, 0.0, moment)
