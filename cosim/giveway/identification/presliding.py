"""Presliding: the force that rollers at rest carry, and how to identify three stiffnesses from a few known pushes.

A roller that does not roll is a spring along its wheel's axle. A static push on the unpowered robot is carried by the
three drivetrains, which the torque sensors feel, and by the three rollers, which they do not::

    (k J_w^T J_w + sum_i s_i n_i n_i^T) d = W      T = -k J_w d      felt: -J_w^T T = k J_w^T J_w d

with the wrench W of the push (38), the small displacement d of the base that it causes, the drivetrain stiffness k,
the roller stiffnesses s_i and the wheels' radial directions n_i. The roller forces pass through the centre: the yaw
moment is felt in full. Only s/k matters for a static push, so a wrong k is repaired by the s that are found with it.

Base frame everywhere: x forward, y left; forces are ON the robot.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.checks import finite
from giveway.base.errors import GivewayError
from giveway.robot.robot_file import read_robot
from giveway.robot.variables import table
from giveway.robot.wheels import AZIMUTHS_RAD, WHEELS

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["Base", "Calibration", "KnownPush", "calibrate", "felt_wrench", "static_torques"]

FORCE_MAXIMUM_N, LENGTH_MAXIMUM_M, TORQUE_MAXIMUM_NM = 1e4, 10.0, 1e4
# The moment of a push is felt in full, so the felt one tells a wrong point, unit, sign or wheel order from presliding.
# A quarter of R F is a push 6 cm from its stated point on Trikey: more than the error of a careful hand.
MOMENT_TOLERANCE = 0.25
# One standard deviation of s_i may be this share of the drivetrain's stiffness at the floor: the force of a push on
# that wheel's roller is then wrong by at most the same share of what the wheel feels.
SIGMA_TOLERANCE = 0.1
# Largest residual of the fitted stiffnesses, as a share of the known forces: with a larger one, a calibrated robot
# would have this error in the force of a push. A roller that slipped, a robot that moved or wheels in another order
# leave more.
RESIDUAL_TOLERANCE = 0.1
# Beyond this many standard deviations below zero a stiffness is not small but wrong.
NEGATIVE_SIGMAS = 3.0


@dataclass(frozen=True)
class Base:
    """The numbers of a robot for the static model.

    Attributes:
        wheel_radius_m: r_w, above 0.
        wheel_distance_m: R, centre to wheel, above 0.
        drivetrain_stiffness_nm_per_rad: k, encoder to wheel, above 0.
        azimuth_rad: of the three wheels in the base frame, 120 deg apart.
    """

    wheel_radius_m: float
    wheel_distance_m: float
    drivetrain_stiffness_nm_per_rad: float
    azimuth_rad: tuple[float, ...] = AZIMUTHS_RAD

    def __post_init__(self) -> None:
        for name in ("wheel_radius_m", "wheel_distance_m", "drivetrain_stiffness_nm_per_rad"):
            finite(f"Base.{name}", getattr(self, name), 1e-6, 1e9)

    @classmethod
    def of_robot(cls, robot: Path | None = None) -> Base:
        """From a robot file, or the robot that giveway was built with."""
        variables = table("controller")
        names = ("geometry.wheel_radius", "geometry.wheel_distance", "estimator.drivetrain_stiffness")
        values = {variable.name: variable.start for variable in variables}
        if robot is not None:
            values |= variables.robot_values(read_robot(robot))
        radius, distance, stiffness = (float(values[name] or 0.0) for name in names)
        return cls(radius, distance, stiffness)

    @property
    def stiffness_at_floor_n_per_m(self) -> float:
        """k_w = k/r_w^2."""
        return self.drivetrain_stiffness_nm_per_rad / self.wheel_radius_m**2

    @property
    def radial(self) -> NDArray[np.float64]:
        """n_i, shape (3 wheels, 2)."""
        return np.stack([np.cos(self.azimuth_rad), np.sin(self.azimuth_rad)], axis=1)

    @property
    def wheel_jacobian(self) -> NDArray[np.float64]:
        """J_w (14), 1/m and 1: wheel rates from (vx, vy, omega), shape (3, 3)."""
        distance = np.full(WHEELS, self.wheel_distance_m)
        columns = [-np.sin(self.azimuth_rad), np.cos(self.azimuth_rad), distance]
        return np.stack(columns, axis=1) / self.wheel_radius_m


@dataclass(frozen=True)
class KnownPush:
    """A push whose force is known, and what the torque sensors read.

    Attributes:
        force_n: (x, y) of the force ON the robot, base frame, N: a weight of m kg over a pulley is 9.81 m.
        point_m: (x, y) of where it acts, base frame, m.
        torque_nm: change of the three wheels' torques, N m: mean during the push minus mean before.
    """

    force_n: tuple[float, float]
    point_m: tuple[float, float]
    torque_nm: tuple[float, float, float]

    @property
    def wrench(self) -> NDArray[np.float64]:
        """Force (N) and moment about the centre (N m), shape (3,)."""
        (fx, fy), (px, py) = self.force_n, self.point_m
        return np.array([fx, fy, px * fy - py * fx])


@dataclass(frozen=True)
class Calibration:
    """The three stiffnesses of one robot.

    Attributes:
        stiffness_n_per_m: s_i at the floor, shape (3,).
        sigma_n_per_m: one standard deviation of each, shape (3,): from the torque noise, or from what the pushes
            disagree by where that is more.
        force_residual_n: rms of what the fitted model leaves of the known forces.
        moment_residual_nm: rms of felt minus known moment: how well the points are known, presliding apart.
    """

    stiffness_n_per_m: NDArray[np.float64]
    sigma_n_per_m: NDArray[np.float64]
    force_residual_n: float
    moment_residual_nm: float

    def controller_parameters(self) -> dict[str, float]:
        """Parameters for compensation in the controller: for ``Scenario.controller``, or ``--set controller.NAME=``."""
        allowed = table("controller")["estimator.presliding_stiffness[0]"]
        within = np.clip(self.stiffness_n_per_m, allowed.minimum, allowed.maximum)
        stiffness = {f"estimator.presliding_stiffness[{wheel}]": float(s) for wheel, s in enumerate(within)}
        return {"estimator.friction_model": 1, **stiffness}


def static_torques(base: Base, stiffness_n_per_m: ArrayLike, wrench: ArrayLike) -> NDArray[np.float64]:
    """Sensed torques (N m) of the unpowered robot under static pushes, rollers and gears stuck.

    ``stiffness_n_per_m`` has shape (..., 3 wheels), ``wrench`` shape (..., 3): Fx, Fy (N) and moment (N m) about the
    centre; both broadcast against each other.
    """
    jacobian, k = base.wheel_jacobian, base.drivetrain_stiffness_nm_per_rad
    radial = np.zeros((WHEELS, 3))
    radial[:, :2] = base.radial
    rollers = np.einsum("...i,ia,ib->...ab", np.asarray(stiffness_n_per_m, dtype=np.float64), radial, radial)
    displacement = np.linalg.solve(k * jacobian.T @ jacobian + rollers, np.asarray(wrench, dtype=np.float64)[..., None])
    return np.asarray(-k * (jacobian @ displacement)[..., 0])


def felt_wrench(base: Base, torque_nm: ArrayLike) -> NDArray[np.float64]:
    """Fx, Fy (N) and moment (N m) computed from the torques alone (38) at rest; shapes (..., 3) to (..., 3)."""
    return np.asarray(-np.asarray(torque_nm, dtype=np.float64) @ base.wheel_jacobian)


def calibrate(pushes: Sequence[KnownPush], base: Base | None = None, torque_sigma_nm: float = 0.005) -> Calibration:
    """The presliding stiffness of each wheel's roller from known static pushes: three of different directions do.

    The robot stands unpowered (or its motors hold still); each push is static and weak enough that no roller slips:
    about 10 N on Trikey. Least squares on the two force components of each push; two pushes of different directions
    are the least that tells three stiffnesses apart, each further one averages noise.

    Args:
        pushes: known force and point, and the torques read; see `KnownPush` for units.
        base: the robot's geometry and drivetrain stiffness; None for the robot that giveway was built with.
        torque_sigma_nm: standard deviation of one torque of ``pushes``, N m, above 0. Means of 100 samples of 0.03 N m
            before and during the push make 0.004.

    Raises:
        GivewayError: a number is not finite or out of range; the felt moment of a push contradicts its known one
            (wrong point, unit, sign or order of wheels); the pushes do not tell the stiffnesses apart, or only to worse
            than a tenth of the drivetrain's stiffness at the floor; a stiffness comes out negative; or no stiffnesses
            explain all pushes to within a tenth of their force (a roller slipped, wheels in another order).
    """
    base = Base.of_robot() if base is None else base
    finite("torque_sigma_nm", torque_sigma_nm, 1e-9, TORQUE_MAXIMUM_NM, "N m")
    if len(pushes) < 2:
        raise GivewayError("pushes", f"a number of {len(pushes)}", "at least 2, better 3, of different directions")
    for index, push in enumerate(pushes):
        _check(f"pushes[{index}]", push, base)
    torques = np.array([push.torque_nm for push in pushes], dtype=np.float64)
    known = np.stack([push.wrench for push in pushes])
    felt = felt_wrench(base, torques)
    displacement = -np.linalg.solve(base.wheel_jacobian, torques.T).T / base.drivetrain_stiffness_nm_per_rad
    # The rollers carry the force that the wheels do not feel: sum_i s_i n_i (n_i . d) = F - felt. Linear in s.
    deflection = displacement[:, :2] @ base.radial.T
    design = (base.radial.T[None] * deflection[:, None, :]).reshape(-1, WHEELS)
    missing = (known - felt)[:, :2].reshape(-1)
    stiffness = _solve(design, missing)
    residual = (missing - design @ stiffness).reshape(-1, 2)
    covariance = _noise(base, stiffness, torque_sigma_nm)
    sigma = _sigma(design, covariance)
    _judge(base, stiffness, sigma, _rms(residual) / _rms(known[:, :2]))
    # Pushes may disagree by more than the torque noise: points and forces are never known exactly.
    chi_square = float(np.einsum("pa,ab,pb->", residual, np.linalg.inv(covariance), residual))
    return Calibration(
        stiffness_n_per_m=np.maximum(stiffness, 0.0),
        sigma_n_per_m=sigma * math.sqrt(max(1.0, chi_square / (residual.size - WHEELS))),
        force_residual_n=_rms(residual),
        moment_residual_nm=_rms((felt - known)[:, 2:]),
    )


def _rms(vectors: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(np.sum(vectors**2, axis=1))))


def _check(name: str, push: KnownPush, base: Base) -> None:
    limits = {
        "force_n": (2, FORCE_MAXIMUM_N, "N"),
        "point_m": (2, LENGTH_MAXIMUM_M, "m"),
        "torque_nm": (WHEELS, TORQUE_MAXIMUM_NM, "N m"),
    }
    for attribute, (count, limit, unit) in limits.items():
        values = getattr(push, attribute)
        if len(values) != count:
            raise GivewayError(f"{name}.{attribute}", f"a number of {len(values)}", f"{count} numbers in {unit}")
        for value in values:
            number = float(value) if isinstance(value, np.number) else value
            finite(f"{name}.{attribute}", number, -limit, limit, unit)
    force = math.hypot(*push.force_n)
    if force == 0.0:
        raise GivewayError(f"{name}.force_n", push.force_n, "a force other than zero")
    moment, felt = float(push.wrench[2]), float(felt_wrench(base, push.torque_nm)[2])
    tolerance = MOMENT_TOLERANCE * base.wheel_distance_m * force
    if abs(felt - moment) > tolerance:
        allowed = f"the push's {moment:.3g} ± {tolerance:.2g} N m (else point, unit, sign or order of wheels is wrong)"
        raise GivewayError(f"{name}.torque_nm", f"a moment of {felt:.3g} N m", allowed)


def _solve(design: NDArray[np.float64], missing: NDArray[np.float64]) -> NDArray[np.float64]:
    stiffness, _, rank, _ = np.linalg.lstsq(design, missing, rcond=1e-6)
    if rank < WHEELS:
        least = f"{rank} of {WHEELS} stiffnesses"
        raise GivewayError("pushes", f"pushes that identify {least}", "pushes along at least two different directions")
    return np.asarray(stiffness)


def _noise(base: Base, stiffness: NDArray[np.float64], torque_sigma_nm: float) -> NDArray[np.float64]:
    """Covariance (N^2) of one push's two equations: a torque enters the felt force, and the load of the rollers."""
    jacobian, radial = base.wheel_jacobian, base.radial
    to_displacement = np.linalg.inv(jacobian)[:2] / base.drivetrain_stiffness_nm_per_rad
    noise = (jacobian.T[:2] + (radial.T * stiffness) @ radial @ to_displacement) * torque_sigma_nm
    return np.asarray(noise @ noise.T)


