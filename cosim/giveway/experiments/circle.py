"""The robot goes around a circle of 1.5 m at 0.16 m/s and is pushed from all sides (Kim, Llado, Sentis 2016, 5.4).

Each push is noticed; the robot escapes by 0.5 m, settles, and returns to its circle. The paper shows the path (Fig. 12)
and prints no numbers; pushes, start and return are chosen here: pushes by hand of 30 to 60 N for 0.4 to 0.8 s, a
quarter of it to rise and a quarter to fall; a start from rest at 0.1 m/s2.

The heading is constant, so every roller turns forwards, stops, and turns backwards twice a round: the hard case for a
friction model. The estimator is the full one: bristles per roller and measured acceleration. Its force is averaged over
50 ms instead of 20 ms, because at rest the noise of the measured acceleration would otherwise keep the force from
looking quiet for the 0.5 s that end a reaction. The paper's own estimator is shown for comparison, with a return as
gentle as the start: it assumes that the real acceleration is the planned one, and mistakes every jolt for a push.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from giveway.base.errors import GivewayError, UnknownNameError
from giveway.experiments import Experiment
from giveway.experiments.placement import for_this_robot, has_default_outline, outline_of_robot, testbed_of
from giveway.experiments.reproduction.findings import Effort, Findings, Picture, Row, Target
from giveway.robot.presets import DEFAULT, check_preset
from giveway.robot.presets import PAPER as PAPER_PRESET
from giveway.robot.variables import Value, table
from giveway.robot.wheels import WHEELS
from giveway.scenario.plan import Circle, Pushes, TimedPush, start_values
from giveway.scenario.scenario import Scenario

if TYPE_CHECKING:
    import numpy as np
    import xarray
    from numpy.typing import NDArray

    from giveway.simulation.push_response import Responses

DIAMETER_M, SPEED_MPS = 1.5, 0.16  # the paper's
START_MPS2 = 0.1
ROUND_S = 33.0  # a whole round takes 29.5 s, and 2.6 s more with tare and start
BUMPERS = ("none",)  # only pushes by hand

TANH, BRISTLES = 0, 1
PLANNED, MEASURED = 0, 1
ESTIMATORS: Mapping[str, Mapping[str, Value]] = {
    "full estimator": {
        "estimator.friction_model": BRISTLES,
        "estimator.acceleration_source": MEASURED,
        "estimator.average_window": 50,
    },
    "paper's estimator": {
        "estimator.friction_model": TANH,
        "estimator.acceleration_source": PLANNED,
        "reference.acceleration_limit": START_MPS2,
    },
    "paper's friction, measured acceleration": {
        "estimator.friction_model": TANH,
        "estimator.acceleration_source": MEASURED,
        "estimator.average_window": 50,
        "reference.acceleration_limit": START_MPS2,
    },
}
FULL, PAPER, BETWEEN = ESTIMATORS

# Side of the robot and m from its middle; degrees off the perpendicular; N; s.
BY_HAND = (
    (1, 0.05, 0.0, 40.0, 0.5),
    (0, -0.10, 15.0, 50.0, 0.4),
    (2, 0.0, 0.0, 30.0, 0.8),
    (1, -0.15, -15.0, 60.0, 0.4),
    (0, 0.20, 0.0, 35.0, 0.6),
    (2, 0.10, 10.0, 45.0, 0.5),
)
WITHIN = 0.8  # of a side of another robot
FIRST_PUSH_S, BETWEEN_PUSHES_S = 7.0, 18.0
LAST_LOOK_S = 24.0  # after the last push: 7 s of escape, 7 s of return, and time to catch up with the plan
RAMP_SHARE = 0.25
OBLIQUE_DEG = 45.0

PAPERS_DIRECTION_DEG = 12.0  # the largest error of a direction in 5.1
FALSE_ALARMS_PER_HOUR = 3.0
HEADINGS = 90  # runs of the false-alarm hour: one in each of as many equal sectors of the heading
UNDISTURBED_SEED = 54
DEAF_N = 15.0  # of leak in motion, for comparison: a push of 30 N is still noticed
LEAK_N = 9.0  # 20 % of three rollers' 2 x 21 N, and a margin


def scenario(
    bumper: str = "none",
    *,
    estimator: str | None = None,
    pushes: int = len(BY_HAND),
    robot: Path | None = None,
    preset: str = DEFAULT,
) -> Scenario:
    """One round with pushes by hand, one every 18 s; ``estimator`` is one of `ESTIMATORS`, which belong to the preset
    "paper" (the first if left out).

    Another ``robot`` is pushed at three of its own sides: as far from their middles, but not beyond `WITHIN` of a short
    side, and as hard, but a lighter one with the same share of its weight.
    """
    if bumper not in BUMPERS:
        raise UnknownNameError("bumper", bumper, BUMPERS)
    check_preset(preset)
    if preset == PAPER_PRESET:
        estimator = estimator or FULL
    elif estimator is not None:
        raise GivewayError("estimator", estimator, f'only beside preset = "{PAPER_PRESET}", on which they build')
    plan = Circle(DIAMETER_M, SPEED_MPS, acceleration_mps2=START_MPS2)
    with for_this_robot("circle", robot):
        outline = outline_of_robot(robot)
        schedule = tuple(
            _push(outline, plan, FIRST_PUSH_S + BETWEEN_PUSHES_S * index, *by_hand)
            for index, by_hand in enumerate(_by_hand(robot)[:pushes])
        )
    duration_s = FIRST_PUSH_S + BETWEEN_PUSHES_S * (pushes - 1) + LAST_LOOK_S
    return dataclasses.replace(_around(plan, duration_s, estimator, Pushes(schedule)), robot=robot)


def _by_hand(robot: Path | None) -> tuple[tuple[int, float, float, float, float], ...]:
    """`BY_HAND` for the sides and the weight of ``robot``."""
    if has_default_outline(robot):
        return BY_HAND
    outline = outline_of_robot(robot)
    masses = [float(testbed_of(one)["base.mass"]) for one in (robot, None)]
    lighter = min(1.0, masses[0] / masses[1])
    found = []
    for number, offset_m, turn_deg, force_n, duration_s in BY_HAND:
        side = number * len(outline) // 3
        start, end = outline[side], outline[(side + 1) % len(outline)]
        most_m = 0.5 * WITHIN * math.hypot(*(end - start))
        found.append((side, min(max(offset_m, -most_m), most_m), turn_deg, force_n * lighter, duration_s))
    return tuple(found)


def _around(plan: Circle, duration_s: float, estimator: str | None, push: Pushes | None) -> Scenario:
    """``estimator`` of the preset "paper", or None: the default preset."""
    return Scenario(
        "circle",
        duration_s,
        bumper="none",
        testbed={"slider.present": False, **start_values(plan)},
        controller={"supervisor.after_settled": 1, **({} if estimator is None else ESTIMATORS[estimator])},
        plan=plan,
        push=push,
        preset=DEFAULT if estimator is None else PAPER_PRESET,
    )


def _push(
    outline: NDArray[np.float64],
    plan: Circle,
    start_s: float,
    side: int,
    offset_m: float,
    turn_deg: float,
    force_n: float,
    duration_s: float,
) -> TimedPush:
    """A push on a side of the robot, whose heading is that of the plan."""
    from giveway.scenario.approach import edge_middle, outward_normal

    point = edge_middle(outline, side, offset_m)
    normal = outward_normal(outline, point)
    direction = math.atan2(-normal[1], -normal[0]) + plan.theta_rad + math.radians(turn_deg)
    ramp_s = RAMP_SHARE * duration_s
    return TimedPush(force_n, math.remainder(direction, 2.0 * math.pi), *point, start_s, duration_s, ramp_s)


def _random_pushes(count: int, oblique: bool, estimator: str) -> list[tuple[Scenario, TimedPush]]:
    """One push each, anywhere on the circle and on the robot's sides; the same for every estimator."""
    import numpy as np

    outline = outline_of_robot(None)
    random = np.random.default_rng(20160325)  # arbitrary; fixed, so that the rows are reproducible
    runs = []
    for seed in range(count):
        plan = Circle(DIAMETER_M, SPEED_MPS, start_rad=random.uniform(-3.0, 3.0), acceleration_mps2=START_MPS2)
        turn = random.uniform(-OBLIQUE_DEG, OBLIQUE_DEG)
        push = _push(
            outline,
            plan,
            random.uniform(5.0, 8.0),
            int(random.integers(3)),
            random.uniform(-0.2, 0.2),
            turn if oblique else 0.0,
            random.uniform(30.0, 60.0),
            random.uniform(0.4, 0.8),
        )
        around = _around(plan, 30.0, estimator, Pushes((push,)))
        runs.append((dataclasses.replace(around, seed=seed), push))
    return runs


