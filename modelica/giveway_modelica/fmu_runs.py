"""The examples of the Modelica package as runs of the FMUs, with the same settings.

Noise is off. The quantisers of encoders and torque sensors are in both, at their finest: a count that flips one sample
earlier in one of the two would otherwise kick a motor by 2 N m for half a millisecond.

Even so it kicks by 0.015 N m, which rings on the sensor's spring, and the loop hands it on. The FMUs as they are
shipped compute wanted angles in single precision, to a sixth of such a count, so that many flip. `in_double` is for
what must not depend on that: the same sources, with the C library's real type a double.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import giveway
import numpy as np
from giveway.base import native
from giveway.robot.presets import PAPER, preset_values
from giveway.robot.variables import Value, table
from giveway.scenario.plan import Circle, Plan, Straight
from giveway.simulation.fmu import Instance, open_fmu
from giveway.simulation.master import simulate
from numpy.typing import NDArray

from giveway_modelica.bench import Bench

Array = NDArray[np.float64]
Inputs = Callable[[float], Mapping[str, float]]

COUNTS, RESOLUTION_NM = 1_000_000, 1e-9
FINEST = f"counts={COUNTS}, resolution={RESOLUTION_NM}"  # the same as a modification of ControlledRobot
# So tight that motor angles differ by less than 1e-5 of a count: then hardly any flips within seconds.
TOLERANCE = 1e-11
TIGHT: Mapping[str, Value] = {"solver.relative_tolerance": TOLERANCE, "solver.absolute_scale": 1e-5}
TESTBED: Mapping[str, Value] = {
    **TIGHT,
    "electronics.torque_noise": 0.0,
    "electronics.encoder_counts": COUNTS,
    "electronics.torque_resolution": RESOLUTION_NM,
}
CONTROLLER: Mapping[str, Value] = {
    **preset_values(PAPER),  # which is what the block is
    "estimator.encoder_counts": COUNTS,
    "sensor_check.encoder_jump": COUNTS,
}
SIDE_RAD = math.pi / 3.0
WHEEL_ANGLE = "controller.command.wheel_angle[0]"
HALF_TICK_S = 2.5e-4  # switches between two ticks, wherever rounding puts them
CIRCLE = Circle(1.5, 0.16, centre_y_m=0.75, start_rad=-0.5 * math.pi, acceleration_mps2=0.6)
MOVING_WAY_M = 0.22 * (0.5 * 0.5 * math.pi * 0.22 / 0.6 + 0.3)


TABLE: tuple[Sequence[float], Sequence[float], Sequence[Sequence[float]]] = (
    (0.0, 0.02, 0.05, 0.09, 0.13),
    (-0.5, 0.0, 0.5),
    ((0.0, 4.0, 7.0), (5.0, 15.0, 22.0), (12.0, 30.0, 44.0), (30.0, 60.0, 85.0), (90.0, 150.0, 200.0)),
)
"""Travels, speeds and forces of `BumperTable`."""

BUILD = Path(os.environ.get("GIVEWAY_BUILD_DIR", Path(__file__).parents[2] / "build"))


@contextmanager
def in_double() -> Iterator[None]:
    """Within it, controller and testbed FMU are those with the C library in double."""
    shipped = native.fmu

    def fmu(model: str, fmi_version: int) -> Path:
        built = BUILD / "tests" / "modelica" / f"giveway_{model}_fmi{fmi_version}.fmu"
        return built if model in native.MODELS else shipped(model, fmi_version)

    native.fmu = fmu
    try:
        yield
    finally:
        native.fmu = shipped


@dataclass(frozen=True)
class Alone:
    """One FMU, stepped through piecewise constant inputs.

    Attributes:
        outputs: what is read at every communication point.
    """

    model: str
    parameters: Mapping[str, Value]
    inputs: Inputs
    outputs: Sequence[str]

    def run(self, stop_s: float, step_s: float = 1e-3) -> dict[str, Array]:
        variables = table(self.model)
        with Instance(open_fmu(native.fmu(self.model, 3)), self.model) as instance:
            instance.initialise(dict(self.parameters), variables)
            step = instance.stepper()

            def exchange(verb: str, name: str, value: float = 0.0) -> float:
                variable = variables[name]
                buffer = np.array([value], dtype=instance.dtype(variable.type))
                port = instance.setter if verb == "set" else instance.getter
                instance.check(port(variable.type, [variable.reference])(buffer.ctypes.data), 0.0)
                return float(buffer[0])

            rows = []
            steps = round(stop_s / step_s)
            for k in range(steps + 1):
                for name, value in self.inputs(k * step_s).items():
                    exchange("set", name, value)
                rows.append([exchange("get", name) for name in self.outputs])
                if k < steps:
                    instance.check(step(k * step_s, step_s), k * step_s)
        found = dict(zip(self.outputs, np.array(rows).T, strict=True))
        return {**found, "time": np.arange(steps + 1) * step_s}


@dataclass(frozen=True)
class Pair:
    """Controller and testbed FMU, co-simulated; traces are named "testbed.truth.x"."""

    bumper: str = "magnetic"
    testbed: Mapping[str, Value] = field(default_factory=dict)
    plan: Plan = field(default_factory=giveway.scenario.plan.Rest)
    push: Callable[[Array], Array] | None = None
    controller: Mapping[str, Value] = field(default_factory=dict)

    def run(self, stop_s: float) -> dict[str, Array]:
        scenario = giveway.Scenario(
            "beside",
            stop_s,
            bumper=self.bumper,
            testbed={"slider.present": True, **TESTBED, **self.testbed},
            controller={**CONTROLLER, **self.controller},
            plan=self.plan,
            push=self.push,
        )
        record = simulate(scenario)
        found = {name: np.asarray(values, float) for name, values in record.traces.items()}
        found[WHEEL_ANGLE] = np.unwrap(found[WHEEL_ANGLE])  # the bus carries it within half a turn
        return {**found, "time": record.time_s}


def _steps(*levels: tuple[float, float]) -> Callable[[float], float]:
    """A staircase: each (from this time, this value)."""
    return lambda t: [value for since, value in levels if t >= since - HALF_TICK_S][-1]


_motor = _steps((0.0, 2.0), (0.05, 5.0), (0.25, -4.0), (0.5, 0.0))
_pushed = _steps((0.0, 0.0), (0.1, 1.0))


def _waves(*wheels: int) -> Alone:
    """These wheels move as in 4.2, the others stand."""
    omega = 2.0 * math.pi * 0.5

    def inputs(t: float) -> Mapping[str, float]:
        angle, speed = 1.5 * (1.0 - math.cos(omega * t)), 1.5 * omega * math.sin(omega * t)
        return {
            f"command.wheel_{name}[{i}]": value for i in wheels for name, value in (("angle", angle), ("speed", speed))
        }

    fixed = {"slider.present": False, "electronics.command_delay": 0}
    return Alone("testbed", {**TESTBED, **fixed}, inputs, _truth(*_BASE))


def _on(t: Array, begin_s: float, end_s: float, *push: float) -> Array:
    inside = (t >= begin_s - HALF_TICK_S) & (t < end_s - HALF_TICK_S)
    forces: Array = inside[:, None] * np.array(push)
    return forces


def two_pushes(t: Array) -> Array:
    """Force and point of the two pushes of `CirclePushed` at times ``t`` in s, shape (n, 4)."""
    return _on(t, 0.8, 1.0, -20.0, -34.0, 0.088046, 0.1525) + _on(t, 1.4, 1.6, 30.0, 0.0, -0.176092, 0.0)


def push_of_the_round(t: Array) -> Array:
    """The same of `CircleRound`."""
    return _on(t, 8.0, 8.2, -20.0, -34.0, 0.088046, 0.1525)


def _truth(*names: str) -> tuple[str, ...]:
    return tuple(f"truth.{name}" for name in names)


_BASE = ("x", "y", "theta", "wheel_torque[0]", "wheel_torque[1]", "wheel_torque[2]")

# What the examples of the other bumpers have, as parameters of the FMUs; 7 has a lever's inertia besides.
LAWS: Mapping[str, Mapping[str, Value]] = {
    "Foam": {
        "bumper.kind": 3,
        "bumper.foam_thickness": 0.15,
        "bumper.foam_force_25": 25.0,
        "bumper.foam_force_50": 45.0,
        "bumper.foam_force_75": 110.0,
        "bumper.foam_hysteresis": 0.3,
        "bumper.foam_rate_gain": 0.3,
    },
    "Gas": {
        "bumper.kind": 4,
        "bumper.gas_force": 20.0,
        "bumper.gas_length": 0.2,
        "bumper.gas_exponent": 1.3,
        "bumper.gas_ambient_force": 100.0,
    },
    "Damper": {
        "bumper.kind": 5,
        "bumper.spring_rate": 200.0,
        "bumper.preload": 4.0,
        "bumper.damper_rate": 60.0,
        "bumper.damper_square": 40.0,
        "bumper.damper_rebound": 3.0,
    },
    "Series": {
        "bumper.kind": 6,
        "bumper.spring_rate": 600.0,
        "bumper.preload": 2.0,
        "bumper.first_travel": 0.03,
        "bumper.second_rate": 2500.0,
        "bumper.second_preload": 15.0,
    },
    "Lever": {"bumper.kind": 7, "bumper.spring_rate": 400.0, "bumper.preload": 2.0, "bumper.lever_ratio": 1.5},
    "Table": {
        "bumper.kind": 8,
        "bumper.table_rows": len(TABLE[0]),
        "bumper.table_columns": len(TABLE[1]),
        **{f"bumper.table_travel[{i}]": travel for i, travel in enumerate(TABLE[0])},
        **{f"bumper.table_speed[{j}]": speed for j, speed in enumerate(TABLE[1])},
        **{f"bumper.table_force[{6 * i + j}]": force for i, row in enumerate(TABLE[2]) for j, force in enumerate(row)},
    },
}
LEVER_KG = 0.3
SPEEDS_MPS = {"Foam": 0.8, "Gas": 0.8, "Damper": 0.8, "Series": 0.6, "Lever": 0.6, "Table": 0.9}

RUNS: Mapping[str, Alone | Pair | Bench] = {
    "BumperDrop": Bench(floor_m=0.02, weight=True),
    "BumperSweep": Bench(floor_m=0.005, v_mps=0.5),
    **{
        f"Bumper{law}": Bench(0.005, SPEEDS_MPS[law], bumper=values, between_kg=LEVER_KG if law == "Lever" else 0.0)
        for law, values in LAWS.items()
    },
    "DrivetrainStep": Alone(
        "drivetrain",
        {**TIGHT, "load.inertia": 0.15, "load.coulomb": 0.2, "load.viscous": 0.02},
        lambda t: {"motor.torque": _motor(t)},
        ("sensor.torque", "motor.angle", "motor.speed", "load.angle", "load.speed", "gear.stuck"),
    ),
    "RollerWaves": _waves(0),
    "RollerWavesPair": _waves(0, 1),
    "StaticPush": Alone(
        "testbed",
        {**TESTBED, "slider.present": False},
        lambda t: {
            "command.enable": 0.0,
            "push.force_x": -5.0 * _pushed(t),
            "push.force_y": -8.660254037844386 * _pushed(t),
            "push.point_x": 0.088046,
            "push.point_y": 0.1525,
        },
        _truth(*_BASE, "roller_force[0]", "roller_force[1]"),
    ),
    "LatchRelease": Alone(
        "testbed",
        {**TESTBED, "bumper.latch_model": 1},
        lambda t: {"command.enable": 0.0},
        (*_truth(*_BASE, "slider_position", "bumper_compression", "contact_force", "latched"), "last_event_time"),
    ),
    "MotionlessNoBumper": Pair("none"),
    "MotionlessSpring": Pair("spring"),
    "MotionlessMagnetic": Pair("magnetic"),
    "MovingCollision": Pair(
        "magnetic",
        {
            "slider.mass": 13.62,
            "rope.attached": False,
            "slider.run_up": 0.0,
            "slider.target_x": 0.088046 + MOVING_WAY_M * math.cos(SIDE_RAD),
            "slider.target_y": 0.1525 + MOVING_WAY_M * math.sin(SIDE_RAD),
        },
        Straight(0.22, SIDE_RAD, acceleration_mps2=0.6),
    ),
    "CirclePushed": Pair("none", {"slider.present": False}, CIRCLE, two_pushes),
    "CircleRound": Pair(
        "none",
        {"slider.present": False},
        CIRCLE,
        push_of_the_round,
        # Not 0.1, which takes the reference exactly to creep_speed with some sample: rounding would decide with which.
        {"reference.acceleration_limit": 0.097},
    ),
}
