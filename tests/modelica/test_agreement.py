"""The Modelica package and the FMUs are two statements of one plant: their trajectories are the same."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from giveway_modelica.agreement import SMOOTH, STOP_S, beside, heights, outside, signals, simulated
from giveway_modelica.compiler import Compiler
from giveway_modelica.fmu_runs import RUNS, TOLERANCE, Alone, Pair, in_double
from giveway_modelica.tube import at

EVENT_S = 1e-6  # of locating an event; both solvers find it to some 1e-8 s
SHORT = [example for example in RUNS if example != "CircleRound"]  # test_circle_round.py
PAIRS = [example for example in SHORT if isinstance(RUNS[example], Pair)]


@pytest.mark.parametrize("example", SHORT)
def test_trajectories_lie_in_the_tube(compiler: Compiler, example: str) -> None:
    assert outside(simulated(compiler, example), example) == {}


@pytest.mark.parametrize("example", PAIRS)
def test_trajectories_lie_in_the_tube_around_the_shipped_fmus(compiler: Compiler, example: str) -> None:
    assert outside(simulated(compiler, example), example, shipped=True) == {}


@pytest.mark.parametrize("example", PAIRS)
def test_hits_are_noticed_with_the_same_sample(compiler: Compiler, example: str) -> None:
    result, reference = simulated(compiler, example), beside(example)
    prefix = "testbed.robot" if example.startswith("Motionless") else "robot"
    theirs = "controller.detection.tick"
    traces = result[f"{prefix}.controller.hit_tick"], reference[theirs], beside(example, shipped=True)[theirs]
    ours, *others = (set(trace[trace >= 0]) for trace in traces)
    assert others == [ours, ours]
    assert ours
    # Until something happens everything is smooth.
    quiet = heights(result, reference, signals(example), 1e-3 * min(ours))
    assert max(quiet.values()) < SMOOTH


def test_the_latch_lets_go_and_takes_hold_at_the_same_instants(compiler: Compiler) -> None:
    result, reference = simulated(compiler, "LatchRelease"), beside("LatchRelease")
    latched = reference["truth.latched"]
    changes = np.flatnonzero(np.diff(latched)) + 1
    released, held = changes[latched[changes] < 0.5], changes[latched[changes] > 0.5]
    assert len(released) == len(held) == 1
    for name, row in (("t_release", released[0]), ("t_latch", held[0])):
        instants = {value for value in result[f"dummy.slider.bumper.{name}"] if value >= 0.0}
        assert len(instants) == 1
        # Nothing else happens within these steps of the FMU, so that its last event is this one.
        assert instants.pop() == pytest.approx(reference["last_event_time"][row], abs=EVENT_S)


def test_gears_stick_and_slide_at_the_same_time(compiler: Compiler) -> None:
    result, reference = simulated(compiler, "DrivetrainStep"), beside("DrivetrainStep")
    stuck = at(np.asarray(result.time), np.asarray(result["drivetrain.motor.direction"]), reference["time"]) == 0
    # At t = 0.05 s and the like the FMU's row is before the new torque, Modelica's after it.
    assert np.flatnonzero(stuck != (reference["gear.stuck"] > 0.5)).tolist() in ([], [50])
    assert 0 < stuck.sum() < len(stuck)


@pytest.mark.parametrize(
    ("example", "fault"),
    [
        ("DrivetrainStep", "robot(drivetrain_stiffness=721.1)"),
        ("StaticPush", "data(roller_presliding_stiffness=28903)"),
        ("LatchRelease", "data(bumper_latch_force=45.81)"),
        pytest.param("RollerWaves", "robot(data(roller_coulomb_torque=0.2002))", marks=pytest.mark.deep),
        pytest.param("MovingCollision", "dummy(contact(e=0.301))", marks=pytest.mark.deep),
        ("BumperDrop", "floor(e=0.301)"),
        ("BumperSweep", "g_0=0.00100002"),
        ("BumperFoam", "h=0.15001"),
        ("BumperGas", "n=1.3001"),
        ("BumperDamper", "rebound=3.001"),
        ("BumperSeries", "travel_1=0.030005"),
        ("BumperLever", "m_lever=0.3005"),
        ("BumperTable", "travels={0, 0.02, 0.05001, 0.09, 0.13}"),
        pytest.param("CirclePushed", "first(f_y=-34.05)", marks=pytest.mark.deep),
    ],
)
def test_a_small_fault_leaves_the_tube(compiler: Compiler, example: str, fault: str) -> None:
    assert outside(simulated(compiler, example, fault), example)


def test_a_robot_that_differs_from_its_drawing_is_the_same_in_both(compiler: Compiler) -> None:
    """Its mass beside the middle, on a floor that falls, every wheel's friction its own; pushed until gears slide."""
    run = RUNS["StaticPush"]
    assert isinstance(run, Alone)
    scales = {"roller": (0.8, 1.2, 1.1), "gear": (0.5, 0.7, 0.4)}
    uneven = {
        **{f"roller.friction_scale[{i}]": value for i, value in enumerate(scales["roller"])},
        **{f"drivetrain.friction_scale[{i}]": value for i, value in enumerate(scales["gear"])},
        **{"base.com_x": 0.03, "base.com_y": -0.02, "floor.slope": 0.02, "floor.azimuth": 2.0},
    }
    harder = dataclasses.replace(
        run,
        parameters={**run.parameters, **uneven},
        inputs=lambda t: {name: value * (8.0 if "force" in name else 1.0) for name, value in run.inputs(t).items()},
    )
    ours = ", ".join(f"{part}_scale={{{', '.join(map(str, values))}}}" for part, values in scales.items())
    result = compiler.simulate(
        "GiveWay.Examples.StaticPush", f"f=80, robot({ours}, c_x=0.03, c_y=-0.02, slope=0.02, downhill=2)", TOLERANCE
    )
    with in_double():
        reference = harder.run(STOP_S["StaticPush"])
    assert np.abs(reference["truth.x"]).max() > 0.03  # its gears slid
    assert max(heights(result, reference, signals("StaticPush")).values()) < SMOOTH
