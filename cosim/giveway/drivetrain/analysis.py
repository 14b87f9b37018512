"""Analysis of the linear drivetrain: poles, frequency and step responses, margins; as table, JSON and curves.

There are three cases: "gear stuck" (stiction holds the motor), "unpowered" (the gear slides, no servo) and "servo" (the
    gear slides, the servo holds the motor). A stuck gear with a locked wheel cannot move and is left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.in_notebooks import ShownInNotebooks
from giveway.drivetrain.model import (
    CURRENT,
    ENVIRONMENT,
    MOTOR,
    SENSED,
    SERVO_PERIOD_S,
    Drivetrain,
    Servo,
    closed_loop,
    current_loop,
    loop_gain,
    plant,
    response,
    transfer,
)

if TYPE_CHECKING:
    import control
    from numpy.typing import NDArray

__all__ = ["Analysis", "Case", "Channel", "Margins", "Pole", "analyse", "table_rows"]

STUCK, UNPOWERED, SERVO = "gear stuck", "unpowered", "servo"
STATIC_HZ = 1e-6  # used as frequency zero, where an unpowered drivetrain that turns freely has no response
LOWEST_HZ, POINTS = 1e-3, 1500
NO_SHARE = 1e-3  # a smaller static gain counts as none
SOURCES = {"environment": ENVIRONMENT, "motor": MOTOR}
STEP_S = (0.05, 5.0)  # shortest and longest step response
SETTLED = 3.0  # time constants
CREEP_PER_S = 1.0
AT_ONCE_Z = 1e-6  # a sampled pole this close to zero decays within one tick: a delay, not a motion


@dataclass(frozen=True)
class Pole:
    """A pole s, rad/s, or the pair s and its conjugate; sampled poles z are given as s = ln(z)/T."""

    real: float
    imaginary: float

    @property
    def frequency_hz(self) -> float:
        """|s|/2 pi."""
        return math.hypot(self.real, self.imaginary) / (2.0 * math.pi)

    @property
    def damping(self) -> float | None:
        """-Re s/|s|; None at s = 0, a load that turns freely."""
        size = math.hypot(self.real, self.imaginary)
        return -self.real / size if size > 0.0 else None


@dataclass(frozen=True)
class Channel:
    """Sensed torque per torque of one source, with the figures of merit of a sensor; an unstable case has none.

    Attributes:
        response: N m/N m at each frequency of the analysis.
        step: sensed torque (N m) at each time of the analysis after a step of 1 N m.
        static_gain: signed gain at rest, 0 if none.
        bandwidth_hz: lowest frequency at which the gain is 3 dB below the static one; None without a static gain.
        resonance_hz, resonance_gain: the highest peak of the gain; None if it has none inside the frequency range.
    """

    response: NDArray[np.complex128]
    step: NDArray[np.float64]
    static_gain: float
    bandwidth_hz: float | None
    resonance_hz: float | None
    resonance_gain: float | None


@dataclass(frozen=True)
class Case:
    """One of the three linear models; ``channels`` by the name of the source, none if it is unstable."""

    poles: list[Pole]
    stable: bool
    channels: dict[str, Channel]


@dataclass(frozen=True)
class Margins:
    """Margins of the servo's loop, broken at the motor torque.

    None where the curve does not cross; an unstable loop has no margin of gain, phase or delay.

    Attributes:
        gain: the factor by which the loop gain may grow; at gain_hz the phase is -180 degrees.
        gain_least: the factor to which it may fall; None if it may vanish.
        phase_deg: the smallest distance of the phase from -180 degrees where the gain is 1; at phase_hz.
        crossover_hz: every frequency at which the gain is 1.
        delay_s: the additional delay that would make the loop unstable.
        distance: of the Nyquist curve from -1, the modulus margin; at distance_hz.
    """

    gain: float | None
    gain_hz: float | None
    gain_least: float | None
    phase_deg: float | None
    phase_hz: float | None
    crossover_hz: list[float]
    delay_s: float | None
    distance: float
    distance_hz: float


@dataclass(frozen=True)
class Analysis(ShownInNotebooks):
    """The complete analysis of one linear drivetrain.

    Attributes:
        frequency_hz: of all responses.
        time_s: of all step responses.
        loop: the servo's open loop, broken at the motor torque.
        motor_current: what is sensed is the servo's torque, by the motor's current; only "servo" shows any then.
    """

    drivetrain: Drivetrain
    servo: Servo
    motor_current: bool
    frequency_hz: NDArray[np.float64]
    time_s: NDArray[np.float64]
    loop: NDArray[np.complex128]
    margins: Margins
    cases: dict[str, Case]


def analyse(drivetrain: Drivetrain, servo: Servo, motor_current: bool = False) -> Analysis:
    """All cases of ``drivetrain`` (without "gear stuck" for a locked wheel, which cannot move).

    ``motor_current``: torque is sensed by the motor's current instead of a sensor behind the gear.
    """
    systems: dict[str, control.StateSpace] = {}
    if not drivetrain.locked:
        systems[STUCK] = plant(drivetrain, stuck=True)
    systems[UNPOWERED] = plant(drivetrain)
    systems[SERVO] = closed_loop(drivetrain, servo)
    frequency_hz = _grid([pole for system in systems.values() for pole in _poles(system)])
    time_s = _step_times([pole for system in systems.values() for pole in _poles(system)])
    seen = {SERVO: current_loop(drivetrain, servo)} if motor_current else {n: s[SENSED, :] for n, s in systems.items()}
    cases = {
        name: _case(drivetrain, servo, name, system, seen.get(name), motor_current, frequency_hz, time_s)
        for name, system in systems.items()
    }
    loop = transfer(loop_gain(drivetrain, servo), np.exp(2j * np.pi * frequency_hz * SERVO_PERIOD_S))
    return Analysis(
        drivetrain,
        servo,
        motor_current,
        frequency_hz,
        time_s,
        loop,
        _margins(loop, frequency_hz, cases[SERVO].stable),
        cases,
    )


def _grid(poles: list[Pole]) -> NDArray[np.float64]:
    """Up to half the servo's rate, dense enough for a smooth curve, and around lightly damped poles for their peaks."""
    highest = 0.5 / SERVO_PERIOD_S
    parts = [np.geomspace(LOWEST_HZ, highest, POINTS, endpoint=False)]
    for pole in poles:
        if pole.damping is not None and 0.0 < abs(pole.damping) < 0.5:
            spread = 1.0 + max(abs(pole.damping), 1e-6) * np.linspace(-5.0, 5.0, 201)
            parts.append(pole.frequency_hz * spread)
    grid = np.unique(np.concatenate(parts))
    return grid[(grid >= LOWEST_HZ) & (grid < highest)]


