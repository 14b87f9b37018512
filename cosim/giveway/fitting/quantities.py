"""The quantities that the fit compares: the paper's measured numbers and the same numbers of simulated runs.

Sensor noise is off, the encoders are fine, and the detection time is interpolated between the controller's ticks, so
that every quantity changes smoothly with the parameters. `Bench.seeds` includes noise and quantisation again.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from giveway.base import native
from giveway.base.errors import GivewayError
from giveway.base.gravity import GRAVITY_MPS2
from giveway.batch import run_many
from giveway.experiments import PAPER_BUMPERS, motionless, moving
from giveway.experiments.placement import has_default_outline
from giveway.paper.matched import QUANTITIES, Quantity
from giveway.robot.presets import PAPER, preset_values
from giveway.robot.robot_file import read_robot
from giveway.robot.variables import Value, table
from giveway.scenario.scenario import Scenario

if TYPE_CHECKING:
    import xarray
    from numpy.typing import NDArray

__all__ = ["QUANTITIES", "Bench", "Quantity", "Values"]

Values = Mapping[str, float]
"""Values by their path in the robot file."""

PUSH_N = 1.0 * GRAVITY_MPS2  # the 1 kg of 5.1
PUSH_S = (0.2, 0.5, 0.8)  # it starts after the tare, reaches its full value, and is read
STATISTIC, CONTACT_TIME = "controller.detection.statistic", "testbed.truth.first_contact_time"
SLIDER_SPEED, COUNT = "testbed.truth.slider_speed", "controller.detection.count"
FORCE = "controller.estimate.force"
# The finest possible encoders; the limit of the check for jumps is in their counts.
SMOOTH: Mapping[str, Mapping[str, Value]] = {
    "testbed": {
        "electronics.torque_noise": 0.0,
        "electronics.torque_resolution": 0.0,
        "electronics.encoder_counts": 1_000_000,
    },
    "controller": {"estimator.encoder_counts": 1_000_000, "sensor_check.encoder_jump": 100_000},
}


@dataclass(frozen=True)
class _Push:
    """A push along x through the centre that rises and is held."""

    def __call__(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        force = np.zeros((len(time_s), 4))
        force[:, 0] = PUSH_N * np.interp(time_s, PUSH_S[:2], (0.0, 1.0))
        return force


_PUSH = _Push()


class Bench:
    """Runs the simulations for the quantities for many sets of values at once, based on a robot file."""

    def __init__(self, robot: Path | None = None, threads: int | None = None) -> None:
        """``robot``: the file of the values that are not varied, None for the one the FMUs were built with.

        Its outline must be that of the paper's robot: slider and obstacle have the paper's positions.
        """
        if not has_default_outline(robot):
            raise GivewayError("robot", robot, "a robot with the outline of the paper's: its results are fitted")
        read = read_robot(native.robot() if robot is None else robot)
        self._base = {model: table(model).robot_values(read) | preset_values(PAPER, model) for model in native.MODELS}
        self._threads = threads
        self._collisions = [motionless.scenario(bumper, motionless.IMPACT_S, preset=PAPER) for bumper in PAPER_BUMPERS]
        self._moving = moving.scenario(moving.PAPER_BUMPER, moving.REVERSAL_S, preset=PAPER)
        self._push = Scenario(
            "push",
            PUSH_S[2],
            testbed={"slider.present": False},
            controller={"controller.drives_enabled": False},
            push=_PUSH,
            preset=PAPER,
        )

    def measure(self, candidates: Sequence[Values]) -> NDArray[np.float64]:
        """The quantities of each candidate without noise and quantisation, shape (candidates, quantities).

        NaN: it did not happen, or came after a false detection. Ctrl-C raises KeyboardInterrupt.
        """
        return self._measure([(values, SMOOTH) for values in candidates], _interpolated_detection)

    def seeds(self, values: Values, seeds: Sequence[int]) -> NDArray[np.float64]:
        """The quantities at ``values`` as the controller sees them, with noise of each seed, shape (seeds, ...)."""
        runs = [(values, {"testbed": {"electronics.seed": seed}, "controller": {}}) for seed in seeds]
        return self._measure(runs, _detection)

    def _measure(
        self,
        runs: Sequence[tuple[Values, Mapping[str, Mapping[str, Value]]]],
        detection: Callable[[xarray.Dataset, NDArray[np.float64]], NDArray[np.float64]],
    ) -> NDArray[np.float64]:
        settings = [self._overrides(values, electronics) for values, electronics in runs]
        collisions = self._run(self._collisions, settings, (STATISTIC, CONTACT_TIME, SLIDER_SPEED))
        drives = self._run([self._moving], settings, (STATISTIC, CONTACT_TIME, COUNT))
        pushes = self._run([self._push], settings, (FORCE,))
        thresholds = [float(controller["detector.impulse_threshold"]) for _testbed, controller in settings]

        def shaped(name: str) -> NDArray[np.float64]:
            return np.reshape(collisions[name].values, (len(runs), -1)).T

        times = np.reshape(detection(collisions, np.repeat(thresholds, 3)), (len(runs), 3)).T
        none, spring, magnetic = shaped("peak wheel torque")
        _none, spring_force, magnetic_force = shaped("peak force of the run")
        columns = (
            _contact_speed(collisions)[0::3],
            *times,
            times[1] - times[2],
            spring / none,
            magnetic / none,
            magnetic_force / spring_force,
            _undisturbed(drives, detection(drives, np.asarray(thresholds))),
            _undisturbed(drives, _statistic_afterwards(drives) / thresholds),
            _undisturbed(drives, drives["peak torque, any sign"].values) / (0.5 * (spring + magnetic)),
            pushes[FORCE].values[:, -1],
        )
        return np.stack(columns, axis=1)

    def _overrides(
        self, values: Values, electronics: Mapping[str, Mapping[str, Value]]
    ) -> tuple[dict[str, Value], dict[str, Value]]:
        made = [{**self._base[model], **_by_variable(model, values), **electronics[model]} for model in native.MODELS]
        controller, testbed = made
        return testbed, controller

    def _run(
        self,
        scenarios: Sequence[Scenario],
        settings: Sequence[tuple[dict[str, Value], dict[str, Value]]],
        traces: Sequence[str],
    ) -> xarray.Dataset:
        """Every scenario with every setting; the scenario's own parameters take precedence."""
        batch = [
            dataclasses.replace(
                scenario,
                testbed={**testbed, **scenario.testbed},
                controller={**controller, **scenario.controller},
            )
            for testbed, controller in settings
            for scenario in scenarios
        ]
        found = run_many(batch, threads=self._threads, traces=traces)
        if found.attrs["interrupted"]:
            raise KeyboardInterrupt
        failed = found["message"].values[found["status"].values != "ok"]
        if failed.size:
            raise GivewayError("fit", str(failed[0]), "parameters with which every run ends well")
        return found


