"""Curves from the stored runs: for each situation, detector and threshold the rate of false alarms and the delays."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from giveway.crowd.curves.alarms import LOCKED
from giveway.crowd.curves.candidates import CANDIDATES, Candidate
from giveway.crowd.curves.situations import SITUATIONS
from giveway.crowd.parts import Record
from giveway.crowd.statistics import Estimate, percentile, rate_interval

__all__ = ["LEVELS", "TABLE_HEADER", "Curve", "Point", "at_level", "curves", "table_rows", "usable", "write_csv"]

LEVELS = (100.0, 10.0, 1.0, 0.0)
"""False alarms per hour at which the table compares; 0: none was found."""


@dataclass(frozen=True)
class Point:
    """A detector with one threshold.

    Attributes:
        threshold: in the detector's unit.
        alarms, hours: without contact.
        per_hour: their rate with its exact Poisson interval; of none: 0 and the upper 95 % bound.
        hits, missed, locked: of contacts; locked ones are no hits, as an alarm came just before.
        median_ms, p95_ms: delays, a missed hit counts as infinite; None: there are no hits.
    """

    threshold: float
    alarms: int
    hours: float
    per_hour: Estimate
    hits: int
    missed: int
    locked: int
    median_ms: Estimate | None
    p95_ms: Estimate | None


@dataclass(frozen=True)
class Curve:
    """One detector in one situation; points in the order of its thresholds."""

    situation: str
    candidate: Candidate
    points: tuple[Point, ...]


def curves(hits: Sequence[Record], quiet: Sequence[Record], stated: bool = False) -> Iterator[Curve]:
    """All curves; ``stated``: only of free hits with the speed for which delays are promised."""
    good = [record for record in quiet if not record["message"]]
    for place, situation in enumerate(SITUATIONS):
        mine = [one for one in hits if one["start_s"] is not None and one["where"] == place and one["stated"] >= stated]
        for candidate in CANDIDATES:
            name = candidate.name
            points = []
            for number, threshold in enumerate(candidate.thresholds):
                count = sum(record["alarms"][name][number][place] for record in good)
                hours = sum(record["seconds"][name][number][place] for record in good) / 3600.0
                delays = [record["delays"][name][number] for record in mine]
                judged = [math.inf if delay is None else delay for delay in delays if delay != LOCKED]
                points.append(
                    Point(
                        threshold,
                        count,
                        hours,
                        rate_interval(count, hours) if hours else (math.nan, 0.0, math.inf),
                        len(judged),
                        sum(math.isinf(delay) for delay in judged),
                        len(delays) - len(judged),
                        percentile(judged, 0.5),
                        percentile(judged, 0.95),
                    )
                )
            yield Curve(situation, candidate, tuple(points))


def usable(curve: Curve) -> list[Point]:
    """The points that no larger threshold makes worse: below them the detector hardly ever comes back from an alarm.

    Of those without any alarm only the smallest threshold.
    """
    found: list[Point] = []
    highest = -1.0
    for point in reversed(curve.points):
        rate = point.per_hour[0]
        if point.hits and rate > highest:
            found.append(point)
            highest = rate
        elif point.hits and rate == highest == 0.0:
            found[-1] = point
    return found[::-1]


def at_level(curve: Curve, per_hour: float) -> Point | None:
    """The smallest threshold from which on there are at most so many alarms; None: not even the largest."""
    found = None
    for point in reversed(curve.points):
        if not (point.hits and point.per_hour[0] <= per_hour):
            break
        found = point
    return found


TABLE_HEADER = ("detector", *(f"{level:g} per hour" if level else "no alarm" for level in LEVELS), "below, per hour")


def table_rows(found: Sequence[Curve]) -> list[tuple[str, ...]]:
    """Median / 95 % of the delay in ms at each of `LEVELS`; last the bound of the rate where no alarm was."""
    rows = []
    for curve in found:
        at = [at_level(curve, level) for level in LEVELS]
        quiet = at[-1]
        bound = f"{quiet.per_hour[2]:.2g}" if quiet is not None else "-"
        rows.append((curve.candidate.name, *(_cell(point) for point in at), bound))
    return rows


def _cell(point: Point | None) -> str:
    if point is None or point.median_ms is None or point.p95_ms is None:
        return "-"
    return f"{_number(point.median_ms[0])} / {_number(point.p95_ms[0])} at {point.threshold:.3g}"


def _number(value: float) -> str:
    return f"{value:.1f}" if math.isfinite(value) else "inf"


COLUMNS = (
    *("situation", "hits of", "detector", "threshold", "unit", "false alarms", "hours"),
    *("per hour", "per hour low", "per hour high", "hits", "missed", "locked"),
    *(f"{what}{end}, ms" for what in ("median", "p95") for end in ("", " low", " high")),
)


def write_csv(path: Path, found: dict[str, Sequence[Curve]]) -> None:
    """Every point of every curve; ``found``: by which hits."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        for of, mine in found.items():
            for curve in mine:
                for point in curve.points:
                    ends = [*(point.median_ms or [""] * 3), *(point.p95_ms or [""] * 3)]
                    rate = [point.threshold, curve.candidate.unit, point.alarms, point.hours, *point.per_hour]
                    counts = [point.hits, point.missed, point.locked]
                    shown = [f"{one:.6g}" if isinstance(one, float) else one for one in (*rate, *counts, *ends)]
                    writer.writerow([curve.situation, of, curve.candidate.name, *shown])
