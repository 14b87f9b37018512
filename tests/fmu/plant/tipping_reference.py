"""A second implementation of the tipping base, by Lagrange's equations, as a reference for fmu/plant/tipping.hpp; not
derived from it.

Coordinates: x, y, height of the body's point at floor level in its middle; heading, pitch, roll (turned in this order);
the wheels' angles against the body. Kinetic energy is that of a rigid body and three spinning discs; the mass matrix
and its derivatives come from complex steps, exact to rounding: no equation is derived by hand.

Forces enter by virtual work at the points where they act. Element laws are those of fmu/plant/README.md, shared with
kkt_reference.py where the planar plant has them too.
"""

from __future__ import annotations

import math

import numpy as np
from kkt_reference import GRAVITY, Inputs, Modes, Parameters, Reference, closest_on_outline, one_sided

STATES, EVENTS, MODES = 40, 16, 11
HEAVE, ROLL, PITCH, HEAVE_RATE, ROLL_RATE, PITCH_RATE, SPIN, GRIP = 28, 29, 30, 31, 32, 33, 34, 37
STEP = 1e-30  # of the complex steps
AZIMUTHS = [2.0 * math.pi * i / 3.0 for i in range(3)]


def turn(q: np.ndarray) -> np.ndarray:
    """Body axes in the world: heading, pitch, roll."""
    s, c = np.sin(q[3:6]), np.cos(q[3:6])
    yaw = np.array([[c[0], -s[0], 0], [s[0], c[0], 0], [0, 0, 1]])
    pitch = np.array([[c[1], 0, s[1]], [0, 1, 0], [-s[1], 0, c[1]]])
    roll = np.array([[1, 0, 0], [0, c[2], -s[2]], [0, s[2], c[2]]])
    return yaw @ pitch @ roll


def rotation_rates(q: np.ndarray) -> np.ndarray:
    """Angular velocity in body axes per unit rate of each coordinate (3 x 9)."""
    s, c = np.sin(q[4:6]), np.cos(q[4:6])
    rates = np.zeros((3, 9), dtype=q.dtype)
    rates[:, 3] = -s[0], c[0] * s[1], c[0] * c[1]
    rates[:, 4] = 0, c[1], -s[1]
    rates[:, 5] = 1, 0, 0
    return rates


def point_rates(q: np.ndarray, body_point: np.ndarray) -> np.ndarray:
    """Velocity in the world of a point of the body per unit rate of each coordinate (3 x 9)."""
    r, w = turn(q), rotation_rates(q)
    rates = np.zeros((3, 9), dtype=q.dtype)
    rates[0:3, 0:3] = np.eye(3)
    for k in range(3, 6):
        rates[:, k] = r @ np.cross(w[:, k], body_point)
    return rates


