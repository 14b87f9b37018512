"""The torques of free motion (27) in the base frame, where the Jacobians are constant."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway.robot.wheels import AZIMUTHS_RAD, WHEELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.robot.robot_file import Robot

__all__ = ["TorqueModel"]


@dataclass(frozen=True)
class TorqueModel:
    """A base on three omniwheels: the numbers of (27), with units in the names."""

    wheel_radius_m: float
    wheel_distance_m: float
    roller_radius_m: float
    mass_kg: float
    yaw_inertia_kgm2: float
    wheel_inertia_kgm2: float
    roller_inertia_kgm2: float

    @classmethod
    def of(cls, robot: Robot) -> TorqueModel:
        """From a robot file."""
        return cls(
            wheel_radius_m=float(robot.value("wheel.radius")),
            wheel_distance_m=float(robot.value("wheel.distance")),
            roller_radius_m=float(robot.value("roller.radius")),
            mass_kg=float(robot.value("base.mass")),
            yaw_inertia_kgm2=float(robot.value("base.yaw_inertia")),
            wheel_inertia_kgm2=float(robot.value("wheel.inertia")),
            roller_inertia_kgm2=float(robot.value("roller.inertia")),
        )

    @property
    def wheel_jacobian(self) -> NDArray[np.float64]:
        """J_w (15) in the base frame, shape (3, 3)."""
        _, tangent = self._axes
        return np.column_stack([tangent, np.full(WHEELS, self.wheel_distance_m)]) / self.wheel_radius_m

    @property
    def roller_jacobian(self) -> NDArray[np.float64]:
        """J_r (16) in the base frame, shape (3, 3)."""
        radial, _ = self._axes
        return np.column_stack([radial, np.zeros(WHEELS)]) / self.roller_radius_m

    @property
    def _axes(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        cos, sin = np.cos(AZIMUTHS_RAD), np.sin(AZIMUTHS_RAD)
        return np.column_stack([cos, sin]), np.column_stack([-sin, cos])

    def motion(
        self, rate: NDArray[np.float64], acceleration: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Roller rates (rad/s) and the frictionless part of the torques (27) (N m), both shape (n, 3).

        ``rate`` and ``acceleration`` are those of the wheels, shape (n, 3).
        """
        radial, tangent = self._axes
        inverse = np.linalg.inv(self.wheel_jacobian)
        twist = rate @ inverse.T
        yaw_rate = twist[:, 2:]
        # The base axes turn: (29) and (30) without their world-frame Jacobians.
        base = (acceleration + yaw_rate * (twist[:, :2] @ radial.T) / self.wheel_radius_m) @ inverse.T
        roller_rate = twist @ self.roller_jacobian.T
        slip = yaw_rate * (twist[:, :2] @ tangent.T) / self.roller_radius_m
        roller_acceleration = base @ self.roller_jacobian.T + slip
        wrench = base * (self.mass_kg, self.mass_kg, self.yaw_inertia_kgm2)
        wrench += self.roller_inertia_kgm2 * roller_acceleration @ self.roller_jacobian
        return roller_rate, wrench @ inverse + self.wheel_inertia_kgm2 * acceleration

    @property
    def friction_gain(self) -> NDArray[np.float64]:
        """Wheel torques per roller friction torque, J_w^-T J_r^T, shape (3, 3)."""
        return np.linalg.inv(self.wheel_jacobian).T @ self.roller_jacobian.T
