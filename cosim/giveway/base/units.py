"""Units as users write them: "N/mm", "lb", "km/h", "%"; whether they suit a quantity, and their factor."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from giveway.base.errors import GivewayError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["WrittenUnit", "check_unit", "factor"]

DIGITS = 15  # digits of a displayed value: one less than a conversion in both directions may change

# Per unit: size in SI, and exponents of m, kg, s, rad, degC, A.
_Dimension = tuple[int, int, int, int, int, int]
_ATOMS: Mapping[str, tuple[float, _Dimension]] = {
    "1": (1.0, (0, 0, 0, 0, 0, 0)),
    "%": (1e-2, (0, 0, 0, 0, 0, 0)),
    "um": (1e-6, (1, 0, 0, 0, 0, 0)),
    "mm": (1e-3, (1, 0, 0, 0, 0, 0)),
    "cm": (1e-2, (1, 0, 0, 0, 0, 0)),
    "m": (1.0, (1, 0, 0, 0, 0, 0)),
    "in": (0.0254, (1, 0, 0, 0, 0, 0)),
    "ft": (0.3048, (1, 0, 0, 0, 0, 0)),
    "km": (1e3, (1, 0, 0, 0, 0, 0)),
    "g": (1e-3, (0, 1, 0, 0, 0, 0)),
    "kg": (1.0, (0, 1, 0, 0, 0, 0)),
    "lb": (0.45359237, (0, 1, 0, 0, 0, 0)),
    "ns": (1e-9, (0, 0, 1, 0, 0, 0)),
    "us": (1e-6, (0, 0, 1, 0, 0, 0)),
    "ms": (1e-3, (0, 0, 1, 0, 0, 0)),
    "s": (1.0, (0, 0, 1, 0, 0, 0)),
    "h": (3600.0, (0, 0, 1, 0, 0, 0)),
    "rad": (1.0, (0, 0, 0, 1, 0, 0)),
    "mrad": (1e-3, (0, 0, 0, 1, 0, 0)),
    "deg": (0.017453292519943295, (0, 0, 0, 1, 0, 0)),
    "Hz": (1.0, (0, 0, -1, 0, 0, 0)),
    "kHz": (1e3, (0, 0, -1, 0, 0, 0)),
    "mN": (1e-3, (1, 1, -2, 0, 0, 0)),
    "N": (1.0, (1, 1, -2, 0, 0, 0)),
    "kN": (1e3, (1, 1, -2, 0, 0, 0)),
    "lbf": (0.45359237 * 9.80665, (1, 1, -2, 0, 0, 0)),
    "Pa": (1.0, (-1, 1, -2, 0, 0, 0)),
    "kPa": (1e3, (-1, 1, -2, 0, 0, 0)),
    "MPa": (1e6, (-1, 1, -2, 0, 0, 0)),
    "J": (1.0, (2, 1, -2, 0, 0, 0)),
    "W": (1.0, (2, 1, -3, 0, 0, 0)),
    "degC": (1.0, (0, 0, 0, 0, 1, 0)),
    "mA": (1e-3, (0, 0, 0, 0, 0, 1)),
    "A": (1.0, (0, 0, 0, 0, 0, 1)),
}
_FACTOR = re.compile(r"(1|%|[A-Za-z]+)(\d?)")


@dataclass(frozen=True)
class WrittenUnit:
    """A unit as the user wrote it: ``name``, and ``scale``, the factor from it to our own unit."""

    name: str
    scale: float = 1.0

    def of(self, value: float) -> float:
        """Converts ``value`` from our own unit to this one."""
        return value if self.scale == 1.0 else float(f"{value / self.scale:.{DIGITS}g}")

    def all_of(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """The same for an array."""
        import numpy as np

        return values if self.scale == 1.0 else np.array([self.of(value) for value in values.tolist()])

    @property
    def shown(self) -> str:
        """The name, or "" where there is no unit."""
        return "" if self.name == "1" else self.name


def check_unit(field: str, unit: str, allowed: str) -> None:
    """Refuse what is no unit."""
    _read(field, unit, allowed)


def factor(field: str, unit: str, wanted: str) -> float:
    """The factor from ``unit`` to ``wanted``; a GivewayError names ``field``."""
    size, dimension = _read(field, unit, _allowed(wanted))
    try:
        wanted_size, wanted_dimension = _read(field, wanted or "1", "")
    except GivewayError:  # a currency: nothing is converted to it
        raise GivewayError(field, unit, wanted) from None
    if dimension != wanted_dimension:
        raise GivewayError(field, unit, _allowed(wanted))
    return size / wanted_size


def _allowed(wanted: str) -> str:
    return f"{wanted}, or a unit of the same kind" if wanted not in ("", "1") else "1 or %: it has no unit"


def _read(field: str, unit: str, allowed: str) -> tuple[float, _Dimension]:
    """Magnitude and dimension of ``N.m.s/rad``: all factors after the one slash are divisors."""
    size, dimension = 1.0, [0, 0, 0, 0, 0, 0]
    above, _, below = unit.partition("/")
    for part, sign in ((above, 1), (below, -1)):
        for word in part.split(".") if part else ():
            found = _FACTOR.fullmatch(word)
            if found is None or found[1] not in _ATOMS:
                raise GivewayError(field, unit, allowed)
            power = sign * int(found[2] or 1)
            atom, exponents = _ATOMS[found[1]]
            size *= atom**power
            dimension = [total + power * one for total, one in zip(dimension, exponents, strict=True)]
    if not above or unit.count("/") > 1 or (not below and "/" in unit):
        raise GivewayError(field, unit, allowed)
    a, b, c, d, e, f = dimension
    return size, (a, b, c, d, e, f)