def _respond(runs: Sequence[tuple[Scenario, TimedPush]], threads: int) -> list[Responses]:
    from giveway import batch
    from giveway.simulation.push_response import TRACES, responses

    data = batch.run_many([one for one, _ in runs], threads=threads, traces=TRACES)
    _refuse_failures(data)
    time_s = data["time"].values
    return [responses((push,), time_s, _trace_of(data, index)) for index, (_, push) in enumerate(runs)]


def _trace_of(data: xarray.Dataset, run: int | None = None) -> Callable[[str], NDArray[Any]]:
    """Traces by name, of one run of a table."""
    return lambda name: data[name].values if run is None else data[name].values[run]


def _refuse_failures(data: xarray.Dataset) -> None:
    from giveway.base.errors import SimulationError

    for run, status in enumerate(data["status"].values):
        if status != "ok":
            raise SimulationError(f"run {run}", str(data["message"].values[run]), float(data["simulated"].values[run]))


def undisturbed_runs(estimator: str, hours: float, count: int) -> list[Scenario]:
    """``count`` rounds without a push, ``hours`` together, that differ in heading, encoders and noise.

    The heading is anywhere in its own sector of 360/count deg: it is constant on the way, so this is also every
    direction in which the robot starts. Each encoder stands anywhere within a count. The same for every estimator.
    """
    import numpy as np

    random = np.random.default_rng(UNDISTURBED_SEED)
    runs = []
    for seed in range(count):
        heading = math.remainder(2.0 * math.pi * (seed + random.uniform()) / count, 2.0 * math.pi)
        phases = {f"electronics.encoder_phase[{wheel}]": float(random.uniform()) for wheel in range(WHEELS)}
        plan = Circle(DIAMETER_M, SPEED_MPS, theta_rad=heading, acceleration_mps2=START_MPS2)
        around = _around(plan, 3600.0 * hours / count, estimator, None)
        runs.append(dataclasses.replace(around, testbed={**around.testbed, **phases}, seed=seed))
    return runs


