"""Thresholds for a wished rate of false alarms: each channel at rest and in motion, then all of them together.

The statistic of the controller is a force over its threshold: with all thresholds ``f`` times as high it is a ``f``-th.
So logs are replayed with thresholds that nothing exceeds, and the peaks of the statistic say how often any other
thresholds would be. First each channel alone (the other one's thresholds are out of reach), apart for rest and motion,
gets the level at which its share of the alarms is as wished. With these thresholds the logs are replayed again, and
again with one factor on all of them, until the upper bound of the rate is the wished one.

How much a wheel's friction may vary from roller to roller is no force: before all of that it gets the least value with
which impacts in motion need no higher thresholds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.errors import GivewayError
from giveway.robot.variables import Value, table
from giveway.tuning.logs import TRACKING, Log
from giveway.tuning.peaks import Peaks, Tail, joined, peaks_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "CHANNELS",
    "MOTION",
    "NAMES",
    "REST",
    "RIPPLE",
    "RIPPLES",
    "Chosen",
    "alarms_in",
    "choose",
    "free_peaks",
    "settings_of",
]

REST, MOTION = "at rest", "in motion"
CHANNELS = ("fast", "slow")
FLOORS: Mapping[tuple[str, str], tuple[str, ...]] = MappingProxyType(
    {
        (channel, when): tuple(f"channels.{channel}_{regime}" for regime in regimes)
        for channel in CHANNELS
        for when, regimes in ((REST, ("rest",)), (MOTION, ("creep", "motion")))
    }
)
NOISE_MULTIPLES = ("channels.noise_multiple", "channels.imu_noise_multiple")
MODEL_MULTIPLE = "channels.model_multiple"
RIPPLE = "channels.ripple"
NAMES = (*(name for names in FLOORS.values() for name in names), *NOISE_MULTIPLES, MODEL_MULTIPLE, RIPPLE)
"""All thresholds: forces, how many standard deviations of noise and model error, and the ripple of rollers."""
RIPPLES = (0.0, 0.16, 0.32, 0.48)  # 0: rollers share the wheel's friction; the last: each has all of it
SAME = 1.02  # a level that is higher by this factor at most is the same
OUT_OF_REACH_N = 1000.0
STEPS_UP = tuple(1.5**step for step in range(8))
LEAST, MOST = 0.5, 12.0  # factors on a threshold of one channel
ROUNDS = 16
LEAST_LOOKED = 0.5  # of the time: with less, alarms hide what comes after them
QUICKLY, SLOWLY, LEAST_STEP = 1.1, 1.03, 0.9  # factors from one round to the next
NEAR = 0.97
_OUTPUTS = ("detection.statistic", "detection.count", "mode")


@dataclass(frozen=True)
class Chosen:
    """Thresholds, and what the logs say of them.

    Attributes:
        thresholds: by name, of the controller.
        factors: of each channel at rest and in motion, on what it had before; None: too few peaks to tell.
        tail: of the statistic with these thresholds; 1 is an alarm.
        alarms: in replays of the logs with these thresholds.
        looked: share of the time in which the controller looked for hits: after an alarm it believes that the robot
            gives way, which a log does not show.
    """

    thresholds: Mapping[str, Value]
    factors: Mapping[tuple[str, str], float | None]
    tail: Tail
    alarms: int
    looked: float

    @property
    def upper_per_hour(self) -> float:
        return self.tail.upper(1.0)


def settings_of(parameters: Mapping[str, Value]) -> dict[str, float]:
    """The thresholds among the controller's parameters; start values where they say nothing."""
    variables = table("controller")
    found = {}
    for name in NAMES:
        value = parameters.get(name, variables[name].start)
        assert value is not None
        found[name] = float(value)
    return found


