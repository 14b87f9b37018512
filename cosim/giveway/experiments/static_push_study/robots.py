"""Simulated robots with different rollers, and the pushes on each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway.base.errors import GivewayError
from giveway.experiments.static_push_study.placements import (
    Placement,
    default_outline,
    middles,
    paper_placements,
    random_placements,
)
from giveway.experiments.static_push_study.trials import WEIGHT_N, Trial
from giveway.identification.presliding import Base
from giveway.robot.variables import table
from giveway.robot.wheels import WHEELS

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["LOAD_SHARE", "SCATTER", "PushedRobot", "presliding_stiffness_n_per_m", "pushed_robot", "roller_loads"]

SEED = 51
# Log-normal scatter of a roller's presliding stiffness about the robot file's value, from wheel to wheel, fixed per
# robot. The spread in the paper decides it: at 0.2 no group of four comes near -45 % or 12 deg, at 0.6 it is in reach.
SCATTER = 0.6
# Loads that earlier motion left in the rollers, uniform up to this share of their friction limit. The mean is that of
# driving at 0.02 to 0.2 m/s and stopping in this plant, a third of the limit; hardly any stop leaves more than the
# maximum.
LOAD_SHARE = 0.6
DRAWS = 1000
HOLD_SHARE = 0.95  # of the stiction: the push begins with residual oscillations of 1 to 2 % of it


def presliding_stiffness_n_per_m() -> float:
    """Of the robot file, each wheel's."""
    return float(table("testbed")["roller.presliding_stiffness[0]"].start or 0.0)


def roller_loads(placement: Placement, share: float, draw: np.random.Generator) -> tuple[float, float, float]:
    """Loads (N) up to ``share`` of the rollers' friction limit B_r/r_r that earlier motion may have left.

    Drawn again where loads and push together would turn a gear: the paper's robot was not pushed away.
    GivewayError if hardly any loads are within the gears' stiction.
    """
    variables = table("testbed")
    limit = float(variables["roller.coulomb_torque"].start or 0.0) / float(variables["roller.radius"].start or 1.0)
    stiction = float(variables["drivetrain.gear_stiction"].start or 0.0)
    base = Base.of_robot()
    to_torque = np.linalg.inv(base.wheel_jacobian.T)
    push = -to_torque @ placement.wrench(WEIGHT_N)
    for _ in range(DRAWS):
        loads = draw.uniform(-share, share, WHEELS) * limit
        wound = to_torque[:, :2] @ base.radial.T @ loads  # what the drivetrains carry against them before the push
        if max(np.abs(wound).max(), np.abs(wound + push).max()) < HOLD_SHARE * stiction:
            return _three(loads)
    raise GivewayError("drivetrain.gear_stiction", stiction, "enough N m to hold the rollers' loads and the push")


@dataclass(frozen=True)
class PushedRobot:
    """One robot and its pushes, none of which shares placement, loads or noise with another.

    Attributes:
        known: twice one push straight on at the middle of each side: to calibrate with.
        paper: four pushes in the manner of the paper's Fig. 9.
        random: pushes anywhere on the outline.
    """

    known: Sequence[Trial]
    paper: Sequence[Trial]
    random: Sequence[Trial]


def pushed_robot(number: int, pushes: int) -> PushedRobot:
    """Robot ``number`` with ``pushes`` random pushes; the same number always makes the same robot."""
    draw = np.random.default_rng([SEED, number])
    stiffness = presliding_stiffness_n_per_m() * np.exp(SCATTER * draw.normal(size=WHEELS))
    outline = default_outline()

    def trial(placement: Placement) -> Trial:
        loads = roller_loads(placement, LOAD_SHARE, draw)
        return Trial(placement, _three(stiffness), loads, seed=int(draw.integers(2**31)))

    return PushedRobot(
        known=[trial(at) for at in (*middles(outline), *middles(outline))],
        paper=[trial(at) for at in paper_placements(outline)],
        random=[trial(at) for at in random_placements(outline, pushes, draw)],
    )


def _three(values: NDArray[np.float64]) -> tuple[float, float, float]:
    return float(values[0]), float(values[1]), float(values[2])
