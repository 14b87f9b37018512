"""`giveway bench --tune`: thresholds tuned on logs of robots of the crowd, and judged on fresh logs of the same.

Each robot differs from the robot file, which is all that the tuning knows of it. It drives as in `giveway crowd
endurance`, and the controller does not react, as the log would end there. The fresh logs have other plans and noise.
Then come the robot's hits in the crowd, with the tuned thresholds and with those of the start values.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from giveway import batch
from giveway.base.checks import finite
from giveway.base.errors import GivewayError, SimulationError
from giveway.crowd import endurance
from giveway.crowd.crowd import compute
from giveway.crowd.hits import PER_ROBOT
from giveway.crowd.parts import Record
from giveway.crowd.population import DRAWS, GROUPS, group_of, robot_of
from giveway.crowd.statistics import count_interval, rate_interval
from giveway.crowd.table import ROWS, find, read
from giveway.robot.presets import NO_REFLEX
from giveway.robot.variables import Value, table
from giveway.robot.wheels import WHEELS
from giveway.scenario.plan import PLAN_INPUTS
from giveway.scenario.scenario import Scenario
from giveway.tuning.logs import Log
from giveway.tuning.thresholds import alarms_in, choose
from giveway.tuning.tuned import check_hours, check_rate

__all__ = ["HEADER", "ROBOTS_MAX", "Judged", "hits_of", "judge", "logs_of", "rows"]

TRACES = (
    *(f"testbed.sensor.{what}[{wheel}]" for what in ("torque", "encoder") for wheel in range(WHEELS)),
    *(f"controller.{name}" for name in PLAN_INPUTS),
)
HEADER = ("", "found")
PLANT, ALL_HITS = GROUPS[0], ROWS[0]
MINUTES = (1.0, 60.0)  # of logs
FRESH_PLANS = 1_000_000  # plans of fresh logs are numbered from here
ROBOTS_MAX = 5000  # with the longest logs their plans do not reach the fresh ones


@dataclass(frozen=True)
class Judged:
    """Of one robot.

    Attributes:
        number: in its draw.
        hours: of the logs that it was tuned on.
        upper_per_hour: what the tuning promises.
        fewest, most: alarms in the fresh hours, as the tuning foretells them with 95 %.
        alarms, fresh_hours: found in the fresh logs.
        hits, hits_before: records of the crowd with the tuned thresholds, and with the start values; empty: not tuned.
        refused: why it was not tuned; "" if it was.
    """

    number: int
    hours: float
    upper_per_hour: float = 0.0
    fewest: int = 0
    most: int = 0
    alarms: int = 0
    fresh_hours: float = 0.0
    hits: Sequence[Record] = ()
    hits_before: Sequence[Record] = ()
    refused: str = ""

    @property
    def holds(self) -> bool:
        """The fresh logs have as many alarms as foretold."""
        return not self.refused and self.fewest <= self.alarms <= self.most

    @property
    def kept(self) -> bool:
        """The alarms do not contradict the promise: as many or more of them would not be rarer than 5 %."""
        return not self.refused and rate_interval(self.alarms, self.fresh_hours)[1] <= self.upper_per_hour


def judge(
    draw: str,
    robots: int,
    minutes: float,
    rate_per_hour: float,
    threads: int,
    progress: Callable[[int], None] = lambda done: None,
) -> list[Judged]:
    """Tune the first ``robots`` planar robots of ``draw`` on ``minutes`` of logs each, and judge on as many.

    Raises:
        GivewayError: ``minutes`` or ``rate_per_hour`` is out of range, or so short logs do not support this rate.
    """
    finite("--minutes", minutes, *MINUTES, "min")
    check_rate(rate_per_hour)
    check_hours(minutes / 60.0, rate_per_hour)
    found: list[Judged] = []
    for number in itertools.islice((one for one in itertools.count() if group_of(one) == PLANT), robots):
        tuned_on = logs_of(draw, number, minutes, 0, threads)
        fresh = logs_of(draw, number, minutes, FRESH_PLANS, threads)
        found.append(_judged(draw, number, tuned_on, fresh, rate_per_hour, threads))
        progress(len(found))
    return found


def _judged(
    draw: str, number: int, tuned_on: Sequence[Log], fresh: Sequence[Log], rate_per_hour: float, threads: int
) -> Judged:
    hours = sum(log.duration_s for log in tuned_on) / 3600.0
    try:
        chosen = choose(tuned_on, {}, rate_per_hour)
    except GivewayError as error:
        return Judged(number, hours, refused=str(error))
    alarms, looked_h = alarms_in(fresh, dict(chosen.thresholds))
    fewest, most = chosen.tail.counts(1.0, looked_h)
    hits, hits_before = (hits_of(draw, number, thresholds, threads) for thresholds in (chosen.thresholds, {}))
    return Judged(number, hours, chosen.upper_per_hour, fewest, most, alarms, looked_h, hits, hits_before)


def hits_of(draw: str, number: int, thresholds: Mapping[str, Value], threads: int) -> list[Record]:
    """Records of the crowd's hits of robot ``number`` with these thresholds."""
    numbers = range(number * PER_ROBOT, (number + 1) * PER_ROBOT)
    return compute(draw, thresholds, numbers, threads, lambda done: None)


