"""Causes that a study can vary and that change several parameters by a factor: the temperature, the gear's ratio.

| quantity | nominal | multiplies |
|---|---|---|
| ``temperature`` T, degC | 20 | the latch force by 1 - 0.0024 (T - 20): a magnet's (robots/trikey.toml) |
| ``gear_ratio`` n, 1 | 1 | seen at the wheel's axle: rotor inertia and viscous friction by n², dry friction, |
| | | greatest torque and encoder counts, which are on the motor's side, by n |

``gear_ratio`` is over the ratio of the robot file, or of the motor that is chosen. The controller, too, gets the counts
that result, to the nearest whole one, and knows its motors' inertia, friction and greatest torque by the same factors.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Factor = Callable[[NDArray[np.float64]], NDArray[np.float64]]

__all__ = ["INFLUENCES", "Influence"]

_MAGNET_PER_KELVIN = -0.0024  # change of a magnet's force (robots/trikey.toml, bumper.latch_force)


@dataclass(frozen=True)
class Influence:
    """A cause.

    Attributes:
        unit, minimum, maximum: of its values.
        nominal: at which the parameters are as stated.
        factors: by which it multiplies each parameter, from its values.
    """

    unit: str
    minimum: float
    maximum: float
    nominal: float
    factors: Mapping[str, Factor]


def _warmed(temperature: NDArray[np.float64]) -> NDArray[np.float64]:
    return 1.0 + _MAGNET_PER_KELVIN * (temperature - 20.0)


def _once(ratio: NDArray[np.float64]) -> NDArray[np.float64]:
    return ratio


def _squared(ratio: NDArray[np.float64]) -> NDArray[np.float64]:
    return ratio * ratio


INFLUENCES: Mapping[str, Influence] = MappingProxyType(
    {
        "temperature": Influence("degC", -100.0, 200.0, 20.0, {"testbed.bumper.latch_force": _warmed}),
        "gear_ratio": Influence(
            "1",
            0.01,
            100.0,
            1.0,
            {
                "testbed.drivetrain.motor_inertia": _squared,
                "testbed.drivetrain.gear_viscous": _squared,
                "testbed.drivetrain.gear_coulomb": _once,
                "testbed.drivetrain.gear_stiction": _once,
                "testbed.drivetrain.torque_limit": _once,
                "testbed.electronics.encoder_counts": _once,
                "controller.estimator.encoder_counts": _once,
                "controller.motor.inertia": _squared,
                "controller.motor.coulomb_torque": _once,
                "controller.motor.torque_limit": _once,
            },
        ),
    }
)
