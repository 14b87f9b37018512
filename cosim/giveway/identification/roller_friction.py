"""Roller friction from a log of free motion: B_r and alpha of (28), as in the paper's 4.2.

Without contact the sensed wheel torques are those of (27),

    T = J_w^-T [M_t xdd + J_r^T (I_r qdd_r + B_r tanh(alpha qd_r))] + I_w qdd_w + offset,

and everything but B_r, alpha and the offsets of the sensors is known from the robot file and the wheel angles. The
steps, in the base frame, where the Jacobians are constant:

1. Wheel angles and torques pass through one and the same zero-phase low-pass (a Gaussian), so that both sides of the
equation are filtered alike; rates and accelerations are differences of the smoothed angles (29), (30). 2. Samples at
which a moving roller is near rest are left out: there presliding and stiction dominate, and (28) has neither. Near rest
means slower than 4 Stribeck speeds, or less than 5 presliding lengths after a reversal. 3. B_r, alpha and one offset
per wheel and log (the tare; it cannot be measured at rest, as stuck rollers and gears hold torque) are fitted to all
logs together, with a robust loss, each wheel weighted by its own noise. 4. The interval: the residuals of one block of
time count as one observation (a block is long against their
   correlation), so neither autocorrelation nor uneven noise makes it too narrow. The change of B_r and alpha with other
   widths of the zone of step 2 and of the low-pass of step 1 is added. The numbers of the rigid part (mass, radii)
   count as exact.

Refused are: the same log twice, a log in which something touched the robot (`disturbance`), and logs that leave the
    friction force more uncertain than the detector's leak in motion covers. The message says what to do.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.errors import GivewayError, one_line
from giveway.identification.disturbance import Limits, find_disturbance
from giveway.identification.friction_curve import FrictionCurve, friction_curve
from giveway.identification.roller_fit import (
    BLOCKS_PER_PARAMETER,
    SMOOTHING_S,
    Fit,
    RestZone,
    Samples,
    check_step,
    enough_blocks,
    fit,
    half_widths,
    prepare,
)
from giveway.identification.torque_model import TorqueModel

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.identification.motion_log import MotionLog
    from giveway.robot.robot_file import Robot

__all__ = ["Calibration", "Estimate", "FittedLog", "TouchedError", "UnidentifiableError", "calibrate"]

EXPLAINED_MIN = 0.5  # with a smaller share most of the torque is not explained by (27)
ALIKE = 1.5  # speeds within this factor show the tanh at one point
NEAR_REST = 3.0  # widths of the zone near rest: a log that shows rollers so slow has been slow enough
LEVEL = 0.1  # share by which friction over the speed may fall and still counts as constant
FLAT = 2.65  # tanh(2.65) = 0.99
VARIATIONS = ((0.7, 1.0), (1.5, 1.0), (1.0, 2.0))
"""Widths of the zone near rest and of the low-pass, relative to those of the fit; their results give the spread."""


class UnidentifiableError(GivewayError):
    """Logs that do not determine B_r or alpha.

    Attributes:
        field: names of the logs.
        value: what is missing.
        allowed: what to do about it.
    """

    def __str__(self) -> str:
        return one_line(f"{self.field}: {self.value}; {self.allowed}")


class TouchedError(UnidentifiableError):
    """A log in which forces act that free motion does not explain."""


@dataclass(frozen=True)
class Estimate:
    """A fitted number and its uncertainty.

    Attributes:
        value: the number.
        from_noise: the part of it that the residuals explain.
        from_choices: the part of it that comes from the widths of the zone near rest and of the low-pass.
    """

    value: float
    from_noise: float
    from_choices: float

    @property
    def half_width(self) -> float:
        """Half of the 95 % interval."""
        return math.hypot(self.from_noise, self.from_choices)

    @property
    def low(self) -> float:
        """Lower end of the interval."""
        return self.value - self.half_width

    @property
    def high(self) -> float:
        """Upper end of the interval."""
        return self.value + self.half_width

    def holds(self, truth: float) -> bool:
        """Whether ``truth`` lies within the interval."""
        return self.low <= truth <= self.high


@dataclass(frozen=True)
class FittedLog:
    """One log after smoothing, and the fitted model's results for it.

    Attributes:
        name: of the log.
        time_s: shape (n,), s.
        wheel_angle_rad: shape (n, 3), rad.
        torque_nm: shape (n, 3), sensed torque, N m.
        roller_rate: shape (n, 3), rad/s.
        model_nm: shape (n, 3), the torque of (27) with the fitted friction and offsets, N m.
        sound: shape (n,), samples that are neither saturated nor at the ends of the log.
        used: shape (n,), those of them that took part in the fit.
        offset_nm: shape (3,), the fitted tare, N m.
    """

    name: str
    time_s: NDArray[np.float64]
    wheel_angle_rad: NDArray[np.float64]
    torque_nm: NDArray[np.float64]
    roller_rate: NDArray[np.float64]
    model_nm: NDArray[np.float64]
    sound: NDArray[np.bool_]
    used: NDArray[np.bool_]
    offset_nm: NDArray[np.float64]


@dataclass(frozen=True)
class Calibration:
    """The results of a calibration.

    Attributes:
        coulomb_torque_nm: B_r of (28), N m.
        tanh_slope_s_rad: alpha of (28), s/rad.
        force_uncertainty_n: the largest half-width of the friction force of one roller that follows, at any speed, N.
        explained: share of the variance of the used torques that the model explains, 1.
        blocks: number of blocks of residuals.
        block_s: their length, s.
        logs: one per log.
    """

    coulomb_torque_nm: Estimate
    tanh_slope_s_rad: Estimate
    force_uncertainty_n: float
    explained: float
    blocks: int
    block_s: float
    logs: tuple[FittedLog, ...]


def calibrate(logs: Sequence[MotionLog], robot: Robot) -> Calibration:
    """Fit B_r and alpha to ``logs`` of free motion of ``robot``.

    Raises UnidentifiableError if they do not determine B_r or alpha; it says what is missing. The same log twice, and a
    log in which something touched the robot, are refused likewise.
    """
    if not logs:
        raise GivewayError("logs", "none", "at least one log")
    _check_different(logs)
    data = _Data.of(logs, robot)
    samples = data.samples()
    used = data.used(samples)
    _check_motion(data, samples, used)
    found = fit(samples, used, data.model)
    if touched := find_disturbance(samples, used, found, data.model, data.limits):
        raise TouchedError(
            logs[touched.log].name,
            f"from {touched.begin_s:.1f} to {touched.end_s:.1f} s something touched the robot: up to "
            f"{touched.force_n:.0f} N that free motion does not explain",
            "cut that out and give what is before and after as logs of their own, or drive again",
        )
    noise = half_widths(found)[:2]
    spread = _spread(data, found)
    coulomb, slope = (Estimate(float(found.x[i]), float(noise[i]), float(spread[i])) for i in range(2))
    uncertainty = _force_uncertainty(coulomb, slope) / data.model.roller_radius_m
    if refusal := _refusal(data, found, samples, used, uncertainty):
        raise UnidentifiableError(data.names, *refusal)
    fitted = tuple(_fitted(log, samples[i], used[i], found, i, data.model) for i, log in enumerate(logs))
    return Calibration(coulomb, slope, uncertainty, found.explained, found.blocks, found.block_s, fitted)


def _check_different(logs: Sequence[MotionLog]) -> None:
    """Refuse a log with the data of another one, under any name and with any start time."""
    for index, log in enumerate(logs):
        for other in logs[:index]:
            if np.array_equal(log.torque_nm, other.torque_nm) and np.array_equal(
                log.wheel_angle_rad, other.wheel_angle_rad
            ):
                reason = f"has the same content as {other.name}" if log.name != other.name else "is given twice"
                raise UnidentifiableError(log.name, reason, "give each log once: twice it would seem twice as sure")


@dataclass(frozen=True)
class _Data:
    """The logs and the robot's numbers for them."""

    logs: Sequence[MotionLog]
    model: TorqueModel
    zone: RestZone
    torque_limit_nm: float
    limits: Limits

    @classmethod
    def of(cls, logs: Sequence[MotionLog], robot: Robot) -> _Data:
        for log in logs:
            check_step(log.name, float(np.median(np.diff(log.time_s))))
        return cls(
            logs,
            TorqueModel.of(robot),
            RestZone.of(robot),
            float(robot.value("drivetrain.torque_sensor_limit")),
            Limits(float(robot.value("detector.leak_motion")), float(robot.value("detector.impulse_threshold"))),
        )

    @property
    def leak_n(self) -> float:
        """The detector's leak in motion, N."""
        return self.limits.leak_n

    @property
    def names(self) -> str:
        return ", ".join(log.name for log in self.logs)

    def samples(self, smoothing: float = 1.0) -> list[Samples]:
        return [prepare(log, self.model, self.torque_limit_nm, smoothing * SMOOTHING_S) for log in self.logs]

    def used(self, samples: Sequence[Samples], zone: float = 1.0) -> list[NDArray[np.bool_]]:
        return [self.zone.free(one, self.model.roller_radius_m, zone) for one in samples]


