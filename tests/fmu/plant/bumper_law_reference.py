"""The laws of bumpers beside spring and magnet, written from their definitions in other forms than the plant's.

A foam's curve by Lagrange's formula, gas by its pressure, springs in series by the travel of each over the force, a
table by searching its cell. Keys are the names of the parameters without `bumper.`
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

__all__ = ["KINDS", "LAWS", "TABLE_WIDTH", "law_force", "stored_energy", "table_parameters"]

KINDS = {"foam": 3, "gas": 4, "damper": 5, "series": 6, "lever": 7, "table": 8}
TABLE_ROWS, TABLE_WIDTH = 12, 6

Numbers = Mapping[str, Any]


def table_parameters(travels: list[float], speeds: list[float], forces: list[list[float]]) -> dict[str, Any]:
    """A table as the parameters that hold it."""
    grid = np.zeros((TABLE_ROWS, TABLE_WIDTH))
    grid[: len(travels), : len(speeds)] = forces
    return {
        "table_rows": len(travels),
        "table_columns": len(speeds),
        "table_travel": [*travels, *[0.0] * (TABLE_ROWS - len(travels))],
        "table_speed": [*speeds, *[0.0] * (TABLE_WIDTH - len(speeds))],
        "table_force": grid.ravel().tolist(),
    }


# Of a small bumper with 50 mm of travel. The table: a rising, then flat, then rising foam with its loss.
LAWS: dict[str, dict[str, Any]] = {
    "foam": {
        "foam_thickness": 0.06, "foam_force_25": 22.0, "foam_force_50": 40.0, "foam_force_75": 105.0,
        "foam_hysteresis": 0.4, "foam_hysteresis_speed": 0.015, "foam_rate_gain": 0.6,
    },
    "gas": {"gas_force": 18.0, "gas_length": 0.09, "gas_exponent": 1.3, "gas_ambient_force": 25.0},
    "damper": {
        "damper_rate": 90.0, "damper_square": 60.0, "damper_rebound": 0.4, "preload": 2.0, "spring_rate": 80.0,
    },
    "series": {
        "spring_rate": 500.0, "preload": 3.0, "second_rate": 1500.0, "second_preload": 6.0, "first_travel": 0.02,
    },
    "lever": {"spring_rate": 400.0, "preload": 3.0, "lever_ratio": 1.6},
    "table": table_parameters(
        [0.0, 0.01, 0.03, 0.055],
        [-0.5, -0.1, 0.0, 0.2, 1.0],
        [[0.0, 0.5, 1.0, 1.0, 3.0], [6.0, 9.0, 14.0, 17.0, 25.0],
         [6.0, 9.0, 16.0, 19.0, 28.0], [30.0, 41.0, 60.0, 68.0, 90.0]],
    ),
}  # fmt: skip


def foam(p: Numbers, c: float, rate: float) -> float:
    if c <= 0.0:
        return 0.0
    x = c / p["foam_thickness"]
    points = [(0.0, 0.0), (0.25, p["foam_force_25"]), (0.5, p["foam_force_50"]), (0.75, p["foam_force_75"])]
    loading = sum(f * math.prod((x - b) / (a - b) for b, _ in points if b != a) for a, f in points)
    kept = 1.0 - 0.5 * p["foam_hysteresis"] * (1.0 - math.tanh(rate / p["foam_hysteresis_speed"]))
    return loading * max(0.0, kept + p["foam_rate_gain"] * rate)


def gas(p: Numbers, c: float, rate: float) -> float:
    area = 1e-3  # any: only forces count
    outside = p["gas_ambient_force"] / area
    volume = area * p["gas_length"]
    now = volume - area * min(c, 0.98 * p["gas_length"])
    pressure = (p["gas_force"] / area + outside) * (volume / now) ** p["gas_exponent"]
    return float(area * (pressure - outside))


def damper(p: Numbers, c: float, rate: float) -> float:
    drag = p["damper_rate"] * rate + p["damper_square"] * rate * abs(rate)
    return float(p["preload"] + p["spring_rate"] * c + (drag if rate > 0.0 else p["damper_rebound"] * drag))


def series(p: Numbers, c: float, rate: float) -> float:
    if c <= 0.0:
        return float(p["preload"] + p["spring_rate"] * c)  # pressed on the end stop: the first alone

    def travel(force: float) -> float:
        first = np.clip((force - p["preload"]) / p["spring_rate"], 0.0, p["first_travel"])
        second = max(0.0, (force - max(p["second_preload"], p["preload"])) / p["second_rate"])
        return float(first + second - c)

    return float(brentq(travel, p["preload"], p["preload"] + 1e7 * c + 1.0, xtol=1e-13, rtol=1e-15))


def lever(p: Numbers, c: float, rate: float) -> float:
    spring = p["preload"] + p["spring_rate"] * (p["lever_ratio"] * c)
    return float(p["lever_ratio"] * spring)  # the plate's work is the spring's


def table(p: Numbers, c: float, rate: float) -> float:
    rows, columns = p["table_rows"], p["table_columns"]
    travels, speeds = np.array(p["table_travel"][:rows]), np.array(p["table_speed"][:columns])
    grid = np.reshape(p["table_force"], (TABLE_ROWS, TABLE_WIDTH))[:rows, :columns]
    forces = [np.interp(c, travels, grid[:, j]) for j in range(columns)]
    if columns == 1:
        return float(forces[0])
    j = int(np.clip(np.searchsorted(speeds, rate) - 1, 0, columns - 2))
    slope = (forces[j + 1] - forces[j]) / (speeds[j + 1] - speeds[j])
    return float(max(0.0, forces[j] + slope * (rate - speeds[j])))


FORCES = {"foam": foam, "gas": gas, "damper": damper, "series": series, "lever": lever, "table": table}


def law_force(name: str, p: Numbers, c: float, rate: float) -> float:
    """What extends the bumper, without what is common to all of them."""
    return FORCES[name](p, c, rate)


def stored_energy(name: str, p: Numbers, c: float) -> float:
    """The work of compressing it as slowly as can be, from full extension."""
    corners = [0.0, c]
    if name == "table":
        corners += [t for t in p["table_travel"][: p["table_rows"]] if 0.0 < t < c]
    if name == "series":
        start = max(0.0, p["second_preload"] - p["preload"]) / p["spring_rate"]
        end = start + (p["first_travel"] - start) * (1.0 + p["spring_rate"] / p["second_rate"])
        corners += [at for at in (start, end) if 0.0 < at < c]
    if name == "gas" and c > 0.98 * p["gas_length"]:
        corners.append(0.98 * p["gas_length"])
    corners = sorted(corners) if c >= 0.0 else [0.0, c]
    return sum(
        quad(lambda at: law_force(name, p, at, 0.0), a, b, epsabs=1e-13, epsrel=1e-12)[0] for a, b in pairwise(corners)
    )
