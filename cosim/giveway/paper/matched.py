"""The numbers of the paper that our values were chosen to match: what `giveway fit` aims at, and what was set by hand.

A row of `giveway reproduce` about any of them is fitted, not predicted. This is the only list: the fit minimises the
residuals of `QUANTITIES`, and the table asks `matched`.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from giveway.paper.printed import ERRORS_OF_PUSHES, printed

__all__ = ["QUANTITIES", "SET_BY_HAND", "Quantity", "matched"]

NOT_HAPPENED = 10.0  # residual, in tolerances, of an event that did not happen: larger than any real miss


@dataclass(frozen=True)
class Quantity:
    """A number of the paper.

    Attributes:
        name: what it is.
        section: of the paper.
        unit: of the numbers.
        aim: what ours should be.
        tolerance: the deviation that counts as one.
        paper: in the paper's words.
        upper: only values above the aim count as deviating.
        prints: its numbers in `giveway.paper.printed`; none if it is the project's own demand.
    """

    name: str
    section: str
    unit: str
    aim: float
    tolerance: float
    paper: str
    upper: bool = False
    prints: tuple[str, ...] = ()

    def residual(self, value: float) -> float:
        """Deviation of ``value`` from the aim in tolerances; `NOT_HAPPENED` for NaN."""
        if math.isnan(value):
            return NOT_HAPPENED
        deviation = (value - self.aim) / self.tolerance
        return max(0.0, deviation) if self.upper else deviation


# A detection time may deviate by 10 ms; the tolerances of the ratios are our reading of "about".
QUANTITIES = (
    Quantity("contact speed", "5.2", "m/s", 0.5, 0.002, "0.5 m/s", prints=("slider speed",)),
    Quantity("detection time, no bumper", "5.2", "ms", 45.0, 10.0, "45 ms", prints=("detection, no bumper",)),
    Quantity("detection time, spring", "5.2", "ms", 95.0, 10.0, "95 ms", prints=("detection, spring",)),
    Quantity("detection time, magnetic", "5.2", "ms", 85.0, 10.0, "85 ms", prints=("detection, magnetic",)),
    # Half the paper's lead is still a lead; the two times above alone could agree within 10 ms in the wrong order.
    Quantity("lead of magnetic over spring", "5.2", "ms", 10.0, 5.0, "10 ms", prints=("lead of magnetic over spring",)),
    Quantity(
        "peak wheel torque, spring over no bumper",
        "5.2",
        "1",
        0.8,
        0.05,
        "about 20 % lower",
        prints=("peak torque with bumpers",),
    ),
    Quantity(
        "peak wheel torque, magnetic over no bumper",
        "5.2",
        "1",
        0.8,
        0.05,
        "about 20 % lower",
        prints=("peak torque with bumpers",),
    ),
    # The project's own demand: not more than 5 % higher.
    Quantity("peak contact force, magnetic over spring", "3.5", "1", 1.0, 0.05, "no higher peak over the run", True),
    Quantity("detection time, moving", "5.3", "ms", 105.0, 10.0, "105 ms", prints=("detection, moving",)),
    # The project's own demand: the robot's own acceleration must not come near to being mistaken for another hit.
    Quantity("false impulse after the reversal over the threshold", "5.3", "1", 0.5, 0.2, "one reaction", True),
    Quantity(
        "peak torque of the reversal over 5.2's with bumpers",
        "5.3",
        "1",
        2.0,
        0.2,
        "about twice",
        prints=("peak torque, moving",),
    ),
    # With uniform rollers: the mean of what the paper saw; its range, which is their scatter, is two deviations wide.
    Quantity(
        "sensed force of a 9.81 N push at rest",
        "5.1",
        "N",
        7.75,
        1.125,
        "5.5 to 10 N",
        prints=(
            "magnitude error, weakest of four pushes",
            "magnitude error, strongest of four pushes",
        ),
    ),
)


SET_BY_HAND: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        # given: the plant's rollers have the paper's friction
        "roller.coulomb_torque": ("B_r",),
        "roller.tanh_slope": ("alpha",),
        # given, or read so that it comes out: 0.8 N s over 1.6 N s/m
        "admittance.escape_impulse": ("escape",),
        "moving.SPEED_MPS": ("robot speed",),
        # The fit's estimate and range are those that reproduce the errors of 5.1.
        "roller.presliding_stiffness": ERRORS_OF_PUSHES,
        # The scatter from wheel to wheel is the least that brings these within reach.
        "static_push_study.robots.SCATTER": (
            "magnitude error, weakest of four pushes",
            "direction error, largest of four pushes",
        ),
    }
)
"""Values chosen to match the paper's results without the fit, or before it as its estimate, and these results."""


@functools.cache
def matched() -> Mapping[str, tuple[str, ...]]:
    """What was chosen to match each result that is not predicted; UnknownNameError if the paper has no such result."""
    found: dict[str, tuple[str, ...]] = {}
    by_fit = [("giveway fit", name) for quantity in QUANTITIES for name in quantity.prints]
    by_hand = [(what, name) for what, names in SET_BY_HAND.items() for name in names]
    for what, name in by_fit + by_hand:
        found[printed(name).name] = tuple(dict.fromkeys((*found.get(name, ()), what)))
    return MappingProxyType(found)
