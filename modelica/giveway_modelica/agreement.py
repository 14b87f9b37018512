"""How far the examples are from the FMUs: per group of signals the height of the tube that just holds them."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from contextlib import nullcontext
from dataclasses import dataclass
from typing import Any

import numpy as np

from giveway_modelica.bench import Bench
from giveway_modelica.compiler import Compiler, classes
from giveway_modelica.fmu_runs import COUNTS, FINEST, RUNS, TOLERANCE, WHEEL_ANGLE, Alone, Array, Pair, in_double
from giveway_modelica.tube import at, excess

# Without encoders, and with the controller's until the first hit: both are limited by their solvers.
SMOOTH = 1e-5
# Else an encoder count may flip one sample earlier in one of the two: 6e-6 rad, which the servo makes a kick of
# 0.015 N m for 0.5 ms, and the sensor's spring a ringing of 5e-4 N m.
SAMPLED = 1e-4
# Where counts do flip, as the instants at which gears begin to slide are located to some 1e-9 s, and then every count
# comes at another time: the double FMU is 2.6e-4 and 1.3e-4 from itself if its solver runs at 1e-12 instead of 1e-11.
FLIPPED = {("CircleRound", "wheel torques"): 5e-4, ("CircleRound", "detector's impulse"): 5e-4}
# Around the FMUs as shipped. Their controller's single precision is 1e-7 of a turn, a sixth of a count: many flip. The
# loop hands that on: the impulse of a hit is off by 5e-5 N s, the direction in which the robot gives way by 4e-5 rad.
# The same FMUs in double are as far from them as Modelica is.
SHIPPED = {**FLIPPED, ("CirclePushed", "wheel torques"): 3e-4}
TUBE_S = 1e-4  # a tenth of a sample of the controller

CHANGES = {
    "RollerWaves": f"robot(counts={COUNTS})",
    "RollerWavesPair": f"robot(counts={COUNTS})",
    "MotionlessNoBumper": f"testbed(robot({FINEST}))",
    "MotionlessSpring": f"testbed(robot({FINEST}))",
    "MotionlessMagnetic": f"testbed(robot({FINEST}))",
    "MovingCollision": f"robot({FINEST})",
    "CirclePushed": f"robot({FINEST})",
}
AS_IT_IS = ("CircleRound",)  # has these settings of its own; 44 s of a sampled loop are simulated only once
STOP_S = {found.name.rsplit(".", 1)[1]: found.experiment[0] for found in classes() if found.experiment}


@dataclass(frozen=True)
class Signal:
    """One quantity in both.

    Attributes:
        ours: its name in the Modelica example; theirs: in the FMU or the co-simulation.
        group: signals of a group are measured by the largest of them: one may be zero by symmetry.
    """

    ours: str
    theirs: str
    group: str


_DRIVETRAIN = (
    Signal("drivetrain.tau_s", "sensor.torque", "sensed torque"),
    Signal("drivetrain.phi_m", "motor.angle", "motor angle"),
    Signal("drivetrain.motor.w", "motor.speed", "motor speed"),
    Signal("load.phi", "load.angle", "load angle"),
    Signal("load.w", "load.speed", "load speed"),
)
_BENCH = (
    Signal("slider.s", "carrier.position", "carriage's travel"),
    Signal("slider.v", "carrier.velocity", "carriage's speed"),
    Signal("slider.bumper.c", "compression", "compression"),
    Signal("slider.bumper.f", "plate.force", "bumper force"),
)
_BASE = (
    Signal("base.body.x", "x", "base position"),
    Signal("base.body.y", "y", "base position"),
    Signal("tau_s[1]", "wheel_torque[0]", "wheel torques"),
    Signal("tau_s[2]", "wheel_torque[1]", "wheel torques"),
    Signal("tau_s[3]", "wheel_torque[2]", "wheel torques"),
)
_DUMMY = (
    Signal("slider.s", "slider_position", "dummy's travel"),
    Signal("slider.bumper.c", "bumper_compression", "compression"),
    Signal("contact.f_normal", "contact_force", "contact force"),
)
_CONTROLLER = (
    Signal("x[1]", "reference.x", "reference"),
    Signal("x[2]", "reference.y", "reference"),
    Signal("q[1]", WHEEL_ANGLE.removeprefix("controller."), "wanted wheel angle"),
    Signal("left", "detection.statistic", "detector's impulse"),
    Signal("hit_point[1]", "detection.point_x", "located contact"),
    Signal("hit_point[2]", "detection.point_y", "located contact"),
)


def _named(signals: tuple[Signal, ...], ours: str, theirs: str) -> list[Signal]:
    return [Signal(f"{ours}.{one.ours}", f"{theirs}.{one.theirs}", one.group) for one in signals]


def signals(example: str) -> list[Signal]:
    """What is compared of ``example``."""
    if example == "DrivetrainStep":
        return list(_DRIVETRAIN)
    if isinstance(RUNS[example], Bench):
        floor = "floor" if example == "BumperDrop" else "obstacle"
        return [*_BENCH, Signal(f"{floor}.nose.f", "floor.force", "floor force")]
    inside = "testbed." if example.startswith("Motionless") else ""
    truth = "truth" if isinstance(RUNS[example], Alone) else "testbed.truth"
    found = _named(_BASE, f"{inside}robot", truth)
    if "Roller" not in example and "Circle" not in example and example != "StaticPush":
        found += _named(_DUMMY, f"{inside}dummy", truth)
    if example.startswith("RollerWaves"):
        found.append(Signal("robot.base.body.theta", "truth.theta", "heading"))
    if example == "StaticPush":
        found += [Signal(f"robot.base.wheel{i}.roller.f", f"truth.roller_force[{i}]", "roller forces") for i in (0, 1)]
    if isinstance(RUNS[example], Pair):
        found += _named(_CONTROLLER, f"{inside}robot.controller", "controller")
    return found


def bound(example: str, group: str, shipped: bool = False) -> float:
    """How high the tube is, over the group's largest magnitude; ``shipped``: around FMUs in single precision."""
    if example not in (*CHANGES, *AS_IT_IS):
        return SMOOTH
    return (SHIPPED if shipped else FLIPPED).get((example, group), SAMPLED)


