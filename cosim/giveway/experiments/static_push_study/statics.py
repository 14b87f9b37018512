"""Groups of four pushes in the static model alone: fast enough to search for the parameter values that would explain a
number.

No dynamics, noise, slipping or outline: magnitudes and directions only. `trials` runs the full simulation.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from giveway.experiments.static_push_study.groups import GROUP, PAPER_FORCE_N
from giveway.experiments.static_push_study.placements import random_placements
from giveway.experiments.static_push_study.trials import WEIGHT_N
from giveway.identification.presliding import Base, felt_wrench, static_torques
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Statics", "first_reaching"]


class Statics:
    """Random robots, four random pushes on each; the same draws for every question, so that answers vary smoothly.

    Args:
        outline: of the base, shape (n, 2), m.
        groups: how many robots.
        seed: of all draws.
    """

    def __init__(self, outline: NDArray[np.float64], groups: int, seed: int) -> None:
        self.groups = groups
        draw = np.random.default_rng(seed)
        self._base = Base.of_robot()
        at = random_placements(outline, groups * GROUP, draw)
        self._wrench = np.stack([placement.wrench(WEIGHT_N) for placement in at]).reshape(groups, GROUP, 3)
        self._deviation = draw.normal(size=(groups, 1, WHEELS))
        self._drift = draw.normal(size=(groups, GROUP, WHEELS))

    def feel(
        self, stiffness_n_per_m: float, scatter: float, zero_drift_nm: float = 0.0
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Magnitude error (% of 10 N, signed) and direction error (deg, absolute), both of shape (groups, 4).

        Log-normal ``scatter`` of the stiffness about its median; zeros of the torques that drifted since the tare.
        """
        stiffness = stiffness_n_per_m * np.exp(scatter * self._deviation)
        torque = static_torques(self._base, stiffness, self._wrench) + zero_drift_nm * self._drift
        felt = felt_wrench(self._base, torque)
        true = self._wrench[..., 0] + 1j * self._wrench[..., 1]
        seen = felt[..., 0] + 1j * felt[..., 1]
        return 100.0 * (np.abs(seen) / PAPER_FORCE_N - 1.0), np.degrees(np.abs(np.angle(seen / true)))


def first_reaching(values: Sequence[float], reached: Callable[[float], bool]) -> float | None:
    """The first of the rising ``values`` for which ``reached`` holds, or None."""
    return next((value for value in values if reached(value)), None)
