"""What does not fit together in a robot file: each rule compares numbers of different origin, by order of magnitude.

The bounds are wide: a robot of any usual make passes. What the FMUs refuse anyway is not repeated here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.gravity import GRAVITY_MPS2
from giveway.own_robot.body import plate
from giveway.robot.footprint import hull, wheel_corners
from giveway.robot.motor_observer import BUS, INERTIA, delay_ticks, longest_delay
from giveway.robot.robot_file import BODY_HEIGHT
from giveway.robot.variables import table
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.robot.robot_file import Robot
    from giveway.robot.variables import Value

__all__ = ["RULES", "Doubt", "Numbers", "doubts"]

SERVO_MARGIN_DEG, SENSED_OVER_SERVO, SENSED_LEAST_HZ = 30.0, 2.0, 2.0
INDENTATION_M = 0.05
HARD_NPM = 1e6
TICK_S = 1e-3
IMU_OFF_SHARE = 0.2


@dataclass(frozen=True)
class Doubt:
    """Numbers that hardly belong to one robot.

    Attributes:
        rule: its name.
        entries: of the robot file; the first one is pointed at.
        words: what was found, and what is usual.
    """

    rule: str
    entries: tuple[str, ...]
    words: str


class Numbers:
    """The numbers of a robot file in both models, and what the rules need of them."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.values: dict[str, dict[str, Value]] = {}
        for model in ("testbed", "controller"):
            variables = table(model)
            start = {v.name: v.start for v in variables.select("parameter") if v.start is not None}
            self.values[model] = start | variables.robot_values(robot)
        self.mass, self.radius, self.distance = self["base.mass"], self["wheel.radius"], self["wheel.distance"]
        count = int(self["outline.count"])
        self.outline: NDArray[np.float64] = np.array(
            [[self[f"outline.{axis}[{corner}]"] for axis in "xy"] for corner in range(count)]
        )
        self.plate = plate(self.outline)
        self.com = (self["base.com_x"], self["base.com_y"])
        self.com_height = self["base.com_height"]
        # Without a stated height: an even body, whose middle is the centre of mass.
        self.height_is_stated = BODY_HEIGHT in robot
        self.height = float(robot.value(BODY_HEIGHT)) if self.height_is_stated else 2.0 * self.com_height

    def __getitem__(self, name: str) -> float:
        return float(self.values["testbed"][name])

    def controller(self, name: str) -> float:
        """A parameter of the controller."""
        return float(self.values["controller"][name])

    @property
    def wheel_load_n(self) -> float:
        """Weight on a wheel."""
        return self.mass * GRAVITY_MPS2 / WHEELS

    @property
    def load_inertia(self) -> float:
        """Inertia of the base at one wheel in straight motion, kg m2."""
        return self.mass * self.radius**2 / 1.5

    @property
    def drive_force_n(self) -> float:
        """Force of the drives in the weakest direction."""
        return math.sqrt(3.0) * self["drivetrain.torque_limit"] / self.radius

    @property
    def tip_limit_mps2(self) -> float:
        """Acceleration at which the robot tips over the line between two wheels."""
        return GRAVITY_MPS2 * self.wheel_margin_m / self.com_height

    @property
    def wheel_margin_m(self) -> float:
        """Distance of the centre of mass from the nearest line between two wheels; negative outside."""
        margins = []
        for wheel in range(WHEELS):
            across = 2.0 * math.pi * (wheel + 0.5) / WHEELS
            along = math.cos(across) * self.com[0] + math.sin(across) * self.com[1]
            margins.append(self.distance * math.cos(math.pi / WHEELS) - along)
        return min(margins)


def doubts(numbers: Numbers) -> list[Doubt]:
    """What is implausible, in the order of `RULES`."""
    return [found for rule in RULES for found in rule(numbers)]


Rule = Callable[[Numbers], Iterator[Doubt]]


