"""Units as powers of kilogram, metre and second. Radians are ratios of lengths, so they are 1 here as in the SI."""

from __future__ import annotations

import re
from fractions import Fraction
from functools import cache
from importlib.resources import files

Dimension = tuple[Fraction, Fraction, Fraction]

NONE: Dimension = (Fraction(0), Fraction(0), Fraction(0))
_BASE: dict[str, tuple[int, int, int]] = {
    "1": (0, 0, 0),
    "rad": (0, 0, 0),
    "kg": (1, 0, 0),
    "m": (0, 1, 0),
    "s": (0, 0, 1),
    "Hz": (0, 0, -1),
    "N": (1, 1, -2),
    "J": (1, 2, -2),
    "W": (1, 2, -3),
}
_FACTOR = re.compile(r"([A-Za-z]+|1)(-?\d+)?")
_TYPE = re.compile(r"type (\w+)\s*=\s*(Real\s*\([^;]*?unit\s*=\s*\"([^\"]+)\"|(\w+))", re.DOTALL)


def times(a: Dimension, b: Dimension, power: Fraction | int = 1) -> Dimension:
    """The dimension of a b^power."""
    return (a[0] + power * b[0], a[1] + power * b[1], a[2] + power * b[2])


@cache
def parsed(unit: str) -> Dimension:
    """The dimension of a Modelica unit such as "N.m.s/rad" or "kg.m2"; ValueError if it is not known here."""
    found = NONE
    numerator, _, denominator = unit.partition("/")
    for text, sign in ((numerator, 1), (denominator, -1)):
        for factor in filter(None, text.strip("()").split(".")):
            parts = _FACTOR.fullmatch(factor)
            if parts is None or parts[1] not in _BASE:
                raise ValueError(f"unit {unit!r}: {factor!r} is not known")
            kg, m, s = _BASE[parts[1]]
            found = times(found, (Fraction(kg), Fraction(m), Fraction(s)), sign * int(parts[2] or 1))
    return found


def shown(dimension: Dimension) -> str:
    """For messages: "kg.m.s-2"."""
    named = [
        f"{name}{'' if power == 1 else power}" for name, power in zip(("kg", "m", "s"), dimension, strict=True) if power
    ]
    return ".".join(named) or "1"


@cache
def si_types() -> dict[str, str]:
    """Unit by name of a type of Modelica.Units.SI, of those whose unit is known here."""
    text = (files("rtctools_standard_library") / "modelica" / "Modelica" / "Units.mo").read_text()
    start = text.index("package SI ")
    units: dict[str, str] = {}
    for found in _TYPE.finditer(text, start, text.index("end SI;", start)):
        unit = found[3] or units.get(found[4] or "")
        if unit:
            units[found[1]] = unit
    return units
