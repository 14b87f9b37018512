"""Many linear drivetrains at once, as arrays: what `model` says of one, without python-control, for studies.

The equations are those of `model`, with a load that turns and a gear that slides. The plant sampled by the servo is
kept as polynomials of delta = (z - 1)/T, which are as well conditioned as those of the continuous plant; polynomials of
z are not, because all slow poles lie at 1.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from giveway.drivetrain.model import SERVO_PERIOD_S

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Real = NDArray[np.float64]
    Complex = NDArray[np.complex128]

__all__ = ["LoopMargins", "ManyDrivetrains"]

HIGHEST_HZ = 0.5 / SERVO_PERIOD_S
LOWEST_HZ, POINTS = 1e-2, 100  # of the frequencies between which crossings are looked for
NEAR_POINTS, NEAR = 14, 3.0  # more of them around each lightly damped mode, so many half widths to each side
NO_MODE_RADPS = 1e-6  # poles nearer to zero are a drivetrain that turns freely
AT_ONCE_Z = 1e-6  # a sampled pole this near to zero is a delay, not a motion
OSCILLATES = math.sqrt(0.5)  # a pair with less damping has a resonance
REFINEMENTS = 60
EXACT = 1e-14  # of a logarithm of a frequency


@dataclass(frozen=True)
class LoopMargins:
    """Margins of the servo's loop, broken at the motor torque; NaN where it is unstable, infinite where none limits.

    Attributes:
        gain_db: by how much the loop gain may grow.
        phase_deg: smallest distance of the phase from -180 degrees where the gain is 1.
        delay_s: additional delay that the loop bears.
    """

    gain_db: Real
    phase_deg: Real
    delay_s: Real


@dataclass(frozen=True)
class ManyDrivetrains:
    """n drivetrains with their loads and servos, all numbers at the wheel axle, arrays of n.

    Attributes:
        motor_inertia, stiffness, damping, gear_viscous, load_inertia: as in `model.Drivetrain`.
        kp, kd, derivative_cutoff: as in `model.Servo`.
        delay: of the servo, ticks, the same for all.
    """

    motor_inertia: Real
    stiffness: Real
    damping: Real
    gear_viscous: Real
    load_inertia: Real
    kp: Real
    kd: Real
    derivative_cutoff: Real
    delay: int = 0

    @classmethod
    def of(cls, numbers: Real, delay: int = 0) -> ManyDrivetrains:
        """Of rows of numbers, shape (n, 8), in the order of the attributes."""
        m, k, d, b, load, kp, kd, cutoff = np.asarray(numbers, dtype=float).T
        return cls(m, k, d, b, load, kp, kd, cutoff, delay)

    @cached_property
    def _sampled(self) -> tuple[Real, Real]:
        """Matrix (n, 4, 4) and vector (n, 4) of wind-up, motor speed, load speed and motor angle per tick, less the
        identity and over T."""
        from scipy.linalg import expm

        n = len(self.stiffness)
        a = np.zeros((n, 5, 5))
        a[:, 0, 1], a[:, 0, 2], a[:, 3, 1] = 1.0, -1.0, 1.0
        for row, inertia, sign in ((1, self.motor_inertia, -1.0), (2, self.load_inertia, 1.0)):
            a[:, row, 0] = sign * self.stiffness / inertia
            a[:, row, 1], a[:, row, 2] = sign * self.damping / inertia, -sign * self.damping / inertia
        a[:, 1, 1] -= self.gear_viscous / self.motor_inertia
        a[:, 1, 4] = 1.0 / self.motor_inertia
        step = expm(a * SERVO_PERIOD_S) if n else a
        change = (step - np.eye(5)) / SERVO_PERIOD_S
        return change[:, :4, :4], change[:, :4, 4]

    @cached_property
    def _polynomials(self) -> tuple[Real, Real]:
        """Numerator (n, 4) and denominator (n, 5) in delta of motor angle per motor torque, highest power first."""
        change, into = self._sampled
        d, b = change[:, :3, :3], into[:, :3]
        eye = np.eye(3)
        # Faddeev and LeVerrier: adj(x I - d) = x^2 I + x m1 + m2, det = x^3 + c2 x^2 + c1 x + c0.
        c2 = -np.trace(d, axis1=1, axis2=2)
        m1 = d + c2[:, None, None] * eye
        dm1 = d @ m1
        c1 = -0.5 * np.trace(dm1, axis1=1, axis2=2)
        m2 = dm1 + c1[:, None, None] * eye
        c0 = -np.trace(d @ m2, axis1=1, axis2=2) / 3.0
        from_speed = change[:, 3, :3]
        through = [np.einsum("ni,ni->n", from_speed, v) for v in (b, (m1 @ b[:, :, None])[:, :, 0],
                                                                  (m2 @ b[:, :, None])[:, :, 0])]  # fmt: skip
        direct, one = into[:, 3], np.ones(len(b))
        top = np.stack([direct, direct * c2 + through[0], direct * c1 + through[1], direct * c0 + through[2]], axis=1)
        return top, np.stack([one, c2, c1, c0, np.zeros(len(b))], axis=1)

    def _servo_gains(self) -> tuple[Real, Real]:
        """Share of the filter of the speed, and the gain of the difference of two angles."""
        share = -np.expm1(-2.0 * np.pi * self.derivative_cutoff * SERVO_PERIOD_S)
        return share, self.kd * share / SERVO_PERIOD_S

    def _control_law(self, z: Complex, which: NDArray[np.intp]) -> Complex:
        share, rate = self._servo_gains()
        share, rate, kp = share[which], rate[which], self.kp[which]
        back = 1.0 / z
        return np.asarray((kp + rate * (1.0 - back) / (1.0 - (1.0 - share) * back)) * back**self.delay)

    def _angle_per_torque(self, z: Complex, which: NDArray[np.intp]) -> Complex:
        """Of the sampled plant."""
        delta = (z - 1.0) / SERVO_PERIOD_S
        top, bottom = self._polynomials
        return np.asarray(_horner(top, delta, which) / _horner(bottom, delta, which))

    def loop(self, frequency_hz: Real, which: NDArray[np.intp]) -> Complex:
        """Open loop of the servo at a frequency each of the drivetrains ``which``; shapes as numpy fits them."""
        z = np.exp(2j * np.pi * SERVO_PERIOD_S * frequency_hz)
        return np.asarray(self._control_law(z, which) * self._angle_per_torque(z, which))

    def sensed(self, frequency_hz: Real, which: NDArray[np.intp]) -> Complex:
        """Sensed torque per torque of the environment under the servo, as `model.response`."""
        s = np.asarray(2j * np.pi * frequency_hz, dtype=np.complex128)
        direct, per_motor, fed_back = self._torques(s, which)
        hold = (1.0 - 1.0 / np.exp(s * SERVO_PERIOD_S)) / (s * SERVO_PERIOD_S)
        return np.asarray(direct - per_motor * hold * fed_back)

    def current(self, frequency_hz: Real, which: NDArray[np.intp]) -> Complex:
        """The same of the servo's torque as the motor's current shows it, a tick late."""
        s = np.asarray(2j * np.pi * frequency_hz, dtype=np.complex128)
        return np.asarray(-np.exp(-s * SERVO_PERIOD_S) * self._torques(s, which)[2])

    def _torques(self, s: Complex, which: NDArray[np.intp]) -> tuple[Complex, Complex, Complex]:
        """Sensed torque per torque of the environment and of the motor without the servo, and the servo's torque
        against a torque of the environment."""
        motor = self.motor_inertia[which] * s + self.gear_viscous[which]  # impedances over s
        load = self.load_inertia[which] * s
        spring = self.damping[which] * s + self.stiffness[which]
        bottom = s * motor * load + spring * (motor + load)
        z = np.exp(s * SERVO_PERIOD_S)
        law = self._control_law(z, which)
        fed_back = law / (1.0 + law * self._angle_per_torque(z, which)) * spring / (s * bottom)
        return np.asarray(-spring * motor / bottom), np.asarray(spring * load / bottom), np.asarray(fed_back)

    @cached_property
    def poles(self) -> Complex:
        """Of the sampled loop as s = ln(z)/T, rad/s, shape (n, states); NaN for what is over within a tick."""
        change, into = self._sampled
        share, rate = self._servo_gains()
        n, order = len(self.stiffness), 5 + self.delay
        a = np.zeros((n, order, order))  # plant, filter, torques on their way
        a[:, :4, :4] = change * SERVO_PERIOD_S + np.eye(4)
        a[:, 4, 4], a[:, 4, 3] = 1.0 - share, 1.0
        now = np.zeros((n, order))  # the law's torque
        now[:, 3], now[:, 4] = self.kp + rate, -rate * share
        if self.delay:
            a[:, 5, :] = now
            for tick in range(6, order):
                a[:, tick, tick - 1] = 1.0
            a[:, :4, -1] -= into * SERVO_PERIOD_S
        else:
            a[:, :4, :] -= SERVO_PERIOD_S * into[:, :, None] * now[:, None, :]
        z = np.linalg.eigvals(a).astype(complex)
        z[np.abs(z) <= AT_ONCE_Z] = np.nan
        return np.asarray(np.log(z) / SERVO_PERIOD_S)

    @cached_property
    def stable(self) -> NDArray[np.bool_]:
        """The servo holds the motor; a drivetrain without one that turns freely counts."""
        dies = (self.poles.real < 0.0) | (np.abs(self.poles) < NO_MODE_RADPS) | np.isnan(self.poles)
        return np.asarray(dies.all(axis=1))

    def first_resonance_hz(self) -> Real:
        """Lowest |s|/2 pi of the loop's poles with a damping below 0.707; infinite: none; NaN: unstable."""
        s = self.poles
        size = np.abs(s)
        with np.errstate(invalid="ignore", divide="ignore"):
            swings = (np.abs(s.imag) > 0.0) & (-s.real < OSCILLATES * size) & (size > NO_MODE_RADPS)
        found = np.where(swings, size, np.inf).min(axis=1, initial=np.inf) / (2.0 * np.pi)
        return np.where(self.stable, found, np.nan)

    @cached_property
    def _grid(self) -> Real:
        """Frequencies, Hz, shape (n, points), up to half the servo's rate, dense around lightly damped modes."""
        n = len(self.stiffness)
        parts = [np.broadcast_to(np.geomspace(LOWEST_HZ, HIGHEST_HZ, POINTS), (n, POINTS))]
        both = 1.0 / self.motor_inertia + 1.0 / self.load_inertia
        offset = np.linspace(-NEAR, NEAR, NEAR_POINTS)
        for inverse in (both, 1.0 / self.load_inertia, 1.0 / self.motor_inertia):
            natural = np.sqrt(self.stiffness * inverse)
            width = np.clip(0.5 * self.damping * inverse / natural, 1e-4, 0.2)
            parts.append(natural[:, None] / (2.0 * np.pi) * np.exp(width[:, None] * offset))
        s = np.where(np.isfinite(self.poles), self.poles, 1.0)
        light = (s.imag > 0.0) & (-s.real < 0.2 * np.abs(s))
        first = np.where(light, np.abs(s), np.inf).argmin(axis=1)
        pole = np.take_along_axis(s, first[:, None], axis=1)[:, 0]
        width = np.clip(np.abs(pole.real) / np.abs(pole), 1e-4, 0.2)
        parts.append(np.abs(pole)[:, None] / (2.0 * np.pi) * np.exp(width[:, None] * offset))
        return np.sort(np.clip(np.concatenate(parts, axis=1), LOWEST_HZ, HIGHEST_HZ), axis=1)

    def margins(self) -> LoopMargins:
        """Of all loops."""
        grid, n = self._grid, len(self.stiffness)
        everyone = np.arange(n)
        loop = self.loop(grid, everyone[:, None])
        gain, phase, delay = np.full(n, np.inf), np.full(n, np.inf), np.full(n, np.inf)

        def size(frequency: Real, which: NDArray[np.intp]) -> Real:
            return np.asarray(np.log(np.abs(self.loop(frequency, which))))

        def across(frequency: Real, which: NDArray[np.intp]) -> Real:
            found = self.loop(frequency, which)
            return np.asarray(found.imag / np.abs(found))

        with np.errstate(divide="ignore", invalid="ignore"):  # no gains, no loop
            sizes, turned = np.log(np.abs(loop)), (loop.imag / np.abs(loop))[:, :-1]
        which, at = _roots(size, grid, sizes)
        ahead = np.degrees(np.angle(-self.loop(at, which)))
        np.minimum.at(phase, which, np.abs(ahead))
        np.minimum.at(delay, which, (ahead % 360.0) / 360.0 / at)
        which, at = _roots(across, grid[:, :-1], turned)
        # At half the servo's rate the loop is real: a crossing, too.
        ends = self.loop(np.full(n, HIGHEST_HZ), everyone)
        real = np.concatenate([self.loop(at, which).real, ends.real])
        which = np.concatenate([which, everyone])
        grows = (real < 0.0) & (real > -1.0)
        np.minimum.at(gain, which[grows], -20.0 * np.log10(-real[grows]))
        return LoopMargins(*(np.where(self.stable, one, np.nan) for one in (gain, phase, delay)))

    def bandwidth_hz(self, by_current: NDArray[np.bool_] | None = None) -> Real:
        """Lowest frequency at which the sensed torque is 3 dB below that at rest; NaN: unstable, or none is at rest.

        ``by_current``: which sense torque by the motor's current; None: none.
        """
        grid = self._grid[:, :-1]
        everyone = np.arange(len(grid))

        def above(frequency: Real, which: NDArray[np.intp]) -> Real:
            seen = self.sensed(frequency, which)
            if by_current is not None:
                seen = np.where(by_current[which], self.current(frequency, which), seen)
            return np.asarray(np.log(np.abs(seen)) + 0.5 * math.log(2.0))

        found = above(grid, everyone[:, None])
        # A motor that is held lets all of the torque through at rest; one that is not, nothing.
        held = (self.kp > 0.0) & self.stable
        which, at = _roots(above, grid, found)
        lowest = np.full(len(grid), np.inf)
        np.minimum.at(lowest, which, at)
        lowest[found[:, 0] < 0.0] = np.nan  # below the range
        return np.where(held, lowest, np.nan)