def _false_alarms(
    estimator: str, hours: float, effort: Effort, controller: Mapping[str, Value] = MappingProxyType({})
) -> NDArray[np.float64]:
    """Detections in each of the undisturbed runs."""
    import numpy as np

    from giveway import batch

    runs = [
        dataclasses.replace(one, controller={**one.controller, **controller})
        for one in undisturbed_runs(estimator, hours, effort.pick(HEADINGS, 3))
    ]
    data = batch.run_many(runs, threads=effort.threads)
    _refuse_failures(data)
    return np.asarray(data["false detections"].values)


def _alarms_otherwise(estimator: str, hours: float, effort: Effort) -> str:
    """The same hour with a detector that ignores more."""
    alarms = _false_alarms(estimator, hours, effort, {"detector.leak_motion": LEAK_N})
    return (
        f"tried on the same runs, with all else as it is: {alarms.sum():.0f} in all with detector.leak_motion "
        f"{LEAK_N:g} N"
    )


def _mismatched(
    estimator: str, shares: Sequence[float], effort: Effort, controller: Mapping[str, Value] = MappingProxyType({})
) -> xarray.Dataset:
    """An undisturbed round, with roller friction larger by ``shares`` than the estimator assumes."""
    from giveway import batch

    plan = Circle(DIAMETER_M, SPEED_MPS, acceleration_mps2=START_MPS2)
    believed = float(table("controller")["friction.coulomb_torque"].start or 0.0)
    runs = []
    for share in shares:
        around = _around(plan, effort.pick(ROUND_S, 10.0), estimator, None)
        testbed = {**around.testbed, "roller.coulomb_torque": (1.0 + share) * believed}
        runs.append(dataclasses.replace(around, testbed=testbed, controller={**around.controller, **controller}))
    traces = ["controller.detection.count", "controller.detection.statistic"]
    data = batch.run_many(runs, threads=effort.threads, traces=traces)
    _refuse_failures(data)
    return data


