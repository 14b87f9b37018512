"""Along the motion of the bench examples the bumper's force is that of the bumper FMU."""

import numpy as np
import pytest
from giveway import native
from giveway.fmu import Instance, open_fmu
from giveway.variables import table
from giveway_modelica.compiler import Compiler
from giveway_modelica.fmu_runs import TIGHT

STEP_S = 1e-6  # the FMU moves its faces on by one step: they start behind where they shall be
SETS = ("carrier.position", "carrier.velocity", "plate.position", "plate.velocity")


def fmu_force(carrier_m: np.ndarray, carrier_mps: np.ndarray, plate_m: np.ndarray, plate_mps: np.ndarray) -> np.ndarray:
    """The force that drives the faces apart at each row of their motion, N."""
    variables = table("bumper")
    motion = np.stack([carrier_m - STEP_S * carrier_mps, carrier_mps, plate_m - STEP_S * plate_mps, plate_mps], axis=1)
    force = np.zeros(1)
    found = []
    with Instance(open_fmu(native.fmu("bumper", 3)), "bumper") as instance:
        instance.initialise({**TIGHT, "bumper.kind": 2, "bumper.latch_model": 0}, variables)
        put = instance.setter("real", [variables[name].reference for name in SETS])
        get = instance.getter("real", [variables["plate.force"].reference])
        step = instance.stepper()
        for k, row in enumerate(np.ascontiguousarray(motion)):
            instance.check(put(row.ctypes.data) | step(k * STEP_S, STEP_S) | get(force.ctypes.data), k * STEP_S)
            found.append(force[0])
    return np.array(found)


@pytest.mark.parametrize("example", ["BumperDrop", "BumperSweep"])
def test_the_force_is_that_of_the_fmu(compiler: Compiler, example: str) -> None:
    result = compiler.simulate(f"GiveWay.Examples.{example}")
    s, c, v, u = (np.asarray(result[f"slider.{name}"]) for name in ("s", "bumper.c", "v", "bumper.u"))
    ours = np.asarray(result["slider.bumper.f"])
    theirs = fmu_force(s, v, s - c, v - u)
    assert c.max() > 0.02  # it strokes,
    assert c.min() < 0.0  # and rests on its end stop
    # Of the largest force: rounding of positions near 1e-16 m on an end stop of 2e5 N/m, and of the step.
    assert np.abs(ours - theirs).max() < 1e-9 * np.abs(theirs).max()


def test_another_law_has_another_force(compiler: Compiler) -> None:
    result = compiler.simulate("GiveWay.Examples.BumperSweep", "g_0=0.00101")
    s, c, v, u = (np.asarray(result[f"slider.{name}"]) for name in ("s", "bumper.c", "v", "bumper.u"))
    theirs = fmu_force(s, v, s - c, v - u)
    assert np.abs(np.asarray(result["slider.bumper.f"]) - theirs).max() > 1e-4 * np.abs(theirs).max()
