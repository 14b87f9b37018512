"""The detector's margin over rounds of the circle."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.style import context

from giveway.report.push_path import PUSH_COLOUR
from giveway.report.style import STYLE

if TYPE_CHECKING:
    import xarray

__all__ = ["alarm"]

LESS, MORE = "#0b64a8", "#c8500a"
BIN = 100  # samples per drawn point, which is their maximum


def alarm(studies: Mapping[str, tuple[Sequence[float], xarray.Dataset]], threshold_newton_s: float) -> Figure:
    """The detector's statistic over an undisturbed round, by estimator and mismatch of the rollers' friction."""
    with context(STYLE):
        figure = Figure(figsize=(9.6, 3.4), layout="constrained")
        panels = figure.subplots(1, len(studies), sharex=True, sharey=True, squeeze=False)[0]
        for axes, (name, (shares, data)) in zip(panels, studies.items(), strict=True):
            largest = max(abs(share) for share in shares) or 1.0
            for share, count, statistic in zip(
                shares,
                data["controller.detection.count"].values,
                data["controller.detection.statistic"].values,
                strict=True,
            ):
                rows = int((count == 0).sum()) // BIN * BIN  # up to the first false alarm
                colour = LESS if share < 0.0 else MORE if share > 0.0 else PUSH_COLOUR
                strength = 1.0 - 0.75 * abs(share) / largest
                highest = statistic[:rows].reshape(-1, BIN).max(axis=1)
                time_s = data["time"].values[:rows:BIN]
                axes.plot(time_s, highest, color=colour, alpha=strength, linewidth=1.2, label=f"{100.0 * share:+g} %")
            axes.axhline(threshold_newton_s, color=PUSH_COLOUR, linestyle=(0, (4, 3)), linewidth=1.0)
            axes.set(title=name, xlabel="time (s)")
        panels[0].set_ylabel("leaky impulse (N s)")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside right center", title="roller friction")
    return figure
