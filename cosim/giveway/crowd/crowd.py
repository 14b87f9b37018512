"""The crowd's runs: drawn, computed in the batch library part by part, judged."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from giveway import batch
from giveway.base.errors import UnknownNameError
from giveway.crowd.blow import Blow
from giveway.crowd.hits import PER_ROBOT, Hit, hit
from giveway.crowd.judged import RECORDED, Judged, Limits, judge
from giveway.crowd.parts import Interrupted, Record, Work
from giveway.crowd.population import DRAWS, GROUPS, group_of, start_value
from giveway.robot.variables import Value
from giveway.scenario.plan import Rest

__all__ = ["ROBOTS_MAX", "compute", "crowd", "limits_of", "record_of"]

ROBOTS_MAX = 100_000
PART_ROBOTS = 32  # 300 MB of traces


Beliefs = Mapping[int, Mapping[str, Value]]
"""By robot: parameters of its controller that a calibration found."""

CODE = ("population.py", "hits.py", "blow.py", "drive.py", "judged.py", "crowd.py", "parts.py")


def crowd(
    draw: str,
    robots: int,
    controller: Mapping[str, Value],
    beliefs: Beliefs | None = None,
    group: str | None = None,
) -> Work:
    """The work of the first ``robots`` robots of ``draw``, with these parameters of the controller.

    ``beliefs``: of each robot's own; without it every controller knows its robot by the robot file alone. ``group``:
    only the robots among them that have this plant of `GROUPS`.
    """
    if group is not None and group not in GROUPS:
        raise UnknownNameError("group", group, GROUPS)
    asked: dict[str, Any] = {"draw": draw, "seed": DRAWS[draw], "group": group, "controller": dict(controller)}
    if beliefs is not None:
        asked["beliefs"] = {str(number): dict(values) for number, values in sorted(beliefs.items())}
    chosen = [number for number in range(robots) if group in (None, group_of(number))]

    def run(indices: Sequence[int], threads: int, progress: Callable[[int], None]) -> list[Record]:
        numbers = [chosen[index // PER_ROBOT] * PER_ROBOT + index % PER_ROBOT for index in indices]
        return compute(draw, controller, numbers, threads, progress, beliefs)

    name = f"crowd, {draw} draw" + ("" if beliefs is None else ", calibrated")
    return Work(name, asked, len(chosen) * PER_ROBOT, PART_ROBOTS * PER_ROBOT, run, CODE)


def compute(
    draw: str,
    controller: Mapping[str, Value],
    numbers: Sequence[int],
    threads: int,
    progress: Callable[[int], None],
    beliefs: Beliefs | None = None,
) -> list[Record]:
    """Records of the hits ``numbers``: each has the same bits alone and among others."""
    own = beliefs or {}
    hits = [hit(draw, number, {**own.get(number // PER_ROBOT, {}), **controller}) for number in numbers]
    records: dict[int, Record] = {}
    for one_kind in _alike(hits):
        method = "event-exact" if one_kind[0].robot.group == "tipping" else "fixed-step"
        prepared = batch.Prepared([one.scenario for one in one_kind], traces=RECORDED)
        said = functools.partial(_say, progress, len(records))
        table = prepared.run(threads=threads, method=method, progress=said)
        if table.attrs["interrupted"]:
            raise Interrupted
        time_s = table["time"].values
        traces = {name: table[name].values for name in RECORDED}
        for index, one in enumerate(one_kind):
            status = (str(table["status"].values[index]), str(table["message"].values[index]))
            # A robot that goes over ends its run: what was until then counts.
            rows = round(float(table["simulated"].values[index]) / one.scenario.step_s) + 1
            judged = None
            if status[0] in ("ok", "failed") and rows > 1:
                mine = {name: values[index, :rows] for name, values in traces.items()}
                judged = judge(time_s[:rows], mine, limits_of(one))
            method_used, simulated_s = str(table["method"].values[index]), float(table["simulated"].values[index])
            records[one.number] = record_of(one, status, method_used, simulated_s, judged)
    return [records[number] for number in numbers]


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
    name = "admittance.acceleration_limit"
    limit = one.scenario.controller.get(name, start_value(name, "controller"))
    return Limits(float(limit), start_value("wheel.distance"), one.kind == "moment")


def record_of(one: Hit, status: tuple[str, str], method: str, simulated_s: float, judged: Judged | None) -> Record:
    """What is kept of a run."""
    return {
        "number": one.number,
        "robot": one.robot.number,
        "group": one.robot.group,
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
