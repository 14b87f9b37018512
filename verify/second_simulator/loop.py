"""The closed loop: robot and slider in MuJoCo, the drives of the testbed, and the controller FMU that users get.

Exchange once a millisecond, in the order of `giveway.simulation.master`: sensors, controller, command; the delays of
the bus are in the drives. The servos act twice in it, and MuJoCo steps in between.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np
from giveway.base import native
from giveway.robot.variables import table
from giveway.scenario.plan import PLAN_INPUTS, PUSH_INPUTS, Plan, Pushes, Rest, TimedPush
from giveway.simulation.fmu import Instance, open_fmu

from verify.second_simulator.electronics import Drives
from verify.second_simulator.mjcf import EACH, FAR_M, FILE, ROLLER_STIFFNESS, WHEELS, SecondRobot

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["TICK_S", "Hit", "Plant", "Run", "Traces", "simulate"]

TICK_S, SERVO_S = 1e-3, 0.5e-3
SETTLE_S, SETTLE_DAMPING = 0.4, (2e3, 2e3, 2e3, 200.0, 200.0, 200.0)  # N s/m, N m s/rad
GAP_M = 1e-4  # of the slider's nose when it is released: it is there within a millisecond

COMMANDS = (
    *(f"command.wheel_angle[{i}]" for i in range(WHEELS)),
    *(f"command.wheel_speed[{i}]" for i in range(WHEELS)),
)

Traces = Mapping[str, "NDArray[np.float64]"]
"""Named as those of `giveway run`; a row a millisecond: sensors at its beginning, the controller's answer."""


@dataclass(frozen=True)
class Hit:
    """The slider is put before a point of the outline and released.

    Attributes:
        time_s: of the release; the contact begins within a millisecond.
        x_m, y_m: the point, base frame.
        inward_rad: direction of travel, base frame.
        speed_mps: at which nose and outline approach each other along that direction.
    """

    time_s: float
    x_m: float
    y_m: float
    inward_rad: float
    speed_mps: float


@dataclass(frozen=True)
class Run:
    """What happens.

    Attributes:
        controller: settings by name.
        wiring: the wheel whose torque sensor the controller takes for that of each wheel.
        seed: of the sensors' noise, the encoders' phase within a count, and which part of which roller bears.
    """

    duration_s: float
    plan: Plan = field(default_factory=Rest)
    hits: tuple[Hit, ...] = ()
    pushes: tuple[TimedPush, ...] = ()
    controller: Mapping[str, Any] = field(default_factory=dict)
    seed: int = 1
    wiring: tuple[int, int, int] = (0, 1, 2)