def choose(logs: Sequence[Log], parameters: Mapping[str, Value], rate_per_hour: float) -> Chosen:
    """Thresholds with which false alarms are rarer than ``rate_per_hour``, as far as ``logs`` can say.

    What the controller learns of friction and noise depends on its thresholds: the last word has a replay with the very
    thresholds that are chosen.

    Raises:
        GivewayError: there are too few peaks in the logs.
    """
    ripple = _least_ripple(logs, parameters, rate_per_hour)
    parameters = {**parameters, RIPPLE: ripple}
    before = settings_of(parameters)
    factors = {key: level if tail.enough else None for key, (tail, level) in
               _of_channels(logs, parameters, before, rate_per_hour).items()}  # fmt: skip
    thresholds, risen = _with_factors(before, factors), False
    found = best = None
    for _ in range(ROUNDS):
        found = _replayed(logs, parameters, thresholds, factors)
        if found.looked < LEAST_LOOKED or not found.tail.enough:
            thresholds, risen = _scaled(thresholds, QUICKLY), True
            continue
        if found.upper_per_hour > rate_per_hour:
            thresholds, risen = _scaled(thresholds, max(found.tail.level(rate_per_hour), SLOWLY)), True
            continue
        best = found
        factor = found.tail.level(rate_per_hour)
        if risen or factor > NEAR:
            break
        thresholds = _scaled(thresholds, max(factor, LEAST_STEP))
    found = best or found
    assert found is not None
    if not found.tail.enough:
        reason = f"{len(found.tail.excesses)} rare peaks of the statistic"
        raise GivewayError("logs", reason, "longer logs: some minutes of starts, stops and drives")
    return found


def _replayed(
    logs: Sequence[Log],
    parameters: Mapping[str, Value],
    thresholds: Mapping[str, float],
    factors: Mapping[tuple[str, str], float | None],
) -> Chosen:
    """What replays with these very thresholds say, alarms included."""
    peaks, alarms = [], 0
    for log in logs:
        free = log.free()
        found = log.replayed({**parameters, **thresholds}, _OUTPUTS)
        first = _first_alarms(found, free)
        alarms += int(np.count_nonzero(first))
        counts = free & ((found["mode"] == TRACKING) | first)
        peaks.append(peaks_of(found["detection.statistic"], counts, first, log.step_s))
    tail = Tail(joined(peaks))
    free_s = sum(float(np.count_nonzero(log.free())) * log.step_s for log in logs)
    known = MappingProxyType(dict(factors))
    return Chosen(MappingProxyType(dict(thresholds)), known, tail, alarms, tail.peaks.duration_s / max(free_s, 1e-9))


def _least_ripple(logs: Sequence[Log], parameters: Mapping[str, Value], rate_per_hour: float) -> float:
    """The least ripple with which the fast channel in motion keeps to its share of the rate as well as with the most.

    Less of it notices softer hits, and raising all thresholds instead would cost more of these. With too few peaks to
    tell it stays as it is.
    """
    before = settings_of(parameters)
    known = sorted({*RIPPLES, before[RIPPLE]})
    tails = [_tail(logs, parameters, {**before, RIPPLE: ripple}, "fast", MOTION) for ripple in known]
    if not all(tail.enough for tail in tails):
        return before[RIPPLE]
    levels = [_level(tail, rate_per_hour) for tail in tails]
    enough = max(1.0, SAME * levels[-1])
    return next(ripple for ripple, level in zip(known, levels, strict=True) if level <= enough)


def _of_channels(
    logs: Sequence[Log], parameters: Mapping[str, Value], before: Mapping[str, float], rate_per_hour: float
) -> dict[tuple[str, str], tuple[Tail, float]]:
    """Of each channel at rest and in motion its tail, and the level that a fourth of the rate asks for."""
    found: dict[tuple[str, str], tuple[Tail, float]] = {}
    for channel, when in FLOORS:
        tail = _tail(logs, parameters, before, channel, when)
        found[channel, when] = (tail, _level(tail, rate_per_hour))
    return found


def _tail(
    logs: Sequence[Log], parameters: Mapping[str, Value], thresholds: Mapping[str, float], channel: str, when: str
) -> Tail:
    """Of one channel alone, at rest or in motion."""
    other = CHANNELS[1 - CHANNELS.index(channel)]
    alone = {name: OUT_OF_REACH_N for regime in (REST, MOTION) for name in FLOORS[other, regime]}
    return Tail(free_peaks(logs, parameters, thresholds, when, alone))


