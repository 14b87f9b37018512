"""False alarms: the crowd's robots drive for hours and nothing touches them.

A run lasts `RUN_S`: starts, stops, straight lines, circles and turns on the spot, all headings, slow and quick; what is
drawn stands in `DRAWN`. `SHARED` robots drive the same plan, each with its own numbers, noise and encoders. Every
detection is a false alarm.
"""

from __future__ import annotations

import functools
import hashlib
import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from giveway import batch
from giveway.base.errors import UnknownNameError
from giveway.crowd.drive import Drive, Leg, fastest, tare_s
from giveway.crowd.parts import Interrupted, Record, Work
from giveway.crowd.population import DRAWS, GROUPS, Robot, controller_of, robot_of
from giveway.crowd.statistics import rate_upper_bound
from giveway.robot.variables import Value
from giveway.scenario.scenario import Scenario

__all__ = ["DRAWN", "HOURS", "RUN_S", "compute", "drive", "endurance", "rates"]

RUN_S = 30.0
SHARED = 8
PART = 512  # 150 MB of plans
HOURS: Mapping[str, float] = MappingProxyType({"planar": 300.0, "tipping": 20.0, "single rollers": 20.0})
"""Decided before the first look; `share` scales them."""

DRAWN: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "heading, rad": (-math.pi, math.pi),
        "standing before a leg, s": (0.1, 1.2),
        "speed, m/s": (0.05, 0.4),
        "acceleration, m/s2, logarithmic": (0.05, 1.0),
        "full speed, s": (0.3, 5.0),
        "diameter of a circle, m": (0.8, 3.0),
        "yaw rate on the spot, rad/s": (0.2, 1.2),
        "yaw acceleration on the spot, rad/s2": (0.5, 4.0),
    }
)
STRAIGHT, ROUND, TURNING, ON_THE_SPOT = range(4)  # kinds of legs
SHARES = (0.35, 0.25, 0.25, 0.15)
LONGEST_RAMP_S = 4.0


def endurance(
    draw: str,
    group: str,
    hours: float,
    controller: Mapping[str, Value],
    imu: bool = False,
    robot: Path | None = None,
) -> Work:
    """The work of ``hours`` of free motion of robots of ``group``.

    ``imu``: each with an IMU; ``robot``: the robot file that they differ from, None: Trikey's.
    """
    if draw not in DRAWS:
        raise UnknownNameError("draw", draw, DRAWS)
    if group not in GROUPS:
        raise UnknownNameError("group", group, GROUPS)
    asked = {"draw": draw, "seed": DRAWS[draw], "group": group, "imu": imu, "controller": dict(controller)}
    if robot is not None:
        asked["robot"] = {"file": robot.name, "sha256": hashlib.sha256(robot.read_bytes()).hexdigest()}
    count = math.ceil(hours * 3600.0 / RUN_S)
    part = PART if group != "tipping" else PART // 8
    code = ("population.py", "../robot/population.py", "drive.py", "endurance.py", "parts.py")
    run = functools.partial(compute, draw, group, controller, imu=imu, robot=robot)
    return Work(f"endurance, {group}", asked, count, part, run, code)


