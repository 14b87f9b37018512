"""What a figure's labels say is what it draws: every curve is one of the run's quantities, in the unit of its label.

Curves are found again among the traces and what follows from them, worked out here in SI. `HELD` says where the figures
are held that are not drawn here.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import giveway
import numpy as np
import pytest
import xarray
from figure_labels import Unit, check_planted, in_si, title, unit_in, unit_of_axis
from giveway.base.errors import GivewayError
from giveway.experiments.figures import circle, impact_response, impulse_share, reversal
from giveway.experiments.impulse_trials import Seen
from giveway.report import figures, overview
from giveway.report.runs import Run
from giveway.report.style import COLOURS
from giveway.scenario.scenario import BUMPERS
from giveway.simulation.metrics import Collision
from giveway.simulation.result import Result
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from matplotlib.text import Annotation
from numpy.typing import NDArray

CURVE = 20  # points at least; shorter lines are marks
LABELS = dict(zip(BUMPERS, COLOURS, strict=True))


@dataclass(frozen=True)
class Known:
    """A run's times since the contact, s, when it was detected, s, and what could be drawn: unit and values, in SI."""

    time_s: NDArray[np.float64]
    detected_s: float
    quantities: list[tuple[str, NDArray[np.float64]]]


def known(result: Result) -> Known:
    traces, testbed = result.traces, result.manifest["parameters"]["testbed"]
    value = {str(name): trace.values.astype(float) for name, trace in traces.data_vars.items()}
    found = [(str(trace.attrs.get("units", "1")), value[str(name)]) for name, trace in traces.data_vars.items()]
    time = traces["time"].values
    contact_s = value["testbed.truth.first_contact_time"][-1]
    row = int(np.searchsorted(time, contact_s))
    along = math.cos(testbed["slider.direction"]), math.sin(testbed["slider.direction"])
    for x, y in (
        ("testbed.truth.x", "testbed.truth.y"),
        ("controller.reference.x", "controller.reference.y"),
        ("testbed.truth.nose_x", "testbed.truth.nose_y"),
    ):
        found.append(("m", along[0] * (value[x] - value[x][row]) + along[1] * (value[y] - value[y][row])))
    for source in ("testbed.truth", "controller.reference"):
        found.append(("m/s", along[0] * value[f"{source}.vx"] + along[1] * value[f"{source}.vy"]))
    slider, wheel = value["testbed.truth.slider_position"], value["testbed.truth.wheel_angle[0]"]
    found.append(("m", slider - slider[row]))
    found.append(("m", float(testbed["wheel.radius"]) * (wheel - wheel[row])))
    found.append(("N.s", np.hypot(*(value[f"testbed.truth.contact_impulse_{axis}"] for axis in "xy"))))
    force = [value[f"controller.estimate.force_{axis}"] * (time >= contact_s) for axis in "xy"]
    found.append(("N.s", np.hypot(*(np.cumsum(one) * (time[1] - time[0]) for one in force))))
    counts = np.diff(value["controller.detection.count"], prepend=0.0)
    detected = np.flatnonzero((counts > 0.0) & (time >= contact_s))
    return Known(time - contact_s, time[detected[0]] - contact_s, found)


def is_found(line: Line2D, x_unit: Unit, y_unit: Unit, run: Known) -> bool:
    """The curve is a quantity of ``run``, over times of it, but for the sign."""
    at_s = in_si(line.get_xdata(), x_unit, "s")
    rows = np.clip(np.searchsorted(run.time_s, at_s - 1e-6), 0, len(run.time_s) - 1)
    if np.abs(run.time_s[rows] - at_s).max() > 1e-9:
        return False
    for unit, values in run.quantities:
        try:
            drawn = in_si(line.get_ydata(), y_unit, unit)
        except GivewayError:
            continue
        same = min(np.abs(drawn - values[rows]).max(), np.abs(drawn + values[rows]).max())
        if same <= 1e-9 * max(np.abs(drawn).max(), 1e-12):
            return True
    return False


def check(figure: Figure, runs: list[Known], panels: range | None = None) -> tuple[int, int]:
    """How many curves and marks of the detection were found again; the assertion names one that was not."""
    curves = marks = 0
    for number, axes in enumerate(figure.axes):
        if panels is not None and number not in panels:
            continue
        x_unit = unit_of_axis(figure, axes, "x")
        assert x_unit, f"no unit: {title(axes)}, {axes.get_xlabel()}"
        for line in axes.lines:
            x = np.asarray(line.get_xdata(), dtype=float)
            if len(x) >= CURVE:
                y_unit = unit_in(str(line.get_label())) or unit_of_axis(figure, axes, "y")
                assert y_unit, f"no unit: {title(axes)}, {axes.get_ylabel()}"
                words = f"{title(axes)}: {line.get_label()}: no quantity in {y_unit[1]} over {x_unit[1]}"
                assert any(is_found(line, x_unit, y_unit, run) for run in runs), words
                curves += 1
            elif len(x) == 2 and x[0] == x[1] and line.get_linestyle() == "--":
                at_s = in_si(x[0], x_unit, "s")
                assert any(abs(at_s - run.detected_s) < 1e-9 for run in runs), title(axes)
                marks += 1
    return curves, marks


