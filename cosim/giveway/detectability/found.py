"""Everything that `giveway detectability` finds of one robot file: pushes, impulses, false alarms, and what limits."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.checks import finite, whole
from giveway.crowd.statistics import Estimate, percentile, rate_upper_bound
from giveway.detectability.alarms import Alarms, alarms
from giveway.detectability.causes import CAUSES, THRESHOLD_CAUSE, raised, without_gears
from giveway.detectability.probes import KINDS, MOTION, PUSH, SITUATIONS, Drive, Probe, places
from giveway.detectability.robots import SEED, Subject, differing
from giveway.detectability.search import Smallest, smallest
from giveway.robot.variables import Value

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Progress = Callable[[str, float], None]

__all__ = ["FACTORS", "SHARE", "Asked", "Cause", "Detectability", "Level", "detect", "parts"]

SHARE = 0.95  # of the robots that notice the push that is told
FACTORS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0, 64.0)
"""On the thresholds, until the false alarms are as rare as asked for."""
CAUSE_DIRECTIONS, CAUSE_ROBOTS = 3, 20  # at the most: of these `causes` tells


@dataclass(frozen=True)
class Asked:
    """How it is searched.

    Attributes:
        robots: that differ from the file.
        directions: of a push, all around.
        speed_mps: of the robots in motion.
        hours: of free motion.
        rate_per_hour: of false alarms that is wished for.
    """

    robots: int = 40
    directions: int = 6
    speed_mps: float = 0.2
    hours: float = 4.0
    rate_per_hour: float = 1.0

    def __post_init__(self) -> None:
        whole("--robots", self.robots, 1, 10_000)
        whole("--directions", self.directions, 1, 360)
        finite("--speed", self.speed_mps, 0.01, 2.0, "m/s")
        finite("--hours", self.hours, 0.01, 10_000.0, "h")
        finite("--false-alarms", self.rate_per_hour, 1e-3, 1000.0, "1/h")

    @property
    def hours_needed(self) -> float:
        """Without any alarm these show the wished rate with 95 % confidence."""
        return rate_upper_bound(0, self.rate_per_hour)

    @property
    def can_show(self) -> bool:
        """Whether the hours are enough for that."""
        return self.hours >= self.hours_needed


@dataclass(frozen=True)
class Level:
    """What is found with the thresholds times ``factor``.

    Attributes:
        factor: on all thresholds of the controller.
        alarms: in free motion.
        smallest: of each situation and kind.
    """

    factor: float
    alarms: Alarms
    smallest: Mapping[tuple[str, str], Smallest] = field(default_factory=dict)

    def meets(self, rate_per_hour: float) -> bool:
        """Whether the alarms are rarer than that with 95 % confidence."""
        return self.alarms.per_hour[2] <= rate_per_hour


@dataclass(frozen=True)
class Cause:
    """One limit taken away.

    Attributes:
        words: what was done.
        values: smallest push at rest and in motion, N, of `SHARE` of the robots and directions.
    """

    words: str
    values: Mapping[str, float]


@dataclass(frozen=True)
class Detectability:
    """Of one robot file.

    Attributes:
        probes: the columns of `Smallest.values`.
        stated: with the controller's own thresholds.
        chosen: with those that keep to the wished rate of false alarms; None: none of `FACTORS` does.
        causes: what the smallest push would be without one limit, with the thresholds of ``told``.
        base: the same with all limits.
        gearless: alarms without friction in the gears, with the controller's own thresholds.
    """

    subject: Subject
    asked: Asked
    probes: Sequence[Probe]
    stated: Level
    chosen: Level | None
    base: Mapping[str, float]
    causes: Mapping[str, Cause]
    gearless: Alarms | None

    @property
    def told(self) -> Level:
        """The level that the robot would have: that of the wished rate, if there is one."""
        return self.stated if self.chosen is None else self.chosen


def of_robots(found: Smallest) -> NDArray[np.float64]:
    """Smallest values, infinite where a robot is alarmed without a force."""
    return np.where(np.isnan(found.values), math.inf, found.values)


def at_each_probe(found: Smallest, share: float = SHARE) -> NDArray[np.float64]:
    """What ``share`` of the robots notice, shape (probes,)."""
    values = of_robots(found)
    ranked = np.sort(values, axis=0)
    return np.asarray(ranked[min(max(math.ceil(share * len(values)), 1), len(values)) - 1])


def anywhere(found: Smallest) -> Estimate:
    """What `SHARE` of the robots notice wherever it acts, with its interval."""
    estimate = percentile(of_robots(found).max(axis=1).tolist(), SHARE)
    assert estimate is not None
    return estimate


def parts(asked: Asked) -> list[str]:
    """The names of the parts of the work, for progress."""
    searches = [f"{kind} {situation}" for situation in SITUATIONS for kind in KINDS]
    return ["false alarms", *searches, "false alarms as wished", *(f"{one}, as wished" for one in searches), "causes"]


def detect(whose: Subject, asked: Asked, threads: int, progress: Progress = lambda name, share: None) -> Detectability:
    """Find it all."""
    work = _Work(whose, asked, threads, progress)
    stated = Level(1.0, work.driven("false alarms"), work.searched({}, ""))
    chosen = stated if stated.meets(asked.rate_per_hour) else work.quiet_enough()
    factor = (chosen or stated).factor
    controller = {} if factor == 1.0 else raised(whose, factor)
    base = work.pushed({}, controller)
    causes = {}
    for number, (name, (words, change)) in enumerate(CAUSES.items()):
        changed = change(whose)
        # The halved thresholds are half of those that the robot has here.
        known = raised(whose, 0.5 * factor) if name == THRESHOLD_CAUSE else {**controller, **changed.controller}
        causes[name] = Cause(words, work.pushed(changed.testbed, known))
        progress("causes", (1 + number) / len(CAUSES))
    gearless = None
    if whose.motor_current:
        changed = without_gears(whose)
        gearless = work.driven("causes", changed.testbed, changed.controller)
    return Detectability(
        whose, asked, work.probes, stated, chosen, MappingProxyType(base), MappingProxyType(causes), gearless
    )


class _Work:
    """The robots that are asked for, how they drive, and what is done with them."""

    def __init__(self, whose: Subject, asked: Asked, threads: int, progress: Progress) -> None:
        self._whose, self._asked, self._threads, self._progress = whose, asked, threads, progress
        self._robots = differing(whose, asked.robots)
        angles = np.random.default_rng((SEED, 0, 1)).uniform(-math.pi, math.pi, asked.robots)
        self._drives = [Drive(asked.speed_mps, angle) for angle in angles.tolist()]
        self.probes = places(whose, asked.directions)

    def driven(
        self,
        name: str,
        changed: Mapping[str, Value] | None = None,
        controller: Mapping[str, Value] | None = None,
        wished_per_hour: float | None = None,
    ) -> Alarms:
        """False alarms; `alarms` says what ``wished_per_hour`` does."""
        robots = [{**robot, **(changed or {})} for robot in self._robots]
        told = functools.partial(self._progress, name)
        return alarms(self._whose, robots, self._asked.hours, controller or {}, self._threads, told, wished_per_hour)

    def searched(self, controller: Mapping[str, Value], after: str) -> dict[tuple[str, str], Smallest]:
        """The smallest of every situation and kind."""
        found = {}
        for situation in SITUATIONS:
            for kind in KINDS:
                told = functools.partial(self._progress, f"{kind} {situation}{after}")
                drives = self._drives if situation == MOTION else None
                found[situation, kind] = smallest(
                    self._whose, self._robots, drives, kind, self.probes, controller, self._threads, told
                )
        return found

    def quiet_enough(self) -> Level | None:
        """The lowest thresholds of `FACTORS` that keep to the wished rate of false alarms."""
        rate = self._asked.rate_per_hour
        for factor in FACTORS[1:] if self._asked.can_show else ():
            controller = raised(self._whose, factor)
            level = Level(factor, self.driven("false alarms as wished", None, controller, rate))
            if level.meets(rate):
                return Level(factor, level.alarms, self.searched(controller, ", as wished"))
        return None

    def pushed(self, changed: Mapping[str, Value], controller: Mapping[str, Value]) -> dict[str, float]:
        """The push at the middle, by situation, of `SHARE` of the first robots and all directions.

        Of those that are not alarmed by themselves: here the question is what the push has to overcome.
        """
        middle = places(self._whose, CAUSE_DIRECTIONS, ("middle",))
        own = [{**robot, **changed} for robot in self._robots[:CAUSE_ROBOTS]]
        values = {}
        for situation in SITUATIONS:
            drives = self._drives[:CAUSE_ROBOTS] if situation == MOTION else None
            found = smallest(self._whose, own, drives, PUSH, middle, controller, self._threads)
            ranked = np.sort(found.values[~found.alarmed], axis=None)
            values[situation] = float(ranked[math.ceil(SHARE * len(ranked)) - 1]) if len(ranked) else math.inf
        return values