def logs_of(draw: str, number: int, minutes: float, plans: int, threads: int) -> list[Log]:
    """``minutes`` of logs of planar robot ``number``, on the endurance's plans from ``plans`` on."""
    whose = robot_of(draw, number, PLANT)
    count = max(1, round(60.0 * minutes / endurance.RUN_S))
    scenarios = []
    for index in range(count):
        plan = plans + number * count + index
        _, driven = endurance.drive(draw, PLANT, plan * endurance.SHARED, {})
        own = {**whose.testbed, "slider.present": False, "rope.attached": False}
        own["start.theta"] = driven.testbed["start.theta"]
        seed = int(np.random.default_rng((DRAWS[draw], 5, plan)).integers(2**31))
        scenarios.append(
            Scenario(f"robot {number}, {index}", endurance.RUN_S, bumper="none", testbed=own, controller=NO_REFLEX,
                     plan=driven.plan, seed=seed)
        )  # fmt: skip
    runs = batch.Prepared(scenarios, traces=TRACES).run(threads=threads, method="fixed-step")
    if runs.attrs["interrupted"]:
        raise KeyboardInterrupt
    for status, message, one in zip(runs["status"].values, runs["message"].values, scenarios, strict=True):
        if status != "ok":
            raise SimulationError("batch library", f"{one.name}: {message}", one.duration_s)
    columns = {name: runs[name].values for name in TRACES}
    return [
        _log(one.name, one.step_s, {name: values[index] for name, values in columns.items()})
        for index, one in enumerate(scenarios)
    ]


def _log(name: str, step_s: float, columns: dict[str, np.ndarray]) -> Log:
    inputs = {trace.partition(".")[2]: values for trace, values in columns.items()}
    steps = len(inputs["sensor.torque[0]"])
    inputs["sensor.counter"] = np.arange(steps, dtype=np.int32)
    inputs["sensor.present"] = np.ones(steps, dtype=np.bool_)
    counts = np.stack([inputs[f"sensor.encoder[{wheel}]"] for wheel in range(WHEELS)], axis=1)
    torque = np.stack([inputs[f"sensor.torque[{wheel}]"] for wheel in range(WHEELS)], axis=1)
    turn = float(table("controller")["estimator.encoder_counts"].start or 1.0)
    return Log(name, step_s, inputs, counts * (2.0 * np.pi / turn), torque)


def rows(found: Sequence[Judged], rate_per_hour: float) -> list[tuple[str, str]]:
    """The result as a table."""
    tuned = [one for one in found if not one.refused]
    held, kept = sum(one.holds for one in tuned), sum(one.kept for one in tuned)
    alarms, hours = sum(one.alarms for one in tuned), sum(one.fresh_hours for one in tuned)
    rate, low, high = rate_interval(alarms, hours) if hours else (0.0, 0.0, 0.0)
    share = [100.0 * end for end in count_interval(held, len(tuned))] if tuned else [0.0, 100.0]
    after, before = (
        find(ALL_HITS, read(list(itertools.chain.from_iterable(of_robots))))
        for of_robots in ((one.hits for one in tuned), (one.hits_before for one in tuned))
    )
    return [
        ("robots", f"{len(found)}, {len(found) - len(tuned)} of them refused"),
        ("logs of each, min", f"{60.0 * found[0].hours:.3g}, and as many fresh ones"),
        ("wished false alarms per hour, at most", f"{rate_per_hour:g}"),
        ("95 % intervals of the alarms in the fresh logs that hold", f"{held} of {len(tuned)}"),
        ("their share, with its interval, %", f"{share[0]:.0f} to {share[1]:.0f}"),
        ("upper bounds that the fresh logs do not contradict", f"{kept} of {len(tuned)}"),
        ("alarms in fresh logs", f"{alarms} in {hours:.3g} h"),
        ("per hour, with its 95 % interval", f"{rate:.3g}, {low:.3g} to {high:.3g}"),
        ("hits missed, tuned", f"{after.missed} of {after.hits}"),
        ("the same with the start values", f"{before.missed} of {before.hits}"),
        ("runs with a reaction without contact, tuned", f"{after.runs_with_false} of {after.runs}"),
        ("the same with the start values", f"{before.runs_with_false} of {before.runs}"),
        ("reactions towards what hit, tuned", f"{after.towards}"),
        ("the same with the start values", f"{before.towards}"),
    ]
