"""All runs of the static-push study: before and after compensation, and two further cases."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from giveway.experiments.static_push_study.groups import GROUP
from giveway.experiments.static_push_study.robots import PushedRobot, pushed_robot, roller_loads
from giveway.experiments.static_push_study.trials import Readings, Trial, run_trials
from giveway.identification.presliding import Calibration, calibrate
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["KNOWN_PUSHES", "Sizes", "Study", "run_study"]

SEED = 52
KNOWN_PUSHES = 3  # number of pushes to calibrate a robot with


@dataclass(frozen=True)
class Sizes:
    """The size of a study.

    Attributes:
        robots: at least 1.
        pushes: random ones on each, a multiple of four.
        threads: native threads.
    """

    robots: int
    pushes: int
    threads: int


@dataclass(frozen=True)
class Study:
    """The results. Readings of all robots are ordered by robot.

    Attributes:
        robots: the robots and their pushes.
        known: the pushes to calibrate with.
        paper, random: pushes as felt by the paper's controller.
        calibrations: of each robot, from its first `KNOWN_PUSHES` known pushes.
        paper_compensated, random_compensated: the same pushes as felt by the calibrated controller.
        loaded, loaded_compensated: four pushes on each robot whose rollers carry any load up to their friction limit.
        drifted: four pushes on each robot with zeros that drifted by ``drift_nm`` (standard deviation).
    """

    robots: Sequence[PushedRobot]
    known: Readings
    paper: Readings
    random: Readings
    calibrations: Sequence[Calibration]
    paper_compensated: Readings
    random_compensated: Readings
    loaded: Readings
    loaded_compensated: Readings
    drifted: Readings
    drift_nm: float

    def calibration_errors(self, pushes: int) -> NDArray[np.float64]:
        """Relative error of the stiffness from each robot's first ``pushes`` known pushes, shape (robots, 3)."""
        each = len(self.robots[0].known)
        found = [
            calibrate([self.known.known_push(number * each + index) for index in range(pushes)]).stiffness_n_per_m
            for number in range(len(self.robots))
        ]
        true = np.array([robot.known[0].stiffness_n_per_m for robot in self.robots])
        return np.asarray(np.array(found) / true - 1.0)


def run_study(sizes: Sizes, drift_nm: float, progress: Callable[[float], None]) -> Study:
    """Run everything; ``progress`` gets the finished share."""
    robots = [pushed_robot(number, sizes.pushes) for number in range(sizes.robots)]
    draw = np.random.default_rng(SEED)
    groups = {
        "known": [trial for robot in robots for trial in robot.known],
        "paper": [trial for robot in robots for trial in robot.paper],
        "random": [trial for robot in robots for trial in robot.random],
    }
    firsts = [trial for robot in robots for trial in robot.random[:GROUP]]
    groups["loaded"] = [replace(trial, roller_load_n=roller_loads(trial.placement, 1.0, draw)) for trial in firsts]
    drifts = drift_nm * draw.normal(size=(len(firsts), WHEELS))
    groups["drifted"] = [
        replace(trial, roller_load_n=(0.0, 0.0, 0.0), zero_drift_nm=(float(d[0]), float(d[1]), float(d[2])))
        for trial, d in zip(firsts, drifts, strict=True)
    ]
    again = ("paper", "random", "loaded")
    everything = sum(map(len, groups.values())) + sum(len(groups[name]) for name in again)
    finished = 0

    def run(trials: Sequence[Trial]) -> Readings:
        nonlocal finished
        readings = run_trials(trials, sizes.threads, lambda done: progress((finished + done) / everything))
        finished += len(trials)
        return readings

    readings = {name: run(trials) for name, trials in groups.items()}
    each = len(robots[0].known)
    calibrations = [
        calibrate([readings["known"].known_push(number * each + index) for index in range(KNOWN_PUSHES)])
        for number in range(len(robots))
    ]
    parameters = {
        robot.known[0].stiffness_n_per_m: calibration.controller_parameters()
        for robot, calibration in zip(robots, calibrations, strict=True)
    }
    for name in again:
        compensated = [replace(trial, controller=parameters[trial.stiffness_n_per_m]) for trial in groups[name]]
        readings[f"{name}_compensated"] = run(compensated)
    return Study(robots=robots, calibrations=calibrations, drift_nm=drift_nm, **readings)
