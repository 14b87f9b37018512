"""The crowd's table: one row per class of hits, with intervals; and the worst cases by number."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from giveway.base.files import replace_files
from giveway.crowd.judged import Contact, Judged
from giveway.crowd.parts import Record
from giveway.crowd.population import TABLES, WITH_IMU
from giveway.crowd.statistics import Estimate, count_interval, mean, percentile, rate_interval

__all__ = [
    "HEADER",
    "ROWS",
    "Found",
    "Row",
    "cells",
    "find",
    "markdown",
    "read",
    "short_cells",
    "short_header",
    "tables",
    "worst",
    "write",
]

WORST = 10
MODE_REACTING = 2
SAME_S = 2e-3  # a contact that begins this close to the second hit is the second hit

Run = Mapping[str, Any]


@dataclass(frozen=True)
class Row:
    """A class of hits: the runs that belong to it, and which of their contacts."""

    name: str
    runs: Callable[[Run], bool]
    contacts: Callable[[Run, Contact], bool]


def _drawn(run: Run, contact: Contact) -> bool:
    """A contact of a robot that follows its plan."""
    return contact.mode < MODE_REACTING


def _second(run: Run, contact: Contact) -> bool:
    return run["second_s"] is not None and abs(contact.start_s - float(run["second_s"])) < SAME_S


def _class(situation: str, kind: str) -> tuple[Callable[[Run], bool], Callable[[Run, Contact], bool]]:
    return (lambda run: bool(run["situation"] == situation and run["kind"] == kind)), _drawn


def _stated(situation: str, bumper: str = "") -> tuple[Callable[[Run], bool], Callable[[Run, Contact], bool]]:
    def runs(run: Run) -> bool:
        mine = run["situation"] == situation and run["kind"] == "free" and run["stated"]
        return bool(mine and bumper in ("", run["bumper"]))

    return runs, _second if situation == "reacting" else _drawn


def is_hit(run: Run) -> bool:
    """Not a slow push or a moment."""
    return run["kind"] not in ("slow push", "moment")


ROWS: tuple[Row, ...] = (
    Row("all hits", is_hit, lambda run, contact: True),
    Row("at rest, free", *_class("rest", "free")),
    Row("at rest, pulled", *_class("rest", "pulled")),
    Row("in motion, free", *_class("motion", "free")),
    Row("in motion, pulled", *_class("motion", "pulled")),
    Row("in motion, clamped", *_class("motion", "clamped")),
    Row("starting", *_class("starting", "free")),
    Row("stopping", *_class("stopping", "free")),
    Row("while reacting", is_hit, lambda run, contact: contact.mode >= MODE_REACTING),
    Row("second hit, 0.5 m/s", *_stated("reacting")),
    Row("at rest, 0.5 m/s", *_stated("rest")),
    *(Row(f"at rest, 0.5 m/s, {bumper}", *_stated("rest", bumper)) for bumper in ("none", "spring", "magnetic")),
    Row("in motion, 0.5 m/s", *_stated("motion")),
    *(Row(f"in motion, 0.5 m/s, {bumper}", *_stated("motion", bumper)) for bumper in ("none", "spring", "magnetic")),
    Row("slow push at rest", *_class("rest", "slow push")),
    Row("slow push in motion", *_class("motion", "slow push")),
    Row("moment at rest", *_class("rest", "moment")),
    Row("moment in motion", *_class("motion", "moment")),
)

HEADER = (
    "hits",
    "runs",
    "hits of 1 N s",
    "missed",
    "false detections",
    "runs with one",
    "towards",
    "delay median, ms",
    "delay 95 %, ms",
    "direction 95 %, deg",
    "direction 30 ms later, deg",
    "place mean, mm",
    "place 95 %, mm",
    "place 30 ms later mean, mm",
    "place 30 ms later 95 %, mm",
    "runs with a late lift",
    "so if blocked, too",
    "runs with a lift by the reaction",
)


@dataclass(frozen=True)
class Found:
    """A row's figures. Percentiles are over all of its hits, a missed one is infinite; None: there is none.

    Attributes:
        runs, hits, missed, false, runs_with_false, towards: counts.
        delay_ms: of hits, median and 95th percentile.
        direction_deg, later_direction_deg: 95th percentile of the error.
        place_mm, later_place_mm: mean and 95th percentile of the error; the mean over those noticed.
        delay_longest_ms: of all of them; infinite: one was missed.
        late_lifts, late_blocked_lifts, caused_lifts: runs with wheels that lift late, that do so with the reaction
            blocked, and that lift by the reaction while a contact lasts; None: this plant cannot tip.
    """

    name: str
    runs: int
    hits: int
    missed: int
    false: int
    runs_with_false: int
    towards: int
    delay_median_ms: Estimate | None
    delay_p95_ms: Estimate | None
    direction_p95_deg: Estimate | None
    later_direction_p95_deg: Estimate | None
    place_mean_mm: Estimate | None
    place_p95_mm: Estimate | None
    later_place_mean_mm: Estimate | None
    later_place_p95_mm: Estimate | None
    delay_longest_ms: float | None
    late_lifts: int | None
    late_blocked_lifts: int | None
    caused_lifts: int | None

    def plain(self) -> dict[str, Any]:
        """For JSON: infinite ends as text."""
        found: dict[str, Any] = {}
        for name, value in vars(self).items():
            if isinstance(value, tuple):
                found[name] = [_plain(end) for end in value]
            else:
                found[name] = _plain(value) if isinstance(value, float) else value
        found["missed_interval"] = list(count_interval(self.missed, self.hits)) if self.hits else None
        found["runs_with_false_interval"] = list(count_interval(self.runs_with_false, self.runs)) if self.runs else None
        return found


def _plain(value: float) -> float | str:
    return value if math.isfinite(value) else "infinite"


Read = Sequence[tuple[Record, Judged]]
"""Runs that ended well, and what they were judged."""


def read(records: Sequence[Record]) -> Read:
    """``records`` without the runs that failed."""
    return [(record, Judged.of(record["judged"])) for record in records if record["judged"]]


def find(row: Row, runs: Read) -> Found:
    """The figures of ``row`` over ``runs``."""
    mine = [(record, judged) for record, judged in runs if row.runs(record)]
    hits = [
        contact
        for record, judged in mine
        for contact in judged.contacts
        if contact.verdict in ("noticed", "missed") and row.contacts(record, contact)
    ]

    def values(name: str, missed: bool) -> list[float]:
        noticed = [getattr(hit, name) for hit in hits if hit.verdict == "noticed"]
        lost = sum(hit.verdict == "missed" for hit in hits)
        return [value for value in noticed if value is not None] + ([math.inf] * lost if missed else [])

    def errors(name: str) -> tuple[Estimate | None, Estimate | None]:
        found = values(name, False)
        return mean(found), percentile(values(name, True), 0.95) if found else None

    delays = values("delay_ms", True)
    return Found(
        row.name,
        len(mine),
        len(hits),
        sum(hit.verdict == "missed" for hit in hits),
        sum(len(judged.false_s) for _, judged in mine),
        sum(bool(judged.false_s) for _, judged in mine),
        sum(len(judged.towards_s) for _, judged in mine),
        percentile(delays, 0.5),
        percentile(delays, 0.95),
        errors("direction_deg")[1],
        errors("later_direction_deg")[1],
        *errors("place_mm"),
        *errors("later_place_mm"),
        max(delays, default=None),
        *_lifts([record["lifts"] for record, _ in mine if record.get("lifts")]),
    )


def _lifts(of_runs: Sequence[Mapping[str, float]]) -> tuple[int | None, ...]:
    """Runs with late lifts, with those if blocked, and with lifts by the reaction."""
    if not of_runs:
        return None, None, None
    return tuple(sum(one[name] > 0 for one in of_runs) for name in ("late_s", "late_blocked_s", "caused"))


@dataclass(frozen=True)
class Target:
    """What a row's figure is to be at most.

    Attributes:
        row, what: names.
        figure: value and interval; None: there is none.
        most: of the value.
    """

    row: str
    what: str
    figure: Callable[[Found], Estimate | None]
    most: float


def _value(name: str) -> Callable[[Found], Estimate | None]:
    """The figure of this name with its interval."""

    def figure(found: Found) -> Estimate | None:
        value: Estimate | None = getattr(found, name)
        return value

    return figure


def _number(name: str, of: str) -> Callable[[Found], Estimate | None]:
    """The count of this name; its interval: per as many as there were."""

    def figure(found: Found) -> Estimate | None:
        count, every = getattr(found, name), getattr(found, of)
        if count is None or not every:
            return None
        low, high = count_interval(min(count, every), every)
        return float(count), low * every, high * every

    return figure


def _false(found: Found) -> Estimate | None:
    return rate_interval(found.false, 1e-4 * found.runs) if found.runs else None


def _longest(found: Found) -> Estimate | None:
    longest = found.delay_longest_ms
    return None if longest is None else (longest, longest, math.inf)


def _delays(row: str, median_ms: float, p95_ms: float) -> tuple[Target, Target]:
    return (
        Target(row, "delay median, ms", _value("delay_median_ms"), median_ms),
        Target(row, "delay 95 %, ms", _value("delay_p95_ms"), p95_ms),
    )


MISSED = _number("missed", "hits")


def _targets(rest_ms: tuple[float, float], motion_ms: tuple[float, float]) -> tuple[Target, ...]:
    bumpers = ("none", "spring", "magnetic")
    return (
        Target("all hits", "missed", MISSED, 0.0),
        Target("all hits", "false detections per 10,000 runs", _false, 10.0),
        Target("all hits", "towards", _number("towards", "runs"), 0.0),
        *(target for bumper in bumpers for target in _delays(f"at rest, 0.5 m/s, {bumper}", *rest_ms)),
        *_delays("in motion, 0.5 m/s", *motion_ms),
        *(target for bumper in bumpers for target in _delays(f"in motion, 0.5 m/s, {bumper}", *motion_ms)),
        Target("second hit, 0.5 m/s", "missed", MISSED, 0.0),
        *_delays("second hit, 0.5 m/s", *motion_ms),
        Target("while reacting", "missed", MISSED, 0.0),
        Target("all hits", "direction 95 %, deg", _value("direction_p95_deg"), 15.0),
        Target("all hits", "direction 30 ms later, deg", _value("later_direction_p95_deg"), 5.0),
        Target("all hits", "place 30 ms later mean, mm", _value("later_place_mean_mm"), 20.0),
        Target("all hits", "place 30 ms later 95 %, mm", _value("later_place_p95_mm"), 50.0),
        Target("slow push in motion", "missed", MISSED, 0.0),
        Target("slow push in motion", "delay longest, ms", _longest, 500.0),
        Target("slow push in motion", "towards", _number("towards", "runs"), 0.0),
        Target("slow push at rest", "missed", MISSED, 0.0),
        Target("slow push at rest", "towards", _number("towards", "runs"), 0.0),
        Target("moment at rest", "missed", MISSED, 0.0),
        Target("moment in motion", "missed", MISSED, 0.0),
    )


LIFTS = (
    Target("all hits", "runs with a late lift", _number("late_lifts", "runs"), 0.0),
    Target("all hits", "runs with a lift by the reaction", _number("caused_lifts", "runs"), 0.0),
)
TARGETS: Mapping[str, tuple[Target, ...]] = {
    "planar": _targets((10.0, 12.0), (20.0, 25.0)),
    "tipping": (*_targets((10.0, 12.0), (20.0, 25.0)), *LIFTS),
    f"planar{WITH_IMU}": _targets((5.0, 6.0), (8.0, 10.0)),
    f"tipping{WITH_IMU}": (*_targets((5.0, 6.0), (8.0, 10.0)), *LIFTS),
}
"""By table; the others have figures alone."""


def target_rows(group: str, rows: Sequence[Found]) -> list[tuple[str, ...]]:
    """Row, figure, target, what was found, its interval, and whether that meets it; none for other plants."""
    named = {found.name: found for found in rows}
    lines: list[tuple[str, ...]] = []
    for target in TARGETS.get(group, ()):
        found = named.get(target.row)
        estimate = target.figure(found) if found is not None and found.hits else None
        said, ends, met = "no hits", "-", "-"
        if estimate is not None:
            value, low, high = estimate
            said, ends = f"{value:.4g}", f"{low:.3g} to {high:.3g}"
            met = "met" if value <= target.most else "missed"
        lines.append((target.row, target.what, f"{target.most:g}", said, ends, met))
    return lines


TARGET_HEADER = ("row", "figure", "at most", "found", "95 % interval", "")


def cells(found: Found) -> tuple[str, ...]:
    """The row as text, intervals in brackets."""
    lifted = found.late_lifts, found.late_blocked_lifts, found.caused_lifts
    return (
        found.name,
        str(found.runs),
        str(found.hits),
        _share(found.missed, found.hits),
        str(found.false),
        _share(found.runs_with_false, found.runs),
        str(found.towards),
        _estimate(found.delay_median_ms, 1),
        _estimate(found.delay_p95_ms, 1),
        _estimate(found.direction_p95_deg, 0),
        _estimate(found.later_direction_p95_deg, 0),
        _estimate(found.place_mean_mm, 0),
        _estimate(found.place_p95_mm, 0),
        _estimate(found.later_place_mean_mm, 0),
        _estimate(found.later_place_p95_mm, 0),
        *("-" if lifts is None else _share(lifts, found.runs) for lifts in lifted),
    )


SHORT = (0, 2, 3, 4, 6, 7, 8, 9, 10, 13, 14)
"""Columns for the terminal, without intervals."""


def short_header() -> tuple[str, ...]:
    return tuple(HEADER[column] for column in SHORT)


def short_cells(found: Found) -> tuple[str, ...]:
    """The row for the terminal."""
    full = cells(found)
    return tuple(full[column].partition(" (")[0] if column else full[column] for column in SHORT)


def _share(count: int, of: int) -> str:
    if not of:
        return "-"
    low, high = count_interval(count, of)
    return f"{count} ({100.0 * low:.3g} to {100.0 * high:.3g} %)"


def _estimate(value: Estimate | None, decimals: int) -> str:
    if value is None:
        return "-"
    at, low, high = (f"{one:.{decimals}f}" if math.isfinite(one) else "inf" for one in value)
    return f"{at} ({low} to {high})"


def tables(records: Sequence[Record]) -> Iterator[tuple[str, list[Found]]]:
    """Per table of `TABLES` that has runs: its rows."""
    for group, mine in _by_table(records):
        judged = read(mine)
        if judged:
            yield group, [found for row in ROWS if (found := find(row, judged)).runs]


def _by_table(records: Sequence[Record]) -> Iterator[tuple[str, list[Record]]]:
    for group in TABLES:
        mine = [record for record in records if record["group"] == group]
        if mine:
            yield group, mine


def worst(records: Sequence[Record]) -> dict[str, list[list[Any]]]:
    """The worst cases of one table: what is wrong, then number and value of each."""
    cases: dict[str, list[tuple[float, int]]] = {
        name: []
        for name in (
            "missed",
            "false detections",
            "towards",
            "delay at 0.5 m/s, ms",
            "direction 30 ms later, deg",
            "place 30 ms later, mm",
            "late lift, s",
            "wheels lifted by the reaction",
        )
    }
    for record, judged in read(records):
        number = int(record["number"])
        lost = [contact.impulse_ns for contact in judged.contacts if contact.verdict == "missed"]
        if lost:
            cases["missed"].append((max(lost), number))
        cases["false detections"] += [(len(judged.false_s), number)] if judged.false_s else []
        cases["towards"] += [(len(judged.towards_s), number)] if judged.towards_s else []
        for contact in judged.contacts:
            if contact.delay_ms is not None and is_hit(record) and record["stated"] and _drawn(record, contact):
                cases["delay at 0.5 m/s, ms"].append((contact.delay_ms, number))
            if contact.later_direction_deg is not None and is_hit(record):
                cases["direction 30 ms later, deg"].append((contact.later_direction_deg, number))
            if contact.later_place_mm is not None and is_hit(record):
                cases["place 30 ms later, mm"].append((contact.later_place_mm, number))
        lifted = record.get("lifts")
        if lifted:
            cases["late lift, s"] += [(lifted["late_s"], number)] if lifted["late_s"] else []
            cases["wheels lifted by the reaction"] += [(lifted["caused"], number)] if lifted["caused"] else []
    found: dict[str, list[list[Any]]] = {}
    for name, values in cases.items():
        values.sort(key=lambda one: (-one[0], one[1]))
        found[name] = [[number, round(value, 3)] for value, number in values[:WORST]]
    return found


def markdown(title: str, notes: Sequence[str], records: Sequence[Record]) -> str:
    """The whole table as text."""
    lines = [f"# {title}", "", *notes, ""]
    for group, rows in tables(records):
        lines += [f"## {group}", "", f"| {' | '.join(HEADER)} |", "|" + "---|" * len(HEADER)]
        lines += [f"| {' | '.join(cells(found))} |" for found in rows] + [""]
        targets = target_rows(group, rows)
        if targets:
            lines += [f"| {' | '.join(TARGET_HEADER)} |", "|" + "---|" * len(TARGET_HEADER)]
            lines += [f"| {' | '.join(line)} |" for line in targets] + [""]
    for group, mine in _by_table(records):
        lines += [f"## {group}: worst cases", ""]
        for name, values in worst(mine).items():
            listed = ", ".join(f"{number} ({value:g})" for number, value in values)
            lines += [f"- {name}: {listed or 'none'}"]
        lines += [""]
    return "\n".join(lines)


def write(folder: Path, title: str, notes: Sequence[str], records: Sequence[Record]) -> list[Path]:
    """Write table.md and table.json into ``folder``, both or none."""
    found = list(tables(records))
    document = {
        "schema_version": 1,
        "title": title,
        "notes": list(notes),
        "tables": {group: [row.plain() for row in rows] for group, rows in found},
        "targets": {group: target_rows(group, rows) for group, rows in found},
        "worst": {group: worst(mine) for group, mine in _by_table(records)},
        "ended early": [[one["number"], one["message"]] for one in records if one["judged"] and one["status"] != "ok"],
        "not judged": [[record["number"], record["message"]] for record in records if not record["judged"]],
    }
    paths = [folder / "table.md", folder / "table.json"]
    with replace_files(*paths) as (text, data):
        text.write_text(markdown(title, notes, records), encoding="utf-8")
        data.write_text(json.dumps(document, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    return paths
