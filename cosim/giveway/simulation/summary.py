"""The result table of several bumpers: as printed rows, and as summary.json for scripts."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from giveway.base.files import write_text
from giveway.base.shapes import Either, Nothing, Number, Rows, Table, Text, Version
from giveway.base.table_document import Shown
from giveway.library.recorded import windows
from giveway.robot.presets import DEFAULT, PAPER, PRESETS
from giveway.simulation.metrics import Metric
from giveway.simulation.result import Result

__all__ = [
    "SUMMARY",
    "cell",
    "false_detection_line",
    "preset_line",
    "push_rows",
    "summary",
    "table_rows",
    "warning_lines",
    "write_summary",
]

SCHEMA_VERSION = 1
_NUMBER = Either("null: it did not happen, or is not known", (Number(), Nothing()))
SUMMARY = Table(
    "the results of giveway demo",
    {
        "schema_version": Version("of this format", SCHEMA_VERSION),
        "rows": Rows(
            "a number of a run each",
            Table(
                "",
                {
                    "bumper": Text("of the run"),
                    "name": Text("what it is"),
                    "value": _NUMBER,
                    "unit": Text("of value and truth; 1: without"),
                    "truth": _NUMBER,
                },
                ("bumper", "name", "value", "unit", "truth"),
            ),
        ),
        "warnings": Rows(
            "deviations from the request",
            Table("", {"bumper": Text(), "code": Text(), "text": Text()}, ("bumper", "code", "text")),
        ),
    },
    ("schema_version", "rows", "warnings"),
)
NOT_IN_ROWS = ("contact point x", "contact point y")  # of a push: the location error suffices, and rows are long


def table_rows(results: Mapping[str, Result]) -> list[tuple[str, ...]]:
    """One row per metric: name with unit, then one cell per bumper: ``value (truth)``."""
    first = next(iter(results.values()))
    rows = []
    for index, metric in enumerate(first.metrics):
        unit = "" if metric.unit == "1" else f", {metric.unit}"
        rows.append((f"{metric.name}{unit}", *(cell(result.metrics[index]) for result in results.values())))
    return rows


def push_rows(result: Result) -> list[tuple[str, ...]]:
    """The header and one row per push: the push, then its estimate, ``value (truth)``; empty without pushes."""
    if not result.pushes:
        return []
    shown = [[one for one in push if one.name not in NOT_IN_ROWS] for push in result.pushes]
    header = tuple(f"{one.name}{'' if one.unit == '1' else f', {one.unit}'}" for one in shown[0])
    rows = [("push", *header)]
    for number, (push, found) in enumerate(zip(result.manifest["scenario"]["pushes"], shown, strict=True), 1):
        words = f"{number}: {push['force_n']:g} N at {push['start_s']:g} s"
        cells = ["not felt" if one.name == "felt after" and one.value is None else cell(one) for one in found]
        rows.append((words, *cells))
    return rows


def false_detection_line(result: Result) -> str:
    """False detections as a sentence; empty if there are none."""
    from giveway.simulation.push_response import responses_of

    if not result.pushes:
        return ""
    false_s = responses_of(result.traces, result.manifest).false_s
    if not false_s:
        return ""
    times = ", ".join(f"{time_s:.3f}" for time_s in false_s)
    return f"False detections, with no push in the {windows().cause_s:g} s before: at {times} s"


def preset_line(results: Mapping[str, Result]) -> str:
    """The controllers' preset as a sentence; empty if it is the default."""
    found = {str(result.manifest["scenario"].get("preset", PAPER)) for result in results.values()}  # older: the paper's
    other = sorted(found - {DEFAULT})
    return "; ".join(f'The controller has the preset "{preset}": {PRESETS[preset]}.' for preset in other)


def warning_lines(results: Mapping[str, Result]) -> list[str]:
    """Warnings, one line each, with the bumper first if there are several results."""
    labels = {
        bumper: f"{'no bumper' if bumper == 'none' else bumper}: " if len(results) > 1 else "" for bumper in results
    }
    return [f"{labels[bumper]}{one.text}" for bumper, result in results.items() for one in result.warnings]


def cell(metric: Metric) -> str:
    """A metric as text: ``value (truth)``, with "-" if it did not happen."""
    text = number(metric.value, metric.decimals)
    if metric.truth is None or metric.truth == 0.0:  # an error's truth is zero by definition: not worth printing
        return Shown(text, metric.value)
    return Shown(f"{text} ({number(metric.truth, metric.decimals)})", {"value": metric.value, "truth": metric.truth})


def number(value: float | None, decimals: int | None) -> str:
    """A number with fixed digits after the point, or in exponent form; "-" if it did not happen."""
    if value is None:
        return "-"
    return f"{value:.1e}" if decimals is None else f"{value:z.{decimals}f}"


def summary(results: Mapping[str, Result]) -> dict[str, Any]:
    """Every number of the table at full precision."""
    return {
        "schema_version": SCHEMA_VERSION,
        "rows": [
            {"bumper": bumper, "name": metric.name, "value": metric.value, "unit": metric.unit, "truth": metric.truth}
            for bumper, result in results.items()
            for metric in result.metrics
        ],
        "warnings": [
            {"bumper": bumper, "code": one.code, "text": one.text}
            for bumper, result in results.items()
            for one in result.warnings
        ],
    }


def write_summary(path: Path, results: Mapping[str, Result]) -> None:
    """Write `summary` as JSON, atomically."""
    write_text(path, json.dumps(summary(results), indent=2, allow_nan=False) + "\n")
