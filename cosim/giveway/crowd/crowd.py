"""The crowd's runs: drawn, computed in the batch library part by part, judged."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence

from giveway import batch
from giveway.crowd.blow import Blow
from giveway.crowd.hits import PER_ROBOT, Hit, hit
from giveway.crowd.judged import RECORDED, Judged, Limits, judge
from giveway.crowd.parts import Interrupted, Record, Work
from giveway.crowd.population import DRAWS, start_value
from giveway.robot.variables import Value
from giveway.scenario.plan import Rest

__all__ = ["ROBOTS_MAX", "compute", "crowd", "limits_of", "record_of"]

ROBOTS_MAX = 100_000
PART_ROBOTS = 32  # 300 MB of traces


def crowd(draw: str, robots: int, controller: Mapping[str, Value]) -> Work:
    """The work of the first ``robots`` robots of ``draw``, with these parameters of the controller."""
    asked = {"draw": draw, "seed": DRAWS[draw], "controller": dict(controller)}
    run = functools.partial(compute, draw, controller)
    return Work(f"crowd, {draw} draw", asked, robots * PER_ROBOT, PART_ROBOTS * PER_ROBOT, run)


def compute(
    draw: str,
    controller: Mapping[str, Value],
    numbers: Sequence[int],
    threads: int,
    progress: Callable[[int], None],
) -> list[Record]:
    """Records of the hits ``numbers``: each has the same bits alone and among others."""
    hits = [hit(draw, number, controller) for number in numbers]
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
            mine = {name: values[index] for name, values in traces.items()}
            status = (str(table["status"].values[index]), str(table["message"].values[index]))
            judged = judge(time_s, mine, limits_of(one)) if status[0] == "ok" else None
            records[one.number] = record_of(one, status, str(table["method"].values[index]), judged)
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


def record_of(one: Hit, status: tuple[str, str], method: str, judged: Judged | None) -> Record:
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
        "simulated_s": one.scenario.duration_s,
        "status": status[0],
        "message": status[1],
        "method": method,
        "judged": None if judged is None else judged.record(),
    }