def _density(n: Numbers) -> Iterator[Doubt]:
    height = n.height - n["outline.clearance"]
    if n.plate.area_m2 <= 0.0 or height <= 0.0:
        entries = (BODY_HEIGHT if n.height_is_stated else "base.com_height", "outline.clearance", "outline.x")
        yield Doubt("body", entries, "no volume: corners anticlockwise, its top above its clearance")
        return
    density = n.mass / n.plate.area_m2 / height
    if not 40.0 <= density <= 2500.0:
        how = "" if n.height_is_stated else ", its height taken as twice that of the centre of mass"
        yield Doubt(
            "density",
            ("base.mass", "outline.x", "outline.y", BODY_HEIGHT if n.height_is_stated else "base.com_height"),
            f"{density:.0f} kg/m3 over the outline's {n.plate.area_m2:.3g} m2{how}; usual: 40 to 2500",
        )


def _yaw_inertia(n: Numbers) -> Iterator[Doubt]:
    even = n.mass * n.plate.gyration_m**2
    most = n.mass * n.plate.reach_m**2
    found = n["base.yaw_inertia"]
    if even > 0.0 and not 0.35 * even <= found <= min(2.0 * even, most):
        yield Doubt(
            "yaw inertia",
            ("base.yaw_inertia", "base.mass", "outline.x"),
            f"{found:.3g} kg m2; an even body of this outline and mass has {even:.3g}, one with all of its mass at the "
            f"farthest corner {most:.3g}; usual: {0.35 * even:.3g} to {min(2.0 * even, most):.3g}",
        )


def _tilt_inertia(n: Numbers) -> Iterator[Doubt]:
    even = n.mass * (0.5 * n.plate.gyration_m**2 + max(n.height - n["outline.clearance"], 0.0) ** 2 / 12.0)
    found = n["base.tilt_inertia"]
    if even > 0.0 and not 0.3 * even <= found <= 3.0 * even:
        entries = ("base.tilt_inertia", "base.mass", BODY_HEIGHT if n.height_is_stated else "base.com_height")
        words = f"{found:.3g} kg m2; an even body of this size has {even:.3g}; usual: 0.3 to 3 times that"
        yield Doubt("tilt inertia", entries, words)


def _centre_of_mass(n: Numbers) -> Iterator[Doubt]:
    share = n.wheel_margin_m / (n.distance * math.cos(math.pi / WHEELS))
    if share < 0.25:
        where = "outside the wheels: the robot falls over" if share <= 0.0 else "close to the line between two wheels"
        yield Doubt(
            "centre of mass",
            ("testbed.base.com_x", "testbed.base.com_y", "wheel.distance"),
            f"{where}; usual: at least a quarter of the way from that line to the middle",
        )
    if n.height_is_stated and n.com_height >= n.height:
        words = f"{n.com_height:.3g} m, and the body's top is at {n.height:.3g} m"
        yield Doubt("centre of mass", ("base.com_height", BODY_HEIGHT), words)
    wanted = n.controller("admittance.acceleration_limit")
    if wanted > 1.05 * n.tip_limit_mps2:
        yield Doubt(
            "tipping",
            ("admittance.acceleration_limit", "base.com_height", "wheel.distance"),
            f"the reaction may accelerate by {wanted:.3g} m/s2, and the robot tips over at {n.tip_limit_mps2:.3g}",
        )


