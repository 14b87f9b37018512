"""The runs on every platform: a coupled collision, and each component alone."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from giveway.experiments import get
from giveway.simulation.master import COMMANDS, SENSORS

from .plan import Fmu, Plan

__all__ = ["CONTROLLER", "all_runs", "replay"]

CONTROLLER, TESTBED = 0, 1
STEP_S = 1e-3
STEPS = 1000


def _fmu(folder: Path, model: str) -> Fmu:
    return Fmu.open(folder / f"giveway_{model}_fmi3.fmu")


def _collision(folder: Path, changes: Mapping[str, float]) -> Plan:
    """5.2 with the magnetic bumper, controller and testbed coupled: hit, detection, escape."""
    make = get("motionless").scenario
    assert make is not None
    scenario = make("magnetic")
    plan = Plan([_fmu(folder, "controller"), _fmu(folder, "testbed")], STEPS, STEP_S)
    plan.set(CONTROLLER, scenario.parameters("controller"))
    plan.set(TESTBED, {**scenario.parameters("testbed"), **changes})
    for names in SENSORS.values():
        plan.connect(TESTBED, CONTROLLER, names)
    for names in COMMANDS.values():
        plan.connect(CONTROLLER, TESTBED, names)
    plan.read_all()
    return plan


def replay(folder: Path, collision: Plan, outputs: Mapping[tuple[int, str], np.ndarray], nudge: float = 0.0) -> Plan:
    """The controller alone with the sensor values of a recorded collision; ``nudge`` (N m) changes one of them."""
    plan = Plan([_fmu(folder, "controller")], STEPS, STEP_S)
    plan.lines = [line for line in collision.lines if line.startswith(f"set {CONTROLLER} ")]
    for names in SENSORS.values():
        for name in names:
            # The controller's input at t_k is the testbed's output at the end of the previous step.
            values = outputs[TESTBED, name]
            start = [1.0 if name == "sensor.present" else 0.0]
            column = [*start, *values[:-1].tolist()]
            if name == "sensor.torque[0]":
                column[STEPS // 2] += nudge
            plan.drive(CONTROLLER, name, column)
    plan.read_all()
    return plan


def _drivetrain(folder: Path, changes: Mapping[str, float]) -> Plan:
    """Torques with jumps on motor and load."""
    plan = Plan([_fmu(folder, "drivetrain")], STEPS, STEP_S)
    plan.set(0, changes)
    time = np.arange(STEPS) * STEP_S
    plan.drive(0, "motor.torque", 6.0 * np.sign(np.sin(2 * np.pi * 3.0 * time + 0.3)))
    plan.drive(0, "environment.torque", 2.0 * np.sign(np.sin(2 * np.pi * 7.0 * time)))
    plan.read_all()
    return plan


def _bumper(folder: Path, changes: Mapping[str, float]) -> Plan:
    """A plate is pushed in and released to its stop, past the latch."""
    plan = Plan([_fmu(folder, "bumper")], STEPS, STEP_S)
    plan.set(0, {"bumper.kind": 2, **changes})
    time = np.arange(STEPS) * STEP_S
    rate = 2 * np.pi * 2.0
    plan.drive(0, "plate.position", -0.03 * (1.0 - np.cos(rate * time)) + 0.002)
    plan.drive(0, "plate.velocity", -0.03 * rate * np.sin(rate * time))
    plan.read_all()
    return plan


def all_runs(folder: Path, scale: float = 1.0) -> dict[str, Plan]:
    """Plans by name for the FMUs in ``folder``; ``scale`` multiplies one stiffness of each: a planted fault."""
    stiffness = {"testbed": "contact.stiffness", "drivetrain": "drivetrain.stiffness", "bumper": "bumper.spring_rate"}
    changes: dict[str, dict[str, float]] = {}
    for model, name in stiffness.items():
        changes[model] = {} if scale == 1.0 else {name: scale * _fmu(folder, model).starts[name]}
    return {
        "collision": _collision(folder, changes["testbed"]),
        "drivetrain": _drivetrain(folder, changes["drivetrain"]),
        "bumper": _bumper(folder, changes["bumper"]),
    }
