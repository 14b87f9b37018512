"""Names of what comes out of a run, as a study's objectives and constraints call them: what the batch library measures,
and what follows from the drivetrain's parameters (`drivetrain_metrics`)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.errors import UnknownNameError
from giveway.simulation.metric_names import current_name

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "DRIVETRAIN",
    "IMPACT_FORCE",
    "MASS_OF_PARTS",
    "PRICE_OF_PARTS",
    "Metric",
    "all_metrics",
    "find_metric",
    "usual_sense",
]

TRUE, ERROR = " (true)", " (error)"
PRICE_OF_PARTS, MASS_OF_PARTS = "price of parts", "mass of parts"  # of a design, not of its runs (parts.py)
IMPACT_FORCE, SMALLEST_PUSH, INERTIA = "impact force", "smallest detectable push", "reflected inertia"
DRIVETRAIN: Mapping[str, str] = MappingProxyType(
    {
        "torque bandwidth": "Hz",
        "first resonance": "Hz",
        "servo gain margin": "dB",
        "servo phase margin": "deg",
        "servo delay margin": "ms",
        SMALLEST_PUSH: "N",
        INERTIA: "kg",
        IMPACT_FORCE: "N",
    }
)
"""What follows from the parameters of a run, and its unit."""
_LESS_IS_BETTER = (SMALLEST_PUSH, INERTIA, IMPACT_FORCE)
_OF_WHOLE_CONTACT = (
    "peak force of the run", "peak force of the first contact", "bumper compression", "bottoming margin",
    "transient force", "transient force share", "lasting force", "lasting force share", "longest contact",
    "contact impulse", "peak wheel torque", "peak torque, any sign",
)  # fmt: skip


@dataclass(frozen=True)
class Metric:
    """Something that comes out of a run: one column of the results, or how far it is from the truth.

    Attributes:
        name, unit: "peak force of the run" in "N".
        column: of the results table.
        truth: column of what it is compared with, if it is an error: the absolute difference of both.
    """

    name: str
    unit: str
    column: str
    truth: str | None = None

    @property
    def of_design(self) -> bool:
        """It is the same in all runs of a design."""
        return self.name in (PRICE_OF_PARTS, MASS_OF_PARTS)

    @property
    def of_whole_contact(self) -> bool:
        """It may grow as long as a contact lasts."""
        return self.column in _OF_WHOLE_CONTACT

    @property
    def columns(self) -> tuple[str, ...]:
        """What it is computed from."""
        return (self.column,) if self.truth is None else (self.column, self.truth)

    def of(self, results: dict[str, NDArray[np.float64]]) -> NDArray[np.float64]:
        """Its values, NaN for what did not happen."""
        if self.truth is None:
            return results[self.column]
        return np.abs(results[self.column] - results[self.truth])


def usual_sense(metric: Metric) -> int:
    """1: less of it is better, or nobody asks; -1: more."""
    return -1 if metric.name in DRIVETRAIN and metric.name not in _LESS_IS_BETTER else 1


def all_metrics() -> dict[str, Metric]:
    """Everything that comes out of a run, by name; ``NAME (true)`` and ``NAME (error)`` where there is a truth."""
    from giveway.library.batch_library import native_metrics

    found = {}
    for metric in native_metrics():
        found[metric.name] = Metric(metric.name, metric.unit, metric.name)
        if metric.has_truth:
            truth, error = metric.name + TRUE, metric.name + ERROR
            found[truth] = Metric(truth, metric.unit, truth)
            found[error] = Metric(error, metric.unit, metric.name, truth)
    return found | {name: Metric(name, unit, name) for name, unit in DRIVETRAIN.items()}


def find_metric(field: str, name: str) -> Metric:
    """The metric ``name`` of a run; the error names ``field`` and the nearest."""
    known = all_metrics()
    name = current_name(field, name)
    if name not in known:
        raise UnknownNameError(field, name, (*known, PRICE_OF_PARTS, MASS_OF_PARTS))
    return known[name]
