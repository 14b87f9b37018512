"""The linear drivetrain (`giveway drivetrain`): `model`, its `analysis`, and the `frequency_response` of the FMU.

`record` and `pictures` are what the command writes.
"""

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
]
