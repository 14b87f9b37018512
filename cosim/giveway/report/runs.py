"""A result as figures need it: time from contact, travel along the slider's rail."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from giveway.metrics import Collision
from giveway.report.obstacle import rail
from giveway.report.style import COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from giveway.result import Result

__all__ = ["IMPACT_MS", "Run"]

IMPACT_MS = (-40.0, 350.0)


class Run:
    """One result, seen from its contact."""

    def __init__(self, label: str, result: Result) -> None:
        self.hit = Collision(result.traces, result.manifest["parameters"])
        self.parameters = result.manifest["parameters"]
        self.label = label
        self.colour = COLOURS[label]
        self.time_s = self.hit.time_s - (self.hit.contact_s or 0.0)
        self.time_ms = 1e3 * self.time_s
        self.impact = (self.time_ms >= IMPACT_MS[0]) & (self.time_ms <= IMPACT_MS[1])
        self.detected_ms = None if self.hit.detected is None else float(self.time_ms[self.hit.detected])
        nose = np.stack([self.hit["testbed.truth.nose_x"], self.hit["testbed.truth.nose_y"]], axis=1)
        self.along = np.array(rail(self.parameters["testbed"]))
        self.contact_row = min(self.hit.until_detection().start, len(nose) - 1)
        self.nose = nose

    def travel(self, xy: NDArray[np.float64]) -> NDArray[np.float64]:
        """Travel of a point along the slider's rail since contact, m."""
        return np.asarray((xy - xy[self.contact_row]) @ self.along)

    def position(self, source: str) -> NDArray[np.float64]:
        """Travel of ``source`` (x and y traces) along the rail since contact, m."""
        return self.travel(np.stack([self.hit[f"{source}.x"], self.hit[f"{source}.y"]], axis=1))

    def mark_detection(self, axes: Axes, scale: float = 1.0) -> None:
        if self.detected_ms is not None:
            axes.axvline(self.detected_ms * scale, color=self.colour, linestyle=(0, (4, 3)), linewidth=1.0)
