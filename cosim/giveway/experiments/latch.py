"""What the magnetic latch costs: the force of the first 60 ms, with and without it.

The paper's bumper is meant to be noticed earlier and to lower the maximum force (3.5). A latched bumper first pushes as
a rigid one, until the latch lets go, and what is in front of the latch adds its own mass: so the force of the first 60
ms, before any bumper of 5.2 is noticed, is compared with that of the same bumper without the magnet, in 5.2 and for a
free slider at several speeds. Other plates, springs and latches say with which parts the latch would cost nothing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from giveway.experiments import Experiment, motionless
from giveway.experiments.placement import outline_of_robot, testbed_of
from giveway.experiments.reproduction.findings import Effort, Findings, Row, Target
from giveway.robot.presets import PAPER
from giveway.robot.variables import table
from giveway.scenario.plan import Rest
from giveway.scenario.scenario import Scenario

if TYPE_CHECKING:
    from giveway.robot.variables import Value

EARLY_S = 0.06
SPEEDS_MPS = (0.2, 0.3, 0.4, 0.5)
PLATES_KG = (0.05, 0.2, 0.5)
STIFF_NPM = 2400.0  # of the stiffest spring in examples/studies/magnetic_latch.toml
LATCHES_N = tuple(5.0 * step for step in range(10))
CONTACT_S = 0.25
PULLED_CONTACT_S = 0.2  # 5.2's contact comes before
NOTICED_S = 0.4  # after the contact; longer than the slowest takes
COSTS_NOTHING = Target(maximum=5.0)
PARTS = ("latch_force", "plate_mass", "spring_rate")
BUMPERS = ("spring", "magnetic")
TRACES = ("testbed.truth.contact_force", "testbed.truth.first_contact_time")


def free_slider(
    bumper: str, speed_mps: float, parts: Mapping[str, Value] | None = None, after_s: float = EARLY_S
) -> Scenario:
    """5.2 without the weight: the slider rolls freely into the resting robot; ``parts``: other bumper parameters."""
    from giveway.scenario.approach import Approach, edge_middle, meet

    approach = Approach(edge_middle(outline_of_robot(None), 0), speed_mps, time_s=CONTACT_S)
    slider = meet(approach, {**testbed_of(None), "bumper.kind": 0}, Rest(), 0.0)
    testbed = {"slider.present": True, **slider, **(parts or {})}
    return Scenario("latch", CONTACT_S + after_s + 0.01, bumper=bumper, testbed=testbed, preset=PAPER)


def pulled(bumper: str) -> Scenario:
    """5.2, as long as a bumper may take to be noticed."""
    return motionless.scenario(bumper, PULLED_CONTACT_S + NOTICED_S, preset=PAPER)


def early_force(scenarios: Sequence[Scenario], threads: int) -> tuple[list[float], list[float]]:
    """Largest contact force up to `EARLY_S` after the contact, N, and the time of detection, ms (NaN: none), of runs of
    one duration."""
    from giveway import batch
    from giveway.base.errors import SimulationError

    found = batch.run_many(scenarios, threads=threads, traces=TRACES)
    for status, message in zip(found["status"].values, found["message"].values, strict=True):
        if status != "ok":
            raise SimulationError("latch", str(message), 0.0)
    time_s, (force, contact) = found["time"].values, (found[name].values for name in TRACES)
    after_s = time_s - contact[:, -1:]
    early = (after_s >= 0.0) & (after_s <= EARLY_S)
    return [float(row[shown].max()) for row, shown in zip(force, early, strict=True)], found[
        "detection time"
    ].values.tolist()


def reproduce(effort: Effort) -> Findings:
    """The shipped latch in 5.2 and at several speeds, and by plate and spring the strongest that costs nothing."""
    speeds = effort.pick(SPEEDS_MPS, (0.2, 0.5))
    strongest = _strongest(speeds, effort)
    shipped, best = list(strongest)[-2], list(strongest)[1]
    reason = (
        f"a latch would cost nothing with {_costless(best, strongest, speeds)}; "
        f"with the shipped parts, {_costless(shipped, strongest, speeds)}"
    )
    cases = [(f"{speed:g} m/s", [free_slider(b, speed, after_s=NOTICED_S) for b in BUMPERS]) for speed in speeds]
    rows = [
        row
        for name, both in (("5.2", [pulled(b) for b in BUMPERS]), *cases)
        for row in _rows(name, both, reason, effort)
    ]
    parts = "; ".join(_costless(one, strongest, speeds) for one in strongest)
    return Findings(rows, notes=[*_notes(), f"Latches, tried in steps of 5 N, that raise it by at most 5 %: {parts}."])


def _rows(name: str, both: Sequence[Scenario], reason: str, effort: Effort) -> list[Row]:
    (spring, magnetic), noticed_ms = early_force(both, effort.threads)
    raised = 100.0 * (magnetic / spring - 1.0)
    what = f"force of the first {1e3 * EARLY_S:g} ms"
    return [
        Row(f"{what}, {name}, spring", spring, "N", "assumed"),
        Row(f"{what}, {name}, magnetic spring", magnetic, "N", "assumed"),
        Row(
            f"the latch raises it by, {name}",
            raised,
            "%",
            "assumed",
            "it lowers the maximum",
            COSTS_NOTHING,
            "" if COSTS_NOTHING.met(raised) else reason,
            0,
        ),
        Row(f"the latch is noticed earlier by, {name}", noticed_ms[0] - noticed_ms[1], "ms", "fitted"),
    ]


def _strongest(speeds: Sequence[float], effort: Effort) -> dict[tuple[float, float], tuple[float, float]]:
    """By plate (kg) and spring (N/m) the strongest latch (N) that costs nothing: at the highest speed, at every one."""
    shipped = float(table("testbed")["bumper.spring_rate"].start or 0.0)
    found = {}
    parts = [(plate, rate) for plate in effort.pick(PLATES_KG, (0.5,)) for rate in (shipped, STIFF_NPM)]
    for done, (plate, rate) in enumerate(parts):
        least = []
        for speed in speeds:
            bumper: dict[str, Value] = {"bumper.plate_mass": plate, "bumper.spring_rate": rate}
            runs = [free_slider("magnetic", speed, {**bumper, "bumper.latch_force": latch}) for latch in LATCHES_N]
            forces, _ = early_force(runs, effort.threads)
            kept = [COSTS_NOTHING.met(100.0 * (force / forces[0] - 1.0)) for force in forces]
            least.append(LATCHES_N[(kept.index(False) if False in kept else len(kept)) - 1])
        found[plate, rate] = (least[-1], min(least))
        effort.progress(0.8 * (done + 1) / len(parts))
    return found


def _costless(
    parts: tuple[float, float], strongest: Mapping[tuple[float, float], tuple[float, float]], speeds: Sequence[float]
) -> str:
    (plate, rate), (fast, every) = parts, strongest[parts]
    return (
        f"{plate:g} kg on {1e-3 * rate:g} N/mm: up to {fast:g} N at {speeds[-1]:g} m/s, up to {every:g} N from "
        f"{speeds[0]:g} m/s on"
    )


def _notes() -> list[str]:
    bumper = {name: float(table("testbed")[f"bumper.{name}"].start or 0.0) for name in PARTS}
    latch_n, plate_kg, rate = (bumper[name] for name in PARTS)
    bound = motionless.SPEED_MPS * math.sqrt(rate * float(table("testbed")["slider.mass"].start or 0.0))
    return [
        f"The shipped latch of {latch_n:g} N holds a plate of {plate_kg:g} kg and is {latch_n / bound:.2f} of "
        "v sqrt(k m) at 5.2's speed. That bound is for a plate without mass, and for the peak of the whole collision. "
        "The paper does not print latch, plate and spring; latch and spring were fitted to its times of detection."
    ]


EXPERIMENT = Experiment(
    name="latch",
    summary="The force of the first 60 ms with and without the magnetic latch, and parts with which it costs nothing.",
    section="3.5",
    reproduce=reproduce,
)
