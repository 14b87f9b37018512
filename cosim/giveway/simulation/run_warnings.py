"""Deviations of a run from the request: one line each, from the stated values and the metrics.

`BOUNDS` has the thresholds of the warnings. Requests that are certainly impossible are refused before a run
(`plan_limits`, `approach`, the variable tables); warnings cover the rest.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from giveway.scenario.plan import Circle, Straight
from giveway.scenario.stated_contact import StatedContact
from giveway.simulation.metrics import FIRST_PEAK

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.scenario.scenario import Scenario
    from giveway.simulation.metrics import Metric

    Numbers = NDArray[np.float64]
    Masks = NDArray[np.bool_]

__all__ = [
    "BOUNDS",
    "CODES",
    "CUT_OFF",
    "MEANINGS",
    "METRICS",
    "SEPARATOR",
    "RunWarning",
    "Stated",
    "codes_of",
    "masks",
    "plan_speed",
    "warnings_of",
]

BOUNDS: Mapping[str, float] = MappingProxyType(
    {
        "speed": 0.02,  # of the stated one; the last millisecond before a contact on the rope changes it by 1 %
        "place_mm": 10.0,  # a moving robot lags its plan by up to 5 mm
        "time_s": 0.02,  # the servo's lag is 16 ms
        "plan_mm": 10.0,  # a plan within the limits is followed to 0.01 mm
        "plan_deg": 1.0,
        "quiet_s": 0.1,  # touches less than this apart are one contact: a plate bounces
        "saturated": 1.0 - 1e-6,  # share of a limit that single precision carries
    }
)


SEPARATOR = "; "  # of codes in a table
CUT_OFF = "contact cut off"  # what a study judges, too
PEAK = "peak force of the run"


@dataclass(frozen=True)
class RunWarning:
    """One deviation.

    Attributes:
        code: which one, for tables and scripts; one of `CODES`.
        text: a sentence with the numbers.
    """

    code: str
    text: str


@dataclass(frozen=True)
class Stated:
    """The requests of some runs, one number per run, shape (n,); NaN: not stated.

    Attributes:
        contact_speed_mps: of the nose relative to the base.
        point_x_m, point_y_m: of the contact, base frame.
        time_s: of the contact.
        plan_speed_mps: of the plan, once it has started; in runs with a contact.
        end_s: of the run.
        contact: whether one is stated at all, shape (n,).
        region: a body region is to be judged, shape (n,).
    """

    contact_speed_mps: Numbers
    point_x_m: Numbers
    point_y_m: Numbers
    time_s: Numbers
    plan_speed_mps: Numbers
    end_s: Numbers
    contact: Masks
    region: Masks

    @classmethod
    def nothing(cls, count: int) -> Stated:
        """The requests of ``count`` runs without any statement; to be filled by `put`."""
        return cls(*(np.full(count, math.nan) for _ in range(6)), *(np.zeros(count, dtype=np.bool_) for _ in range(2)))

    def put(self, where: NDArray[np.int64], other: Stated) -> None:
        """Copy the requests of ``other`` to the runs ``where``."""
        for one in fields(self):
            getattr(self, one.name)[where] = getattr(other, one.name)

    @classmethod
    def of(cls, scenarios: Sequence[Scenario]) -> Stated:
        """What scenarios state."""
        contacts = [scenario.contact or StatedContact() for scenario in scenarios]
        points = [contact.point_m or (None, None) for contact in contacts]
        planned = [None if scenario.contact is None else plan_speed(scenario) for scenario in scenarios]
        return cls(
            _known([contact.speed_mps for contact in contacts]),
            _known([x for x, _ in points]),
            _known([y for _, y in points]),
            _known([contact.time_s for contact in contacts]),
            _known(planned),
            _known([scenario.duration_s for scenario in scenarios]),
            np.array([scenario.contact is not None for scenario in scenarios], dtype=np.bool_),
            np.array([scenario.judged is not None for scenario in scenarios], dtype=np.bool_),
        )


def _known(values: Sequence[float | None]) -> Numbers:
    """NaN for None."""
    return np.array(values, dtype=np.float64)


def plan_speed(scenario: Scenario) -> float | None:
    """The speed of the scenario's plan, m/s; None: no plan, or standing."""
    plan = scenario.plan
    return abs(plan.speed_mps) or None if isinstance(plan, Straight | Circle) else None