def _level(tail: Tail, rate_per_hour: float) -> float:
    """At which a channel has its share of the alarms; 1 if there are too few peaks to tell."""
    return min(max(tail.level(rate_per_hour / len(FLOORS), 0.5), LEAST), MOST) if tail.enough else 1.0


def _with_factors(before: Mapping[str, float], factors: Mapping[tuple[str, str], float | None]) -> dict[str, float]:
    """What noise and model error are multiplied with is common to rest and motion: the larger factor counts."""
    known = [factor for factor in factors.values() if factor is not None]
    otherwise = max(known, default=1.0)
    each = {key: otherwise if factor is None else factor for key, factor in factors.items()}
    found = {name: each[key] * before[name] for key, names in FLOORS.items() for name in names}
    for name in NOISE_MULTIPLES:
        found[name] = before[name] * max(each["fast", REST], each["fast", MOTION])
    found[MODEL_MULTIPLE] = before[MODEL_MULTIPLE] * max(each["fast", MOTION], each["slow", MOTION])
    found[RIPPLE] = before[RIPPLE]
    return _allowed(found)


def _scaled(thresholds: Mapping[str, float], factor: float) -> dict[str, float]:
    """The forces and multiples; the ripple stays."""
    return _allowed({name: (1.0 if name == RIPPLE else factor) * value for name, value in thresholds.items()})


def _allowed(thresholds: Mapping[str, float]) -> dict[str, float]:
    """Within the ranges of the controller, with as many digits as a robot file states."""
    variables = table("controller")
    return {
        name: float(f"{min(max(value, variables[name].minimum), variables[name].maximum):.4g}")
        for name, value in thresholds.items()
    }


def free_peaks(
    logs: Sequence[Log],
    parameters: Mapping[str, Value],
    thresholds: Mapping[str, float],
    when: str | None = None,
    others: Mapping[str, float] = MappingProxyType({}),
) -> Peaks:
    """Peaks of the statistic over ``thresholds`` where nothing pushes, at rest, in motion, or (None) always.

    The thresholds are raised until there is no alarm, which would change what comes after it.
    """
    return joined([_free_peaks(log, parameters, thresholds, when, others) for log in logs])


def _free_peaks(
    log: Log,
    parameters: Mapping[str, Value],
    thresholds: Mapping[str, float],
    when: str | None,
    others: Mapping[str, float],
) -> Peaks:
    free, moving = log.free(), log.moving()
    counts = free if when is None else free & (moving if when == MOTION else ~moving)
    for factor in STEPS_UP:
        raised = {**parameters, **_scaled(thresholds, factor), **others}
        found = log.replayed(raised, _OUTPUTS)
        if not _first_alarms(found, free).any():
            break
    statistic: NDArray[np.float64] = factor * found["detection.statistic"]
    return peaks_of(statistic, counts & (found["mode"] == TRACKING), np.zeros_like(counts), log.step_s)


def _first_alarms(found: Mapping[str, NDArray[np.generic]], free: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The steps of alarms while nothing pushes, of those in a reaction only the first."""
    tracking = np.concatenate(([False], np.asarray(found["mode"][:-1] == TRACKING)))
    return np.asarray((np.diff(found["detection.count"], prepend=0) > 0) & free & tracking)


def alarms_in(logs: Sequence[Log], parameters: Mapping[str, Value]) -> tuple[int, float]:
    """Alarms where nothing pushes in replays of ``logs``, and the hours in which the controller looked for hits."""
    alarms, looked_s = 0, 0.0
    for log in logs:
        free = log.free()
        found = log.replayed(parameters, _OUTPUTS)
        alarms += int(np.count_nonzero(_first_alarms(found, free)))
        looked_s += float(np.count_nonzero(free & (found["mode"] == TRACKING))) * log.step_s
    return alarms, looked_s / 3600.0
