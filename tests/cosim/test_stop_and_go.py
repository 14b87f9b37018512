"""A robot that moves and stops again and again: what its rollers hold after a stop is not taken for a push."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pytest
from giveway import batch
from giveway.robot.presets import NO_REFLEX
from giveway.scenario.plan import PLAN_INPUTS
from giveway.scenario.scenario import Scenario

if TYPE_CHECKING:
    from giveway.robot.variables import Value
    from numpy.typing import NDArray

PERIOD_S, SPEED_MPS, ACCELERATION_MPS2 = 4.0, 0.16, 0.3
MOVES_S = (0.5, 2.5)  # within a period
FORCES = ("controller.estimate.force_x", "controller.estimate.force_y")
SPEEDS = ("controller.reference.vx", "controller.reference.vy")


@dataclass(frozen=True)
class StopAndGo:
    """Along a straight line, two seconds of every four."""

    direction_rad: float

    def __call__(self, time_s: NDArray[np.float64]) -> NDArray[np.float64]:
        begin, end = MOVES_S
        phase = np.mod(time_s, PERIOD_S)
        ramp = ACCELERATION_MPS2 * np.minimum(phase - begin, end - phase)
        speed = np.clip(ramp, 0.0, SPEED_MPS)
        sign = np.where(phase < (begin + end) / 2.0, 1.0, -1.0)
        acceleration = np.where((ramp > 0.0) & (ramp < SPEED_MPS), sign * ACCELERATION_MPS2, 0.0)
        table = np.zeros((len(time_s), len(PLAN_INPUTS)))
        for column, along in zip((0, 3, 6), (np.cumsum(speed) * 1e-3, speed, acceleration), strict=True):
            table[:, column] = along * math.cos(self.direction_rad)
            table[:, column + 1] = along * math.sin(self.direction_rad)
        return table


def forces_after_stops(controller: dict[str, Value]) -> NDArray[np.float64]:
    """Estimated force in the 0.3 s after each stop, until its tare, in four directions; nothing pushes."""
    runs = [
        Scenario(
            "stop and go",
            12.0,
            testbed={"slider.present": False, "rope.attached": False},
            controller={**controller, **NO_REFLEX},
            plan=StopAndGo(direction),
            seed=seed,
            preset="paper",
        )
        for seed, direction in enumerate((0.0, 0.3, 1.0, 2.0))
    ]
    found = batch.run_many(runs, traces=(*FORCES, *SPEEDS))
    assert set(found["status"].values) == {"ok"}
    force = np.hypot(*(found[name].values for name in FORCES))
    stands = np.hypot(*(found[name].values for name in SPEEDS)) <= 0.002
    stops = np.argwhere(stands[:, 1:] & ~stands[:, :-1])
    assert len(stops) >= 2 * len(runs)
    return np.concatenate([force[run, row + 1 : row + 299] for run, row in stops])


@pytest.mark.parametrize("acceleration_source", [0, 1])
def test_with_bristles_a_stop_leaves_a_third_of_the_force(acceleration_source: int) -> None:
    bristles = {"estimator.friction_model": 1, "estimator.acceleration_source": acceleration_source}
    paper, ours = (
        float(np.sqrt(np.mean(forces_after_stops(controller) ** 2)))
        for controller in ({"estimator.acceleration_source": acceleration_source}, bristles)
    )
    # Stuck rollers hold up to 21 N each.
    assert 10.0 < paper < 42.0
    # What is left is what the bristles do not know: the plant's exact motion into the stop, noise, encoder steps.
    assert ours < 0.4 * paper
