"""What a matplotlib figure draws, as numbers: the page's script draws it again, so that it can be zoomed and asked."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.cbook import STEP_LOOKUP_MAP
from matplotlib.collections import LineCollection, PathCollection, PolyCollection
from matplotlib.colors import to_rgba
from matplotlib.legend import Legend
from matplotlib.text import Annotation
from matplotlib.ticker import FixedFormatter, FuncFormatter

from giveway.report.page import packed

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import Collection
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch
    from matplotlib.text import Text
    from numpy.typing import NDArray

__all__ = ["figure_data"]

POINTS_MAX = 8000  # of a line
PIXELS_PER_POINT = 4.0 / 3.0


def figure_data(figure: Figure, *, points_max: int = POINTS_MAX) -> dict[str, Any]:
    """Axes by row and column, with their lines, points, areas, words and limits in the units of their labels.

    Of a line with more than ``points_max`` points it takes the lowest and highest of every bit.
    """
    drawn = [axes for axes in figure.axes if axes.get_visible() and axes.axison]
    places = [_place(axes, index) for index, axes in enumerate(drawn)]
    found = [_axes(axes, row, column, points_max) for axes, (row, column) in zip(drawn, places, strict=True)]
    for one in found:  # a label that stands at the edge of a grid is that of all its panels
        for name, same in (("x", "column"), ("y", "row")):
            others = [other[name]["label"] for other in found if other[same] == one[same] and other[name]["label"]]
            of_all = figure.get_supxlabel() if name == "x" else figure.get_supylabel()
            one[name]["label"] = one[name]["label"] or next(iter(others), of_all)
    legends = [*figure.legends, *(legend for axes in drawn if (legend := axes.get_legend()) is not None)]
    titles = dict.fromkeys(text for legend in legends if (text := legend.get_title().get_text()))
    return {
        "columns": 1 + max((column for _, column in places), default=0),
        "axes": found,
        "legend": _legend(legends),
        "legend_title": "; ".join(titles),
    }


def _place(axes: Axes, index: int) -> tuple[int, int]:
    spec = axes.get_subplotspec()
    return (index, 0) if spec is None else (spec.rowspan.start, spec.colspan.start)


def _axes(axes: Axes, row: int, column: int, points_max: int) -> dict[str, Any]:
    crossing = [line for line in axes.lines if _is_across(axes, line)]
    return {
        "row": row,
        "column": column,
        "title": axes.get_title() or axes.get_title(loc="left"),
        "equal": axes.get_aspect() != "auto",
        "x": _axis(axes, "x"),
        "y": _axis(axes, "y"),
        "areas": [*_areas(axes), *(_area(axes, patch) for patch in axes.patches)],
        "lines": [_line(line, points_max) for line in axes.lines if line not in crossing],
        "clouds": [_cloud(found) for found in axes.collections if isinstance(found, PathCollection)],
        "segments": [_segments(found) for found in axes.collections if isinstance(found, LineCollection)],
        "across": [_across(line) for line in crossing],
        "words": [_words(axes, text) for text in axes.texts if text.get_text().strip()],
        "arrows": [
            _arrow(text) for text in axes.texts if isinstance(text, Annotation) and text.arrow_patch is not None
        ],
    }


def _axis(axes: Axes, which: str) -> dict[str, Any]:
    axis = axes.xaxis if which == "x" else axes.yaxis
    first, last = axes.get_xlim() if which == "x" else axes.get_ylim()
    # Names of ticks: matplotlib 3.11 has a function where others had a list.
    named = isinstance(axis.get_major_formatter(), FixedFormatter | FuncFormatter)
    places = axis.get_majorticklocs().tolist()
    texts = axis.get_major_formatter().format_ticks(places) if named else []
    ticks = [[float(at), text] for at, text in zip(places, texts, strict=True)] if named else None
    return {
        "label": axis.get_label_text(),
        "first": float(first),
        "last": float(last),
        "log": axis.get_scale() == "log",
        "ticks": ticks,
    }


def _named(label: object) -> str:
    text = str(label)
    return "" if text.startswith("_") else text


def _colour(colour: Any, alpha: float | None = None) -> dict[str, Any]:
    red, green, blue, own = to_rgba(colour)
    return {
        "colour": f"#{round(255 * red):02x}{round(255 * green):02x}{round(255 * blue):02x}",
        "alpha": round(own if alpha is None else alpha, 3),
    }


def _numbers(values: Any) -> NDArray[np.float64]:
    return np.ma.filled(np.ma.asarray(values, dtype=float), np.nan)


def _line(line: Line2D, points_max: int) -> dict[str, Any]:
    x, y = (_numbers(values) for values in line.get_data())
    x, y = STEP_LOOKUP_MAP[line.get_drawstyle()](x, y)
    kept = _thinned(y, points_max)
    style, marker = line.get_linestyle(), line.get_marker()
    marked = marker not in (None, "None", "none", "", " ")
    return {
        "label": _named(line.get_label()),
        **_colour(line.get_color(), line.get_alpha()),
        "width": float(line.get_linewidth()) if style not in ("None", "none", "", " ") else 0.0,
        "dash": style not in ("-", "solid"),
        "marker": float(line.get_markersize()) if marked else 0.0,
        "hollow": line.get_fillstyle() == "none" or line.get_markerfacecolor() == "none" or marker in ("x", "+"),
        "x": packed(x[kept], single=True),
        "y": packed(y[kept], single=True),
    }


def _thinned(y: NDArray[np.float64], points_max: int) -> NDArray[np.intp]:
    """Rows of a curve that are enough to draw it: its ends, and the lowest and highest row of every bit."""
    if len(y) <= points_max:
        return np.arange(len(y))
    bits = np.array_split(np.arange(len(y)), points_max // 2)
    filled = np.where(np.isnan(y), -np.inf, y)
    ends = [rows[place] for rows in bits for place in {int(np.argmin(y[rows])), int(np.argmax(filled[rows]))}]
    return np.unique([0, *ends, len(y) - 1])


def _is_across(axes: Axes, line: Line2D) -> bool:
    """A line over the whole height or width, at one value."""
    return line.get_transform() != axes.transData and np.shape(line.get_xydata())[0] == 2


def _across(line: Line2D) -> dict[str, Any]:
    x, y = (_numbers(values) for values in line.get_data())
    upright = bool(x[0] == x[1])
    return {
        "axis": "x" if upright else "y",
        "at": float(x[0] if upright else y[0]),
        "label": _named(line.get_label()),
        "dash": line.get_linestyle() not in ("-", "solid"),
        **_colour(line.get_color(), line.get_alpha()),
    }


def _cloud(found: PathCollection) -> dict[str, Any]:
    places = _numbers(found.get_offsets())
    faces, edges, sizes = np.atleast_2d(found.get_facecolor()), np.atleast_2d(found.get_edgecolor()), found.get_sizes()
    hollow = not faces.size
    colours = edges if hollow else faces
    return {
        "label": _named(found.get_label()),
        **_colour(colours[0] if colours.size else "black"),
        "hollow": hollow,
        "marker": float(math.sqrt(sizes[0])) if len(sizes) else 3.0,
        "x": packed(places[:, 0].copy(), single=True),
        "y": packed(places[:, 1].copy(), single=True),
    }


def _segments(found: LineCollection) -> dict[str, Any]:
    broken = [np.vstack([_numbers(one), [[np.nan, np.nan]]]) for one in found.get_segments() if len(one)]
    corners = np.vstack(broken) if broken else np.empty((0, 2))
    colours = np.atleast_2d(found.get_colors())
    return {
        **_colour(colours[0] if colours.size else "black"),
        "x": packed(corners[:, 0].copy(), single=True),
        "y": packed(corners[:, 1].copy(), single=True),
    }


def _areas(axes: Axes) -> Iterator[dict[str, Any]]:
    for found in axes.collections:
        if isinstance(found, PolyCollection):
            corners = [np.asarray(path.vertices) for path in found.get_paths() if np.size(path.vertices)]
            yield _filled(found, corners)


def _filled(found: Collection, corners: list[Any]) -> dict[str, Any]:
    faces = np.atleast_2d(found.get_facecolor())
    return {
        "label": _named(found.get_label()),
        **_colour(faces[0] if faces.size else "none"),
        "edge": None,
        **_rings(corners),
    }


def _area(axes: Axes, patch: Patch) -> dict[str, Any]:
    """A shape in the coordinates of its axes."""
    to_data = patch.get_transform() - axes.transData
    rings = patch.get_path().transformed(to_data).to_polygons(closed_only=True)
    edge = to_rgba(patch.get_edgecolor())
    drawn = edge[3] > 0.0 and patch.get_linewidth() > 0.0
    return {
        "label": _named(patch.get_label()),
        **_colour(patch.get_facecolor()),
        "edge": _colour(edge) | {"width": float(patch.get_linewidth())} if drawn else None,
        **_rings(rings),
    }


def _rings(corners: list[Any]) -> dict[str, str]:
    """Polygons one after the other, with NaN between them."""
    broken = [np.vstack([_numbers(ring), [[np.nan, np.nan]]]) for ring in corners]
    points = np.vstack(broken) if broken else np.empty((0, 2))
    return {"x": packed(points[:, 0].copy(), single=True), "y": packed(points[:, 1].copy(), single=True)}


def _words(axes: Axes, text: Text) -> dict[str, Any]:
    shift = (0.0, 0.0)
    where, transform = text.get_position(), text.get_transform()
    coordinates: Any = "data" if transform == axes.transData else transform
    if isinstance(text, Annotation):
        where, coordinates = (text.xyann, text.anncoords)
        if coordinates == "offset points":
            shift = (PIXELS_PER_POINT * float(where[0]), -PIXELS_PER_POINT * float(where[1]))
            where, coordinates = text.xy, text.xycoords
    across, along = _fractions(axes, coordinates)
    return {
        "text": text.get_text(),
        "x": float(where[0]),
        "y": float(where[1]),
        "x_share": across,
        "y_share": along,
        "shift": list(shift),
        "turned": text.get_rotation() != 0.0,
        "side": text.get_horizontalalignment(),
        "upright": text.get_verticalalignment(),
        **_colour(text.get_color()),
    }


def _fractions(axes: Axes, coordinates: Any) -> tuple[bool, bool]:
    """Whether x and y are shares of the panel instead of values."""
    if coordinates == "data":
        return False, False
    if coordinates == axes.get_xaxis_transform():
        return False, True
    return True, coordinates != axes.get_yaxis_transform()


def _arrow(text: Annotation) -> dict[str, Any]:
    patch = text.arrow_patch
    assert patch is not None
    tip, tail = text.xy, text.xyann
    return {
        **_colour(patch.get_edgecolor()),
        "width": float(patch.get_linewidth()),
        "x": [float(tail[0]), float(tip[0])],
        "y": [float(tail[1]), float(tip[1])],
    }


def _legend(legends: list[Legend]) -> list[dict[str, Any]]:
    """Its entries, each once: name, colour, and whether it is a dashed line, a point or an area."""
    found: dict[str, dict[str, Any]] = {}
    for legend in legends:
        for handle, text in zip(legend.legend_handles, legend.get_texts(), strict=True):
            found.setdefault(text.get_text(), {"label": text.get_text(), **_key(handle)})
    return list(found.values())


def _key(handle: Any) -> dict[str, Any]:
    if hasattr(handle, "get_linestyle") and hasattr(handle, "get_marker"):
        line = handle.get_linestyle() not in ("None", "none", "", " ")
        dashed = handle.get_linestyle() not in ("-", "solid")
        return {"kind": ("dash" if dashed else "line") if line else "point", **_colour(handle.get_color())}
    face = np.atleast_2d(handle.get_facecolor())
    colour = face[0] if face.size else np.atleast_2d(handle.get_edgecolor())[0]
    return {"kind": "point" if isinstance(handle, PathCollection) else "area", **_colour(colour)}