def _wheels(n: Numbers) -> Iterator[Doubt]:
    if n["roller.radius"] >= 0.5 * n.radius:
        words = f"{n['roller.radius']:.3g} m in a wheel of {n.radius:.3g} m; usual: less than half of it"
        yield Doubt("rollers", ("roller.radius", "wheel.radius"), words)
    if n["wheel.width"] > 2.0 * n.radius:
        words = f"{n['wheel.width']:.3g} m wide, and {2.0 * n.radius:.3g} m high"
        yield Doubt("wheels", ("wheel.width", "wheel.radius"), words)
    corners = wheel_corners(n.values["testbed"]).reshape(-1, 2)
    beyond = float(np.hypot(*corners.T).max()) - n.plate.reach_m
    if beyond > n.radius:
        words = f"the wheels stick out of the body's corners by {1e3 * beyond:.0f} mm; usual: less than their radius"
        yield Doubt("wheels", ("wheel.distance", "outline.x", "outline.y"), words)
    if 2.0 * n.distance < n.plate.reach_m:
        words = f"{n.distance:.3g} m from the middle, and the body reaches {n.plate.reach_m:.3g} m"
        yield Doubt("wheels", ("wheel.distance", "outline.x", "outline.y"), words)
    solid = 0.5 * math.pi * 2700.0 * n["wheel.width"] * n.radius**4  # of aluminium
    if not 0.02 * solid <= n["wheel.inertia"] <= 3.0 * solid:
        words = f"{n['wheel.inertia']:.3g} kg m2; a solid disc of aluminium of this size has {solid:.3g}"
        yield Doubt("wheels", ("wheel.inertia", "wheel.radius", "wheel.width"), words)


def _outline(n: Numbers) -> Iterator[Doubt]:
    if len(hull(n.outline)) != len(n.outline):
        yield Doubt(
            "outline", ("outline.x", "outline.y"), "not convex: what hits the robot meets its outer corners only"
        )
    if n["outline.clearance"] > 2.0 * n.radius:
        words = (
            f"the body begins {n['outline.clearance']:.3g} m above the floor, the wheels end at {2.0 * n.radius:.3g} m"
        )
        yield Doubt("clearance", ("outline.clearance", "wheel.radius"), words)


def _roller_friction(n: Numbers) -> Iterator[Doubt]:
    force = n["roller.coulomb_torque"] / n["roller.radius"]
    share = force / n.wheel_load_n
    if not 0.005 <= share <= 0.4:
        yield Doubt(
            "roller friction",
            ("roller.coulomb_torque", "roller.radius", "base.mass"),
            f"{force:.3g} N at the floor, {100.0 * share:.2g} % of a wheel's load; usual: 0.5 to 40 %",
        )
    else:
        way = force / n["roller.presliding_stiffness[0]"]
        if not 2e-5 <= way <= 5e-3:
            words = f"{1e3 * way:.2g} mm until the rollers slide; usual: 0.02 to 5 mm"
            yield Doubt("roller friction", ("roller.presliding_stiffness", "roller.coulomb_torque"), words)


def _torque(n: Numbers) -> Iterator[Doubt]:
    friction = n["roller.coulomb_torque"] / n["roller.radius"]
    reached = n.drive_force_n / n.mass
    wanted = n.controller("admittance.acceleration_limit") + friction / n.mass
    weight = n.mass * GRAVITY_MPS2
    entries = ("drivetrain.torque_limit", "base.mass", "wheel.radius")
    if reached < wanted:
        words = (
            f"the drives accelerate the robot by {reached:.3g} m/s2, the reaction and the rollers ask for {wanted:.3g}"
        )
        yield Doubt("torque limit", (*entries, "admittance.acceleration_limit"), words)
    elif n.drive_force_n > 3.0 * weight:
        words = f"the drives push with {n.drive_force_n:.3g} N, {n.drive_force_n / weight:.2g} times the robot's weight"
        yield Doubt("torque limit", entries, words)
    gear = n["drivetrain.gear_stiction"]
    if gear > 0.5 * n["drivetrain.torque_limit"]:
        words = f"{gear:.3g} N m of the motor's {n['drivetrain.torque_limit']:.3g} N m; usual: less than half"
        yield Doubt("gear friction", ("drivetrain.gear_stiction", "drivetrain.torque_limit"), words)


