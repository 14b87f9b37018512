"""Every entry of a new robot file: asked, or estimated from what was asked, by a rule that the file states.

The rules scale Trikey, whose numbers were partly fitted to measurements: forces with the weight, stiffnesses so that
natural frequencies stay. They are starting points: `giveway robot check` lists them until they have a better source.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from giveway.base.gravity import GRAVITY_MPS2
from giveway.own_robot.body import Plate, plate

if TYPE_CHECKING:
    from giveway.own_robot.measured import Measured

__all__ = ["ENTRIES", "Entry", "Known", "Part"]

TRIKEY_KG = 34.7
Number = float | int


class Known:
    """What was asked, and what follows from it at once."""

    def __init__(self, asked: Measured) -> None:
        self.asked = asked
        self.mass, self.radius, self.distance = asked.mass, asked.wheel_radius, asked.wheel_distance
        self.plate: Plate = plate(asked.outline)
        self.share = self.mass / TRIKEY_KG
        self.clearance = asked.clearance if asked.clearance is not None else min(self.radius, 0.5 * asked.height)
        self.com_height = asked.com_height if asked.com_height is not None else 0.45 * asked.height
        # Mass that a wheel carries, and the base's inertia at one wheel in straight motion.
        self.wheel_load_n = self.mass * GRAVITY_MPS2 / 3.0
        self.load_inertia = self.mass * self.radius**2 / 1.5
        self.torque_limit = asked.torque_limit if asked.torque_limit is not None else self._torque_limit()
        self.gear_friction = asked.gear_friction if asked.gear_friction is not None else 0.1 * self.torque_limit
        self.roller_radius = 0.09375 * self.radius
        self.roller_friction_n = 0.1 * self.wheel_load_n
        self.motor_inertia = 0.2 * self.load_inertia
        self.stiffness = self.load_inertia * (2.0 * math.pi * 9.0) ** 2
        self.tip_limit = GRAVITY_MPS2 * 0.5 * self.distance / self.com_height
        self.slider = 0.25 * self.mass

    def _torque_limit(self) -> float:
        return 2.5 * self.mass * 3.0 * self.radius / math.sqrt(3.0)

    @property
    def by_current(self) -> bool:
        """Whether torque comes from motor current."""
        return self.asked.torque_constant is not None

    @property
    def current_range(self) -> float:
        """What the current sensors measure to either side, A."""
        assert self.asked.torque_constant is not None
        assert self.asked.gear_ratio is not None
        return 1.4 * self.torque_limit / (self.asked.torque_constant * self.asked.gear_ratio)

    @property
    def drive_limit(self) -> float:
        """Acceleration that half of the drives' torque gives in the weakest direction, m/s2."""
        return 0.5 * math.sqrt(3.0) * self.torque_limit / self.radius / self.mass


@dataclass(frozen=True)
class Entry:
    """An entry: its value from `Known`, the rule in words, or ``asked``: the question that answers it.

    ``by_current``: only robots whose torque comes from motor current have it, or (False) only the others.
    """

    name: str
    unit: str
    value: Callable[[Known], Number | str | Sequence[float]]
    rule: str
    asked: str = ""
    by_current: bool | None = None


@dataclass(frozen=True)
class Part:
    """Entries under one heading; ``remark``: lines of comment below it."""

    heading: str
    entries: tuple[Entry, ...]
    remark: str = ""
    imu: bool = False


def _same(value: Number | str) -> Callable[[Known], Number | str]:
    return lambda _known: value


def _inertia_scale(known: Known) -> float:
    return (known.radius / 0.1016) ** 4


