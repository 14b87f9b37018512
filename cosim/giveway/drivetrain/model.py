"""The linearised drivetrain of Fig. 6 as python-control systems: one wheel, everything reflected to its axle.

Between motor and load sits the torque sensor, a spring with some damping, and its torque is what is sensed::

    m thm'' = tau_m - b1 thm' - tau_s       m: rotor, b1: viscous part of the gear friction B1
    tau_s   = k (thm - q) + d (thm' - q')
    J q''   = tau_s - b2 q' + tau_e         J: load, b2: viscous part of its friction B2, tau_e: environment

Two things are left out, and one of two linear models is true instead:

- *sliding*: the gear turns one way. Coulomb friction is then a constant torque and has no part in small signals; only
  the viscous friction is there.
- *stuck*: the gear's stiction holds the motor like a locked rotor: thm = 0, and motor torque does nothing.

The 2 kHz servo of the drives (c_core's gw_servo.c) is sampled: at each tick of period T it reads the motor's encoder,
and its torque holds until the next, ``delay`` ticks later. Without limits and quantisation it is linear::

    C(z) = (kp + kd F(z)) z^-delay,   F(z) = g (1 - z^-1) / (T (1 - (1 - g) z^-1)),   g = 1 - exp(-2 pi fc T)

and acts as tau_m = -C(z) thm. A reading affects the torque of its own tick: there is no latency from encoder to torque
except ``delay``.

Where torque comes from the motor's current, the servo's torque is what is sensed, sampled before the servo acts, so one
tick old: -z^-1 C(z) thm. A stuck gear and a drive without power show nothing.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from giveway.base import native
from giveway.base.errors import GivewayError
from giveway.base.in_notebooks import ShownInNotebooks
from giveway.robot.robot_file import Robot, read_robot
from giveway.robot.variables import table

if TYPE_CHECKING:
    import control
    from numpy.typing import NDArray

__all__ = [
    "ENVIRONMENT",
    "LOADS",
    "MOTOR",
    "SERVO_PERIOD_S",
    "Drivetrain",
    "Servo",
    "closed_loop",
    "current_loop",
    "describe",
    "gear_friction",
    "loop_gain",
    "plant",
    "read",
    "response",
    "sampled_plant",
    "senses_current",
    "transfer",
]

SERVO_PERIOD_S = 5e-4
MOTOR, ENVIRONMENT = 0, 1  # inputs of `plant`: motor torque, environment torque, N m
SENSED, ANGLE = 0, 1  # outputs of `plant`: sensed torque, N m; motor angle, rad
CURRENT = 2  # of `response`: the servo's torque as the motor's current shows it, N m
LOADS = ("base", "wheel", "locked")


@dataclass(frozen=True)
class Drivetrain(ShownInNotebooks):
    """The numbers of one drivetrain and its load, reflected to the wheel axle.

    Attributes:
        motor_inertia: m, kg m2.
        stiffness: k, N m/rad.
        damping: d, N m s/rad.
        gear_viscous: b1, N m s/rad.
        load_inertia: J, kg m2; infinite for a wheel that the environment holds.
        load_viscous: b2, N m s/rad.
    """

    motor_inertia: float
    stiffness: float
    damping: float
    gear_viscous: float
    load_inertia: float
    load_viscous: float = 0.0

    def __post_init__(self) -> None:
        for field, value in self.variables().items():
            if field != "load.inertia" or value != math.inf:
                table("drivetrain").check(field, value)

    @property
    def locked(self) -> bool:
        """The wheel does not turn."""
        return math.isinf(self.load_inertia)

    def variables(self) -> dict[str, float]:
        """The same numbers under the names of the drivetrain FMU's parameters."""
        load = {"load.inertia": self.load_inertia, "load.viscous": self.load_viscous}
        names = ("motor_inertia", "stiffness", "damping", "gear_viscous")
        return {**{f"drivetrain.{name}": getattr(self, name) for name in names}, **load}


