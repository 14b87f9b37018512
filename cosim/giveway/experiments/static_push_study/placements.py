"""Points on a robot's outline and directions of pushes into its body."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from giveway.robot.variables import table

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["CONE_RAD", "Placement", "default_outline", "middles", "paper_placements", "random_placements"]

# Largest angle of a push to the inward normal: beyond the friction angle of the cover's polyurethane (friction 0.6: 31
# deg) the pushing body slips along the side.
CONE_RAD = math.radians(30.0)
# Fig. 9 shows four orientations of the robot before a dummy that pushes the same side, and prints no numbers. These
# four do the same: at the middle and towards both corners, straight on and leaning to either side.
PAPER_SIDE = 1
PAPER_PLACEMENTS = ((0.5, 0.0), (0.25, 0.0), (0.7, math.radians(20.0)), (0.35, math.radians(-20.0)))


@dataclass(frozen=True)
class Placement:
    """A push on the outline.

    Attributes:
        x_m, y_m: the point, base frame, m.
        direction_rad: of the force on the robot, base frame.
    """

    x_m: float
    y_m: float
    direction_rad: float

    def wrench(self, force_n: float) -> NDArray[np.float64]:
        """Fx, Fy (N) and moment about the centre (N m) of a force of this placement."""
        fx, fy = force_n * math.cos(self.direction_rad), force_n * math.sin(self.direction_rad)
        return np.array([fx, fy, self.x_m * fy - self.y_m * fx])


def default_outline() -> NDArray[np.float64]:
    """Vertices of the outline of giveway's default robot, base frame, m, counter-clockwise, shape (n, 2)."""
    variables = table("controller")
    count = int(variables["outline.count"].start or 0)
    return np.array([[float(variables[f"outline.{a}[{i}]"].start or 0.0) for a in "xy"] for i in range(count)])


def _on_side(outline: NDArray[np.float64], side: int, share: float, lean_rad: float) -> Placement:
    start, end = outline[side], outline[(side + 1) % len(outline)]
    along = end - start
    inward = math.atan2(along[0], -along[1])  # the body lies to the left of a counter-clockwise side
    point = start + share * along
    return Placement(float(point[0]), float(point[1]), inward + lean_rad)


def paper_placements(outline: NDArray[np.float64]) -> list[Placement]:
    """Four pushes on one side, in the manner of Fig. 9."""
    return [_on_side(outline, PAPER_SIDE, share, lean) for share, lean in PAPER_PLACEMENTS]


def random_placements(outline: NDArray[np.float64], count: int, draw: np.random.Generator) -> list[Placement]:
    """``count`` pushes anywhere on the outline (every millimetre alike), within `CONE_RAD` of the inward normal."""
    lengths = np.hypot(*(np.roll(outline, -1, axis=0) - outline).T)
    sides = draw.choice(len(outline), size=count, p=lengths / lengths.sum())
    shares, leans = draw.random(count), draw.uniform(-CONE_RAD, CONE_RAD, count)
    return [_on_side(outline, int(s), float(u), float(lean)) for s, u, lean in zip(sides, shares, leans, strict=True)]


def middles(outline: NDArray[np.float64]) -> list[Placement]:
    """One push straight on at the middle of each side."""
    return [_on_side(outline, side, 0.5, 0.0) for side in range(len(outline))]
