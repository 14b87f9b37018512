"""A robot that feels by its motors' currents, in both formulations; how the FMU samples them is tested with it."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
from giveway_modelica.agreement import CHANGES, SAMPLED, STOP_S, Array, beside, heights, signals
from giveway_modelica.compiler import Compiler, simulated
from giveway_modelica.fmu_runs import RESOLUTION_NM, RUNS, TESTBED, TOLERANCE, Alone, Pair, in_double

EXAMPLE = "CirclePushed"  # gears stick, slide one way and turn round
BY_CURRENT = {"drivetrain.sensing": 1}
WHEELS = range(3)


@pytest.fixture(scope="module")
def driven(compiler: Compiler) -> Any:
    inside = CHANGES[EXAMPLE].removesuffix(")")
    return compiler.simulate(f"GiveWay.Examples.{EXAMPLE}", f"{inside}, motor_current=true)", TOLERANCE)


@pytest.fixture(scope="module")
def reference() -> dict[str, Array]:
    run = RUNS[EXAMPLE]
    assert isinstance(run, Pair)
    with in_double():
        return dataclasses.replace(run, testbed={**run.testbed, **BY_CURRENT}).run(STOP_S[EXAMPLE])


def test_the_closed_loop_lies_in_the_tube(driven: Any, reference: dict[str, Array]) -> None:
    """Bound as with torque sensors; found: 2e-9. The paper's reflex knows no gears."""
    assert max(heights(driven, reference, signals(EXAMPLE)).values()) < SAMPLED
    ours, theirs = set(driven["robot.controller.hit_tick"]), set(reference["controller.detection.tick"])
    assert ours == theirs
    assert len(ours) > 2


def test_the_signal_is_the_testbeds(driven: Any, reference: dict[str, Array]) -> None:
    """Every sample as it arrives, to a few steps of the resolution."""
    tick = np.asarray(driven["robot.controller.tick"])
    last = np.flatnonzero(np.diff(tick, append=np.inf))  # of each sample's rows, behind its event
    for i in WHEELS:
        ours = np.asarray(driven[f"robot.controller.tau[{i + 1}]"])[last]
        theirs = reference[f"testbed.sensor.torque[{i}]"]
        assert len(ours) == len(theirs)
        assert np.abs(theirs).max() > 10.0  # the gear's friction and the servo's kicks
        assert np.abs(ours - theirs).max() < 3.0 * RESOLUTION_NM


def test_a_robot_with_torque_sensors_does_another_thing(driven: Any) -> None:
    assert max(heights(driven, beside(EXAMPLE), signals(EXAMPLE)).values()) > SAMPLED


def test_a_start_in_motion_has_its_steady_current(compiler: Compiler) -> None:
    """Two samples are on the bus: that of before the start, and the start's own, before the servo acts."""
    start = {"v_x": 0.11, "v_y": 0.2, "omega": 0.3}
    scales = (0.5, 0.7, 1.3)
    ours = ", ".join(f"{name}_start={value}" for name, value in start.items())
    text = (
        f"  GiveWay.Components.ControlledRobot robot({ours}, gear_scale={{{', '.join(map(str, scales))}}},"
        f" tare_ticks=0, resolution={RESOLUTION_NM}, motor_current=true);\n"
    )
    result = simulated(compiler.load_text(text, "start by current"), 2e-3, TOLERANCE)
    theirs = Alone(
        "testbed",
        {
            **{**TESTBED, **BY_CURRENT, "slider.present": False},
            **{f"start.{name.replace('_', '')}": value for name, value in start.items()},
            **{f"drivetrain.friction_scale[{i}]": value for i, value in enumerate(scales)},
        },
        lambda t: {"command.enable": 1.0},
        tuple(f"sensor.torque[{i}]" for i in WHEELS),
    ).run(1e-3)
    tick = np.asarray(result["robot.controller.tick"])
    for i in WHEELS:
        arrived = np.asarray(result[f"robot.controller.tau[{i + 1}]"])
        expected = theirs[f"sensor.torque[{i}]"]
        assert np.abs(expected).min() > 0.5
        for sample in (0, 1):
            assert np.abs(arrived[tick == sample] - expected[sample]).max() < 3.0 * RESOLUTION_NM
