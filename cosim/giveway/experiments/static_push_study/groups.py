"""Groups of four pushes on one robot, as in 5.1, and the rank of the paper's numbers among them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from giveway.paper.printed import ERRORS_OF_PUSHES, printed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.experiments.static_push_study.trials import Readings

__all__ = ["GROUP", "PRINTED", "group_values", "percentile_of"]

GROUP = 4
PAPER_FORCE_N = 10.0  # the paper's value for the weight of 1 kg, used in its comparisons

PRINTED = tuple(printed(name) for name in ERRORS_OF_PUSHES)


def group_values(readings: Readings) -> NDArray[np.float64]:
    """The six quantities of `PRINTED` for each four consecutive trials, shape (groups, 6).

    Magnitudes are compared with 10 N, as the paper does, though the weight of 1 kg is 9.81 N.
    """
    magnitude = _grouped(100.0 * (readings.force_n / PAPER_FORCE_N - 1.0))
    direction, location = _grouped(np.abs(readings.direction_error_deg)), _grouped(readings.location_error_cm)
    columns = [
        magnitude.min(1),
        magnitude.max(1),
        direction.max(1),
        direction.mean(1),
        location.max(1),
        location.mean(1),
    ]
    return np.stack(columns, axis=1)


def _grouped(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return values.reshape(-1, GROUP)


def percentile_of(value: float, values: NDArray[np.float64]) -> float:
    """Share of ``values`` below ``value``, in percent; those equal to it count half."""
    return float(100.0 * (np.mean(values < value) + 0.5 * np.mean(values == value)))
