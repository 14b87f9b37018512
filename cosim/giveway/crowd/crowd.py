"""The crowd's runs: drawn, computed in the batch library part by part, judged."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from giveway import batch
from giveway.base.errors import UnknownNameError
from giveway.crowd.blow import Blow
from giveway.crowd.hits import PATTERN, PER_ROBOT, SITUATIONS, Hit, hit
from giveway.crowd.judged import RECORDED, Judged, Limits, judge, limits
from giveway.crowd.lifts import RECORDED as LOADS
from giveway.crowd.lifts import lifts
from giveway.crowd.parts import Interrupted, Record, Work
from giveway.crowd.population import DRAWS, GROUPS, group_of, start_value
from giveway.robot.presets import NO_REFLEX
from giveway.robot.variables import Value
from giveway.scenario.plan import Rest

__all__ = ["ROBOTS_MAX", "compute", "crowd", "limits_of", "record_of", "robot_asked"]

ROBOTS_MAX = 100_000
PART_ROBOTS = 32  # 300 MB of traces


Beliefs = Mapping[int, Mapping[str, Value]]
"""By robot: parameters of its controller that a calibration found."""

CODE = (
    "population.py",
    "../robot/population.py",
    "hits.py",
    "blow.py",
    "drive.py",
    "judged.py",
    "lifts.py",
    "crowd.py",
    "parts.py",
)


def crowd(
    draw: str,
    robots: int,
    controller: Mapping[str, Value],
    beliefs: Beliefs | None = None,
    group: str | None = None,
    imu: bool = False,
    robot: Path | None = None,
    same: Mapping[str, Value] | None = None,
    situations: Sequence[str] | None = None,
) -> Work:
    """The work of the first ``robots`` robots of ``draw``, with these parameters of the controller.

    ``beliefs``: of each robot's own; without it every controller knows its robot by the robot file alone. ``group``:
    only the robots among them that have this plant of `GROUPS`. ``imu``: the same robots, each with an IMU. ``robot``:
    the robot file that they differ from, and that their controllers believe; None: Trikey's. ``same``: as in `hit`.
    ``situations``: only hits whose situation in `PATTERN` is one of these; None: all.
    """
    for situation in situations or ():
        if situation not in SITUATIONS:
            raise UnknownNameError("--situation", situation, SITUATIONS)
    if group is not None and group not in GROUPS:
        raise UnknownNameError("group", group, GROUPS)
    asked: dict[str, Any] = {
        "draw": draw,
        "seed": DRAWS[draw],
        "group": group,
        "imu": imu,
        "controller": dict(controller),
    }
    if robot is not None:
        asked["robot"] = robot_asked(robot)
    if same:
        asked["same"] = dict(same)
    if beliefs is not None:
        asked["beliefs"] = {str(number): dict(values) for number, values in sorted(beliefs.items())}
    if situations:
        asked["situations"] = list(situations)
    places = [place for place, (situation, _) in enumerate(PATTERN) if situation in (situations or SITUATIONS)]
    chosen = [
        number * PER_ROBOT + place for number in range(robots) if group in (None, group_of(number)) for place in places
    ]

    def run(indices: Sequence[int], threads: int, progress: Callable[[int], None]) -> list[Record]:
        numbers = [chosen[index] for index in indices]
        return compute(draw, controller, numbers, threads, progress, beliefs, imu, robot, same)

    name = (
        f"crowd, {draw} draw"
        + ("" if robot is None else f", {robot.stem}")
        + ("" if beliefs is None else ", calibrated")
        + (", IMU" if imu else "")
    )
    return Work(name, asked, len(chosen), PART_ROBOTS * PER_ROBOT, run, CODE)


def robot_asked(robot: Path) -> dict[str, str]:
    """What stands for a robot file in the settings of a `Work`."""
    return {"file": robot.name, "sha256": hashlib.sha256(robot.read_bytes()).hexdigest()}


def compute(
    draw: str,
    controller: Mapping[str, Value],
    numbers: Sequence[int],
    threads: int,
    progress: Callable[[int], None],
    beliefs: Beliefs | None = None,
    imu: bool = False,
    robot: Path | None = None,
    same: Mapping[str, Value] | None = None,
) -> list[Record]:
    """Records of the hits ``numbers``: each has the same bits alone and among others."""
    own = beliefs or {}
    hits = [
        hit(draw, number, {**own.get(number // PER_ROBOT, {}), **controller}, imu=imu, file=robot, same=same)
        for number in numbers
    ]
    records: dict[int, Record] = {}
    for alike in _alike(hits):
        can_tip = alike[0].robot.group == "tipping"
        said = functools.partial(_say, progress, len(records))
        ran = _run(alike, (*RECORDED, *LOADS) if can_tip else RECORDED, threads, said)
        if can_tip:
            blocked = _run([_blocked(one) for one in alike], (*RECORDED, *LOADS), threads, lambda _done, _of: None)
            for one, other in zip(ran, blocked, strict=True):
                one.judge_lifts(other)
        records |= {one.hit.number: one.record() for one in ran}
    return [records[number] for number in numbers]


class _Ran:
    """A run of the batch library, judged; a robot that goes over ends its run: what was until then counts."""

    def __init__(self, one: Hit, table: Any, index: int, traces: Mapping[str, Any]) -> None:
        self.hit = one
        self.status, self.message, self.method = (
            str(table[name].values[index]) for name in ("status", "message", "method")
        )
        self.simulated_s = float(table["simulated"].values[index])
        rows = round(self.simulated_s / one.scenario.step_s) + 1
        self.time_s = table["time"].values[:rows]
        self.traces = {name: values[index, :rows] for name, values in traces.items()}
        self.judged: Judged | None = None
        if self.status in ("ok", "failed") and rows > 1:
            self.judged = judge(self.time_s, self.traces, limits_of(one))
        self.lifts: Any = None

    def judge_lifts(self, blocked: _Ran) -> None:
        if self.judged is not None and blocked.judged is not None:
            self.lifts = lifts(self.hit.scenario.step_s, self.traces, self.judged, blocked.traces, blocked.judged)

    def record(self) -> Record:
        return {
            **record_of(self.hit, (self.status, self.message), self.method, self.simulated_s, self.judged),
            "lifts": self.lifts,
        }


def _run(hits: Sequence[Hit], recorded: tuple[str, ...], threads: int, said: Callable[[int, int], None]) -> list[_Ran]:
    """Hits of one duration and plant."""
    method = "event-exact" if hits[0].robot.group == "tipping" else "fixed-step"
    table = batch.Prepared([one.scenario for one in hits], traces=recorded).run(
        threads=threads, method=method, progress=said
    )
    if table.attrs["interrupted"]:
        raise Interrupted
    traces = {name: table[name].values for name in recorded}
    return [_Ran(one, table, index, traces) for index, one in enumerate(hits)]


def _blocked(one: Hit) -> Hit:
    """The same without a reaction."""
    controller = {**one.scenario.controller, **NO_REFLEX}
    return dataclasses.replace(one, scenario=dataclasses.replace(one.scenario, controller=controller))


def _say(progress: Callable[[int], None], before: int, done: int, _of: int) -> None:
    progress(before + done)


def _alike(hits: Sequence[Hit]) -> list[list[Hit]]:
    """Hits of one duration and method, those that can be computed side by side next to each other."""
    groups: dict[tuple[float, bool], list[Hit]] = {}
    for one in hits:
        groups.setdefault((one.scenario.duration_s, one.robot.group == "tipping"), []).append(one)
    for group in groups.values():
        group.sort(key=lambda one: (one.bumper, one.kind, one.number))
    return list(groups.values())


def limits_of(one: Hit) -> Limits:
    """What `judge` needs to know of a hit."""
    file = one.robot.file
    return limits(one.scenario.controller, start_value("wheel.distance", robot=file), one.kind == "moment", file)


def record_of(one: Hit, status: tuple[str, str], method: str, simulated_s: float, judged: Judged | None) -> Record:
    """What is kept of a run."""
    return {
        "number": one.number,
        "robot": one.robot.number,
        "group": one.robot.table,
        "situation": one.situation,
        "kind": one.kind,
        "bumper": one.bumper,
        "speed_mps": one.speed_mps,
        "mass_kg": one.mass_kg,
        "stated": one.stated,
        "moving": not isinstance(one.scenario.plan, Rest),
        "second_s": one.scenario.push.start_s if isinstance(one.scenario.push, Blow) else None,
        "simulated_s": simulated_s,
        "status": status[0],
        "message": status[1],
        "method": method,
        "judged": None if judged is None else judged.record(),
    }