def _sigma(design: NDArray[np.float64], covariance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Standard deviations of the stiffnesses from torque noise, shape (3,)."""
    shares = np.linalg.pinv(design).reshape(WHEELS, -1, 2)
    return np.asarray(np.sqrt(np.einsum("ipa,ab,ipb->i", shares, covariance, shares)))


def _judge(base: Base, stiffness: NDArray[np.float64], sigma: NDArray[np.float64], residual: float) -> None:
    allowed = SIGMA_TOLERANCE * base.stiffness_at_floor_n_per_m
    worst = int(np.argmax(sigma))
    if not sigma[worst] <= allowed:
        found = f"pushes that leave wheel {worst} uncertain by {sigma[worst]:.3g} N/m"
        raise GivewayError("pushes", found, f"pushes that tell it to {allowed:.3g} N/m: more, or other directions")
    if residual > RESIDUAL_TOLERANCE:
        found = f"pushes that no three stiffnesses explain to better than {100.0 * residual:.0f} %"
        share = f"{100.0 * RESIDUAL_TOLERANCE:.0f} % (did a roller slip, the robot move, are the wheels in order?)"
        raise GivewayError("pushes", found, share)
    least = int(np.argmin(stiffness))
    if stiffness[least] < -NEGATIVE_SIGMAS * sigma[least]:
        found = f"torques that make the stiffness of wheel {least} {stiffness[least]:.3g} N/m"
        raise GivewayError("pushes", found, "torques smaller than pushes make without rollers (sign, unit, wheels?)")
