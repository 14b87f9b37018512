"""Polar figure: the push that 95 % of the robots notice, over the side from which it comes."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from typing import TYPE_CHECKING

from matplotlib.figure import Figure
from matplotlib.style import context

from giveway.base.files import replace_file
from giveway.detectability.found import Detectability
from giveway.detectability.probes import IMPULSE, KINDS, PUSH, SITUATIONS
from giveway.detectability.record import polar, title
from giveway.report.style import STYLE
from giveway.scenario.approach import outline_of

if TYPE_CHECKING:
    from matplotlib.projections.polar import PolarAxes

__all__ = ["write_figure"]

COLOURS = {"middle": "#0b64a8", "left": "#c8500a", "right": "#0a8a63"}
LABELS = {"middle": "at the middle", "left": "towards the left end", "right": "towards the right end"}
OUTLINE, OUTLINE_SIZE = "#8a8f98", 0.25  # of the radius


def write_figure(path: Path, found: Detectability) -> None:
    """Write ``path`` (.png or .svg): a polar diagram for each situation and kind."""
    with context(STYLE):
        figure = Figure(figsize=(9.0, 9.2), layout="constrained")
        figure.suptitle(_wrapped(title(found)), x=0.01, ha="left", fontsize=11)
        axes = figure.subplots(2, 2, subplot_kw={"projection": "polar"})
        for row, kind in enumerate((PUSH, IMPULSE)):
            for column, situation in enumerate(SITUATIONS):
                _diagram(axes[row, column], found, situation, kind)
        handles, labels = axes[0, 0].get_legend_handles_labels()
        if handles:
            figure.legend(handles, labels, loc="outside lower center", ncols=len(labels))
        with replace_file(path) as temporary:
            metadata = {"Date": None} if path.suffix == ".svg" else None
            figure.savefig(temporary, dpi=110, metadata=metadata)


def _wrapped(text: str) -> str:
    head, _, rest = text.partition(": ")
    return f"{head}:\n{rest}"


def _diagram(axes: PolarAxes, found: Detectability, situation: str, kind: str) -> None:
    axes.set_title(f"{kind} {situation} ({KINDS[kind].replace('.', ' ')})")
    top = 0.0
    for place, points in polar(found, found.told, situation, kind).items():
        angles = [math.radians(side) for side, _ in points]
        values = [value if math.isfinite(value) else math.nan for _, value in points]
        top = max([top, *(value for value in values if math.isfinite(value))])
        axes.plot([*angles, angles[0]], [*values, values[0]], marker="o", ms=3, color=COLOURS[place],
                  label=LABELS[place])  # fmt: skip
    if top == 0.0:
        axes.text(0.5, 0.5, "none is noticed by 95 % of the robots", transform=axes.transAxes, ha="center")
        axes.set_yticklabels([])
        return
    axes.set_ylim(0.0, 1.1 * top)
    outline = outline_of(found.subject.testbed)
    scale = OUTLINE_SIZE * 1.1 * top / max(math.hypot(x, y) for x, y in outline.tolist())
    corners = [*outline.tolist(), outline[0].tolist()]
    # Sides of a polygon are straight in the plane, not in the diagram's angles.
    sides = [
        (x0 + (x1 - x0) * share / 20.0, y0 + (y1 - y0) * share / 20.0)
        for (x0, y0), (x1, y1) in itertools.pairwise(corners)
        for share in range(21)
    ]
    axes.plot([math.atan2(y, x) for x, y in sides], [scale * math.hypot(x, y) for x, y in sides], color=OUTLINE, lw=1.0)
