"""A slider hits the motionless robot (Kim, Llado, Sentis 2016, 5.2).

A 9.08 kg slider, pulled by a hanging weight of 4.54 kg, reaches 0.5 m/s and hits the middle of one side of the body.
The robot notices the hit from its wheel torques alone and escapes by 0.5 m. The escape decays with the time constant
M_des/B_des = 1.25 s, so it settles within 1 mm in 8 s. Afterwards the robot holds its position.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from giveway.experiments import PAPER_BUMPERS, Experiment
from giveway.experiments.placement import pulled_by_weight, stated_contact
from giveway.experiments.reproduction.findings import Effort, Findings, Picture, Row, Target, warning_notes
from giveway.paper.printed import printed
from giveway.robot.presets import DEFAULT, PAPER
from giveway.robot.wheels import WHEELS
from giveway.scenario.scenario import Scenario

if TYPE_CHECKING:
    from giveway.simulation.result import Result

DURATION_S = 8.0
SPEED_MPS = 0.5  # of the slider at the contact
IMPACT_S = 0.6  # the part up to detection and peak torque: contact at 0.16 s, and 0.35 s in which the peak counts
HOLD = 0  # after the escape; 1 would go back to the path
SEEDS, FEW_SEEDS = 20, 3
LABELS = {"none": "no bumper", "spring": "spring", "magnetic": "magnetic spring"}
PAPER_DETECTION = {
    bumper: printed(f"detection, {words}")
    for bumper, words in (("none", "no bumper"), ("spring", "spring"), ("magnetic", "magnetic"))
}
QUICKER_MPS2 = (5.0, 10.0)  # the reaction's acceleration limit, which the paper does not have, for comparison
CAPTION = (
    "Dashed: the moment of detection. Bumpers spread the hit over time and lower the peak torque of the impact; the "
    "magnetic latch holds until its force is exceeded, so that the robot feels the hit earlier than with the plain "
    "spring, and harder in the first 60 ms. After detection the robot drives away, and the torque changes its sign."
)


def scenario(
    bumper: str, duration_s: float = DURATION_S, *, robot: Path | None = None, preset: str = DEFAULT
) -> Scenario:
    """The experiment with ``bumper`` ("none", "spring" or "magnetic") on the slider.

    Another ``robot`` is hit as fast, in the middle of its own side between corners 0 and 1.
    """
    return Scenario(
        "motionless",
        duration_s,
        bumper=bumper,
        testbed={"slider.present": True, **pulled_by_weight("motionless", robot, SPEED_MPS)},
        controller={"supervisor.after_settled": HOLD},
        robot=robot,
        contact=stated_contact(robot, SPEED_MPS),
        preset=preset,
    )


def reproduce(effort: Effort) -> Findings:
    """5.2's rows and Fig. 10."""
    from giveway.experiments.figures.impact_response import draw
    from giveway.experiments.noise_range import noise_note
    from giveway.report import BUMPER_LABELS
    from giveway.simulation.runner import run

    results: dict[str, Result] = {}
    notes = []
    for number, (bumper, label) in enumerate(LABELS.items()):
        effort.progress(number / len(LABELS))
        results[bumper] = run(scenario(bumper, preset=PAPER), engine="native")
        seeds = effort.pick(SEEDS, FEW_SEEDS)
        short = scenario(bumper, IMPACT_S, preset=PAPER)
        notes.append(noise_note(f"Detection time, {label}", short, "detection time", seeds, effort))
    paper = [
        *((f"detection, {LABELS[bumper]}", paper.text) for bumper, paper in PAPER_DETECTION.items()),
        ("peak torque with bumpers", "about 20 % below that without"),
        ("escape", "0.5 m"),
    ]
    figure = draw({BUMPER_LABELS[bumper]: result for bumper, result in results.items()})
    picture = Picture("fig10", "Hit while motionless, with three bumpers (Fig. 10)", CAPTION, figure, paper)
    return Findings(
        [*_compared(results), *_each(results), _acceleration_row(results["magnetic"])],
        [picture],
        [*notes, *_remarks(results), *warning_notes({LABELS[b]: r for b, r in results.items()})],
    )


def value(result: Result, metric: str) -> float:
    """A metric's value, NaN if the event did not happen."""
    found = result.metric(metric).value
    return float("nan") if found is None else found


def peak_torque_ms(result: Result) -> float:
    """Time of the impact's peak torque, ms since contact."""
    from giveway.simulation.metrics import Collision

    hit = Collision(result.traces, result.manifest["parameters"])
    row = hit.peak_torque_row()
    return math.nan if row is None else float(1e3 * (hit.time_s[row] - (hit.contact_s or 0.0)))


def _acceleration_ms(bumper: str, result: Result) -> float:
    """Time of the robot's largest acceleration away from the slider, ms since contact."""
    import numpy as np

    from giveway.report import BUMPER_LABELS
    from giveway.report.runs import Run

    run = Run(BUMPER_LABELS[bumper], result)
    velocity = np.stack([run.hit["testbed.truth.vx"], run.hit["testbed.truth.vy"]], axis=1) @ run.along
    return float(run.time_ms[np.diff(velocity, prepend=0.0).argmax()])


