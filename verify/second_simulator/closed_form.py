"""The second robot against formulas: what it has to give before its answers count.

Each check runs the robot without the controller and compares one number with a formula in the testbed's parameters.
A planted fault builds the robot from other parameters than the formula has.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from giveway.scenario.plan import Straight

from verify.second_simulator.faults import FAULTS
from verify.second_simulator.loop import TICK_S, Hit, Plant
from verify.second_simulator.mjcf import (
    AZIMUTHS_RAD,
    GRAVITY_MPS2,
    ROLLER_STIFFNESS,
    WHEELS,
    SecondRobot,
    build,
    roller_half_length_m,
    rollers,
    row_place_m,
    wheel_mass_kg,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["CHECKS", "Finding", "check_all"]

Parameters = Mapping[str, Any]


@dataclass(frozen=True)
class Finding:
    name: str
    found: float
    expected: float
    share: float  # allowed difference, relative

    @property
    def holds(self) -> bool:
        return bool(abs(self.found - self.expected) <= self.share * abs(self.expected))

    def line(self) -> str:
        off = 100.0 * (self.found / self.expected - 1.0)
        verdict = "" if self.holds else "  WRONG"
        both = f"{self.found:.5g}, formula {self.expected:.5g}"
        return f"{self.name}: {both}: {off:+.2f} % of {100.0 * self.share:g} %{verdict}"


@dataclass(frozen=True)
class Bench:
    """``model``: parameters of the robot that is tried; ``formula``: those of the formulas."""

    model: Parameters
    formula: Parameters
    drives: Path
    step_s: float

    def plant(self, wheel_rad: float | None = None) -> Plant:
        quiet = {**self.model, "electronics.torque_noise": 0.0, "roller.friction_scatter": 0.0}
        plant = Plant(build(quiet, "none", self.step_s), self.drives, wheel_rad=wheel_rad)
        plant.settle()
        return plant


def jacobian(p: Parameters) -> NDArray[np.float64]:
    """J_w (13): wheel speeds from the base's, in the base's frame."""
    rows = [(-math.sin(a), math.cos(a), p["wheel.distance"]) for a in AZIMUTHS_RAD]
    return np.array(rows) / float(p["wheel.radius"])


def _driven(plant: Plant, path: Straight, seconds: float, p: Parameters) -> NDArray[np.float64]:
    """The wheels follow ``path``. Per millisecond: torques, wheel angles, velocity of the centre of mass."""
    rows = []
    wheels = jacobian(p)
    command = np.zeros(2 * WHEELS)
    data, height = plant.data, p["base.com_height"]
    for planned in path(np.arange(round(seconds / TICK_S), dtype=np.float64) * TICK_S):
        command[:WHEELS] = (wheels @ planned[:3] + math.pi) % (2.0 * math.pi) - math.pi
        command[WHEELS:] = wheels @ planned[3:6]
        plant.sample()
        v, spin = data.qvel[:2], data.qvel[3:5]
        angles = data.qpos[plant.robot.wheel[0]]
        rows.append([*plant.torque, *angles, v[0] + spin[1] * height, v[1] - spin[0] * height])
        plant.advance(command.ctypes.data, True)
    return np.array(rows)


def weight(bench: Bench) -> list[Finding]:
    """The floor's springs carry the robot: three rollers in their middle."""
    plant = bench.plant(wheel_rad=0.0)
    p = bench.formula
    sag = p["base.mass"] * GRAVITY_MPS2 / (WHEELS * p["wheel.floor_stiffness"])
    # The wheels' own weight is not on the suspension, which is nearly all of it.
    sag *= 1.0 - (1.0 - 1.0 / ROLLER_STIFFNESS) * WHEELS * wheel_mass_kg(p) / p["base.mass"]
    return [Finding("sag on the floor, m", -float(plant.data.qpos[2]), sag, 0.01)]


