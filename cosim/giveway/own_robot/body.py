"""The body as a prism over its outline: area and radius of gyration, for estimates and for what is plausible."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Plate", "plate"]


@dataclass(frozen=True)
class Plate:
    """An even plate of the outline's shape.

    Attributes:
        area_m2: positive for anticlockwise corners.
        gyration_m: its radius of gyration about the origin: an even body has the yaw inertia mass times its square.
        reach_m: distance of the farthest corner from the origin.
    """

    area_m2: float
    gyration_m: float
    reach_m: float


def plate(corners: NDArray[np.float64]) -> Plate:
    """Area and moments of a simple polygon, corners (n, 2), m."""
    x, y = corners.T
    x1, y1 = np.roll(x, -1), np.roll(y, -1)
    cross = x * y1 - x1 * y
    area = float(0.5 * cross.sum())
    second = float((cross * (x * x + x * x1 + x1 * x1 + y * y + y * y1 + y1 * y1)).sum() / 12.0)
    gyration = math.sqrt(second / area) if area > 0.0 and second > 0.0 else 0.0
    return Plate(area, gyration, float(np.hypot(x, y).max()))
