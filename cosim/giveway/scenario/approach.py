"""The start of the collision dummy for a hit at a chosen point of the robot with a given speed.

The slider's nose is a disc on a straight rail. `meet` gives the testbed's ``slider.*`` parameters for a contact point
on the outline, a direction and a speed; for a moving robot its planned motion is taken into account. The robot itself
lags its plan by a few millimetres (compliance of servo and drivetrain), and so does the contact point.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.checks import finite, whole
from giveway.base.errors import GivewayError
from giveway.base.gravity import GRAVITY_MPS2
from giveway.robot.variables import Value
from giveway.scenario.plan import Plan, Rest
from giveway.scenario.stated_contact import StatedContact

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Numbers = NDArray[np.float64]

__all__ = [
    "Approach",
    "Approaches",
    "Meetings",
    "edge_middle",
    "meet",
    "meet_as_stated",
    "meet_many",
    "outline_of",
    "outward_normal",
    "outward_normals",
]

ON_OUTLINE_M = 1e-3  # robot files give corners to micrometres; users give points to millimetres
STILL_MPS = 1e-6
SAMPLE_S, SAMPLE_M = 1e-3, 4e-3  # a disc of 20 mm that grazes over 4 mm penetrates by 0.1 mm
SAMPLES_AT_ONCE = 200_000
LONGEST_RUN_UP_S = 60.0
ROPE = ("hanging_mass", "stiffness", "damping", "drop_height")
_SURFACE = Callable[["Numbers"], "Numbers"]


@dataclass(frozen=True)
class Approach:
    """The contact of slider and robot.

    Attributes:
        point_m: contact point on the robot's outline, base frame, m.
        speed_mps: speed of the slider along its rail at contact, m/s; 0: it stands still, and the robot runs into it.
        direction_rad: direction in which the slider travels (or, at rest, points), world frame, rad; None: straight
            into the robot's side.
        time_s: time of the contact, s. With the rope it follows from the run-up, and this must be None.
        rope: the hanging weight pulls the slider from rest; otherwise it slides freely from the start.
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
    """Motions along the rail that end at the given speeds, one per run.

    Attributes:
        start_mps, length_m, duration_s: start speed, travel and time to contact, shape (n,).
        travel: times of shape (k, n) from the start to travel in m, shape (k, n).
        refused: why a contact is not possible, by index of the run.
    """

    start_mps: Numbers
    length_m: Numbers
    duration_s: Numbers
    travel: _SURFACE
    refused: dict[int, GivewayError]


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
    point = np.array([point_m], dtype=np.float64)
    normals, found = outward_normals(outline, point)
    if not found[0]:
        raise _off_outline(outline, point[0])
    return np.asarray(normals[0])


def outward_normals(outline: Numbers, points_m: Numbers) -> tuple[Numbers, NDArray[np.bool_]]:
    """`outward_normal` of many points, shape (n, 2); and which points are on the outline, shape (n,)."""
    total = np.zeros(points_m.shape)
    for start, side in zip(outline, np.roll(outline, -1, axis=0) - outline, strict=True):
        near = _distance_to_segment(points_m, start, side) <= ON_OUTLINE_M
        total[near] += np.array([side[1], -side[0]]) / math.hypot(*side)
    length = np.hypot(*total.T)
    found = length > 0.0
    return total / np.where(found, length, 1.0)[:, None], found


def meet(
    approach: Approach, testbed: Mapping[str, Value], plan: Plan, path_start_s: float = 0.0
) -> dict[str, float | bool]:
    """The testbed's ``slider.*`` and ``rope.attached`` for ``approach``.

    Args:
        approach: the intended contact.
        testbed: all parameters of the testbed by name, including outline, slider mass and rope.
        plan: the robot's motion until then.
        path_start_s: when the plan's clock starts: after the controller's first tare, s.

    Raises:
        GivewayError: naming the impossible field of `Approach`: the point is not on the outline, slider and robot do
            not approach there, the weight cannot accelerate the slider to this speed, or they would touch earlier.
    """
    return meet_as_stated(approach, testbed, plan, path_start_s)[0]


