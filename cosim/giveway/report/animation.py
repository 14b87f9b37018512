"""The data of the top-view animation: few samples for a small file, dense around the impact."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.report.obstacle import obstacle, plate
from giveway.scenario.approach import outline_of
from giveway.simulation.metrics import Collision
from giveway.simulation.push_response import responses_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.simulation.push_response import PushResponse
    from giveway.simulation.result import Result

__all__ = ["motion", "scene"]

LEAD_S = 0.15  # shown before contact
IMPACT_S, IMPACT_STEP_S, ESCAPE_STEP_S = 0.6, 0.002, 0.025
DECIMALS = 4
PUSH = tuple(f"{kind}_{axis}" for kind in ("force", "point") for axis in "xy")
FELT = (
    "controller.estimate.valid",
    *(f"controller.{what}.{name}" for what in ("estimate", "detection") for name in PUSH),
)  # in the base frame


def scene(label: str, result: Result) -> dict[str, Any]:
    """Geometry and sampled motion of one run; lengths in m, forces in N, times in s since contact or the first push."""
    hit = Collision(result.traces, result.manifest["parameters"])
    parameters = result.manifest["parameters"]["testbed"]
    pushes = responses_of(result.traces, result.manifest).pushes
    contact_s = pushes[0].push.start_s if hit.contact_s is None and pushes else hit.contact_s or 0.0
    touches = _touches(hit, pushes, contact_s)
    rows = _samples(hit.time_s - contact_s, [touch["time"] for touch in touches])
    theta = hit["testbed.truth.theta"]
    x, y = hit["testbed.truth.x"], hit["testbed.truth.y"]

    def sampled(name: str) -> list[float]:
        return _rounded(hit[name][rows].astype(float))

    force = [hit[f"testbed.truth.contact_force_{axis}"] for axis in "xy"]
    point = [hit[f"testbed.truth.contact_point_{axis}"] for axis in "xy"]
    if hit.pushed().any():
        pushed_at = _to_world(hit, "testbed.push.point_x", "testbed.push.point_y", x, y, theta)
        point = [np.where(hit.pushed(), at, touched) for at, touched in zip(pushed_at, point, strict=True)]
        force = [total + hit[f"testbed.push.force_{axis}"] for total, axis in zip(force, "xy", strict=True)]
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
        "felt": {name: sampled(name) for name in FELT},
        "touches": touches,
    }


def motion(found: dict[str, Any]) -> dict[str, Any]:
    """A `scene` as the page's script takes it: traces by name, shapes by what they are."""
    named = {"x": found["base"][0], "y": found["base"][1], "theta": found["base"][2]}
    named |= {"nose_x": found["nose"][0], "nose_y": found["nose"][1], "bumper_compression": found["compression"]}
    named |= {f"contact_{what}_{axis}": found[what][k] for what in ("force", "point") for k, axis in enumerate("xy")}
    shape, plate_ = found["obstacle"], found["plate"]
    front = None if shape is None else shape["body"][0][0]
    noticed = [touch["detection"]["time"] for touch in found["touches"] if touch["detection"] is not None]
    return {
        "label": found["label"],
        "time": found["time"],
        "traces": {f"testbed.truth.{name}": values for name, values in named.items()} | found["felt"],
        "contact": found["touches"][0]["time"] if found["touches"] else None,
        "detected": min(noticed, default=None),
        "robot": {
            "outline": found["outline"],
            "wheel": found["wheel"],
            "obstacle": None
            if shape is None
            else {
                **{name: shape[name] for name in ("rail", "sprung", "front")},
                "radius": shape["radius"] or 0.0,
                "edge": shape["edge"] is not None,
                "body": front,
            },
            "plate": plate_,
        },
    }


def _touches(hit: Collision, pushes: Sequence[PushResponse], contact_s: float) -> list[dict[str, Any]]:
    """Hits and pushes with the robot's estimates, in the order of time."""
    found = []
    if hit.contact_s is not None:
        found.append({"what": "contact", "time": 0.0, "detection": _detection(hit, hit.detected, contact_s)})
    for one in pushes:
        row = None if one.detected_s is None else int(np.searchsorted(hit.time_s, one.detected_s))
        start_s = round(one.push.start_s - contact_s, DECIMALS)
        found.append({"what": "push", "time": start_s, "detection": _detection(hit, row, contact_s)})
    return sorted(found, key=lambda touch: float(touch["time"]))


def _samples(time_s: NDArray[np.float64], touches_s: Sequence[float]) -> NDArray[np.intp]:
    """Rows to show: every 2 ms around each hit or push, every 25 ms in the long escape."""
    step_s = float(time_s[1] - time_s[0])
    fine, coarse = (max(1, round(wanted / step_s)) for wanted in (IMPACT_STEP_S, ESCAPE_STEP_S))
    index = np.arange(len(time_s))
    near = np.any([(time_s >= at - LEAD_S) & (time_s < at + IMPACT_S) for at in (0.0, *touches_s)], axis=0)
    chosen = (near & (index % fine == 0)) | ((time_s >= IMPACT_S) & (index % coarse == 0))
    rows = np.flatnonzero(chosen)
    return rows if rows.size else index[::fine]


def _to_world(
    hit: Collision, name_x: str, name_y: str, x: Any, y: Any, theta: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    bx, by = hit[name_x], hit[name_y]
    return x + np.cos(theta) * bx - np.sin(theta) * by, y + np.sin(theta) * bx + np.cos(theta) * by


def _detection(hit: Collision, row: int | None, contact_s: float) -> dict[str, Any] | None:
    """Time and estimate of the detection in ``row``; point and force in the base frame, fixed on the robot."""
    if row is None:
        return None
    return {
        "time": round(float(hit.time_s[row] - contact_s), DECIMALS),
        "point": [round(float(hit[f"controller.detection.point_{axis}"][row]), DECIMALS) for axis in "xy"],
        "force": [round(float(hit[f"controller.detection.force_{axis}"][row]), 2) for axis in "xy"],
    }


def _rounded(values: NDArray[np.float64], decimals: int = DECIMALS) -> list[float]:
    return [float(value) for value in np.round(values, decimals)]
