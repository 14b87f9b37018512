"""The fitted parameters: estimates, their uncertainty, and bounds.

An estimate is the value expected without the paper's results; ``factor`` is the deviation from it that costs as much as
missing a number of the paper by its tolerance. Sources are those of the robot file's notes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from giveway.fitting.quantities import Values

__all__ = ["FREE", "Free", "from_unit", "limits", "to_unit"]

DIGITS = 3  # digits of a fitted value: more would not be justified


@dataclass(frozen=True)
class Free:
    """A parameter that is fitted.

    Attributes:
        paths: its entries in the robot file; several paths share the value.
        unit: of estimate and bounds.
        estimate: the expected value.
        minimum, maximum: the range that is plausible; the fit stays within.
        why: where estimate and range come from.
    """

    paths: tuple[str, ...]
    unit: str
    estimate: float
    minimum: float
    maximum: float
    why: str

    @property
    def name(self) -> str:
        """The first path."""
        return self.paths[0]

    @property
    def factor(self) -> float:
        """The deviation that counts as one: the range is two to either side."""
        return float((self.maximum / self.minimum) ** 0.25)


FREE = (
    Free(("slider.run_up",), "m", 0.0382, 0.036, 0.042, "0.5 m/s without friction and with a stiff rope"),
    Free(("bumper.spring_rate",), "N/m", 1000.0, 800.0, 1300.0, "travel and speed of 5.2"),
    Free(("bumper.latch_force",), "N", 50.0, 35.0, 70.0, "below v sqrt(k_b m), made tolerance 30 %"),
    Free(
        ("detector.impulse_threshold",), "N.s", 0.8, 0.2, 3.2, "the 0.8 N of 5.2 read as an impulse; window not stated"
    ),
    Free(("roller.presliding_stiffness",), "N/m", 3.3e4, 1.6e4, 6.7e4, "reproduces the errors of 5.1"),
    Free(("drivetrain.stiffness",), "N.m/rad", 840.0, 280.0, 1900.0, "gear 8100, sensor 15000, belt 300-3000 (1000)"),
    Free(("drivetrain.gear_coulomb", "drivetrain.gear_stiction"), "N.m", 3.0, 1.0, 5.0, "harmonic drives of this size"),
    Free(("servo.kp",), "N.m/rad", 200.0, 50.0, 800.0, "no source"),
    Free(("servo.kd",), "N.m.s/rad", 8.0, 2.0, 32.0, "no source"),
    Free(("contact.stiffness",), "N/m", 3.0e4, 1.0e4, 1.0e5, "hard polyurethane cover"),
)
"""In the order of the robot file's use: slider, bumper, detector, rollers, drivetrain, servo, cover."""


def to_unit(values: Values) -> NDArray[np.float64]:
    """``values`` as logarithmic deviations from the estimates, in factors."""
    return np.array([math.log(values[free.name] / free.estimate) / math.log(free.factor) for free in FREE])


def from_unit(point: NDArray[np.float64]) -> dict[str, float]:
    """The values, by path, at logarithmic deviations ``point``."""
    return {
        path: free.estimate * free.factor ** float(deviation)
        for free, deviation in zip(FREE, point, strict=True)
        for path in free.paths
    }


def rounded(values: Values) -> dict[str, float]:
    """``values`` with as many digits as a robot file states."""
    return {path: float(f"{value:.{DIGITS}g}") for path, value in values.items()}


def limits() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lower and upper bounds as logarithmic deviations."""
    lower = to_unit({free.name: free.minimum for free in FREE})
    return lower, to_unit({free.name: free.maximum for free in FREE})