def static_push(bench: Bench) -> list[Finding]:
    """Of a push on stuck rollers the wheels feel what their springs take beside the rollers'."""
    p = bench.formula
    plant = bench.plant(wheel_rad=0.0)  # elsewhere the rollers' shape adds the spring of a pendulum
    hold = np.zeros(2 * WHEELS)
    force, arm = 10.0, 0.15
    before = plant.torque.copy()
    plant.push[:] = 0.0, force, arm, 0.0
    total = []
    for tick in range(3000):
        plant.sample()
        plant.advance(hold.ctypes.data, True)
        if tick >= 2000:
            total.append(plant.torque - before)
    felt = -jacobian(p).T @ np.mean(total, axis=0)
    # The row of rollers that bears decides the lever.
    rolling = jacobian(p)
    rolling[:, 2] = (p["wheel.distance"] + _bearing_row(p, plant)) / p["wheel.radius"]
    along = np.array([(math.cos(a), math.sin(a), 0.0) for a in AZIMUTHS_RAD])
    bristles = np.diag([p[f"roller.presliding_stiffness[{i}]"] for i in range(WHEELS)])
    stiffness = p["drivetrain.stiffness"] * rolling.T @ rolling + along.T @ bristles @ along
    moved = np.linalg.solve(stiffness, [0.0, force, force * arm])
    wrench = jacobian(p).T @ (p["drivetrain.stiffness"] * rolling @ moved)
    # 1.5 %: friction that holds creeps, and the base leans.
    return [
        Finding("share of a static push that the wheels feel", felt[1] / force, wrench[1] / force, 0.015),
        Finding("moment of a static push, N m", felt[2], wrench[2], 0.015),
    ]


def _bearing_row(p: Parameters, plant: Plant) -> NDArray[np.float64]:
    """Where the row that bears is, along each axle from the wheel's middle, m."""
    division = 2.0 * math.pi / rollers(p)
    row = np.round(plant.data.qpos[plant.robot.wheel[0]] / division) % p["roller.rows"]
    return np.array([row_place_m(p, one) for one in row])


