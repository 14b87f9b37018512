"""What happens to the robot: the cases of the table, each a run with its record.

Places and headings are spread evenly, what is left open is drawn from the seed of the case. Full: all of them; quick:
every fifth or so.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from giveway.crowd.drive import Drive, Leg, tare_s
from giveway.scenario.plan import Circle, Plan, Rest, TimedPush

from verify.second_simulator.loop import Hit, Run
from verify.second_simulator.mjcf import BUMPERS

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Case", "cases"]

SPEED_MPS = 0.5  # of what hits
PLACES_PER_SIDE, SPREAD = 5, 0.75  # of the side's half length
REST_HIT_S, AFTER_HIT_S = 1.0, 3.0
CIRCLE_M, CIRCLE_MPS, CIRCLE_MPS2 = 1.5, 0.16, 0.3
CRUISE_S = 1.0  # of what stops again
PUSH_N, PUSH_S, PUSH_RAMP_S, UNTOUCHED_S = 20.0, 2.0, 0.2, 10.0


@dataclass(frozen=True)
class Case:
    """One run and what it is for, in the words of `giveway crowd`.

    Attributes:
        situation: "rest", "motion", "starting", "stopping", "reacting", "circle".
        kind: "free", "slow push" or "nothing": nobody touches the robot.
    """

    name: str
    situation: str
    kind: str
    bumper: str
    run: Run
    second_s: float | None = None

    def record(self, number: int, judged: Any) -> dict[str, Any]:
        """As those of `giveway crowd`."""
        return {
            "number": number,
            "name": self.name,
            "group": "second simulator",
            "situation": self.situation,
            "kind": self.kind,
            "bumper": self.bumper,
            "stated": self.kind == "free",
            "moving": not isinstance(self.run.plan, Rest),
            "second_s": self.second_s,
            "simulated_s": self.run.duration_s,
            "judged": judged,
        }


def cases(parameters: Mapping[str, Any], controller: Mapping[str, Any], seed: int, quick: bool) -> list[Case]:
    """All of them, or some of every kind."""
    found = []
    for group, (stride, make) in enumerate(
        (
            (4, _at_rest),  # strides that meet every bumper
            (7, _in_motion),
            (5, _starting_hits),
            (5, _stopping_hits),
            (4, _second_hits),
            (5, _slow_pushes_at_rest),
            (6, _slow_pushes_in_motion),
            (5, _starts_and_stops),
            (3, _circles),
        )
    ):
        every = list(make(parameters, np.random.default_rng((seed, group))))
        for number, case in enumerate(every[:: stride if quick else 1]):
            run = replace(case.run, seed=1000 * seed + 100 * group + number, controller=controller)
            found.append(replace(case, run=run))
    return found


def _places(p: Mapping[str, Any]) -> list[tuple[str, float, float, float]]:
    """Name, point and inward normal, evenly along every side."""
    count = int(p["outline.count"])
    corners = np.array([(p[f"outline.x[{i}]"], p[f"outline.y[{i}]"]) for i in range(count)])
    found = []
    for side in range(count):
        start, end = corners[side], corners[(side + 1) % count]
        along = end - start
        inward = math.atan2(along[0], -along[1])
        for step in np.linspace(-SPREAD, SPREAD, PLACES_PER_SIDE):
            x, y = 0.5 * (start + end) + 0.5 * step * along
            offset = 0.5 * step * math.hypot(*along)
            found.append((f"side {side} {100.0 * offset:+.0f} cm", float(x), float(y), inward))
    return found


def _hit(time_s: float, place: tuple[str, float, float, float]) -> Hit:
    return Hit(time_s, *place[1:], SPEED_MPS)


def _at_rest(p: Mapping[str, Any], _rng: np.random.Generator) -> Iterator[Case]:
    for place in _places(p):
        for bumper in BUMPERS:
            run = Run(REST_HIT_S + AFTER_HIT_S, hits=(_hit(REST_HIT_S, place),))
            yield Case(f"rest, {place[0]}, {bumper}", "rest", "free", bumper, run)


def _straight(rng: np.random.Generator, heading: float, cruise_s: float = math.inf) -> Drive:
    speed, theta, acceleration = rng.uniform(0.08, 0.4), rng.uniform(-math.pi, math.pi), rng.uniform(0.3, 1.0)
    return Drive((Leg(0.0, speed, acceleration, cruise_s, heading),), theta)


def _around(rng: np.random.Generator, turning: bool) -> Circle:
    return Circle(
        CIRCLE_M,
        CIRCLE_MPS * float(rng.choice((-1.0, 1.0))),
        start_rad=rng.uniform(-math.pi, math.pi),
        heading="turning" if turning else "fixed",
        theta_rad=rng.uniform(-math.pi, math.pi),
        acceleration_mps2=CIRCLE_MPS2,
    )


def _headings(count: int) -> NDArray[np.float64]:
    return np.linspace(-math.pi, math.pi, count, endpoint=False)


def _in_motion(p: Mapping[str, Any], rng: np.random.Generator) -> Iterator[Case]:
    places = _places(p)
    for number, heading in enumerate(_headings(len(places) * len(BUMPERS))):
        place, bumper = places[(4 * number) % len(places)], BUMPERS[number % len(BUMPERS)]
        circle = number % 2 == 1
        straight = _straight(rng, heading)
        plan: Plan = _around(rng, number % 4 == 3) if circle else straight
        ramp_s = 0.5 * math.pi * CIRCLE_MPS / CIRCLE_MPS2 if circle else straight.legs[0].ramp_s
        at_s = tare_s() + ramp_s + rng.uniform(0.3, 1.5)
        run = Run(at_s + AFTER_HIT_S, plan, hits=(_hit(at_s, place),))
        where = "circle" if circle else "straight"
        yield Case(f"{where}, {place[0]}, {bumper}", "motion", "free", bumper, run)


def _ramp_hits(p: Mapping[str, Any], rng: np.random.Generator, starting: bool) -> Iterator[Case]:
    places = _places(p)
    for number, heading in enumerate(_headings(24)):
        place, bumper = places[(7 * number) % len(places)], BUMPERS[number % len(BUMPERS)]
        plan = _straight(rng, heading, math.inf if starting else CRUISE_S)
        (leg,) = plan.legs
        at_s = tare_s() + (0.0 if starting else leg.cruise_to_s) + rng.uniform(0.1, 0.9) * leg.ramp_s
        name = "starting" if starting else "stopping"
        run = Run(at_s + AFTER_HIT_S, plan, hits=(_hit(at_s, place),))
        yield Case(f"{name}, {place[0]}, {bumper}", name, "free", bumper, run)


def _starting_hits(p: Mapping[str, Any], rng: np.random.Generator) -> Iterator[Case]:
    return _ramp_hits(p, rng, True)


def _stopping_hits(p: Mapping[str, Any], rng: np.random.Generator) -> Iterator[Case]:
    return _ramp_hits(p, rng, False)


def _second_hits(p: Mapping[str, Any], rng: np.random.Generator) -> Iterator[Case]:
    places = _places(p)
    for number in range(15):
        first, second = places[number], places[(7 * number + 6) % len(places)]
        bumper = BUMPERS[number % len(BUMPERS)]
        again_s = REST_HIT_S + rng.uniform(0.5, 1.5)
        run = Run(again_s + AFTER_HIT_S, hits=(_hit(REST_HIT_S, first), _hit(again_s, second)))
        yield Case(f"{first[0]}, then {second[0]}, {bumper}", "reacting", "free", bumper, run, again_s)


def _push(place: tuple[str, float, float, float], theta_rad: float, start_s: float) -> TimedPush:
    direction = math.remainder(theta_rad + place[3], 2.0 * math.pi)
    return TimedPush(PUSH_N, direction, place[1], place[2], start_s, PUSH_S, PUSH_RAMP_S)


def _slow_pushes_at_rest(p: Mapping[str, Any], _rng: np.random.Generator) -> Iterator[Case]:
    for place in _places(p):
        run = Run(REST_HIT_S + PUSH_S + 2.0, pushes=(_push(place, 0.0, REST_HIT_S),))
        yield Case(f"slow push at rest, {place[0]}", "rest", "slow push", "none", run)


def _slow_pushes_in_motion(p: Mapping[str, Any], rng: np.random.Generator) -> Iterator[Case]:
    for place in _places(p)[::2]:
        plan = _around(rng, False)
        run = Run(UNTOUCHED_S + PUSH_S + 2.0, plan, pushes=(_push(place, plan.theta_rad, UNTOUCHED_S),))
        yield Case(f"slow push on a circle, {place[0]}", "motion", "slow push", "none", run)


def _starts_and_stops(p: Mapping[str, Any], rng: np.random.Generator) -> Iterator[Case]:
    """Nobody touches it: 30 headings, gently and fast."""
    for number, heading in enumerate(_headings(30)):
        growth = (0.05, 0.2, 0.6)[number % 3]
        speed = (0.1, 0.2, 0.4)[number % 3]
        leg = Leg(0.0, speed, growth, CRUISE_S, heading)
        run = Run(tare_s() + leg.end_s + 1.5, Drive((leg,), rng.uniform(-math.pi, math.pi)))
        yield Case(
            f"start and stop, {math.degrees(heading):+.0f} deg at {growth:g} m/s2",
            "starts and stops",
            "nothing",
            "none",
            run,
        )


def _circles(p: Mapping[str, Any], rng: np.random.Generator) -> Iterator[Case]:
    """Nobody touches it."""
    for number in range(6):
        yield Case(f"circle {number}", "circle", "nothing", "none", Run(40.0, _around(rng, number % 2 == 1)))