def _horner(polynomials: Real, x: Complex, which: NDArray[np.intp]) -> Complex:
    found = np.zeros(np.broadcast_shapes(x.shape, which.shape), dtype=complex)
    for power in range(polynomials.shape[1]):
        found = found * x + polynomials[which, power]
    return found


def _roots(
    function: Callable[[Real, NDArray[np.intp]], Real], grid: Real, values: Real
) -> tuple[NDArray[np.intp], Real]:
    """Where ``function`` changes its sign between points of ``grid`` (n, points): which of the n, and frequencies.

    Regula falsi of Illinois along the logarithm of the frequency.
    """
    which, point = np.nonzero(np.sign(values[:, :-1]) * np.sign(values[:, 1:]) < 0.0)
    left, right = np.log(grid[which, point]), np.log(grid[which, point + 1])
    at_left, at_right = values[which, point], values[which, point + 1]
    busy = np.arange(len(which))
    for _ in range(REFINEMENTS):
        if not len(busy):
            break
        a, b, at_a, at_b = left[busy], right[busy], at_left[busy], at_right[busy]
        found = b - at_b * (b - a) / (at_b - at_a)
        value = function(np.exp(found), which[busy])
        crossed = value * at_b < 0.0
        left[busy], at_left[busy] = np.where(crossed, b, a), np.where(crossed, at_b, 0.5 * at_a)
        right[busy], at_right[busy] = found, value
        busy = busy[(value != 0.0) & (np.abs(found - b) > EXACT * np.maximum(1.0, np.abs(b)))]
    return which, np.exp(right)