def _drag(p: Parameters, wheel_angle: NDArray[np.float64], direction: float) -> NDArray[np.float64]:
    """Friction of the rollers that bear against steady motion along ``direction``, N."""
    roller, radius = p["roller.radius"], p["wheel.radius"]
    half = roller_half_length_m(p)
    division = 2.0 * math.pi / rollers(p)
    load_n = p["base.mass"] * GRAVITY_MPS2 / WHEELS
    stiffness = ROLLER_STIFFNESS * p["wheel.floor_stiffness"]

    def reach_and_arm(angle: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """How far a roller whose middle is ``angle`` from the bottom reaches down, and its contact's arm about it."""
        c, s = np.cos(angle), np.sin(angle)
        root = np.sqrt((roller * c) ** 2 + (half * s) ** 2)
        return (radius - roller) * c + root, roller**2 * c / root

    first = np.abs((wheel_angle + 0.5 * division) % division - 0.5 * division)
    reach, arm = reach_and_arm(first)
    next_reach, next_arm = reach_and_arm(division - first)
    # The roller that reaches farther has half of the load and so of the friction, and more for what it reaches farther.
    most = np.minimum(0.5 + 0.5 * stiffness * (reach - next_reach) / load_n, 1.0)
    per_wheel = p["roller.coulomb_torque"] * (most / arm + (1.0 - most) / next_arm)
    return np.asarray((np.abs(np.cos(np.array(AZIMUTHS_RAD) - direction)) * per_wheel).sum(axis=1))


def drag_and_inertia(bench: Bench) -> list[Finding]:
    """Torques at constant speed are the rollers' friction; the rest while accelerating is (27)."""
    p = bench.formula
    path = Straight(1.0, direction_rad=math.radians(20.0), acceleration_mps2=1.0)
    plant = bench.plant()
    rows = _driven(plant, path, 3.3, p)
    wrench = rows[:, :WHEELS] @ jacobian(p)
    direction = np.array([math.cos(path.direction_rad), math.sin(path.direction_rad)])
    pull = wrench[:, :2] @ direction
    drag = _drag(p, rows[:, WHEELS : 2 * WHEELS], path.direction_rad)
    steady = slice(round((path.ramp_s + 0.7) / TICK_S), None)
    # By momentum, from where the rollers slip to after the ramp.
    speed = rows[:, 6:8] @ direction
    span = slice(round(0.2 * path.ramp_s / TICK_S), round((path.ramp_s + 0.3) / TICK_S))
    inertia = float((pull[span] - drag[span]).sum() * TICK_S / (speed[span.stop] - speed[span.start]))
    mass = (
        p["base.mass"]
        + 1.5 * p["wheel.inertia"] / p["wheel.radius"] ** 2
        + 1.5 * p["roller.inertia"] / p["roller.radius"] ** 2
    )
    # 3 %: at the hand-over the load shifts from one row to the other by degrees, and the base rocks.
    return [
        Finding("rollers' friction at 1 m/s, N", float(pull[steady].mean()), float(drag[steady].mean()), 0.03),
        Finding("inertia while accelerating (27), kg", inertia, mass, 0.03),
    ]


def gear(bench: Bench) -> list[Finding]:
    """A rotor at rest holds torques up to its friction; beyond, the rest accelerates it."""
    import mujoco

    p = bench.formula
    robot = build(bench.model, "none", bench.step_s)
    model = robot.model
    model.opt.gravity[2] = 0.0
    for name in range(WHEELS):
        model.tendon_stiffness[name] = model.tendon_damping[name] = 0.0
    data = mujoco.MjData(model)
    data.qpos[2] = 0.1
    dof = robot.rotor[1]
    data.qfrc_applied[dof[0]] = 0.9 * p["drivetrain.gear_coulomb"]
    data.qfrc_applied[dof[1]] = 2.0 * p["drivetrain.gear_coulomb"]
    steps = round(0.01 / bench.step_s)
    mujoco.mj_step(model, data, nstep=steps)
    speed = p["drivetrain.gear_coulomb"] / p["drivetrain.motor_inertia"] * steps * bench.step_s
    held = float(data.qvel[dof[0]])
    # 1 %: the base recoils, and the gear's viscous friction.
    return [
        Finding("rotor's speed after 10 ms of twice its friction, rad/s", float(data.qvel[dof[1]]), speed, 0.01),
        Finding("rotor held below its friction: 1 + rad/s", 1.0 + held, 1.0, 1e-4),
    ]


def hit(bench: Bench) -> list[Finding]:
    """The slider's lost momentum is the impulse on the robot; the force is that of the cover's spring at first."""
    p = bench.formula
    plant = bench.plant()
    robot: SecondRobot = plant.robot
    hold = np.zeros(2 * WHEELS)
    x, y = 0.088046, 0.1525
    plant.release(Hit(0.0, x, y, math.radians(-120.0), 0.5))
    speed_dof = robot.slider[1]
    before = float(plant.data.qvel[speed_dof])
    impulse = rubbed = 0.0
    touched = False
    for _ in range(600):
        plant.sample()
        fx, fy, _, _ = plant.contact()
        impulse += math.hypot(fx, fy) * TICK_S
        rubbed += math.copysign(p["slider.friction"], float(plant.data.qvel[speed_dof])) * TICK_S
        if touched and fx == fy == 0.0:
            break
        touched = touched or fx != 0.0
        plant.advance(hold.ctypes.data, True)
    lost = p["slider.mass"] * (before - float(plant.data.qvel[speed_dof])) - rubbed
    # 0.5 %: the force of a pulse of 90 ms is read once a millisecond.
    return [Finding("impulse of a hit, N s", impulse, lost, 0.005)]


CHECKS: Mapping[str, Callable[[Bench], list[Finding]]] = {
    "weight": weight,
    "static push": static_push,
    "drag and inertia": drag_and_inertia,
    "gear": gear,
    "hit": hit,
}


def with_factors(parameters: Parameters, factors: Mapping[str, float]) -> dict[str, Any]:
    """The parameters, some times a factor; "name[*]" is all of a list."""
    changed = dict(parameters)
    for name, factor in factors.items():
        stem = name.removesuffix("[*]")
        for key in [key for key in changed if key == name or (name != stem and key.startswith(f"{stem}["))]:
            changed[key] = changed[key] * factor
    return changed


def check_all(parameters: Parameters, drives: Path, step_s: float, fault: str | None = None) -> list[Finding]:
    """All findings; with a fault planted, those of the check that has to see it."""
    if fault is None:
        bench, checks = Bench(parameters, parameters, drives, step_s), tuple(CHECKS)
    else:
        name, _, factors = FAULTS[fault]
        bench, checks = Bench(with_factors(parameters, factors), parameters, drives, step_s), (name,)
    return [finding for check in checks for finding in CHECKS[check](bench)]
