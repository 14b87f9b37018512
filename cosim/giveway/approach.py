"""Where the collision dummy has to start so that it meets a chosen point of the robot, as fast as asked.

The slider's nose is a disc on a straight rail. `meet` gives the testbed's ``slider.*`` parameters for a contact point
on the outline, a direction and a speed; a robot that moves along its plan is led. The robot itself lags its plan by a
few millimetres (servo and drivetrain give), and so does the contact point.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway.checks import finite, whole
from giveway.errors import GivewayError
from giveway.variables import Value

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.plan import Plan

__all__ = ["Approach", "edge_middle", "meet", "outline_of", "outward_normal"]

GRAVITY = 9.81  # the plant's
ON_OUTLINE_M = 1e-3  # robot files state corners to micrometres; users state points to millimetres
STILL_MPS = 1e-6
SAMPLE_S = 1e-3
LONGEST_RUN_UP_S = 60.0
_SURFACE = Callable[["NDArray[np.float64]"], "NDArray[np.float64]"]


@dataclass(frozen=True)
class Approach:
    """How slider and robot meet.

    Attributes:
        point_m: contact point on the robot's outline, base frame, m.
        speed_mps: speed of the slider along its rail at contact, m/s; 0: it stands, and the robot runs into it.
        direction_rad: direction in which the slider travels (or, at rest, points), world frame, rad; None: straight
            into the robot's side.
        time_s: when they meet, s. With the rope, the run-up takes as long as it takes, and this must be None.
        rope: the hanging weight pulls the slider from rest; else it slides freely from the start.
    """

    point_m: tuple[float, float]
    speed_mps: float
    direction_rad: float | None = None
    time_s: float | None = None
    rope: bool = False

    def __post_init__(self) -> None:
        finite("speed_mps", self.speed_mps, 0.0, 20.0, "m/s")
        if self.direction_rad is not None:
            finite("direction_rad", self.direction_rad, -10.0, 10.0, "rad")
        if self.rope and self.time_s is not None:
            raise GivewayError(
                "time_s", self.time_s, "none with the rope: the weight decides how long the run-up takes"
            )
        if self.rope and self.speed_mps <= 0.0:
            raise GivewayError("speed_mps", self.speed_mps, "above 0 m/s with the rope: the weight pulls the slider")
        if not self.rope:
            finite("time_s", self.time_s, 0.0, LONGEST_RUN_UP_S, "s")


@dataclass(frozen=True)
class _RunUp:
    """A way along the rail that ends at the asked speed.

    Attributes:
        start_mps, length_m, duration_s: start speed, travel and time to contact.
        travel: times of shape (n,) from the start to travel in m, shape (n,).
    """

    start_mps: float
    length_m: float
    duration_s: float
    travel: _SURFACE


def outline_of(testbed: Mapping[str, Value]) -> NDArray[np.float64]:
    """Corners of the robot, base frame, m, anticlockwise, shape (n, 2), from the testbed's parameters."""
    count = int(testbed["outline.count"])
    return np.array([[float(testbed[f"outline.{axis}[{i}]"]) for axis in "xy"] for i in range(count)])


def edge_middle(outline: NDArray[np.float64], edge: int, offset_m: float = 0.0) -> tuple[float, float]:
    """The point ``offset_m`` (m, towards the next corner) from the middle of ``edge``, which starts at that corner."""
    whole("edge", edge, 0, len(outline) - 1)
    start, end = outline[edge], outline[(edge + 1) % len(outline)]
    along = end - start
    length = math.hypot(*along)
    finite("offset_m", offset_m, -0.5 * length, 0.5 * length, "m")
    point = 0.5 * (start + end) + along * (offset_m / length)
    return float(point[0]), float(point[1])


def outward_normal(outline: NDArray[np.float64], point_m: tuple[float, float]) -> NDArray[np.float64]:
    """Outward unit normal of the outline at ``point_m`` (base frame, m, on the outline to 1 mm), shape (2,).

    At a corner it is the mean of the two sides'.
    """
    point = np.asarray(point_m, dtype=np.float64)
    normals = [
        np.array([side[1], -side[0]]) / math.hypot(*side)
        for start, side in zip(outline, np.roll(outline, -1, axis=0) - outline, strict=True)
        if _distance_to_segment(point, start, side) <= ON_OUTLINE_M
    ]
    if not normals:
        nearest = min(
            (
                _foot(point, start, side)
                for start, side in zip(outline, np.roll(outline, -1, axis=0) - outline, strict=True)
            ),
            key=lambda foot: math.hypot(*(foot - point)),
        )
        allowed = f"a point on the robot's outline; the nearest is [{nearest[0]:.3f}, {nearest[1]:.3f}]"
        raise GivewayError("point_m", [float(value) for value in point], allowed)
    mean = np.sum(normals, axis=0)
    return np.asarray(mean / math.hypot(*mean))