def reproduce(effort: Effort) -> Findings:
    """The paper's 5.4: a round with pushes, random pushes, an hour undisturbed, and rollers unlike the model."""
    from giveway.experiments.figures.circle import alarm
    from giveway.report import push_path
    from giveway.simulation.push_response import responses
    from giveway.simulation.runner import run

    of_paper = functools.partial(scenario, preset=PAPER_PRESET)
    pushes = effort.pick(len(BY_HAND), 2)
    runs = {name: run(of_paper(estimator=name, pushes=pushes), engine="native") for name in (FULL, PAPER)}
    schedule = of_paper(pushes=pushes).push
    assert isinstance(schedule, Pushes)
    found = {
        name: responses(schedule.pushes, run.traces["time"].values, _trace_of(run.traces)) for name, run in runs.items()
    }
    effort.progress(0.1)
    undisturbed = run(dataclasses.replace(of_paper(pushes=1), push=None, duration_s=ROUND_S), engine="native")
    lag_m = float(_off_path(undisturbed.traces, "testbed.truth").max())
    reference_m = float(_off_path(runs[FULL].traces, "controller.reference")[-1])
    rows = _rows_of_the_round(found, lag_m, reference_m)

    count = effort.pick(40, 4)
    cases = ((FULL, False), (FULL, True), (PAPER, False), (PAPER, True), (BETWEEN, False))
    by_full: dict[bool, list[Responses]] = {}
    for step, (name, oblique) in enumerate(cases):
        pushed = _random_pushes(count, oblique, name)
        response = _respond(pushed, effort.threads)
        tried = functools.partial(_ignoring_more, pushed, effort)
        if name == FULL:
            by_full[oblique] = response
        else:
            tried = functools.partial(_by_the_full_one, by_full[oblique])
        rows += _rows_of_random_pushes(name, oblique, response, tried)
        effort.progress(0.15 + 0.08 * step)
    hours = effort.pick(1.0, 0.01)
    for step, name in enumerate((FULL, PAPER)):
        tried = functools.partial(_alarms_otherwise, name, hours, effort)
        rows += _rows_of_false_alarms(name, _false_alarms(name, hours, effort), hours, tried)
        effort.progress(0.65 + 0.15 * step)

    shares = effort.pick(
        (-0.2, -0.15, -0.1, -0.075, -0.05, -0.025, 0.0, 0.025, 0.05, 0.075, 0.1, 0.15, 0.2), (-0.2, 0.0, 0.2)
    )
    mismatched = {name: _mismatched(name, shares, effort) for name in (FULL, PAPER)}
    rows += [row for name in mismatched for row in _rows_of_mismatch(name, shares, mismatched[name])]
    leaking = {"detector.leak_motion": LEAK_N}
    rows.append(
        Row(
            f"false alarms in a round each at friction +-20 %, detector.leak_motion {LEAK_N:g} N, {FULL}",
            float(_mismatched(FULL, (-0.2, 0.2), effort, leaking)["false detections"].values.sum()),
            "1",
            "assumed",
            decimals=0,
        )
    )
    effort.progress(1.0)
    pictures = (
        Picture(
            "path",
            "The path around the circle, pushed",
            "Motion of the base as the testbed knows it. Arrows: pushes; the robot is drawn as it stood when it felt "
            "them. It gives way along the push and comes back to where it left its path.",
            push_path.path({name: (run.traces, found[name]) for name, run in runs.items()}),
            (("circle", f"{DIAMETER_M:g} m"), ("speed", f"{SPEED_MPS:g} m/s"), ("figure", "12")),
        ),
        Picture(
            "alarm",
            "How far from a false alarm",
            "What the detector compares with its threshold (dashed) in one undisturbed round, with rollers that rub "
            "more or less than the estimator believes.",
            alarm(
                {name: (shares, data) for name, data in mismatched.items()},
                float(table("controller")["detector.impulse_threshold"].start or 0.0),
            ),
        ),
    )
    return Findings(rows, pictures, NOTES)


