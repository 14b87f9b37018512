"""What a log may hold: names, units, and which input of the controller each becomes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from giveway.robot.wheels import WHEELS

__all__ = ["ANGLES", "CALIBRATION_UNITS", "PLAN", "QUANTITIES", "TIME", "TORQUES", "Quantity", "of_wheels"]

TIME = "time"
ANGLES = ("encoder", "motor_angle", "wheel_angle")
"""What says where the wheels are: counts or angles on the motor side, or angles behind the torque sensors."""
TORQUES = ("torque", "current")
PLAN = ("plan_x", "plan_y", "plan_theta", "plan_vx", "plan_vy", "plan_omega", "plan_ax", "plan_ay", "plan_alpha")
CALIBRATION_UNITS: Mapping[str, str] = {
    **{"s": "s", "ms": "ms", "us": "us", "ns": "ns", "rad": "rad", "deg": "deg", "nm": "N.m", "mnm": "mN.m"},
    **{"a": "A", "ma": "mA", "counts": "1"},
}
"""Units at the end of a name, as in the logs of `giveway calibrate`: time_s, torque_0_nm."""


@dataclass(frozen=True)
class Quantity:
    """``unit``: what it is converted to; ``controller``: the controller's input that takes it as it is."""

    unit: str
    controller: str | None
    meaning: str


def of_wheels(kind: str) -> tuple[str, ...]:
    """``torque``: torque_0 ... of every wheel."""
    return tuple(f"{kind}_{wheel}" for wheel in range(WHEELS))


def _wheels(kind: str, unit: str, controller: str | None, meaning: str) -> dict[str, Quantity]:
    return {
        name: Quantity(unit, None if controller is None else f"{controller}[{wheel}]", meaning.format(wheel=wheel))
        for wheel, name in enumerate(of_wheels(kind))
    }


QUANTITIES: Mapping[str, Quantity] = {
    TIME: Quantity("s", None, "time of the row"),
    **_wheels("encoder", "1", "sensor.encoder", "counts of encoder {wheel} on the motor side, at the wheel axle"),
    **_wheels("motor_angle", "rad", None, "angle of motor {wheel}, at the wheel axle"),
    **_wheels("wheel_angle", "rad", None, "angle of wheel {wheel}, behind its torque sensor"),
    **_wheels("torque", "N.m", "sensor.torque", "torque that drivetrain {wheel} delivers to its wheel"),
    **_wheels("current", "A", None, "current of motor {wheel}"),
    "sensor_counter": Quantity("1", "sensor.counter", "sample counter of the sensors"),
    "sensor_present": Quantity("1", "sensor.present", "1: there is a sample; 0: it is missing"),
    "acceleration_x": Quantity("m/s2", "sensor.acceleration[0]", "first axis of the accelerometer"),
    "acceleration_y": Quantity("m/s2", "sensor.acceleration[1]", "second axis of the accelerometer"),
    "yaw_rate": Quantity("rad/s", "sensor.yaw_rate", "yaw rate of the gyro"),
    "imu_counter": Quantity("1", "sensor.imu_counter", "sample counter of the IMU"),
    "imu_present": Quantity("1", "sensor.imu_present", "1: there is a sample of the IMU"),
    **{
        name: Quantity(unit, f"plan.{name.removeprefix('plan_')}", "planned motion, world frame")
        for name, unit in zip(PLAN, ["m", "m", "rad", "m/s", "m/s", "rad/s", "m/s2", "m/s2", "rad/s2"], strict=True)
    },
    "stop_request": Quantity("1", "stop_request", "1: the robot is asked to stop"),
    "tare_request": Quantity("1", "tare_request", "1: a new tare is asked for"),
}
"""By name."""