def by_label(full_runs: Mapping[str, Result]) -> dict[str, Result]:
    return {LABELS[bumper]: result for bumper, result in full_runs.items()}


def of_report(number: int) -> Callable[[dict[str, Result]], Figure]:
    def draw(results: dict[str, Result]) -> Figure:
        return figures._FIGURES[number][2]([Run(label, result) for label, result in results.items()])

    return draw


def of_overview(results: dict[str, Result]) -> Figure:
    runs = [Run(label, result) for label, result in results.items()]
    figure = Figure()
    forces, escapes = figure.subplots(2, 1)
    overview._forces(forces, runs)
    overview._escapes(escapes, runs)
    return figure


def of_reversal(results: dict[str, Result]) -> Figure:
    label = LABELS["magnetic"]
    return reversal.draw(label, results[label])


DRAWN: dict[str, tuple[Callable[[dict[str, Result]], Figure], int, int]] = {  # and how many curves, how many marks
    "contact force": (of_report(0), 3, 3),
    "wheel torques": (of_report(1), 9, 9),
    "positions": (of_report(2), 18, 6),
    "estimates": (of_report(3), 12, 6),
    "impact response": (impact_response.draw, 12, 0),
    "overview": (of_overview, 6, 3),
    "reversal": (of_reversal, 11, 3),
}


def test_every_figure_of_the_report_is_there() -> None:
    assert len(figures._FIGURES) == 4


@pytest.mark.parametrize("name", DRAWN)
def test_curves_are_quantities_in_the_units_of_their_labels(name: str, full_runs: dict[str, Result]) -> None:
    draw, curves, marks = DRAWN[name]
    results = by_label(full_runs)
    figure = draw(results)
    runs = [known(result) for result in results.values()]
    found = check(figure, runs)
    assert found[0] == curves
    assert found[1] >= marks


@pytest.mark.parametrize("name", DRAWN)
def test_a_label_of_another_unit_would_be_noticed(name: str, full_runs: dict[str, Result]) -> None:
    results = by_label(full_runs)
    figure, runs = DRAWN[name][0](results), [known(result) for result in results.values()]
    check_planted(figure, lambda: check(figure, runs))


def of_impulse_share() -> tuple[Figure, list[Known]]:
    """Four kinds of hit, each seen by three forms of the estimator with two seeds."""
    time_s, rng, runs = np.linspace(0.0, 0.3, 301), np.random.default_rng(1), []
    hits: dict[str, dict[str, Seen]] = {}
    for hit in ("light", "hard", "oblique", "at a corner"):
        true = rng.uniform(0.0, 3.0, (2, time_s.size))
        hits[hit] = {form: Seen(time_s, true, rng.uniform(0.0, 3.0, true.shape)) for form in ("a", "b", "c")}
        means = [true.mean(axis=0), *(form.seen.mean(axis=0) for form in hits[hit].values())]
        runs.append(Known(time_s, math.nan, [("N.s", mean) for mean in means]))
    return impulse_share.draw(hits, 0.1), runs


def of_alarm() -> tuple[Figure, list[Known]]:
    """The detector's statistic of three robots; the highest of each tenth of a second is drawn."""
    time_s = np.arange(10_000) / 1000.0
    statistic = np.random.default_rng(2).uniform(0.0, 0.5, (3, time_s.size))
    traces = {"controller.detection.statistic": statistic, "controller.detection.count": np.zeros(statistic.shape)}
    data = xarray.Dataset({name: (("run", "time"), values) for name, values in traces.items()}, {"time": time_s})
    highest = statistic.reshape(3, -1, 100).max(axis=2)
    runs = [Known(time_s[::100], math.nan, [("N.s", one) for one in highest])]
    return circle.alarm({"by the paper": ((-0.1, 0.0, 0.1), data)}, 0.6), runs


ALONE = {"impulse share": (of_impulse_share, 16), "alarm on the circle": (of_alarm, 3)}  # and how many curves