def _check_motion(data: _Data, samples: Sequence[Samples], used: Sequence[NDArray[np.bool_]]) -> None:
    """Refuse logs in which nothing can be fitted, with the most basic reason."""
    for log in data.logs:
        for wheel, spread in enumerate(np.ptp(log.torque_nm, axis=0)):
            if spread == 0.0:
                raise UnidentifiableError(log.name, f"torque_{wheel} never changes", "all three sensors are needed")
    if any(rows.any() for rows in used):
        return
    if not any(s.sound.any() for s in samples):
        saturated = any((np.abs(log.torque_nm) >= data.torque_limit_nm).any() for log in data.logs)
        reason = (
            f"torques are at the sensor's limit of {data.torque_limit_nm:g} N m" if saturated else "it is too short"
        )
        raise UnidentifiableError(data.names, f"no sound sample: {reason}", "drive arcs of some seconds, and gently")
    fastest = max(float(np.abs(s.roller_rate[s.sound]).max()) for s in samples if s.sound.any())
    wheels = max(float(np.abs(s.wheel_rate[s.sound]).max()) for s in samples if s.sound.any())
    rim, tread = fastest * data.model.roller_radius_m, wheels * data.model.wheel_radius_m
    what = f"the rollers never get away from rest: {1e3 * rim:.2g} mm/s at most"
    if tread > data.zone.speed_mps > rim:
        raise UnidentifiableError(
            data.names,
            f"{what}, though the wheels turn: the robot spins on the spot",
            "drive arcs: one wheel moving, or two",
        )
    wanted = f"above {1e3 * data.zone.speed_mps:g} mm/s over more than {1e3 * data.zone.length_m:.2g} mm each way"
    raise UnidentifiableError(data.names, what, f"they have to roll {wanted}")