def meet_as_stated(
    approach: Approach, testbed: Mapping[str, Value], plan: Plan, path_start_s: float = 0.0
) -> tuple[dict[str, float | bool], StatedContact, float]:
    """The result of `meet`, the intended contact, and its time, s (which also depends on the rope)."""
    direction_rad = math.nan if approach.direction_rad is None else approach.direction_rad
    many = Approaches(
        np.array([approach.point_m]),
        np.array([approach.speed_mps]),
        np.array([direction_rad]),
        None if approach.time_s is None else np.array([approach.time_s]),
    )
    met = meet_many(many, testbed, plan, np.array([path_start_s]))
    if met.refused:
        raise met.refused[0]
    slider = {
        "slider.present": True,
        **{name: float(values[0]) for name, values in met.slider.items()},
        "rope.attached": approach.rope,
    }
    stated = StatedContact(float(met.contact_speed_mps[0]), approach.point_m, approach.time_s)
    return slider, stated, float(met.time_s[0])


@dataclass(frozen=True)
class Approaches:
    """Many `Approach`, the fields as arrays over the runs.

    Attributes:
        point_m: shape (n, 2).
        speed_mps, direction_rad: shape (n,); a direction of NaN is straight into the robot's side.
        time_s: shape (n,); None with the rope.
    """

    point_m: Numbers
    speed_mps: Numbers
    direction_rad: Numbers
    time_s: Numbers | None


@dataclass(frozen=True)
class Meetings:
    """The contacts of many runs.

    Attributes:
        slider: the testbed's ``slider.*`` for the contacts, each of shape (n,).
        contact_speed_mps: of the nose relative to the base, shape (n,).
        time_s: of the contacts, shape (n,).
        refused: why a contact is not possible, by index of the run.
    """

    slider: dict[str, Numbers]
    contact_speed_mps: Numbers
    time_s: Numbers
    refused: dict[int, GivewayError]


def meet_many(
    approaches: Approaches, testbed: Mapping[str, Value | Numbers], plan: Plan, path_start_s: Numbers
) -> Meetings:
    """`meet` for n runs at once.

    ``testbed`` may hold arrays of shape (n,), but for the outline, which all runs share; ``path_start_s`` is one.
    """
    count = len(approaches.speed_mps)
    values = {name: np.broadcast_to(np.asarray(value, dtype=np.float64), count) for name, value in testbed.items()}
    outline = outline_of({name: float(values[name][0]) for name in testbed if name.startswith("outline.")})
    run_up = (_free if approaches.time_s is not None else _with_rope)(approaches, values)
    refused = dict(run_up.refused)
    mounted = np.flatnonzero((values["bumper.kind"] != 0.0) & (values["bumper.mount"] != 0.0))
    for index in mounted:
        allowed = "0: a bumper on the robot is in front of its outline"
        refused[int(index)] = GivewayError("bumper.mount", int(values["bumper.mount"][index]), allowed)
    normal, on_outline = outward_normals(outline, approaches.point_m)
    for index in np.flatnonzero(~on_outline):
        refused[int(index)] = _off_outline(outline, approaches.point_m[index])
    pose = _at(plan, run_up.duration_s - path_start_s)
    velocity, omega = pose[:, 3:5], pose[:, 5]
    cosine, sine = _each(math.cos, pose[:, 2]), _each(math.sin, pose[:, 2])
    arm, outward = _turned(cosine, sine, approaches.point_m), _turned(cosine, sine, normal)
    given = approaches.direction_rad
    straight = np.fromiter(map(math.atan2, -outward[:, 1], -outward[:, 0]), np.float64, count)
    direction = np.where(np.isnan(given), straight, given)
    along = np.stack([_each(math.cos, direction), _each(math.sin, direction)], axis=1)
    surface = velocity + omega[:, None] * np.stack([-arm[:, 1], arm[:, 0]], axis=1)
    closing = np.sum((approaches.speed_mps[:, None] * along - surface) * outward, axis=1)
    for index in np.flatnonzero(on_outline & (closing >= -STILL_MPS)):
        speed = float(approaches.speed_mps[index])
        allowed = "a direction and speed with which slider and robot approach each other at this point"
        found = float(given[index]) if speed > 0.0 and not math.isnan(given[index]) else speed
        refused.setdefault(int(index), GivewayError("direction_rad" if speed > 0.0 else "speed_mps", found, allowed))
    radius = values["contact.nose_radius"]
    centre = pose[:, 0:2] + arm + radius[:, None] * outward  # of the nose, when it touches
    target = centre + radius[:, None] * along
    if not isinstance(plan, Rest):  # a straight line enters a resting convex outline only once
        motion = _Nose(run_up, centre, along, radius)
        for run, time_s in _earlier_contacts(motion, outline, plan, path_start_s):
            when = f"touches the robot elsewhere before, at {time_s:.3g} s"
            error = GivewayError("point_m", f"a slider that {when}", "a point that the slider reaches first")
            refused.setdefault(run, error)
    met = {
        "slider.direction": np.fromiter((math.remainder(d, 2.0 * math.pi) for d in direction), np.float64, count),
        "slider.target_x": target[:, 0],
        "slider.target_y": target[:, 1],
        "slider.run_up": run_up.length_m,
        "slider.speed": run_up.start_mps,
    }
    relative = np.hypot(*(approaches.speed_mps[:, None] * along - velocity).T)
    return Meetings(met, relative, run_up.duration_s, refused)