class TippingReference:
    def __init__(self, p: Parameters) -> None:
        self.p = p
        self.planar = Reference(p)
        self.mass_centre = np.array([p.base_com_x, p.base_com_y, p.base_com_height])
        self.gravity = np.array([*self.planar.downhill, -GRAVITY * math.cos(p.floor_slope)])
        self.axles = [np.array([math.cos(a), math.sin(a), 0.0]) for a in AZIMUTHS]
        without_spin = p.base_tilt_inertia - 1.5 * p.wheel_inertia
        self.inertia = np.diag([without_spin, without_spin, p.base_yaw_inertia])

    def mass_matrix(self, q: np.ndarray) -> np.ndarray:
        p = self.p
        centre = point_rates(q, self.mass_centre)
        w = rotation_rates(q)
        m = p.base_mass * centre.T @ centre + w.T @ self.inertia @ w
        for i, axle in enumerate(self.axles):
            spin = -(axle @ w)  # absolute: relative to the body, minus the body's rotation about the axle
            spin[6 + i] += 1.0
            m = m + p.wheel_inertia * np.outer(spin, spin)
        return m

    def coordinates(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Coordinates and their rates from the state."""
        q = np.array([x[0], x[1], x[HEAVE], x[2], x[PITCH], x[ROLL], *x[12:15]])
        w = rotation_rates(q)
        # Roll and pitch rate about the body's axes and the heading's rate are what the state has.
        rows = np.array([w[0, 3:6], w[1, 3:6], [1.0, 0.0, 0.0]])
        rates = np.linalg.solve(rows, [x[ROLL_RATE], x[PITCH_RATE], x[5]])
        v = np.array([x[3], x[4], x[HEAVE_RATE], *rates, 0.0, 0.0, 0.0])
        for i, axle in enumerate(self.axles):
            v[6 + i] = x[SPIN + i] + axle @ (w @ v)
        return q, v

    def energy(self, x: np.ndarray) -> float:
        """Kinetic and of gravity, of body and wheels."""
        q, v = self.coordinates(x)
        place = q[0:3] + turn(q) @ self.mass_centre
        return float(0.5 * v @ self.mass_matrix(q) @ v - self.p.base_mass * self.gravity @ place)

    def lowest(self, q: np.ndarray, i: int) -> np.ndarray:
        """Lowest point of a wheel's rim, body axes: where the rim's height is stationary."""
        p, axle = self.p, self.axles[i]
        up, side = np.array([0.0, 0.0, 1.0]), np.cross(np.array([0.0, 0.0, 1.0]), axle)
        r = turn(q)
        angle = math.atan2(-(r @ side)[2], -(r @ up)[2])
        return p.wheel_distance * axle + p.wheel_radius * (up + math.cos(angle) * up + math.sin(angle) * side)

    def grip_rate(self, i: int, z: float, slip: float) -> float:
        p = self.p
        share = p.wheel_grip_stiffness * abs(z) / (p.wheel_grip_friction * p.base_mass * GRAVITY / 3.0)
        creep = 0.0
        if z * slip > 0.0:
            y = min(1.0, max(0.0, (share - p.roller_elastic_fraction) / (1.0 - p.roller_elastic_fraction)))
            creep = y * y * (3.0 - 2.0 * y)
        return slip * (1.0 - creep * share)

    def contact(
        self, x: np.ndarray, q: np.ndarray, v: np.ndarray
    ) -> tuple[float, float, float, np.ndarray, np.ndarray]:
        """Depth, its rate, slip, outward normal (world), and the point's velocity per unit coordinate rate (2 x 9)."""
        p, r = self.p, self.planar
        nose_x, nose_y, ux, uy = r.nose(x)
        axis = np.array([0.0, 0.0, p.contact_height])
        at = q[0:2] + (turn(q) @ axis)[0:2]
        ct, st = math.cos(q[3]), math.sin(q[3])
        dx, dy = nose_x - at[0], nose_y - at[1]
        distance, lx, ly, mx, my = min(
            closest_on_outline(ct * dx + st * dy, ct * dy - st * dx, part) for part in r.parts
        )
        normal = np.array([ct * mx - st * my, st * mx + ct * my])
        rates = point_rates(q, axis)[0:2]
        rates[:, 3] += -(st * lx + ct * ly), ct * lx - st * ly
        relative = rates @ v - np.array([ux, uy])
        return (
            p.contact_nose_radius - distance,
            normal @ relative,
            relative @ np.array([-normal[1], normal[0]]),
            normal,
            rates,
        )

    def rhs(
        self, x: np.ndarray, u: Inputs, gear: list[int], contact: int, on_floor: list[int]
    ) -> dict[str, np.ndarray]:
        """Rates, as the plant's state has them, in groups that share a scale."""
        p = self.p
        q, v = self.coordinates(x)
        r = turn(q)
        force = p.base_mass * point_rates(q, self.mass_centre).T @ self.gravity
        work = loss = 0.0
        rate = np.zeros(STATES)
        loads, depths = [], []
        for i in range(3):
            axle = r @ self.axles[i]
            radial = np.array([axle[0], axle[1], 0.0]) / math.hypot(axle[0], axle[1])
            rolling = np.cross([0.0, 0.0, 1.0], radial)
            point = self.lowest(q, i)
            # Velocity of the rim's material there: the body's motion plus the wheel's relative motion (positive about
            # -axle).
            rates = point_rates(q, point)
            hub = p.wheel_distance * self.axles[i] + np.array([0.0, 0.0, p.wheel_radius])
            rates[:, 6 + i] = r @ np.cross(-self.axles[i], point - hub)
            velocity = rates @ v
            height = q[2] + (r @ point)[2]
            depths.append(-height)
            load = (
                one_sided(p.wheel_floor_stiffness, -height, -velocity[2], p.wheel_floor_damping) if on_floor[i] else 0.0
            )
            loss += (load - (p.wheel_floor_stiffness * -height if on_floor[i] else 0.0)) * -velocity[2]
            loads.append(load)
            share = load / (p.base_mass * GRAVITY / 3.0)
            friction, bristle_rate = self.planar.roller(
                i, x[15 + i], velocity @ radial, self.planar.footing(i, x[12 + i], Modes())
            )
            grip_rate = self.grip_rate(i, x[GRIP + i], velocity @ rolling)
            traction = -share * (p.wheel_grip_stiffness * x[GRIP + i] + p.wheel_grip_damping * grip_rate)
            at_floor = traction * rolling - share * friction * radial + np.array([0.0, 0.0, load])
            force += rates.T @ at_floor
            loss -= traction * (velocity @ rolling) - share * friction * (velocity @ radial)
            torque = p.drivetrain_stiffness * (x[6 + i] - x[12 + i]) + p.drivetrain_damping * (x[9 + i] - v[6 + i])
            force[6 + i] += torque
            loss += p.drivetrain_damping * (x[9 + i] - v[6 + i]) ** 2
            drive = max(-p.drivetrain_torque_limit, min(p.drivetrain_torque_limit, u.motor_torque[i]))
            rate[15 + i], rate[GRIP + i] = on_floor[i] * bristle_rate, on_floor[i] * grip_rate
            rate[6 + i], rate[12 + i] = x[9 + i], v[6 + i]
            held = p.drivetrain_gear_coulomb * gear[i] + p.drivetrain_gear_viscous * x[9 + i]
            held *= p.drivetrain_friction_scale[i]
            rate[9 + i] = (drive - torque - held) / p.drivetrain_motor_inertia if gear[i] else 0.0
            work += drive * x[9 + i]
            loss += held * x[9 + i]
        push = np.array([*u.push_force, 0.0])
        pushed = point_rates(q, np.array([*u.push_point, p.push_height]))
        force += pushed.T @ push
        work += push @ pushed @ v
        hit = np.zeros(2)
        if p.slider_present:
            depth, depth_rate, slip, normal, rates = self.contact(x, q, v)
            if contact:
                size = one_sided(p.contact_stiffness, depth, depth_rate, p.contact_damping)
                shear = p.contact_friction * size * math.tanh(slip / p.contact_friction_speed)
                hit = -size * normal - shear * np.array([-normal[1], normal[0]])
                force += rates.T @ hit
                loss += (size - p.contact_stiffness * depth) * depth_rate + shear * slip
            rail = p.slider_friction * math.tanh(x[19] / p.slider_friction_speed) + p.slider_damping * x[19]
            loss += rail * x[19]
            rate[18] = x[19]
            rate[19] = -(rail + hit[0] * self.planar.ex + hit[1] * self.planar.ey) / p.slider_mass

        # d/dt (M v) - 1/2 grad(v M v) = force
        slopes = []
        for k in range(9):
            moved = q.astype(complex)
            moved[k] += 1j * STEP
            slopes.append(self.mass_matrix(moved).imag / STEP)
        turning = sum(slope * v[k] for k, slope in enumerate(slopes)) @ v
        bend = np.array([0.5 * v @ slope @ v for slope in slopes])
        a = np.linalg.solve(self.mass_matrix(q), force - turning + bend)

        rate[0:3], rate[HEAVE], rate[PITCH], rate[ROLL] = (v[0], v[1], v[3]), v[2], v[4], v[5]
        rate[3:6], rate[HEAVE_RATE] = (a[0], a[1], a[3]), a[2]
        moved = q + 1j * STEP * v
        spin = rotation_rates(q) @ a + (rotation_rates(moved).imag / STEP) @ v
        rate[ROLL_RATE], rate[PITCH_RATE] = spin[0], spin[1]
        for i, axle in enumerate(self.axles):
            rate[SPIN + i] = a[6 + i] - axle @ spin
        rate[24:28] = work, loss, *hit
        # What an accelerometer feels: d/dt of its velocity, less gravity, along the body's axes turned by its azimuth.
        place = np.array([p.imu_x, p.imu_y, p.imu_height])
        acceleration = point_rates(q, place) @ a + (point_rates(moved, place).imag / STEP) @ v
        felt = r.T @ (acceleration - self.gravity)
        ct, st = math.cos(p.imu_azimuth), math.sin(p.imu_azimuth)
        return {
            "rate": rate,
            "loads": np.array(loads),
            "depths": np.array(depths),
            "felt": np.array([ct * felt[0] + st * felt[1], ct * felt[1] - st * felt[0]]),
            "yaw rate": (rotation_rates(q) @ v)[2],
        }
