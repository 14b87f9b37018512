"""True impulse of a hit over time, and the part that variants of the estimator see, one panel per kind of hit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.style import context

from giveway.report.style import STYLE, TRUTH_COLOUR

if TYPE_CHECKING:
    from giveway.experiments.impulse_trials import Seen

__all__ = ["draw"]

FORM_COLOURS = ("#c8500a", "#0b64a8", "#0a8a63")


def draw(hits: Mapping[str, Mapping[str, Seen]], judged_s: float) -> Figure:
    """The figure for results by kind of hit and label of the form; bands reach from lowest to highest seed."""
    with context(STYLE):
        figure = Figure(figsize=(9.6, 6.0), layout="constrained")
        panels = figure.subplots(2, 2, sharex=True)
        for axes, (hit, forms) in zip(panels.flat, hits.items(), strict=True):
            for colour, (label, result) in zip(FORM_COLOURS, forms.items(), strict=True):
                time_ms = 1e3 * result.time_s
                axes.fill_between(
                    time_ms, result.seen.min(axis=0), result.seen.max(axis=0), color=colour, alpha=0.25, linewidth=0.0
                )
                axes.plot(time_ms, result.seen.mean(axis=0), color=colour, label=label)
            axes.plot(time_ms, result.true.mean(axis=0), color=TRUTH_COLOUR, linestyle="--", label="true")
            axes.axvline(1e3 * judged_s, color=TRUTH_COLOUR, linewidth=0.8)
            axes.set(title=f"{hit}: impulse (N s)", xlim=(0.0, time_ms[-1]))
        for axes in panels[1]:
            axes.set(xlabel="time since contact (ms)")
        handles, labels = panels[0, 0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
    return figure
