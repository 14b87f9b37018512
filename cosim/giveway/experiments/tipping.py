"""The collisions of 5.2 with a base that can tip: effects of an impact above the centre of mass on torques and motion.

The paper's robot was hit "above its center of mass": its torques dip right after the impact, its motion has a plateau
of about 50 ms after detection, and its front wheel left the floor (Fig. 10). A planar robot shows none of it. The paper
does not print the height of the hit; the height halfway between the centre of mass and the top of the body is used, and
others for comparison.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.errors import SimulationError
from giveway.base.stretches import stretches
from giveway.experiments import PAPER_BUMPERS, Experiment, motionless
from giveway.experiments.placement import not_above
from giveway.experiments.reproduction.findings import Effort, Findings, Picture, Row, Target
from giveway.paper.printed import printed
from giveway.robot.presets import DEFAULT, PAPER
from giveway.robot.wheels import WHEELS
from giveway.scenario.scenario import Scenario
from giveway.simulation.runner import run

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from giveway.robot.variables import Value
    from giveway.simulation.result import Result

CENTRE_OF_MASS_M, TOP_M = 0.414, 0.751  # robot file; upper end of the same source's collision cylinder
CONTACT_HEIGHT_M = 0.58
HEIGHTS_M = (0.42, 0.5, CONTACT_HEIGHT_M, 0.66, 0.74)
LOW_M = 0.3  # below the centre of mass, where the paper did not hit
QUICK_NS = 0.6  # of impulse threshold
# "We decrease it to just over the limit where it tips over": without the reaction's limits, which the paper lacks.
MASSES_KG = tuple(round(2.4 - 0.1 * step, 1) for step in range(22))
UNLIMITED: dict[str, Value] = {"admittance.acceleration_limit": 1000.0, "admittance.speed_limit": 10.0}
HIGH_COM_M = 0.7
DURATION_S = 1.0
WINDOW_S = 0.35  # after contact, as for 5.2's peak torque
PLATEAU_SHARE = 0.5
# No lever arm for tipping, and no slip, which the planar robot does not have either.
FLAT: dict[str, Value] = {"base.com_height": 0.01, "contact.height": 0.01, "wheel.grip_friction": 10.0}


def scenario(bumper: str, *, robot: Path | None = None, preset: str = DEFAULT) -> Scenario:
    """5.2 with ``bumper``, hit at `CONTACT_HEIGHT_M` by a base that can tip; ``robot``: another robot's file.

    A robot whose centre of mass is lower than Trikey's is hit as much lower.
    """
    return _tipping(bumper, {"contact.height": not_above(robot, CONTACT_HEIGHT_M)}, robot, preset)


def _planar(bumper: str, robot: Path | None = None, preset: str = PAPER) -> Scenario:
    return motionless.scenario(bumper, DURATION_S, robot=robot, preset=preset)


def _tipping(bumper: str, testbed: dict[str, Value], robot: Path | None = None, preset: str = PAPER) -> Scenario:
    planar = _planar(bumper, robot, preset)
    return dataclasses.replace(planar, name="tipping", testbed={**planar.testbed, "base.tipping": True, **testbed})


class _Run:
    """A run from its first contact to `WINDOW_S` later."""

    def __init__(self, case: Scenario) -> None:
        self.result: Result = run(case, engine="native")
        time = self.result.traces["time"].to_numpy()
        contact = float(self._all("truth.first_contact_time")[-1])
        self._rows = (time >= contact) & (time <= contact + WINDOW_S)
        self.time_ms = 1e3 * (time[self._rows] - contact)

    def _all(self, name: str) -> NDArray[np.float64]:
        return self.result.traces[f"testbed.{name}"].to_numpy().astype(float)

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        return self._all(name)[self._rows]

    def along_push(self, quantity: tuple[str, str]) -> NDArray[np.float64]:
        """A vector's component along the push."""
        push = [float(self[f"truth.contact_impulse_{axis}"][-1]) for axis in "xy"]
        size = math.hypot(*push)
        along: NDArray[np.float64] = self[quantity[0]] * (push[0] / size) + self[quantity[1]] * (push[1] / size)
        return along

    def travel_mm(self) -> NDArray[np.float64]:
        travel = 1e3 * self.along_push(("truth.x", "truth.y"))
        return travel - float(travel[0])

    def detection_ms(self) -> float | None:
        return self.result.metric("detection time").value

    def plateau_ms(self) -> float:
        """Longest time for which the speed along the push is less than half of its previous maximum."""
        speed = self.along_push(("truth.vx", "truth.vy"))
        return _longest(speed < PLATEAU_SHARE * np.maximum.accumulate(speed), self.time_ms)

    def dip_nm(self) -> float:
        """The largest fall of wheel 0's torque from a peak, before detection."""
        torque = self["truth.wheel_torque[0]"]
        until = self.detection_ms()
        torque = torque[self.time_ms <= (self.time_ms[-1] if until is None else until)]
        return float((np.maximum.accumulate(torque) - torque).max())

    def airborne_ms(self) -> float:
        """Longest time that a wheel has no load."""
        return max(_longest(self[f"truth.wheel_load[{wheel}]"] <= 0.0, self.time_ms) for wheel in range(WHEELS))

    def lean_deg(self) -> float:
        return math.degrees(float(np.hypot(self["truth.pitch"], self["truth.roll"]).max()))

    def least_margin(self) -> float:
        """Over the whole run: the reaction goes on after the window."""
        return float(self._all("truth.tip_margin").min())

    def margin(self) -> float:
        return float(self["truth.tip_margin"].min())