def meet(
    approach: Approach, testbed: Mapping[str, Value], plan: Plan, path_start_s: float = 0.0
) -> dict[str, float | bool]:
    """The testbed's ``slider.*`` and ``rope.attached`` for ``approach``.

    Args:
        approach: where and how they shall meet.
        testbed: all parameters of the testbed by name, outline, slider mass and rope among them.
        plan: the robot's motion until then.
        path_start_s: when the plan's clock starts: after the controller's first tare, s.

    Raises:
        GivewayError: naming the field of `Approach` that cannot be met: the point is not on the outline, slider and
            robot do not approach there, the weight cannot make the slider so fast, or they would touch before.
    """
    if testbed["bumper.kind"] != 0 and testbed["bumper.mount"] != 0:
        raise GivewayError(
            "bumper.mount", testbed["bumper.mount"], "0: a bumper on the robot is in front of its outline"
        )
    outline = outline_of(testbed)
    normal = outward_normal(outline, approach.point_m)
    run_up = _with_rope(approach, testbed) if approach.rope else _free(approach, testbed)
    x, y, theta, vx, vy, omega = (float(value) for value in _at(plan, run_up.duration_s - path_start_s)[0, :6])
    turn = np.array([[math.cos(theta), -math.sin(theta)], [math.sin(theta), math.cos(theta)]])
    arm, outward = turn @ np.asarray(approach.point_m), turn @ normal
    direction_rad = approach.direction_rad
    if direction_rad is None:
        direction_rad = math.atan2(-outward[1], -outward[0])
    along = np.array([math.cos(direction_rad), math.sin(direction_rad)])
    surface = np.array([vx - omega * arm[1], vy + omega * arm[0]])
    if float((approach.speed_mps * along - surface) @ outward) >= -STILL_MPS:
        allowed = "a direction and speed with which slider and robot approach each other at this point"
        raise GivewayError("direction_rad" if approach.speed_mps > 0.0 else "speed_mps", _given(approach), allowed)
    radius = float(testbed["contact.nose_radius"])
    centre = np.array([x, y]) + arm + radius * outward  # of the nose, when it touches
    target = centre + radius * along
    _refuse_earlier_contact(run_up, centre, along, radius, outline, plan, path_start_s)
    return {
        "slider.present": True,
        "slider.direction": math.remainder(direction_rad, 2.0 * math.pi),
        "slider.target_x": float(target[0]),
        "slider.target_y": float(target[1]),
        "slider.run_up": run_up.length_m,
        "slider.speed": run_up.start_mps,
        "rope.attached": approach.rope,
    }


def _given(approach: Approach) -> float:
    if approach.speed_mps > 0.0 and approach.direction_rad is not None:
        return approach.direction_rad
    return approach.speed_mps


