"""How far a search has come: the hypervolume of the front, generation by generation, and when it no longer grows.

The hypervolume is what the feasible designs dominate of the box that a reference point closes. Only its growth is
judged, in shares, so the objectives' units do not matter.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from giveway.base.extras import extra
from giveway.study.pareto import front

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.study.search_plan import SearchPlan

__all__ = ["hypervolume", "reference_of", "stopped"]

MARGIN = 0.1  # of the range of the first feasible designs, by which the reference is worse than all of them


def hypervolume(costs: NDArray[np.float64], reference: NDArray[np.float64]) -> float:
    """Of ``costs`` (n, objectives; less is better), up to ``reference``."""
    inside = costs[(costs < reference).all(axis=1)]
    if not len(inside):
        return 0.0
    best = inside[front(inside)]
    if best.shape[1] == 1:
        return float(reference[0] - best.min())
    return float(extra("moocore", "optimise").hypervolume(best, ref=reference))


def reference_of(costs: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """A point that is worse than all of ``costs``; None as long as there are not two of them."""
    if len(costs) < 2:
        return None
    worst, best = costs.max(axis=0), costs.min(axis=0)
    width = np.where(worst > best, worst - best, np.maximum(np.abs(worst), 1.0))
    return np.asarray(worst + MARGIN * width)


def stopped(stop: SearchPlan, volumes: list[float], designs: int) -> str:
    """Why a search ends after generations with these hypervolumes; "" if it goes on."""
    if designs >= stop.designs:
        return f"{designs:,} designs, as many as were asked for"
    if len(volumes) > stop.patience and volumes[-1 - stop.patience] > 0.0:
        grown = volumes[-1] / volumes[-1 - stop.patience] - 1.0
        if grown <= stop.growth:
            words = f"the hypervolume grew by {100.0 * grown:.2g} % in {stop.patience} generations"
            return f"{words}, no more than {100.0 * stop.growth:g} %"
    return ""
