"""Every number that Kim, Llado, Sentis 2016 print about their results, from the first page to the last.

Each is judged in at least one row of `giveway reproduce`, or stands in `NOT_JUDGED` with the reason. What the paper
sets (masses, speeds, radii, cycle times) is no result, and is not here.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from giveway.base.errors import UnknownNameError

__all__ = ["ERRORS_OF_PUSHES", "NOT_JUDGED", "RESULTS", "Printed", "printed"]


@dataclass(frozen=True)
class Printed:
    """A result in the paper.

    Attributes:
        name: unique; what it is.
        where: section or figure.
        value: as printed, in ``unit``.
        unit: of the value; "1" if there is none.
        words: the value as a table shows it where the number alone would say too much, or would be in another unit.
    """

    name: str
    where: str
    value: float
    unit: str
    words: str = ""

    @property
    def text(self) -> str:
        """The value in words: as stated, or number and unit."""
        return self.words or (f"{self.value:g}" if self.unit == "1" else f"{self.value:g} {self.unit}")


_ALL = (
    Printed("time to detect and reverse", "3.5", 100.0, "ms", "roughly 100"),
    Printed("B_r", "4.2", 0.2, "N.m"),
    Printed("alpha", "4.2", 0.4, "s/rad"),
    Printed("magnitude error, weakest of four pushes", "5.1", -45.0, "%"),
    Printed("magnitude error, strongest of four pushes", "5.1", 0.0, "%"),
    Printed("direction error, largest of four pushes", "5.1", 12.0, "deg"),
    Printed("direction error, mean of four pushes", "5.1", 7.2, "deg"),
    Printed("location error, largest of four pushes", "5.1", 11.0, "cm"),
    Printed("location error, mean of four pushes", "5.1", 4.5, "cm"),
    Printed("slider speed", "5.2", 0.5, "m/s"),
    Printed("escape", "5.2", 0.5, "m"),
    Printed("detection, no bumper", "5.2", 45.0, "ms"),
    Printed("detection, spring", "5.2", 95.0, "ms"),
    Printed("detection, magnetic", "5.2", 85.0, "ms"),
    Printed("M_des just over the limit of tipping", "5.2", 2.0, "kg", "just below 2"),
    Printed("lead of magnetic over spring", "5.2", 10.0, "ms"),
    Printed("largest acceleration, magnetic", "Fig. 10", 140.0, "ms"),
    Printed("plateau, no bumper", "5.2", 50.0, "ms", "about 50"),
    Printed("peak torque with bumpers", "5.2", -20.0, "%", "about -20"),
    Printed("robot speed", "5.3", 0.22, "m/s"),
    Printed("detection, moving", "5.3", 105.0, "ms"),
    Printed("largest deflection, moving", "Fig. 11", 180.0, "ms"),
    Printed("peak torque, moving", "5.3", 2.0, "1", "about 2"),
)

RESULTS: Mapping[str, Printed] = MappingProxyType({one.name: one for one in _ALL})
"""By name, in the order of the paper."""

ERRORS_OF_PUSHES = tuple(name for name in RESULTS if name.endswith(" of four pushes"))
"""The six of 5.1, by name: 5.5 to 10 N of 10 N; 12 deg at most, 2 % of the full circle in the mean; 11 cm, 4.5 cm."""

NOT_JUDGED: Mapping[str, str] = MappingProxyType(
    {
        "0.05 s, when the estimated force without a bumper reaches the threshold (Fig. 10c)": (
            "the same event as the detection after 45 ms, read off the figure's axis"
        ),
        "5.5 to 10 N; 3.3 %, 2 %, 18 % and 7.5 % (5.1); 18 %, 3.3 % and 45 % (section 6)": (
            "the errors of 5.1 once more, in newtons, and as shares of the circle and of the 61 cm of a side"
        ),
        "positions, forces and torques over time (Fig. 7 to 12)": "drawn, without a number in text or caption",
    }
)
"""What the paper prints besides, and why it has no row."""


def printed(name: str) -> Printed:
    """The result called ``name``; UnknownNameError offers the nearest one."""
    if name not in RESULTS:
        raise UnknownNameError("result of the paper", name, RESULTS)
    return RESULTS[name]
