"""Units in FMI's form: exponents of the SI base units, a factor, and display units."""

from __future__ import annotations

import math
import re

__all__ = ["DISPLAY_UNITS", "base_units", "default_display_unit"]

_BASES = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")  # in the order of the FMI schemas
_SYMBOLS: dict[str, dict[str, int]] = {
    **{base: {base: 1} for base in _BASES},
    "1": {},
    "Hz": {"s": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
}

# unit -> display unit -> (factor, offset): value in the display unit = factor * value in the unit + offset.
DISPLAY_UNITS: dict[str, dict[str, tuple[float, float]]] = {
    "1": {"%": (100.0, 0.0)},
    "J": {"mJ": (1e3, 0.0)},
    "K": {"degC": (1.0, -273.15)},
    "N.m/rad": {"N.m/deg": (math.pi / 180.0, 0.0)},
    "N/m": {"N/mm": (1e-3, 0.0)},
    "kg": {"g": (1e3, 0.0)},
    "m": {"cm": (1e2, 0.0), "mm": (1e3, 0.0)},
    "m/s": {"km/h": (3.6, 0.0), "mm/s": (1e3, 0.0)},
    "rad": {"deg": (180.0 / math.pi, 0.0)},
    "rad/s": {"deg/s": (180.0 / math.pi, 0.0), "rpm": (30.0 / math.pi, 0.0)},
    "rad/s2": {"deg/s2": (180.0 / math.pi, 0.0)},
    "s": {"ms": (1e3, 0.0)},
}

# Default display units. Lengths in metres and in millimetres are both common on a robot.
_DEFAULT_DISPLAY_UNITS = {"rad": "deg", "rad/s": "deg/s", "rad/s2": "deg/s2", "s": "ms"}


def default_display_unit(unit: str | None) -> str | None:
    """The display unit of a variable that names none; None: it is shown in its unit."""
    return None if unit is None else _DEFAULT_DISPLAY_UNITS.get(unit)


def base_units(unit: str) -> dict[str, int]:
    """Exponents of a unit written like ``N.m.s/rad`` or ``kg.m2``; ValueError if it cannot be read.

    Factors are joined by dots; a factor after a slash is a divisor. Only coherent SI units are known, so the numeric
    factor is always 1.
    """
    exponents: dict[str, int] = {}
    for operator, symbol, power in re.findall(r"(^|[./])([A-Za-z]+|1)(-?\d+)?", unit):
        if symbol not in _SYMBOLS:
            raise ValueError(f"unknown unit symbol {symbol!r}")
        sign = -1 if operator == "/" else 1
        for base, exponent in _SYMBOLS[symbol].items():
            exponents[base] = exponents.get(base, 0) + sign * int(power or 1) * exponent
    if not re.fullmatch(r"([A-Za-z]+|1)(-?\d+)?([./]([A-Za-z]+|1)(-?\d+)?)*", unit):
        raise ValueError("not a product of units such as N.m.s/rad")
    return {base: exponents[base] for base in _BASES if exponents.get(base)}
