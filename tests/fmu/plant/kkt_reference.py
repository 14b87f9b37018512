"""A second implementation of the plant, in multiplier (KKT) form, as a reference for fmu/plant.

Written from (9)-(31) of Kim, Llado, Sentis 2016, with `F_ext` as the wrench of the environment ON
the robot, and from the element laws in fmu/plant/README.md; not from the C++. It is built
differently on purpose: no equation is reduced by hand.

Every body keeps its own coordinates, every joint is a constraint with a multiplier, and each
evaluation solves

    | A  J^T | | Q'' |   | forces     |
    | J   0  | |  l  | = | -J' Q'     |

    Q = (x, y of the centre of mass, theta | q_w[3] | q_r[3] | carriage x, y | plate x, y | weight h)
    J = 6 rolling constraints (19) | carriage on its rail | plate on its guide
        | plate locked to its carrier | weight locked (no rope) | carriage locked (no slider)

The 28 states of the README are only the carrier of the integration. The internal force of a latched
bumper is a multiplier. Plain Python floats and `math` around one `numpy.linalg.solve`: a right-hand
side takes about 40 us.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from typing import NamedTuple

import numpy as np
from bumper_law_reference import KINDS, law_force, stored_energy
from scipy.integrate import DOP853, DenseOutput, quad
from scipy.optimize import brentq

STATES = 28
INDICATORS = 12
KIND_NONE, KIND_SPRING, KIND_MAGNETIC = 0, 1, 2
MOUNT_SLIDER, MOUNT_ROBOT = 0, 1
LATCH_CONTINUOUS, LATCH_IDEALISED = 0, 1
NOSE_DISC, NOSE_EDGE = 0, 1
ROLLER_BRISTLE, ROLLER_TANH = 0, 1
GRAVITY = 9.81
# Event indices; gears are 0, 1, 2, rollers 9, 10, 11.
GEAR, CONTACT, ROPE, BUMPER, BOTTOM, LANDING, WALL, ROLLER = 0, 3, 4, 5, 6, 7, 8, 9

_COS = [math.cos(2.0 * math.pi * i / 3.0) for i in range(3)]
_SIN = [math.sin(2.0 * math.pi * i / 3.0) for i in range(3)]


@dataclass
class Parameters:
    """SI units. The defaults are Trikey's numbers where the robot file has them."""

    base_mass: float = 34.7
    base_yaw_inertia: float = 1.31  # about the centre of mass
    base_com_x: float = 0.0
    base_com_y: float = 0.0
    floor_slope: float = 0.0
    floor_azimuth: float = 0.0
    wheel_radius: float = 0.1016
    wheel_distance: float = 0.24
    wheel_inertia: float = 0.002798
    wheel_traction: list[float] = field(default_factory=lambda: [1.0, 1.0, 1.0])
    # Roller friction over that at nominal load.
    wheel_load: list[float] = field(default_factory=lambda: [1.0, 1.0, 1.0])
    roller_friction_scale: list[float] = field(default_factory=lambda: [1.0, 1.0, 1.0])
    drivetrain_friction_scale: list[float] = field(default_factory=lambda: [1.0, 1.0, 1.0])
    roller_model: int = ROLLER_BRISTLE
    roller_radius: float = 0.009525
    roller_inertia: float = 1.23e-6
    roller_coulomb_torque: float = 0.2  # B_r, N m
    roller_tanh_slope: float = 0.4  # alpha, s/rad
    # sigma0, N/m
    roller_presliding_stiffness: list[float] = field(default_factory=lambda: [25900.0] * 3)
    roller_presliding_damping: float = 20.0  # sigma1, N s/m
    roller_stribeck_speed: float = 0.002  # v_S, m/s
    roller_elastic_fraction: float = 0.7  # rho_ba
    # Rollers one by one.
    roller_arrangement: int = 0
    roller_rows: int = 2
    roller_per_row: int = 9
    roller_row_distance: float = 0.0125
    roller_radius_dip: float = 1.0e-4
    roller_friction_scatter: float = 0.1
    roller_seed: int = 1
    roller_phase: list[float] = field(default_factory=lambda: [0.0] * 3)
    drivetrain_motor_inertia: float = 0.0523
    drivetrain_stiffness: float = 668.0
    drivetrain_damping: float = 1.0
    drivetrain_gear_coulomb: float = 2.8
    drivetrain_gear_stiction: float = 3.0
    drivetrain_gear_viscous: float = 0.02
    drivetrain_torque_limit: float = 20.0
    slider_present: int = 1
    slider_mass: float = 9.08
    slider_direction: float = 0.0  # psi, rad
    slider_target_x: float = -0.176092
    slider_target_y: float = 0.0
    slider_run_up: float = 0.0382
    contact_nose_radius: float = 0.03
    slider_friction: float = 1.0
    slider_friction_speed: float = 0.01
    slider_damping: float = 0.0
    rope_attached: int = 1
    rope_hanging_mass: float = 4.54
    rope_stiffness: float = 1.0e4
    rope_damping: float = 150.0
    rope_drop_height: float = 0.3
    rope_floor_stiffness: float = 1.0e5
    rope_floor_damping: float = 1.0  # e_f, s/m
    bumper_kind: int = KIND_SPRING
    bumper_mount: int = MOUNT_SLIDER
    bumper_latch_model: int = LATCH_CONTINUOUS
    bumper_plate_mass: float = 0.5
    bumper_preload: float = 2.0
    bumper_spring_rate: float = 723.0
    bumper_damping: float = 5.0
    bumper_guide_friction: float = 0.5
    bumper_guide_friction_speed: float = 0.01
    bumper_travel: float = 0.12
    bumper_stop_stiffness: float = 2.0e4
    bumper_stop_damping: float = 0.5
    bumper_latch_force: float = 33.0
    bumper_latch_gap: float = 0.001
    bumper_mount_x: float = -0.25
    bumper_mount_y: float = 0.0
    bumper_mount_azimuth: float = math.pi  # of the outward unit vector a, base frame
    contact_stiffness: float = 1.06e4
    contact_damping: float = 0.3
    contact_friction: float = 0.0
    contact_friction_speed: float = 0.01
    contact_nose_shape: int = NOSE_DISC
    contact_height: float = 0.05
    outline_body: int = 1
    outline_wheels: int = 0
    wheel_width: float = 0.025
    wall_present: int = 0
    wall_distance: float = 0.0
    wall_stiffness: float = 2.0e5
    wall_damping: float = 1.0
    # Those of a base that tips are used by tipping_reference.py.
    base_tipping: int = 0
    base_tilt_inertia: float = 2.0
    base_com_height: float = 0.414
    wheel_floor_stiffness: float = 2.0e5
    wheel_floor_damping: float = 2.0
    wheel_grip_friction: float = 0.7
    wheel_grip_stiffness: float = 2.0e6
    wheel_grip_damping: float = 400.0
    push_height: float = 0.414
    # The accelerometer.
    imu_x: float = 0.0
    imu_y: float = 0.0
    imu_height: float = 0.2
    imu_azimuth: float = 0.0
    # Laws of bumpers beside spring and magnet.
    bumper_foam_thickness: float = 0.15
    bumper_foam_force_25: float = 25.0
    bumper_foam_force_50: float = 45.0
    bumper_foam_force_75: float = 110.0
    bumper_foam_hysteresis: float = 0.3
    bumper_foam_hysteresis_speed: float = 0.02
    bumper_foam_rate_gain: float = 0.3
    bumper_gas_force: float = 50.0
    bumper_gas_length: float = 0.2
    bumper_gas_exponent: float = 1.2
    bumper_gas_ambient_force: float = 0.0
    bumper_damper_rate: float = 100.0
    bumper_damper_square: float = 0.0
    bumper_damper_rebound: float = 1.0
    bumper_second_rate: float = 4000.0
    bumper_second_preload: float = 0.0
    bumper_first_travel: float = 0.03
    bumper_lever_ratio: float = 1.5
    bumper_lever_mass: float = 0.0
    bumper_table_rows: int = 2
    bumper_table_columns: int = 1
    bumper_table_travel: list[float] = field(default_factory=lambda: [0.0, 0.2, *[0.0] * 10])
    bumper_table_speed: list[float] = field(default_factory=lambda: [0.0] * 6)
    bumper_table_force: list[float] = field(default_factory=lambda: [0.0] * 72)
    outline: list[tuple[float, float]] = field(
        default_factory=lambda: [(0.352184, 0.0), (-0.176092, 0.305), (-0.176092, -0.305)]
    )
    # Deliberate faults: a comparison against a faulty reference must turn red.
    fault_velocity_term: float = 1.0  # factor on J' Q' of the rolling constraints; -1 flips c(nu)
    fault_contact_moment: float = 1.0  # factor on the contact force's moment on the base
    fault_external_sign: float = 1.0  # factor on the wrench on the base; -1: (31) as printed


