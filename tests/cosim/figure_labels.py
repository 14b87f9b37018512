"""What a figure draws, read in the units of its labels and compared with the quantities that it says it draws.

A label of another unit, a factor that is missing, or a quantity of another kind on an axis finds no such quantity.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from giveway.base.errors import GivewayError
from giveway.base.units import factor
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Annotation
from numpy.typing import ArrayLike, NDArray

Unit = tuple[float, str]
"""Size and name: of "force (10 N)" it is (10.0, "N")."""
# What a label could wrongly say instead.
OTHER_UNIT = {
    "mm": "m", "cm": "mm", "m": "mm", "N": "kN", "N m": "N", "N s": "N", "ms": "s", "s": "ms", "m/s": "mm/s",
    "rad": "deg", "deg": "rad", "%": "1", "% of true": "1", "rad/s": "deg/s", "km/h": "m/s",
    "kN": "N", "N m/rad": "N m/deg", "N/mm": "N/m", "1/h": "1/s",
}  # fmt: skip


@dataclass(frozen=True)
class Quantity:
    """Values and their unit."""

    values: NDArray[np.float64]
    unit: str = "1"


@dataclass(frozen=True)
class Curve:
    """A line, a cloud of points, a band, or an arrow from tail to tip."""

    x: Quantity
    y: Quantity


def curve(x: ArrayLike, x_unit: str, y: ArrayLike, y_unit: str) -> Curve:
    return Curve(Quantity(np.asarray(x, dtype=float), x_unit), Quantity(np.asarray(y, dtype=float), y_unit))


def band(x: NDArray[np.float64], x_unit: str, low: ArrayLike, high: ArrayLike, y_unit: str) -> Curve:
    """The corners of what is filled between two curves, in ascending order."""
    both = np.concatenate([np.stack([x, np.broadcast_to(y, x.shape)], axis=1) for y in (low, high)])
    corners = np.unique(both, axis=0)
    return curve(corners[:, 0], x_unit, corners[:, 1], y_unit)


def unit_in(text: str) -> Unit | None:
    """Size and unit of "force (10 N), rising", of "felt force / 10 N" too; None without one."""
    for words in [*re.findall(r"\(([^()]+)\)", text), *re.findall(r" / (\d+ \w+)$", text)]:
        size, unit = re.fullmatch(r"(\d+ )?(.*?)(?: of .*)?", words).groups()  # type: ignore[union-attr]
        unit = unit.replace(" ", ".")
        try:
            factor("unit", unit, unit)
        except GivewayError:
            continue
        return float(size or 1.0), unit
    return None


def title(axes: Axes) -> str:
    return axes.get_title("left") or axes.get_title()


def unit_of_axis(figure: Figure, axes: Axes, which: str) -> Unit | None:
    """From the axis' own label, its title, the label of the panels that it shares its axis with, or the figure's."""
    if found := unit_in(axes.get_xlabel() if which == "x" else axes.get_ylabel()):
        return found
    if which == "y" and (found := unit_in(title(axes))):
        return found
    mine = axes.get_subplotspec()
    assert mine is not None
    for other in figure.axes:
        theirs = other.get_subplotspec()
        if theirs is None:
            continue
        if which == "y" and theirs.rowspan == mine.rowspan and (found := unit_in(other.get_ylabel())):
            return found
        if which == "x" and theirs.colspan == mine.colspan and (found := unit_in(other.get_xlabel())):
            return found
    if which == "y" and (found := unit_in(figure.get_supylabel())):
        return found
    return None


def in_si(values: object, unit: Unit, wanted: str) -> NDArray[np.float64]:
    """Into ``wanted``, a unit of SI; GivewayError: of another kind."""
    return np.asarray(values, dtype=float) * unit[0] * factor("label", unit[1], wanted)


def lines(axes: Axes) -> list[Line2D]:
    """Those with points; neither handles of a legend nor marks across the panel."""
    return [line for line in axes.lines if len(line.get_xydata()) and line.get_transform() == axes.transData]  # type: ignore[arg-type]


def across(axes: Axes, which: str) -> list[float]:
    """Places of the marks across the panel, sorted: "x" of upright ones, "y" of level ones."""
    transform = axes.get_xaxis_transform() if which == "x" else axes.get_yaxis_transform()
    marks = [line for line in axes.lines if line.get_transform() == transform]
    return sorted(float(np.asarray(line.get_xdata() if which == "x" else line.get_ydata())[0]) for line in marks)


def shown(axes: Axes) -> Iterator[tuple[NDArray[np.float64], Unit | None]]:
    """Points of each line, cloud, band and arrow of the panel, shape (n, 2), and the unit of y that is its own."""
    yield from ((np.asarray(line.get_xydata(), dtype=float), unit_in(str(line.get_label()))) for line in lines(axes))
    for found in axes.collections:
        if isinstance(found, PathCollection):
            yield np.asarray(found.get_offsets(), dtype=float), None
        elif isinstance(found, PolyCollection):
            yield np.unique(found.get_paths()[0].vertices, axis=0), None
    for text in axes.texts:
        if isinstance(text, Annotation) and text.arrow_patch is not None:
            yield np.array([text.xyann, text.xy], dtype=float), None


def same(drawn: NDArray[np.float64], wanted: NDArray[np.float64]) -> bool:
    """As many values, and equal but for rounding; NaN, where a line is interrupted, is equal to itself."""
    if drawn.shape != wanted.shape:
        return False
    size = max(float(np.nanmax(np.abs(wanted), initial=0.0)), 1e-12)
    return bool(np.allclose(drawn, wanted, rtol=0.0, atol=1e-9 * size, equal_nan=True))


def is_curve(points: NDArray[np.float64], units: tuple[Unit, Unit], wanted: Curve) -> bool:
    for values, unit, quantity in zip(points.T, units, (wanted.x, wanted.y), strict=True):
        try:
            read = in_si(values, unit, quantity.unit)
        except GivewayError:
            return False
        if not same(read, quantity.values):
            return False
    return True


def check_panel(figure: Figure, axes: Axes, wanted: Sequence[Curve]) -> None:
    """All that the panel shows are the curves ``wanted``, and all of these are there."""
    x_unit, y_unit = (unit_of_axis(figure, axes, which) or (1.0, "1") for which in "xy")
    seen: set[int] = set()
    for number, (points, own) in enumerate(shown(axes)):
        units = (x_unit, own or y_unit)
        found = {index for index, one in enumerate(wanted) if is_curve(points, units, one)}
        assert found, f"{title(axes)}: number {number} of {len(points)} points is no quantity in {units}"
        seen |= found
    assert seen == set(range(len(wanted))), f"{title(axes)}: missing are {set(range(len(wanted))) - seen}"


def check_panels(figure: Figure, panels: Sequence[Sequence[Curve]]) -> None:
    """The same for all panels, in the order in which the figure has them."""
    for axes, wanted in zip(figure.axes, panels, strict=True):
        check_panel(figure, axes, wanted)


def check_planted(figure: Figure, check: Callable[[], Any]) -> None:
    """``check`` passes, and notices every label with another unit, and in every panel a curve that is 1 % larger."""
    check()
    assert _plant_units(figure, check) >= 1
    for axes in figure.axes:
        curves = lines(axes)
        if curves:
            values = np.array(curves[0].get_ydata(), dtype=float)
            curves[0].set_ydata(1.01 * values + 1e-6)
            with pytest.raises(AssertionError):
                check()
            curves[0].set_ydata(values)
    check()


def _plant_units(figure: Figure, check: Callable[[], Any]) -> int:
    planted = 0
    for axes in figure.axes:
        labels: dict[Callable[[str], Any], str] = {
            axes.set_xlabel: axes.get_xlabel(),
            axes.set_ylabel: axes.get_ylabel(),
            # Of no meaning beside a label with a unit.
            lambda text, axes=axes: axes.set_title(text, loc="left"): "" if axes.get_ylabel() else title(axes),
        }
        labels |= {line.set_label: str(line.get_label()) for line in lines(axes)}
        for put, right in labels.items():
            if unit_in(right) is not None:
                put(_replaced(right))
                with pytest.raises(AssertionError):
                    check()
                put(right)
                planted += 1
    return planted


def _replaced(label: str) -> str:
    """``label`` with another unit."""
    for unit, other in OTHER_UNIT.items():
        if f"({unit})" in label:
            return label.replace(f"({unit})", f"({other})", 1)
    if "10 N" in label:
        return label.replace("10 N", "1 N", 1)
    raise AssertionError(f"no other unit for {label}")


def keeping(function: Callable[..., Any], kept: list[Any]) -> Callable[..., Any]:
    """``function``, whose results are put into ``kept``, too."""

    def call(*arguments: Any, **options: Any) -> Any:
        kept.append(function(*arguments, **options))
        return kept[-1]

    return call