def _each(function: Callable[[float], float], values: Numbers) -> Numbers:
    """``function`` of the math module: the same bits on every processor, alone and among many."""
    return np.fromiter(map(function, values), np.float64, len(values))


def _turned(cosine: Numbers, sine: Numbers, vectors: Numbers) -> Numbers:
    x, y = vectors.T
    return np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=1)


def _off_outline(outline: Numbers, point: Numbers) -> GivewayError:
    feet = [_foot(point, start, side) for start, side in zip(outline, np.roll(outline, -1, 0) - outline, strict=True)]
    nearest = min(feet, key=lambda foot: math.hypot(*(foot - point)))
    allowed = f"a point on the robot's outline; the nearest is [{nearest[0]:.3f}, {nearest[1]:.3f}]"
    return GivewayError("point_m", [float(value) for value in point], allowed)


def _free(approaches: Approaches, testbed: Mapping[str, Numbers]) -> _RunUp:
    """Without the rope: the start speeds that rail friction reduces to the given speeds at the given times."""
    assert approaches.time_s is not None
    mass = testbed["slider.mass"]
    end, duration = approaches.speed_mps, approaches.time_s
    moves = end > 0.0
    coulomb = np.where(moves, testbed["slider.friction"] / mass, 0.0)
    viscous = np.where(moves, testbed["slider.damping"] / mass, 0.0)
    # Backwards in time friction is growth: v' = a + c v, written with expm1 so that c may be small.
    small = viscous * duration < 1e-9
    rate = np.where(small, 1.0, viscous)
    grown = end + (end + coulomb / rate) * np.expm1(rate * duration)
    start = np.where(small, end + coulomb * duration, grown)

    def travel(time_s: Numbers) -> Numbers:
        slowing = -(start + coulomb / rate) * np.expm1(-rate * time_s) / rate - coulomb / rate * time_s
        return np.where(small, start * time_s - 0.5 * coulomb * time_s**2, slowing)

    return _RunUp(start, travel(duration[None, :])[0], duration, travel, {})


def _with_rope(approaches: Approaches, testbed: Mapping[str, Numbers]) -> _RunUp:
    """With the rope: slider and weight integrated from rest until the slider has the given speed."""
    names = ("slider.mass", "slider.friction", "slider.damping", *(f"rope.{name}" for name in ROPE))
    rows = np.stack([approaches.speed_mps, *(testbed[name] for name in names)], axis=1)
    # Most runs of a batch share theirs.
    different, which = np.unique(rows, axis=0, return_inverse=True)
    times, travels, refused = _pulled(different.tobytes(), len(different))
    which = which.ravel()
    reasons = {i: refused[int(k)] for i, k in enumerate(which) if int(k) in refused} if refused else {}

    def travel(time_s: Numbers) -> Numbers:
        columns = np.broadcast_to(time_s, (len(time_s), len(which))).T
        return np.stack([np.interp(t, times[:, k], travels[:, k]) for t, k in zip(columns, which, strict=True)], axis=1)

    start = np.zeros(len(which))
    return _RunUp(start, travels[-1, which], times[-1, which], travel, reasons)


