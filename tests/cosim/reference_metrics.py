"""What a collision is judged by, written a second time: what the batch library's numbers are held against.

Nothing here uses the library, not even its windows. Each function's docstring is the definition of one number.

Traces are named as in the FMUs and lie on the grid of communication steps; contact starts at the plant's own event
time, so detection times resolve one step. "Base frame" is x forward, y left, fixed to the robot.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from giveway.library.recorded import Force
from giveway.scenario.body_regions import BodyRegion
from giveway.simulation.metrics import Metric

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

PEAK_WINDOW_S = 0.35
LOADED_SHARE = 0.5
CAUSE_WINDOW_S = 0.25
CONTACT_GAP_S = 0.1
TRANSIENT_S = 0.5
TRACKING, FAULT = 1, 6  # controller.mode
FIRST_PEAK = "peak force of the first contact"
PUSH_FORCES = ("testbed.push.force_x", "testbed.push.force_y")
WHEELS = 3
GRAVITY_MPS2 = 9.81  # the plant's


class Collision:
    """The first collision of a run, cut out of its traces.

    Attributes:
        time_s: shape (n,).
        contact_s: time of the first cover contact, None if there was none.
        detected: row of the first detection after contact, None if there was none.
    """

    def __init__(self, traces: xarray.Dataset, parameters: Mapping[str, Mapping[str, Any]]) -> None:
        self._traces = traces
        self._parameters = parameters
        self.time_s: NDArray[np.float64] = traces["time"].values
        first = float(traces["testbed.truth.first_contact_time"].values[-1])
        self.contact_s = first if first >= 0.0 else None
        self.detected = self._first_detection()

    def __getitem__(self, name: str) -> NDArray[Any]:
        values: NDArray[Any] = self._traces[name].values
        return values

    def pushed(self) -> NDArray[np.bool_]:
        """Rows with an external push; its traces are there only if the scenario has one."""
        none = np.zeros(len(self.time_s), dtype=np.bool_)
        forces = [self[name] for name in PUSH_FORCES if name in self._traces]
        return np.any([none, *(force != 0.0 for force in forces)], axis=0)  # type: ignore[no-any-return]

    def wheels(self, name: str) -> NDArray[np.float64]:
        """The traces ``name[0]`` to ``name[2]`` as shape (n, 3)."""
        return np.stack([self[f"{name}[{wheel}]"] for wheel in range(WHEELS)], axis=1)

    def _first_detection(self) -> int | None:
        if self.contact_s is None:
            return None
        count = self["controller.detection.count"]
        before = count[self.time_s < self.contact_s]
        rows = np.flatnonzero((self.time_s >= self.contact_s) & (count > (before[-1] if before.size else 0)))
        return int(rows[0]) if rows.size else None

    def force_base(self) -> NDArray[np.float64]:
        """True contact force on the robot in the base frame, N, shape (n, 2)."""
        theta = self["testbed.truth.theta"]
        fx, fy = self["testbed.truth.contact_force_x"], self["testbed.truth.contact_force_y"]
        cos, sin = np.cos(theta), np.sin(theta)
        return np.stack([cos * fx + sin * fy, -sin * fx + cos * fy], axis=1)

    def until_detection(self) -> slice:
        """Rows from contact to detection, both included (to the end if there was no detection)."""
        start = 0 if self.contact_s is None else int(np.searchsorted(self.time_s, self.contact_s))
        return slice(start, None if self.detected is None else self.detected + 1)

    def true_impulse(self) -> NDArray[np.float64]:
        """Impulse of the contact on the robot up to detection, base frame, N s, shape (2,).

        From the plant's own integral in the world frame, turned by the heading at detection.
        """
        row = -1 if self.detected is None else self.detected
        px, py = self["testbed.truth.contact_impulse_x"][row], self["testbed.truth.contact_impulse_y"][row]
        theta = self["testbed.truth.theta"][row]
        return np.array([math.cos(theta) * px + math.sin(theta) * py, -math.sin(theta) * px + math.cos(theta) * py])

    def true_point(self) -> NDArray[np.float64] | None:
        """Contact point on the robot in the base frame, m, shape (2,): mean up to detection, weighted by the force."""
        rows = self.until_detection()
        weight = self["testbed.truth.contact_force"][rows]
        if weight.sum() <= 0.0:
            return None
        points = np.stack([self["testbed.truth.contact_base_x"][rows], self["testbed.truth.contact_base_y"][rows]])
        return np.asarray(points @ weight / weight.sum())

    def loaded_wheels(self) -> dict[int, float]:
        """Wheels that carry the impact and the sign of the torque it makes there.

        At rest T = -J^-T F. A wheel counts if its share is at least half of the largest.
        """
        point, force = self.true_point(), self.true_impulse()
        if point is None:
            return {}
        parameters = self._parameters["testbed"]
        radius, distance = float(parameters["wheel.radius"]), float(parameters["wheel.distance"])
        azimuth = np.arange(WHEELS) * 2.0 * math.pi / 3.0
        moment = point[0] * force[1] - point[1] * force[0]
        rolling = -np.sin(azimuth) * force[0] + np.cos(azimuth) * force[1]
        torque = -radius * (2.0 / 3.0 * rolling + moment / (3.0 * distance))
        loaded = np.flatnonzero(np.abs(torque) >= LOADED_SHARE * np.abs(torque).max())
        return {int(wheel): float(np.sign(torque[wheel])) for wheel in loaded}

    # Numbers of the table

    def contact_speed(self) -> Metric:
        """Speed of the slider's nose relative to the robot at the last step before contact, m/s."""
        name = "contact speed"
        row = self.until_detection().start - 1
        if self.contact_s is None or row < 1:
            return Metric(name, None, "m/s")
        return Metric(name, self._nose_speed(row - 1), "m/s", decimals=3)

    def detection_time(self) -> Metric:
        """Time from the first cover contact to the controller's decision, all delays included, ms."""
        if self.contact_s is None or self.detected is None:
            return Metric("detection time", None, "ms")
        return Metric("detection time", 1e3 * (self.time_s[self.detected] - self.contact_s), "ms", decimals=1)

    def false_detections(self) -> Metric:
        """Detections with no true contact or push in the 0.25 s before them; one is late by design, not by more."""
        rows = np.flatnonzero(np.diff(self["controller.detection.count"], prepend=0) > 0)
        touched = self.time_s[self["testbed.truth.contact"] | self.pushed()]
        when = self.time_s[rows]
        caused = [bool(((touched >= t - CAUSE_WINDOW_S) & (touched <= t)).any()) for t in when]
        return Metric("false detections", float(len(caused) - sum(caused)), "1", 0.0, 0)

    def direction(self) -> Metric:
        """Direction of the detection's mean force against that of the true impulse up to detection, base frame, deg."""
        name = "force direction"
        if self.detected is None:
            return Metric(name, None, "deg")
        value = math.degrees(self["controller.detection.direction"][self.detected])
        px, py = self.true_impulse()
        truth = math.degrees(math.atan2(py, px))
        return Metric(name, truth + _wrapped(value - truth), "deg", truth, 1)

    def direction_error(self) -> Metric:
        """Estimated minus true direction of the force at detection, wrapped to [-180, 180), deg."""
        direction = self.direction()
        if direction.value is None or direction.truth is None:
            return Metric("direction error", None, "deg")
        return Metric("direction error", _wrapped(direction.value - direction.truth), "deg", 0.0, 1)

    def location(self) -> tuple[Metric, Metric, Metric]:
        """Contact point at detection against the force-weighted true one: base frame x, y and distance, mm."""
        names = ("contact point x", "contact point y", "location error")
        truth = self.true_point()
        if self.detected is None or truth is None:
            empty = [Metric(name, None, "mm") for name in names]
            return empty[0], empty[1], empty[2]
        x, y = (1e3 * float(self[f"controller.detection.point_{axis}"][self.detected]) for axis in "xy")
        true_x, true_y = 1e3 * truth
        return (
            Metric(names[0], x, "mm", true_x, 1),
            Metric(names[1], y, "mm", true_y, 1),
            Metric(names[2], math.hypot(x - true_x, y - true_y), "mm", 0.0, 1),
        )

    def magnitude(self) -> Metric:
        """Filtered force estimate at detection against the true contact force averaged over the same window, N.

        The average is of the force vector; the window ends at detection, so delays count as error.
        """
        name = "force at detection"
        if self.detected is None:
            return Metric(name, None, "N")
        window = max(1, round(self._window_s() / (self.time_s[1] - self.time_s[0])))
        rows = slice(max(0, self.detected + 1 - window), self.detected + 1)
        mean = self.force_base()[rows].mean(axis=0)
        return Metric(name, float(self["controller.estimate.force"][self.detected]), "N", math.hypot(*mean), 1)

    def _window_s(self) -> float:
        controller = self._parameters["controller"]
        return float(controller["estimator.average_window"]) * float(controller["controller.period"])

    def impulse(self) -> Metric:
        """Integral of the estimated force vector from contact to detection against the true impulse, N s."""
        name = "impulse at detection"
        if self.detected is None:
            return Metric(name, None, "N.s")
        rows = self.until_detection()
        step_s = self.time_s[1] - self.time_s[0]
        estimated = [self[f"controller.estimate.force_{axis}"][rows].sum() * step_s for axis in "xy"]
        return Metric(name, math.hypot(*estimated), "N.s", math.hypot(*self.true_impulse()))

    def peak_force(self) -> Metric:
        """Largest true contact force of the run, N."""
        return Metric("peak force of the run", float(self["testbed.truth.contact_force"].max()), "N", decimals=1)

    def peak_torque(self) -> Metric:
        """Largest wheel torque in the impact's direction within 0.35 s of contact, N m.

        True drivetrain torque of the wheels that carry the impact, signed so that the impact makes it positive:
        the paper's "positive" peak of experiment 5.2.
        """
        name = "peak wheel torque"
        wheels = self.loaded_wheels()
        if self.contact_s is None or not wheels:
            return Metric(name, None, "N.m")
        rows = (self.time_s >= self.contact_s) & (self.time_s <= self.contact_s + PEAK_WINDOW_S)
        torque = self.wheels("testbed.truth.wheel_torque")[rows]
        return Metric(name, max(float((sign * torque[:, wheel]).max()) for wheel, sign in wheels.items()), "N.m")

    def peak_torque_any(self) -> Metric:
        """Largest true drivetrain torque of any wheel, either sign, from contact on, N m."""
        name = "peak torque, any sign"
        if self.contact_s is None:
            return Metric(name, None, "N.m")
        rows = self.time_s >= self.contact_s
        return Metric(name, float(np.abs(self.wheels("testbed.truth.wheel_torque")[rows]).max()), "N.m")

    def escape(self) -> Metric:
        """Travel of the controller's reference from the last detection to the end, against the base's own travel, m.

        The last one, because every new hit starts the escape anew.
        """
        count = self["controller.detection.count"]
        if self.detected is None:
            return Metric("escape distance", None, "m")
        row = int(np.flatnonzero(np.diff(count) > 0)[-1]) + 1
        travel = [
            math.hypot(*(self[f"{source}.{axis}"][-1] - self[f"{source}.{axis}"][row] for axis in "xy"))
            for source in ("controller.reference", "testbed.truth")
        ]
        return Metric("escape distance", travel[0], "m", travel[1], 3)

    def bumper_compression(self) -> Metric:
        """Largest compression of the bumper, mm: what the collision used of its travel."""
        compression_m = float(self["testbed.truth.bumper_compression"].max())
        return Metric("bumper compression", 1e3 * compression_m, "mm", decimals=1)

    # What happened otherwise than asked

    def contact_time(self) -> Metric:
        """Time of the first cover contact, s."""
        return Metric("contact time", self.contact_s, "s", decimals=3)

    def first_contact(self) -> tuple[Metric, Metric]:
        """True contact point in the first row of the first contact, base frame, mm."""
        row = self.until_detection().start
        there = self.contact_s is not None and row < len(self.time_s) and bool(self["testbed.truth.contact"][row])
        x, y = (1e3 * float(self[f"testbed.truth.contact_base_{axis}"][row]) if there else None for axis in "xy")
        return Metric("first contact x", x, "mm", decimals=1), Metric("first contact y", y, "mm", decimals=1)

    def robot_speed(self) -> Metric:
        """Speed of the base in the last row before contact, m/s."""
        row = self.until_detection().start - 1
        there = self.contact_s is not None and row >= 0
        speed = math.hypot(*(self[f"testbed.truth.v{axis}"][row] for axis in "xy")) if there else None
        return Metric("robot speed at contact", speed, "m/s", decimals=3)

    def plan_deviation(self) -> tuple[Metric, Metric]:
        """Largest distance (mm) and angle (deg) of the controller's reference from the plan while it tracks, up to its
        first reaction: a plan within the reference's limits is followed exactly."""
        mode = self["controller.mode"]
        rows = (mode == TRACKING) & ~np.maximum.accumulate(mode > TRACKING)
        dx, dy, turned = (
            (self[f"controller.reference.{name}"] - self[f"controller.plan.{name}"])[rows]
            for name in ("x", "y", "theta")
        )
        away, turned = np.hypot(dx, dy), np.abs((np.degrees(turned) + 180.0) % 360.0 - 180.0)
        return (
            Metric("distance from the plan", 1e3 * float(away.max(initial=0.0)), "mm", decimals=1),
            Metric("angle from the plan", float(turned.max(initial=0.0)), "deg", decimals=1),
        )

    def saturation(self) -> tuple[Metric, Metric, Metric]:
        """Largest sensed torque over what counts as saturated, largest motor torque over its limit, both of any wheel
        as the rows show it, 1; and how long the controller was in its mode 6, sensor fault, s."""
        testbed, controller = self._parameters["testbed"], self._parameters["controller"]
        sensed_limit = min(float(testbed["electronics.torque_range"]), float(controller["sensor_check.torque_limit"]))
        sensed = float(np.abs(self.wheels("testbed.sensor.torque")).max()) / sensed_limit
        motor = float(np.abs(self.wheels("testbed.truth.motor_torque")).max()) / float(
            testbed["drivetrain.torque_limit"]
        )
        faulty = float((self["controller.mode"] == FAULT).sum()) * (self.time_s[1] - self.time_s[0])
        return (
            Metric("sensed torque share", sensed, "1"),
            Metric("motor torque share", motor, "1"),
            Metric("time in sensor fault", faulty, "s", decimals=3),
        )

    # Numbers of a design

    def person(self, region: BodyRegion | None) -> tuple[Metric, ...]:
        """Transient and lasting force (N), as `body_regions.judge`, the longest contact (s), and both forces' shares of
        the limits of ``region``. What lasts longer than 0.5 s is not known if the run ended within them."""
        judged = judge_force(self.time_s, self["testbed.truth.contact_force"])
        lasting = judged.lasting_n if judged.lasting_known else None
        shares: list[float | None] = [None, None]
        if region is not None:
            limit = region.peak_limit_n
            shares[0] = 0.0 if judged.transient_n == 0.0 else judged.transient_n / limit if limit > 0.0 else math.inf
            shares[1] = None if lasting is None else lasting / region.lasting_limit_n
        return (
            Metric("transient force", judged.transient_n, "N", decimals=1),
            Metric("lasting force", lasting, "N", decimals=1),
            Metric("longest contact", judged.longest_contact_s, "s", decimals=3),
            Metric("transient force share", shares[0], "1"),
            Metric("lasting force share", shares[1], "1"),
        )

    def bottoming_margin(self) -> Metric:
        """Travel that the bumper had left at its largest compression, mm; negative in the stop."""
        testbed = self._parameters["testbed"]
        left = float(testbed["bumper.travel"]) - float(self["testbed.truth.bumper_compression"].max())
        return Metric("bottoming margin", 1e3 * left if testbed["bumper.kind"] else None, "mm", decimals=1)

    def contacts(self) -> tuple[Metric, Metric, Metric]:
        """How many contacts there were, the largest true force of the first (N), and the speed of the nose relative to
        the robot after it (m/s). Touches less than 0.1 s apart are one contact: a bumper's plate bounces."""
        names = (("contacts", "1", 0), (FIRST_PEAK, "N", 1), ("rebound speed", "m/s", 3))
        if self.contact_s is None:
            empty = [Metric(name, None, unit, decimals=decimals) for name, unit, decimals in names]
            return empty[0], empty[1], empty[2]
        start = self.until_detection().start
        rows = start + np.flatnonzero(self["testbed.truth.contact"][start:])
        before = np.concatenate([[self.contact_s], self.time_s[rows][:-1]])
        number = 1 + np.cumsum(self.time_s[rows] - before[: len(rows)] >= CONTACT_GAP_S)
        first = rows[number == 1]
        count = float(number[-1]) if rows.size else 1.0
        peak = float(self["testbed.truth.contact_force"][first].max(initial=0.0))
        after = int(first[-1]) + 1 if first.size else start
        speed = self._nose_speed(after) if after + 1 < len(self.time_s) else None
        values = (count, peak, speed)
        found = [Metric(*name[:1], value, name[1], decimals=name[2]) for name, value in zip(names, values, strict=True)]
        return found[0], found[1], found[2]

    def _nose_speed(self, row: int) -> float:
        """Of the nose relative to the base from ``row`` to the next, m/s."""
        step_s = self.time_s[row + 1] - self.time_s[row]
        nose = [np.diff(self[f"testbed.truth.nose_{axis}"][row : row + 2])[0] / step_s for axis in "xy"]
        return math.hypot(*(nose[i] - self[f"testbed.truth.v{axis}"][row + 1] for i, axis in enumerate("xy")))

    def relatching(self) -> tuple[Metric, Metric]:
        """How often the magnet caught the plate again, and when first, ms after contact."""
        rows = np.flatnonzero(np.diff(self["testbed.truth.latched"].astype(np.int8)) > 0) + 1
        exists = self._parameters["testbed"]["bumper.kind"] and self.contact_s is not None
        first = 1e3 * (self.time_s[rows[0]] - self.contact_s) if exists and rows.size else None
        count = Metric("re-latches", float(len(rows)) if exists else None, "1", decimals=0)
        return count, Metric("re-latch time", first, "ms", decimals=1)

    def tip_margin(self) -> Metric:
        """Least tip margin of the run, 1: 1 level and at rest, 0 where a wheel lifts (or, with ``base.tipping``, the
        base goes over).

        On a plane from the centre of pressure of the wheel loads, which acceleration, contact force and push move:
        its distance to the nearest line between two wheels over that of the centre.
        """
        testbed = {name: float(value) for name, value in self._parameters["testbed"].items()}
        if testbed["base.tipping"]:
            return Metric("tip margin", min(1.0, float(self["testbed.truth.tip_margin"].min())), "1")
        none = np.zeros(len(self.time_s))
        weight = testbed["base.mass"] * GRAVITY_MPS2
        reach = []
        for axis in "xy":
            force, speed = self[f"testbed.truth.contact_force_{axis}"], self[f"testbed.truth.v{axis}"]
            name = f"testbed.push.force_{axis}"
            push = (self[name] if name in self._traces else none)[:-1]
            inertial = testbed["base.com_height"] * testbed["base.mass"] * np.diff(speed) / np.diff(self.time_s)
            moment = testbed["contact.height"] * 0.5 * (force[1:] + force[:-1]) + testbed["push.height"] * push
            reach.append((moment - inertial) / weight)
        theta = self["testbed.truth.theta"][1:]
        azimuth = (np.arange(WHEELS) * 2.0 * math.pi / 3.0)[:, None]
        # A line between two wheels is half a wheel distance from the centre, opposite to the third wheel.
        beyond = -(np.cos(azimuth + theta) * reach[0] + np.sin(azimuth + theta) * reach[1])
        farthest = max(0.0, float(beyond.max(initial=0.0)))
        return Metric("tip margin", 1.0 - farthest / (0.5 * testbed["wheel.distance"]), "1")

    def energy_residual(self) -> Metric:
        """Largest error of the energy balance (work in = stored + dissipated) over the largest energy in play, 1.

        Energy in play: work put in plus what was stored at the start and has been released.
        """
        stored, work = self["testbed.energy.stored"], self["testbed.energy.work_in"]
        scale = max(float(np.abs(work).max()), float(np.ptp(stored)), float(self["testbed.energy.dissipated"].max()))
        worst = float(np.abs(self["testbed.energy.residual"]).max())
        return Metric("energy residual", worst / scale if scale > 0.0 else worst, "1", 0.0, None)