def _spread(data: _Data, found: Fit) -> NDArray[np.float64]:
    """Largest change of B_r and alpha over `VARIATIONS`, in quadrature over zone and low-pass, shape (2,)."""
    changes: dict[bool, NDArray[np.float64]] = {True: np.zeros(2), False: np.zeros(2)}
    for zone, smoothing in VARIATIONS:
        samples = data.samples(smoothing)
        used = data.used(samples, zone)
        if not any(rows.any() for rows in used):
            continue  # no sample is that far from rest; the narrower zone alone gives the spread
        change = np.abs(fit(samples, used, data.model).x[:2] - found.x[:2])
        changes[zone == 1.0] = np.maximum(changes[zone == 1.0], change)
    return np.hypot(changes[True], changes[False])


def _force_uncertainty(coulomb: Estimate, slope: Estimate) -> float:
    """Largest half-width of B_r tanh(alpha rate) over all rates, N m."""
    if not (math.isfinite(coulomb.half_width) and math.isfinite(slope.half_width)):
        return math.inf
    rate = np.geomspace(0.01, 100.0, 200) / slope.value
    low, high = (np.tanh(max(0.0, end) * rate) for end in (slope.low, slope.high))
    return float(np.hypot(coulomb.half_width, 0.5 * abs(coulomb.value) * (high - low)).max())


def _refusal(
    data: _Data, found: Fit, samples: Sequence[Samples], used: Sequence[NDArray[np.bool_]], uncertainty_n: float
) -> tuple[str, str] | None:
    """What the logs lack, and what to do about it, the most basic reason first; None if nothing."""
    uncertain = not uncertainty_n <= data.leak_n
    rates = np.concatenate([s.roller_rate[rows] for s, rows in zip(samples, used, strict=True)])
    one_way = all((rates[:, roller] > 0.0).mean() in (0.0, 1.0) for roller in range(rates.shape[1]))
    if one_way and (uncertain or found.explained < EXPLAINED_MIN):
        return "every roller turns one way only: friction and zero of the sensors look alike", "drive forth and back"
    curve = friction_curve(samples, used, data.model, data.zone.speed_mps / data.model.roller_radius_m)
    if found.explained < EXPLAINED_MIN and curve.all_nm < data.leak_n * data.model.wheel_radius_m:
        small_nm = curve.all_nm / data.model.wheel_radius_m * data.model.roller_radius_m
        return (
            f"the friction of the rollers does not show: without any, (27) leaves {curve.all_nm:.2g} N m of noise",
            f"B_r is not above some {small_nm:.1g} N m, and the detector ignores a force of {data.leak_n:g} N",
        )
    if found.explained < EXPLAINED_MIN:
        return (
            f"(27) explains {max(0.0, 100.0 * found.explained):.0f} % of the torques",
            "is the order of the wheels right, the sign of angles and torques, the robot free, the robot file its own?",
        )
    if found.x[0] <= 0.0:
        reason = f"B_r comes out as {found.x[0]:.3g} N m: the rollers would push the robot"
        return reason, "the signs of angles and torques do not belong together"
    if not uncertain:
        return None
    seconds = sum(float(rows.sum()) * s.step_s for s, rows in zip(samples, used, strict=True))
    missing, remedy = _too_little(data, found, rates, seconds, curve)
    by = f"uncertain by {uncertainty_n:.2g} N" if math.isfinite(uncertainty_n) else "undetermined"
    reason = f"at some speed the friction force of a roller would be {by}; the detector ignores {data.leak_n:g} N"
    return f"{missing} ({reason})", remedy


