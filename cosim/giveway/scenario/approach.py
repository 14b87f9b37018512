"""The start of the collision dummy for a hit at a chosen point of the robot with a given speed.

The slider's nose is a disc on a straight rail. `meet` gives the testbed's ``slider.*`` parameters for a contact point
on the outline, a direction and a speed; for a moving robot its planned motion is taken into account. The robot itself
lags its plan by a few millimetres (compliance of servo and drivetrain), and so does the contact point.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway.base.checks import finite, whole
from giveway.base.errors import GivewayError
from giveway.library.batch_library import OK, REFUSED, WRONG
from giveway.library.run_up import LONGEST_RUN_UP_S, RUN_UP, find_run_ups
from giveway.robot.variables import Value, table
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
START_M = 1e-6  # a nose that starts deeper in the robot is refused by the testbed
STILL_MPS = 1e-6
SAMPLE_S, SAMPLE_M = 1e-3, 4e-3  # a disc of 20 mm that grazes over 4 mm penetrates by 0.1 mm
SAMPLES_AT_ONCE = 200_000
# What the run-up depends on, of the testbed.
SLIDER = ("mass", "friction", "friction_speed", "damping")
ROPE = ("hanging_mass", "stiffness", "damping", "drop_height")


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
    """Motions along the rail that end at the asked speeds, one per run, as the batch library finds them.

    Attributes:
        start_mps, length_m, duration_s: start speed, travel and time to contact, shape (n,).
        different, which: the answers (`RUN_UP`), each once, and that of each run, shape (n,).
        refused: why a contact is not possible, by index of the run.
    """

    start_mps: Numbers
    length_m: Numbers
    duration_s: Numbers
    different: NDArray[Any]
    which: NDArray[np.intp]
    refused: dict[int, GivewayError]

    def sampled(self, shares: Numbers, before_s: float) -> tuple[Numbers, Numbers]:
        """Times and travels from the start, shape (k, n), at ``shares`` (k,) of the time to ``before_s`` before it."""
        times = np.maximum(self.different["duration_s"] - before_s, 0.0)[:, None] * shares
        travels = find_run_ups(self.different.copy(), times)
        return times[self.which].T, travels[self.which].T


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

    def of_each(name: str) -> Numbers:
        return np.broadcast_to(np.asarray(testbed[name], dtype=np.float64), count)

    outline = outline_of({name: float(of_each(name)[0]) for name in testbed if name.startswith("outline.")})
    run_up = _run_ups(approaches, of_each)
    refused = dict(run_up.refused)
    mount = of_each("bumper.mount")
    for index in np.flatnonzero((of_each("bumper.kind") != 0.0) & (mount != 0.0)):
        allowed = "0: a bumper on the robot is in front of its outline"
        refused[int(index)] = GivewayError("bumper.mount", int(mount[index]), allowed)
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
    radius = of_each("contact.nose_radius")
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


def _run_ups(approaches: Approaches, of_each: Callable[[str], Numbers]) -> _RunUp:
    """With the rope from rest until the slider is as fast as asked; without, until the rail has slowed it so far.

    ``of_each``: a parameter of the testbed by name, shape (n,).
    """
    rope = approaches.time_s is None
    duration = np.zeros(len(approaches.speed_mps)) if approaches.time_s is None else approaches.time_s
    names = [*(f"slider.{name}" for name in SLIDER), *(f"rope.{name}" for name in ROPE)]
    rows = np.stack([approaches.speed_mps, duration, *map(of_each, names)], axis=1)
    # Most runs of a batch share theirs.
    each, which = np.unique(rows, axis=0, return_inverse=True)
    which = which.ravel()
    different = np.zeros(len(each), dtype=RUN_UP)
    for name, column in zip(("end_speed_mps", "duration_s", *names), each.T, strict=True):
        different[name] = column
    different["rope.attached"] = rope
    find_run_ups(different)
    reasons = {int(index): _refusal(different[index]) for index in np.flatnonzero(different["status"] != OK)}
    refused = {run: reasons[int(index)] for run, index in enumerate(which) if int(index) in reasons} if reasons else {}
    found = different[which]
    return _RunUp(found["start_speed_mps"], found["travel_m"], found["duration_s"], different, which, refused)


def _refusal(run_up: np.void) -> GivewayError:
    """Why the library finds no start."""
    speed = float(run_up["end_speed_mps"])
    if run_up["status"] == WRONG:
        for variable in (table("testbed")[name] for name in (run_up.dtype.names or ()) if "." in name):
            low, high = variable.minimum, variable.maximum
            value = float(run_up[variable.name])
            if low is not None and high is not None and not low <= value <= high:
                return GivewayError(variable.name, value, f"{low:g} to {high:g}")
        return GivewayError("speed_mps", speed, "0 to 20 m/s, with the rope above 0, and a time of 0 to 60 s")
    if run_up["status"] == REFUSED and run_up["rope.attached"]:
        reached = max(0.0, float(run_up["reached_mps"]))
        return GivewayError("speed_mps", speed, f"a speed that the hanging weight reaches: at most {reached:.3g} m/s")
    if run_up["status"] == REFUSED:
        allowed = "a time for which the rail's friction does not ask for a start at more than 1000 m/s"
        return GivewayError("time_s", float(run_up["duration_s"]), allowed)
    return GivewayError("speed_mps", speed, "a run-up whose equations can be integrated")


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
    path = _at(plan, np.arange(0.0, longest + SAMPLE_S, SAMPLE_S))[:, :3]
    moved = np.abs(np.diff(path, axis=0)).sum(axis=0) @ [1.0, 1.0, float(np.hypot(*outline.T).max())]
    moved += float(np.abs(nose.run_up.length_m).max(initial=0.0))
    samples = 1 + max(1, math.ceil(min(longest / SAMPLE_S, moved / SAMPLE_M)))
    time_s, travel = nose.run_up.sampled(np.linspace(0.0, 1.0, samples), SAMPLE_S)
    travel -= nose.run_up.length_m
    runs = max(1, SAMPLES_AT_ONCE // samples)
    for first in range(0, len(duration), runs):
        part = slice(first, first + runs)
        poses = _at(plan, (time_s[:, part] - path_start_s[part]).ravel())
        centre = nose.centre[part] + travel[:, part, None] * nose.along[part]
        from_base = centre.reshape(-1, 2) - poses[:, :2]
        seen = _turned(np.cos(poses[:, 2]), -np.sin(poses[:, 2]), from_base)
        outside = _outside(outline, seen).reshape(samples, -1)
        allowed_m = np.where(time_s[:, part] > 0.0, ON_OUTLINE_M, START_M)
        touching = (outside < nose.radius[part] - allowed_m) & (duration[part] > 0.0)
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
