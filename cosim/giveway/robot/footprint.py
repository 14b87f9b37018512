"""The robot from above, including the wheels: corners and hull, for outlines that are convex polygons."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.errors import GivewayError
from giveway.robot.variables import Value
from giveway.robot.wheels import AZIMUTHS_RAD

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["controller_outline", "hull", "wheel_corners"]

CORNERS_MAX = 16  # of the controller's outline


def wheel_corners(testbed: Mapping[str, Value], height_m: float | None = None) -> NDArray[np.float64]:
    """Corners of the three wheels' sections at ``height_m``, base frame, m, shape (3, 4, 2), anticlockwise each.

    A section is as wide as the wheel and as long as the chord of its disc: as in the plant. None: at axle height, where
    it is longest.
    """
    radius, distance = float(testbed["wheel.radius"]), float(testbed["wheel.distance"])
    above_axle = 0.0 if height_m is None else height_m - radius
    if abs(above_axle) >= radius:
        raise GivewayError(
            "height_m", height_m, f"a height at which there are wheels: between 0 and {2.0 * radius:g} m"
        )
    half_width, half_length = 0.5 * float(testbed["wheel.width"]), math.sqrt(radius**2 - above_axle**2)
    corners = np.array([
        [distance - half_width, -half_length],
        [distance + half_width, -half_length],
        [distance + half_width, half_length],
        [distance - half_width, half_length],
    ])  # fmt: skip
    return np.stack([
        corners @ np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
        for turn in AZIMUTHS_RAD
    ])  # fmt: skip


def hull(points: Sequence[Sequence[float]] | NDArray[np.float64]) -> NDArray[np.float64]:
    """Convex hull of points (n, 2), anticlockwise, shape (corners, 2)."""
    ordered = sorted({(float(x), float(y)) for x, y in points})
    if len(ordered) < 3:
        raise GivewayError("points", len(ordered), "at least three different ones")

    def chain(sequence: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
        kept: list[tuple[float, float]] = []
        for point in sequence:
            while len(kept) >= 2 and _turn(kept[-2], kept[-1], point) <= 0.0:
                kept.pop()
            kept.append(point)
        return kept[:-1]

    return np.array(chain(ordered) + chain(ordered[::-1]))


def controller_outline(corners: NDArray[np.float64]) -> dict[str, Value]:
    """The controller's ``outline.*`` parameters for a convex outline of shape (n, 2), anticlockwise, m."""
    if len(corners) > CORNERS_MAX:
        raise GivewayError("corners", len(corners), f"at most {CORNERS_MAX}")
    values: dict[str, Value] = {"outline.count": len(corners)}
    for index, (x, y) in enumerate(corners):
        values[f"outline.x[{index}]"], values[f"outline.y[{index}]"] = float(x), float(y)
    return values


def _turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    """Positive if the path from ``a`` over ``b`` to ``c`` turns left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