def _free(approach: Approach, testbed: Mapping[str, Value]) -> _RunUp:
    """Without the rope: the start speed that rail friction brings down to the asked one at the asked time."""
    assert approach.time_s is not None
    mass = float(testbed["slider.mass"])
    coulomb, viscous = float(testbed["slider.friction"]) / mass, float(testbed["slider.damping"]) / mass
    end, duration = approach.speed_mps, approach.time_s
    if end == 0.0:
        return _RunUp(0.0, 0.0, duration, np.zeros_like)
    # Backwards in time friction is growth: v' = a + c v, written with expm1 so that c may be small.
    if viscous * duration < 1e-9:
        start = end + coulomb * duration
    else:
        start = end + (end + coulomb / viscous) * math.expm1(viscous * duration)

    def travel(time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        if viscous * duration < 1e-9:
            return np.asarray(start * time_s - 0.5 * coulomb * time_s**2)
        return np.asarray(
            -(start + coulomb / viscous) * np.expm1(-viscous * time_s) / viscous - coulomb / viscous * time_s
        )

    return _RunUp(start, float(travel(np.array([duration]))[0]), duration, travel)


def _with_rope(approach: Approach, testbed: Mapping[str, Value]) -> _RunUp:
    """With the rope: slider and weight integrated from rest until the slider is as fast as asked."""
    slider, weight = float(testbed["slider.mass"]), float(testbed["rope.hanging_mass"])
    friction, viscous = float(testbed["slider.friction"]), float(testbed["slider.damping"])
    stiffness, damping = float(testbed["rope.stiffness"]), float(testbed["rope.damping"])
    pull = weight * GRAVITY

    def rate(state: NDArray[np.float64]) -> NDArray[np.float64]:
        s, s_rate, h, h_rate = state
        tension = max(0.0, pull + stiffness * (h - s) + damping * (h_rate - s_rate))
        return np.array([
            s_rate, (tension - friction - viscous * s_rate) / slider, h_rate, GRAVITY - tension / weight,
        ])  # fmt: skip

    # Small against the rope's fastest motion, for the classical Runge-Kutta method.
    reduced = 1.0 / slider + 1.0 / weight
    step = min(1e-3, 0.3 / math.sqrt(stiffness * reduced), 1.0 / max(damping * reduced, 1e-9))
    drop = float(testbed["rope.drop_height"])
    state, times, travels = np.zeros(4), [0.0], [0.0]
    while state[1] < approach.speed_mps:
        if pull <= friction or state[2] > drop or times[-1] > LONGEST_RUN_UP_S:
            allowed = f"a speed that the hanging weight reaches: at most {max(0.0, float(state[1])):.3g} m/s"
            raise GivewayError("speed_mps", approach.speed_mps, allowed)
        before = state
        k1 = rate(state)
        k2 = rate(state + 0.5 * step * k1)
        k3 = rate(state + 0.5 * step * k2)
        k4 = rate(state + step * k3)
        state = state + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        times.append(times[-1] + step)
        travels.append(float(state[0]))
    share = (approach.speed_mps - before[1]) / (state[1] - before[1])  # of the last step
    times[-1] += (share - 1.0) * step
    travels[-1] = float(before[0] + share * (state[0] - before[0]))
    known_times, known_travels = np.array(times), np.array(travels)
    return _RunUp(0.0, travels[-1], times[-1], lambda time_s: np.interp(time_s, known_times, known_travels))


def _at(plan: Plan, path_s: float | NDArray[np.float64]) -> NDArray[np.float64]:
    """Rows of the plan; before its clock starts the robot waits at its beginning."""
    return plan(np.maximum(np.atleast_1d(np.asarray(path_s, dtype=np.float64)), 0.0))


def _refuse_earlier_contact(
    run_up: _RunUp,
    centre: NDArray[np.float64],
    along: NDArray[np.float64],
    radius: float,
    outline: NDArray[np.float64],
    plan: Plan,
    path_start_s: float,
) -> None:
    """The nose must be outside the robot from the start until it meets the point."""
    time_s = np.arange(0.0, run_up.duration_s - SAMPLE_S, SAMPLE_S)
    poses = _at(plan, time_s - path_start_s)
    nose = centre + (run_up.travel(time_s) - run_up.length_m)[:, None] * along - poses[:, :2]
    cosine, sine = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    seen = np.stack([cosine * nose[:, 0] + sine * nose[:, 1], -sine * nose[:, 0] + cosine * nose[:, 1]], axis=1)
    touching = np.flatnonzero(_outside(outline, seen) < radius - ON_OUTLINE_M)
    if touching.size:
        when = f"touches the robot elsewhere before, at {time_s[touching[0]]:.3g} s"
        raise GivewayError("point_m", f"a slider that {when}", "a point that the slider reaches first")


def _outside(outline: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distance of points (n, 2) from the convex outline; 0 inside."""
    distance = np.full(len(points), np.inf)
    inside = np.ones(len(points), dtype=bool)
    for start, side in zip(outline, np.roll(outline, -1, axis=0) - outline, strict=True):
        from_start = points - start
        inside &= side[0] * from_start[:, 1] - side[1] * from_start[:, 0] > 0.0
        share = np.clip(from_start @ side / (side @ side), 0.0, 1.0)
        distance = np.minimum(distance, np.hypot(*(from_start - share[:, None] * side).T))
    return np.where(inside, 0.0, distance)


def _foot(point: NDArray[np.float64], start: NDArray[np.float64], side: NDArray[np.float64]) -> NDArray[np.float64]:
    """The point of a segment that is closest to ``point``."""
    share = float(np.clip((point - start) @ side / (side @ side), 0.0, 1.0))
    return np.asarray(start + share * side)


def _distance_to_segment(point: NDArray[np.float64], start: NDArray[np.float64], side: NDArray[np.float64]) -> float:
    return math.hypot(*(_foot(point, start, side) - point))