def _off_path(traces: xarray.Dataset, what: str) -> NDArray[Any]:
    """Distance of the base ("testbed.truth") or its reference from the plan, m, shape (n,)."""
    import numpy as np

    return np.asarray(
        np.hypot(*(traces[f"{what}.{axis}"].values - traces[f"controller.plan.{axis}"].values for axis in "xy"))
    )


def _rows_of_the_round(found: Mapping[str, Responses], lag_m: float, reference_m: float) -> list[Row]:
    full, paper = found[FULL], found[PAPER]
    count = len(full.pushes)
    angles = [abs(one.escape_error_deg) for one in full.pushes]
    felt = [abs(one.felt_error_deg) for one in full.pushes]
    late = [1e3 * (one.detected_s - one.push.start_s) for one in full.pushes if one.detected_s is not None]
    direction = Target(maximum=PAPERS_DIRECTION_DEG, text=f"at most {PAPERS_DIRECTION_DEG:g}, 5.1's largest error")
    escapes = [one.escape_m for one in full.pushes]
    rejoined = 1e3 * float(table("controller")["supervisor.rejoin_distance"].start or 0.0)
    at_path = Target(maximum=rejoined, text=f"at most {rejoined:g}, which counts as back")
    return [
        Row(f"pushes noticed, of {count}", full.detected, "1", "assumed", "each", Target(minimum=count), decimals=0),
        Row("pushes invented", len(full.invented_s), "1", "assumed", None, Target(maximum=0.0), decimals=0),
        Row(f"returns to the path, of {count}", full.returned, "1", "assumed", None, Target(minimum=count), decimals=0),
        Row("angle from push to escape, largest", max(angles), "deg", "assumed", "along the push", direction),
        Row("error of the felt direction, largest", max(felt), "deg", "assumed", None, direction),
        Row("escape distance, mean", sum(escapes) / count, "m", "given", None, decimals=3),
        Row("from the start of a push to its detection, longest", max(late, default=math.nan), "ms", "assumed", None),
        Row("distance from the plan, undisturbed, largest", 1e3 * lag_m, "mm", "assumed", None),
        Row(
            f"distance from the plan {LAST_LOOK_S:g} s after the last push",
            1e3 * full.off_path_m,
            "mm",
            "assumed",
            None,
        ),
        Row(
            "distance of the reference from the plan then",
            1e3 * reference_m,
            "mm",
            "assumed",
            None,
            at_path,
            decimals=4,
        ),
        Row(
            f"pushes noticed, of {count}, {PAPER}",
            paper.detected,
            "1",
            "assumed",
            "each",
            Target(minimum=count),
            "" if paper.detected == count else f"{full.detected} by the full estimator",
            0,
        ),
        Row(
            f"pushes invented, {PAPER}",
            len(paper.invented_s),
            "1",
            "assumed",
            None,
            Target(maximum=0.0),
            f"{len(full.invented_s)} by the full estimator" if paper.invented_s else "",
            0,
        ),
    ]


def _rows_of_random_pushes(
    estimator: str, oblique: bool, found: Sequence[Responses], tried: Callable[[], str]
) -> list[Row]:
    """What was noticed and invented; ``tried`` says how many of both with other settings, if one is missed."""
    how = f"up to {OBLIQUE_DEG:g} deg oblique" if oblique else "perpendicular"
    count, noticed, invented = len(found), *_noticed_and_invented(found)
    all_of_them, none = Target(minimum=count), Target(maximum=0.0)
    reason = "" if all_of_them.met(noticed) and none.met(invented) else tried()
    return [
        Row(
            f"random pushes noticed, of {count}, {how}, {estimator}",
            noticed,
            "1",
            "assumed",
            "each",
            all_of_them,
            "" if all_of_them.met(noticed) else reason,
            0,
        ),
        Row(
            f"invented around {count} random pushes, {how}, {estimator}",
            invented,
            "1",
            "assumed",
            None,
            none,
            "" if none.met(invented) else reason,
            0,
        ),
    ]


def _noticed_and_invented(found: Sequence[Responses]) -> tuple[int, int]:
    return sum(one.detected for one in found), sum(len(one.invented_s) for one in found)