@functools.lru_cache(maxsize=8)
def _pulled(packed: bytes, count: int) -> tuple[Numbers, Numbers, dict[int, GivewayError]]:
    """Times and travels of ``count`` run-ups on the rope, shape (steps, count); each ends in its last value.

    ``packed`` holds speed, slider mass, friction, damping and `ROPE`, shape (count, 9).
    """
    speed, slider, friction, viscous, weight, stiffness, damping, drop = np.frombuffer(packed).reshape(count, -1).T
    pull = weight * GRAVITY_MPS2

    def rate(state: Numbers) -> Numbers:
        s, s_rate, h, h_rate = state
        tension = np.maximum(0.0, pull + stiffness * (h - s) + damping * (h_rate - s_rate))
        return np.stack([
            s_rate, (tension - friction - viscous * s_rate) / slider, h_rate, GRAVITY_MPS2 - tension / weight,
        ])  # fmt: skip

    # Small against the rope's fastest motion, for the classical Runge-Kutta method.
    reduced = 1.0 / slider + 1.0 / weight
    fastest = np.minimum(0.3 / np.sqrt(stiffness * reduced), 1.0 / np.maximum(damping * reduced, 1e-9))
    step = np.minimum(1e-3, fastest)
    state, times, travels = np.zeros((4, count)), [np.zeros(count)], [np.zeros(count)]
    refused: dict[int, GivewayError] = {}
    pulling = state[1] < speed
    while pulling.any():
        for index in np.flatnonzero(
            pulling & ((pull <= friction) | (state[2] > drop) | (times[-1] > LONGEST_RUN_UP_S))
        ):
            allowed = f"a speed that the hanging weight reaches: at most {max(0.0, float(state[1, index])):.3g} m/s"
            refused[int(index)] = GivewayError("speed_mps", float(speed[index]), allowed)
            pulling[index] = False
        k1 = rate(state)
        k2 = rate(state + 0.5 * step * k1)
        k3 = rate(state + 0.5 * step * k2)
        k4 = rate(state + step * k3)
        after = state + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        ends = pulling & (after[1] >= speed)
        gain = np.where(ends, after[1] - state[1], 1.0)
        share = np.where(ends, (speed - state[1]) / gain, 1.0)  # of the last step
        times.append(np.where(pulling, times[-1] + share * step, times[-1]))
        travels.append(np.where(pulling, state[0] + share * (after[0] - state[0]), travels[-1]))
        state = np.where(pulling, after, state)
        pulling &= ~ends
    return np.array(times), np.array(travels), refused


def _at(plan: Plan, path_s: Numbers) -> Numbers:
    """Rows of the plan; before its clock starts the robot waits at its beginning."""
    return plan(np.maximum(path_s, 0.0))


@dataclass(frozen=True)
class _Nose:
    """Paths of the noses: run-up, centre at the contact (n, 2), unit vector along the rail (n, 2), radius (n,)."""

    run_up: _RunUp
    centre: Numbers
    along: Numbers
    radius: Numbers


def _earlier_contacts(nose: _Nose, outline: Numbers, plan: Plan, path_start_s: Numbers) -> Iterator[tuple[int, float]]:
    """The runs in which the nose touches the robot before it reaches the point, and the times."""
    duration = np.maximum(nose.run_up.duration_s - SAMPLE_S, 0.0)
    longest = float(duration.max(initial=0.0))
    way = _at(plan, np.arange(0.0, longest + SAMPLE_S, SAMPLE_S))[:, :3]
    moved = np.abs(np.diff(way, axis=0)).sum(axis=0) @ [1.0, 1.0, float(np.hypot(*outline.T).max())]
    moved += float(np.abs(nose.run_up.length_m).max(initial=0.0))
    samples = 1 + max(1, math.ceil(min(longest / SAMPLE_S, moved / SAMPLE_M)))
    time_s = np.linspace(0.0, 1.0, samples)[:, None] * duration
    travel = nose.run_up.travel(time_s) - nose.run_up.length_m
    runs = max(1, SAMPLES_AT_ONCE // samples)
    for first in range(0, len(duration), runs):
        part = slice(first, first + runs)
        poses = _at(plan, (time_s[:, part] - path_start_s[part]).ravel())
        centre = nose.centre[part] + travel[:, part, None] * nose.along[part]
        from_base = centre.reshape(-1, 2) - poses[:, :2]
        seen = _turned(np.cos(poses[:, 2]), -np.sin(poses[:, 2]), from_base)
        outside = _outside(outline, seen).reshape(samples, -1)
        touching = (outside < nose.radius[part] - ON_OUTLINE_M) & (duration[part] > 0.0)
        for index in np.flatnonzero(touching.any(axis=0)):
            yield first + int(index), float(time_s[touching[:, index].argmax(), first + index])


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


def _distance_to_segment(
    points: NDArray[np.float64], start: NDArray[np.float64], side: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Distances of points (n, 2), shape (n,)."""
    share = np.clip((points - start) @ side / (side @ side), 0.0, 1.0)
    return np.asarray(np.hypot(*(start + share[:, None] * side - points).T))