def compute(
    draw: str,
    group: str,
    controller: Mapping[str, Value],
    numbers: Sequence[int],
    threads: int,
    progress: Callable[[int], None],
    imu: bool = False,
    robot: Path | None = None,
) -> list[Record]:
    """Records of the runs ``numbers``."""
    plans = {number // SHARED: _plan(draw, number // SHARED, robot) for number in numbers}
    scenarios = [_driven(draw, group, number, plans[number // SHARED], controller, imu, robot)[1] for number in numbers]
    method = "event-exact" if group == "tipping" else "fixed-step"
    table = batch.Prepared(scenarios).run(threads=threads, method=method, progress=lambda done, _of: progress(done))
    if table.attrs["interrupted"]:
        raise Interrupted
    columns = {name: table[name].values for name in ("status", "message", "method", "simulated", "detections")}
    return [
        {
            "number": number,
            "status": str(columns["status"][index]),
            "message": str(columns["message"][index]),
            "method": str(columns["method"][index]),
            "simulated_s": float(columns["simulated"][index]),
            "detections": None if math.isnan(columns["detections"][index]) else int(columns["detections"][index]),
        }
        for index, number in enumerate(numbers)
    ]


def drive(
    draw: str, group: str, number: int, controller: Mapping[str, Value], imu: bool = False, robot: Path | None = None
) -> tuple[Robot, Scenario]:
    """Run ``number``: its robot, and its whole input."""
    return _driven(draw, group, number, _plan(draw, number // SHARED, robot), controller, imu, robot)


def _driven(
    draw: str, group: str, number: int, plan: Drive, controller: Mapping[str, Value], imu: bool, robot: Path | None
) -> tuple[Robot, Scenario]:
    whose = robot_of(draw, number, group, imu, robot)
    seed = int(np.random.default_rng((DRAWS[draw], 3, number)).integers(2**31))
    own: dict[str, Value] = {
        **whose.testbed,
        "slider.present": False,
        "rope.attached": False,
        "start.theta": plan.theta_rad,
    }
    known = controller_of(whose, controller)
    scenario = Scenario(
        f"endurance {number}", RUN_S, bumper="none", testbed=own, controller=known, plan=plan, seed=seed, robot=robot
    )
    return whose, scenario


def _plan(draw: str, number: int, robot: Path | None) -> Drive:
    """Legs until the run is over."""
    rng = np.random.default_rng((DRAWS[draw], 2, number))

    def uniform(what: str) -> float:
        return float(rng.uniform(*DRAWN[what]))

    heading = uniform("heading, rad")
    legs: list[Leg] = []
    at_s = 0.0
    while True:
        leg = _leg(rng, uniform, at_s, fastest(robot))
        if leg.end_s > RUN_S - tare_s():
            return Drive(tuple(legs), heading)
        legs.append(leg)
        at_s = leg.end_s


def _leg(rng: np.random.Generator, uniform: Callable[[str], float], after_s: float, fastest_mps: float) -> Leg:
    start_s = after_s + uniform("standing before a leg, s")
    kind = int(rng.choice(len(SHARES), p=SHARES))
    side = 1.0 if rng.uniform() < 0.5 else -1.0
    cruise_s = uniform("full speed, s")
    if kind == ON_THE_SPOT:
        rate, growth = uniform("yaw rate on the spot, rad/s"), uniform("yaw acceleration on the spot, rad/s2")
        return Leg(start_s, rate, growth, cruise_s, curvature_pm=side, on_the_spot=True)
    speed = min(uniform("speed, m/s"), fastest_mps)
    low, high = DRAWN["acceleration, m/s2, logarithmic"]
    acceleration = max(float(low * (high / low) ** rng.uniform()), 0.5 * math.pi * speed / LONGEST_RAMP_S)
    direction = uniform("heading, rad")
    bend = 0.0 if kind == STRAIGHT else 2.0 * side / uniform("diameter of a circle, m")
    return Leg(start_s, speed, acceleration, cruise_s, direction, bend, turning=kind == TURNING)


def rates(records: Sequence[Record]) -> dict[str, Any]:
    """Hours, false alarms, and the upper 95 % bound of their rate per hour."""
    judged = [record for record in records if record["detections"] is not None]
    hours = sum(record["simulated_s"] for record in judged) / 3600.0
    alarms = sum(record["detections"] for record in judged)
    worst = sorted(judged, key=lambda record: (-record["detections"], record["number"]))
    return {
        "hours": hours,
        "runs": len(judged),
        "failed": len(records) - len(judged),
        "false alarms": alarms,
        "runs with one": sum(record["detections"] > 0 for record in judged),
        "per hour": alarms / hours if hours else None,
        "per hour, upper 95 % bound": rate_upper_bound(alarms, hours) if hours else None,
        "worst": [[record["number"], record["detections"]] for record in worst[:10] if record["detections"]],
    }
