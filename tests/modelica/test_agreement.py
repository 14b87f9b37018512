"""The Modelica package and the FMUs are two statements of one plant: their trajectories are the same."""

from __future__ import annotations

import numpy as np
import pytest
from giveway_modelica.agreement import MOTION, SMOOTH, STOP_S, bound, heights, signals, simulated
from giveway_modelica.compiler import Compiler
from giveway_modelica.fmu_runs import RUNS, Array, Pair
from giveway_modelica.tube import at

EVENT_S = 1e-6  # of locating an event; both solvers find it to some 1e-8 s


@pytest.fixture(scope="module")
def fmu_runs() -> dict[str, dict[str, Array]]:
    return {name: run.run(STOP_S[name]) for name, run in RUNS.items()}


@pytest.mark.parametrize("example", RUNS)
def test_trajectories_lie_in_the_tube(compiler: Compiler, fmu_runs: dict[str, dict[str, Array]], example: str) -> None:
    result, beside = simulated(compiler, example), fmu_runs[example]
    found = heights(result, beside, signals(example), STOP_S[example])
    assert {group: height for group, height in found.items() if height > bound(example, group)} == {}
    if isinstance(RUNS[example], Pair):
        prefix = "testbed.robot" if example.startswith("Motionless") else "robot"
        hits = [
            set(trace[trace >= 0])
            for trace in (result[f"{prefix}.controller.hit_tick"], beside["controller.detection.tick"])
        ]
        assert hits[0] == hits[1]
        assert hits[0]
        # Until something happens the motion is smooth.
        moved = [one for one in signals(example) if one.group in MOTION]
        quiet = heights(result, beside, moved, 1e-3 * min(hits[0]))
        assert max(quiet.values()) < SMOOTH


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
        ("BumperDrop", "floor(e=0.301)"),
        ("BumperSweep", "g_0=0.00100002"),
        ("CirclePushed", "first(f_y=-34.05)"),
    ],
)
def test_a_small_fault_leaves_the_tube(
    compiler: Compiler, fmu_runs: dict[str, dict[str, Array]], example: str, fault: str
) -> None:
    result = simulated(compiler, example, fault)
    found = heights(result, fmu_runs[example], signals(example), STOP_S[example])
    assert any(height > bound(example, group) for group, height in found.items())