def _too_little(
    data: _Data, found: Fit, rates: NDArray[np.float64], seconds: float, curve: FrictionCurve
) -> tuple[str, str]:
    """Why the friction stays uncertain: from where on the tanh the used roller rates lie."""
    moving = np.abs(rates[np.abs(rates) * data.model.roller_radius_m > data.zone.speed_mps])
    slowest, fastest = np.quantile(moving, (0.05, 0.95))
    rim = 1e3 * data.model.roller_radius_m
    level = found.x[1] * slowest > 1.5  # tanh(1.5) = 0.91: the samples hardly cover its slope
    if level and slowest * data.model.roller_radius_m <= NEAR_REST * data.zone.speed_mps:
        return _does_not_grow(found, curve, rim)
    if not enough_blocks(found):
        needed = BLOCKS_PER_PARAMETER * len(found.x)
        blocks = f"{found.blocks} blocks of {found.block_s:.2g} s, and {len(found.x)} numbers need {needed:g}"
        longer = f"drive longer, about {seconds * needed / max(found.blocks, 1):.0f} s in all"
        return f"too short: {seconds:.3g} s away from rest make {blocks}", longer
    if fastest < ALIKE * slowest:
        return (
            f"one speed only, {rim * slowest:.3g} to {rim * fastest:.3g} mm/s: B_r and alpha show only together",
            "drive in sines, fast and slow",
        )
    if found.x[1] * moving.max() < 1.0:  # tanh(1) = 0.76: the samples do not cover its bend
        return (
            f"too slow: up to {rim * moving.max():.3g} mm/s the friction grows with the speed, and only "
            f"B_r alpha = {found.x[0] * found.x[1]:.3g} N m s/rad shows",
            "drive faster",
        )
    if level:
        return (
            f"never slow: from {rim * slowest:.3g} mm/s on the friction is B_r alone, and alpha does not show",
            "drive slower, or in sines that pass through low speeds",
        )
    return "too noisy", "drive longer"


def _does_not_grow(found: Fit, curve: FrictionCurve, rim: float) -> tuple[str, str]:
    """The message about rollers whose friction is constant, or falls, from the slowest speed above rest on."""
    first, last = float(curve.torque_nm[0]), float(curve.torque_nm[-1])
    over = f"{rim * curve.rate[0]:.3g} to {rim * curve.rate[-1]:.3g} mm/s"
    if last < (1.0 - LEVEL) * first:
        return (
            f"the friction falls with the speed: from {first:.2g} to {last:.2g} N m over {over}",
            "(28) knows no such rollers, and longer or slower drives do not change that",
        )
    return (
        f"the friction does not grow with the speed: {found.x[0]:.3g} N m over {over}, slower ones count as at rest",
        f"there is no alpha to be found: set roller.coulomb_torque to {found.x[0]:.3g} N m and roller.tanh_slope to "
        f"{FLAT / curve.rate[0]:.2g} s/rad or more by hand",
    )


def _fitted(
    log: MotionLog, samples: Samples, used: NDArray[np.bool_], found: Fit, index: int, model: TorqueModel
) -> FittedLog:
    offset = found.offset_nm(index)
    friction = found.x[0] * np.tanh(found.x[1] * samples.roller_rate) @ model.friction_gain.T
    predicted = samples.rigid_nm + friction + offset
    return FittedLog(
        name=log.name,
        time_s=samples.time_s,
        wheel_angle_rad=samples.wheel_angle_rad,
        torque_nm=samples.torque_nm,
        roller_rate=samples.roller_rate,
        model_nm=predicted,
        sound=samples.sound,
        used=used,
        offset_nm=offset,
    )
