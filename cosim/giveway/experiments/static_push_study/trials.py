"""Static pushes on simulated robots with different rollers, and the controller's estimates of them.

The robot stands unpowered. After the tare the push grows smoothly, so that the drivetrains do not oscillate, and is
held; the estimate is read when it has settled.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from giveway import batch
from giveway.base.errors import SimulationError
from giveway.base.gravity import GRAVITY_MPS2
from giveway.robot.presets import NO_REFLEX, PAPER
from giveway.robot.wheels import WHEELS
from giveway.scenario.scenario import Scenario

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.experiments.static_push_study.placements import Placement
    from giveway.identification.presliding import KnownPush
    from giveway.robot.variables import Value

__all__ = ["Readings", "SteadyPush", "Trial", "run_trials"]

TARE_S, RISE_S, SETTLE_S, READ_S = 0.13, 0.3, 0.07, 0.1
DURATION_S = TARE_S + RISE_S + SETTLE_S + READ_S
STEP_S = 1e-3
WEIGHT_N = 1.0 * GRAVITY_MPS2
"""The push: the weight of 1 kg. The paper calls it 10 N."""
# Unpowered, as in 5.1. A detection would change the plan that the estimate is made against, so there is none; the
# estimate is averaged over the time in which it is read.
CONTROLLER: Mapping[str, Value] = {
    "controller.drives_enabled": False,
    **NO_REFLEX,
    "estimator.average_window": round(READ_S / STEP_S),
}
TORQUES = tuple(f"testbed.sensor.torque[{wheel}]" for wheel in range(WHEELS))
ESTIMATES = ("force", "direction", "point_x", "point_y", "on_outline", "valid")
AT_ONCE = 256  # runs whose traces are in memory together: some 10 MB


@dataclass(frozen=True)
class SteadyPush:
    """A constant force (N) on the robot at a point of the base frame, from TARE_S on, grown over RISE_S.

    The robot starts at heading 0 and turns by less than a milliradian: the world frame of the push is its base frame.
    """

    placement: Placement
    force_n: float = WEIGHT_N

    def __call__(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        share = np.clip((time_s - TARE_S) / RISE_S, 0.0, 1.0)
        force = self.force_n * 0.5 * (1.0 - np.cos(np.pi * share))
        at, direction = self.placement, self.placement.direction_rad
        ones = np.ones_like(time_s)
        return np.stack(
            [force * math.cos(direction), force * math.sin(direction), at.x_m * ones, at.y_m * ones], axis=1
        )


@dataclass(frozen=True)
class Trial:
    """One push on one robot.

    Attributes:
        placement: point and direction.
        stiffness_n_per_m: presliding stiffness of each wheel's roller: the robot.
        roller_load_n: load that earlier motion left in each roller, along the wheel's radial direction.
        seed: of the sensor noise.
        zero_drift_nm: drift of the zeros of the three torque signals since the tare; only without roller loads.
        controller: parameter overrides in addition to those of every trial.
    """

    placement: Placement
    stiffness_n_per_m: tuple[float, float, float]
    roller_load_n: tuple[float, float, float] = (0.0, 0.0, 0.0)
    seed: int = 1
    zero_drift_nm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    controller: Mapping[str, Value] = field(default_factory=dict)

    def scenario(self) -> Scenario:
        """The run."""
        testbed: dict[str, Value] = {"slider.present": False}
        for wheel, (stiffness, load) in enumerate(zip(self.stiffness_n_per_m, self.roller_load_n, strict=True)):
            testbed[f"roller.presliding_stiffness[{wheel}]"] = stiffness
            testbed[f"start.bristle[{wheel}]"] = load / stiffness
        controller = {**CONTROLLER, **self.controller}
        if any(self.zero_drift_nm):
            # Without a tare an offset has the effect of a drift since the tare.
            controller["estimator.tare_ticks"] = 0
            testbed |= {f"electronics.torque_offset[{wheel}]": drift for wheel, drift in enumerate(self.zero_drift_nm)}
        push = SteadyPush(self.placement)
        return Scenario(
            "static push",
            DURATION_S,
            STEP_S,
            testbed=testbed,
            controller=controller,
            push=push,
            seed=self.seed,
            preset=PAPER,
        )


@dataclass(frozen=True)
class Readings:
    """The controller's estimates for each trial, and their errors.

    Attributes:
        trials: n of them.
        force_n: estimated magnitude, shape (n,).
        direction_rad: estimated direction, base frame, shape (n,).
        point_m: estimated contact point, base frame, shape (n, 2).
        on_outline: the zero-moment line crosses the outline, shape (n,); else the point is the nearest one.
        torque_nm: change of the sensed torques, mean while read minus mean of the tare, shape (n, 3).
    """

    trials: Sequence[Trial]
    force_n: NDArray[np.float64]
    direction_rad: NDArray[np.float64]
    point_m: NDArray[np.float64]
    on_outline: NDArray[np.bool_]
    torque_nm: NDArray[np.float64]

    @property
    def true_point_m(self) -> NDArray[np.float64]:
        """Shape (n, 2)."""
        return np.array([(trial.placement.x_m, trial.placement.y_m) for trial in self.trials]).reshape(-1, 2)

    @property
    def true_direction_rad(self) -> NDArray[np.float64]:
        """Shape (n,)."""
        return np.array([trial.placement.direction_rad for trial in self.trials])

    @property
    def magnitude_error_percent(self) -> NDArray[np.float64]:
        """Of the true 9.81 N, signed, shape (n,)."""
        return 100.0 * (self.force_n / WEIGHT_N - 1.0)

    @property
    def direction_error_deg(self) -> NDArray[np.float64]:
        """Signed, counter-clockwise positive, shape (n,)."""
        turned = self.direction_rad - self.true_direction_rad
        return np.degrees(np.arctan2(np.sin(turned), np.cos(turned)))

    @property
    def location_error_cm(self) -> NDArray[np.float64]:
        """Distance of the estimated from the true point, shape (n,)."""
        return np.asarray(100.0 * np.hypot(*(self.point_m - self.true_point_m).T))

    def known_push(self, index: int) -> KnownPush:
        """Trial ``index`` as a push for `giveway.identification.presliding.calibrate`."""
        from giveway.identification.presliding import KnownPush

        at = self.trials[index].placement
        force = (WEIGHT_N * math.cos(at.direction_rad), WEIGHT_N * math.sin(at.direction_rad))
        torque = self.torque_nm[index]
        return KnownPush(force, (at.x_m, at.y_m), (float(torque[0]), float(torque[1]), float(torque[2])))


def run_trials(trials: Sequence[Trial], threads: int, progress: Callable[[int], None] = lambda _done: None) -> Readings:
    """Run ``trials`` natively in ``threads`` threads; ``progress`` gets the number of finished trials.

    SimulationError if a run fails, or a push is so weak that the controller does not locate it.
    """
    names = [f"controller.estimate.{name}" for name in ESTIMATES]
    parts: dict[str, list[NDArray[Any]]] = {name: [] for name in (*names, "torque")}
    for first in range(0, len(trials), AT_ONCE):
        chunk = [trial.scenario() for trial in trials[first : first + AT_ONCE]]
        table = batch.run_many(chunk, threads=threads, traces=[*names, *TORQUES])
        if table.attrs["interrupted"]:
            raise KeyboardInterrupt
        for status, message in zip(table["status"].values, table["message"].values, strict=True):
            if status != "ok":
                raise SimulationError("static push", f"{status}: {message}", DURATION_S)
        for name in names:
            parts[name].append(table[name].values[:, -1])
        torque = np.stack([table[name].values for name in TORQUES], axis=2)
        before = slice(round((TARE_S - READ_S) / STEP_S), round(TARE_S / STEP_S))
        read = slice(-round(READ_S / STEP_S), None)
        parts["torque"].append(torque[:, read].mean(axis=1) - torque[:, before].mean(axis=1))
        progress(min(first + AT_ONCE, len(trials)))
    force, direction, x, y, on_outline, valid = (np.concatenate(parts[name]) for name in names)
    if not valid.all():
        raise SimulationError("static push", f"{int((~valid).sum())} pushes were too weak to be located", DURATION_S)
    points = np.stack([x, y], axis=1)
    return Readings(trials, force, direction, points, on_outline, np.concatenate(parts["torque"]))
