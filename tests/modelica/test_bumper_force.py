"""Along the motion of the bench examples the bumper's force is that of the bumper FMU."""

import numpy as np
import pytest
from giveway_modelica.agreement import STOP_S
from giveway_modelica.bench import ROBOT, Bench, bumper_force
from giveway_modelica.compiler import Compiler
from giveway_modelica.fmu_runs import RUNS
from giveway_modelica.robot_record import numbers
from scipy.interpolate import CubicHermiteSpline

EVENT_S = 1e-6  # as the latch's


def fmu_force(
    example: str, carrier_m: np.ndarray, carrier_mps: np.ndarray, plate_m: np.ndarray, plate_mps: np.ndarray
) -> np.ndarray:
    """The force that drives the faces apart at each row of their motion, N."""
    bench = RUNS[example]
    assert isinstance(bench, Bench)
    with bumper_force(bench.bumper) as law:
        return np.array([law(*row) for row in zip(carrier_m, carrier_mps, plate_m, plate_mps, strict=True)])


@pytest.mark.parametrize("example", [example for example, run in RUNS.items() if isinstance(run, Bench)])
def test_the_force_is_that_of_the_fmu(compiler: Compiler, example: str) -> None:
    result = compiler.simulate(f"GiveWay.Examples.{example}")
    s, c, v, u = (np.asarray(result[f"slider.{name}"]) for name in ("s", "bumper.c", "v", "bumper.u"))
    # The FMU has no inertia between its faces.
    ours = np.asarray(result["slider.bumper.f_slow" if example == "BumperLever" else "slider.bumper.f"])
    theirs = fmu_force(example, s, v, s - c, v - u)
    assert c.max() > 0.02  # it strokes,
    assert c.min() < 0.0  # and rests on its end stop
    # Of the largest force: rounding of positions near 1e-16 m on an end stop of 2e5 N/m, and of the step.
    assert np.abs(ours - theirs).max() < 1e-9 * np.abs(theirs).max()


def test_another_law_has_another_force(compiler: Compiler) -> None:
    result = compiler.simulate("GiveWay.Examples.BumperSweep", "g_0=0.00101")
    s, c, v, u = (np.asarray(result[f"slider.{name}"]) for name in ("s", "bumper.c", "v", "bumper.u"))
    theirs = fmu_force("BumperSweep", s, v, s - c, v - u)
    assert np.abs(np.asarray(result["slider.bumper.f"]) - theirs).max() > 1e-4 * np.abs(theirs).max()


def test_the_magnet_lets_go_and_takes_hold_at_the_same_instants(compiler: Compiler) -> None:
    """Its gap passes g_0, where a quarter of its force is left: out, and back in the rebound."""
    result = compiler.simulate("GiveWay.Examples.BumperSweep", tolerance=1e-9, interval_s=1e-4)
    time_s, first = np.unique(np.asarray(result.time), return_index=True)
    c, u = (np.asarray(result[f"slider.bumper.{name}"])[first] for name in "cu")
    gap_m = dict(numbers(ROBOT))["bumper_latch_gap"].values[0]
    ours = CubicHermiteSpline(time_s, c - gap_m, u).roots(extrapolate=False)
    beside = RUNS["BumperSweep"].run(STOP_S["BumperSweep"])
    assert len(beside["opening"]) == len(beside["closing"]) == 1
    assert ours == pytest.approx(np.concatenate((beside["opening"], beside["closing"])), abs=EVENT_S)
