"""A result prepared for figures: time from contact, travel along the slider's rail."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from giveway.report.obstacle import rail
from giveway.report.style import COLOURS
from giveway.simulation.metrics import FIRST_PEAK, Collision

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from giveway.simulation.result import Result

__all__ = ["IMPACT_MS", "Run", "force_window_ms"]

IMPACT_MS = (-40.0, 350.0)
AROUND_PEAK_MS, LATEST_PEAK_MS = 120.0, 3000.0


def force_window_ms(runs: list[Run]) -> tuple[float, float]:
    """Range of times since contact that shows every peak of `Run.peaks` and its surroundings, ms."""
    latest = max((time_ms for run in runs for time_ms, _, _ in run.peaks()), default=0.0)
    return IMPACT_MS[0], max(IMPACT_MS[1], min(latest, LATEST_PEAK_MS) + AROUND_PEAK_MS)


class Run:
    """One result, relative to its contact."""

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
        self.contact_row = min(self.hit.start, len(nose) - 1)
        self.nose = nose

    def travel(self, xy: NDArray[np.float64]) -> NDArray[np.float64]:
        """Travel of a point along the slider's rail since contact, m."""
        return np.asarray((xy - xy[self.contact_row]) @ self.along)

    def position(self, source: str) -> NDArray[np.float64]:
        """Travel of ``source`` (x and y traces) along the rail since contact, m."""
        return self.travel(np.stack([self.hit[f"{source}.x"], self.hit[f"{source}.y"]], axis=1))

    def peaks(self) -> list[tuple[float, float, str]]:
        """Time (ms), force (N) and label of the peak of the first contact, and of the run's peak if that is higher."""
        if self.hit.contact_s is None:
            return []
        first, most = (self.hit.metrics[name].value or 0.0 for name in (FIRST_PEAK, "peak force of the run"))
        force = self.hit["testbed.truth.contact_force"]
        named = {"the first contact": first} | ({"the run": most} if most > first else {})
        rows = {name: int(np.argmax(force >= peak)) for name, peak in named.items()}
        return [
            (float(self.time_ms[rows[name]]), peak, f"{peak:.0f} N: peak of {name}") for name, peak in named.items()
        ]

    def draw_force(self, axes: Axes, window_ms: tuple[float, float], label: str) -> None:
        """The true contact force over the time since contact, with its peaks in words."""
        rows = (self.time_ms >= window_ms[0]) & (self.time_ms <= window_ms[1])
        force = self.hit["testbed.truth.contact_force"][rows]
        axes.plot(self.time_ms[rows], force, color=self.colour, label=label)
        peaks = [peak for peak in self.peaks() if peak[0] <= window_ms[1]]
        for (time_ms, force_n, words), side in zip(peaks, ("left", "center"), strict=False):
            if len(peaks) > 1:
                text = axes.annotate(words, (time_ms, force_n), (0, 8), textcoords="offset points", ha=side)
                text.set(color=self.colour, fontsize=8, backgroundcolor="#ffffffc0")

    def mark_detection(self, axes: Axes, scale: float = 1.0) -> None:
        if self.detected_ms is not None:
            axes.axvline(self.detected_ms * scale, color=self.colour, linestyle=(0, (4, 3)), linewidth=1.0)
