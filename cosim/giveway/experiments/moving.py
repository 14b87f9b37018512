"""The moving robot drives into a resting slider (Kim, Llado, Sentis 2016, 5.3).

The robot drives at 0.22 m/s, with the middle of one side ahead, into a free slider of 13.62 kg. It notices the hit,
reverses and escapes by 0.5 m.

It starts from rest and accelerates slowly: the PD servo makes torque only by its lag, so a robot that is set in motion
at once first falls behind its plan, which the estimator mistakes for a push. By the time of the contact lag, rollers
and drivetrains are those of steady motion.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from giveway.experiments import PAPER_BUMPERS, Experiment, motionless
from giveway.experiments.placement import before_resting, sliding_mass, stated_contact, tare_s
from giveway.experiments.reproduction.findings import Effort, Findings, Picture, Row, Target, warning_notes
from giveway.paper.printed import printed
from giveway.robot.presets import DEFAULT, PAPER
from giveway.scenario.scenario import Scenario

if TYPE_CHECKING:
    from giveway.robot.variables import Value
    from giveway.simulation.result import Result

SPEED_MPS = 0.22
SLIDER_KG = 13.62
STEADY_S = 0.4  # at full speed before the contact: more than ten time constants kd/kp of the servo's lag
ESCAPE_S = 8.0  # as in 5.2
HOLD = 0  # after the escape; 1 would go back to the path and into the slider again
PAPER_BUMPER = "magnetic"
TRIED: Mapping[str, tuple[Mapping[str, Value], Mapping[str, Value]]] = {
    "a latch of 20 N": ({"bumper.latch_force": 20.0}, {}),
    "a rail friction of 18 N": ({"slider.friction": 18.0}, {}),
    "an acceleration limit of 5 m/s2": ({}, {"admittance.acceleration_limit": 5.0}),
    "none": ({}, {"admittance.acceleration_limit": 1000.0}),
}
"""Changes of testbed and controller for the reasons of missed targets."""
SLOWER, QUICKER = tuple(TRIED)[:2], tuple(TRIED)[2:]
REVERSAL_S = 1.2  # after the contact: the reversal, and the time in which it might be mistaken for another hit


def scenario(
    bumper: str, after_contact_s: float = ESCAPE_S, *, robot: Path | None = None, preset: str = DEFAULT
) -> Scenario:
    """The experiment with ``bumper`` on the slider, up to ``after_contact_s`` after the planned contact.

    The paper has the magnetic one only. Another ``robot`` drives with its own side between corners 0 and 1 ahead, into
    half again as much as its own slider's mass, as in the paper.
    """
    plan, slider = before_resting("moving", robot, SPEED_MPS, STEADY_S)
    return Scenario(
        "moving",
        math.ceil(1e3 * (tare_s() + plan.ramp_s + STEADY_S + after_contact_s)) / 1e3,
        bumper=bumper,
        testbed={
            "slider.present": True,
            "slider.mass": sliding_mass(robot, SLIDER_KG),
            **slider,
            "rope.attached": False,
        },
        controller={"supervisor.after_settled": HOLD},
        plan=plan,
        robot=robot,
        contact=stated_contact(robot, SPEED_MPS, tare_s() + plan.ramp_s + STEADY_S),
        preset=preset,
    )


def reproduce(effort: Effort) -> Findings:
    """5.3's rows and Fig. 11."""
    from giveway.experiments.figures.reversal import draw
    from giveway.experiments.noise_range import noise_note
    from giveway.report import BUMPER_LABELS
    from giveway.simulation.runner import run

    bumpers = ("spring", "magnetic")
    while_still = [
        run(motionless.scenario(bumper, motionless.IMPACT_S, preset=PAPER), engine="native") for bumper in bumpers
    ]
    effort.progress(0.2)
    result = run(scenario(PAPER_BUMPER, preset=PAPER), engine="native")
    effort.progress(0.5)
    seeds = effort.pick(motionless.SEEDS, motionless.FEW_SEEDS)
    short = scenario(PAPER_BUMPER, REVERSAL_S, preset=PAPER)
    note = noise_note("Detection time", short, "detection time", seeds, effort)
    picture = Picture(
        "fig11",
        "Hit while moving (Fig. 11)",
        "The robot drives into the resting slider and compresses its bumper; dashed: the moment of detection, from "
        "which on it reverses. The torque of the reversal is larger than that of the impact.",
        draw(BUMPER_LABELS[PAPER_BUMPER], result),
        paper=[
            ("speed at contact", "0.22 m/s"),
            ("detection", "105 ms"),
            ("largest spring deflection", "at 180 ms"),
            ("peak torque", "about twice the peaks with bumpers of 5.2"),
        ],
    )
    again = {words: run(_varied(*change), engine="native") for words, change in TRIED.items()}
    peaks = [motionless.value(still, "peak wheel torque") for still in while_still]
    return Findings(
        _rows(result, sum(peaks) / len(peaks), again), [picture], [note, *warning_notes({PAPER_BUMPER: result})]
    )