def _by_variable(model: str, values: Values) -> dict[str, Value]:
    """``values`` under the names that the model's variables have."""
    paths = _paths(model)
    return {name: value for path, value in values.items() for name in paths.get(path, ())}


@functools.cache
def _paths(model: str) -> dict[str, list[str]]:
    """The variables of ``model`` that take their start from each path of the robot file."""
    paths: dict[str, list[str]] = {}
    for variable in table(model):
        if variable.robot_path is not None:
            paths.setdefault(variable.robot_path, []).append(variable.name)
    return paths


def _row_at(runs: xarray.Dataset, time_s: NDArray[np.float64]) -> NDArray[np.intp]:
    """The last rows that are not later than ``time_s``."""
    return np.asarray(np.floor(time_s / runs["time"].values[1]), dtype=np.intp)


def _undisturbed(runs: xarray.Dataset, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """``values`` of the runs in which nothing was detected before the contact, else NaN."""
    before = np.maximum(_row_at(runs, runs[CONTACT_TIME].values[:, -1]), 0)
    return np.where(runs[COUNT].values[np.arange(len(before)), before] == 0, values, np.nan)


def _statistic_afterwards(runs: xarray.Dataset) -> NDArray[np.float64]:
    """The detector's largest statistic after the first detection, when the contact is over."""
    statistic = np.where(runs[COUNT].values > 0, runs[STATISTIC].values, 0.0)
    statistic[np.arange(len(statistic)), np.argmax(runs[COUNT].values > 0, axis=1)] = 0.0
    return np.asarray(statistic.max(axis=1))


def _detection(runs: xarray.Dataset, _threshold: NDArray[np.float64]) -> NDArray[np.float64]:
    """Detection times in ms as the metrics define them."""
    return runs["detection time"].values.copy()


def _interpolated_detection(runs: xarray.Dataset, threshold: NDArray[np.float64]) -> NDArray[np.float64]:
    """Detection times in ms, placed between two ticks where the statistic meets the threshold."""
    times = _detection(runs, threshold)
    step_s = float(runs["time"].values[1])
    for run in np.flatnonzero(np.isfinite(times)):
        statistic = runs[STATISTIC].values[run]
        row = round((runs[CONTACT_TIME].values[run, -1] + 1e-3 * times[run]) / step_s)
        beyond = (statistic[row] - threshold[run]) / (statistic[row] - statistic[row - 1])
        times[run] -= 1e3 * step_s * min(1.0, max(0.0, beyond))
    return times


def _contact_speed(runs: xarray.Dataset) -> NDArray[np.float64]:
    """Speed of the slider at the contact, m/s: extrapolated from the two samples before."""
    at = runs[CONTACT_TIME].values[:, -1] / float(runs["time"].values[1])
    row = _row_at(runs, runs[CONTACT_TIME].values[:, -1])
    speed = runs[SLIDER_SPEED].values
    each = np.arange(len(at))
    slope = speed[each, row] - speed[each, row - 1]
    return np.where(at > 1.0, speed[each, row] + (at - row) * slope, np.nan)