def _longest(where: NDArray[np.bool_], time_ms: NDArray[np.float64]) -> float:
    longest = max((end - begin for begin, end in stretches(where)), default=0)
    return float(longest * (time_ms[1] - time_ms[0]))


def _reproduce(effort: Effort) -> Findings:
    bumpers: Sequence[str] = effort.pick(PAPER_BUMPERS, ("none",))
    heights = effort.pick(HEIGHTS_M, (0.42, CONTACT_HEIGHT_M))
    count = 2 * len(bumpers) + len(heights) + 1
    runs: list[_Run] = []

    def run(case: Scenario) -> _Run:
        runs.append(_Run(case))
        effort.progress(len(runs) / count)
        return runs[-1]

    planar = {bumper: run(_planar(bumper)) for bumper in bumpers}
    tipping = {bumper: run(scenario(bumper, preset=PAPER)) for bumper in bumpers}
    by_height = {height: run(_tipping("none", {"contact.height": height})) for height in heights}
    flat = run(_tipping("none", FLAT))
    rows = [
        *_plateau_rows(planar["none"], tipping["none"], by_height),
        *(_safety_row(bumper, tipping[bumper]) for bumper in bumpers),
        *(_detection_row(bumper, tipping[bumper], by_height) for bumper in bumpers),
        _agreement_row(planar["none"], flat),
        _mass_row(bumpers, effort.pick(MASSES_KG, MASSES_KG[::5])),
    ]
    notes = [
        f"Heights above the floor: centre of mass {CENTRE_OF_MASS_M:g} m (robot file), contact {CONTACT_HEIGHT_M:g} m "
        f"(assumed, halfway to the body's top at {TOP_M:g} m). Stiffness and friction of wheels and floor are assumed.",
        "Without a bumper, by height of the contact: "
        + "; ".join(
            f"{height:g} m: plateau {r.plateau_ms():.0f} ms, a wheel in the air for {r.airborne_ms():.0f} ms, "
            f"detected after {_ms(r.detection_ms())}"
            for height, r in by_height.items()
        )
        + ". A hit above the centre of mass takes load and grip from the wheels, so they feel it later.",
    ]
    pictures = [
        Picture(
            "wheel-torque",
            "Wheel torque and motion, with and without tipping",
            "Torque of wheel 0 and travel of the base along the push, as the paper's Fig. 10 has them, and the loads "
            "on the wheels; dotted: detection. The base that tips loses torque right after a hard impact, and its "
            "travel pauses.",
            _picture(planar, tipping),
            (("plateau after detection, no bumper", "about 50 ms"),),
        )
    ]
    return Findings(rows, pictures, notes)


def _ms(value: float | None) -> str:
    return "never" if value is None else f"{value:.0f} ms"


