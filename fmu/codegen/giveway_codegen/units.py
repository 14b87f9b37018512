"""Units as FMI wants them: exponents of the SI base units and a factor."""

from __future__ import annotations

import re

__all__ = ["base_units"]

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


def base_units(unit: str) -> dict[str, int]:
    """Exponents of a unit written like ``N.m.s/rad`` or ``kg.m2``; ValueError if it cannot be read.

    Factors are joined by dots; what follows a slash up to the next dot or slash is divided by. Only
    coherent SI units are known, so the factor is always 1.
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
