"""The Modelica package and the FMUs are two statements of one plant: their trajectories are the same."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from fmu_beside import FINEST, RUNS, Alone, Array, Pair
from giveway_modelica.compiler import Compiler, classes
from giveway_modelica.tube import at, excess

# Without a sampled controller both are limited by their solvers, which run at 1e-9.
SMOOTH = 1e-5
# With it by the controller's single precision and by encoder counts that flip (6e-6 rad, felt as 0.015 N m).
SAMPLED = 1e-4
# The controller works in single precision: its reference is off by 1e-7 of a turn, a sixth of a count. A count that
# flips one sample earlier in one of the two kicks a motor by 0.015 N m for 0.5 ms, which rings on the sensor's spring
# with 1e-3 N m. Over 1.65 s two or three of these are in the air at a time: 2.7e-3 N m, of a peak of 12 N m.
KICKED = {"CirclePushed": ("robot.tau_s", 3e-4)}
EVENT_S = 1e-6  # of locating an event; both solvers find it to some 1e-8 s
TUBE_S = 1e-4  # a tenth of a sample of the controller

BASE = {
    "base.body.x": "x",
    "base.body.y": "y",
    "tau_s[1]": "wheel_torque[0]",
    "tau_s[2]": "wheel_torque[1]",
    "tau_s[3]": "wheel_torque[2]",
}
DUMMY = {"slider.s": "slider_position", "slider.bumper.c": "bumper_compression", "contact.f_normal": "contact_force"}
REFERENCE = {
    "x[1]": "reference.x",
    "x[2]": "reference.y",
    "q[1]": "command.wheel_angle[0]",
    "left": "detection.statistic",
}
MOTION = ("base.body.x", "base.body.y", "slider.s")
WITH_DUMMY = ("LatchRelease", "MotionlessNoBumper", "MotionlessSpring", "MotionlessMagnetic", "MovingCollision")
CHANGES = {
    "RollerWaves": "counts=1000000",
    "MotionlessNoBumper": f"testbed(robot({FINEST}))",
    "MotionlessSpring": f"testbed(robot({FINEST}))",
    "MotionlessMagnetic": f"testbed(robot({FINEST}))",
    "MovingCollision": f"robot({FINEST})",
    "CirclePushed": f"robot({FINEST})",
}
STOP_S = {found.name.rsplit(".", 1)[1]: found.experiment[0] for found in classes() if found.experiment}


def signals(example: str) -> dict[str, str]:
    """Modelica name -> FMU name."""
    if example == "DrivetrainStep":
        return {
            "drivetrain.tau_s": "sensor.torque",
            "drivetrain.phi_m": "motor.angle",
            "drivetrain.motor.w": "motor.speed",
            "load.phi": "load.angle",
            "load.w": "load.speed",
        }
    inside = "testbed." if example.startswith("Motionless") else ""
    truth = "truth." if isinstance(RUNS[example], Alone) else "testbed.truth."
    names = {f"{inside}robot.{ours}": f"{truth}{theirs}" for ours, theirs in BASE.items()}
    if example in WITH_DUMMY:
        names |= {f"{inside}dummy.{ours}": f"{truth}{theirs}" for ours, theirs in DUMMY.items()}
    if example == "RollerWaves":
        names["robot.base.body.theta"] = "truth.theta"
    if example == "StaticPush":
        names |= {f"robot.base.wheel{i}.roller.f": f"truth.roller_force[{i}]" for i in (0, 1)}
    if isinstance(RUNS[example], Pair):
        names |= {f"{inside}robot.controller.{a}": f"controller.{b}" for a, b in REFERENCE.items()}
    return names


def simulated(compiler: Compiler, example: str, changes: str = "") -> Any:
    both = ", ".join(text for text in (CHANGES.get(example, ""), changes) if text)
    return compiler.simulate(f"GiveWay.Examples.{example}", both, 1e-9 if isinstance(RUNS[example], Alone) else None)


def excesses(result: Any, beside: Mapping[str, Array], example: str, height: float, until_s: float) -> dict[str, float]:
    """Per signal, how far it leaves its tube up to ``until_s``, over its largest magnitude; negative: inside.

    Torques of the three wheels have one magnitude, and so have the components of a vector: one may be zero by symmetry.
    """
    time_s = beside["time"]
    rows = time_s <= until_s
    names = signals(example)
    peaks = {ours: float(np.abs(beside[theirs]).max()) for ours, theirs in names.items()}
    found = {}
    for ours, theirs in names.items():
        kind = ours.rstrip("xy[123]")
        scale = max(peak for other, peak in peaks.items() if other.rstrip("xy[123]") == kind)
        values = at(np.asarray(result.time), np.asarray(result[ours]), time_s[rows])
        kicked, kicked_height = KICKED.get(example, ("", 0.0))
        share = max(height, kicked_height) if kind == kicked else height
        tube_height = share * (scale or 1.0)
        found[ours] = excess(time_s[rows], values, time_s, beside[theirs], TUBE_S, tube_height).value / (scale or 1.0)
    return found


@pytest.fixture(scope="module")
def fmu_runs() -> dict[str, dict[str, Array]]:
    return {name: run.run(STOP_S[name]) for name, run in RUNS.items()}


@pytest.mark.parametrize("example", RUNS)
def test_trajectories_lie_in_the_tube(compiler: Compiler, fmu_runs: dict[str, dict[str, Array]], example: str) -> None:
    result, beside = simulated(compiler, example), fmu_runs[example]
    height = SAMPLED if example in CHANGES else SMOOTH
    outside = excesses(result, beside, example, height, STOP_S[example])
    assert {name: value for name, value in outside.items() if value > 0.0} == {}
    if isinstance(RUNS[example], Pair):
        prefix = "testbed.robot" if example.startswith("Motionless") else "robot"
        hits = [
            set(trace[trace >= 0])
            for trace in (result[f"{prefix}.controller.hit_tick"], beside["controller.detection.tick"])
        ]
        assert hits[0] == hits[1]
        assert hits[0]
        # Until something happens the motion is smooth.
        quiet = excesses(result, beside, example, SMOOTH, 1e-3 * min(hits[0]))
        assert {name: value for name, value in quiet.items() if name.endswith(MOTION) and value > 0.0} == {}


def test_the_latch_lets_go_and_takes_hold_at_the_same_instants(
    compiler: Compiler, fmu_runs: dict[str, dict[str, Array]]
) -> None:
    result, beside = simulated(compiler, "LatchRelease"), fmu_runs["LatchRelease"]
    latched = beside["truth.latched"]
    changes = np.flatnonzero(np.diff(latched)) + 1
    released, held = changes[latched[changes] < 0.5], changes[latched[changes] > 0.5]
    assert len(released) == len(held) == 1
    for name, row in (("t_release", released[0]), ("t_latch", held[0])):
        found = {value for value in result[f"dummy.slider.bumper.{name}"] if value >= 0.0}
        assert len(found) == 1
        # Nothing else happens within these steps of the FMU, so that its last event is this one.
        assert found.pop() == pytest.approx(beside["last_event_time"][row], abs=EVENT_S)


def test_gears_stick_and_slide_at_the_same_time(compiler: Compiler, fmu_runs: dict[str, dict[str, Array]]) -> None:
    result, beside = simulated(compiler, "DrivetrainStep"), fmu_runs["DrivetrainStep"]
    stuck = at(np.asarray(result.time), np.asarray(result["drivetrain.motor.direction"]), beside["time"]) == 0
    # At t = 0.05 s and the like the FMU's row is before the new torque, Modelica's after it.
    assert np.flatnonzero(stuck != (beside["gear.stuck"] > 0.5)).tolist() in ([], [50])
    assert 0 < stuck.sum() < len(stuck)


@pytest.mark.parametrize(
    ("example", "fault"),
    [
        ("DrivetrainStep", "robot(drivetrain_stiffness=721.1)"),
        ("StaticPush", "data(roller_presliding_stiffness=28903)"),
        ("LatchRelease", "data(bumper_latch_force=45.81)"),
        ("RollerWaves", "data(roller_coulomb_torque=0.2002)"),
        ("MovingCollision", "dummy(contact(e=0.301))"),
        ("CirclePushed", "first(f_y=-34.05)"),
    ],
)
def test_a_small_fault_leaves_the_tube(
    compiler: Compiler, fmu_runs: dict[str, dict[str, Array]], example: str, fault: str
) -> None:
    result = simulated(compiler, example, fault)
    outside = excesses(result, fmu_runs[example], example, SAMPLED if example in CHANGES else SMOOTH, STOP_S[example])
    assert max(outside.values()) > 0.0
