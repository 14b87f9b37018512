"""An experiment's part in the reproduction of the paper: rows of its table and figures of its report.

An experiment's module defines ``EXPERIMENT`` with a ``reproduce`` function from an `Effort` to `Findings`. That
function computes the rows; the paper's printed numbers stand in `giveway.paper.printed`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, TypeVar

from giveway.base.errors import GivewayError
from giveway.paper.matched import matched
from giveway.paper.printed import Printed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from giveway.simulation.result import Result

__all__ = ["CLASSES", "PROVENANCES", "Effort", "Findings", "Picture", "Row", "Target", "warning_notes"]

_T = TypeVar("_T")

PROVENANCES = ("given", "sourced", "fitted", "assumed", "computed")
"""Provenance of a row's number: the weakest of its inputs, in this order; computed has no such input."""

PREDICTED, FITTED, REQUIREMENT = "predicted", "fitted", "own requirement"
CLASSES: Mapping[str, str] = MappingProxyType(
    {
        PREDICTED: "numbers of the paper that no value here was chosen to match",
        FITTED: "numbers of the paper that values here were fitted or set to match",
        REQUIREMENT: "what the paper says without a number, and what this project asks for",
    }
)
"""What a target is worth: the classes of judged rows, in the order of the summary."""

Progress = Callable[[float], None]
"""Called now and then with the finished share of the experiment, 0 to 1."""


def _silent(_share: float) -> None:
    pass


@dataclass(frozen=True)
class Effort:
    """How much an experiment may spend.

    Attributes:
        full: False is the reduced version that the tests run: every step, on fewer and shorter runs.
        threads: native threads it may use.
        progress: told the finished share.
    """

    full: bool = True
    threads: int = 2
    progress: Progress = _silent

    def pick(self, full: _T, reduced: _T) -> _T:
        """``full`` or ``reduced``, by effort."""
        return full if self.full else reduced


@dataclass(frozen=True)
class Target:
    """The target of a number.

    Attributes:
        minimum, maximum: inclusive bounds in the row's unit.
        text: the bounds in words; made from them when empty.
    """

    minimum: float = -math.inf
    maximum: float = math.inf
    text: str = ""

    @classmethod
    def around(cls, centre: float, tolerance: float) -> Target:
        """``centre`` plus or minus ``tolerance``."""
        return cls(centre - tolerance, centre + tolerance, f"{centre:g} ± {tolerance:g}")

    def __post_init__(self) -> None:
        if not self.minimum <= self.maximum:
            raise GivewayError("Target.minimum", self.minimum, f"at most the maximum, {self.maximum:g}")
        if not self.text:
            low = f"at least {self.minimum:g}" if math.isfinite(self.minimum) else ""
            high = f"at most {self.maximum:g}" if math.isfinite(self.maximum) else ""
            object.__setattr__(self, "text", " and ".join(part for part in (low, high) if part) or "any")

    def met(self, value: float | None) -> bool:
        """Whether ``value`` lies within; None (it did not happen) does not."""
        return value is not None and self.minimum <= value <= self.maximum


@dataclass(frozen=True)
class Row:
    """One line of the table: a quantity in the paper and here.

    Attributes:
        quantity: what it is, with the case ("detection time, spring").
        ours: the computed number in ``unit``; None if it did not happen.
        unit: of paper, ours and target; "1" if there is none.
        provenance: one of `PROVENANCES`.
        paper: the paper's number, which needs a target; what it says without a number; None where it says nothing.
        target: required range of ours, or None for a number that is only shown.
        reason: why a target is missed, found by experiment: the parameter values that would meet it. A miss needs one.
        decimals: digits after the point that are worth printing.
    """

    quantity: str
    ours: float | None
    unit: str
    provenance: str
    paper: Printed | str | None = None
    target: Target | None = None
    reason: str = ""
    decimals: int = 1

    def __post_init__(self) -> None:
        if self.provenance not in PROVENANCES:
            raise GivewayError(f"{self.quantity}: provenance", self.provenance, ", ".join(PROVENANCES))
        if isinstance(self.paper, Printed) and self.target is None:
            raise GivewayError(f"{self.quantity}: target", None, f"one for the paper's {self.paper.text}")
        if self.paper is not None and not isinstance(self.paper, Printed | str):
            raise GivewayError(f"{self.quantity}: paper", self.paper, "a result of giveway.paper.printed, or words")
        if self.ours is not None:
            number = float(self.ours)
            object.__setattr__(self, "ours", number if math.isfinite(number) else None)

    @property
    def met(self) -> bool | None:
        """Whether the target is met; None without one."""
        return None if self.target is None else self.target.met(self.ours)

    @property
    def kind(self) -> str:
        """Its class in `CLASSES`; "" without a target. What was fitted is asked of the fit's list, not stated here."""
        if self.target is None:
            return ""
        if not isinstance(self.paper, Printed):
            return REQUIREMENT
        return FITTED if self.paper.name in matched() else PREDICTED

    @property
    def papers(self) -> float | str | None:
        """The paper's cell: its number if that is in the row's unit, else words."""
        if not isinstance(self.paper, Printed):
            return self.paper
        return self.paper.value if self.paper.unit == self.unit and not self.paper.words else self.paper.text


@dataclass(frozen=True)
class Picture:
    """A figure of the report.

    Attributes:
        name: short and unique in its experiment; part of a file name.
        title, caption: its words; the caption says what to look for.
        figure: drawn in `giveway.report.style.STYLE`.
        paper: the paper's printed numbers to stand beside it, one (what, number with unit) each.
    """

    name: str
    title: str
    caption: str
    figure: Figure
    paper: Sequence[tuple[str, str]] = ()


@dataclass(frozen=True)
class Findings:
    """All that an experiment found.

    Attributes:
        rows: in the order of the table.
        pictures: in the order of the report.
        notes: sentences for the report about deviations and their reasons.
    """

    rows: Sequence[Row]
    pictures: Sequence[Picture] = field(default_factory=tuple)
    notes: Sequence[str] = field(default_factory=tuple)


def warning_notes(results: Mapping[str, Result]) -> list[str]:
    """Warnings of the runs as notes; ``results`` by name."""
    return [f"{name}: {one.text}." for name, result in results.items() for one in result.warnings]