@dataclass
class Inputs:
    motor_torque: tuple[float, float, float] = (0.0, 0.0, 0.0)
    push_force: tuple[float, float] = (0.0, 0.0)  # world frame
    push_point: tuple[float, float] = (0.0, 0.0)  # base frame


@dataclass
class Modes:
    gear: list[int] = field(default_factory=lambda: [0, 0, 0])
    contact: int = 0
    rope_taut: int = 0
    end_stop: int = 0
    bottom_stop: int = 0
    latched: int = 0
    landed: int = 0
    walled: int = 0
    roller: list[int] = field(default_factory=lambda: [0, 0, 0])  # at the bottom of each wheel

    def copy(self) -> Modes:
        return replace(self, gear=list(self.gear), roller=list(self.roller))

    def as_list(self) -> list[int]:
        return [*self.gear, *(getattr(self, f.name) for f in fields(self)[1:-1]), *self.roller]


class Footing(NamedTuple):
    """How a wheel stands on one of its rollers."""

    radius: float  # of the wheel there
    slope: float  # its derivative by the wheel's angle
    lever: float  # of the contact about the base's centre
    angle: float  # past the roller's middle
    roller_radius: float  # of the barrel there
    friction: float  # over that of an endless roller of the same radius


def scattered(roller: int, wheel: int, seed: int) -> float:
    """A number in (-1, 1) for each roller, by whole numbers."""
    prime = 2**24 - 3
    v = (69069 * seed + 39916801 * roller + 1000003 * (wheel + 1)) % prime
    for salt in (7919, 104729, 1299709):
        v = (v * v + salt) % prime
    return 2.0 * (v + 0.5) / prime - 1.0


def one_sided(k: float, depth: float, rate: float, e: float) -> float:
    """Hunt-Crossley spring of exponent 1 that never pulls."""
    return max(0.0, k * depth * (1.0 + e * rate))


def closest_on_outline(
    px: float, py: float, outline: list[tuple[float, float]]
) -> tuple[float, float, float, float, float]:
    """Signed distance (negative inside), closest point and outward normal: all in the outline's
    frame.

    Brute force: the nearest of the nearest points of all edges; inside by winding of the crossings.
    """
    best = (math.inf, 0.0, 0.0, 0.0, 0.0)
    inside = False
    ax, ay = outline[-1]
    for bx, by in outline:
        if (ay > py) != (by > py) and px < ax + (py - ay) * (bx - ax) / (by - ay):
            inside = not inside
        ex, ey = bx - ax, by - ay
        share = min(1.0, max(0.0, ((px - ax) * ex + (py - ay) * ey) / (ex * ex + ey * ey)))
        cx, cy = ax + share * ex, ay + share * ey
        distance = math.hypot(px - cx, py - cy)
        if distance < best[0]:
            best = (distance, cx, cy, ex, ey)
        ax, ay = bx, by
    distance, cx, cy, ex, ey = best
    if inside or distance < 1e-12:
        length = math.hypot(ex, ey)
        return -distance, cx, cy, ey / length, -ex / length
    return distance, cx, cy, (px - cx) / distance, (py - cy) / distance


def parts_of_outline(p: Parameters) -> list[list[tuple[float, float]]]:
    """Polygons of the base frame, counter-clockwise: the body, and each wheel as a disc cut at the contact's height."""
    parts = [p.outline] if p.outline_body else []
    if p.outline_wheels:
        half = math.sqrt(max(0.0, p.wheel_radius**2 - (p.contact_height - p.wheel_radius) ** 2))
        near, far = p.wheel_distance - 0.5 * p.wheel_width, p.wheel_distance + 0.5 * p.wheel_width
        for c, s in zip(_COS, _SIN, strict=True):
            corners = ((far, -half), (far, half), (near, half), (near, -half))
            parts.append([(u * c - w * s, u * s + w * c) for u, w in corners])
    return parts


