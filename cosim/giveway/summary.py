"""The result table of several bumpers: as printed rows, and as summary.json for scripts."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from giveway.files import write_text
from giveway.metrics import Metric
from giveway.result import Result

__all__ = ["cell", "summary", "table_rows", "warning_lines", "write_summary"]

SCHEMA_VERSION = 1


def table_rows(results: Mapping[str, Result]) -> list[tuple[str, ...]]:
    """One row per metric: name with unit, then one cell per bumper: ``value (truth)``."""
    first = next(iter(results.values()))
    rows = []
    for index, metric in enumerate(first.metrics):
        unit = "" if metric.unit == "1" else f", {metric.unit}"
        rows.append((f"{metric.name}{unit}", *(cell(result.metrics[index]) for result in results.values())))
    return rows


def warning_lines(results: Mapping[str, Result]) -> list[str]:
    """What happened otherwise than asked, one line each; with the bumper before it where there are several results."""
    labels = {
        bumper: f"{'no bumper' if bumper == 'none' else bumper}: " if len(results) > 1 else "" for bumper in results
    }
    return [f"{labels[bumper]}{one.text}" for bumper, result in results.items() for one in result.warnings]


def cell(metric: Metric) -> str:
    """A metric as text: ``value (truth)``, with "-" for what did not happen."""
    if metric.truth is None or metric.truth == 0.0:  # an error's truth is zero by definition: not worth printing
        return number(metric.value, metric.decimals)
    return f"{number(metric.value, metric.decimals)} ({number(metric.truth, metric.decimals)})"


def number(value: float | None, decimals: int | None) -> str:
    """A number with fixed digits after the point, or in exponent form; "-" for what did not happen."""
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
