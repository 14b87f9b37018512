"""Limits as named lines across a panel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from giveway.base.units import WrittenUnit
from giveway.study.limits import limit_of, limit_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from giveway.study.answers import Answers

__all__ = ["DETECTION", "FORCES", "LIMIT_COLOUR", "LimitLine", "draw_limits", "limit_lines", "limits_of_metrics",
           "unit_of"]  # fmt: skip

LIMIT_COLOUR = "#b3261e"
BACKGROUND = {"boxstyle": "round,pad=0.12", "facecolor": "white", "edgecolor": "none", "alpha": 0.85}
FORCES = ("peak force of the run", "peak force of the first contact", "transient force", "lasting force")
"""Metrics of the contact force."""
DETECTION = "detection time"


@dataclass(frozen=True)
class LimitLine:
    """A limit in the unit of its axis, and its name."""

    at: float
    words: str


def limit_lines(answers: Answers, index: int) -> list[LimitLine]:
    """The limits of what goal ``index`` measures, in its unit; with how they are taken over runs, if otherwise."""
    offset, unit, name = len(answers.setup.objectives), answers.goal_unit(index), answers.goal_name(index)
    found = []
    for number, one in enumerate(answers.setup.constraints):
        if one.goal.metric.name != answers.goals[index].metric.name:
            continue
        words, its = limit_words(answers.setup, number), answers.goal_name(offset + number)
        over = its.removeprefix(one.goal.metric.name).removeprefix(", ")
        words += f", {over}" if its != name and over else ""
        found.append(LimitLine(unit.of(limit_of(one)), words))
    return found


def limits_of_metrics(answers: Answers, metrics: Sequence[str], unit: WrittenUnit) -> list[LimitLine]:
    """The limits of any of the ``metrics``, in ``unit``, with the metric's name."""
    return [
        LimitLine(unit.of(limit_of(one)), f"{one.goal.metric.name} {limit_words(answers.setup, number)}")
        for number, one in enumerate(answers.setup.constraints)
        if one.goal.metric.name in metrics
    ]


def unit_of(answers: Answers, metrics: Sequence[str], unit: str) -> WrittenUnit:
    """The unit in which the user wrote a limit of one of the ``metrics``; else ``unit``."""
    written = (one.written for one in answers.setup.constraints if one.goal.metric.name in metrics)
    return next((found for found in written if found is not None), WrittenUnit(unit))


def draw_limits(axes: Axes, limits: list[LimitLine], which: str, named: bool = True) -> None:
    """Draw limits of what is on the axis ``which``, "x" or "y"; one that is far from the data is named at the edge."""
    low, high = axes.get_xlim() if which == "x" else axes.get_ylim()
    reach = high - low
    for limit in limits:
        inside = low - reach <= limit.at <= high + reach
        if inside:
            line = axes.axvline if which == "x" else axes.axhline
            line(limit.at, color=LIMIT_COLOUR, lw=1.1, ls=(0, (5, 2)), zorder=4)
        if named:
            words = limit.words if inside else f"{limit.words}: {'above' if limit.at > high else 'below'} this range"
            _name(axes, words, limit.at if inside else None, which, limit.at > high)


def _name(axes: Axes, words: str, at: float | None, which: str, above: bool) -> None:
    """Write ``words`` at the line, or at the edge of the panel."""
    style = {"fontsize": 7.5, "color": LIMIT_COLOUR, "bbox": BACKGROUND, "zorder": 6}
    edge = 0.99 if above else 0.01
    upright = "top" if above else "bottom"
    if which == "x":
        place, coordinates = ((edge, 0.98), "axes fraction") if at is None else ((at, 0.98), axes.get_xaxis_transform())
        side = "right" if at is not None or above else "left"
        axes.annotate(words, place, xycoords=coordinates, rotation=90, ha=side, va="top", **style)  # type: ignore[arg-type]
    else:
        place, coordinates = ((0.99, edge), "axes fraction") if at is None else ((0.99, at), axes.get_yaxis_transform())
        up = "bottom" if at is not None else upright
        axes.annotate(words, place, xycoords=coordinates, ha="right", va=up, **style)  # type: ignore[arg-type]