ENTRIES: tuple[Part, ...] = (
    Part(
        "Base",
        (
            Entry("base.mass", "kg", lambda k: k.mass, "", "mass"),
            Entry(
                "base.yaw_inertia", "kg.m2", lambda k: k.mass * k.plate.gyration_m**2,
                "even body of the outline's shape; swing the robot on two ropes to measure it",
            ),
            Entry(
                "base.com_height", "m", lambda k: k.com_height, "45 % of the body's height: batteries are low",
                "com-height",
            ),
            Entry(
                "base.tilt_inertia", "kg.m2",
                lambda k: k.mass * (0.5 * k.plate.gyration_m**2 + (k.asked.height - k.clearance) ** 2 / 12.0)
                + 0.002 * _inertia_scale(k) * 3.0,
                "even body of the outline's shape and height",
            ),
        ),
        "Wheels included. The yaw inertia is about the vertical axis, the tilt inertia about a horizontal one through\n"
        "the centre of mass.",
    ),
    Part(
        "Wheels and rollers",
        (
            Entry("wheel.radius", "m", lambda k: k.radius, "", "wheel-radius"),
            Entry("wheel.distance", "m", lambda k: k.distance, "", "wheel-distance"),
            Entry(
                "wheel.inertia", "kg.m2", lambda k: 0.0028 * _inertia_scale(k),
                "Trikey's wheel, with the fourth power of the radius",
            ),
            Entry("wheel.width", "m", lambda k: 0.25 * k.radius, "a quarter of the radius"),
            Entry(
                "wheel.floor_stiffness", "N/m", lambda k: k.wheel_load_n / 6e-4,
                "0.6 mm deflection under the robot's weight",
            ),
            Entry("wheel.floor_damping", "s/m", _same(2.0), "a tenth of critical under the robot's weight"),
            Entry("wheel.grip_friction", "1", _same(0.7), "polyurethane rollers on a hard floor"),
            Entry(
                "wheel.grip_stiffness", "N/m", lambda k: 30.0 * k.stiffness / k.radius**2,
                "30 times as stiff as the drivetrain",
            ),
            Entry(
                "wheel.grip_damping", "N.s/m",
                lambda k: 2.0 / 3.0
                * math.sqrt(30.0 * k.stiffness * 0.0028 * _inertia_scale(k)) / k.radius**2,
                "a third of critical for the wheel's own inertia",
            ),
            Entry("roller.radius", "m", lambda k: k.roller_radius, "Trikey's share of the wheel's radius"),
            Entry(
                "roller.inertia", "kg.m2", lambda k: 1.23e-6 * (k.roller_radius / 0.009525) ** 4,
                "Trikey's roller, with the fourth power of the radius",
            ),
            Entry(
                "roller.coulomb_torque", "N.m", lambda k: k.roller_friction_n * k.roller_radius,
                "a tenth of the wheel's load at the floor; `giveway calibrate` measures it",
            ),
            Entry(
                "roller.tanh_slope", "s/rad", lambda k: k.roller_radius / 0.024,
                "friction is there from 24 mm/s on; `giveway calibrate` measures it",
            ),
            Entry(
                "roller.presliding_stiffness", "N/m", lambda k: k.roller_friction_n / 7e-4,
                "0.7 mm until the rollers slide",
            ),
            Entry(
                "roller.presliding_damping", "N.s/m",
                lambda k: 20.0 * math.sqrt(k.roller_friction_n / 7e-4 / 28900.0 * k.share),
                "Trikey's share of critical",
            ),
            Entry("roller.stribeck_speed", "m/s", _same(0.0025), "as Trikey's"),
            Entry("roller.elastic_fraction", "1", _same(0.7), "as Trikey's"),
        ),
        "Three omniwheels, 120 degrees apart, the first straight ahead (x). roller.coulomb_torque is at the roller.",
    ),
    Part(
        "Rollers one by one (`roller.arrangement`)",
        (
            Entry("roller.rows", "1", _same(2), "two staggered rows"),
            Entry("roller.per_row", "1", _same(9), "18 rollers in both rows"),
            Entry("roller.row_distance", "m", lambda k: 0.125 * k.radius, "half of the wheel's width"),
            Entry("roller.radius_dip", "m", lambda k: 1e-3 * k.radius, "a thousandth of the wheel's radius"),
            Entry("roller.friction_scatter", "1", _same(0.1), "from roller to roller, to both sides"),
        ),
    ),
    Part(
        "Drivetrain, reflected to the wheel axle",
        (
            Entry(
                "drivetrain.motor_inertia", "kg.m2", lambda k: k.motor_inertia,
                "a fifth of the base's inertia at a wheel; rotor times gear ratio squared",
            ),
            Entry(
                "drivetrain.stiffness", "N.m/rad", lambda k: k.stiffness,
                "gear, shaft and sensor in series: the base swings on it at 9 Hz",
            ),
            Entry(
                "drivetrain.damping", "N.m.s/rad", lambda k: 0.06 * math.sqrt(k.stiffness * k.load_inertia),
                "3 % of critical for the base on its drivetrains",
            ),
            Entry(
                "drivetrain.gear_coulomb", "N.m", lambda k: k.gear_friction, "a tenth of the torque limit",
                "gear-friction",
            ),
            Entry(
                "drivetrain.gear_stiction", "N.m", lambda k: k.gear_friction, "as while it turns", "gear-friction",
            ),
            Entry("drivetrain.gear_viscous", "N.m.s/rad", lambda k: 1e-3 * k.torque_limit, "small"),
            Entry(
                "drivetrain.torque_limit", "N.m", lambda k: k.torque_limit,
                "2.5 times what accelerates the robot at 3 m/s2", "torque-limit",
            ),
            Entry(
                "drivetrain.torque_sensor_limit", "N.m", lambda k: 1.4 * k.torque_limit,
                "1.4 times the torque limit: usable range to either side", by_current=False,
            ),
            Entry(
                "drivetrain.torque_sensor_resolution", "N.m", lambda k: 2.8 * k.torque_limit / 4096.0,
                "12 bit of the sensor's range", by_current=False,
            ),
            Entry(
                "drivetrain.torque_noise", "N.m",
                lambda k: k.asked.torque_noise if k.asked.torque_noise is not None else 1.5e-3 * k.torque_limit,
                "0.15 % of the torque limit", "torque-noise", by_current=False,
            ),
            Entry("drivetrain.sensing", "", _same("motor current"), "", "torque-constant", by_current=True),
            Entry("motor.gear_ratio", "1", lambda k: k.asked.gear_ratio or 0.0, "", "gear-ratio", by_current=True),
            Entry(
                "motor.torque_constant", "N.m/A", lambda k: k.asked.torque_constant or 0.0, "", "torque-constant",
                by_current=True,
            ),
            Entry(
                "motor.current_range", "A", lambda k: k.current_range,
                "1.4 times what the torque limit takes: usable range to either side", by_current=True,
            ),
            Entry(
                "motor.current_resolution", "A", lambda k: k.current_range / 2048.0, "12 bit of the range",
                by_current=True,
            ),
            Entry(
                "motor.current_noise", "A", lambda k: 4e-3 * k.current_range,
                "0.4 % of the range; log the current of a motor that holds still to measure it", by_current=True,
            ),
            Entry(
                "drivetrain.encoder_counts", "1",
                lambda k: 8192 if k.asked.encoder_counts is None else int(k.asked.encoder_counts),
                "a usual encoder", "encoder-counts",
            ),
        ),
    ),
    Part(
        "2 kHz joint servo in the drives",
        (
            Entry("servo.kp", "N.m/rad", lambda k: 3600.0 * k.motor_inertia, "60 rad/s with the motor's inertia"),
            Entry("servo.kd", "N.m.s/rad", lambda k: 132.0 * k.motor_inertia, "1.1 of critical"),
            Entry("servo.derivative_cutoff", "Hz", _same(60.0), "as Trikey's"),
        ),
    ),
    Part(
        "Drive electronics",
        (Entry("electronics.bus_delay", "1", _same(1), "one 1 ms cycle each way"),),
    ),
    Part(
        "Accelerometer and gyro",
        (
            Entry("testbed.imu.present", "", _same(True), ""),
            Entry("imu.height", "m", lambda k: k.com_height, "the centre of mass's, where it should be"),
            Entry("imu.acceleration_noise", "m/s2", _same(0.0136), "TDK ICM-42688-P in 250 Hz"),
            Entry("imu.gyro_noise", "rad/s", _same(0.00097), "TDK ICM-42688-P in 250 Hz"),
            Entry("imu.vibration", "m/s2", _same(0.01), "fans, people walking by"),
            Entry("imu.vibration_growth", "s/rad", _same(6.0), "rollers passing the floor"),
            Entry("imu.vibration_frequency", "Hz", _same(60.0), "frame of aluminium profiles"),
            Entry("imu.vibration_damping", "1", _same(0.05), "bolted frame"),
            Entry("imu.bandwidth", "Hz", _same(250.0), "filter of the sensor"),
            Entry("imu.range", "m/s2", _same(39.2266), "4 g"),
            Entry("imu.gyro_range", "rad/s", _same(8.7266), "500 deg/s"),
            Entry("imu.delay", "1", _same(1), "bus cycles, as the torque sensors"),
            Entry("controller.imu.use", "1", _same(1), "the controller reads it"),
            Entry("controller.estimator.acceleration_source", "1", _same(3), "measured, with the accelerometer"),
        ),
        imu=True,
    ),
    Part(
        "Body outline",
        (
            Entry("outline.x", "m", lambda k: [round(float(x), 6) for x in k.asked.outline[:, 0]], "", "outline"),
            Entry("outline.y", "m", lambda k: [round(float(y), 6) for y in k.asked.outline[:, 1]], "", "outline"),
            Entry(
                "outline.clearance", "m", lambda k: k.clearance, "the wheel's radius, at most half of the height",
                "clearance",
            ),
            Entry("outline.height", "m", lambda k: k.asked.height, "", "height"),
        ),
        "Corners anticlockwise, convex; x forward, y left.",
    ),
    Part(
        "Reaction",
        (
            Entry("admittance.mass", "kg", lambda k: 0.058 * k.mass, "Trikey's share of the mass"),
            Entry("admittance.damping", "N.s/m", lambda k: 0.046 * k.mass, "the escape decays in 1.25 s"),
            Entry("admittance.escape_impulse", "N.s", lambda k: 0.023 * k.mass, "escape of 0.5 m: damping times way"),
            Entry("admittance.speed_limit", "m/s", _same(0.5), "as Trikey's"),
            Entry(
                "admittance.acceleration_limit", "m/s2", lambda k: min(k.tip_limit, k.drive_limit),
                "tip limit g (R/2)/h of the base, or what half of the drives' torque gives",
            ),
            Entry("detector.impulse_threshold", "N.s", lambda k: 1.71 * k.share, "Trikey's, with the mass"),
            Entry("detector.leak_rest", "N", lambda k: 1.0 * k.share, "Trikey's, with the mass"),
            Entry("detector.leak_motion", "N", lambda k: 3.0 * k.share, "Trikey's, with the mass"),
        ),
        "detector.* belong to the preset paper. The default preset's thresholds are controller.channels.*: Trikey's,\n"
        "until this file sets them: [controller.channels.fast_rest] and others (`giveway variables controller`).",
    ),
    Part(
        "Collision dummy of the testbed: a sliding mass on a rail, pulled by a hanging weight",
        (
            Entry("slider.mass", "kg", lambda k: k.slider, "a quarter of the robot's mass"),
            Entry("slider.friction", "N", lambda k: 0.11 * k.slider, "Trikey's rail, with the mass"),
            Entry("slider.damping", "N.s/m", _same(0.0), "none"),
            Entry(
                "slider.run_up", "m",
                lambda k: 0.125 / ((0.5 * GRAVITY_MPS2 - 0.11) / 1.5),
                "0.5 m/s when it meets the robot",
            ),
            Entry("rope.hanging_mass", "kg", lambda k: 0.5 * k.slider, "half of what slides"),
            Entry("rope.stiffness", "N/m", lambda k: 1100.0 * k.slider, "Trikey's, with the mass"),
            Entry("rope.damping", "N.s/m", lambda k: 16.5 * k.slider, "Trikey's, with the mass"),
            Entry("rope.drop_height", "m", _same(0.2), "the weight lands after this drop"),
        ),
    ),
    Part(
        "Bumper",
        (
            Entry("bumper.plate_mass", "kg", lambda k: 0.055 * k.slider, "Trikey's, with the slider's mass"),
            Entry("bumper.spring_rate", "N/m", lambda k: 104.0 * k.slider, "Trikey's, with the slider's mass"),
            Entry("bumper.preload", "N", lambda k: 0.22 * k.slider, "Trikey's, with the slider's mass"),
            Entry("bumper.damping", "N.s/m", lambda k: 0.55 * k.slider, "Trikey's, with the slider's mass"),
            Entry("bumper.guide_friction", "N", lambda k: 0.055 * k.slider, "Trikey's, with the slider's mass"),
            Entry("bumper.travel", "m", _same(0.12), "needed at 0.5 m/s"),
            Entry("bumper.latch_force", "N", lambda k: 5.0 * k.slider, "Trikey's, with the slider's mass"),
            Entry("bumper.latch_gap", "m", _same(0.001), "half the force at 0.4 mm"),
        ),
        "On what collides, as in the paper; the numbers are also those of a bumper on the robot.",
    ),
    Part(
        "Cover",
        (
            Entry("contact.stiffness", "N/m", lambda k: 290.0 * k.mass, "Trikey's, with the mass"),
            Entry("contact.damping", "s/m", _same(0.3), "Hunt-Crossley"),
        ),
    ),
)  # fmt: skip