def _varied(testbed: Mapping[str, Value], controller: Mapping[str, Value]) -> Scenario:
    import dataclasses

    case = scenario(PAPER_BUMPER, REVERSAL_S, preset=PAPER)
    return dataclasses.replace(case, testbed={**case.testbed, **testbed}, controller={**case.controller, **controller})


def _rows(result: Result, still_nm: float, again: Mapping[str, Result]) -> list[Row]:
    """The table; ``still_nm`` is the mean of 5.2's peaks with bumpers, ``again`` the runs of `TRIED`."""
    peak_nm = motionless.value(result, "peak torque, any sign")
    reversal_ms, deflection_ms = _times_ms(result)
    speed, detection, escape, false = (
        motionless.value(result, name)
        for name in ("contact speed", "detection time", "escape distance", "false detections")
    )
    fitted = "fitted"
    reverse, deflected = printed("time to detect and reverse"), printed("largest deflection, moving")
    # "Roughly": a quarter. The deflection's time is that of a still, as good as a time of detection.
    in_time, at_still = Target.around(reverse.value, 25.0), Target.around(deflected.value, 10.0)
    late = ", ".join(f"{_times_ms(again[words])[0]:.0f} ms with {words}" for words in QUICKER)
    flat = ", ".join(
        f"{_times_ms(again[words])[1]:.0f} ms with {words} (then noticed after "
        f"{motionless.value(again[words], 'detection time'):.0f} ms)"
        for words in SLOWER
    )
    return [
        Row(
            "speed at contact",
            speed,
            "m/s",
            "given",
            printed("robot speed"),
            Target.around(SPEED_MPS, 0.005),
            decimals=3,
        ),
        Row("detection time", detection, "ms", fitted, printed("detection, moving"), Target.around(105.0, 10.0)),
        Row(
            "reversal after contact",
            reversal_ms,
            "ms",
            fitted,
            reverse,
            in_time,
            ""
            if in_time.met(reversal_ms)
            else f"{detection:.0f} ms pass until the decision; then the reaction's acceleration limit decides: {late}",
            decimals=0,
        ),
        Row(
            "peak torque over 5.2's with bumpers",
            peak_nm / still_nm,
            "1",
            fitted,
            printed("peak torque, moving"),
            Target.around(2.0, 0.2),
            decimals=2,
        ),
        Row("peak torque of either sign", peak_nm, "N.m", fitted, decimals=2),
        Row("peak torque against the motion", motionless.value(result, "peak wheel torque"), "N.m", fitted, decimals=2),
        Row("peak force of the run", motionless.value(result, "peak force of the run"), "N", "assumed"),
        Row("largest spring deflection", motionless.value(result, "bumper compression"), "mm", fitted),
        Row(
            "time of the largest spring deflection",
            deflection_ms,
            "ms",
            fitted,
            deflected,
            at_still,
            ""
            if at_still.met(deflection_ms)
            else f"the latch's hit makes the plate swing; tried, with all else as it is: {flat}",
            decimals=0,
        ),
        Row("escape of the admittance", escape, "m", "given", printed("escape"), Target.around(0.5, 0.005), decimals=3),
        Row("false detections", false, "1", "computed", None, Target(maximum=0.0), decimals=0),
    ]


def _times_ms(result: Result) -> tuple[float, float]:
    """Times since contact in ms: of the robot's reversal (NaN if it did not), of the largest spring deflection."""
    import numpy as np

    from giveway.report import BUMPER_LABELS
    from giveway.report.runs import Run

    run = Run(BUMPER_LABELS[PAPER_BUMPER], result)
    velocity = np.stack([run.hit["testbed.truth.vx"], run.hit["testbed.truth.vy"]], axis=1) @ run.along
    backwards = np.flatnonzero((run.time_s > 0.0) & (velocity > 0.0))
    reversal = float(run.time_ms[backwards[0]]) if backwards.size else float("nan")
    return reversal, float(run.time_ms[int(np.argmax(run.hit["testbed.truth.bumper_compression"]))])


EXPERIMENT = Experiment(
    name="moving",
    summary="The robot drives at 0.22 m/s into a resting slider, notices, reverses and gives way (paper, 5.3).",
    section="5.3",
    bumpers=PAPER_BUMPERS,
    scenario=scenario,
    reproduce=reproduce,
)