class Plant:
    """The robot in MuJoCo with its drives, step by step; `simulate` puts a controller to it, the formulas do not."""

    def __init__(
        self, robot: SecondRobot, drives: Path, seed: int = 1, theta_rad: float = 0.0, wheel_rad: float | None = None
    ) -> None:
        self.robot, self.model = robot, robot.model
        self.data = mujoco.MjData(self.model)
        random = np.random.default_rng(seed)
        p = robot.parameters
        self.substeps = round(SERVO_S / self.model.opt.timestep)
        self._rotor_q, self._rotor_v = robot.rotor
        self._wheel_q, self._wheel_v = robot.wheel
        self._stiffness, self._damping = p["drivetrain.stiffness"], p["drivetrain.damping"]
        data = self.data
        turned = random.uniform(0.0, 2.0 * math.pi / p["roller.per_row"], WHEELS)  # which part of which roller bears
        if wheel_rad is not None:
            turned[:] = wheel_rad
        data.qpos[self._rotor_q] = data.qpos[self._wheel_q] = turned
        data.qpos[2] = -robot.sag_m / ROLLER_STIFFNESS
        data.qpos[robot.suspension] = 0.0
        data.qpos[3:7] = math.cos(0.5 * theta_rad), 0.0, 0.0, math.sin(0.5 * theta_rad)
        count = 2.0 * math.pi / p["electronics.encoder_counts"]
        self._zero = turned - count * random.uniform(0.0, 1.0, WHEELS)
        self.angle, self.torque = np.zeros(WHEELS), np.zeros(WHEELS)
        self.motor, self.sensed = np.zeros(WHEELS), np.zeros(WHEELS + 3)
        self.felt = np.zeros(4)
        self.counts = np.zeros(WHEELS + 3, dtype=np.int32)
        self._latch = None
        if robot.bumper == "magnetic":
            assert robot.plate is not None
            self._latch = (*robot.plate, p["bumper.latch_force"], 1.0 / p["bumper.latch_gap"])
        self.measure()
        self.drives = Drives(drives, p, seed, self.angle)
        self._at = {
            name: getattr(self, name).ctypes.data for name in ("angle", "torque", "motor", "felt", "sensed", "counts")
        }
        self._law, self._slope = robot.friction, p["roller.tanh_slope"]
        self._coulomb = self.model.dof_frictionloss.copy()
        self._per_stribeck = p["roller.radius"] / p["roller.stribeck_speed"]
        self._bearing: list[int] = []  # joints of the rollers on the floor
        self._force = np.zeros(6)
        self.push = np.zeros(4)  # force (world), point (base)

    def settle(self) -> None:
        """Let the robot sink into its wheels, held by its servos and by dampers that are then taken away."""
        hold = np.zeros(2 * WHEELS)
        dampers = self.model.dof_damping[:6].copy()
        self.model.dof_damping[:6] = SETTLE_DAMPING
        for _ in range(round(SETTLE_S / TICK_S)):
            self.sample()
            self.advance(hold.ctypes.data, True)
        self.model.dof_damping[:6] = dampers

    def measure(self) -> None:
        """The motors' angles and the torques on the wheels."""
        data = self.data
        rotor, wheel = data.qpos[self._rotor_q], data.qpos[self._wheel_q]
        self.angle[:] = rotor - self._zero
        self.torque[:] = self._stiffness * (rotor - wheel) + self._damping * (
            data.qvel[self._rotor_v] - data.qvel[self._wheel_v]
        )

    def sample(self) -> None:
        """What the controller gets now."""
        self.measure()
        at = self._at
        sensors = self.data.sensordata
        self.felt[:] = sensors[0], sensors[1], sensors[5], np.abs(self.data.qvel[self._wheel_v]).mean()
        self.drives.sample(at["angle"], at["torque"], at["felt"], at["sensed"], at["counts"])

    def advance(self, command_at: int, enable: bool) -> None:
        """One millisecond with the command at this address."""
        at, data = self._at, self.data
        self.drives.receive(command_at, enable)
        self._apply_push()
        for _ in range(2):
            self._set_friction()
            self.angle[:] = data.qpos[self._rotor_q] - self._zero
            self.drives.regulate(at["angle"], at["motor"])
            data.qfrc_applied[self._rotor_v] = self.motor
            if self._latch is None:
                mujoco.mj_step(self.model, data, nstep=self.substeps)
            else:
                place, dof, force, per_gap = self._latch
                for _ in range(self.substeps):
                    gap = max(float(data.qpos[place]), 0.0) * per_gap
                    data.qfrc_applied[dof] = -force / (1.0 + gap) ** 2
                    mujoco.mj_step(self.model, data)

    def _set_friction(self) -> None:
        """The friction of the rollers that bear; MuJoCo decides whether they stick or slip."""
        if self._law == EACH:
            return
        data, loss = self.data, self.model.dof_frictionloss
        loss[self._bearing] = self._coulomb[self._bearing]
        bodies = self.model.geom_bodyid[data.contact.geom[: data.ncon]].max(axis=1)
        wheels = self.robot.wheel_of_body[bodies]
        numbers = np.flatnonzero(wheels >= 0)
        self._bearing = self.model.body_dofadr[bodies[numbers]].tolist()
        shares = [1.0] * len(numbers)
        if len(numbers) > WHEELS or len(set(wheels[numbers].tolist())) < len(numbers):
            loads = np.zeros(len(numbers))
            for place, number in enumerate(numbers):
                mujoco.mj_contactForce(self.model, data, int(number), self._force)
                loads[place] = self._force[0]
            whole = np.bincount(wheels[numbers], loads, WHEELS)
            shares = (loads / np.maximum(whole[wheels[numbers]], 1e-9)).tolist()
        for dof, share in zip(self._bearing, shares, strict=True):
            strength = float(self._coulomb[dof]) * share
            if self._law == FILE:
                spin = abs(float(data.qvel[dof]))
                stuck = math.exp(-((spin * self._per_stribeck) ** 2))
                strength *= stuck + (1.0 - stuck) * math.tanh(self._slope * spin)
            loss[dof] = strength

    def _apply_push(self) -> None:
        fx, fy, px, py = self.push
        wrench = self.data.xfrc_applied[self.robot.base_body]
        if fx == 0.0 and fy == 0.0:
            wrench[:] = 0.0
            return
        theta = self.theta
        c, s = math.cos(theta), math.sin(theta)
        # At the height of the centre of mass, where MuJoCo applies it.
        wrench[0], wrench[1] = fx, fy
        wrench[5] = (c * px - s * py) * fy - (s * px + c * py) * fx

    @property
    def theta(self) -> float:
        w, x, y, z = self.data.qpos[3:7]
        return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))

    def release(self, hit: Hit) -> None:
        """The slider before the outline, coming."""
        data, robot = self.data, self.robot
        theta = self.theta
        c, s = math.cos(theta), math.sin(theta)
        x, y = c * hit.x_m - s * hit.y_m, s * hit.x_m + c * hit.y_m
        direction = theta + hit.inward_rad
        ahead = math.cos(direction), math.sin(direction)
        moving = data.qvel[0] - data.qvel[5] * y, data.qvel[1] + data.qvel[5] * x
        # Nose's tip at the point, less the gap; a heeled body is not looked at.
        model = self.model
        model.body_pos[robot.rail_body, :2] = (
            data.qpos[0] + x - GAP_M * ahead[0],
            data.qpos[1] + y - GAP_M * ahead[1],
        )
        model.body_quat[robot.rail_body] = math.cos(0.5 * direction), 0.0, 0.0, math.sin(0.5 * direction)
        data.qpos[robot.slider[0]] = 0.0
        data.qvel[robot.slider[1]] = hit.speed_mps + moving[0] * ahead[0] + moving[1] * ahead[1]
        if robot.plate is not None:
            data.qpos[robot.plate[0]] = data.qvel[robot.plate[1]] = 0.0

    def close(self) -> None:
        """The slider waits far away again: the model is that of the next run, too."""
        self.model.body_pos[self.robot.rail_body, :2] = FAR_M, 0.0
        self.model.dof_frictionloss[:] = self._coulomb
        self.drives.close()

    def contact(self) -> tuple[float, float, float, float]:
        """Force of the slider on the robot (world frame), N, and where (base frame), m."""
        data, robot = self.data, self.robot
        fx = fy = px = py = 0.0
        numbers = np.flatnonzero(data.contact.geom[: data.ncon] == robot.nose_geom) // 2
        for number in numbers:
            force = np.zeros(6)
            mujoco.mj_contactForce(self.model, data, number, force)
            contact = data.contact[number]
            # MuJoCo's normal is from the first geom to the second, its force that on the second.
            along = force[0] * contact.frame[:3] * (1.0 if contact.geom[1] == robot.body_geom else -1.0)
            fx, fy = fx + along[0], fy + along[1]
            x, y = contact.pos[0] - data.qpos[0], contact.pos[1] - data.qpos[1]
            c, s = math.cos(self.theta), math.sin(self.theta)
            px, py = c * x + s * y, c * y - s * x
        return fx, fy, px, py

    def lifted(self) -> int:
        """How many wheels do not bear."""
        bodies = self.model.geom_bodyid[self.data.contact.geom[: self.data.ncon]]
        return WHEELS + 1 - len(set(self.robot.wheel_of_body[bodies].ravel().tolist()) | {-1})


