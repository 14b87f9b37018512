"""The runs behind the curves, in parts that are stored: `hits_work` and `quiet_work`, and what is kept of each run."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from giveway.crowd.crowd import limits_of, robot_asked
from giveway.crowd.curves.alarms import LOCKED, alarms, delay_ms
from giveway.crowd.curves.candidates import (
    CANDIDATES,
    RESIDUAL,
    Model,
    Residual,
    learn,
    scaled,
    statistics,
)
from giveway.crowd.curves.recorded import RESIDUAL_TRACES, Recording, record
from giveway.crowd.curves.situations import SITUATIONS
from giveway.crowd.endurance import RUN_S, drive
from giveway.crowd.hits import PATTERN, PER_ROBOT, hit
from giveway.crowd.judged import PATIENCE_S, RECORDED, judge
from giveway.crowd.parts import Record, Work
from giveway.crowd.population import DRAWS, group_of

if TYPE_CHECKING:
    from pathlib import Path

    from giveway.robot.variables import Value
    from giveway.scenario.scenario import Scenario

__all__ = ["hits_work", "quiet_work"]

HIT_ROBOTS, QUIET_RUNS = 16, 32  # of a part: 150 and 100 MB of traces
LEARNED_FROM, LEARNED_RUNS = 1_000_000, 16  # quiet runs from which noise is learned, with plans and robots of their own
SHARED = 8  # neighbours in number have one plan
STATISTIC, COUNT = "controller.detection.statistic", "controller.detection.count"

HIT_KINDS = tuple(
    place
    for place, (situation, kind) in enumerate(PATTERN)
    if situation in ("rest", "motion", "starting", "stopping") and kind in ("free", "pulled", "clamped")
)
"""Places in `PATTERN` of the hits that are counted."""

CODE = (
    *("population.py", "../robot/population.py", "hits.py", "drive.py", "judged.py", "endurance.py", "parts.py"),
    *(
        f"curves/{name}.py"
        for name in (
            *("alarms", "candidates", "cusum", "glr", "kalman", "matched_filter", "noise", "recorded", "situations"),
            "work",
        )
    ),
)

Numbers = NDArray[np.float64]
Rows = NDArray[np.intp]
THRESHOLDS = {one.name: one.thresholds for one in CANDIDATES}

ScenarioOf = Callable[[int, Mapping[str, "Value"]], "Scenario"]
"""The scenario of a number with these parameters of the controller."""


def hits_work(draw: str, group: str, robots: int, controller: Mapping[str, Value], robot: Path | None = None) -> Work:
    """Hits of those among the first ``robots`` robots of ``draw`` that have the plant ``group``.

    ``robot``: the robot file that they differ from, and that their controllers believe; None: Trikey's.
    """
    chosen = [
        number * PER_ROBOT + place for number in range(robots) if group_of(number) == group for place in HIT_KINDS
    ]

    def run(indices: Sequence[int], threads: int, progress: Callable[[int], None]) -> list[Record]:
        return _hits(draw, group, controller, robot, [chosen[index] for index in indices], threads, progress)

    part = HIT_ROBOTS * len(HIT_KINDS)
    return Work(_name("hits", group, robot), _asked(draw, group, controller, robot), len(chosen), part, run, CODE)


def quiet_work(draw: str, group: str, hours: float, controller: Mapping[str, Value], robot: Path | None = None) -> Work:
    """``hours`` of free motion, as in `giveway crowd endurance`."""
    count = math.ceil(hours * 3600.0 / RUN_S)
    run = functools.partial(_quiet, draw, group, controller, robot)
    asked = _asked(draw, group, controller, robot)
    return Work(_name("free motion", group, robot), asked, count, QUIET_RUNS, run, CODE)


def _name(what: str, group: str, robot: Path | None) -> str:
    return f"curves, {what}, {group}" + ("" if robot is None else f", {robot.stem}")


def _asked(draw: str, group: str, controller: Mapping[str, Value], robot: Path | None) -> dict[str, object]:
    asked = {"draw": draw, "seed": DRAWS[draw], "group": group, "controller": dict(controller)}
    return asked if robot is None else {**asked, "robot": robot_asked(robot)}


class _Runs:
    """One set of runs with the controllers that the candidates need, one after the other."""

    def __init__(
        self,
        of: ScenarioOf,
        numbers: Sequence[int],
        group: str,
        threads: int,
        progress: Callable[[int], None],
        robot: Path | None,
    ) -> None:
        self._of, self._numbers, self._threads, self._progress = of, numbers, threads, progress
        self._robot = robot
        self._method = "event-exact" if group == "tipping" else "fixed-step"
        self._recorded = 0
        with_settings = [one for one in CANDIDATES if one.settings is not None]
        self._recordings = 1 + sum(len(one.thresholds) if one.scaled else 1 for one in with_settings)

    def recorded(self, controller: Mapping[str, Value], traces: Sequence[str]) -> Recording:
        scenarios = [self._of(number, controller) for number in self._numbers]
        before = self._recorded * len(scenarios)

        def say(done: int) -> None:
            self._progress((before + done) // self._recordings)

        found = record(scenarios, traces, self._method, self._threads, say, self._robot)
        self._recorded += 1
        return found


@functools.lru_cache(maxsize=4)
def _model(draw: str, group: str, threads: int, robot: Path | None) -> Model:
    """The noise of `LEARNED_RUNS` quiet runs, each with a plan of its own."""
    numbers = range(LEARNED_FROM, LEARNED_FROM + SHARED * LEARNED_RUNS, SHARED)
    runs = _Runs(
        lambda n, own: drive(draw, group, n, own, robot=robot)[1], numbers, group, threads, lambda _done: None, robot
    )
    found = runs.recorded(RESIDUAL, RESIDUAL_TRACES)
    good = [index for index in range(len(numbers)) if index not in found.failed]
    residual = found.residual()
    return learn(Residual(residual.wrench[good], residual.situations[good], residual.still[good]))


def _deaf(runs: _Runs, model: Model, recording: Recording) -> dict[str, Numbers]:
    """Statistics (runs, n) of all candidates that do not react."""
    found = statistics(model, recording.residual())
    for one in CANDIDATES:
        if one.settings is not None and not one.scaled:
            own = runs.recorded(one.settings, (STATISTIC,))
            found[one.name] = np.where(own.tracking, own.traces[STATISTIC], 0.0)
    return found


Detected = Mapping[str, list[tuple[Recording, list[Rows]]]]
"""By candidate, for each of its thresholds: the runs, and of each the rows with a detection."""


def _detected(runs: _Runs, controller: Mapping[str, Value], robot: Path | None) -> Detected:
    """Of the candidates that react; ``controller`` sets parameters of them all."""
    found: dict[str, list[tuple[Recording, list[Rows]]]] = {}
    for one in CANDIDATES:
        if one.scaled:
            found[one.name] = []
            for scale in one.thresholds:
                own = runs.recorded(scaled(one, scale, controller, robot), (COUNT,))
                counts = own.traces[COUNT]
                rows = [np.flatnonzero(np.diff(count, prepend=count[:1]) > 0) for count in counts]
                found[one.name].append((own, rows))
    return found


def _quiet(
    draw: str,
    group: str,
    controller: Mapping[str, Value],
    robot: Path | None,
    numbers: Sequence[int],
    threads: int,
    progress: Callable[[int], None],
) -> list[Record]:
    """Per run: seconds in each situation, and alarms in each by candidate and threshold."""
    runs = _Runs(lambda n, own: drive(draw, group, n, own, robot=robot)[1], numbers, group, threads, progress, robot)
    model = _model(draw, group, threads, robot)
    residual = runs.recorded(RESIDUAL, RESIDUAL_TRACES)
    deaf, reacting = _deaf(runs, model, residual), _detected(runs, controller, robot)
    failed = [residual.failed, *(own.failed for runs_of in reacting.values() for own, _ in runs_of)]
    records = []
    for index, number in enumerate(numbers):
        messages = [messages[index] for messages in failed if index in messages]
        found: Record = {"number": number, "message": messages[0] if messages else "", "simulated_s": RUN_S}
        if not messages:
            alarms_of: dict[str, list[list[int]]] = {}
            seconds_of: dict[str, list[list[float]]] = {}
            for name, statistic in deaf.items():
                rows = _rows(name, statistic[index], residual.step_s)
                alarms_of[name] = [_per_situation(residual.situations[index], one) for one in rows]
                seconds_of[name] = [_seconds(residual, index)] * len(rows)
            for name, runs_of in reacting.items():
                # What it does while it reacts or returns is not counted, neither its time.
                on_plan = [(own, rows[index][own.tracking[index][rows[index]]]) for own, rows in runs_of]
                alarms_of[name] = [_per_situation(own.situations[index], rows) for own, rows in on_plan]
                seconds_of[name] = [_seconds(own, index) for own, _ in on_plan]
            found |= {"alarms": alarms_of, "seconds": seconds_of}
        records.append(found)
    return records


def _seconds(recording: Recording, index: int) -> list[float]:
    """Time in each situation in which the controller followed the plan."""
    there = recording.situations[index][recording.tracking[index]]
    return [recording.step_s * int(count) for count in np.bincount(there, minlength=len(SITUATIONS))]


def _rows(name: str, statistic: Numbers, step_s: float) -> list[Rows]:
    """Of the alarms, for each threshold of a candidate."""
    return [alarms(statistic, threshold, step_s) for threshold in THRESHOLDS[name]]


def _per_situation(situations: NDArray[np.int8], rows: NDArray[np.intp]) -> list[int]:
    return [int(count) for count in np.bincount(situations[rows], minlength=len(SITUATIONS))]


def _hits(
    draw: str,
    group: str,
    controller: Mapping[str, Value],
    robot: Path | None,
    numbers: Sequence[int],
    threads: int,
    progress: Callable[[int], None],
) -> list[Record]:
    """Per hit: where its contact begins, and by candidate and threshold the delay; None: missed, `LOCKED`: no hit."""
    runs = _Runs(lambda n, own: hit(draw, n, own, file=robot).scenario, numbers, group, threads, progress, robot)
    model = _model(draw, group, threads, robot)
    residual = runs.recorded(RESIDUAL, (*RESIDUAL_TRACES, *RECORDED))
    deaf, reacting = _deaf(runs, model, residual), _detected(runs, controller, robot)
    records = []
    for index, number in enumerate(numbers):
        one = hit(draw, number, RESIDUAL, file=robot)
        found: Record = {
            "number": number,
            "situation": one.situation,
            "kind": one.kind,
            "bumper": one.bumper,
            "stated": one.stated and one.kind == "free",
            "simulated_s": one.scenario.duration_s,
            "message": residual.failed.get(index, ""),
            "start_s": None,
        }
        # A robot that goes over ends its run: what was until then counts.
        rows = residual.rows[index]
        if rows > 1:
            time_s = np.arange(rows, dtype=np.float64) * np.float64(residual.step_s)
            traces = {name: residual.traces[name][index, :rows] for name in RECORDED}
            hits = [
                contact for contact in judge(time_s, traces, limits_of(one)).contacts if contact.verdict == "missed"
            ]
            if hits and hits[0].passed_s is not None:
                start_s, deadline_s = hits[0].start_s, max(hits[0].end_s, hits[0].passed_s + PATIENCE_S)
                row = min(math.ceil(start_s / residual.step_s), rows - 1)
                found |= {"start_s": start_s, "deadline_s": deadline_s, "where": int(residual.situations[index, row])}
                found["delays"] = _delays(index, deaf, reacting, residual.step_s, (start_s, deadline_s))
        records.append(found)
    return records


def _delays(
    index: int, deaf: Mapping[str, Numbers], reacting: Detected, step_s: float, contact_s: tuple[float, float]
) -> dict[str, list[float | None]]:
    found: dict[str, list[float | None]] = {}
    for name, statistic in deaf.items():
        rows = _rows(name, statistic[index], step_s)
        found[name] = [_plain(delay_ms(one, step_s, *contact_s)) for one in rows]
    for name, runs_of in reacting.items():
        mine = [rows[index] for _, rows in runs_of]
        # An alarm long before the contact has led the robot elsewhere: it is another hit.
        early = [bool((rows * step_s < contact_s[0]).any()) for rows in mine]
        found[name] = [
            LOCKED if spoilt else _plain(delay_ms(rows, step_s, *contact_s))
            for rows, spoilt in zip(mine, early, strict=True)
        ]
    return found


def _plain(delay: float) -> float | None:
    return delay if math.isfinite(delay) else None