@dataclass(frozen=True)
class Servo:
    """The 2 kHz joint servo of the drives.

    Attributes:
        kp: N m/rad.
        kd: N m s/rad.
        derivative_cutoff: corner fc of the filter of the speed, Hz.
        delay: ticks from reading the encoder to the torque, 0 to 64.
    """

    kp: float
    kd: float
    derivative_cutoff: float
    delay: int = 0

    def __post_init__(self) -> None:
        for field, value in self.variables().items():
            table("drivetrain").check(field, value)

    def variables(self) -> dict[str, float]:
        """The same numbers under the names of the drivetrain FMU's parameters."""
        return {f"servo.{field.name}": getattr(self, field.name) for field in dataclasses.fields(self)}

    def system(self) -> control.StateSpace:
        """C(z), from motor angle (rad) to the torque against it (N m)."""
        import control

        gain = -math.expm1(-2.0 * math.pi * self.derivative_cutoff * SERVO_PERIOD_S)
        rate = self.kd * gain / SERVO_PERIOD_S
        # F(z) = g/T (1 - g/(z - (1 - g))): one state, the filter; behind it a shift register for the delay.
        order = 1 + self.delay
        a, b, c = np.zeros((order, order)), np.zeros((order, 1)), np.zeros((1, order))
        a[0, 0], b[0, 0] = 1.0 - gain, 1.0
        direct = self.kp + rate
        if self.delay == 0:
            c[0, 0] = -rate * gain
            return control.ss(a, b, c, [[direct]], SERVO_PERIOD_S)
        a[1, 0], b[1, 0] = -rate * gain, direct
        for tick in range(2, order):
            a[tick, tick - 1] = 1.0
        c[0, -1] = 1.0
        return control.ss(a, b, c, [[0.0]], SERVO_PERIOD_S)


def read(robot_path: Path | None = None, load: str | float = "base", delay: int = 0) -> tuple[Drivetrain, Servo]:
    """Drivetrain and servo of a robot file (None: the robot the FMUs were built with).

    ``load`` is an inertia in kg m2 or one of

    - "base": the base in straight motion, M r_w^2/1.5 + I_w + I_r r_w^2/r_r^2. At speed v in any direction the squares
      of the three wheel speeds add up to 1.5 v^2/r_w^2, the inertia of M_t (27) in x and y is M + 1.5 I_w/r_w^2 +
      1.5 I_r/r_r^2, so this inertia at each wheel holds the same energy; it is exact for equal drivetrains.
    - "wheel": a lifted wheel, I_w.
    - "locked": the environment holds the wheel.

    Roller friction on the floor is Coulomb friction, so a base that slides on its rollers has b2 = 0.
    """
    robot = read_robot(native.robot() if robot_path is None else robot_path)
    names = ("motor_inertia", "stiffness", "damping", "gear_viscous")
    numbers = {name: _value(robot, "drivetrain", f"drivetrain.{name}") for name in names}
    drivetrain = Drivetrain(**numbers, load_inertia=_load_inertia(robot, load))
    gains = {name: _value(robot, "drivetrain", f"servo.{name}") for name in ("kp", "kd", "derivative_cutoff")}
    return drivetrain, Servo(**gains, delay=delay)


def describe(robot_path: Path | None, load: str | float, drivetrain: Drivetrain, servo: Servo) -> str:
    """One line on what `read` read."""
    name = (native.robot() if robot_path is None else robot_path).name
    loads = {"base": "base in straight motion", "wheel": "lifted wheel", "locked": "locked wheel"}
    inertia = "" if drivetrain.locked else f" ({drivetrain.load_inertia:.4g} kg m2 per wheel)"
    sensed = "; torque sensed by motor current" if senses_current(robot_path) else ""
    return (
        f"Linear drivetrain of {name}; load: {loads.get(str(load), 'given')}{inertia}; servo delay: {servo.delay} "
        f"ticks{sensed}"
    )


