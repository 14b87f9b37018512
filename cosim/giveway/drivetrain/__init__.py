"""The linear drivetrain (`giveway drivetrain`): `model`, its `analysis`, and the `frequency_response` of the FMU.

`record` and `pictures` write the command's files.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from giveway.drivetrain.model import (
        ENVIRONMENT,
        LOADS,
        MOTOR,
        SERVO_PERIOD_S,
        Drivetrain,
        Servo,
        closed_loop,
        describe,
        gear_friction,
        loop_gain,
        plant,
        read,
        response,
        sampled_plant,
        senses_current,
    )

__all__ = [
    "ENVIRONMENT",
    "LOADS",
    "MOTOR",
    "SERVO_PERIOD_S",
    "Drivetrain",
    "Servo",
    "closed_loop",
    "describe",
    "gear_friction",
    "loop_gain",
    "plant",
    "read",
    "response",
    "sampled_plant",
    "senses_current",
]


def __getattr__(name: str) -> object:
    """Handed on when asked for: `command` is imported at every start, and has to be light."""
    if name in __all__:
        return getattr(importlib.import_module(f"{__name__}.model"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