def _compared(results: Mapping[str, Result]) -> Iterator[Row]:
    """The paper's measurements and comparisons."""
    detection, torque, force = (
        {bumper: value(result, metric) for bumper, result in results.items()}
        for metric in ("detection time", "peak wheel torque", "peak force of the run")
    )
    speed = value(results["none"], "contact speed")
    yield Row(
        "slider speed at contact", speed, "m/s", "fitted", printed("slider speed"), Target.around(0.5, 0.01), decimals=3
    )
    for bumper, paper in PAPER_DETECTION.items():
        target = Target.around(paper.value, 10.0)
        yield Row(f"detection time, {LABELS[bumper]}", detection[bumper], "ms", "fitted", paper, target)
    lead_ms, lead = detection["spring"] - detection["magnetic"], printed("lead of magnetic over spring")
    half = Target.around(lead.value, 5.0)  # half the paper's lead is still a lead
    yield Row("magnetic spring is noticed before the spring, by", lead_ms, "ms", "fitted", lead, half)
    for bumper in ("spring", "magnetic"):
        name = f"peak torque of the impact, {LABELS[bumper]} against no bumper"
        change = 100.0 * (torque[bumper] / torque["none"] - 1.0)
        yield Row(name, change, "%", "fitted", printed("peak torque with bumpers"), Target.around(-20.0, 5.0))
    # Over the run, which the weight's pull decides; the latch's own force comes first: see `latch`.
    name = f"peak contact force, magnetic spring against spring ({_masses(results['magnetic'])})"
    change = 100.0 * (force["magnetic"] / force["spring"] - 1.0)
    yield Row(name, change, "%", "assumed", None, Target(maximum=5.0))
    false = sum(value(result, "false detections") for result in results.values())
    yield Row("false detections, all three", false, "1", "computed", None, Target(maximum=0.0), decimals=0)


def _masses(result: Result) -> str:
    """Plate and cover in words: they decide the peak of the contact force."""
    parameters = result.manifest["parameters"]["testbed"]
    cover = f"cover {parameters['contact.stiffness'] / 1e3:g} kN/m"
    return cover if parameters["bumper.kind"] == 0 else f"plate {parameters['bumper.plate_mass']:g} kg, {cover}"


def _each(results: Mapping[str, Result]) -> Iterator[Row]:
    """The rows of each bumper."""
    for bumper, result in results.items():
        label = LABELS[bumper]
        force, torque, either, escape = (
            value(result, metric)
            for metric in ("peak force of the run", "peak wheel torque", "peak torque, any sign", "escape distance")
        )
        half_metre = Target.around(0.5, 0.005)
        yield Row(f"escape of the admittance, {label}", escape, "m", "given", printed("escape"), half_metre, decimals=3)
        yield Row(f"peak contact force, {label} ({_masses(result)})", force, "N", "assumed")
        yield Row(f"peak torque of the impact, {label}", torque, "N.m", "fitted", decimals=2)
        yield Row(f"time of that peak, {label}", peak_torque_ms(result), "ms", "fitted", decimals=0)
        yield Row(f"peak torque of either sign, {label}", either, "N.m", "fitted", decimals=2)
        if bumper != "magnetic":
            acceleration_ms = _acceleration_ms(bumper, result)
            yield Row(f"time of the largest acceleration, {label}", acceleration_ms, "ms", "fitted", decimals=0)


def _acceleration_row(result: Result) -> Row:
    """Fig. 10a; the reason of a miss is the same number with other limits of the reaction's acceleration."""
    paper = printed("largest acceleration, magnetic")
    target, ours = Target.around(paper.value, 10.0), _acceleration_ms("magnetic", result)
    reason = "" if target.met(ours) else _with_quicker_reactions()
    name = f"time of the largest acceleration, {LABELS['magnetic']}"
    return Row(name, ours, "ms", "fitted", paper, target, reason, 0)


def _with_quicker_reactions() -> str:
    import dataclasses

    from giveway.simulation.runner import run

    tried = []
    for limit in QUICKER_MPS2:
        quicker = scenario("magnetic", 1.0, preset=PAPER)
        controller = {**quicker.controller, "admittance.acceleration_limit": limit}
        peak_ms = _acceleration_ms(
            "magnetic", run(dataclasses.replace(quicker, controller=controller), engine="native")
        )
        tried.append(f"{peak_ms:.0f} ms with one of {limit:g} m/s2")
    return f"the reaction's acceleration limit, which the paper does not have, decides: {' and '.join(tried)}"


def _remarks(results: Mapping[str, Result]) -> Iterator[str]:
    """Deviations from the paper, with their numbers."""
    import numpy as np

    for bumper in ("spring", "magnetic"):
        result = results[bumper]
        detection_ms, peak_ms = value(result, "detection time"), peak_torque_ms(result)
        if peak_ms > detection_ms:
            torque = np.abs([result.traces[f"testbed.truth.wheel_torque[{wheel}]"].values for wheel in range(WHEELS)])
            contact_s = float(result.traces["testbed.truth.first_contact_time"].values[-1])
            early = torque[:, result.traces["time"].values <= contact_s + 1e-3 * detection_ms].max()
            yield (
                f"With the {LABELS[bumper]}, the torque of the impact peaks at {peak_ms:.0f} ms, when the robot slows "
                f"down and the slider, still pulled, pushes on; up to detection it reaches {early:.1f} N m only."
            )
    yield (
        "Fig. 10's dip of the torque right after the hit and its 50 ms plateau come from tipping, which a planar robot "
        "does not do."
    )


EXPERIMENT = Experiment(
    name="motionless",
    summary="A pulled slider at 0.5 m/s hits the resting robot, which notices and gives way (paper, 5.2).",
    section="5.2",
    bumpers=PAPER_BUMPERS,
    scenario=scenario,
    reproduce=reproduce,
)