def gear_friction(robot_path: Path | None = None) -> float:
    """Coulomb friction of the gear, N m: not part of the linear model, but the sweep has to overcome it."""
    return _value(
        read_robot(native.robot() if robot_path is None else robot_path), "drivetrain", "drivetrain.gear_coulomb"
    )


def senses_current(robot_path: Path | None = None) -> bool:
    """Whether the robot's torque is that of its motors' current."""
    return read_robot(native.robot() if robot_path is None else robot_path).motor_current


def _load_inertia(robot: Robot, load: str | float) -> float:
    if load == "locked":
        return math.inf
    if load in ("wheel", "base"):
        wheel = _value(robot, "testbed", "wheel.inertia")
        if load == "wheel":
            return wheel
        radius, roller_radius = (_value(robot, "testbed", f"{part}.radius") for part in ("wheel", "roller"))
        mass, roller = (_value(robot, "testbed", name) for name in ("base.mass", "roller.inertia"))
        return wheel + mass * radius**2 / 1.5 + roller * (radius / roller_radius) ** 2
    try:
        return float(table("drivetrain").check("load.inertia", load))
    except GivewayError as error:
        raise GivewayError("load", load, f"{', '.join(LOADS)} or {error.allowed}") from None


def _value(robot: Robot, model: str, name: str) -> float:
    """A number of the robot file within the range that the FMUs allow it."""
    variables = table(model)
    return float(variables.robot_value(robot, variables[name]))


def plant(drivetrain: Drivetrain, stuck: bool = False) -> control.StateSpace:
    """From motor and environment torque (N m) to sensed torque (N m) and motor angle (rad), in continuous time.

    ``stuck``: the gear's stiction holds the motor; motor torque then has no effect.
    """
    import control

    k, d = drivetrain.stiffness, drivetrain.damping
    if stuck and drivetrain.locked:
        raise GivewayError("load", "locked", "a load that moves: with a stuck gear and a locked wheel nothing does")
    # States: wind-up thm - q, motor speed, load speed, motor angle; b holds motor and environment torque.
    sensed = np.array([k, d, -d, 0.0])
    a, b = np.zeros((4, 4)), np.zeros((4, 2))
    a[0], a[3] = [0.0, 1.0, -1.0, 0.0], [0.0, 1.0, 0.0, 0.0]
    a[1] = (-sensed - [0.0, drivetrain.gear_viscous, 0.0, 0.0]) / drivetrain.motor_inertia
    b[1, MOTOR] = 1.0 / drivetrain.motor_inertia
    a[2] = (sensed - [0.0, 0.0, drivetrain.load_viscous, 0.0]) / drivetrain.load_inertia
    b[2, ENVIRONMENT] = 1.0 / drivetrain.load_inertia
    c = np.array([sensed, [0.0, 0.0, 0.0, 1.0]])
    if stuck:
        moving = [0, 2]
    elif drivetrain.locked:
        moving, c[ANGLE] = [0, 1], [1.0, 0.0, 0.0, 0.0]
    else:
        moving = [0, 1, 2, 3]
    names = {"inputs": ["motor torque", "environment torque"], "outputs": ["sensed torque", "motor angle"]}
    return control.ss(a[np.ix_(moving, moving)], b[moving], c[:, moving], np.zeros((2, 2)), **names)


def sampled_plant(drivetrain: Drivetrain, period_s: float = SERVO_PERIOD_S) -> control.StateSpace:
    """`plant`, sliding, sampled by the servo: torques hold for ``period_s``, outputs are read at its end. Exact."""
    import control

    return control.sample_system(plant(drivetrain), period_s, method="zoh")