def _sensor(n: Numbers) -> Iterator[Doubt]:
    noise, step = n["electronics.torque_noise"], n["electronics.torque_resolution"]
    most, motor = n["electronics.torque_range"], n["drivetrain.torque_limit"]
    if most < motor:
        words = f"it ends at {most:.3g} N m, and the motor gives {motor:.3g} N m"
        yield Doubt("torque sensor", ("drivetrain.torque_sensor_limit", "drivetrain.torque_limit"), words)
    if noise < 0.3 * step:
        words = f"noise {noise:.2g} N m, resolution {step:.2g} N m: the steps are the noise, which is not even then"
        yield Doubt("torque sensor", ("drivetrain.torque_noise", "drivetrain.torque_sensor_resolution"), words)
    if noise > 0.02 * most:
        words = f"noise {noise:.2g} N m of a range of {most:.3g} N m; usual: less than 2 %"
        yield Doubt("torque sensor", ("drivetrain.torque_noise", "drivetrain.torque_sensor_limit"), words)


def _accelerometer(n: Numbers) -> Iterator[Doubt]:
    if n.robot.does_without("imu.height"):
        return
    height = n["imu.height"]
    if abs(height - n.com_height) > IMU_OFF_SHARE * n.com_height:
        words = (
            f"{height:.3g} m high, the centre of mass {n.com_height:.3g} m: while the body leans, it does not show the "
            f"sum of all forces; usual: within {100.0 * IMU_OFF_SHARE:.0f} % of that height"
        )
        yield Doubt("accelerometer", ("imu.height", "base.com_height"), words)


def _thresholds(n: Numbers) -> Iterator[Doubt]:
    friction = WHEELS * n["roller.coulomb_torque"] / n["roller.radius"]
    if n.robot.motor_current:
        friction += WHEELS * n["drivetrain.gear_coulomb"] / n.radius
    for name in ("fast_rest", "slow_rest"):
        entry = f"controller.channels.{name}"
        threshold = n.controller(f"channels.{name}")
        noise = n["electronics.torque_noise"] / n.radius
        if threshold < noise:
            words = f"{threshold:.3g} N, and the torque noise is {noise:.3g} N at the floor: false alarms"
            yield Doubt("threshold", (entry, "drivetrain.torque_noise"), words)
        if threshold > 0.2 * n.mass * GRAVITY_MPS2:
            words = f"{threshold:.3g} N, more than a fifth of the robot's weight: hits stay unnoticed"
            yield Doubt("threshold", (entry, "base.mass"), words)
    creep = n.controller("channels.fast_motion")
    if not 0.03 * friction <= creep <= 3.0 * friction:
        words = f"{creep:.3g} N, while the friction that it stands for is {friction:.3g} N; usual: 0.03 to 3 times it"
        yield Doubt("threshold", ("controller.channels.fast_motion", "roller.coulomb_torque"), words)


def _servo(n: Numbers) -> Iterator[Doubt]:
    from giveway.drivetrain.analysis import analyse
    from giveway.drivetrain.model import Drivetrain, Servo

    roller = n["roller.inertia"] * (n.radius / n["roller.radius"]) ** 2
    drivetrain = Drivetrain(
        motor_inertia=n["drivetrain.motor_inertia"],
        stiffness=n["drivetrain.stiffness"],
        damping=n["drivetrain.damping"],
        gear_viscous=n["drivetrain.gear_viscous"],
        load_inertia=n["wheel.inertia"] + n.load_inertia + roller,
    )
    found = analyse(drivetrain, Servo(n["servo.kp"], n["servo.kd"], n["servo.derivative_cutoff"]))
    entries = ("servo.kp", "servo.kd", "drivetrain.motor_inertia")
    if not found.cases["servo"].stable:
        yield Doubt("servo", entries, "unstable with this drivetrain (`giveway drivetrain`)")
        return
    margin_deg = found.margins.phase_deg
    if margin_deg is not None and margin_deg < SERVO_MARGIN_DEG:
        words = f"phase margin {margin_deg:.0f} degrees; usual: {SERVO_MARGIN_DEG:.0f} or more"
        yield Doubt("servo", entries, words)
    if drivetrain.stiffness < SENSED_OVER_SERVO * n["servo.kp"]:
        words = (
            f"the servo holds the motor with {n['servo.kp']:.3g} N m/rad behind a sensor and shaft of "
            f"{drivetrain.stiffness:.3g}: it answers their swinging; usual: less than half of it"
        )
        yield Doubt("sensed bandwidth", ("drivetrain.stiffness", *entries), words)
    sensed = found.cases["servo"].channels["environment"]
    if sensed.bandwidth_hz is not None and sensed.bandwidth_hz < SENSED_LEAST_HZ:
        words = (
            f"of a push, {sensed.bandwidth_hz:.2g} Hz reach the sensed torque while the servo holds the motor: it is "
            f"late; usual: {SENSED_LEAST_HZ:g} Hz or more"
        )
        yield Doubt("sensed bandwidth", (*entries, "drivetrain.stiffness"), words)


