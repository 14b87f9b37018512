"""Frequency response of the drivetrain FMU, measured with sines in co-simulation: the linear model's counterpart.

The nonlinear drivetrain answers a sine like the linear one only while its gear stays in one mode, so a sweep sets up:

- "unpowered" and "servo" on a gear that slides one way: both sides turn at ``bias_speed``, the motor torque makes up
  for the friction, and the sine is too small to turn the motor back; or, with a bias of 0, without Coulomb friction;
- "gear stuck": no bias, and a sine that the stiction holds.

A run in which the gear changes its mode all the same is refused, not averaged over. The torque sensor is read without
noise; the encoder has its finest resolution of a million counts, since a staircase has no slope to measure. The motor's
current is a sample of each millisecond: only these samples are fitted.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base import native
from giveway.base.checks import finite
from giveway.base.errors import GivewayError, SimulationError, UnknownNameError
from giveway.drivetrain.analysis import SERVO, SOURCES, STUCK, UNPOWERED, analyse
from giveway.drivetrain.model import ANGLE, CURRENT, SENSED, SERVO_PERIOD_S, Drivetrain, Servo, response
from giveway.robot.variables import table

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.drivetrain.analysis import Analysis
    from giveway.robot.variables import Value
    from giveway.simulation.fmu import Instance

__all__ = ["Sweep", "check_load", "deviations", "measurable", "measure", "measure_all"]

PERIODS, SHORTEST_S = 4, 0.02  # periods of the fitted sine
SAMPLES_PER_PERIOD = 64  # of the master, at the least
SHARE = 0.2  # share of the stiction or of the bias speed that the settled sine uses; its start uses more
FREQUENCY_HZ = (0.01, 0.45 / SERVO_PERIOD_S)
CURRENT_TO_HZ = 30.0  # above, a heavy load hides from the encoder: a thousandth of a count and less
BUS_TICKS = 2  # servo ticks from one sample of the motor's current to the next
TIME_CONSTANTS = 10.0  # until the transient has decayed
SLOW_PER_S = 0.5  # slower decays without oscillation are covered by the fit's constant and slope
LONGEST_SETTLING_S = 30.0
LEAST_STICTION_NM = 1e-3
TORQUE_LIMIT_NM = 1000.0


@dataclass(frozen=True)
class Sweep:
    """A measured frequency response.

    Attributes:
        case: "gear stuck", "unpowered" or "servo".
        source: where the sine acts, "environment" or "motor".
        frequency_hz: measured frequencies; near the requested ones, so that whole periods are whole servo ticks.
        response: sensed torque per torque of the source, N m/N m.
    """

    case: str
    source: str
    frequency_hz: NDArray[np.float64]
    response: NDArray[np.complex128]


def check_load(drivetrain: Drivetrain) -> None:
    """Refuse, before any work is done, a load that cannot be measured with sines."""
    if drivetrain.locked:
        raise GivewayError("load", "locked", "a load that moves, if ever so little: 100 kg m2 is the heaviest")


def measure(
    drivetrain: Drivetrain,
    servo: Servo,
    case: str,
    source: str,
    frequency_hz: NDArray[np.float64],
    *,
    gear_friction: float,
    bias_speed: float = 5.0,
    amplitude: float = 10.0,
    motor_current: bool = False,
    fmi_version: int = 3,
    progress: Callable[[float], None] | None = None,
) -> Sweep:
    """Measure ``case`` at each frequency (Hz).

    Args:
        gear_friction: Coulomb friction and stiction of the gear, N m.
        bias_speed: rad/s, for a gear that slides; 0: without Coulomb friction.
        amplitude: of the sine, N m; reduced where the gear would change its mode.
        motor_current: the torque in the motor's current is measured, with a servo.
        progress: called with the finished share, 0 to 1.
    """
    if case not in (STUCK, UNPOWERED, SERVO):
        raise UnknownNameError("case", case, (STUCK, UNPOWERED, SERVO))
    if source not in SOURCES:
        raise UnknownNameError("source", source, SOURCES)
    if motor_current and case != SERVO:
        raise GivewayError("case", case, f"{SERVO}: the motor's current shows nothing else")
    check_load(drivetrain)
    least = LEAST_STICTION_NM if case == STUCK else 0.0
    finite("gear_friction", gear_friction, least, TORQUE_LIMIT_NM / 2.0, "N m")
    finite("bias_speed", bias_speed, 0.0, 100.0, "rad/s")
    finite("amplitude", amplitude, 1e-6, TORQUE_LIMIT_NM / 4.0, "N m")
    lowest, highest = FREQUENCY_HZ
    for frequency in frequency_hz:
        finite("frequency_hz", float(frequency), lowest, highest / (BUS_TICKS if motor_current else 1), "Hz")
    found = analyse(drivetrain, servo).cases[case]
    if not found.stable:
        raise GivewayError("case", case, "a stable one; this one does not settle")
    slow = [p for p in found.poles if p.imaginary == 0.0 and -p.real < SLOW_PER_S]
    settling_s = TIME_CONSTANTS / min((-p.real for p in found.poles if p not in slow), default=SLOW_PER_S)
    if settling_s > LONGEST_SETTLING_S:
        raise GivewayError("case", case, f"one that settles in {LONGEST_SETTLING_S:g} s; this takes {settling_s:.3g} s")
    setup = _Setup(
        drivetrain,
        servo,
        case,
        source,
        0.0 if case == STUCK else bias_speed,
        gear_friction,
        amplitude,
        settling_s,
        motor_current,
    )
    points = []
    for index, frequency in enumerate(frequency_hz):
        if progress is not None:
            progress(index / len(frequency_hz))
        points.append(_measure_one(setup, float(frequency), fmi_version))
    if progress is not None:
        progress(1.0)
    return Sweep(case, source, np.array([f for f, _ in points]), np.array([gain for _, gain in points]))


def measurable(analysis: Analysis, gear_friction: float) -> list[tuple[str, str]]:
    """Every stable case with every source; "gear stuck" only if ``gear_friction`` (N m) can hold it."""
    return [
        (name, source)
        for name, case in analysis.cases.items()
        for source in case.channels
        if case.stable and (name != STUCK or gear_friction >= LEAST_STICTION_NM)
    ]


def measure_all(
    analysis: Analysis,
    gear_friction: float,
    points: int = 16,
    progress: Callable[[str, str, float], None] | None = None,
) -> list[Sweep]:
    """Everything `measurable`, at frequencies from 0.5 to 500 Hz, of the motor's current to 30 Hz.

    ``progress``, if given, is called with case, source and its finished share.
    """
    frequency_hz = np.geomspace(0.5, CURRENT_TO_HZ if analysis.motor_current else 500.0, points)
    return [
        measure(
            analysis.drivetrain,
            analysis.servo,
            case,
            source,
            frequency_hz,
            gear_friction=gear_friction,
            motor_current=analysis.motor_current,
            progress=None if progress is None else functools.partial(progress, case, source),
        )
        for case, source in measurable(analysis, gear_friction)
    ]


def deviations(analysis: Analysis, sweeps: Sequence[Sweep]) -> list[tuple[str, ...]]:
    """Per sweep the largest deviations from the linear model: of the gain (%) and of the phase (deg)."""
    rows: list[tuple[str, ...]] = []
    for sweep in sweeps:
        servo = analysis.servo if sweep.case == SERVO else None
        model = response(
            analysis.drivetrain,
            servo,
            SOURCES[sweep.source],
            sweep.frequency_hz,
            stuck=sweep.case == STUCK,
            sink=CURRENT if analysis.motor_current else SENSED,
        )
        ratio = sweep.response / model
        gain, phase = 100.0 * np.max(np.abs(np.abs(ratio) - 1.0)), np.degrees(np.max(np.abs(np.angle(ratio))))
        rows.append((f"{sweep.case}, {sweep.source}", f"{len(ratio)}", f"{gain:.3f} %", f"{phase:.3f} deg"))
    return rows


@dataclass(frozen=True)
class _Setup:
    drivetrain: Drivetrain
    servo: Servo
    case: str
    source: str
    bias_speed: float
    gear_friction: float
    wanted_amplitude: float
    settling_s: float
    motor_current: bool

    @property
    def sensed(self) -> str:
        """The output that is measured."""
        return "sensor.motor_torque" if self.motor_current else "sensor.torque"

    @property
    def frictionless(self) -> bool:
        return self.case != STUCK and self.bias_speed == 0.0

    @property
    def friction(self) -> float:
        """Coulomb friction and stiction of this sweep."""
        return 0.0 if self.frictionless else self.gear_friction

    @property
    def bias_torque(self) -> float:
        """The torque that keeps a sliding gear at the bias speed."""
        sliding = self.bias_speed > 0.0
        return self.friction + self.drivetrain.gear_viscous * self.bias_speed if sliding else 0.0

    def amplitude(self, frequency_hz: float) -> float:
        """The requested amplitude, or the largest that keeps the gear in its mode by the linear model."""
        if self.frictionless:
            return self.wanted_amplitude
        stuck = self.case == STUCK
        servo, source, frequency = self.servo if self.case == SERVO else None, SOURCES[self.source], [frequency_hz]
        sink = SENSED if stuck else ANGLE
        gain = float(np.abs(response(self.drivetrain, servo, source, np.array(frequency), stuck=stuck, sink=sink))[0])
        if stuck:  # the sensed torque pulls at the motor; its start overshoots to twice the amplitude
            return min(self.wanted_amplitude, SHARE * self.friction / max(gain, 1.0))
        return min(self.wanted_amplitude, SHARE * self.bias_speed / (2.0 * math.pi * frequency_hz * gain))

    def parameters(self) -> dict[str, Value]:
        wanted: dict[str, Any] = {
            **self.drivetrain.variables(),
            **(self.servo.variables() if self.case == SERVO else {}),
            "servo.enabled": self.case == SERVO,
            "servo.encoder_counts": 1_000_000,
            "drivetrain.gear_coulomb": self.friction,
            "drivetrain.gear_stiction": self.friction,
            "drivetrain.torque_limit": TORQUE_LIMIT_NM,
            "start.motor_speed": self.bias_speed,
            "start.load_speed": self.bias_speed,
            "solver.relative_tolerance": 1e-9,
        }
        return table("drivetrain").check_all(wanted)


def _measure_one(setup: _Setup, frequency_hz: float, fmi_version: int) -> tuple[float, complex]:
    """The actual frequency, and the response there."""
    from giveway.simulation.fmu import Instance, open_fmu

    periods = max(PERIODS, math.ceil(SHORTEST_S * frequency_hz))
    ticks = round(periods / (frequency_hz * SERVO_PERIOD_S))
    frequency_hz = periods / (ticks * SERVO_PERIOD_S)
    steps_per_tick = math.ceil(SAMPLES_PER_PERIOD * frequency_hz * SERVO_PERIOD_S)
    step_s = SERVO_PERIOD_S / steps_per_tick
    settling = math.ceil(setup.settling_s / SERVO_PERIOD_S) * steps_per_tick
    fitted = ticks * steps_per_tick
    file = open_fmu(native.fmu("drivetrain", fmi_version))
    file.check_matches(table("drivetrain"))
    amplitude = setup.amplitude(frequency_hz)
    with Instance(file, f"sweep at {frequency_hz:.4g} Hz") as instance:
        instance.initialise(setup.parameters(), table("drivetrain"))
        sensed = _run(instance, setup, amplitude, frequency_hz, step_s, settling + fitted)
    # The FMU's input is a staircase: its sine component is smaller and half a step late.
    phase = 2j * np.pi * frequency_hz * step_s
    hold = (1.0 - np.exp(-phase)) / phase
    row = np.arange(settling + 1, settling + fitted + 1)
    if setup.motor_current:
        row = row[row % (BUS_TICKS * steps_per_tick) == 0]
    turn = np.exp(2j * np.pi * frequency_hz * step_s * row)
    # Over whole periods; a constant and a slope cover the rest of the transient.
    columns = np.column_stack((turn.real, turn.imag, np.ones(len(row)), np.linspace(-1.0, 1.0, len(row))))
    cosine, sine = np.linalg.lstsq(columns, sensed[row - 1], rcond=None)[0][:2]
    return frequency_hz, complex(cosine, -sine) / (amplitude * hold)


def _run(
    instance: Instance, setup: _Setup, amplitude: float, frequency_hz: float, step_s: float, steps: int
) -> NDArray[np.float64]:
    """Sensed torque at the end of each step of a run with a cosine at the source."""
    names = ("motor.torque", "environment.torque", "servo.reference_angle", "servo.reference_speed")
    variables = table("drivetrain")
    put = instance.setter("real", [variables[name].reference for name in names])
    get = instance.getter("real", [variables[setup.sensed].reference])
    advance = instance.stepper()
    time_s = step_s * np.arange(steps)
    inputs = np.zeros((steps, len(names)))
    inputs[:, 0] = setup.bias_torque
    inputs[:, 1] = setup.drivetrain.load_viscous * setup.bias_speed
    # Without the servo's lag: the angle that the motor would have without a sine.
    inputs[:, 2] = np.remainder(setup.bias_speed * time_s + math.pi, 2.0 * math.pi) - math.pi
    inputs[:, 3] = setup.bias_speed
    inputs[:, 0 if setup.source == "motor" else 1] += amplitude * np.cos(2.0 * np.pi * frequency_hz * time_s)
    sensed = np.zeros(steps)
    width, address, out = inputs.strides[0], inputs.ctypes.data, sensed.ctypes.data
    for row in range(steps):
        now_s = row * step_s
        status = put(address + row * width) | advance(now_s, step_s) | get(out + row * sensed.itemsize)
        instance.check(status, now_s)
    _refuse_mode_changes(instance, setup, amplitude, steps * step_s)
    return sensed


def _refuse_mode_changes(instance: Instance, setup: _Setup, amplitude: float, end_s: float) -> None:
    if setup.frictionless:
        return  # both directions are the same
    variables = table("drivetrain")
    events = np.zeros(1, dtype=instance.dtype("integer"))
    status = instance.getter("integer", [variables["events"].reference])(events.ctypes.data)
    instance.check(status, end_s)
    if events[0]:
        reason = f"the gear changed between sliding and sticking: {amplitude:g} N m is too much for {setup.case}"
        raise SimulationError(instance.name, reason, end_s)
