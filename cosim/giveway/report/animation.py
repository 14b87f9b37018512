"""The data of the top-view animation: few enough samples for a small file, dense where the impact is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.approach import outline_of
from giveway.metrics import Collision
from giveway.report.obstacle import obstacle, plate

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.result import Result

__all__ = ["scene"]

LEAD_S = 0.15  # shown before contact
IMPACT_S, IMPACT_STEP_S, ESCAPE_STEP_S = 0.6, 0.002, 0.025
DECIMALS = 4


def scene(label: str, result: Result) -> dict[str, Any]:
    """Geometry and sampled motion of one run; lengths in m, forces in N, times in s since contact."""
    hit = Collision(result.traces, result.manifest["parameters"])
    parameters = result.manifest["parameters"]["testbed"]
    contact_s = hit.contact_s or 0.0
    rows = _samples(hit.time_s - contact_s)
    theta = hit["testbed.truth.theta"]
    x, y = hit["testbed.truth.x"], hit["testbed.truth.y"]

    def sampled(name: str) -> list[float]:
        return _rounded(hit[name][rows])

    force = [hit[f"testbed.truth.contact_force_{axis}"] for axis in "xy"]
    point = [hit[f"testbed.truth.contact_point_{axis}"] for axis in "xy"]
    if hit.pushed().any():
        pushed_at = _to_world(hit, "testbed.push.point_x", "testbed.push.point_y", x, y, theta)
        point = [np.where(hit.pushed(), at, touched) for at, touched in zip(pushed_at, point, strict=True)]
        force = [total + hit[f"testbed.push.force_{axis}"] for total, axis in zip(force, "xy", strict=True)]
    estimated_point = _to_world(hit, "controller.estimate.point_x", "controller.estimate.point_y", x, y, theta)
    estimated_force = _to_world(hit, "controller.estimate.force_x", "controller.estimate.force_y", 0.0, 0.0, theta)
    return {
        "label": label,
        "outline": outline_of(parameters).tolist(),
        "wheel": {name: parameters[f"wheel.{name}"] for name in ("radius", "distance", "width")},
        "obstacle": obstacle(parameters) if parameters["slider.present"] else None,
        "plate": plate(parameters),
        "time": _rounded((hit.time_s - contact_s)[rows]),
        "base": [sampled(f"testbed.truth.{name}") for name in ("x", "y", "theta")],
        "nose": [sampled("testbed.truth.nose_x"), sampled("testbed.truth.nose_y")],
        "compression": sampled("testbed.truth.bumper_compression"),
        "point": [_rounded(values[rows]) for values in point],
        "force": [_rounded(values[rows]) for values in force],
        "estimated_point": [_rounded(values[rows]) for values in estimated_point],
        "estimated_force": [_rounded(values[rows], 2) for values in estimated_force],
        "detection": _detection(hit, contact_s),
    }


def _samples(time_s: NDArray[np.float64]) -> NDArray[np.intp]:
    """Rows to show: every 2 ms around the impact, every 25 ms in the long escape."""
    step_s = float(time_s[1] - time_s[0])
    fine, coarse = (max(1, round(wanted / step_s)) for wanted in (IMPACT_STEP_S, ESCAPE_STEP_S))
    index = np.arange(len(time_s))
    near = (time_s >= -LEAD_S) & (time_s < IMPACT_S)
    chosen = (near & (index % fine == 0)) | ((time_s >= IMPACT_S) & (index % coarse == 0))
    rows = np.flatnonzero(chosen)
    return rows if rows.size else index[::fine]


def _to_world(
    hit: Collision, name_x: str, name_y: str, x: Any, y: Any, theta: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    bx, by = hit[name_x], hit[name_y]
    return x + np.cos(theta) * bx - np.sin(theta) * by, y + np.sin(theta) * bx + np.cos(theta) * by


def _detection(hit: Collision, contact_s: float) -> dict[str, Any] | None:
    """When and what was detected; point and force in the base frame, where they stay put on the robot."""
    row = hit.detected
    if row is None:
        return None
    return {
        "time": round(float(hit.time_s[row] - contact_s), DECIMALS),
        "point": [round(float(hit[f"controller.detection.point_{axis}"][row]), DECIMALS) for axis in "xy"],
        "force": [round(float(hit[f"controller.detection.force_{axis}"][row]), 2) for axis in "xy"],
    }


def _rounded(values: NDArray[np.float64], decimals: int = DECIMALS) -> list[float]:
    return [float(value) for value in np.round(values, decimals)]