def design(
    traces: xarray.Dataset, parameters: Mapping[str, Mapping[str, Any]], region: BodyRegion | None = None
) -> tuple[Metric, ...]:
    """What a bumper design is judged by beyond `collision`, and what happened otherwise than asked; a batch computes
    it natively."""
    hit = Collision(traces, parameters)
    return (
        *hit.person(region),
        hit.bottoming_margin(),
        hit.contacts()[2],
        *hit.relatching(),
        hit.tip_margin(),
        *hit.first_contact(),
        hit.robot_speed(),
        *hit.plan_deviation(),
        *hit.saturation(),
        hit.contact_time(),
    )


def collision(traces: xarray.Dataset, parameters: Mapping[str, Mapping[str, Any]]) -> tuple[Metric, ...]:
    """All metrics of the first collision in ``traces``, in the order of the table."""
    hit = Collision(traces, parameters)
    return (
        hit.contact_speed(),
        hit.false_detections(),
        hit.detection_time(),
        hit.direction(),
        hit.direction_error(),
        *hit.location(),
        hit.magnitude(),
        hit.impulse(),
        *_peaks(hit),
        hit.bumper_compression(),
        hit.peak_torque(),
        hit.peak_torque_any(),
        hit.escape(),
        hit.energy_residual(),
    )