class Controller:
    """The FMU that users get, one millisecond at a time. ``names`` and ``values``: of its outputs, by type."""

    def __init__(self, settings: Mapping[str, Any]) -> None:
        variables = table("controller")
        self._instance = Instance(open_fmu(native.fmu("controller", 3)), "controller")
        self._instance.initialise(dict(settings), variables)
        self.names, self.values, self._get = {}, {}, []
        for kind in ("real", "integer", "boolean"):
            chosen = sorted(variables.select("output", kind), key=lambda one: one.name not in COMMANDS)
            self.names[kind] = [one.name for one in chosen]
            self.values[kind] = np.zeros(len(chosen), dtype=self._instance.dtype(kind))
            getter = self._instance.getter(kind, [one.reference for one in chosen])
            self._get.append((getter, self.values[kind].ctypes.data))
        self._path_ticks = self.names["integer"].index("path_ticks")
        self._enable = self.names["boolean"].index("command.enable")

        def setter(kind: str, names: list[str]) -> Any:
            return self._instance.setter(kind, [variables[name].reference for name in names])

        self._set_torque = setter("real", [f"sensor.torque[{i}]" for i in range(WHEELS)])
        self._set_counts = setter("integer", [*(f"sensor.encoder[{i}]" for i in range(WHEELS)), "sensor.counter"])
        imu = "sensor.imu_present" in variables
        if imu:
            self._set_acceleration = setter(
                "real", ["sensor.acceleration[0]", "sensor.acceleration[1]", "sensor.yaw_rate"]
            )
            self._set_counter = setter("integer", ["sensor.imu_counter"])
        self._set_present = setter("boolean", ["sensor.imu_present"]) if imu else None
        self._present = np.zeros(1, dtype=self._instance.dtype("boolean"))
        self._set_plan = setter("real", list(PLAN_INPUTS))
        self._step = self._instance.stepper()
        self._ticks = 0

    def step(self, sensed_at: int, counts_at: int, plan_at: int, imu_present: bool) -> None:
        """With sensors and plan at these addresses."""
        now = self._ticks * TICK_S
        status = self._set_torque(sensed_at) | self._set_counts(counts_at) | self._set_plan(plan_at)
        if self._set_present is not None:
            status |= self._set_acceleration(sensed_at + 3 * 8) | self._set_counter(counts_at + 4 * 4)
            self._present[0] = imu_present
            status |= self._set_present(self._present.ctypes.data)
        status |= self._step(now, TICK_S)
        for get, address in self._get:
            status |= get(address)
        self._instance.check(status, now)
        self._ticks += 1

    @property
    def path_ticks(self) -> int:
        return int(self.values["integer"][self._path_ticks])

    @property
    def enable(self) -> bool:
        return bool(self.values["boolean"][self._enable])

    def close(self) -> None:
        self._instance.__exit__(None, None, None)


