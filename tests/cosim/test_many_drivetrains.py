"""Many linear drivetrains at once against python-control, one by one: curves, poles, margins, bandwidth."""

from __future__ import annotations

import math
from collections.abc import Callable

import control
import numpy as np
import pytest
from giveway.drivetrain.analysis import analyse
from giveway.drivetrain.many import ManyDrivetrains
from giveway.drivetrain.model import (
    CURRENT,
    ENVIRONMENT,
    SERVO_PERIOD_S,
    Drivetrain,
    Servo,
    closed_loop,
    loop_gain,
    read,
    response,
)
from numpy.typing import NDArray
from sampled_drivetrain import largest_multiplier
from scipy.optimize import brentq

COUNT = 8
PARAMETERS = ("motor_inertia", "stiffness", "damping", "gear_viscous", "load_inertia")
GAINS = ("kp", "kd", "derivative_cutoff")
FREQUENCY_HZ = np.geomspace(0.02, 990.0, 150)
# Both compute in double precision; what they lose to rounding, near the slowest poles most, stays far below.
EXACT = 1e-9
# Slow enough to be stable, or not: a factor to either side of Trikey's values.
SPREAD = {"motor_inertia": 5.0, "stiffness": 10.0, "damping": 5.0, "gear_viscous": 5.0, "load_inertia": 3.0, "kp": 3.0,
          "kd": 3.0, "derivative_cutoff": 2.0}  # fmt: skip


def numbers_of(drivetrain: Drivetrain) -> list[float]:
    return [getattr(drivetrain, name) for name in PARAMETERS]


def gains_of(servo: Servo) -> list[float]:
    return [getattr(servo, name) for name in GAINS]


def drawn(delay: int, count: int = COUNT) -> ManyDrivetrains:
    drivetrain, servo = read()
    rng = np.random.default_rng(7 + delay)
    around = {name: getattr(drivetrain, name) for name in PARAMETERS} | {name: getattr(servo, name) for name in GAINS}
    numbers = [value * SPREAD[name] ** rng.uniform(-1.0, 1.0, count) for name, value in around.items()]
    return ManyDrivetrains.of(np.stack(numbers, axis=1), delay)


def single(many: ManyDrivetrains, index: int) -> tuple[Drivetrain, Servo]:
    drivetrain = Drivetrain(*(float(getattr(many, name)[index]) for name in PARAMETERS))
    kp, kd, cutoff = (float(getattr(many, name)[index]) for name in GAINS)
    return drivetrain, Servo(kp, kd, cutoff, many.delay)


def loop_at(system: control.StateSpace, frequency_hz: NDArray[np.float64]) -> NDArray[np.complex128]:
    return np.atleast_1d(system(np.exp(2j * np.pi * SERVO_PERIOD_S * frequency_hz)))


def roots(
    function: Callable[[NDArray[np.float64]], NDArray[np.float64]], frequency_hz: NDArray[np.float64]
) -> list[float]:
    """Where ``function`` of frequencies changes its sign."""
    values = function(frequency_hz)
    rows = np.flatnonzero(values[:-1] * values[1:] < 0.0)
    return [
        brentq(lambda f: float(function(np.array([f]))[0]), frequency_hz[row], frequency_hz[row + 1], xtol=1e-13,
               rtol=1e-13)
        for row in rows
    ]  # fmt: skip


@pytest.mark.parametrize("delay", [0, 1, 4])
def test_curves_are_those_of_python_control(delay: int) -> None:
    many = drawn(delay)
    for index in range(COUNT):
        one = single(many, index)
        z = np.exp(2j * np.pi * SERVO_PERIOD_S * FREQUENCY_HZ)
        loop = many.loop(FREQUENCY_HZ, np.array([index])) / loop_gain(*one)(z)
        sensed = many.sensed(FREQUENCY_HZ, np.array([index])) / response(*one, ENVIRONMENT, FREQUENCY_HZ)
        assert np.abs(loop - 1.0).max() < EXACT
        assert np.abs(sensed - 1.0).max() < EXACT


