"""A fit as printed tables, as a small JSON record, and in a robot file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from giveway.base.files import read_json
from giveway.fitting.parameters import FREE, to_unit
from giveway.fitting.quantities import QUANTITIES
from giveway.fitting.search import SEEDS, Fit
from giveway.robot.changes import NewValue, changed_robot

__all__ = ["PARAMETER_HEADER", "TARGET_HEADER", "parameter_rows", "read_record", "record", "robot_text", "target_rows"]

SCHEMA_VERSION = 1
DIGITS = 4  # of a recorded number; runs of another compiler differ in the sixth
TARGET_HEADER = ("quantity", "section", "paper", "aim", "fit", "noise", "residual")
PARAMETER_HEADER = ("parameter", "estimate", "range", "fitted", "deviation", "known to", "decided by")


def target_rows(fit: Fit) -> list[tuple[str, ...]]:
    """One row per quantity; the residual counts tolerances, the noise is the range over its seeds."""
    rows: list[tuple[str, ...]] = []
    for index, quantity in enumerate(QUANTITIES):
        low, high = (f"{value:.4g}" for value in fit.spread[:, index])
        unit = "" if quantity.unit == "1" else f", {quantity.unit}"
        bound = "at most " if quantity.upper else ""
        rows.append(
            (
                f"{quantity.name}{unit}",
                quantity.section,
                quantity.paper,
                f"{bound}{quantity.aim:g} ± {quantity.tolerance:g}",
                f"{fit.quantities[index]:.4g}",
                f"{low} to {high}",
                f"{fit.residuals[index]:+.2f}",
            )
        )
    return rows


def parameter_rows(fit: Fit) -> list[tuple[str, ...]]:
    """One row per parameter: expected value, fitted value, uncertainty, and the quantity that determines it."""
    deviations, decided = to_unit(fit.values), _decided_by(fit)
    return [
        (
            f"{free.name}, {free.unit}",
            f"{free.estimate:g}",
            f"{free.minimum:g} to {free.maximum:g}",
            f"{fit.values[free.name]:g}",
            f"{deviations[index]:+.2f}",
            f"x {free.factor ** fit.uncertainty[index]:.2f}",
            decided[index],
        )
        for index, free in enumerate(FREE)
    ]


def _decided_by(fit: Fit) -> list[str]:
    """For each parameter its strongest influence: a quantity, or its own estimate if that is stronger."""
    names = []
    for column in fit.jacobian.T:
        strongest = int(np.argmax(np.abs(column)))
        names.append(QUANTITIES[strongest].name if abs(column[strongest]) > 1.0 else "its estimate")
    return names


def record(fit: Fit, command: str) -> dict[str, Any]:
    """All of it as plain data, with the command that made it."""
    decided, deviations = _decided_by(fit), to_unit(fit.values)
    return {
        "schema_version": SCHEMA_VERSION,
        "command": command,
        "noise_seeds": f"{SEEDS[0]} to {SEEDS[-1]}",
        "targets": [
            {
                "quantity": quantity.name,
                "section": quantity.section,
                "unit": quantity.unit,
                "paper": quantity.paper,
                "aim": quantity.aim,
                "tolerance": quantity.tolerance,
                "only_above": quantity.upper,
                "fit": _short(fit.quantities[index]),
                "with_noise": [_short(value) for value in fit.spread[:, index]],
                "residual": _short(fit.residuals[index]),
            }
            for index, quantity in enumerate(QUANTITIES)
        ],
        "parameters": [
            {
                "paths": list(free.paths),
                "unit": free.unit,
                "estimate": free.estimate,
                "range": [free.minimum, free.maximum],
                "why": free.why,
                "fitted": fit.values[free.name],
                "deviation": _short(deviations[index]),
                "standard_deviation": _short(fit.uncertainty[index]),
                "decided_by": decided[index],
            }
            for index, free in enumerate(FREE)
        ],
        "singular_values": [_short(value) for value in fit.singular_values],
        "cost": _short(fit.cost),
    }


def _short(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def read_record(path: Path) -> dict[str, Any]:
    """A stored record, as made by `record`."""
    return read_json(path, SCHEMA_VERSION, "give a record that `giveway fit` wrote")


def robot_text(path: Path, fit: Fit, record_name: str) -> str:
    """The robot file ``path`` with the fitted values, their provenance and source; everything else is unchanged."""
    source = f"giveway fit, to the results of Kim, Llado, Sentis, Auton Robot 40:325 (2016); residuals in {record_name}"
    changes = {name: NewValue(float(value), source, "fitted") for name, value in fit.values.items()}
    return changed_robot(path, changes)
