"""Units, signs and order of the wheels of a log, judged by what the robot could have done; nothing is mended."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from giveway.identification.torque_model import TorqueModel
from giveway.replay.inputs import Steps, jump_radps, value_of, wheels_at_azimuths
from giveway.replay.quantities import PLAN, QUANTITIES
from giveway.robot.variables import Value
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Findings", "LogChecks", "Match", "best_match"]

POINT_S = 0.01  # samples are averaged over this time
POINTS = 60_000  # 10 minutes
POINTS_MIN = 100
POINTS_JUDGED = 5000
SMOOTH = 5  # points on either side for speed and acceleration
BETTER = 0.5  # of the squared misfit: another order or sign has to fit so much better to be named
MOVING_MPS = 0.02
TURNING_RADPS = 0.05
DRIVEN_M = 0.05
ALIKE = (0.8, 1.25)  # factors within which two speeds count as the same
STEADY = 0.3  # spread of the middle half of such factors, relative
FAST = 5.0  # times the limit of the robot's speed: no wheel turns so fast
OUTER = 0.99  # of the time: one jump is no speed
SATURATED_SHARE = 0.01
_DEG = math.degrees(1.0)


@dataclass
class Findings:
    """In words: what looks wrong, what is in order, what the log does not tell."""

    wrong: list[str] = field(default_factory=list)
    fine: list[str] = field(default_factory=list)
    open: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Match:
    """Measured wheel ``order[i]`` times ``signs[i]`` is expected wheel i; ``share`` of the misfit as it is."""

    order: tuple[int, ...]
    signs: tuple[int, ...]
    share: float

    @property
    def as_it_is(self) -> bool:
        return self.order == tuple(range(WHEELS)) and all(sign > 0 for sign in self.signs)


def best_match(measured: NDArray[np.float64], expected: NDArray[np.float64], friction: NDArray[np.float64]) -> Match:
    """The order and signs in which ``measured`` fits ``expected`` best, all of shape (n, wheels).

    ``friction``: directions in which each wheel may have any friction, at least 0.
    """
    centred = measured - measured.mean(axis=0)
    wanted = expected - expected.mean(axis=0)
    drag = friction - friction.mean(axis=0)
    cost = np.zeros((WHEELS, WHEELS, 2))
    for i, j, k in itertools.product(range(WHEELS), range(WHEELS), range(2)):
        rest = (1 - 2 * k) * centred[:, j] - wanted[:, i]
        power = _product(drag[:, i], drag[:, i])
        held = max(0.0, _product(rest, drag[:, i]) / power) if power > 0.0 else 0.0
        rest = rest - held * drag[:, i]
        cost[i, j, k] = _product(rest, rest)
    identity = tuple(range(WHEELS))
    turned = cost.argmin(axis=2)
    for i in identity:  # a wheel that hardly moves tells nothing of its sign
        if cost[i, i, 1] > BETTER * cost[i, i, 0]:
            turned[i, i] = 0
    least = np.take_along_axis(cost, turned[:, :, None], axis=2)[:, :, 0]

    def total(order: tuple[int, ...]) -> float:
        return float(sum(least[i, j] for i, j in enumerate(order)))

    order = min(itertools.permutations(identity), key=total)
    if total(order) > BETTER * total(identity):
        order = identity
    now = float(sum(cost[i, i, 0] for i in identity))
    signs = tuple(1 - 2 * int(turned[i, j]) for i, j in enumerate(order))
    return Match(order, signs, total(order) / now if now > 0.0 else 1.0)


def _product(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    """Scalar product, without the threads of BLAS, which would wait for each other."""
    return float(np.einsum("i,i->", a, b))


class LogChecks:
    """Collects points of a log, a bounded number, and judges them.

    Args:
        parameters: of the controller.
        step_s: between samples.
        names: of the wheels' angles and torques, as the log has them: "wheel_angle", "torque".
    """

    def __init__(self, parameters: Mapping[str, Value], step_s: float, names: tuple[str, str]) -> None:
        self._parameters, self._step_s = parameters, step_s
        self._angle, self._torque = names
        # looked up once: live, rows come one by one
        self._limit_nm = value_of(parameters, "sensor_check.torque_limit")
        self._tare_s = value_of(parameters, "estimator.tare_ticks") * value_of(parameters, "controller.period")
        self._at_rest_rad = 3.0 * 2.0 * math.pi / value_of(parameters, "estimator.encoder_counts")
        self._width = max(1, round(POINT_S / step_s))
        self._parts: list[NDArray[np.float64]] = []
        self._points = 0
        self._largest_torque = 0.0
        self._least, self._most = np.full(WHEELS, np.inf), np.full(WHEELS, -np.inf)
        self._saturated = self._samples = 0
        self._fastest = 0.0
        self._tare_moved = False
        self._farthest = 0.0
        self._begin: NDArray[np.float64] | None = None

    def add(self, steps: Steps) -> None:
        """The next samples."""
        good = steps.present & np.isfinite(steps.torque_nm).all(axis=1)
        self._note_size(steps, good)
        count = len(good) // self._width * self._width
        if self._points >= POINTS or not count:
            return
        plan = [steps.inputs.get(str(QUANTITIES[name].controller)) for name in PLAN[2:6]]
        columns = [*steps.angle_rad.T, *steps.torque_nm.T, steps.yaw_rate, *plan]
        values = np.stack([np.full(len(good), np.nan) if one is None else one for one in columns], axis=1)
        values[~good] = np.nan
        points = values[:count].reshape(-1, self._width, values.shape[1]).mean(axis=1)
        self._parts.append(points)
        self._points += len(points)

    def _note_size(self, steps: Steps, good: NDArray[np.bool_]) -> None:
        torque = np.abs(steps.torque_nm[good])
        if torque.size:
            self._largest_torque = max(self._largest_torque, float(torque.max()))
            self._least = np.minimum(self._least, steps.torque_nm[good].min(axis=0))
            self._most = np.maximum(self._most, steps.torque_nm[good].max(axis=0))
            self._saturated += int(np.count_nonzero((torque >= self._limit_nm).any(axis=1)))
            self._samples += len(torque)
        if good.any():
            angle = steps.angle_rad[good]
            self._begin = angle[0].copy() if self._begin is None else self._begin
            self._farthest = max(self._farthest, float(np.abs(angle - self._begin).max()))
        change = np.abs(np.diff(steps.angle_rad, axis=0))[good[1:] & good[:-1]]
        if change.size:
            self._fastest = max(self._fastest, float(change.max()) / self._step_s)
        until = min(len(good), round(self._tare_s / self._step_s) - steps.first)
        if until > 1:
            moved = np.abs(steps.angle_rad[:until] - steps.angle_rad[0]).max()
            self._tare_moved |= bool(moved > self._at_rest_rad)

    @property
    def moved(self) -> bool:
        """Whether the robot drove, and did not just give way to what pushed it."""
        return self._farthest * value_of(self._parameters, "geometry.wheel_radius") > DRIVEN_M

    @property
    def _dead(self) -> list[str]:
        """Torques that never change, though the robot drove or another one changes."""
        still = self._most <= self._least
        if not self._samples or (still.all() and not self.moved):
            return []
        return [f"{self._torque}_{wheel}" for wheel in np.flatnonzero(still)]

    def judge(self) -> Findings:
        """What the log shows."""
        found = Findings()
        found.wrong += [f"{name} never changes: all three sensors are needed" for name in self._dead]
        self._judge_size(found)
        if self._tare_moved:
            found.wrong.append("the wheels turn while the controller takes its tare, at the begin of the log")
        points = np.concatenate(self._parts) if self._parts else np.zeros((0, 2 * WHEELS + 5))
        if len(points) < POINTS_MIN:
            found.open.append(f"signs and order of the wheels: the log has less than {POINTS_MIN * POINT_S:g} s")
            return found
        angle = points[:, :WHEELS]
        some = slice(None, None, -(-len(points) // POINTS_JUDGED))
        rate, acceleration = _derivatives(angle, self._width * self._step_s)
        self._judge_speed(found, rate)
        rate, acceleration = rate[some], acceleration[some]
        inside = points[SMOOTH:-SMOOTH][some]
        self._judge_torque(found, inside[:, WHEELS : 2 * WHEELS], rate, acceleration)
        self._judge_yaw(found, inside[:, 2 * WHEELS], rate)
        self._judge_plan(found, inside[:, 2 * WHEELS + 1 :], rate)
        return found

    def _judge_size(self, found: Findings) -> None:
        limit = self._limit_nm
        if self._samples and self._saturated > SATURATED_SHARE * self._samples:
            found.wrong.append(
                f"{100.0 * self._saturated / self._samples:.3g} % of the samples have a torque at or above "
                f"{limit:g} N m, where the robot's sensors saturate (up to {self._largest_torque:.3g} N m): "
                f"is the unit of {self._torque} right?"
            )
        else:
            found.fine.append(f"torques of up to {self._largest_torque:.3g} N m; the sensors saturate at {limit:g} N m")
        counts = value_of(self._parameters, "estimator.encoder_counts")
        jump = jump_radps(self._parameters)
        speed = self._fastest * value_of(self._parameters, "geometry.wheel_radius")
        if self._fastest > jump:
            found.wrong.append(
                f"wheels turn with up to {self._fastest:.3g} rad/s ({speed:.3g} m/s at the rim), faster than "
                f"{jump:.3g} rad/s, which the controller takes for a jump: is the unit of {self._angle} right, and "
                f"have the encoders {counts:g} counts per turn?"
            )
        else:
            found.fine.append(f"wheels turn with up to {self._fastest:.3g} rad/s ({speed:.3g} m/s at the rim)")

    def _judge_speed(self, found: Findings, rate: NDArray[np.float64]) -> None:
        """Speeds that the robot does not have, so that another unit is likely."""
        known = np.abs(rate).max(axis=1) * value_of(self._parameters, "geometry.wheel_radius")
        known = known[np.isfinite(known)]
        limit_mps = value_of(self._parameters, "reference.speed_limit")
        if known.size and (speed_mps := float(np.quantile(known, OUTER))) > FAST * limit_mps:
            found.wrong.append(
                f"the wheels' rims move with {speed_mps:.3g} m/s, {speed_mps / limit_mps:.3g} times the robot's "
                f"reference.speed_limit of {limit_mps:g} m/s: is the unit of {self._angle} right?"
            )

    def _model(self) -> TorqueModel:
        def value(name: str) -> float:
            return value_of(self._parameters, name)

        return TorqueModel(
            wheel_radius_m=value("geometry.wheel_radius"),
            wheel_distance_m=value("geometry.wheel_distance"),
            roller_radius_m=value("geometry.roller_radius"),
            mass_kg=value("base.mass"),
            yaw_inertia_kgm2=value("base.yaw_inertia"),
            wheel_inertia_kgm2=value("base.wheel_inertia"),
            roller_inertia_kgm2=value("base.roller_inertia"),
        )

    def _judge_torque(
        self, found: Findings, torque: NDArray[np.float64], rate: NDArray[np.float64], change: NDArray[np.float64]
    ) -> None:
        """Torques against those that the motion takes."""
        model, slots = self._model(), wheels_at_azimuths(self._parameters)
        roller_rate, expected = model.motion(rate[:, slots], change[:, slots])
        slope = value_of(self._parameters, "friction.tanh_slope")
        rolled = value_of(self._parameters, "friction.coulomb_torque") * np.tanh(slope * roller_rate)
        expected = expected + rolled @ model.friction_gain.T
        good = np.isfinite(torque).all(axis=1) & np.isfinite(expected).all(axis=1)
        moving = good & (np.abs(rate).max(axis=1) * model.wheel_radius_m > MOVING_MPS)
        torque, expected, rate = torque[:, slots][moving], expected[moving], rate[:, slots][moving]
        noise = value_of(self._parameters, "estimator.torque_noise")
        if len(torque) < POINTS_MIN or expected.std(axis=0).max() < 3.0 * noise:
            found.open.append(f"signs and order of {self._torque}: the robot moves too little to tell")
            return
        if self._dead:
            return
        match = best_match(torque, expected, np.sign(rate))
        if match.as_it_is:
            found.fine.append(f"signs and order of {self._torque} fit the motion")
            return
        found.wrong.append(
            f"{self._torque} fits the motion better otherwise: {_words(match, self._torque, slots)} "
            f"({100.0 * math.sqrt(match.share):.0f} % of the misfit)"
        )

    def _judge_yaw(self, found: Findings, yaw: NDArray[np.float64], rate: NDArray[np.float64]) -> None:
        """The gyro against the wheels."""
        good = np.isfinite(yaw) & np.isfinite(rate).all(axis=1)
        if not good.any():
            found.open.append("wheels against the yaw rate: the log has none")
            return
        inverse = np.linalg.inv(self._model().wheel_jacobian)
        slots = wheels_at_azimuths(self._parameters)
        parts = rate[:, slots][good] * inverse[2]
        gyro = yaw[good] - np.median(yaw[good])
        wheels = parts.sum(axis=1)
        if min(wheels.std(), gyro.std()) < TURNING_RADPS:
            found.open.append("wheels against the yaw rate: the robot turns too little to tell")
            return
        ratio = float(gyro @ wheels) / float(wheels @ wheels)

        def likeness(signs: tuple[int, ...]) -> float:  # whatever the unit is
            turned = parts @ np.array(signs)
            return float(gyro @ turned) / math.sqrt(float(turned @ turned) or math.inf)

        best = max(itertools.product((1, -1), repeat=WHEELS), key=likeness)
        if all(sign > 0 for sign in best) and ALIKE[0] <= ratio <= ALIKE[1]:
            found.fine.append(f"the yaw rate is {ratio:.3g} times that of the wheels")
        elif all(sign < 0 for sign in best):
            found.wrong.append("the yaw rate is opposite to that of the wheels: the sign of yaw_rate or of all angles")
        elif any(sign < 0 for sign in best):
            names = [f"{self._angle}_{slots[i]}" for i, sign in enumerate(best) if sign < 0]
            found.wrong.append(f"the yaw rate fits the wheels with the sign of {' and '.join(names)} turned")
        else:
            hint = ": is it in deg/s?" if 0.7 < ratio / _DEG < 1.4 or 0.7 < ratio * _DEG < 1.4 else ""
            found.wrong.append(f"the yaw rate is {ratio:.3g} times that of the wheels{hint}")

    def _judge_plan(self, found: Findings, plan: NDArray[np.float64], rate: NDArray[np.float64]) -> None:
        """The planned motion against the wheels."""
        good = np.isfinite(plan).all(axis=1) & np.isfinite(rate).all(axis=1)
        if not good.any():
            found.open.append("order of the wheels as a whole: the log has no plan to compare with")
            return
        theta, vx, vy, omega = plan[good].T
        azimuth = value_of(self._parameters, "geometry.azimuth")
        cos, sin = np.cos(theta + azimuth), np.sin(theta + azimuth)
        twist = np.stack([cos * vx + sin * vy, cos * vy - sin * vx, omega], axis=1)
        slots = wheels_at_azimuths(self._parameters)
        expected = twist @ self._model().wheel_jacobian.T
        measured = rate[:, slots][good]
        if expected.std(axis=0).max() * self._model().wheel_radius_m < MOVING_MPS:
            found.open.append("order of the wheels as a whole: the plan moves too little to tell")
            return
        match = best_match(measured, expected, np.zeros_like(expected))
        if match.as_it_is:
            found.fine.append(f"signs and order of {self._angle} fit the plan")
            self._judge_scale(found, measured, expected, slots)
        else:
            words = _words(match, self._angle, slots)
            found.wrong.append(f"{self._angle} fits the plan better otherwise: {words}")

    def _judge_scale(
        self, found: Findings, measured: NDArray[np.float64], expected: NDArray[np.float64], slots: list[int]
    ) -> None:
        """How far the wheels turn, as a multiple of the plan, unless most of the time something holds or moves them."""
        moving = np.abs(expected) * self._model().wheel_radius_m > MOVING_MPS
        factors: dict[str, float] = {}
        for i, rows in enumerate(moving.T):
            if np.count_nonzero(rows) >= POINTS_MIN // 2:
                low, factor, high = np.quantile(measured[rows, i] / expected[rows, i], (0.25, 0.5, 0.75))
                if high - low > STEADY * abs(factor):
                    found.open.append("how far the wheels turn against the plan: they do not follow it steadily")
                    return
                factors[f"{self._angle}_{slots[i]}"] = float(factor)
        if not factors:
            return
        least, most = min(factors.values()), max(factors.values())
        if least > 0.0 and most <= ALIKE[1] * least:  # all of them alike
            factors = {"the wheels": float(np.median([*factors.values()]))}
        for name, factor in sorted(factors.items()):
            words = f"{name} turn{'' if name == 'the wheels' else 's'} {factor:.2f} times as far as the plan"
            if ALIKE[0] <= factor <= ALIKE[1]:
                found.fine.append(words)
            else:
                found.wrong.append(f"{words}: encoder counts, wheel radius or unit?")


def _derivatives(values: NDArray[np.float64], step_s: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """First and second derivative by central differences over `SMOOTH` steps; that many fewer rows on either side."""
    after, at, before = values[2 * SMOOTH :], values[SMOOTH:-SMOOTH], values[: -2 * SMOOTH]
    span_s = SMOOTH * step_s
    return (after - before) / (2.0 * span_s), (after - 2.0 * at + before) / span_s**2


def _words(match: Match, name: str, slots: list[int]) -> str:
    """``torque_1 = -torque_2, torque_2 = torque_1``: what differs from the log's own."""
    pairs = [(slots[i], slots[j], sign) for i, (j, sign) in enumerate(zip(match.order, match.signs, strict=True))]
    changed = [(i, j, sign) for i, j, sign in sorted(pairs) if i != j or sign < 0]
    return ", ".join(f"{name}_{i} = {'-' if sign < 0 else ''}{name}_{j}" for i, j, sign in changed)