_Metrics = Mapping[str, "Numbers"]


@dataclass(frozen=True)
class _Check:
    """One kind of warning: what it means, whether each run has it, and its sentence for one run (index 0)."""

    code: str
    meaning: str
    metrics: tuple[str, ...]
    found: Callable[[Stated, _Metrics], Masks]
    text: Callable[[Stated, _Metrics], str]


def _at(values: Numbers) -> float:
    return float(values[0])


def _off(found: Numbers, stated: Numbers, share: float) -> Masks:
    return np.asarray(np.abs(found - stated) > share * stated)


def _away_mm(stated: Stated, found: _Metrics) -> Numbers:
    return np.hypot(
        found["first contact x"] - 1e3 * stated.point_x_m, found["first contact y"] - 1e3 * stated.point_y_m
    )


def _lasts(stated: Stated, found: _Metrics) -> Masks:
    """The run ended before a contact was over."""
    quiet_s = stated.end_s - found["contact time"] - found["longest contact"]
    return np.asarray((found["contact at end"] > 0.0) | (quiet_s < BOUNDS["quiet_s"]))


_CHECKS: Sequence[_Check] = (
    _Check(
        "no contact",
        "slider and robot did not touch",
        ("contact time",),
        lambda stated, found: stated.contact & np.isnan(found["contact time"]),
        lambda _stated, _found: "slider and robot did not touch",
    ),
    _Check(
        "contact speed",
        f"the contact was at another speed than asked for, by more than {100.0 * BOUNDS['speed']:g} %",
        ("contact speed",),
        lambda stated, found: _off(found["contact speed"], stated.contact_speed_mps, BOUNDS["speed"]),
        lambda stated, found: (
            f"the contact was at {_at(found['contact speed']):.3g} m/s, "
            f"asked for {_at(stated.contact_speed_mps):.3g} m/s"
        ),
    ),
    _Check(
        "contact place",
        f"the contact was elsewhere on the robot than asked for, by more than {BOUNDS['place_mm']:g} mm",
        ("first contact x", "first contact y"),
        lambda stated, found: _away_mm(stated, found) > BOUNDS["place_mm"],
        lambda stated, found: (
            f"the contact was at [{1e-3 * _at(found['first contact x']):.3f}, "
            f"{1e-3 * _at(found['first contact y']):.3f}] m on the robot, "
            f"{_at(_away_mm(stated, found)):.0f} mm from where it was asked for"
        ),
    ),
    _Check(
        "contact time",
        f"the contact was at another time than asked for, by more than {1e3 * BOUNDS['time_s']:g} ms",
        ("contact time",),
        lambda stated, found: np.abs(found["contact time"] - stated.time_s) > BOUNDS["time_s"],
        lambda stated, found: (
            f"the contact was at {_at(found['contact time']):.3f} s, asked for {_at(stated.time_s):.3f} s"
        ),
    ),
    _Check(
        "robot speed",
        "at the contact the robot was not as fast as its plan asks for",
        ("robot speed at contact",),
        lambda stated, found: _off(found["robot speed at contact"], stated.plan_speed_mps, BOUNDS["speed"]),
        lambda stated, found: (
            f"the robot moved at {_at(found['robot speed at contact']):.3g} m/s at the contact, its plan asks for "
            f"{_at(stated.plan_speed_mps):.3g} m/s: hit before or after, or not yet so fast"
        ),
    ),
    _Check(
        "plan not followed",
        "the plan goes beyond the limits of controller.reference",
        ("distance from the plan", "angle from the plan"),
        lambda _stated, found: (
            (found["distance from the plan"] > BOUNDS["plan_mm"]) | (found["angle from the plan"] > BOUNDS["plan_deg"])
        ),
        lambda _stated, found: (
            f"the plan goes beyond the limits of controller.reference: the controller fell behind it by up to "
            f"{_at(found['distance from the plan']):.0f} mm and {_at(found['angle from the plan']):.1f} deg"
        ),
    ),
    _Check(
        "torque sensor saturated",
        "a torque sensor was at its end",
        ("sensed torque share",),
        lambda _stated, found: found["sensed torque share"] >= BOUNDS["saturated"],
        lambda _stated, _found: "a torque sensor was saturated: the robot felt less than there was",
    ),
    _Check(
        "motor saturated",
        "a motor gave its largest torque",
        ("motor torque share",),
        lambda _stated, found: found["motor torque share"] >= BOUNDS["saturated"],
        lambda _stated, _found: (
            "a motor gave its largest torque (drivetrain.torque_limit): the robot could not do as told"
        ),
    ),
    _Check(
        "sensor fault",
        "the controller took its sensors for faulty and stood still",
        ("time in sensor fault",),
        lambda _stated, found: found["time in sensor fault"] > 0.0,
        lambda _stated, found: (
            f"the controller took its sensors for faulty for {_at(found['time in sensor fault']):.3g} s and stood still"
        ),
    ),
    _Check(
        "bumper bottomed",
        "the bumper was pressed into its stop",
        ("bottoming margin",),
        lambda _stated, found: found["bottoming margin"] <= 0.0,
        lambda _stated, found: (
            f"the bumper was pressed into its stop, {-_at(found['bottoming margin']):.1f} mm beyond its travel"
        ),
    ),
    _Check(
        "lasting force unknown",
        "the run was over before the lasting force was known",
        ("contact time", "lasting force"),
        lambda stated, found: stated.region & ~np.isnan(found["contact time"]) & np.isnan(found["lasting force"]),
        lambda _stated, _found: (
            "the run was over before the lasting force was known: it counts from 0.5 s after the contact"
        ),
    ),
    _Check(
        CUT_OFF,
        f"the run ended during a contact, or less than {BOUNDS['quiet_s']:g} s after the last touch: the largest force "
        "and compression may have been still to come",
        ("contact at end", "contact time", "longest contact", "lasting force", PEAK),
        # The lasting force is that of 0.5 s after a touch and later: below the peak, the peak was before, and is over.
        lambda stated, found: _lasts(stated, found) & ~(found["lasting force"] < found[PEAK]),
        lambda _stated, _found: (
            f"the run ended during the contact, or less than {BOUNDS['quiet_s']:g} s after the last touch: the largest "
            "force and compression may have been still to come, which a longer duration shows"
        ),
    ),
    _Check(
        "second hit harder",
        "a later contact was harder than the first",
        (FIRST_PEAK, PEAK),
        lambda _stated, found: found[PEAK] > found[FIRST_PEAK],
        lambda _stated, found: (
            f"a later contact was harder than the first: {_at(found[PEAK]):.0f} N after {_at(found[FIRST_PEAK]):.0f} N"
        ),
    ),
)

