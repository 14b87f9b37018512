"""The obstacle from above: shapes of slider, nose and bumper for the animation and the figures."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from giveway.scenario.approach import outline_of

__all__ = ["EDGE_DEPTH_M", "EDGE_M", "SLIDER_M", "obstacle", "plate", "rail"]

EDGE_M, EDGE_DEPTH_M = 1.2, 0.06  # of a long edge, as drawn
SLIDER_M = (0.14, 0.12)  # along its rail and across it, as drawn
RIGID_M = 0.1  # from the slider to its nose without a bumper, as drawn
CLOSED_M = 0.02  # between slider and nose at full compression
PLATE_M = 0.2  # of a bumper's plate on the robot, as drawn


def rail(testbed: Mapping[str, Any]) -> list[float]:
    """Unit vector of the slider's direction of travel in the world: from it to the robot, whichever of them moves."""
    direction = float(testbed["slider.direction"])
    return [math.cos(direction), math.sin(direction)]


def obstacle(testbed: Mapping[str, Any]) -> dict[str, Any]:
    """Shapes behind the tip of the nose, as polygons of (distance back along the rail, distance to its left), m.

    The body moves towards the nose by the compression if the bumper is ``sprung`` and on the slider.
    """
    sprung = bool(testbed["bumper.kind"]) and int(testbed["bumper.mount"]) == 0
    radius = float(testbed["contact.nose_radius"])
    edge = int(testbed["contact.nose_shape"]) == 1
    front = EDGE_DEPTH_M if edge else 2.0 * radius
    start = front + (CLOSED_M + float(testbed["bumper.travel"]) if sprung else RIGID_M)
    return {
        "rail": rail(testbed),
        "radius": None if edge else radius,
        "edge": _box(0.0, EDGE_DEPTH_M, EDGE_M) if edge else None,
        "front": front,
        "body": _box(start, start + SLIDER_M[0], SLIDER_M[1]),
        "sprung": sprung,
    }


def plate(testbed: Mapping[str, Any]) -> dict[str, Any] | None:
    """A bumper on the robot, base frame, m: ends of its plate, its direction, base of its spring; None if there is
    none."""
    if not testbed["bumper.kind"] or int(testbed["bumper.mount"]) == 0:
        return None
    azimuth = float(testbed["bumper.mount_azimuth"])
    x, y = float(testbed["bumper.mount_x"]), float(testbed["bumper.mount_y"])
    inward = (-math.cos(azimuth), -math.sin(azimuth))
    across = (0.5 * PLATE_M * inward[1], -0.5 * PLATE_M * inward[0])
    depth = _distance_to_outline((x, y), inward, testbed)
    return {
        "ends": [[x + across[0], y + across[1]], [x - across[0], y - across[1]]],
        "inward": list(inward),
        "foot": [x + depth * inward[0], y + depth * inward[1]],
    }


def _box(start: float, end: float, width: float) -> list[list[float]]:
    return [[start, 0.5 * width], [end, 0.5 * width], [end, -0.5 * width], [start, -0.5 * width]]


def _distance_to_outline(point: tuple[float, float], inward: tuple[float, float], testbed: Mapping[str, Any]) -> float:
    """From a point outside along ``inward`` to the first side of the outline, m; to the middle if there is none."""
    corners = outline_of(testbed)
    found = []
    for (ax, ay), (bx, by) in zip(corners, [*corners[1:], corners[0]], strict=True):
        determinant = inward[0] * (ay - by) - inward[1] * (ax - bx)
        if determinant == 0.0:
            continue
        dx, dy = ax - point[0], ay - point[1]
        distance = (dx * (ay - by) - dy * (ax - bx)) / determinant
        share = (inward[0] * dy - inward[1] * dx) / determinant
        if distance >= 0.0 and 0.0 <= share <= 1.0:
            found.append(distance)
    return min(found, default=math.hypot(*point))
