"""False alarms of the same robots: they drive for hours and nothing touches them.

The drives are those of `giveway crowd endurance`, slower where the robot file's limits ask for it. After an alarm a
robot gives way, and its next alarm depends on the first; so a drive counts until its first one.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from giveway import batch
from giveway.base.errors import SimulationError
from giveway.crowd import endurance
from giveway.crowd.drive import Drive as Legs
from giveway.crowd.statistics import rate_interval
from giveway.detectability.robots import Subject
from giveway.detectability.search import Interrupted
from giveway.robot.variables import Value
from giveway.scenario.plan_limits import limits_of
from giveway.scenario.scenario import Scenario

__all__ = ["DETECTIONS", "Alarms", "alarms"]

DETECTIONS = "controller.detection.count"
PART = 64  # drives whose traces are in memory at once
SPEED_MPS, ACCELERATION_MPS2, YAW_RADPS, YAW_ACCELERATION_RADPS2 = 0.4, 1.0, 1.2, 4.0  # the quickest of the drives
SHARE = 0.9  # of the reference's limits


@dataclass(frozen=True)
class Alarms:
    """Alarms of drives that nothing touched.

    Attributes:
        hours: driven until each drive's first alarm.
        drives: in all.
        alarms: drives with one.
    """

    hours: float
    drives: int
    alarms: int

    @property
    def per_hour(self) -> tuple[float, float, float]:
        """The rate with its exact 95 % interval."""
        return rate_interval(self.alarms, self.hours)


def alarms(
    whose: Subject,
    robots: Sequence[Mapping[str, Value]],
    hours: float,
    controller: Mapping[str, Value],
    threads: int,
    progress: Callable[[float], None] = lambda share: None,
    wished_per_hour: float | None = None,
) -> Alarms:
    """Let ``robots`` drive for ``hours`` in all, one after the other, each on the next plan.

    ``wished_per_hour``: it ends as soon as the rate is certainly higher than this.
    """
    count = math.ceil(hours * 3600.0 / endurance.RUN_S)
    driven_s, first = 0.0, 0
    for begin in range(0, count, PART):
        part = [_drive(whose, robots, number, controller) for number in range(begin, min(begin + PART, count))]
        table = batch.Prepared(part, traces=(DETECTIONS,)).run(threads=threads, method="fixed-step")
        if table.attrs["interrupted"]:
            raise Interrupted
        for index, one in enumerate(part):
            if (status := str(table["status"].values[index])) != "ok":
                message = f"{one.name}: {status}: {table['message'].values[index]}"
                raise SimulationError("batch library", message, float(table["simulated"].values[index]))
        found = table[DETECTIONS].values > 0
        driven_s += float(np.where(found.any(axis=1), found.argmax(axis=1), found.shape[1] - 1).sum()) * part[0].step_s
        first += int(found.any(axis=1).sum())
        done = min(begin + PART, count)
        so_far = Alarms(driven_s / 3600.0, done, first)
        progress(done / count)
        if wished_per_hour is not None and so_far.per_hour[1] > wished_per_hour:
            break
    return so_far


def _drive(
    whose: Subject, robots: Sequence[Mapping[str, Value]], number: int, controller: Mapping[str, Value]
) -> Scenario:
    plan = endurance.drive("tuning", "planar", number, {})[1].plan
    assert isinstance(plan, Legs)
    slower = _slower(whose)
    legs = [
        dataclasses.replace(
            leg,
            speed_mps=slower[leg.on_the_spot] * leg.speed_mps,
            acceleration_mps2=slower[leg.on_the_spot] * leg.acceleration_mps2,
        )
        for leg in plan.legs
    ]
    own = {"slider.present": False, "rope.attached": False, "start.theta": plan.theta_rad}
    return Scenario(
        f"drive {number}",
        endurance.RUN_S,
        bumper="none",
        testbed={**whose.changed["testbed"], **robots[number % len(robots)], **own},
        controller={**whose.changed["controller"], **controller},
        plan=dataclasses.replace(plan, legs=tuple(legs)),
        seed=1 + number,
    )


def _slower(whose: Subject) -> tuple[float, float]:
    """Factors on legs along a path, and on the spot, that keep them within the reference's limits."""
    limits = limits_of(dict(whose.controller))
    along = min(limits.speed_mps / SPEED_MPS, limits.acceleration_mps2 / ACCELERATION_MPS2)
    around = min(limits.yaw_rate_radps / YAW_RADPS, limits.yaw_acceleration_radps2 / YAW_ACCELERATION_RADPS2)
    return min(1.0, SHARE * along), min(1.0, SHARE * around)