def _ignoring_more(runs: Sequence[tuple[Scenario, TimedPush]], effort: Effort) -> str:
    """The same pushes with a detector that ignores more, for the reason of a miss."""
    deaf = {"detector.leak_motion": DEAF_N}
    varied = [(dataclasses.replace(one, controller={**one.controller, **deaf}), push) for one, push in runs]
    noticed, invented = _noticed_and_invented(_respond(varied, effort.threads))
    return (
        f"tried, with all else as it is: {noticed} noticed, {invented} invented with detector.leak_motion {DEAF_N:g} N"
    )


def _by_the_full_one(found: Sequence[Responses]) -> str:
    noticed, invented = _noticed_and_invented(found)
    return f"{noticed} noticed and {invented} invented by the full estimator"


def _rows_of_false_alarms(
    estimator: str, alarms: NDArray[np.float64], hours: float, tried: Callable[[], str]
) -> list[Row]:
    from giveway.simulation.push_response import most_events

    target = Target(maximum=FALSE_ALARMS_PER_HOUR, text=f"below {FALSE_ALARMS_PER_HOUR:g}")
    count = int(alarms.sum())
    bound = most_events(count) / hours
    shown = target if hours >= 1.0 else None  # a shorter time cannot show it
    reason = "" if shown is None or shown.met(bound) else tried()
    headings = len(alarms)
    return [
        Row(f"false alarms in {hours:g} h undisturbed, {estimator}", count, "1", "assumed", None, decimals=0),
        Row(
            f"of {headings} headings, with a false alarm, {estimator}",
            int((alarms > 0).sum()),
            "1",
            "assumed",
            None,
            decimals=0,
        ),
        Row(f"false alarms, upper bound at 95 %, {estimator}", bound, "1/h", "assumed", None, shown, reason, 3),
    ]


def _rows_of_mismatch(estimator: str, shares: Sequence[float], data: xarray.Dataset) -> list[Row]:
    alarms = data["false detections"].values > 0
    rows = []
    for sign, word in ((1, "more"), (-1, "less")):
        silent = 0.0
        for share, alarm in sorted((sign * share, alarm) for share, alarm in zip(shares, alarms, strict=True)):
            if share >= 0.0:
                if alarm:
                    break
                silent = share + 0.0  # never -0
        rows.append(
            Row(
                f"rollers may rub so much {word} without a false alarm, {estimator}",
                100.0 * silent,
                "%",
                "assumed",
                None,
            )
        )
    return rows


NOTES = (
    "Pushes, their shape, the start and the return are chosen here: the paper prints the circle and the speed only.",
    f"Undisturbed: {HEADINGS} rounds of 40 s, each with a start from rest; heading uniform in its own sector of "
    f"{360 / HEADINGS:g} deg, each encoder uniform within a count, noise of its own (seed {UNDISTURBED_SEED}).",
    "The robot knows its place from its wheels alone. Its reference is back on the plan exactly; the base itself lags "
    "by what servo and drivetrains give, and each escape, in which it yaws by a few tenths of a degree, leaves a "
    "millimetre or so of dead reckoning.",
    "What the rollers rub more or less than the estimator believes looks like a push: three sliding rollers brake with "
    "42 N, so a mismatch of 20 % is 8.4 N. False alarms begin where that exceeds detector.leak_motion, the force that "
    f"the detector ignores in motion: 3 N are 7 % of mismatch. The last row shows what {LEAK_N:g} N would do.",
    "The paper's estimator takes the planned acceleration for the real one. When a push ends, servo and drivetrains "
    "spring back, and in the escape the robot lags its reference: it takes both for pushes. Where one roller hardly "
    "turns, tanh (28) knows nothing of what it holds, up to 21 N for seconds, which it takes for a push, too.",
    "Most of what the full estimator invents around oblique pushes comes seconds after the push, in the return to the "
    "path, where a roller creeps. The encoders' steps are half of it: with a million counts a turn 5 of 10 are left, "
    "with twice the threshold 5 as well.",
)


EXPERIMENT = Experiment(
    name="circle",
    summary="The robot goes around a circle and is pushed from all sides: it gives way and comes back (paper, 5.4).",
    section="5.4",
    bumpers=BUMPERS,
    scenario=scenario,
    reproduce=reproduce,
)
