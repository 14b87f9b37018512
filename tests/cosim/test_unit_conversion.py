"""Units as users write them: every one that is known has its size, and another kind is refused."""

from __future__ import annotations

import math

import pytest
from giveway.base import units
from giveway.base.errors import GivewayError
from giveway.base.units import factor

SIZES = {  # of one unit in SI: the SI brochure; NIST SP 811 for inch, foot, pound and pound-force, which are exact
    ("m",): {"um": 1e-6, "mm": 1e-3, "cm": 1e-2, "m": 1.0, "km": 1e3, "in": 0.0254, "ft": 0.3048},
    ("kg",): {"g": 1e-3, "kg": 1.0, "lb": 0.45359237},
    ("s",): {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0, "h": 3600.0},
    ("rad",): {"rad": 1.0, "mrad": 1e-3, "deg": math.pi / 180.0},
    ("Hz", "1/s"): {"Hz": 1.0, "kHz": 1e3},
    ("N", "kg.m/s2"): {"mN": 1e-3, "N": 1.0, "kN": 1e3, "lbf": 4.4482216152605},
    ("Pa", "N/m2", "kg/m.s2"): {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6},
    ("J", "N.m", "kg.m2/s2"): {"J": 1.0},
    ("W", "J/s", "N.m/s"): {"W": 1.0},
    ("degC",): {"degC": 1.0},
    ("A",): {"mA": 1e-3, "A": 1.0},
    ("1", ""): {"1": 1.0, "%": 1e-2},
}
CONVERSIONS = [(unit, si, size) for names, sizes in SIZES.items() for si in names for unit, size in sizes.items()]


@pytest.mark.parametrize(("unit", "wanted", "size"), [
    *CONVERSIONS,
    ("N/mm", "N/m", 1e3), ("kN/m", "N/m", 1e3), ("km/h", "m/s", 1.0 / 3.6), ("N.mm/deg", "N.m/rad", 0.18 / math.pi),
    ("kg/s2", "N/m", 1.0), ("N/cm2", "kPa", 10.0), ("in", "mm", 25.4), ("cm2", "m2", 1e-4), ("m", "mm", 1e3),
    ("1", "%", 100.0), ("Hz", "kHz", 1e-3),
])  # fmt: skip
def test_units_convert(unit: str, wanted: str, size: float) -> None:
    # A few products of rounded numbers: some 2e-16 each.
    assert factor("unit", unit, wanted) == pytest.approx(size, rel=1e-15, abs=0.0)


def test_every_unit_that_is_known_stands_in_the_table_above() -> None:
    assert set(units._ATOMS) == {unit for sizes in SIZES.values() for unit in sizes}


@pytest.mark.parametrize("known", [names[0] for names in SIZES])
def test_units_of_another_kind_are_refused(known: str) -> None:
    for names, sizes in SIZES.items():
        for unit in sizes if names[0] != known else ():
            with pytest.raises(GivewayError, match=r"unit of the same kind|has no unit"):
                factor("vary[0].unit", unit, known)


@pytest.mark.parametrize(
    ("unit", "wanted"),
    [("N", "N/m"), ("m", "rad"), ("Nm", "N.m"), ("", "kg"), ("N/", "N"), ("N//m", "N/m"), ("K", "degC")],
)
def test_units_that_do_not_fit_are_refused(unit: str, wanted: str) -> None:
    with pytest.raises(GivewayError, match=wanted):
        factor("vary[0].unit", unit, wanted)