@pytest.mark.parametrize("name", ALONE)
def test_curves_of_figures_without_a_run_are_in_the_units_of_their_labels(name: str) -> None:
    draw, curves = ALONE[name]
    figure, runs = draw()
    assert check(figure, runs)[0] == curves
    check_planted(figure, lambda: check(figure, runs))


def test_the_picture_from_above_is_in_metres(full_runs: dict[str, Result]) -> None:
    """The robot at the contact, and an arrow to the estimated point: 10 mm for each newton of the estimated force."""
    result = full_runs["magnetic"]
    figure = Figure()
    axes = figure.subplots()
    overview._top_view(axes, Run(LABELS["magnetic"], result))
    assert (unit_in(axes.get_xlabel()), unit_in(axes.get_ylabel())) == ((1.0, "m"), (1.0, "m"))
    hit, testbed = Run(LABELS["magnetic"], result).hit, result.manifest["parameters"]["testbed"]
    row, detected = hit.start, hit.detected
    assert detected is not None
    corners = np.array([[testbed[f"outline.{axis}[{i}]"] for axis in "xy"] for i in range(3)])
    outlines = [patch.get_xy()[:-1] for patch in axes.patches if isinstance(patch, Polygon)]
    assert any(np.allclose(one, in_world(hit, row, corners), atol=1e-12) for one in outlines)
    force = np.array([hit[f"controller.detection.force_{axis}"][detected] for axis in "xy"])
    point = np.array([hit[f"controller.detection.point_{axis}"][detected] for axis in "xy"])
    tip, tail = in_world(hit, detected, np.stack([point, point - 0.01 * force]))
    arrows = [(text.xyann, text.xy) for text in axes.texts if isinstance(text, Annotation)]
    assert any(np.allclose(ends, (tail, tip), atol=1e-12) for ends in arrows)


def in_world(hit: Collision, row: int, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points of the base frame, shape (n, 2), m."""
    x, y, theta = (float(hit[f"testbed.truth.{name}"][row]) for name in ("x", "y", "theta"))
    cos, sin = math.cos(theta), math.sin(theta)
    return np.asarray(points @ [[cos, sin], [-sin, cos]] + [x, y])


HERE = "test_figure_units.py"
HELD = {  # module and function that make a figure: the file that holds its labels against what it draws
    "crowd/curves/figure.py draw": "test_crowd_curves.py",
    "detectability/figure.py write_figure": "test_detectability.py",
    "drivetrain/pictures.py picture": "test_drivetrain_margins.py",
    "experiments/clamping.py _figure": "test_experiment_clamping.py",
    "experiments/figures/circle.py alarm": HERE,
    "experiments/figures/impact_response.py draw": HERE,
    "experiments/figures/impulse_share.py draw": HERE,
    "experiments/figures/reversal.py draw": HERE,
    "experiments/figures/scene_view.py scenes_figure": "test_experiment_scenes.py",
    "experiments/figures/static_pushes.py _clouds": "test_experiment_static_pushes.py",
    "experiments/figures/static_pushes.py _groups": "test_experiment_static_pushes.py",
    "experiments/figures/static_pushes.py _placements": "test_experiment_static_pushes.py",
    "experiments/tipping.py _picture": "test_experiment_tipping.py",
    "fmu_tools/page.py _figure": "test_fmu_run.py",
    "identification/figures.py residual_figure": "test_experiment_roller_calibration.py",
    "identification/figures.py torque_figure": "test_experiment_roller_calibration.py",
    "notebook/page.py _designs": "test_notebooks.py",
    "notebook/page.py _forces": "test_notebooks.py",
    "own_robot/drawing.py draw": "test_own_robot_files.py",
    "report/figures.py _panels": HERE,
    "report/overview.py overview": HERE,
    "report/push_path.py path": "test_experiment_circle.py",
    "report/pushes.py _forces": "test_push_metrics.py",
    "study/evidence_page.py forces": "test_study_evidence.py",
    "study/figures.py growth": "test_study_units.py",
    "study/figures.py sensitivities": "test_study_units.py",
    "study/gallery.py latch_figure": "test_study_gallery.py",
    "study/gallery.py sensor_figure": "test_study_gallery.py",
}


def test_every_figure_is_held() -> None:
    """A new figure needs a test of its labels, and its line here."""
    package, found = Path(giveway.__file__).parent, set()
    for path in package.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)) if "Figure(" in text else ():
            if isinstance(node, ast.FunctionDef) and any(
                isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "Figure"
                for call in ast.walk(node)
            ):
                found.add(f"{path.relative_to(package).as_posix()} {node.name}")
    assert found == set(HELD)
    for test in set(HELD.values()):
        assert re.search(r"unit_in|check_planted|in_si", (Path(__file__).parent / test).read_text(encoding="utf-8"))