def _encoder(n: Numbers) -> Iterator[Doubt]:
    counts = n["electronics.encoder_counts"]
    step_m = 2.0 * math.pi * n.radius / counts
    speed = max(n.controller("reference.speed_limit"), n.controller("admittance.speed_limit"))
    per_tick = speed * TICK_S / step_m
    jump = n.controller("sensor_check.encoder_jump")
    if per_tick > 0.8 * jump:
        yield Doubt(
            "encoder",
            ("drivetrain.encoder_counts", "controller.sensor_check.encoder_jump"),
            f"{per_tick:.0f} counts per millisecond at {speed:.3g} m/s, a fault for the sensor check is {jump:.0f}",
        )
    if step_m > 5e-4:
        words = f"a count is {1e3 * step_m:.2g} mm at the floor; usual: less than 0.5 mm"
        yield Doubt("encoder", ("drivetrain.encoder_counts", "wheel.radius"), words)


def _observer(n: Numbers) -> Iterator[Doubt]:
    if n.robot.follows_from(INERTIA) == BUS:
        cycles = n["electronics.sensor_delay"]
        words = (
            f"a command shows {delay_ticks(cycles, cycles):.0f} ticks later, the controller remembers "
            f"{longest_delay()}: it takes the encoders' counts as they are"
        )
        yield Doubt("bus", (BUS,), words)


def _contact(n: Numbers) -> Iterator[Doubt]:
    stiffness = n["contact.stiffness"]
    deep = 0.5 * math.sqrt(n["slider.mass"] * n.mass / (n["slider.mass"] + n.mass) / stiffness)
    if deep > INDENTATION_M:
        words = f"the slider sinks {1e3 * deep:.0f} mm into the cover at 0.5 m/s; usual: less than 50 mm"
        yield Doubt("contact stiffness", ("contact.stiffness", "slider.mass"), words)
    if stiffness > HARD_NPM:
        words = f"{stiffness:.3g} N/m, harder than a cover of steel sheet; usual: up to {HARD_NPM:.0g}"
        yield Doubt("contact stiffness", ("contact.stiffness",), words)


def _escape(n: Numbers) -> Iterator[Doubt]:
    way = n.controller("admittance.escape_impulse") / n.controller("admittance.damping")
    decay = n.controller("admittance.mass") / n.controller("admittance.damping")
    if not 0.05 <= way <= 2.0:
        words = f"{way:.3g} m; usual: 0.05 to 2 m, impulse over damping"
        yield Doubt("escape", ("admittance.escape_impulse", "admittance.damping"), words)
    if not 0.1 <= decay <= 10.0:
        words = f"it decays in {decay:.3g} s; usual: 0.1 to 10 s, mass over damping"
        yield Doubt("escape", ("admittance.mass", "admittance.damping"), words)


RULES: tuple[Rule, ...] = (
    *(_density, _yaw_inertia, _tilt_inertia, _centre_of_mass, _outline, _wheels, _roller_friction, _torque, _sensor),
    *(_servo, _encoder, _observer, _accelerometer, _thresholds, _contact, _escape),
)
