"""From samples of a log to the controller's inputs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.errors import GivewayError
from giveway.replay.mapping import Chosen
from giveway.replay.quantities import PLAN, QUANTITIES, TIME, of_wheels
from giveway.replay.sampling import Sampled
from giveway.robot.variables import Value, table
from giveway.robot.wheels import AZIMUTHS_RAD, WHEELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["HELD", "Inputs", "Steps", "columns_for", "jump_radps", "value_of", "wheels_at_azimuths", "wrapped"]

HELD = ("sensor_counter", "sensor_present", "imu_counter", "imu_present", "stop_request", "tare_request")
_IMU = ("acceleration_x", "acceleration_y", "yaw_rate")
_COUNT_RANGE = 2.0**32


def value_of(parameters: Mapping[str, Value], name: str) -> float:
    """A parameter of the controller, its start value if it is not set."""
    value = parameters.get(name, table("controller")[name].start)
    assert value is not None
    return float(value)


def jump_radps(parameters: Mapping[str, Value]) -> float:
    """The speed of a wheel, rad/s, above which the controller takes a change of its encoder for a jump."""
    counts_per_s = value_of(parameters, "sensor_check.encoder_jump") / value_of(parameters, "controller.period")
    return counts_per_s * 2.0 * math.pi / value_of(parameters, "estimator.encoder_counts")


def wheels_at_azimuths(parameters: Mapping[str, Value]) -> list[int]:
    """The wheel at each azimuth of the model."""
    slots = [int(value_of(parameters, f"geometry.wheel_slot[{wheel}]")) for wheel in range(WHEELS)]
    return [slots.index(slot) for slot in range(len(AZIMUTHS_RAD))]


@dataclass(frozen=True)
class Steps:
    """Successive steps: the controller's inputs by name, and what they were made of.

    Attributes:
        first: number of the first.
        angle_rad: of the motors, at the wheel axle, (n, wheels).
        torque_nm: (n, wheels).
        present: whether there is a sample.
        yaw_rate: rad/s; None: the log has none.
    """

    first: int
    inputs: dict[str, NDArray[Any]]
    angle_rad: NDArray[np.float64]
    torque_nm: NDArray[np.float64]
    present: NDArray[np.bool_]
    yaw_rate: NDArray[np.float64] | None


@dataclass
class Inputs:
    """Makes `Steps` of samples.

    Args:
        chosen: the columns of the samples.
        parameters: of the controller.
        torque_constant: N m at the wheel per A, for a log of currents.
        exact: the rows are the steps, so that counters of the log are those of the steps.
    """

    chosen: Chosen
    parameters: Mapping[str, Value]
    torque_constant: float | None = None
    exact: bool = False

    def __post_init__(self) -> None:
        self._at = {column.quantity: index for index, column in enumerate(self.chosen.columns)}
        self._counts = value_of(self.parameters, "estimator.encoder_counts")
        self._stiffness = value_of(self.parameters, "estimator.drivetrain_stiffness")
        if self.chosen.torque == "current" and self.torque_constant is None:
            raise GivewayError(
                "--torque-constant",
                "nothing",
                "N.m at the wheel per A (gear ratio times the motor's constant): the log has currents",
            )

    @property
    def angles(self) -> tuple[str, ...]:
        """The columns without which there is no sample."""
        return of_wheels(self.chosen.angle)

    @property
    def has_plan(self) -> bool:
        return self.chosen.has(*PLAN)

    @property
    def has_imu(self) -> bool:
        return self.chosen.has(*_IMU)

    def of(self, sampled: Sampled) -> Steps:
        values, count = sampled.values, len(sampled.present)
        numbers = np.arange(sampled.first, sampled.first + count)
        torque = self._wheels(values, self.chosen.torque)
        if self.chosen.torque == "current":
            torque = torque * (self.torque_constant or 0.0)
        counts, angle = self._angles(values, torque)
        inputs: dict[str, NDArray[Any]] = {}
        for wheel in range(WHEELS):
            inputs[f"sensor.torque[{wheel}]"] = torque[:, wheel]
            inputs[f"sensor.encoder[{wheel}]"] = wrapped(counts[:, wheel])
        inputs["sensor.counter"] = self._whole(values, "sensor_counter", numbers)
        inputs["sensor.present"] = sampled.present & (self._whole(values, "sensor_present", np.ones(count)) != 0)
        for name in ("stop_request", "tare_request"):
            if name in self._at:
                inputs[name] = self._whole(values, name, numbers) != 0
        if self.has_imu:
            for name in _IMU:
                inputs[str(QUANTITIES[name].controller)] = values[:, self._at[name]]
            inputs["sensor.imu_counter"] = self._whole(values, "imu_counter", numbers)
            there = self._whole(values, "imu_present", np.ones(count)) != 0
            inputs["sensor.imu_present"] = there & sampled.present if "imu_present" not in self._at else there
        if self.has_plan:
            for name in PLAN:
                inputs[str(QUANTITIES[name].controller)] = values[:, self._at[name]]
        yaw = values[:, self._at["yaw_rate"]] if "yaw_rate" in self._at else None
        return Steps(sampled.first, inputs, angle, torque, inputs["sensor.present"], yaw)

    def _wheels(self, values: NDArray[np.float64], kind: str) -> NDArray[np.float64]:
        return values[:, [self._at[name] for name in of_wheels(kind)]]

    def _angles(
        self, values: NDArray[np.float64], torque: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Counts, and angles of the motors, rad; 0 where there are none."""
        found = self._wheels(values, self.chosen.angle)
        found = np.where(np.isfinite(found), found, 0.0)
        per_rad = self._counts / (2.0 * math.pi)
        if self.chosen.angle == "encoder":
            return np.rint(found), found / per_rad
        if self.chosen.angle == "wheel_angle" and self._stiffness > 0.0:
            found = found + np.where(np.isfinite(torque), torque, 0.0) / self._stiffness
        return np.rint(found * per_rad), found

    def _whole(self, values: NDArray[np.float64], name: str, otherwise: NDArray[Any]) -> NDArray[np.int32]:
        """A column of whole numbers; ``otherwise`` where the log has none, or they were those of rows, not of steps."""
        of_rows = name.endswith("_counter") and not self.exact
        if name not in self._at or of_rows:
            return wrapped(otherwise.astype(np.float64))
        found = values[:, self._at[name]]
        return wrapped(np.rint(np.where(np.isfinite(found), found, 0.0)))


def wrapped(values: NDArray[np.float64]) -> NDArray[np.int32]:
    """Whole numbers at 32 bits."""
    return np.mod(values, _COUNT_RANGE).astype(np.uint32).view(np.int32)


def columns_for(chosen: Chosen, encoder_bits: int) -> tuple[list[str], list[int], dict[int, float], list[int]]:
    """Names, columns that are held, periods of those that wrap, and the angles, for `Sampling`."""
    names = [column.quantity for column in chosen.columns]
    assert names[0] == TIME
    held = [index for index, name in enumerate(names) if name in HELD]
    angles = [names.index(name) for name in of_wheels(chosen.angle)]
    period = 2.0**encoder_bits if chosen.angle == "encoder" else 2.0 * math.pi
    return names, held, dict.fromkeys(angles, period), angles