CODES = tuple(check.code for check in _CHECKS)
"""All codes, in the order of lines and tables."""

MEANINGS = MappingProxyType({check.code: check.meaning for check in _CHECKS})
"""The meaning of each code, without the numbers of a run."""

METRICS = tuple(dict.fromkeys(name for check in _CHECKS for name in check.metrics))
"""The metrics on which the warnings are based."""


def masks(stated: Stated, metrics: _Metrics) -> dict[str, Masks]:
    """The runs with each warning, by code, shape (n,); ``metrics`` holds `METRICS`, NaN for events that did not
    happen."""
    with np.errstate(invalid="ignore"):
        return {check.code: check.found(stated, metrics) for check in _CHECKS}


def codes_of(stated: Stated, metrics: _Metrics) -> list[str]:
    """The codes of each run's warnings, as text: "bumper bottomed; second hit harder"; empty: none."""
    which = masks(stated, metrics)
    found = [""] * len(stated.time_s)
    for code, mask in which.items():
        for run in np.flatnonzero(mask).tolist():
            found[run] += f"{SEPARATOR}{code}" if found[run] else code
    return found


def warnings_of(scenario: Scenario, metrics: Sequence[Metric]) -> tuple[RunWarning, ...]:
    """The warnings of a completed run of ``scenario``, in the order of `CODES`."""
    values = {metric.name: metric.value for metric in metrics}
    found = {name: _known([values[name]]) for name in METRICS}
    stated = Stated.of([scenario])
    which = masks(stated, found)
    return tuple(RunWarning(check.code, check.text(stated, found)) for check in _CHECKS if which[check.code][0])