def without_collision(traces: xarray.Dataset, parameters: Mapping[str, Mapping[str, Any]]) -> tuple[Metric, ...]:
    """The metrics of a run in which nothing can be hit, in the order of the table."""
    hit = Collision(traces, parameters)
    return hit.false_detections(), *hit.plan_deviation(), hit.energy_residual()


def judge_force(time_s: NDArray[np.float64], force_n: NDArray[np.float64], touch_n: float = 0.0) -> Force:
    """A contact begins when the force rises above ``touch_n`` and ends when it stays at or below it for 0.5 s."""
    transient = lasting = (0.0, None)
    longest = 0.0
    touching = np.flatnonzero(force_n > touch_n)
    groups = np.split(touching, np.flatnonzero(np.diff(time_s[touching]) >= TRANSIENT_S) + 1) if touching.size else []
    for rows in groups:
        since = time_s[rows] - time_s[rows[0]]
        longest = max(longest, float(since[-1]))
        transient = max(transient, _largest(time_s, force_n, rows[since <= TRANSIENT_S]), key=lambda found: found[0])
        lasting = max(lasting, _largest(time_s, force_n, rows[since > TRANSIENT_S]), key=lambda found: found[0])
    known = not touching.size or bool(time_s[-1] - time_s[touching[0]] > TRANSIENT_S)
    return Force(*transient, *lasting, longest, known)


def _largest(
    time_s: NDArray[np.float64], force_n: NDArray[np.float64], rows: NDArray[np.intp]
) -> tuple[float, float | None]:
    if not rows.size:
        return 0.0, None
    row = rows[force_n[rows].argmax()]
    return float(force_n[row]), float(time_s[row])


def _peaks(hit: Collision) -> tuple[Metric, Metric, Metric]:
    """How many contacts, the peak of the first and that of the run."""
    count, first, _ = hit.contacts()
    return count, first, hit.peak_force()


def _wrapped(degrees: float) -> float:
    """``degrees`` wrapped to [-180, 180)."""
    return (degrees + 180.0) % 360.0 - 180.0