def transfer(system: control.StateSpace, points: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """What ``system`` passes at ``points``, s (1/s) or z: shape (outputs, inputs, points), or (points,) of one to one.

    All points at once: python-control solves for one after the other, and `analyse` takes three times as long.
    """
    states = points[:, None, None] * np.eye(system.nstates) - system.A
    passed: NDArray[np.complex128] = np.moveaxis(system.C @ np.linalg.solve(states, system.B) + system.D, 0, -1)
    return passed[0, 0] if system.issiso() else passed


def loop_gain(drivetrain: Drivetrain, servo: Servo) -> control.StateSpace:
    """Open loop of the servo, broken at the motor torque: C(z) times motor torque to motor angle."""
    return servo.system() * sampled_plant(drivetrain)[ANGLE, MOTOR]


def closed_loop(drivetrain: Drivetrain, servo: Servo) -> control.StateSpace:
    """`sampled_plant` under the servo. The motor torque, still an input, is added to the servo's."""
    import control

    into_motor, from_angle = np.array([[1.0], [0.0]]), np.array([[0.0, 1.0]])
    return control.feedback(sampled_plant(drivetrain), into_motor * servo.system() * from_angle, sign=-1)


def current_loop(drivetrain: Drivetrain, servo: Servo) -> control.StateSpace:
    """From motor and environment torque to the servo's torque as the motor's current shows it, under the servo."""
    import control

    before = control.ss([[0.0]], [[1.0]], [[-1.0]], [[0.0]], SERVO_PERIOD_S)  # -1/z
    return before * servo.system() * closed_loop(drivetrain, servo)[ANGLE, :]


def response(
    drivetrain: Drivetrain,
    servo: Servo | None,
    source: int,
    frequency_hz: NDArray[np.float64],
    *,
    stuck: bool = False,
    sink: int = SENSED,
) -> NDArray[np.complex128]:
    """``sink`` (SENSED torque, N m, motor ANGLE, rad, or CURRENT, N m, of a servo) per N m of ``source`` (MOTOR,
    ENVIRONMENT) at each frequency.

    With a servo, the response of the sampled loop to a sine has further frequencies; this is the part at the sine's own
    frequency, below half the servo's rate 1/T. With G the plant and P its sampled form, z = exp(j w T), and a hold H =
    (1 - exp(-j w T))/(j w T)::

        G_ks - G_km H C(z)/(1 + C(z) P_am(z)) G_as       k: sink, s: source, m: motor torque, a: motor angle

    Exact: the samples of a sine are those of its continuous response, and C responds with a staircase. With a stuck
        gear the servo has no effect. CURRENT is a sequence of samples: -C(z)/(z (1 + C(z) P_am(z))) G_as.

    Raises:
        GivewayError: a frequency is not above 0 Hz or, with a servo, not below half its rate.
    """
    w = 2.0 * np.pi * np.asarray(frequency_hz, dtype=float)
    if not w.min() > 0.0:  # where a load that turns freely has no response
        raise GivewayError("frequency_hz", float(w.min() / (2.0 * np.pi)), "above 0 Hz")
    continuous = transfer(plant(drivetrain, stuck), np.asarray(1j * w, dtype=np.complex128))
    if servo is None or stuck:
        nothing: NDArray[np.complex128] = np.zeros(len(w), dtype=np.complex128)
        direct: NDArray[np.complex128] = continuous[min(sink, ANGLE), source]
        return nothing if sink == CURRENT else direct
    if w.max() >= np.pi / SERVO_PERIOD_S:
        raise GivewayError("frequency_hz", float(w.max() / (2.0 * np.pi)), f"below {0.5 / SERVO_PERIOD_S:g} Hz")
    z = np.exp(1j * w * SERVO_PERIOD_S)
    hold = (1.0 - 1.0 / z) / (1j * w * SERVO_PERIOD_S)
    gain = transfer(servo.system(), z)
    sampled = transfer(sampled_plant(drivetrain), z)
    fed_back: NDArray[np.complex128] = gain / (1.0 + gain * sampled[ANGLE, MOTOR]) * continuous[ANGLE, source]
    if sink == CURRENT:
        sampled_current: NDArray[np.complex128] = -fed_back / z
        return sampled_current
    returned: NDArray[np.complex128] = continuous[sink, source] - continuous[sink, MOTOR] * hold * fed_back
    return returned
