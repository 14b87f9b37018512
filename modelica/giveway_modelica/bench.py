"""The bench of the bumper examples beside Modelica: two masses and a floor around the bumper FMU.

The FMU has the bumper and nothing else: it gives the force at every evaluation of an integration in double precision.
The masses are those of the plant (fmu/plant/README.md): carriage m - m_p and plate m_p on one rail. The floor's cover
is that of Hunt and Crossley.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from giveway.base import native
from giveway.base.gravity import GRAVITY_MPS2
from giveway.robot.variables import Value, table
from giveway.simulation.fmu import Instance, open_fmu

from giveway_modelica.robot_record import numbers

if TYPE_CHECKING:
    from numpy.typing import NDArray

ROBOT = Path(__file__).parents[2] / "robots" / "trikey.toml"
FACES = ("carrier.position", "carrier.velocity", "plate.position", "plate.velocity")
FMU_STEP_S = 1e-6  # the FMU moves its faces on by one step: they start behind where they shall be
TOLERANCE = 1e-9
CLOSED_M = 1e-3  # the magnet and the preload rest on an end stop that is much stiffer than this asks


class Force(Protocol):
    """Force in N that drives the faces apart, at their positions in m and velocities in m/s."""

    def __call__(self, carrier_m: float, carrier_mps: float, plate_m: float, plate_mps: float) -> float: ...


MAGNETIC: Mapping[str, Value] = {"bumper.kind": 2, "bumper.latch_model": 0}
"""Spring and magnet by its continuous law."""


@contextmanager
def bumper_force(parameters: Mapping[str, Value] = MAGNETIC) -> Iterator[Force]:
    """The force law of the bumper FMU with these ``parameters``."""
    variables = table("bumper")
    faces, force = np.zeros(4), np.zeros(1)
    calls = 0
    with Instance(open_fmu(native.fmu("bumper", 3)), "bumper") as instance:
        instance.initialise(dict(parameters), variables)
        put = instance.setter("real", [variables[name].reference for name in FACES])
        get = instance.getter("real", [variables["plate.force"].reference])
        step = instance.stepper()

        def law(carrier_m: float, carrier_mps: float, plate_m: float, plate_mps: float) -> float:
            nonlocal calls
            before_m = carrier_m - FMU_STEP_S * carrier_mps, plate_m - FMU_STEP_S * plate_mps
            faces[:] = before_m[0], carrier_mps, before_m[1], plate_mps
            now_s = calls * FMU_STEP_S
            instance.check(put(faces.ctypes.data) | step(now_s, FMU_STEP_S) | get(force.ctypes.data), now_s)
            calls += 1
            return float(force[0])

        yield law


@dataclass(frozen=True)
class Bench:
    """A mass with the bumper ahead that meets a floor.

    Attributes:
        floor_m: where that begins; v_mps: speed at the start; weight: the rail is vertical.
        bumper: parameters of the FMU; between_kg: inertance between plate and carriage, which the FMU does not have.
    """

    floor_m: float
    v_mps: float = 0.0
    weight: bool = False
    bumper: Mapping[str, Value] = field(default_factory=lambda: MAGNETIC)
    between_kg: float = 0.0

    def run(self, stop_s: float, step_s: float = 1e-3) -> dict[str, NDArray[np.float64]]:
        """Traces, and under "closing" and "opening" the times in s at which the magnet's gap passes g_0."""
        from scipy.integrate import solve_ivp
        from scipy.optimize import brentq

        known = {name: entry.values[0] for name, entry in numbers(ROBOT)}
        plate_kg = known["bumper_plate_mass"]
        carriage_kg = known["slider_mass"] - plate_kg
        drive_n = known["slider_mass"] * GRAVITY_MPS2 if self.weight else 0.0
        stiffness, damping = known["contact_stiffness"], known["contact_damping"]

        def floor_n(plate_m: float, plate_mps: float) -> float:
            depth_m = plate_m - self.floor_m
            return max(0.0, stiffness * depth_m * (1.0 + damping * plate_mps)) if depth_m > 0.0 else 0.0

        def gap(_t: float, y: Any) -> float:
            return float(y[0] - y[2] - known["bumper_latch_gap"])

        with bumper_force(self.bumper) as law:

            def pushed(y: Any) -> tuple[float, float]:
                """What the FMU's force leaves of the drive's, and the floor's of that, N."""
                force_n = law(*y)
                return drive_n - force_n, force_n - floor_n(y[2], y[3])

            def between(carriage_n: float, plate_n: float) -> float:
                """The inertance's force, N: it resists the acceleration between carriage and plate."""
                apart = carriage_n / carriage_kg - plate_n / plate_kg
                return self.between_kg * apart / (1.0 + self.between_kg * (1.0 / carriage_kg + 1.0 / plate_kg))

            def rates(_t: float, y: Any) -> list[float]:
                on = pushed(y)
                inner_n = between(*on)
                return [y[1], (on[0] - inner_n) / carriage_kg, y[3], (on[1] + inner_n) / plate_kg]

            closed_m = brentq(lambda c: law(c, 0.0, 0.0, 0.0), -CLOSED_M, 0.0, xtol=1e-16)
            start = [0.0, self.v_mps, -closed_m, self.v_mps]
            times = np.arange(round(stop_s / step_s) + 1) * step_s
            found = solve_ivp(
                rates, (0.0, times[-1]), start, "DOP853", times, rtol=TOLERANCE, atol=1e-11, events=gap, max_step=step_s
            )
            force = [law(*row) + between(*pushed(row)) for row in found.y.T]
        carrier, carrier_mps, plate, plate_mps = found.y
        passing = [float(y[1] - y[3]) for y in found.y_events[0]]
        return {
            "time": times,
            "carrier.position": carrier,
            "carrier.velocity": carrier_mps,
            "compression": carrier - plate,
            "plate.force": np.array(force),
            "floor.force": np.array([floor_n(*row) for row in zip(plate, plate_mps, strict=True)]),
            "opening": found.t_events[0][np.array(passing) > 0.0],
            "closing": found.t_events[0][np.array(passing) < 0.0],
        }