def _plateau_rows(planar: _Run, tipping: _Run, by_height: dict[float, _Run]) -> list[Row]:
    target = Target.around(50.0, 25.0)
    plateaus = {height: run.plateau_ms() for height, run in by_height.items()}
    enough = [height for height, plateau in plateaus.items() if target.met(plateau)]
    reason = (
        f"a contact at {min(enough):g} m makes one of {plateaus[min(enough)]:.0f} ms; the paper prints no height"
        if enough
        else f"no height from {min(plateaus):g} to {max(plateaus):g} m makes more than {max(plateaus.values()):.0f} ms"
    )
    plateau, still, airborne = tipping.plateau_ms(), Target(0.0, 0.0, "none"), tipping.airborne_ms()
    lifts = Target(minimum=1.0, text="it lifts")
    low = "" if lifts.met(airborne) else "this contact is too low to lift one"
    missed = "" if target.met(plateau) else reason
    return [
        Row(
            "plateau of the motion, no bumper",
            plateau,
            "ms",
            "assumed",
            printed("plateau, no bumper"),
            target,
            missed,
            0,
        ),
        Row("plateau of the motion, no bumper, planar", planar.plateau_ms(), "ms", "computed", None, still, "", 0),
        Row("longest time a wheel is in the air", airborne, "ms", "assumed", "front wheel lifts", lifts, low, 0),
        Row(
            "dip of wheel 0's torque before detection, no bumper",
            tipping.dip_nm(),
            "N.m",
            "assumed",
            "a dip",
            None,
            "",
            2,
        ),
        Row("the same, planar", planar.dip_nm(), "N.m", "computed", None, None, "", 2),
    ]


def _safety_row(bumper: str, run: _Run) -> Row:
    # 0 is the point of no return; a design would keep half of the margin.
    half, margin = Target(minimum=0.5), run.margin()
    reason = "" if half.met(margin) else "a lower or softer contact, or a slower escape, would keep it"
    name = f"least tip margin, {BUMPERS_IN_WORDS[bumper]} (leans {run.lean_deg():.1f} deg)"
    return Row(name, margin, "1", "assumed", None, half, reason, 2)


def _detection_row(bumper: str, tipping: _Run, by_height: dict[float, _Run]) -> Row:
    paper, ours = motionless.PAPER_DETECTION[bumper], tipping.detection_ms()
    target = Target.around(paper.value, 10.0)
    reason = "" if target.met(ours) else _reason_of_delay(bumper, by_height)
    return Row(
        f"detection time with tipping, {BUMPERS_IN_WORDS[bumper]}", ours, "ms", "assumed", paper, target, reason, 0
    )


def _reason_of_delay(bumper: str, by_height: dict[float, _Run]) -> str:
    """Other heights (without a bumper) and another threshold, which then holds for every bumper."""

    def with_threshold(bumper: str) -> str:
        case = _tipping(bumper, {"contact.height": CONTACT_HEIGHT_M})
        controller = {**case.controller, "detector.impulse_threshold": QUICK_NS}
        return _ms(_Run(dataclasses.replace(case, controller=controller)).detection_ms())

    heights = ""
    if bumper == "none":
        least = min(by_height)
        low = _ms(_Run(_tipping(bumper, {"contact.height": LOW_M})).detection_ms())
        heights = (
            f"a contact at {least:g} m is noticed after {_ms(by_height[least].detection_ms())}, only one below the "
            f"centre of mass, at {LOW_M:g} m, after {low}; "
        )
    others = ", ".join(with_threshold(one) for one in PAPER_BUMPERS)
    return (
        f"{heights}the threshold was fitted to the planar robot: one of {QUICK_NS:g} N s gives {others} (no bumper, "
        "spring, magnetic)"
    )


def _mass_row(bumpers: Sequence[str], masses_kg: Sequence[float]) -> Row:
    paper, target = printed("M_des just over the limit of tipping"), Target(1.75, 2.0, "2 or a little less")
    ours = _tips_at(bumpers, masses_kg, {})
    reason = ""
    if not target.met(ours):
        higher = _tips_at(bumpers, masses_kg, {"base.com_height": HIGH_COM_M})
        found = "at none" if higher is None else f"at {higher:g} kg"
        reason = f"with its centre of mass at {HIGH_COM_M:g} m instead of {CENTRE_OF_MASS_M:g} m it tips over {found}"
    name = "largest M_des at which it tips over, reaction without limits"
    return Row(name, ours, "kg", "assumed", paper, target, reason, 1)