def _poles(system: control.StateSpace) -> list[Pole]:
    poles = system.poles()
    if system.isdtime(strict=True):
        poles = np.log(poles[np.abs(poles) > AT_ONCE_Z]) / SERVO_PERIOD_S
    poles = np.where(np.abs(poles) < 1e-6, 0.0, poles)  # an integrator appears as a rounding error
    upper = poles[poles.imag >= 0.0]
    return [Pole(float(s.real), float(s.imag)) for s in sorted(upper, key=lambda s: (abs(s), s.imag))]


def _case(
    drivetrain: Drivetrain,
    servo: Servo,
    name: str,
    system: control.StateSpace,
    seen: control.StateSpace | None,
    motor_current: bool,
    frequency_hz: NDArray[np.float64],
    time_s: NDArray[np.float64],
) -> Case:
    """``seen``: from both torques to what is sensed; None: nothing is."""
    poles = _poles(system)
    # The integrator of a freely turning load does not appear in the torque.
    stable = all(pole.real < 0.0 or pole.damping is None for pole in poles)
    moved = {"environment": not drivetrain.locked, "motor": name != STUCK}
    channels = {
        source: _channel(drivetrain, servo, name, source, seen, motor_current, frequency_hz, time_s)
        for source in SOURCES
        if stable and moved[source] and seen is not None
    }
    return Case(poles, stable, channels)


