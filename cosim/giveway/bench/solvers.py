"""Cost and error of the testbed's integration methods over stiffness.

One collision with the magnetic bumper, 1 s, the servos holding. Designs are made stiffer in two ways: `springs` makes
cover, bumper stops and drivetrain springs harder, `damper` the drivetrain's damping. The error of a run is against the
explicit method at a relative tolerance of 1e-11.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway.base import native
from giveway.robot.variables import Value, VariableTable, table
from giveway.simulation.fmu import Instance, open_fmu

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["HEADER", "METHODS", "SWEEPS", "Measurement", "measure_solvers"]

METHODS: Mapping[str, int] = {"ERK": 0, "Adams": 1, "BDF": 2}
SWEEPS: Mapping[str, tuple[tuple[str, ...], tuple[float, ...]]] = {
    "springs": (("contact.stiffness", "bumper.stop_stiffness", "drivetrain.stiffness"), (1.0, 10.0, 100.0, 1000.0)),
    "damper": (("drivetrain.damping",), (10.0, 100.0, 1000.0, 10000.0)),
}
SIMULATED_S, STEP_S = 1.0, 1e-3
REFERENCE_TOLERANCE = 1e-11
DEFAULT_TOLERANCE = 1e-6
# Each is judged relative to its largest value: motions, a torque, the push on the robot, and the lost energy. The blow
# is central, so the robot hardly turns: its angle would only show rounding.
SIGNALS = (
    "truth.x",
    "truth.slider_position",
    "truth.bumper_compression",
    "truth.wheel_torque[1]",
    "truth.contact_impulse_x",
    "energy.dissipated",
)
COUNTERS = ("solver.steps", "solver.rhs_calls", "solver.jacobian_calls")


HEADER = ("stiffer", "times", "method", "ms", "steps", "rhs calls", "Jacobians", "error")


@dataclass(frozen=True)
class Measurement:
    """One method on one design, at the default relative tolerance of 1e-6.

    Attributes:
        sweep: "springs" or "damper".
        scale: factor on the sweep's parameters.
        wall_ms: wall time inside the FMU per simulated second, the best of the repeats.
        error: the largest deviation of any signal, relative to that signal's largest value.
    """

    sweep: str
    scale: float
    method: str
    wall_ms: float
    steps: int
    rhs_calls: int
    jacobian_calls: int
    error: float

    @property
    def cells(self) -> tuple[str, ...]:
        """A row under `HEADER`."""
        counts = (f"{self.steps}", f"{self.rhs_calls}", f"{self.jacobian_calls}")
        return (self.sweep, f"{self.scale:g}", self.method, f"{self.wall_ms:.1f}", *counts, f"{self.error:.0e}")


def measure_solvers(repeats: int, fmi_version: int) -> list[Measurement]:
    """Every method on every design of both sweeps."""
    measurements = []
    for sweep, (_, scales) in SWEEPS.items():
        for scale in scales:
            design = _design(sweep, scale)
            reference = _run(design | _tolerance(REFERENCE_TOLERANCE), fmi_version)[0]
            peaks = np.abs(reference).max(axis=0)
            for method, number in METHODS.items():
                chosen = design | {"solver.method": number}
                runs = [_run(chosen, fmi_version) for _ in range(repeats)]
                trace, (steps, rhs_calls, jacobian_calls), _ = runs[0]
                error = float((np.abs(trace - reference).max(axis=0) / peaks).max())
                wall_ms = 1e3 * min(wall_s for *_, wall_s in runs) / SIMULATED_S
                found = Measurement(sweep, scale, method, wall_ms, steps, rhs_calls, jacobian_calls, error)
                measurements.append(found)
    return measurements


def _design(sweep: str, scale: float) -> dict[str, Value]:
    variables = table("testbed")
    design: dict[str, Value] = {
        "bumper.kind": 2,
        # Results that differ by far less than a count may still round to different counts: with fine counts this
        # matters little.
        "electronics.encoder_counts": 1_000_000,
    }
    for name in SWEEPS[sweep][0]:
        variable = variables[name]
        assert variable.start is not None
        design[name] = min(scale * variable.start, variable.maximum)
    return design


def _tolerance(relative: float) -> dict[str, Value]:
    """Both tolerances, tightened alike."""
    return {"solver.relative_tolerance": relative, "solver.absolute_scale": max(relative / DEFAULT_TOLERANCE, 1e-6)}


def _run(parameters: dict[str, Value], fmi_version: int) -> tuple[NDArray[np.float64], tuple[int, ...], float]:
    """Signals of shape (steps + 1, signals), counters, and the wall time inside doStep in s."""
    variables: VariableTable = table("testbed")
    file = open_fmu(native.fmu("testbed", fmi_version))
    file.check_matches(variables)
    rows = round(SIMULATED_S / STEP_S) + 1
    trace = np.zeros((rows, len(SIGNALS)))
    with Instance(file, "testbed") as instance:
        instance.initialise(variables.check_all(parameters), variables)
        read = instance.getter("real", [variables[name].reference for name in SIGNALS])
        step = instance.stepper()
        row_at, row_size = trace.ctypes.data, trace.strides[0]
        instance.check(read(row_at), 0.0)
        wall_s = 0.0
        for k in range(1, rows):
            started = time.perf_counter()
            status = step((k - 1) * STEP_S, STEP_S)
            wall_s += time.perf_counter() - started
            instance.check(status | read(row_at + k * row_size), k * STEP_S)
        counters = np.zeros(len(COUNTERS), dtype=np.int32)
        count = instance.getter("integer", [variables[name].reference for name in COUNTERS])
        instance.check(count(counters.ctypes.data), SIMULATED_S)
    return trace, tuple(int(value) for value in counters), wall_s