@pytest.mark.parametrize("delay", [0, 3])
def test_poles_are_those_of_python_control(delay: int) -> None:
    many = drawn(delay)
    resonance = many.first_resonance_hz()
    states = {True: 0, False: 0}
    for index in range(COUNT):
        z = closed_loop(*single(many, index)).poles()
        stable = bool(np.all(np.abs(z) < 1.0))
        assert many.stable[index] == stable
        states[stable] += 1
        if not stable:
            assert math.isnan(resonance[index])
            continue
        s = np.log(z[np.abs(z) > 1e-6]) / SERVO_PERIOD_S
        swings = [abs(one) for one in s if one.imag != 0.0 and -one.real < math.sqrt(0.5) * abs(one)]
        assert resonance[index] == pytest.approx(min(swings, default=math.inf) / (2.0 * math.pi), rel=1e-8)
    assert states[True] > COUNT // 2
    assert delay == 0 or states[False] > 0


@pytest.mark.parametrize("delay", [0, 3])
def test_margins_and_bandwidth_are_the_crossings_of_python_controls_curves(delay: int) -> None:
    many = drawn(delay)
    margins, bandwidth = many.margins(), many.bandwidth_hz()
    dense = np.geomspace(0.02, 999.9, 2500)
    judged = 0
    for index in np.flatnonzero(many.stable):
        drivetrain, servo = single(many, int(index))
        loop = loop_gain(drivetrain, servo)

        def size(f: NDArray[np.float64], loop: control.StateSpace = loop) -> NDArray[np.float64]:
            return np.asarray(np.log(np.abs(loop_at(loop, f))))

        def across(f: NDArray[np.float64], loop: control.StateSpace = loop) -> NDArray[np.float64]:
            value = loop_at(loop, f)
            return np.asarray(value.imag / np.abs(value))

        crossovers = np.array(roots(size, dense))
        ahead = list(zip(np.degrees(np.angle(-loop_at(loop, crossovers))), crossovers, strict=True))
        assert margins.phase_deg[index] == pytest.approx(min(abs(angle) for angle, _ in ahead), rel=EXACT)
        assert margins.delay_s[index] == pytest.approx(min(angle % 360.0 / 360.0 / f for angle, f in ahead), rel=EXACT)
        real = loop_at(loop, np.array([*roots(across, dense), 0.5 / SERVO_PERIOD_S])).real
        gain = min(-20.0 * math.log10(-value) for value in real if -1.0 < value < 0.0)
        # A gain of 0.999 loses six digits to its logarithm.
        assert margins.gain_db[index] == pytest.approx(gain, rel=1e-9, abs=1e-9)

        def above(f: NDArray[np.float64], one: tuple[Drivetrain, Servo] = (drivetrain, servo)) -> NDArray[np.float64]:
            return np.asarray(np.abs(response(*one, ENVIRONMENT, f)) - math.sqrt(0.5))

        coarse = np.geomspace(0.1, 200.0, 400)
        assert bandwidth[index] == pytest.approx(roots(above, coarse)[0], rel=EXACT)
        judged += 1
    assert judged > COUNT // 2


def test_the_bandwidth_by_motor_current_is_that_of_the_servos_torque() -> None:
    many = drawn(2)
    by_current = np.arange(COUNT) % 2 == 0
    bandwidth, behind = many.bandwidth_hz(by_current), many.bandwidth_hz()
    coarse = np.geomspace(0.1, 200.0, 400)
    assert np.array_equal(bandwidth[~by_current], behind[~by_current], equal_nan=True)
    judged = np.flatnonzero(many.stable & by_current)
    assert len(judged) > COUNT // 4
    for index in judged:
        one = single(many, int(index))

        def above(f: NDArray[np.float64], one: tuple[Drivetrain, Servo] = one) -> NDArray[np.float64]:
            return np.asarray(np.abs(response(*one, ENVIRONMENT, f, sink=CURRENT)) - math.sqrt(0.5))

        assert bandwidth[index] == pytest.approx(roots(above, coarse)[0], rel=EXACT)
        assert bandwidth[index] != pytest.approx(behind[index], rel=1e-3)


