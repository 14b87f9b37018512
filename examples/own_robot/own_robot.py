"""A robot of your own from pieces: three drivetrain FMUs, a bumper FMU, and rigid bodies that you write yourself.

    python own_robot.py

A slider of 9 kg with a magnetic bumper hits an unpowered base with three omni wheels. The same collision runs in the
testbed FMU, which solves everything together; the table shows the error of the pieces for several coupling steps.

Inputs and outputs of the pieces:
- A drivetrain takes torques (motor, environment) and gives the motion of its load. A base that rolls without slip would
have the same causality: forces in, motion out. Both cannot determine the motion, so the base has no state here: its
velocity follows from the three loads. Each load carries its share of the base's mass (`load.inertia`); the inertial
coupling between the wheels goes through `environment.torque`, with the accelerations of the previous step. This works
as long as the share of the other wheels is the smaller one, as for three wheels at 120 degrees, and it makes the
coupling explicit and of first order.
- The bumper takes the motion of its two faces and gives the force between them. Its neighbours, plate and carrier, are
  masses: forces in, motion out, as it should be.
"""

from __future__ import annotations

import shutil
import tempfile
from typing import Any

import fmpy
import numpy as np
from fmpy.fmi3 import FMU3Slave
from giveway.base import native
from numpy.typing import NDArray

SECONDS, REPORT_S = 0.3, 1e-3
SLIDER_SPEED = 0.5  # m/s
COUPLING_STEPS_S = (1e-3, 5e-4, 2e-4, 1e-4, 5e-5)
SIGNALS = ("base travel", "plate travel", "compression", "torque 1")
E = np.array([np.cos(-2 * np.pi / 3), np.sin(-2 * np.pi / 3)])  # the slider's direction; the blow is central

# The robot: what the testbed is built with (`giveway variables testbed`).
MASS, YAW_INERTIA, WHEEL_RADIUS, WHEEL_DISTANCE, WHEEL_INERTIA = 34.7, 1.31, 0.1016, 0.24, 0.002798
AZIMUTHS = np.array([0.0, 2 * np.pi / 3, 4 * np.pi / 3])
ROLLER_RADIUS, ROLLER_TORQUE, ROLLER_SLOPE = 0.009525, 0.2, 0.4
SLIDER_MASS, PLATE_MASS, RUN_UP = 9.08, 0.5, 0.0395
CONTACT_STIFFNESS, CONTACT_DAMPING = 10100.0, 0.3
# Latch and preload press the bumper this far into its end stop.
AT_REST = (45.8 + 2.0) / (200000.0 + 948.0)
# The testbed without the parts that this example leaves out: rope, rail friction, bristles of the rollers.
TESTBED = {
    "rope.attached": False, "slider.speed": SLIDER_SPEED, "slider.friction": 0.0, "roller.model": 1,
    "roller.inertia": 0.0, "bumper.kind": 2, "command.enable": False,
}  # fmt: skip


class Piece:
    """An FMI 3.0 Co-Simulation FMU by variable names."""

    def __init__(self, model: str, **start: float) -> None:
        path = str(native.fmu(model, 3))
        self.folder = fmpy.extract(path, unzipdir=tempfile.mkdtemp())
        description = fmpy.read_model_description(path, validate=False)
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.types = {v.name: v.type for v in description.modelVariables}
        self.fmu = FMU3Slave(
            guid=description.instantiationToken, unzipDirectory=self.folder, instanceName=model,
            modelIdentifier=description.coSimulation.modelIdentifier,
        )  # fmt: skip
        self.fmu.instantiate(loggingOn=True)
        for name, value in start.items():
            getattr(self.fmu, f"set{self.types[name]}")([self.references[name]], [value])
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def set(self, **values: float) -> None:
        self.fmu.setFloat64([self.references[name] for name in values], list(values.values()))

    def get(self, *names: str) -> list[float]:
        values: list[float] = self.fmu.getFloat64([self.references[name] for name in names])
        return values

    def step(self, time_s: float, step_s: float) -> None:
        self.fmu.doStep(time_s, step_s)

    def close(self) -> None:
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


