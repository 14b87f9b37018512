"""The numerical part of the roller calibration: smoothed samples, the zone near rest, the robust fit and its spread.

`giveway.identification.roller_friction` explains the method, and refuses logs that these functions cannot use.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.errors import GivewayError
from giveway.identification.torque_model import TorqueModel
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.identification.motion_log import MotionLog
    from giveway.robot.robot_file import Robot

__all__ = [
    "CONFIDENCE",
    "LONGEST_STEP_S",
    "SMOOTHING_S",
    "Fit",
    "RestZone",
    "Samples",
    "check_step",
    "enough_blocks",
    "fit",
    "half_widths",
    "prepare",
]

SMOOTHING_S = 0.05
"""Standard deviation of the Gaussian: -3 dB at 2.7 Hz. Arcs take seconds; encoder steps and servo ripple do not."""

LONGEST_STEP_S = SMOOTHING_S  # between two samples of a log: the Gaussian has to cover some of them
STEP_TOLERANCE = 0.02  # of it: clocks of loggers, and rounded times
CONFIDENCE = 0.95
TRUNCATE = 4.0  # Gaussians are cut off here; what the cut touches at the ends of a log is left out
SAMPLES_PER_SMOOTHING = 1  # between kept samples: closer ones would add no information
REST_SPEEDS = 4.0  # exp(-16): nothing is left of the Stribeck term
REST_LENGTHS = 5.0  # exp(-5) = 0.7 %: the bristles have turned over
ROBUST = 2.0  # residuals beyond two standard deviations lose weight (soft l1)
ROUNDS = 3  # rounds of fitting and re-estimating each wheel's noise; the third has no visible effect
EVALUATIONS = 100  # in a round; a fit that takes more stands still where something is not determined
CORRELATIONS_PER_BLOCK = 3.0
BLOCKS_PER_PARAMETER = 2  # with fewer blocks their scatter is unknown
GAUSSIAN_MAD = 1.4826  # standard deviation over median absolute deviation
SLOPES = np.geomspace(0.03, 300.0, 24)  # starting values of alpha, times the largest roller rate


def check_step(name: str, step_s: float) -> None:
    """GivewayError if the usual time between the rows of log ``name``, s, is too long to see a motion by."""
    if step_s > (1.0 + STEP_TOLERANCE) * LONGEST_STEP_S:
        allowed = f"at most {LONGEST_STEP_S:g} s between rows; is the unit of its times right?"
        raise GivewayError(f"{name}: time step", f"{step_s:.6g} s", allowed)


@dataclass(frozen=True)
class Samples:
    """One log, smoothed and thinned out.

    Attributes:
        time_s: shape (n,), s, evenly spaced.
        wheel_angle_rad, torque_nm: shape (n, 3).
        wheel_rate: shape (n, 3), rad/s.
        roller_rate: shape (n, 3), rad/s.
        rigid_nm: shape (n, 3), torques of (27) without friction, N m.
        sound: shape (n,), neither saturated nor at the ends of the log.
    """

    time_s: NDArray[np.float64]
    wheel_angle_rad: NDArray[np.float64]
    torque_nm: NDArray[np.float64]
    wheel_rate: NDArray[np.float64]
    roller_rate: NDArray[np.float64]
    rigid_nm: NDArray[np.float64]
    sound: NDArray[np.bool_]

    @property
    def step_s(self) -> float:
        return float(self.time_s[1] - self.time_s[0])


def prepare(log: MotionLog, model: TorqueModel, torque_limit_nm: float, smoothing_s: float = SMOOTHING_S) -> Samples:
    """Put ``log`` on an even grid, smooth angles and torques alike, and differentiate the smoothed angles.

    Args:
        log: at most `LONGEST_STEP_S` between its samples.
        model: of the robot.
        torque_limit_nm: where the torque sensors saturate, N m; such samples are not sound.
        smoothing_s: standard deviation of the Gaussian, s.
    """
    from scipy.ndimage import gaussian_filter1d

    step = float(np.median(np.diff(log.time_s)))
    count = int((log.time_s[-1] - log.time_s[0]) / step) + 1
    time: NDArray[np.float64] = log.time_s[0] + step * np.arange(count)

    def smooth(values: NDArray[np.float64]) -> NDArray[np.float64]:
        even = np.interp(time, log.time_s, values)
        return np.asarray(gaussian_filter1d(even, smoothing_s / step, truncate=TRUNCATE, mode="nearest"))

    angle = np.stack([smooth(log.wheel_angle_rad[:, wheel]) for wheel in range(WHEELS)], axis=1)
    torque = np.stack([smooth(log.torque_nm[:, wheel]) for wheel in range(WHEELS)], axis=1)
    saturated = smooth(np.where((np.abs(log.torque_nm) >= torque_limit_nm).any(axis=1), 1.0, 0.0))
    reach = TRUNCATE * smoothing_s + step  # of the Gaussian and the difference
    sound = (saturated == 0.0) & (time >= time[0] + reach) & (time <= time[-1] - reach)
    rate = np.gradient(angle, step, axis=0)
    roller_rate, rigid = model.motion(rate, np.gradient(rate, step, axis=0))
    kept = slice(None, None, max(1, round(SMOOTHING_S / SAMPLES_PER_SMOOTHING / step)))
    return Samples(
        time[kept], angle[kept], torque[kept], rate[kept], roller_rate[kept], rigid[kept], np.asarray(sound)[kept]
    )


@dataclass(frozen=True)
class RestZone:
    """The zone in which presliding and stiction dominate a roller, in m/s and m at its rim."""

    speed_mps: float
    length_m: float

    @classmethod
    def of(cls, robot: Robot) -> RestZone:
        """From a robot file: 4 Stribeck speeds, 5 presliding lengths."""
        force = float(robot.value("roller.coulomb_torque")) / float(robot.value("roller.radius"))
        return cls(
            speed_mps=REST_SPEEDS * float(robot.value("roller.stribeck_speed")),
            length_m=REST_LENGTHS * force / float(robot.value("roller.presliding_stiffness")),
        )

    def moving(self, samples: Samples, roller_radius_m: float) -> NDArray[np.bool_]:
        """The rollers that ever leave the zone, shape (3,)."""
        fast = np.abs(samples.roller_rate[samples.sound]) * roller_radius_m > self.speed_mps
        return np.asarray(fast.any(axis=0))

    def free(self, samples: Samples, roller_radius_m: float, width: float = 1.0) -> NDArray[np.bool_]:
        """Sound samples at which every moving roller is outside ``width`` times the zone, shape (n,)."""
        speed = samples.roller_rate * roller_radius_m
        free = samples.sound.copy()
        moving = self.moving(samples, roller_radius_m)
        for roller in np.flatnonzero(moving):
            v = speed[:, roller]
            path = np.cumsum(v) * samples.step_s
            turns = np.flatnonzero(np.diff(np.signbit(v)))
            turns = np.concatenate(([0], turns, [len(v) - 1]))  # the ends of the log may be reversals, too
            next_one = np.clip(np.searchsorted(turns, np.arange(len(v))), 1, len(turns) - 1)
            for turn in (turns[next_one - 1], turns[next_one]):
                free &= np.abs(path - path[turn]) > width * self.length_m
            free &= np.abs(v) > width * self.speed_mps
        return free & moving.any()


@dataclass(frozen=True)
class Fit:
    """A robust fit of x = (B_r, alpha, offsets of the first log, of the second, ...).

    Attributes:
        x: shape (2 + 3 logs,).
        scores: shape (blocks, 2 + 3 logs), the sum over each block of residual times gradient.
        curvature: shape (2 + 3 logs, 2 + 3 logs).
        blocks, block_s: number of blocks that hold samples, and their length.
        explained: share of the variance of the friction torques that is explained.
    """

    x: NDArray[np.float64]
    scores: NDArray[np.float64]
    curvature: NDArray[np.float64]
    blocks: int
    block_s: float
    explained: float

    def offset_nm(self, log: int) -> NDArray[np.float64]:
        """The offsets of log number ``log``, shape (3,), N m."""
        return self.x[2 + WHEELS * log : 2 + WHEELS * (log + 1)]


class _Problem:
    """Residuals and gradients of all logs, one row per sample and wheel."""

    def __init__(self, samples: Sequence[Samples], used: Sequence[NDArray[np.bool_]], model: TorqueModel) -> None:
        self._gain = model.friction_gain
        self._rate = np.concatenate([s.roller_rate[rows] for s, rows in zip(samples, used, strict=True)])
        self._wanted = np.concatenate([(s.torque_nm - s.rigid_nm)[rows] for s, rows in zip(samples, used, strict=True)])
        self._log = np.repeat(np.arange(len(samples)), [rows.sum() for rows in used])
        self.parameters = 2 + WHEELS * len(samples)
        self.sigma = np.ones((len(samples), WHEELS))

    def residuals(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Model minus log over each wheel's noise, shape (n * 3,)."""
        friction = x[0] * np.tanh(x[1] * self._rate) @ self._gain.T
        offsets = x[2:].reshape(-1, WHEELS)
        return np.asarray(((friction + offsets[self._log] - self._wanted) / self.sigma[self._log]).ravel())

    def jacobian(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Derivatives of `residuals`, shape (n * 3, parameters)."""
        tanh = np.tanh(x[1] * self._rate)
        gradient = np.zeros((len(self._rate), WHEELS, self.parameters))
        gradient[:, :, 0] = tanh @ self._gain.T
        gradient[:, :, 1] = x[0] * (self._rate * (1.0 - tanh**2)) @ self._gain.T
        for wheel in range(WHEELS):
            gradient[np.arange(len(self._rate)), wheel, 2 + WHEELS * self._log + wheel] = 1.0
        return np.asarray((gradient / self.sigma[self._log][:, :, None]).reshape(-1, self.parameters))

    def start(self) -> NDArray[np.float64]:
        """The best of a row of slopes; for each, everything else is a linear least-squares problem."""
        best, least = np.zeros(self.parameters), np.inf
        linear = [0, *range(2, self.parameters)]
        for slope in SLOPES / self.largest_rate:
            x = np.zeros(self.parameters)
            x[0], x[1] = 1.0, slope
            columns = self.jacobian(x)[:, linear]
            x[0] = 0.0
            x[linear] = np.linalg.lstsq(columns, -self.residuals(x), rcond=None)[0]
            cost = float(np.sum(self.residuals(x) ** 2))
            if cost < least:
                best, least = x, cost
        return best

    @property
    def largest_rate(self) -> float:
        return float(np.abs(self._rate).max())

    def weigh(self, x: NDArray[np.float64]) -> None:
        """Estimate each wheel's noise from its residuals."""
        plain = self.residuals(x).reshape(-1, WHEELS) * self.sigma[self._log]
        for log in range(len(self.sigma)):
            spread = (
                GAUSSIAN_MAD * np.median(np.abs(plain[self._log == log]), axis=0) if (self._log == log).any() else 1.0
            )
            self.sigma[log] = np.maximum(spread, np.finfo(np.float64).tiny ** 0.25)

    def explained(self, x: NDArray[np.float64]) -> float:
        left, all_of_it = 0.0, 0.0
        plain = self.residuals(x).reshape(-1, WHEELS) * self.sigma[self._log]
        for log in range(len(self.sigma)):
            rows = self._log == log
            left += float(np.sum(plain[rows] ** 2))
            all_of_it += (
                float(np.sum((self._wanted[rows] - self._wanted[rows].mean(axis=0)) ** 2)) if rows.any() else 0.0
            )
        return 1.0 - left / all_of_it if all_of_it > 0.0 else 0.0


def fit(samples: Sequence[Samples], used: Sequence[NDArray[np.bool_]], model: TorqueModel) -> Fit:
    """Fit (27) with (28) to the ``used`` samples of all logs together."""
    from scipy.optimize import least_squares

    problem = _Problem(samples, used, model)
    x = problem.start()
    lower = np.full(problem.parameters, -np.inf)
    lower[1] = 0.0
    for _ in range(ROUNDS):
        problem.weigh(x)
        x[1] = max(x[1], SLOPES[0] / problem.largest_rate)
        found = least_squares(
            problem.residuals,
            x,
            problem.jacobian,
            bounds=(lower, np.inf),
            loss="soft_l1",
            f_scale=ROBUST,
            x_scale="jac",
            max_nfev=EVALUATIONS,
        )
        x = np.asarray(found.x)
    residuals, gradient = problem.residuals(x), problem.jacobian(x)
    bent = 1.0 + (residuals / ROBUST) ** 2
    block_s = _block_length(samples, used, residuals.reshape(-1, WHEELS))
    block = _blocks(samples, used, block_s)
    scores = np.zeros((int(block.max()) + 1, problem.parameters))
    np.add.at(scores, np.repeat(block, WHEELS), gradient * (residuals / np.sqrt(bent))[:, None])
    curvature = (gradient * bent[:, None] ** -1.5).T @ gradient
    return Fit(x, scores, curvature, len(scores), block_s, problem.explained(x))


def enough_blocks(found: Fit) -> bool:
    """Whether there are enough blocks to estimate their scatter."""
    return found.blocks >= BLOCKS_PER_PARAMETER * len(found.x)


def half_widths(found: Fit) -> NDArray[np.float64]:
    """Half-widths of the 95 % intervals of ``found.x`` from its residuals, shape of x; infinite where undetermined.

    The covariance is H^-1 (sum over blocks of g g^T) H^-1: correct for residuals that are correlated within a block and
    differ in magnitude. Student's quantile corrects for few blocks, down to two for each parameter.
    """
    from scipy.special import stdtrit

    freedom = found.blocks - len(found.x)
    scale = np.sqrt(np.diag(found.curvature))
    if not enough_blocks(found) or not (scale > 0.0).all():
        return np.full(len(found.x), np.inf)
    scaled = found.curvature / np.outer(scale, scale)
    if np.linalg.cond(scaled) > 1.0 / np.sqrt(np.finfo(np.float64).eps):
        return np.full(len(found.x), np.inf)  # a combination of parameters that no sample feels
    inverse = np.linalg.inv(scaled) / np.outer(scale, scale)
    covariance = inverse @ (found.scores.T @ found.scores) @ inverse * found.blocks / freedom
    return np.asarray(stdtrit(freedom, 0.5 + CONFIDENCE / 2.0) * np.sqrt(np.diag(covariance)))


def _block_length(
    samples: Sequence[Samples], used: Sequence[NDArray[np.bool_]], residuals: NDArray[np.float64]
) -> float:
    """Three times the longest integrated correlation time of any wheel's residuals, and of the smoothing, s."""
    longest, start = 2.0 * SMOOTHING_S * np.sqrt(np.pi), 0  # of white noise behind the Gaussian
    for s, rows in zip(samples, used, strict=True):
        count = int(rows.sum())
        for wheel in range(WHEELS):
            whole = np.zeros(len(rows))  # left-out samples count as zero
            whole[rows] = residuals[start : start + count, wheel]
            longest = max(longest, s.step_s * _correlation(whole))
        start += count
    return float(CORRELATIONS_PER_BLOCK * longest)


def _correlation(values: NDArray[np.float64]) -> float:
    """1 + 2 times the sum of the autocorrelation up to its first zero, in samples."""
    spectrum = np.fft.rfft(values, 2 * len(values))
    correlation: NDArray[np.float64] = np.fft.irfft(np.abs(spectrum) ** 2)[: len(values)]
    if correlation[0] <= 0.0:
        return 1.0
    negative = np.flatnonzero(correlation < 0.0)
    end = int(negative[0]) if negative.size else len(values)
    return float(2.0 * np.sum(correlation[:end]) / correlation[0] - 1.0)


def _blocks(samples: Sequence[Samples], used: Sequence[NDArray[np.bool_]], block_s: float) -> NDArray[np.intp]:
    """The number of the block of every used sample; a block belongs to one log."""
    numbers: list[NDArray[np.intp]] = []
    first = 0
    for s, rows in zip(samples, used, strict=True):
        if not rows.any():
            continue
        _, number = np.unique(((s.time_s[rows] - s.time_s[0]) / block_s).astype(np.intp), return_inverse=True)
        numbers.append(number + first)
        first += int(number.max()) + 1
    return np.concatenate(numbers)