def test_margins_are_where_the_simulated_loop_becomes_unstable() -> None:
    """By a simulation that knows neither of both."""
    many = drawn(1, 4)
    margins = many.margins()
    stable = 1.0 + 1e-7
    for index in np.flatnonzero(many.stable):
        drivetrain, servo = single(many, int(index))
        factor = 10.0 ** (margins.gain_db[index] / 20.0)
        assert largest_multiplier(drivetrain, servo, 0.999 * factor) < stable
        assert largest_multiplier(drivetrain, servo, 1.001 * factor) > stable
        ticks = margins.delay_s[index] / SERVO_PERIOD_S
        assert largest_multiplier(drivetrain, servo, delay=1 + math.floor(ticks)) < stable
        assert largest_multiplier(drivetrain, servo, delay=1 + math.ceil(ticks)) > stable


def test_the_command_says_the_same() -> None:
    drivetrain, servo = read(delay=2)
    many = ManyDrivetrains.of(np.array([[*numbers_of(drivetrain), *gains_of(servo)]]), delay=2)
    analysis = analyse(drivetrain, servo)
    # The command takes its curves as straight between points.
    near = 1e-4
    assert many.bandwidth_hz()[0] == pytest.approx(
        analysis.cases["servo"].channels["environment"].bandwidth_hz, rel=near
    )
    margins = many.margins()
    assert analysis.margins.gain is not None
    assert margins.gain_db[0] == pytest.approx(20.0 * math.log10(analysis.margins.gain), rel=near)
    assert margins.phase_deg[0] == pytest.approx(analysis.margins.phase_deg, rel=near)
    assert margins.delay_s[0] == pytest.approx(analysis.margins.delay_s, rel=near)
    first = next(pole for pole in analysis.cases["servo"].poles if pole.imaginary)
    assert many.first_resonance_hz()[0] == pytest.approx(first.frequency_hz, rel=1e-8)


class Given(ManyDrivetrains):
    """Trikey with another loop: near its resonance beyond -180 degrees, or with a gain that must not fall."""

    must_not_fall = False

    def loop(self, frequency_hz: NDArray[np.float64], which: NDArray[np.intp]) -> NDArray[np.complex128]:
        s = 2j * np.pi * frequency_hz
        if self.must_not_fall:
            return np.asarray(np.where(frequency_hz > 900.0, 1e-3, 5.0 * (s + 2.0) ** 2 / s**3))
        return np.asarray(-0.5 / ((s / 20.0) ** 2 + 0.2 * s / 20.0 + 1.0))


class Falling(Given):
    must_not_fall = True


def test_a_gain_above_1_beyond_half_a_turn_is_no_margin() -> None:
    drivetrain, servo = read()
    given = Given.of(np.array([[*numbers_of(drivetrain), *gains_of(servo)]]))
    # Through 1 upwards a little beyond -180 degrees, where delay helps, then downwards after most of a turn.
    x = np.sqrt(np.roots([1.0, 0.04 - 2.0, 0.75]).real)  # (1 - x^2)^2 + (0.2 x)^2 = 0.25
    angles = {float(one): math.degrees(math.atan2(0.2 * one, 1.0 - one**2)) for one in x}
    margins = given.margins()
    assert margins.phase_deg[0] == pytest.approx(min(angles.values()), rel=EXACT)
    later = max(x)
    wanted = (360.0 - angles[later]) / 360.0 / (20.0 * later / (2.0 * math.pi))
    assert margins.delay_s[0] == pytest.approx(wanted, rel=EXACT)
    falling = Falling.of(np.array([[*numbers_of(drivetrain), *gains_of(servo)]]))
    assert falling.margins().gain_db[0] == math.inf  # at -5 on the real axis: it may grow as it likes


def test_what_does_not_exist_is_not_a_number_or_infinite() -> None:
    drivetrain, servo = read()
    gains = ([0.0, 0.0], [servo.kp, 60.0 * servo.kd], [servo.kp, servo.kd])
    rows = [[*numbers_of(drivetrain), *one, servo.derivative_cutoff] for one in gains]
    many = ManyDrivetrains.of(np.array(rows))
    assert many.stable.tolist() == [True, False, True]
    bandwidth = many.bandwidth_hz()
    assert np.isnan(bandwidth[:2]).all()  # at rest a free motor transmits nothing
    margins = many.margins()
    assert margins.phase_deg[0] == margins.gain_db[0] == math.inf  # no loop
    assert np.isnan([margins.phase_deg[1], margins.gain_db[1], margins.delay_s[1]]).all()
    assert len(ManyDrivetrains.of(np.empty((0, 8))).bandwidth_hz()) == 0