def _channel(
    drivetrain: Drivetrain,
    servo: Servo,
    name: str,
    source: str,
    seen: control.StateSpace,
    motor_current: bool,
    frequency_hz: NDArray[np.float64],
    time_s: NDArray[np.float64],
) -> Channel:
    import control

    def answer(frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
        sink = CURRENT if motor_current else SENSED
        driven = servo if name == SERVO else None
        return response(drivetrain, driven, SOURCES[source], frequency, stuck=name == STUCK, sink=sink)

    curve = answer(frequency_hz)
    gain = np.abs(curve)
    static = float(answer(np.array([STATIC_HZ]))[0].real)
    static = static if abs(static) > NO_SHARE else 0.0
    below = np.flatnonzero(gain < abs(static) / math.sqrt(2.0))
    peak = int(np.argmax(gain))
    # The first and last point of the range are not peaks, nor are maxima barely above the static gain.
    peaked = 0 < peak < len(gain) - 1 and gain[peak] > 1.001 * abs(static)
    step = control.step_response(seen[0, SOURCES[source]], time_s)
    return Channel(
        response=curve,
        step=np.asarray(step.outputs, dtype=float),
        static_gain=static,
        bandwidth_hz=_crossing(frequency_hz, gain, int(below[0]), static) if below.size and static else None,
        resonance_hz=float(frequency_hz[peak]) if peaked else None,
        resonance_gain=float(gain[peak]) if peaked else None,
    )


def _crossing(frequency_hz: NDArray[np.float64], gain: NDArray[np.float64], row: int, static: float) -> float | None:
    """Where the gain falls to 3 dB below ``static``, between the rows ``row`` - 1 and ``row``."""
    if row == 0:  # below the range
        return None
    level = math.log(abs(static) / math.sqrt(2.0))
    return math.exp(float(np.interp(-level, -np.log(gain[row - 1 : row + 1]), np.log(frequency_hz[row - 1 : row + 1]))))


def _step_times(poles: list[Pole]) -> NDArray[np.float64]:
    """Whole servo ticks until everything has settled, except the creep of a load that only friction slows down."""
    slowest = min((-pole.real for pole in poles if -pole.real > CREEP_PER_S), default=CREEP_PER_S)
    duration = min(max(SETTLED / slowest, STEP_S[0]), STEP_S[1])
    ticks = np.arange(math.ceil(duration / SERVO_PERIOD_S) + 1, dtype=float)
    return ticks * SERVO_PERIOD_S


def _margins(loop: NDArray[np.complex128], frequency_hz: NDArray[np.float64], stable: bool) -> Margins:
    import control

    w = 2.0 * np.pi * frequency_hz
    # From the curve, not from polynomials: those of a sampled loop with a delay are ill-conditioned.
    data = (np.abs(loop), np.degrees(np.unwrap(np.angle(loop))), w)
    gains, phases, distances, gain_w, phase_w, distance_w = control.stability_margins(data, returnall=True)
    growing = [(float(g), float(at)) for g, at in zip(gains, gain_w, strict=True) if g > 1.0]
    falling = [float(g) for g in gains if g < 1.0]
    crossings = [(float(p), float(at)) for p, at in zip(phases, phase_w, strict=True)]
    gain, at_gain = min(growing if stable else [], default=(None, None))
    phase, at_phase = min(((abs(p), at) for p, at in crossings if stable), default=(None, None))
    nearest = int(np.argmin(np.abs(1.0 + loop)))
    if len(distances):
        nearest = int(np.argmin(np.abs(w - distance_w[int(np.argmin(distances))])))
    return Margins(
        gain=gain,
        gain_hz=_hertz(at_gain),
        gain_least=max(falling if stable else [], default=None),
        phase_deg=phase,
        phase_hz=_hertz(at_phase),
        crossover_hz=sorted(at / (2.0 * math.pi) for _, at in crossings),
        delay_s=min((math.radians(p % 360.0) / at for p, at in crossings if stable), default=None),
        distance=float(np.abs(1.0 + loop[nearest])),
        distance_hz=float(frequency_hz[nearest]),
    )


def _hertz(angular: float | None) -> float | None:
    return None if angular is None else angular / (2.0 * math.pi)


def table_rows(analysis: Analysis) -> list[tuple[str, ...]]:
    """One row per quantity, one cell per case; "-" for what does not exist."""
    cases = list(analysis.cases.values())
    rows: list[tuple[str, ...]] = []
    for number in range(max(len(case.poles) for case in cases)):
        title = "poles: frequency, damping" if number == 0 else ""
        rows.append((title, *(_pole(case.poles[number]) if number < len(case.poles) else "" for case in cases)))
    rows.append(("stable", *("yes" if case.stable else "NO" for case in cases)))
    for source in SOURCES:
        channels = [case.channels.get(source) for case in cases]
        if not any(channels):
            continue
        for title, field, form in (
            (f"sensed per {source} torque, at rest", "static_gain", ".3f"),
            ("  bandwidth (-3 dB), Hz", "bandwidth_hz", ".2f"),
            ("  resonance, Hz", "resonance_hz", ".2f"),
            ("  gain there", "resonance_gain", ".2f"),
        ):
            rows.append((title, *(_cell(getattr(c, field, None), form) for c in channels)))
    margins, blank = analysis.margins, ("-",) * (len(cases) - 1)
    gain_db = None if margins.gain is None else 20.0 * math.log10(margins.gain)
    loop = (
        ("servo loop: gain margin, dB", f"{_cell(gain_db, '.1f')}{_at(margins.gain_hz)}"),
        ("  phase margin, deg", f"{_cell(margins.phase_deg, '.1f')}{_at(margins.phase_hz)}"),
        ("  crossover, Hz", ", ".join(f"{f:.2f}" for f in margins.crossover_hz) or "-"),
        ("  delay margin, ms", _cell(None if margins.delay_s is None else 1e3 * margins.delay_s, ".2f")),
        ("  distance from -1", f"{margins.distance:.3f}{_at(margins.distance_hz)}"),
    )
    return [*rows, *((name, *blank, value) for name, value in loop)]


def _pole(pole: Pole) -> str:
    if pole.damping is None:
        return "turns freely"
    if pole.imaginary == 0.0:
        return f"{pole.frequency_hz:.2f} Hz, real"
    return f"{pole.frequency_hz:.2f} Hz, {pole.damping:.3f}"


def _cell(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)


def _at(frequency_hz: float | None) -> str:
    return "" if frequency_hz is None else f" at {frequency_hz:.1f} Hz"