def _tips_at(bumpers: Sequence[str], masses_kg: Sequence[float], testbed: dict[str, Value]) -> float | None:
    """The first of the falling masses with which it passes the point of no return in a hit with one of the bumpers."""
    for mass_kg in masses_kg:
        for bumper in bumpers:
            case = _tipping(bumper, {"contact.height": CONTACT_HEIGHT_M, **testbed})
            controller = {**case.controller, **UNLIMITED, "admittance.mass": mass_kg}
            try:
                tried = _Run(dataclasses.replace(case, controller=controller))
            except SimulationError as error:
                if "tips over" not in str(error):
                    raise
                return mass_kg
            if tried.least_margin() <= 0.0:
                return mass_kg
    return None


def _agreement_row(planar: _Run, flat: _Run) -> Row:
    """Both hit without a bumper, compared until the controllers react, as these see different encoder counts."""
    reacts = min(planar.detection_ms() or 1e3 * WINDOW_S, flat.detection_ms() or 1e3 * WINDOW_S)
    worst = 0.0
    for names in (
        ("truth.contact_force",),
        tuple(f"truth.wheel_torque[{i}]" for i in range(WHEELS)),
        ("truth.x", "truth.y"),
    ):
        before = planar.time_ms < reacts
        a = np.stack([planar[name][before] for name in names])
        b = np.stack([flat[name][before] for name in names])
        worst = max(worst, float(np.abs(a - b).max() / np.abs(a - a[:, :1]).max()))
    target = Target(maximum=10.0, text="at most 10 (the wheels' grip is 30 times as stiff as the drivetrain)")
    reason = "" if target.met(100.0 * worst) else "wheel.grip_stiffness: the deviation falls as it rises"
    name = "largest deviation from the planar robot, wheels kept down"
    return Row(name, 100.0 * worst, "%", "computed", None, target, reason, 1)


BUMPERS_IN_WORDS = {"none": "no bumper", "spring": "spring bumper", "magnetic": "magnetic bumper"}


def _picture(planar: dict[str, _Run], tipping: dict[str, _Run]) -> Figure:
    from matplotlib.figure import Figure
    from matplotlib.style import context

    from giveway.report.style import BUMPER_LABELS, COLOURS, STYLE, TRUTH_COLOUR

    colours = {bumper: COLOURS[BUMPER_LABELS[bumper]] for bumper in PAPER_BUMPERS}
    with context(STYLE):
        figure = Figure(figsize=(9.6, 6.4), layout="constrained")
        panels = figure.subplots(3, len(planar), sharex=True, sharey="row", squeeze=False)
        for column, bumper in enumerate(planar):
            for run, colour, label in (
                (planar[bumper], TRUTH_COLOUR, "planar"),
                (tipping[bumper], colours[bumper], "tipping"),
            ):
                panels[0, column].plot(run.time_ms, run["truth.wheel_torque[0]"], color=colour, label=label)
                panels[1, column].plot(run.time_ms, run.travel_mm(), color=colour)
                for axes in panels[:, column]:
                    if run.detection_ms() is not None:
                        axes.axvline(run.detection_ms(), color=colour, linestyle=":", linewidth=1.0)
            for wheel, style in enumerate(("-", "--", ":")):
                load = tipping[bumper][f"truth.wheel_load[{wheel}]"]
                panels[2, column].plot(
                    tipping[bumper].time_ms,
                    load,
                    color=colours[bumper],
                    linestyle=style,
                    linewidth=1.1,
                    label=f"wheel {wheel}",
                )
            panels[0, column].set_title(BUMPERS_IN_WORDS[bumper])
            panels[2, column].set(xlabel="time since contact (ms)", xlim=(0.0, 1e3 * WINDOW_S))
        handles, labels = panels[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper right", ncols=2)
        handles, labels = panels[2, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3)
        for row, label in enumerate(("torque of wheel 0 (N m)", "travel (mm)", "load on the wheels (N)")):
            panels[row, 0].set_ylabel(label)
    return figure


EXPERIMENT = Experiment(
    name="tipping",
    summary="The collisions of 5.2 with a base that can tip: torque dip, plateau, tip margin (paper, Fig. 10).",
    section="5.2",
    bumpers=PAPER_BUMPERS,
    scenario=scenario,
    reproduce=_reproduce,
)
