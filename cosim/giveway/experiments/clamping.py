"""A leg between robot and wall: quasi-static clamping (the future work of Kim, Llado, Sentis 2016, first step).

The robot drives at the speed of 5.3 into the paper's slider, which stands in front of a wall and cannot get out of the
way. It keeps pushing until it notices, then escapes. The slider represents a body region: its effective stiffness is in
series with the cover in front, and acts again between the slider and the wall behind. The force on it, the larger one
of both sides, is judged against the region's limits: the peak within 0.5 s of the contact, and the lasting force after
that.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from giveway.experiments import PAPER_BUMPERS, Experiment
from giveway.experiments.placement import before_resting, stated_contact, tare_s, testbed_of
from giveway.experiments.reproduction.findings import Effort, Findings, Picture, Row, Target
from giveway.robot.presets import DEFAULT, NO_REFLEX, PAPER
from giveway.robot.variables import table
from giveway.scenario.body_regions import NOTICE, Judgement, body_region, contact_peak, judge
from giveway.scenario.scenario import Scenario

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

REGION = "lower leg"
SPEED_MPS = 0.22
SPEEDS_MPS = (0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5)  # up to the robot's own limit
ASKED_MPS: Mapping[str, float] = {"none": 0.225, "spring": 0.375, "magnetic": 0.5}
"""Up to these speeds our own reflex shall keep the limits, with the leg before the wall."""
ASKED_PLACE = "20 mm before the wall"
SLIDER_KG = 13.62  # the paper's, of 5.3
GAPS_M: Mapping[str, float] = {"at the wall": 0.001, "20 mm before the wall": 0.02}
STEADY_S = 0.4  # at full speed before the contact: the servo's lag has settled
AFTER_S = 1.6  # of which 1.1 s count as lasting; a robot that keeps pushing for longer lags by half a wheel turn
RECORDED = (
    *(f"testbed.truth.{name}" for name in ("contact_force", "wall_force", "first_contact_time", "contact")),
    "controller.detection.count",
)
LABELS = {"none": "no bumper", "spring": "spring bumper", "magnetic": "magnetic spring bumper"}
STYLES = ("o-", "s:")  # per gap
NO_REFLEX_COLOUR, INK, LIMIT_COLOUR = "#8a8f98", "#2b2f36", "#b3261e"


def scenario(
    bumper: str,
    speed_mps: float = SPEED_MPS,
    gap_m: float = 0.001,
    region: str = REGION,
    *,
    reflex: bool = True,
    robot: Path | None = None,
    preset: str = DEFAULT,
) -> Scenario:
    """The robot drives into a clamped body region with ``bumper`` on it.

    Args:
        bumper: "none", "spring" or "magnetic".
        speed_mps: of the robot, m/s.
        gap_m: between the slider and the wall, m, above 0.
        region: the body region.
        reflex: False: the detector is off and the robot keeps pushing.
        robot: another robot's file; it drives with its own side between corners 0 and 1 ahead.
        preset: the controller's.
    """
    body = body_region(region)
    plan, slider = before_resting("clamping", robot, speed_mps, STEADY_S)
    return Scenario(
        "clamping",
        math.ceil(1e3 * (tare_s() + plan.ramp_s + STEADY_S + AFTER_S)) / 1e3,
        bumper=bumper,
        testbed={
            "slider.present": True,
            "slider.mass": SLIDER_KG,
            **slider,
            "rope.attached": False,
            "contact.stiffness": body.stiffness_with(float(testbed_of(robot)["contact.stiffness"])),
            "wall.present": True,
            "wall.distance": gap_m,
            "wall.stiffness": body.stiffness_npm,
        },
        controller={"supervisor.after_settled": 0, **({} if reflex else NO_REFLEX)},
        plan=plan,
        robot=robot,
        contact=stated_contact(robot, speed_mps, tare_s() + plan.ramp_s + STEADY_S),
        preset=preset,
    )


def reproduce(effort: Effort) -> Findings:
    """Forces on the leg with each bumper and gap, without the reflex, and over the speed."""
    import dataclasses

    from giveway import batch

    speeds = effort.pick(SPEEDS_MPS, (0.1, 0.5))
    cases: dict[tuple[object, ...], Scenario] = {
        (bumper, place): scenario(bumper, gap_m=gap, preset=PAPER)
        for place, gap in GAPS_M.items()
        for bumper in PAPER_BUMPERS
    }
    cases |= {
        ("no reflex", place): scenario("none", gap_m=gap, reflex=False, preset=PAPER) for place, gap in GAPS_M.items()
    }
    cases |= {
        (bumper, place, speed): scenario(bumper, speed, gap, preset=PAPER)
        for place, gap in GAPS_M.items()
        for bumper in PAPER_BUMPERS
        for speed in speeds
    }
    own = effort.pick(tuple(sorted({*SPEEDS_MPS, *ASKED_MPS.values()})), tuple(ASKED_MPS.values()))
    cases |= {
        ("own", bumper, speed): scenario(bumper, speed, GAPS_M[ASKED_PLACE])
        for bumper in PAPER_BUMPERS
        for speed in own
    }
    longest = max(case.duration_s for case in cases.values())  # traces need one duration
    table = batch.run_many(
        [dataclasses.replace(case, duration_s=longest) for case in cases.values()],
        threads=effort.threads,
        traces=RECORDED,
        progress=lambda done, of: effort.progress(done / of),
    )
    forces = {case: Clamped(table, run) for run, case in enumerate(cases)}
    safe = {
        (bumper, place): _safe_speed({speed: forces[bumper, place, speed] for speed in speeds})
        for place in GAPS_M
        for bumper in PAPER_BUMPERS
    }
    rows = [row for case in safe for row in _rows(*case, forces[case], safe[case])]
    rows += [_own_row(bumper, {speed: forces["own", bumper, speed] for speed in own}) for bumper in PAPER_BUMPERS]
    rows += [
        Row(f"lasting force, no reflex, {place}", forces["no reflex", place].judgement.lasting_n, "N", "assumed")
        for place in GAPS_M
    ]
    picture = Picture(
        "clamping",
        "A lower leg between robot and wall",
        "Left: force on the leg at the wall, robot at 0.22 m/s. Up to 0.5 s after the contact it has to stay below the "
        f"upper limit, from then on below the lower one. Right: its peak over the robot's speed. {NOTICE}",
        _figure(forces, speeds),
    )
    return Findings(rows, [picture], _notes(forces))


class Clamped:
    """The force on the leg in one run of a batch that recorded `RECORDED`.

    Attributes:
        time_s: since the first contact, shape (n,), s; from 0.2 s before.
        force_n: the larger one of the robot's and the wall's force, shape (n,), N.
        judgement: of the force.
        detection_ms: from the first contact to the decision; None without one.
    """

    def __init__(self, table: xarray.Dataset, run: int) -> None:
        import numpy as np

        time = table["time"].values
        both = [np.abs(table[f"testbed.truth.{side}_force"].values[run]) for side in ("contact", "wall")]
        self.force_n = np.maximum(*both)
        contact = float(table["testbed.truth.first_contact_time"].values[run, -1])
        self.time_s = time - contact
        self.judgement: Judgement = judge(time, self.force_n, REGION)
        hits = np.flatnonzero(np.diff(table["controller.detection.count"].values[run]) > 0) + 1
        self.detection_ms = 1e3 * float(self.time_s[hits[0]]) if hits.size else None


def _rows(bumper: str, place: str, clamped: Clamped, safe_mps: float | None) -> list[Row]:
    found = clamped.judgement
    region = found.region
    case = f"{bumper}, {place}"
    below = "at no speed that was tried" if safe_mps is None else f"up to {safe_mps:g} m/s, not at {SPEED_MPS:g} m/s"
    reason = "" if found.ok else f"tried at other speeds, with all else as it is: the limits are kept {below}"
    return [
        Row(f"detection time, {case}", clamped.detection_ms, "ms", "assumed", target=Target(0.0, text="happens")),
        Row(
            f"peak force, {case}",
            found.peak_n,
            "N",
            "assumed",
            target=Target(maximum=region.peak_limit_n),
            reason="" if found.peak_ok else reason,
        ),
        Row(
            f"lasting force, {case}",
            found.lasting_n,
            "N",
            "assumed",
            target=Target(maximum=region.lasting_limit_n),
            reason="" if found.lasting_ok else reason,
        ),
        Row(f"limits kept up to this speed, {case}", safe_mps, "m/s", "assumed", decimals=2),
    ]


def _own_row(bumper: str, found: Mapping[float, Clamped]) -> Row:
    """Up to which speed our own reflex keeps the limits, and where it does not first."""
    safe, asked = _safe_speed(found), ASKED_MPS[bumper]
    failed = next(((speed, clamped) for speed, clamped in found.items() if not clamped.judgement.ok), None)
    reason = ""
    if failed is not None and (safe is None or safe < asked):
        speed, clamped = failed
        when = "is not noticed" if clamped.detection_ms is None else f"is noticed after {clamped.detection_ms:.0f} ms"
        forces = f"{clamped.judgement.peak_n:.0f} N at first and {clamped.judgement.lasting_n:.0f} N lasting"
        reason = f"at {speed:g} m/s the leg {when} and feels {forces}"
    target = Target(minimum=asked)
    name = f"limits kept up to this speed, our own reflex, {bumper}, {ASKED_PLACE}"
    return Row(name, safe, "m/s", "assumed", target=target, reason=reason, decimals=3)


def _safe_speed(found: Mapping[float, Clamped]) -> float | None:
    """The largest tried speed up to which all speeds keep both limits; None if not even the slowest does."""
    safe = None
    for speed, clamped in found.items():
        if not clamped.judgement.ok:
            return safe
        safe = speed
    return safe


def _figure(forces: Mapping[tuple[object, ...], Clamped], speeds: Sequence[float]) -> Figure:
    from matplotlib.figure import Figure
    from matplotlib.style import context

    from giveway.library.recorded import windows
    from giveway.report.style import COLOURS, STYLE

    region, transient_s = body_region(REGION), windows().transient_s
    place = next(iter(GAPS_M))
    with context(STYLE):
        figure = Figure(figsize=(9.6, 3.9), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1.6, 1.0))
        for bumper in PAPER_BUMPERS:
            colour, label = COLOURS[LABELS[bumper]], LABELS[bumper]
            clamped = forces[bumper, place]
            left.plot(clamped.time_s, clamped.force_n, color=colour, label=label)
            for style, gap in zip(STYLES, GAPS_M, strict=True):
                peaks = [forces[bumper, gap, speed].judgement.peak_n for speed in speeds]
                right.plot(speeds, peaks, style, markersize=4, color=colour)
        clamped = forces["no reflex", place]
        left.plot(clamped.time_s, clamped.force_n, color=NO_REFLEX_COLOUR, label="no bumper, no reflex")
        limits = ([0.0, transient_s, transient_s, 1.5], [region.peak_limit_n] * 2 + [region.lasting_limit_n] * 2)
        left.plot(*limits, "--", color=LIMIT_COLOUR, linewidth=1.2, label=f"limits, {REGION}")
        right.axhline(region.peak_limit_n, linestyle="--", color=LIMIT_COLOUR, linewidth=1.2)
        left.set(xlabel="time since contact (s)", ylabel="force on the leg (N)", xlim=(-0.1, 1.5))
        right.set(xlabel="speed of the robot (m/s)", ylabel="peak force (N)")
        left.set_ylim(bottom=0.0)
        right.set_ylim(bottom=0.0)
        for style, gap in zip(STYLES, GAPS_M, strict=True):
            right.plot([], [], style, color=INK, markersize=4, label=f"leg {gap}")
        right.legend(loc="upper left")
        figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=5)
    return figure


def _notes(forces: Mapping[tuple[object, ...], Clamped]) -> list[str]:
    estimate = contact_peak(REGION, SPEED_MPS, float(table("testbed")["base.mass"].start or 0.0))
    pushing = forces["no reflex", next(iter(GAPS_M))].judgement.lasting_n
    return [
        NOTICE,
        f"Without the reflex the robot pushes with {pushing:.0f} N for as long as its plan goes on; the drives' torque "
        "limit sets that force, if the floor lets the wheels bear it: the plant's wheels do not slip.",
        f"A leg that can move away feels a peak of {estimate:.0f} N from a bare rigid robot by the standard's two-mass "
        "estimate.",
    ]


EXPERIMENT = Experiment(
    name="clamping",
    summary="The robot drives into a leg that stands in front of a wall; forces against ISO/TS 15066 limits.",
    section="",
    bumpers=PAPER_BUMPERS,
    scenario=scenario,
    reproduce=reproduce,
)