def composed(step_s: float) -> NDArray[np.float64]:
    """`SIGNALS` every millisecond, shape (n, 4), from the pieces coupled every ``step_s`` seconds."""
    tangents = np.column_stack([-np.sin(AZIMUTHS), np.cos(AZIMUTHS)])
    normals = np.column_stack([np.cos(AZIMUTHS), np.sin(AZIMUTHS)])
    # Wheel speeds from the base's twist (vx, vy, omega), and the inverse.
    to_wheels = np.column_stack([tangents, np.full(3, WHEEL_DISTANCE)]) / WHEEL_RADIUS
    to_base = np.linalg.inv(to_wheels)
    inertia = to_base.T @ np.diag([MASS, MASS, YAW_INERTIA]) @ to_base  # of the base, reflected to the wheels
    own, others = np.diag(inertia), inertia - np.diag(np.diag(inertia))
    drivetrains = [Piece("drivetrain", **{"load.inertia": WHEEL_INERTIA + share}) for share in own]
    speeds_at_start = {"carrier.velocity": SLIDER_SPEED, "plate.velocity": SLIDER_SPEED}
    bumper = Piece("bumper", **{"bumper.kind": 2, "plate.position": AT_REST, **speeds_at_start})

    carrier, plate = np.array([0.0, SLIDER_SPEED]), np.array([AT_REST, SLIDER_SPEED])  # travel and speed along E
    pose = np.zeros(3)
    accelerations, speeds = np.zeros(3), np.zeros(3)
    every, rows = round(REPORT_S / step_s), []
    for k in range(round(SECONDS / step_s) + 1):
        twist = to_base @ speeds
        if k % every == 0:
            (torque,) = drivetrains[1].get("sensor.torque")
            rows.append([E @ pose[:2], plate[0], carrier[0] - plate[0], torque])
        # Present forces: contact between plate and base, rollers at the floor, bumper between plate and carrier.
        depth, rate = plate[0] - RUN_UP - E @ pose[:2], plate[1] - E @ twist[:2]
        contact = max(0.0, CONTACT_STIFFNESS * depth * (1.0 + CONTACT_DAMPING * rate)) if depth > 0.0 else 0.0
        sideways = normals @ twist[:2]
        rollers = ROLLER_TORQUE / ROLLER_RADIUS * np.tanh(ROLLER_SLOPE * sideways / ROLLER_RADIUS)
        force = contact * E - rollers @ normals
        environment = to_base.T @ np.array([*force, 0.0]) - others @ accelerations
        on_carrier, on_plate = bumper.get("carrier.force", "plate.force")
        # Everything moves on by one step.
        for drivetrain, torque in zip(drivetrains, environment, strict=True):
            drivetrain.set(**{"environment.torque": float(torque)})
            drivetrain.step(k * step_s, step_s)
        before, speeds = speeds, np.array([d.get("load.speed")[0] for d in drivetrains])
        accelerations = (speeds - before) / step_s
        pose += 0.5 * step_s * (twist + to_base @ speeds)
        _move(carrier, on_carrier / (SLIDER_MASS - PLATE_MASS), step_s)
        _move(plate, (on_plate - contact) / PLATE_MASS, step_s)
        bumper.step(k * step_s, step_s)
        bumper.set(**{"carrier.position": carrier[0], "carrier.velocity": carrier[1],
                      "plate.position": plate[0], "plate.velocity": plate[1]})  # fmt: skip
    for piece in (*drivetrains, bumper):
        piece.close()
    return np.array(rows)


def _move(body: NDArray[np.float64], acceleration: float, step_s: float) -> None:
    """Travel and speed after a step of constant acceleration."""
    body += np.array([body[1] * step_s + 0.5 * acceleration * step_s**2, acceleration * step_s])


def monolithic() -> NDArray[np.float64]:
    """The same from the testbed FMU, which solves everything together."""
    names = ["truth.x", "truth.y", "truth.slider_position", "truth.bumper_compression", "truth.wheel_torque[1]"]
    values: dict[str, Any] = dict(TESTBED)
    found = fmpy.simulate_fmu(
        str(native.fmu("testbed", 3)), validate=False, stop_time=SECONDS, output_interval=REPORT_S,
        fmi_type="CoSimulation", start_values=values, output=names,
    )  # fmt: skip
    x, y, slider, compression, torque = (found[name] for name in names)
    return np.column_stack([E[0] * x + E[1] * y, slider - compression, compression, torque])


def errors() -> dict[float, NDArray[np.float64]]:
    """Per coupling step, the largest deviation of each signal relative to its peak."""
    reference = monolithic()
    peaks = np.abs(reference).max(axis=0)
    return {step_s: np.abs(composed(step_s) - reference).max(axis=0) / peaks for step_s in COUPLING_STEPS_S}


def table() -> str:
    """The errors as lines of Markdown."""
    lines = [f"| coupling step | {' | '.join(SIGNALS)} |", "|---" * (1 + len(SIGNALS)) + "|"]
    for step_s, found in errors().items():
        lines.append(f"| {1e3 * step_s:g} ms | {' | '.join(f'{100 * error:.2f} %' for error in found)} |")
    return "\n".join(lines)


if __name__ == "__main__":
    print(table())
