"""The contact stated by a scenario, so that deviations from it can be reported."""

from __future__ import annotations

from dataclasses import dataclass

from giveway.base.checks import finite

__all__ = ["StatedContact"]


@dataclass(frozen=True)
class StatedContact:
    """The intended contact of slider and robot; None: not stated.

    Attributes:
        speed_mps: of the slider's nose relative to the base, m/s, as the metric "contact speed".
        point_m: on the robot, base frame, m.
        time_s: time of the contact, s.
    """

    speed_mps: float | None = None
    point_m: tuple[float, float] | None = None
    time_s: float | None = None

    def __post_init__(self) -> None:
        if self.speed_mps is not None:
            finite("StatedContact.speed_mps", self.speed_mps, 0.0)
        for value in self.point_m or ():
            finite("StatedContact.point_m", value)
        if self.time_s is not None:
            finite("StatedContact.time_s", self.time_s, 0.0)