class Reference:
    """The plant with one set of parameters."""

    N_Q = 14
    RAIL, GUIDE, LOCK, LOCK_WEIGHT, LOCK_CARRIAGE = 20, 21, 22, 23, 24
    SIZE = 25

    def __init__(self, p: Parameters) -> None:
        self.p = p
        self.ex, self.ey = math.cos(p.slider_direction), math.sin(p.slider_direction)
        self.on_robot = p.bumper_mount == MOUNT_ROBOT and p.bumper_kind != KIND_NONE
        self.has_latch = p.bumper_kind == KIND_MAGNETIC
        self.law = {number: name for name, number in KINDS.items()}.get(p.bumper_kind)
        self.law_numbers = {f.name.removeprefix("bumper_"): getattr(p, f.name) for f in fields(p)}
        self.ideal = self.has_latch and p.bumper_latch_model == LATCH_IDEALISED
        self.carriage_mass = p.slider_mass - (0.0 if self.on_robot else p.bumper_plate_mass)
        self.aim = (
            p.slider_target_x - self.ex * (p.slider_run_up + p.contact_nose_radius),
            p.slider_target_y - self.ey * (p.slider_run_up + p.contact_nose_radius),
        )
        self.rope_preload = p.rope_hanging_mass * GRAVITY / p.rope_stiffness
        along = GRAVITY * math.sin(p.floor_slope)
        self.downhill = (along * math.cos(p.floor_azimuth), along * math.sin(p.floor_azimuth))
        self.axis = (math.cos(p.bumper_mount_azimuth), math.sin(p.bumper_mount_azimuth))
        masses = [p.base_mass, p.base_mass, p.base_yaw_inertia]
        masses += [p.wheel_inertia] * 3 + [p.roller_inertia] * 3
        masses += [self.carriage_mass] * 2 + [p.bumper_plate_mass] * 2 + [p.rope_hanging_mass]
        self.masses = np.array(masses)
        self.parts = parts_of_outline(p)
        # A roller is an arc over its pitch, its barrel as round as that arc.
        self.pitch = 2.0 * math.pi / (p.roller_rows * p.roller_per_row)
        self.arc = p.wheel_radius - p.roller_radius_dip / (1.0 - math.cos(0.5 * self.pitch))
        self.barrel_mean = 1.0
        if p.roller_arrangement:
            half = 0.5 * self.pitch
            self.barrel_mean = quad(lambda a: p.roller_radius / self.barrel(a), 0.0, half, epsabs=1e-14)[0] / half
        self.template = np.zeros((self.SIZE, self.SIZE))
        self.template[range(self.N_Q), range(self.N_Q)] = masses
        for i in range(3):
            if p.wheel_traction[i]:
                self._fill(self.template, 14 + i, {3 + i: -1.0})
                self._fill(self.template, 17 + i, {6 + i: -1.0})
            else:  # a wheel without grip: its two constraints do not exist
                self.template[14 + i, 14 + i] = self.template[17 + i, 17 + i] = 1.0
        self._fill(self.template, self.RAIL, {9: -self.ey, 10: self.ex})
        if not self.on_robot:
            self._fill(self.template, self.GUIDE, {11: -self.ey, 12: self.ex})

    @staticmethod
    def _fill(matrix: np.ndarray, row: int, entries: dict[int, float]) -> None:
        for column, value in entries.items():
            matrix[row, column] = matrix[column, row] = value

    # --- Geometry ---------------------------------------------------------------------------------

    def to_mass(self, theta: float) -> tuple[float, float]:
        """From the wheels' centre to that of mass, world frame."""
        p, ct, st = self.p, math.cos(theta), math.sin(theta)
        return ct * p.base_com_x - st * p.base_com_y, st * p.base_com_x + ct * p.base_com_y

    def barrel(self, angle: float) -> float:
        """Distance of the contact from the roller's own axis, which is roller_radius inside the rim."""
        p = self.p
        return self.arc * math.cos(angle) + (p.wheel_radius - self.arc) - (p.wheel_radius - p.roller_radius)

    def footing(self, i: int, wheel_angle: float, modes: Modes) -> Footing:
        p = self.p
        if not p.roller_arrangement:
            return Footing(p.wheel_radius, 0.0, p.wheel_distance, 0.0, p.roller_radius, 1.0)
        k = modes.roller[i]
        angle = wheel_angle + p.roller_phase[i] - k * self.pitch
        row = k % p.roller_rows
        scatter = p.roller_friction_scatter * scattered(k % (p.roller_rows * p.roller_per_row), i, p.roller_seed)
        return Footing(
            self.arc + (p.wheel_radius - self.arc) * math.cos(angle),
            -(p.wheel_radius - self.arc) * math.sin(angle),
            p.wheel_distance + (row - 0.5 * (p.roller_rows - 1)) * p.roller_row_distance,
            angle,
            self.barrel(angle),
            (1.0 + scatter) / self.barrel_mean,
        )

    def weight(self, i: int) -> float:
        p = self.p
        share = 1.0 + 2.0 * (_COS[i] * p.base_com_x + _SIN[i] * p.base_com_y) / p.wheel_distance
        return p.wheel_traction[i] * share * p.base_mass * GRAVITY * math.cos(p.floor_slope) / 3.0

    def plate_locked(self, modes: Modes) -> bool:
        p = self.p
        return p.bumper_kind == KIND_NONE or not p.slider_present or bool(self.ideal and modes.latched)

    def plate(self, x: np.ndarray) -> tuple[float, ...]:
        """Plate position and velocity, world frame; its outward axis."""
        c, cdot = x[22], x[23]
        if not self.on_robot:
            along, rate = x[18] - c, x[19] - cdot
            return (
                self.aim[0] + self.ex * along,
                self.aim[1] + self.ey * along,
                self.ex * rate,
                self.ey * rate,
                self.ex,
                self.ey,
            )
        p = self.p
        ct, st = math.cos(x[2]), math.sin(x[2])
        ax, ay = ct * self.axis[0] - st * self.axis[1], st * self.axis[0] + ct * self.axis[1]
        rx = ct * p.bumper_mount_x - st * p.bumper_mount_y - ax * c
        ry = st * p.bumper_mount_x + ct * p.bumper_mount_y - ay * c
        vx = x[3] - x[5] * ry - ax * cdot
        vy = x[4] + x[5] * rx - ay * cdot
        return x[0] + rx, x[1] + ry, vx, vy, ax, ay

    def nose(self, x: np.ndarray) -> tuple[float, float, float, float]:
        """Centre of the nose disc and its velocity, world frame."""
        along, rate = (x[18], x[19]) if self.on_robot else (x[18] - x[22], x[19] - x[23])
        return (
            self.aim[0] + self.ex * along,
            self.aim[1] + self.ey * along,
            self.ex * rate,
            self.ey * rate,
        )

    def contact(self, x: np.ndarray) -> tuple[float, ...]:
        """Penetration, its rate, slip speed, closest point and outward normal (world frame)."""
        p = self.p
        cx, cy, ux, uy = self.nose(x)
        if self.on_robot:
            px, py, vx, vy, nx, ny = self.plate(x)
            distance = (cx - px) * nx + (cy - py) * ny
            qx, qy = cx - distance * nx, cy - distance * ny
            bx, by = vx - x[5] * (qy - py), vy + x[5] * (qx - px)
        else:
            ct, st = math.cos(x[2]), math.sin(x[2])
            dx, dy = cx - x[0], cy - x[1]
            distance, lx, ly, mx, my = min(
                closest_on_outline(ct * dx + st * dy, ct * dy - st * dx, part) for part in self.parts
            )
            rx, ry = ct * lx - st * ly, st * lx + ct * ly
            qx, qy = x[0] + rx, x[1] + ry
            nx, ny = ct * mx - st * my, st * mx + ct * my
            bx, by = x[3] - x[5] * ry, x[4] + x[5] * rx
        depth_rate = (bx - ux) * nx + (by - uy) * ny
        slip = -(bx - ux) * ny + (by - uy) * nx
        return p.contact_nose_radius - distance, depth_rate, slip, qx, qy, nx, ny

    def touching(self, x: np.ndarray) -> list[tuple[float, ...]]:
        """As `contact`, for each point that may carry force: one of a disc, every corner of an edge; deepest first."""
        if self.p.contact_nose_shape == NOSE_DISC:
            return [self.contact(x)]
        cx, cy, ux, uy = self.nose(x)
        cx, cy = cx + self.p.contact_nose_radius * self.ex, cy + self.p.contact_nose_radius * self.ey
        ct, st = math.cos(x[2]), math.sin(x[2])
        points = []
        for part in self.parts:
            for lx, ly in part:
                rx, ry = ct * lx - st * ly, st * lx + ct * ly
                depth = (cx - x[0] - rx) * self.ex + (cy - x[1] - ry) * self.ey
                wx, wy = x[3] - x[5] * ry - ux, x[4] + x[5] * rx - uy
                points.append(
                    (depth, -wx * self.ex - wy * self.ey, wx * self.ey - wy * self.ex,
                     x[0] + rx, x[1] + ry, -self.ex, -self.ey)
                )  # fmt: skip
        return sorted(points, reverse=True)

    # --- Element laws -----------------------------------------------------------------------------

    def rope(self, x: np.ndarray) -> tuple[float, float]:
        return self.rope_preload + x[20] - x[18], x[21] - x[19]

    def roller(self, i: int, z: float, v: float, footing: Footing) -> tuple[float, float]:
        """Friction force at the floor and the bristle's rate."""
        p = self.p
        level = p.roller_friction_scale[i] * p.wheel_load[i] * p.roller_coulomb_torque
        level *= footing.friction / footing.roller_radius
        moving = math.tanh(p.roller_tanh_slope * abs(v) / footing.roller_radius)
        if p.roller_model == ROLLER_TANH:
            return level * math.copysign(moving, v), 0.0
        w = math.exp(-((v / p.roller_stribeck_speed) ** 2))
        g = level * (w + (1.0 - w) * moving)
        stiffness = p.roller_presliding_stiffness[i]
        share = stiffness * abs(z) / g
        creep = 0.0
        if z * v > 0.0:
            y = (share - p.roller_elastic_fraction) / (1.0 - p.roller_elastic_fraction)
            y = min(1.0, max(0.0, y))
            creep = y * y * (3.0 - 2.0 * y)
        zdot = v * (1.0 - creep * share)
        return stiffness * z + p.roller_presliding_damping * zdot, zdot

    def latch(self, c: float) -> float:
        if not self.has_latch or self.ideal:
            return 0.0
        return self.p.bumper_latch_force / (1.0 + max(c, 0.0) / self.p.bumper_latch_gap) ** 2

    # --- Right-hand side --------------------------------------------------------------------------

    def evaluate(self, t: float, state: np.ndarray, u: Inputs, modes: Modes) -> dict:
        """Everything at one instant: rates, forces, powers."""
        p = self.p
        x = state.tolist() if isinstance(state, np.ndarray) else list(state)
        theta, vx, vy, omega = x[2], x[3], x[4], x[5]
        ct, st = math.cos(theta), math.sin(theta)
        mx, my = self.to_mass(theta)
        matrix = self.template.copy()
        load = [0.0] * self.SIZE
        rate = [0.0] * STATES
        work = dissipated = 0.0

        # Base, wheels, rollers: (11), (12), (19) and d/dt of (19), world frame.
        torque, friction = [], []
        for i in range(3):
            ci, si = ct * _COS[i] - st * _SIN[i], st * _COS[i] + ct * _SIN[i]
            v_roll = -si * vx + ci * vy
            v_radial = ci * vx + si * vy
            f = self.footing(i, x[12 + i], modes)
            wheel_speed = (v_roll + f.lever * omega) / f.radius
            if p.wheel_traction[i]:
                row = 14 + i
                # The wheels' centre is at (-mx, -my) from that of mass.
                for column, value in ((0, -si), (1, ci), (2, f.lever - si * my - ci * mx)):
                    matrix[row, column] = matrix[column, row] = value / f.radius
                load[row] = p.fault_velocity_term * (omega * v_radial + f.slope * wheel_speed**2) / f.radius
                load[row] -= omega**2 * (-si * mx + ci * my) / f.radius
                row = 17 + i
                for column, value in ((0, ci), (1, si), (2, ci * my - si * mx)):
                    matrix[row, column] = matrix[column, row] = value / p.roller_radius
                load[row] = -p.fault_velocity_term * omega * v_roll / p.roller_radius
                load[row] -= omega**2 * (ci * mx + si * my) / p.roller_radius

            twist_rate = x[9 + i] - wheel_speed
            t_i = p.drivetrain_stiffness * (x[6 + i] - x[12 + i]) + p.drivetrain_damping * twist_rate
            torque.append(t_i)
            load[3 + i] = t_i - self.weight(i) * f.slope  # the weight is lifted along the wheel's radius
            f_i, zdot = self.roller(i, x[15 + i], v_radial, f)
            friction.append(f_i)
            load[6 + i] = -p.roller_radius * f_i
            rate[12 + i] = wheel_speed
            rate[15 + i] = zdot
            dissipated += p.drivetrain_damping * twist_rate**2
            if p.wheel_traction[i]:
                stored_rate = (
                    p.roller_presliding_stiffness[i] * x[15 + i] * zdot if p.roller_model == ROLLER_BRISTLE else 0.0
                )
                dissipated += f_i * v_radial - stored_rate

            drive = max(-p.drivetrain_torque_limit, min(p.drivetrain_torque_limit, u.motor_torque[i]))
            direction = modes.gear[i]
            if direction:
                w_m = x[9 + i]
                gear = p.drivetrain_friction_scale[i] * (
                    p.drivetrain_gear_coulomb * direction + p.drivetrain_gear_viscous * w_m
                )
                rate[6 + i] = w_m
                rate[9 + i] = (drive - t_i - gear) / p.drivetrain_motor_inertia
                work += drive * w_m
                dissipated += gear * w_m

        load[0] += p.base_mass * self.downhill[0]
        load[1] += p.base_mass * self.downhill[1]
        if self.on_robot:
            load[11] += p.bumper_plate_mass * self.downhill[0]
            load[12] += p.bumper_plate_mass * self.downhill[1]

        # External push: force at a point of the base.
        fx, fy = u.push_force
        rx = ct * u.push_point[0] - st * u.push_point[1]
        ry = st * u.push_point[0] + ct * u.push_point[1]
        load[0] += p.fault_external_sign * fx
        load[1] += p.fault_external_sign * fy
        load[2] += p.fault_external_sign * ((rx - mx) * fy - (ry - my) * fx)
        work += fx * (vx - omega * ry) + fy * (vy + omega * rx)

        # Slider, rope, weight.
        tension = 0.0
        if p.slider_present:
            if p.rope_attached:
                ext, ext_rate = self.rope(x)
                if modes.rope_taut:
                    tension = max(0.0, p.rope_stiffness * ext + p.rope_damping * ext_rate)
                    dissipated += (tension - p.rope_stiffness * ext) * ext_rate
                floor = 0.0
                if modes.landed:
                    depth = x[20] - p.rope_drop_height
                    floor = one_sided(p.rope_floor_stiffness, depth, x[21], p.rope_floor_damping)
                    dissipated += (floor - p.rope_floor_stiffness * depth) * x[21]
                load[13] = p.rope_hanging_mass * GRAVITY - tension - floor
            rail = p.slider_friction * math.tanh(x[19] / p.slider_friction_speed) + p.slider_damping * x[19]
            dissipated += rail * x[19]
            wall = 0.0
            if modes.walled:
                depth = -x[18] - p.wall_distance
                wall = one_sided(p.wall_stiffness, depth, -x[19], p.wall_damping)
                dissipated += (wall - p.wall_stiffness * depth) * -x[19]
            load[9] += self.ex * (tension - rail + wall)
            load[10] += self.ey * (tension - rail + wall)
        if not (p.slider_present and p.rope_attached):
            self._fill(matrix, self.LOCK_WEIGHT, {13: 1.0})
        else:
            matrix[self.LOCK_WEIGHT, self.LOCK_WEIGHT] = 1.0
        if not p.slider_present:
            self._fill(matrix, self.LOCK_CARRIAGE, {9: self.ex, 10: self.ey})
        else:
            matrix[self.LOCK_CARRIAGE, self.LOCK_CARRIAGE] = 1.0

        # Plate on its guide. `out` is the direction in which the bumper extends, `across` the
        # guide's normal.
        px, py, pvx, pvy, ox, oy = self.plate(x)
        gx, gy = px - x[0], py - x[1]
        if self.on_robot:
            wx, wy = -oy, ox
            rvx, rvy = pvx - vx, pvy - vy
            gap, lever = gx * ox + gy * oy, gx * wx + gy * wy
            # across . (P - X) = const, differentiated twice
            self._fill(matrix, self.GUIDE, {0: -wx, 1: -wy, 2: -gap - (wx * my - wy * mx), 11: wx, 12: wy})
            load[self.GUIDE] = 2.0 * omega * (rvx * ox + rvy * oy) + (lever + wx * mx + wy * my) * omega**2
            extension = {0: -ox, 1: -oy, 2: lever - (ox * my - oy * mx), 11: ox, 12: oy}
            centrifugal = 2.0 * omega * (rvx * wx + rvy * wy) - (gap + ox * mx + oy * my) * omega**2
        else:
            extension = {9: -ox, 10: -oy, 11: ox, 12: oy}
            centrifugal = 0.0
        locked = self.plate_locked(modes)
        if locked:
            self._fill(matrix, self.LOCK, extension)
            load[self.LOCK] = -centrifugal
        else:
            c, cdot = x[22], x[23]
            if self.law is None:
                force = p.bumper_preload + p.bumper_spring_rate * c + self.latch(c)
            else:
                force = law_force(self.law, self.law_numbers, c, cdot)
                dissipated += (force - law_force(self.law, self.law_numbers, c, 0.0)) * cdot
            force += p.bumper_damping * cdot
            slide = p.bumper_guide_friction * math.tanh(cdot / p.bumper_guide_friction_speed)
            force += slide
            dissipated += (p.bumper_damping * cdot + slide) * cdot
            if modes.end_stop and not self.ideal:
                stop = one_sided(p.bumper_stop_stiffness, -c, -cdot, p.bumper_stop_damping)
                force -= stop
                dissipated += (stop - p.bumper_stop_stiffness * -c) * -cdot
            if modes.bottom_stop:
                depth = c - p.bumper_travel
                stop = one_sided(p.bumper_stop_stiffness, depth, cdot, p.bumper_stop_damping)
                force += stop
                dissipated += (stop - p.bumper_stop_stiffness * depth) * cdot
            matrix[self.LOCK, self.LOCK] = 1.0
            inertance = p.bumper_lever_mass if self.law == "lever" else 0.0
            for column, value in extension.items():
                load[column] += (force - inertance * centrifugal) * value
                for other, moved in extension.items():
                    matrix[column, other] += inertance * value * moved

        # Contact: force on the robot, its reaction on the nose.
        cfx = cfy = 0.0
        qx = qy = 0.0
        normal = 0.0
        if p.slider_present:
            touching = self.touching(x)
            qx, qy = touching[0][3:5]
            total = [0.0, 0.0, 0.0]  # normal force, and its moments about the world's axes
            for depth, depth_rate, slip, rx, ry, nx, ny in touching:
                if not modes.contact or (p.contact_nose_shape == NOSE_EDGE and depth <= 0.0):
                    continue
                normal = one_sided(p.contact_stiffness, depth, depth_rate, p.contact_damping)
                shear = p.contact_friction * normal * math.tanh(slip / p.contact_friction_speed)
                fx, fy = -normal * nx + shear * ny, -normal * ny - shear * nx
                cfx, cfy = cfx + fx, cfy + fy
                total = [total[0] + normal, total[1] + normal * rx, total[2] + normal * ry]
                dissipated += (normal - p.contact_stiffness * depth) * depth_rate + shear * slip
                s = p.fault_external_sign
                load[9 if self.on_robot else 11] -= fx
                load[10 if self.on_robot else 12] -= fy
                # On the robot, the plate takes the force and its guide the moment about the plate.
                taker, ax, ay = (11, px, py) if self.on_robot else (0, x[0] + mx, x[1] + my)
                load[taker] += s * fx
                load[taker + 1] += s * fy
                load[2] += s * p.fault_contact_moment * ((rx - ax) * fy - (ry - ay) * fx)
            normal = total[0]
            if normal > 0.0:
                qx, qy = total[1] / normal, total[2] / normal

        solution = np.linalg.solve(matrix, load).tolist()
        if not locked:
            force -= inertance * (centrifugal + sum(value * solution[k] for k, value in extension.items()))
        rate[0:3] = [vx, vy, omega]
        rate[3] = solution[0] + solution[2] * my + omega**2 * mx
        rate[4] = solution[1] - solution[2] * mx + omega**2 * my
        rate[5] = solution[2]
        if p.slider_present:
            rate[18], rate[19] = x[19], solution[9] * self.ex + solution[10] * self.ey
            if p.rope_attached:
                rate[20], rate[21] = x[21], solution[13]
            if not locked:
                rate[22] = x[23]
                rate[23] = -centrifugal - sum(value * solution[k] for k, value in extension.items())
        rate[24], rate[25] = work, dissipated
        rate[26], rate[27] = cfx, cfy
        return {
            "rate": rate,
            "torque": torque,
            "roller_force": friction,
            "contact_force": (cfx, cfy),
            "contact_normal": normal,
            "contact_point": (qx, qy),
            "tension": tension,
            "wall_force": wall if p.slider_present else 0.0,
            "internal_force": -solution[self.LOCK] if locked else force,
        }

    def rhs(self, t: float, x: np.ndarray, u: Inputs, modes: Modes) -> np.ndarray:
        return np.array(self.evaluate(t, x, u, modes)["rate"])

    def specific_force(self, x: np.ndarray, rate: list[float]) -> tuple[float, float]:
        """Acceleration less gravity where the accelerometer sits, along its axes: a point of the complex plane."""
        p = self.p
        arm = complex(p.imu_x, p.imu_y) * complex(math.cos(x[2]), math.sin(x[2]))
        acceleration = complex(rate[3], rate[4]) + (1j * rate[5] - x[5] ** 2) * arm
        axis = x[2] + p.imu_azimuth
        felt = (acceleration - complex(*self.downhill)) * complex(math.cos(axis), -math.sin(axis))
        return felt.real, felt.imag

    # --- Energy -----------------------------------------------------------------------------------

    def stored_energy(self, x: np.ndarray, modes: Modes) -> float:
        p = self.p
        ct, st = math.cos(x[2]), math.sin(x[2])
        mx, my = self.to_mass(x[2])
        energy = 0.5 * p.base_mass * ((x[3] - x[5] * my) ** 2 + (x[4] + x[5] * mx) ** 2)
        energy += 0.5 * p.base_yaw_inertia * x[5] ** 2
        energy -= p.base_mass * (self.downhill[0] * (x[0] + mx) + self.downhill[1] * (x[1] + my))
        for i in range(3):
            ci, si = ct * _COS[i] - st * _SIN[i], st * _COS[i] + ct * _SIN[i]
            if p.wheel_traction[i]:
                f = self.footing(i, x[12 + i], modes)
                energy += self.weight(i) * (f.radius - p.wheel_radius)
                wheel = (-si * x[3] + ci * x[4] + f.lever * x[5]) / f.radius
                roller = (ci * x[3] + si * x[4]) / p.roller_radius
                energy += 0.5 * p.wheel_inertia * wheel**2 + 0.5 * p.roller_inertia * roller**2
            energy += 0.5 * p.drivetrain_motor_inertia * x[9 + i] ** 2
            energy += 0.5 * p.drivetrain_stiffness * (x[6 + i] - x[12 + i]) ** 2
            if p.roller_model == ROLLER_BRISTLE:
                energy += 0.5 * p.roller_presliding_stiffness[i] * x[15 + i] ** 2
        px, py, pvx, pvy, _, _ = self.plate(x)
        if self.on_robot:
            energy -= p.bumper_plate_mass * (self.downhill[0] * px + self.downhill[1] * py)
        energy += 0.5 * self.carriage_mass * x[19] ** 2 + 0.5 * p.bumper_plate_mass * (pvx**2 + pvy**2)
        if not p.slider_present:
            return energy
        if p.rope_attached:
            energy += 0.5 * p.rope_hanging_mass * x[21] ** 2 - p.rope_hanging_mass * GRAVITY * x[20]
            if modes.rope_taut:
                energy += 0.5 * p.rope_stiffness * self.rope(x)[0] ** 2
            if modes.landed:
                energy += 0.5 * p.rope_floor_stiffness * (x[20] - p.rope_drop_height) ** 2
        if p.bumper_kind != KIND_NONE:
            c = x[22]
            if self.law is None:
                energy += p.bumper_preload * c + 0.5 * p.bumper_spring_rate * c**2
            else:
                energy += stored_energy(self.law, self.law_numbers, c)
            if self.law == "lever":
                energy += 0.5 * p.bumper_lever_mass * x[23] ** 2
            if self.has_latch and not self.ideal:
                energy += p.bumper_latch_force * (c if c < 0.0 else p.bumper_latch_gap * c / (p.bumper_latch_gap + c))
            if modes.end_stop and not self.ideal:
                energy += 0.5 * p.bumper_stop_stiffness * c**2
            if modes.bottom_stop:
                energy += 0.5 * p.bumper_stop_stiffness * (c - p.bumper_travel) ** 2
        if modes.contact:
            depths = [point[0] for point in self.touching(x)]
            energy += (
                0.5 * p.contact_stiffness * sum(d**2 for d in depths if p.contact_nose_shape == NOSE_DISC or d > 0.0)
            )
        if modes.walled:
            energy += 0.5 * p.wall_stiffness * (x[18] + p.wall_distance) ** 2
        return energy

    # --- Events -----------------------------------------------------------------------------------

    def gear_surplus(self, i: int, x: np.ndarray, u: Inputs, modes: Modes) -> float:
        """Motor torque minus drivetrain torque: the torque that the gear friction has to hold."""
        p = self.p
        ci, si = math.cos(x[2] + 2.0 * math.pi * i / 3.0), math.sin(x[2] + 2.0 * math.pi * i / 3.0)
        f = self.footing(i, x[12 + i], modes)
        wheel_speed = (-si * x[3] + ci * x[4] + f.lever * x[5]) / f.radius
        torque = p.drivetrain_stiffness * (x[6 + i] - x[12 + i]) + p.drivetrain_damping * (x[9 + i] - wheel_speed)
        return max(-p.drivetrain_torque_limit, min(p.drivetrain_torque_limit, u.motor_torque[i])) - torque

    def stiction(self, i: int) -> float:
        return self.p.drivetrain_friction_scale[i] * self.p.drivetrain_gear_stiction

    def indicators(self, t: float, x: np.ndarray, u: Inputs, modes: Modes) -> list[float]:
        p = self.p
        g = [0.0] * INDICATORS
        for i in range(3):
            direction = modes.gear[i]
            g[i] = x[9 + i] * direction if direction else self.stiction(i) - abs(self.gear_surplus(i, x, u, modes))
            g[ROLLER + i] = 0.5 * self.pitch + 1e-9 - abs(self.footing(i, x[12 + i], modes).angle)
        if p.slider_present:
            g[CONTACT] = self.touching(x)[0][0]
            if p.wall_present:
                g[WALL] = -x[18] - p.wall_distance
            if p.rope_attached:
                g[ROPE] = self.rope(x)[0]
                g[LANDING] = x[20] - p.rope_drop_height
            if p.bumper_kind != KIND_NONE:
                if self.ideal and modes.latched:
                    g[BUMPER] = (
                        p.bumper_latch_force + p.bumper_preload - self.evaluate(t, x, u, modes)["internal_force"]
                    )
                else:
                    g[BUMPER] = x[22]
                g[BOTTOM] = x[22] - p.bumper_travel
        return g

    def event_direction(self, index: int, modes: Modes) -> int:
        """Sign of the crossing that is an event in the present modes; 0 = none can happen."""
        p = self.p
        if index < 3:
            return -1
        if index >= ROLLER:
            return -1 if p.roller_arrangement else 0
        if not p.slider_present:
            return 0
        if index == CONTACT:
            return -1 if modes.contact else 1
        if index == WALL:
            return (-1 if modes.walled else 1) if p.wall_present else 0
        if index in (ROPE, LANDING):
            engaged = modes.rope_taut if index == ROPE else modes.landed
            return (-1 if engaged else 1) if p.rope_attached else 0
        if p.bumper_kind == KIND_NONE:
            return 0
        if index == BUMPER:
            if self.ideal:
                return -1
            return 1 if modes.end_stop else -1
        return 0 if self.plate_locked(modes) else (-1 if modes.bottom_stop else 1)

    def transition(self, t: float, x: np.ndarray, u: Inputs, modes: Modes, index: int) -> tuple[np.ndarray, Modes]:
        x, modes = np.array(x), modes.copy()
        if index < 3:
            if modes.gear[index]:
                x[9 + index] = 0.0
            surplus = self.gear_surplus(index, x, u, modes)
            stays = modes.gear[index] and abs(surplus) <= self.stiction(index)
            modes.gear[index] = 0 if stays else int(math.copysign(1.0, surplus))
        elif index == CONTACT:
            modes.contact = 1 - modes.contact
        elif index == ROPE:
            modes.rope_taut = 1 - modes.rope_taut
        elif index == BUMPER:
            if not self.ideal:
                modes.end_stop = 1 - modes.end_stop
            elif modes.latched:
                modes.latched = 0
            else:
                x = self.relatch(x, modes)
                modes.latched = 1
        elif index == BOTTOM:
            modes.bottom_stop = 1 - modes.bottom_stop
        elif index == LANDING:
            modes.landed = 1 - modes.landed
        elif index == WALL:
            modes.walled = 1 - modes.walled
        else:
            x, modes = self.hand_over(x, modes, index - ROLLER)
        return x, self.settle(t, x, u, modes) if self.p.roller_arrangement else modes

    def constraints(self, x: np.ndarray, modes: Modes, locked: bool) -> np.ndarray:
        """J at this instant; weight and carriage are never locked."""
        p = self.p
        theta = x[2]
        mx, my = self.to_mass(theta)
        rows = np.zeros((9, self.N_Q))
        for i in range(3):
            ci, si = (
                math.cos(theta + 2.0 * math.pi * i / 3.0),
                math.sin(theta + 2.0 * math.pi * i / 3.0),
            )
            if p.wheel_traction[i]:
                f = self.footing(i, x[12 + i], modes)
                rows[i, [0, 1, 2, 3 + i]] = -si / f.radius, ci / f.radius, 0.0, -1.0
                rows[i, 2] = (f.lever - si * my - ci * mx) / f.radius
                rows[3 + i, [0, 1, 6 + i]] = ci / p.roller_radius, si / p.roller_radius, -1.0
                rows[3 + i, 2] = (ci * my - si * mx) / p.roller_radius
        rows[6, [9, 10]] = -self.ey, self.ex
        px, py, _, _, ox, oy = self.plate(x)
        gx, gy = px - x[0], py - x[1]
        if self.on_robot:
            gx, gy = gx - mx, gy - my  # from the centre of mass
            rows[7, [0, 1, 2, 11, 12]] = oy, -ox, -(gx * ox + gy * oy), -oy, ox
            rows[8, [0, 1, 2, 11, 12]] = -ox, -oy, -gx * oy + gy * ox, ox, oy
        else:
            rows[7, [11, 12]] = -self.ey, self.ex
            rows[8, [9, 10, 11, 12]] = -ox, -oy, ox, oy
        if not locked:
            rows[8] = 0.0
        return rows

    def twist(self, speeds: np.ndarray, theta: float) -> tuple[float, float, float]:
        """Of the wheels' centre."""
        mx, my = self.to_mass(theta)
        return speeds[0] + speeds[2] * my, speeds[1] - speeds[2] * mx, speeds[2]

    def speeds(self, x: np.ndarray, rows: np.ndarray) -> np.ndarray:
        speeds = np.zeros(self.N_Q)
        mx, my = self.to_mass(x[2])
        speeds[0:3] = x[3] - x[5] * my, x[4] + x[5] * mx, x[5]
        for i in range(3):
            speeds[3 + i] = rows[i, 0:3] @ speeds[0:3]
            speeds[6 + i] = rows[3 + i, 0:3] @ speeds[0:3]
        speeds[9:11] = x[19] * self.ex, x[19] * self.ey
        speeds[11:13] = self.plate(x)[2:4]
        return speeds

    def impact(self, speeds: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """A dQ' + J^T impulses = 0 with J Q' = 0 afterwards."""
        rows = rows[np.any(rows != 0.0, axis=1)]  # without those of lifted wheels
        weights = rows / self.masses
        return speeds - weights.T @ np.linalg.solve(weights @ rows.T, rows @ speeds)

    def relatch(self, x: np.ndarray, modes: Modes) -> np.ndarray:
        """Plastic impact of plate and carrier, with the lock closed afterwards."""
        x = np.array(x)
        x[22] = 0.0
        still = Modes(roller=modes.roller)
        before = self.stored_energy(x, still)
        rows = self.constraints(x, modes, locked=True)
        after = self.impact(self.speeds(x, rows), rows)
        x[3:6] = self.twist(after, x[2])
        x[19] = after[9] * self.ex + after[10] * self.ey
        x[23] = 0.0
        x[25] += before - self.stored_energy(x, still)
        return x

    def hand_over(self, x: np.ndarray, modes: Modes, wheel: int) -> tuple[np.ndarray, Modes]:
        """The next roller: another lever of the wheel, a bristle and a roller at rest."""
        x, next_modes = np.array(x), modes.copy()
        before = self.stored_energy(x, modes)
        speeds = self.speeds(x, self.constraints(x, modes, locked=False))
        next_modes.roller[wheel] += 1 if self.footing(wheel, x[12 + wheel], modes).angle > 0.0 else -1
        speeds[6 + wheel] = 0.0
        after = self.impact(speeds, self.constraints(x, next_modes, self.plate_locked(modes)))
        if self.on_robot and not self.plate_locked(modes):
            px, py, _, _, ox, oy = self.plate(x)
            base = self.twist(after, x[2])
            vx = after[11] - base[0] + after[2] * (py - x[1])
            vy = after[12] - base[1] - after[2] * (px - x[0])
            x[23] = -(vx * ox + vy * oy)
        x[3:6] = self.twist(after, x[2])
        x[15 + wheel] = 0.0
        x[25] += before - self.stored_energy(x, next_modes)
        return x, next_modes

    def settle(self, t: float, x: np.ndarray, u: Inputs, modes: Modes) -> Modes:
        """A stuck gear that a jump (of input or speed) has overloaded breaks away at once."""
        modes = modes.copy()
        for i in range(3):
            surplus = self.gear_surplus(i, x, u, modes)
            if modes.gear[i] == 0 and abs(surplus) > self.stiction(i):
                modes.gear[i] = int(math.copysign(1.0, surplus))
        return modes

    # --- Simulation -------------------------------------------------------------------------------

    def _crossing(self, i: int, left: float, right: float, dense: DenseOutput, u: Inputs, modes: Modes) -> float:
        def value(t: float) -> float:
            return self.indicators(t, dense(t), u, modes)[i]

        # No change of sign: it crossed before `left`, within the distance kept from the start.
        return brentq(value, left, right, xtol=1e-14) if value(left) * value(right) < 0.0 else left

    def _until_event(
        self, start: float, x: np.ndarray, u: Inputs, modes: Modes, end: float, sampling: Sampling
    ) -> tuple[float, np.ndarray, int | None]:
        """Integrates to the first event, or to `end`: time, state, event or None."""
        solver = DOP853(
            lambda t, y: self.evaluate(t, y, u, modes)["rate"],
            start,
            x,
            end,
            rtol=sampling.rtol,
            atol=sampling.atol,
        )
        directions = [self.event_direction(i, modes) for i in range(INDICATORS)]
        old = self.indicators(start, x, u, modes)
        while solver.status == "running":
            solver.step()
            new = self.indicators(solver.t, solver.y.tolist(), u, modes)
            crossed = [i for i, sign in enumerate(directions) if sign and sign * old[i] <= 0.0 < sign * new[i]]
            if not crossed and not sampling.due(solver.t):
                old = new
                continue
            dense = solver.dense_output()
            first: tuple[float, int] | None = None
            for i in crossed:
                # The start of a step may be the zero of the last event: keep away from it.
                left = solver.t_old if old[i] != 0.0 else solver.t_old + 1e-12
                at = self._crossing(i, left, solver.t, dense, u, modes)
                first = min(first, (at, i)) if first else (at, i)
            sampling.take(first[0] if first else solver.t, dense, modes)
            if first:
                return first[0], dense(first[0]), first[1]
            old = new
        return solver.t, np.array(solver.y), None

    def simulate(
        self,
        x0: np.ndarray,
        modes: Modes,
        times: np.ndarray,
        inputs: list[tuple[float, Inputs]],
        rtol: float = 1e-10,
        atol: float = 1e-12,
    ) -> Trajectory:
        """States at `times`. `inputs`: (from time, value), the first from times[0]. Restarted at
        inputs and events."""
        times = np.asarray(times, dtype=float)
        sampling = Sampling(times, np.empty((len(times), STATES)), rtol, atol)
        x, t = np.array(x0, dtype=float), float(times[0])
        events: list[tuple[float, int]] = []
        ends = [min(start, float(times[-1])) for start, _ in inputs[1:]] + [float(times[-1])]
        for end, (_, u) in zip(ends, inputs, strict=True):
            while t < end:
                modes = self.settle(t, x, u, modes)
                t, x, event = self._until_event(t, x, u, modes, end, sampling)
                if event is not None:
                    events.append((t, event))
                    x, modes = self.transition(t, x, u, modes, event)
        return Trajectory(sampling.states, sampling.modes, events)


@dataclass
class Sampling:
    """Fills the states at the wanted times as the integration passes them."""

    times: np.ndarray
    states: np.ndarray
    rtol: float
    atol: float
    modes: list[Modes] = field(default_factory=list)

    def due(self, time: float) -> bool:
        return len(self.modes) < len(self.times) and self.times[len(self.modes)] <= time

    def take(self, time: float, dense: DenseOutput, modes: Modes) -> None:
        done, upto = len(self.modes), int(np.searchsorted(self.times, time, side="right"))
        if upto > done:
            self.states[done:upto] = dense(self.times[done:upto]).T
            self.modes += [modes] * (upto - done)


@dataclass
class Trajectory:
    states: np.ndarray  # one row per time
    modes: list[Modes]  # in force at each time
    events: list[tuple[float, int]]