def simulate(robot: SecondRobot, drives: Path, run: Run) -> Traces:
    """One run from its beginning, after the robot has sunk into its wheels."""
    ticks = round(run.duration_s / TICK_S)
    times = np.arange(ticks + 1, dtype=np.float64) * TICK_S
    time_s = times[:-1]
    plan = np.ascontiguousarray(run.plan(times))
    plant = Plant(robot, drives, run.seed, float(plan[0, 2]))
    plant.data.qpos[:2] = plan[0, :2]
    plant.settle()
    pushes = Pushes(run.pushes)(time_s)
    controller = Controller(run.controller)
    sensed = [
        *(f"sensor.torque[{i}]" for i in range(WHEELS)),
        *("sensor.acceleration[0]", "sensor.acceleration[1]", "sensor.yaw_rate"),
        *(f"sensor.encoder[{i}]" for i in range(WHEELS)),
        *("sensor.counter", "sensor.imu_counter", "sensor.imu_present"),
        *("truth.specific_force[0]", "truth.specific_force[1]", "truth.yaw_rate"),
    ]
    true = [*(f"wheel_torque[{i}]" for i in range(WHEELS)), "x", "y", "theta", "vx", "vy", "omega"]
    true += ["contact_force_x", "contact_force_y", "contact_base_x", "contact_base_y", "tilt", "lifted"]
    columns = [
        *(f"controller.{name}" for name in PLAN_INPUTS),
        *(f"testbed.{name}" for name in sensed),
        *(f"testbed.truth.{name}" for name in true),
        *(f"controller.{name}" for names in controller.names.values() for name in names),
    ]
    rows = np.zeros((ticks, len(columns)))
    hits, wiring = list(run.hits), list(run.wiring)
    sensed_at, counts_at = plant.sensed.ctypes.data, plant.counts.ctypes.data
    command_at = controller.values["real"].ctypes.data
    answers = tuple(controller.values.values())
    data, path_ticks = plant.data, 0
    try:
        for tick in range(ticks):
            if hits and time_s[tick] >= hits[0].time_s:
                plant.release(hits.pop(0))
            plant.push[:] = pushes[tick]
            plant.sample()
            plant.sensed[:WHEELS] = plant.sensed[wiring]
            used = plan[min(max(path_ticks, 0), ticks)]
            controller.step(sensed_at, counts_at, used.ctypes.data, bool(plant.counts[-1]))
            path_ticks = controller.path_ticks
            rows[tick] = np.concatenate(
                (
                    used,
                    plant.sensed,
                    plant.counts,
                    plant.felt[:3],
                    plant.torque,
                    (data.qpos[0], data.qpos[1], plant.theta, data.qvel[0], data.qvel[1], data.qvel[5]),
                    plant.contact(),
                    (2.0 * math.hypot(data.qpos[4], data.qpos[5]), plant.lifted()),
                    *answers,
                )
            )
            plant.advance(command_at, controller.enable)
    finally:
        controller.close()
        plant.close()
    traces = {name: rows[:, column] for column, name in enumerate(columns)}
    traces["time"] = time_s
    for column, name in enumerate(PUSH_INPUTS):
        traces[f"testbed.{name}"] = pushes[:, column]
    for axis in "xy":
        force = traces[f"testbed.truth.contact_force_{axis}"]
        steps = 0.5 * TICK_S * (force[1:] + force[:-1])
        traces[f"testbed.truth.contact_impulse_{axis}"] = np.concatenate(([0.0], np.cumsum(steps)))
    traces["testbed.truth.contact_force"] = np.hypot(*(traces[f"testbed.truth.contact_force_{axis}"] for axis in "xy"))
    return traces