@functools.cache
def simulated(compiler: Compiler, example: str, changes: str = "") -> Any:
    """The example with the settings of its FMU run, and ``changes``."""
    both = ", ".join(text for text in (CHANGES.get(example, ""), changes) if text)
    return compiler.simulate(f"GiveWay.Examples.{example}", both, tolerance=None if example in AS_IT_IS else TOLERANCE)


@functools.cache
def beside(example: str, shipped: bool = False) -> Mapping[str, Array]:
    """The FMUs' run of the example: with the C library in double, or as shipped."""
    with nullcontext() if shipped else in_double():
        return RUNS[example].run(STOP_S[example])


def heights(
    result: Any, reference: Mapping[str, Array], compared: list[Signal], until_s: float = math.inf
) -> dict[str, float]:
    """Per group the lowest tube around ``reference`` that holds ``result`` until then, over its largest magnitude."""
    time_s = reference["time"]
    rows = time_s <= until_s
    peaks: dict[str, float] = {}
    for one in compared:
        peaks[one.group] = max(peaks.get(one.group, 0.0), float(np.abs(reference[one.theirs]).max()))
    found = dict.fromkeys(peaks, 0.0)
    for one in compared:
        values = at(np.asarray(result.time), np.asarray(result[one.ours]), time_s[rows])
        outside = excess(time_s[rows], values, time_s, reference[one.theirs], TUBE_S, 0.0).value
        found[one.group] = max(found[one.group], outside / (peaks[one.group] or 1.0))
    return found


def found(result: Any, example: str, shipped: bool = False) -> dict[str, float]:
    """`heights` of ``result`` of ``example`` over all of its signals."""
    return heights(result, beside(example, shipped), signals(example))


def outside(result: Any, example: str, shipped: bool = False) -> dict[str, float]:
    """What of them is higher than its tube."""
    height = found(result, example, shipped)
    return {group: value for group, value in height.items() if value > bound(example, group, shipped)}


def table(compiler: Compiler) -> str:
    """Every example's heights in Markdown: around the FMUs in double, and as shipped where that is another FMU."""
    rows = ["| example | signals | bound | found | shipped |", "|---|---|---|---|---|"]
    for example, run in RUNS.items():
        result = simulated(compiler, example)
        single = {} if isinstance(run, Bench) else found(result, example, shipped=True)
        for group, height in found(result, example).items():
            other = f"{single[group]:.1e}" if group in single else ""
            rows.append(f"| {example} | {group} | {bound(example, group):.0e} | {height:.1e} | {other} |")
    return "\n".join(rows) + "\n"
