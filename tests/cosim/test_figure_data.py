"""What a page's script is given of a figure is what the figure draws."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from giveway.report.figure_data import POINTS_MAX, figure_data
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from page_arrays import page_values


def points(data: dict[str, Any]) -> list[tuple[float, float]]:
    return list(zip(page_values(data["x"]).tolist(), page_values(data["y"]).tolist(), strict=True))


@pytest.fixture
def data() -> dict[str, Any]:
    figure = Figure()
    left, right = figure.subplots(1, 2, sharey=True)
    left.plot([0.0, 1.0, 2.0], [3.0, np.nan, 5.0], "--", color="#0b64a8", label="a line")
    left.scatter([1.0, 2.0], [4.0, 5.0], s=16.0, color="#c8500a", label="points")
    left.axvline(1.5, color="#b3261e", label="_nothing")
    left.fill_between([0.0, 1.0], [1.0, 2.0], alpha=0.25)
    left.set(xlabel="time (s)", ylabel="force (N)", title="left", xlim=(0.0, 4.0))
    right.step([0.0, 2.0], [1.0, 2.0], where="mid", color="#0a8a63")
    right.add_patch(Rectangle((1.0, 2.0), 2.0, 1.0, facecolor="none", edgecolor="#2b2f36"))
    right.annotate("peak", (1.0, 2.0), (0, 8), textcoords="offset points", ha="center")
    right.annotate("", (2.0, 3.0), (1.0, 1.0), arrowprops={"arrowstyle": "->"})
    right.set(xlabel="speed (m/s)", xscale="log", aspect="equal")
    figure.legend(*left.get_legend_handles_labels(), title="what")
    found: dict[str, Any] = json.loads(json.dumps(figure_data(figure), allow_nan=False))
    return found


def test_lines_points_and_areas_have_their_values(data: dict[str, Any]) -> None:
    left, right = data["axes"]
    (line,), (cloud,) = left["lines"], left["clouds"]
    assert (line["label"], line["colour"], line["dash"], line["marker"]) == ("a line", "#0b64a8", True, 0.0)
    np.testing.assert_array_equal(points(line), [(0.0, 3.0), (1.0, np.nan), (2.0, 5.0)])
    assert points(cloud) == [(1.0, 4.0), (2.0, 5.0)]
    assert (cloud["colour"], cloud["marker"]) == ("#c8500a", 4.0)
    assert {(0.0, 1.0), (1.0, 2.0), (1.0, 0.0)} <= set(points(left["areas"][0]))
    assert left["areas"][0]["alpha"] == 0.25
    assert points(right["lines"][0]) == [(0.0, 1.0), (1.0, 1.0), (1.0, 2.0), (2.0, 2.0)]
    assert {(1.0, 2.0), (3.0, 3.0)} <= set(points(right["areas"][0]))
    assert right["areas"][0]["alpha"] == 0.0
    assert right["areas"][0]["edge"]["colour"] == "#2b2f36"


def test_axes_limits_words_and_arrows_are_there(data: dict[str, Any]) -> None:
    left, right = data["axes"]
    assert data["columns"] == 2
    assert [(one["row"], one["column"]) for one in data["axes"]] == [(0, 0), (0, 1)]
    assert (left["x"]["label"], left["x"]["first"], left["x"]["last"]) == ("time (s)", 0.0, 4.0)
    assert right["y"]["label"] == left["y"]["label"] == "force (N)"  # of the whole row
    assert (right["x"]["log"], right["equal"], left["equal"]) == (True, True, False)
    assert [(one["axis"], one["at"], one["label"]) for one in left["across"]] == [("x", 1.5, "")]
    (word,), (arrow,) = right["words"], right["arrows"]
    assert (word["text"], word["x"], word["y"], word["side"]) == ("peak", 1.0, 2.0, "center")
    assert word["shift"][1] == pytest.approx(-32.0 / 3.0)
    assert (arrow["x"], arrow["y"]) == ([1.0, 2.0], [1.0, 3.0])
    assert [(one["label"], one["kind"]) for one in data["legend"]] == [("a line", "dash"), ("points", "point")]
    assert data["legend_title"] == "what"


def test_long_curves_keep_their_peaks_and_ends() -> None:
    figure = Figure()
    y = np.sin(np.linspace(0.0, 300.0, 100_000))
    y[54_321] = 7.0
    figure.subplots().plot(y)
    (line,) = figure_data(figure)["axes"][0]["lines"]
    drawn = points(line)
    assert len(drawn) <= POINTS_MAX + 2
    assert (54_321.0, 7.0) in drawn
    assert (drawn[0][0], drawn[-1][0]) == (0.0, 99_999.0)
