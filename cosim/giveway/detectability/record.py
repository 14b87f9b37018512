"""What was found as text, as JSON and as CSV."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from giveway.base import native
from giveway.base.files import write_text
from giveway.detectability.alarms import Alarms
from giveway.detectability.causes import GEAR_CAUSE, THRESHOLD_CAUSE
from giveway.detectability.found import FACTORS, SHARE, Detectability, Level, anywhere, at_each_probe
from giveway.detectability.probes import KINDS, MOTION, PUSH, REST, SITUATIONS
from giveway.detectability.search import DECADES, largest

__all__ = ["HEADER", "cause_rows", "document", "polar", "remarks", "rows", "title", "write_csv", "write_json"]

SCHEMA_VERSION = 1
HEADER = ("", "typical", "95 %, best side", "95 %, worst side", "95 %, wherever", "alarmed by itself")
LEAST_CHANGE = 0.1  # of the smallest push, by which something counts as its limit


def title(found: Detectability) -> str:
    """One line on what was asked."""
    subject, asked = found.subject, found.asked
    sensing = "motor current" if subject.motor_current else "torque sensors"
    file = (native.robot() if subject.path is None else subject.path).name
    return (
        f"Smallest push that {subject.name} notices ({file}, {sensing}): {asked.robots} robots that differ from it, "
        f"{asked.directions} directions, {asked.speed_mps:g} m/s in motion"
    )


def number(value: float, unit: str) -> str:
    """Three digits; what is beyond the search in words."""
    return "none" if math.isinf(value) or math.isnan(value) else f"{value:.3g} {unit.replace('.', ' ')}"


def rows(level: Level) -> list[tuple[str, ...]]:
    """A row for each situation and kind."""
    found: list[tuple[str, ...]] = []
    for situation in SITUATIONS:
        for kind, unit in KINDS.items():
            one = level.smallest[situation, kind]
            share, half = at_each_probe(one), at_each_probe(one, 0.5)
            value, low, high = anywhere(one)
            ends = " to ".join(number(end, unit).removesuffix(f" {unit.replace('.', ' ')}") for end in (low, high))
            found.append((
                f"{kind} {situation}", number(float(np.median(half)), unit), number(float(share.min()), unit),
                number(float(share.max()), unit), f"{number(value, unit)} [{ends}]",
                f"{100.0 * float(one.alarmed.mean()):.0f} %",
            ))  # fmt: skip
    return found


def alarms_text(alarms: Alarms) -> str:
    """The rate with its interval."""
    rate, low, high = alarms.per_hour
    return (
        f"{rate:.3g} per hour [{low:.3g} to {high:.3g}]: {alarms.alarms} of {alarms.drives} drives, "
        f"{alarms.hours:.3g} h until the first alarm of each"
    )


def cause_rows(found: Detectability) -> list[tuple[str, ...]]:
    """What each limit costs: the smallest push of 95 % of robots and directions without it."""

    def cells(values: Any) -> tuple[str, ...]:
        return tuple(number(values[situation], "N") for situation in SITUATIONS)

    return [("as it is", *cells(found.base)), *((cause.words, *cells(cause.values)) for cause in found.causes.values())]


def limiting(found: Detectability, situation: str) -> str | None:
    """The cause without which the smallest push is smallest, the thresholds left out; None: none of them matters."""
    base = found.base[situation]
    least = {name: one.values[situation] for name, one in found.causes.items() if name != THRESHOLD_CAUSE}
    name = min(least, key=lambda one: least[one])
    gains = (math.isinf(base) and not math.isinf(least[name])) or least[name] < (1.0 - LEAST_CHANGE) * base
    return name if gains else None


def remarks(found: Detectability) -> list[str]:
    """What the numbers mean, in sentences."""
    asked, told = found.asked, found.told
    said = [f"False alarms of the same robots, thresholds as they are: {alarms_text(found.stated.alarms)}."]
    if found.chosen is None:
        wish = f"{asked.rate_per_hour:g} per hour"
        said.append(
            f"No thresholds up to {FACTORS[-1]:g} times as high keep to {wish}."
            if asked.can_show
            else f"{asked.hours:g} h cannot show {wish}: that takes {asked.hours_needed:.3g} h without an alarm."
        )
    elif found.chosen.factor == 1.0:
        said.append(f"That keeps to {asked.rate_per_hour:g} per hour, with 95 % confidence.")
    else:
        said.append(
            f"For {asked.rate_per_hour:g} per hour all thresholds have to be {told.factor:g} times as high: "
            f"{alarms_text(told.alarms)}."
        )
    for situation in SITUATIONS:
        name = limiting(found, situation)
        half = found.causes[THRESHOLD_CAUSE].values[situation]
        follow = (
            "it follows the thresholds" if half < 0.75 * found.base[situation] else "it hardly follows the thresholds"
        )
        what = "nothing but the thresholds" if name is None else name
        if math.isinf(half):
            follow = "with half the thresholds none is noticed, or all robots are alarmed by themselves"
        said.append(f"The smallest push {situation} is limited by {what}; {follow}.")
    if found.gearless is not None:
        said.append(
            "The controller knows the gears' friction from the file while they turn, and not what they hold at rest. "
            "Without any friction in them the same robots would have false alarms of "
            f"{alarms_text(found.gearless)} (thresholds as they are). With a tenth of it they would "
            + ", ".join(
                f"{situation} notice {number(found.causes[GEAR_CAUSE].values[situation], 'N')} instead of "
                f"{number(found.base[situation], 'N')}"
                for situation in (REST, MOTION)
            )
            + "."
        )
    unit = {kind: number(largest(found.subject, kind), KINDS[kind]) for kind in KINDS}
    said.append(
        f"Searched from {' and '.join(unit.values())} downwards, a {10**DECADES:.0f}th at most; "
        '"none": not even these, or the robot is alarmed by itself.'
    )
    return said


def document(found: Detectability) -> dict[str, Any]:
    """Everything as plain data; what is infinite or not a number is null."""
    return {
        "schema_version": SCHEMA_VERSION,
        "title": title(found),
        "robot": found.subject.name,
        "sensing": "motor current" if found.subject.motor_current else "torque sensor",
        "set": {model: dict(values) for model, values in found.subject.stated.items()},
        "asked": found.asked.__dict__,
        "share_of_robots": SHARE,
        "levels": [_level(found, level) for level in _levels(found)],
        "limits": {
            "as it is": _finite(found.base),
            **{name: _finite(one.values) for name, one in found.causes.items()},
        },
        "limited_by": {situation: limiting(found, situation) for situation in SITUATIONS},
        "alarms_without_gear_friction": None if found.gearless is None else _alarms(found.gearless),
        "remarks": remarks(found),
    }


def _levels(found: Detectability) -> list[Level]:
    return [found.stated] if found.chosen in (None, found.stated) else [found.stated, found.told]


def _finite(values: Any) -> dict[str, float | None]:
    return {name: value if math.isfinite(value) else None for name, value in values.items()}


def _alarms(alarms: Alarms) -> dict[str, Any]:
    rate, low, high = alarms.per_hour
    return {"per_hour": rate, "interval": [low, high], "hours": alarms.hours, "alarms": alarms.alarms}


def _level(found: Detectability, level: Level) -> dict[str, Any]:
    searches = {}
    for (situation, kind), one in level.smallest.items():
        value, low, high = anywhere(one)
        searches[f"{kind} {situation}"] = {
            "unit": KINDS[kind],
            "wherever": _finite({"value": value, "low": low, "high": high}),
            "alarmed_by_itself": float(one.alarmed.mean()),
            "probes": [
                {
                    "from_deg": round(probe.from_deg, 6),
                    "place": probe.place,
                    **_finite({"half_of_robots": float(half), "share_of_robots": float(share)}),
                }
                for probe, half, share in zip(found.probes, at_each_probe(one, 0.5), at_each_probe(one), strict=True)
            ],
        }
    return {"threshold_factor": level.factor, "alarms": _alarms(level.alarms), "smallest": searches}


def write_json(path: Path, found: Detectability) -> None:
    write_text(path, json.dumps(document(found), allow_nan=False, indent=1) + "\n")


def write_csv(path: Path, found: Detectability) -> None:
    """A row for each robot, situation, kind and probe; empty: not noticed, or alarmed by itself."""
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(
            ("threshold_factor", "situation", "kind", "unit", "robot", "from_deg", "place", "smallest", "alarmed")
        )
        for level in _levels(found):
            for (situation, kind), one in level.smallest.items():
                for robot, values in enumerate(one.values.tolist()):
                    for probe, value in zip(found.probes, values, strict=True):
                        shown = f"{value:.6g}" if math.isfinite(value) else ""
                        alarmed = int(one.alarmed[robot])
                        table.writerow((level.factor, situation, kind, KINDS[kind], robot, f"{probe.from_deg:g}",
                                        probe.place, shown, alarmed))  # fmt: skip


def polar(found: Detectability, level: Level, situation: str, kind: str = PUSH) -> dict[str, list[tuple[float, float]]]:
    """By place: side in deg and the push that `SHARE` of the robots notice."""
    share = at_each_probe(level.smallest[situation, kind])
    curves: dict[str, list[tuple[float, float]]] = {}
    for probe, value in zip(found.probes, share.tolist(), strict=True):
        curves.setdefault(probe.place, []).append((probe.from_deg, value))
    return {place: sorted(points) for place, points in curves.items()}
