"""A run of pushes is judged by its pushes: one row each, against truth that follows by hand."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path

import giveway
import numpy as np
import pytest
import xarray
from cosim_helpers import Cli
from figure_labels import across, band, check_panels, check_planted, curve
from giveway import batch
from giveway.report import pushes, render
from giveway.report.animation import scene
from giveway.scenario.plan import Pushes, TimedPush
from giveway.simulation.metrics import Metric
from giveway.simulation.push_response import TRACES, push_metrics, responses, responses_of
from giveway.simulation.result import Result
from giveway.simulation.summary import false_detection_line, push_rows
from page_arrays import data_of

EXAMPLE = Path(__file__).parents[2] / "examples" / "pushed_on_a_circle.toml"
STEP_S = 0.001
# 40 N along 30 deg for 0.3 s from 1 s on; the robot's heading is 20 deg, so 10 deg in the base frame.
PUSH = TimedPush(40.0, math.radians(30.0), 0.1, 0.05, 1.0, 0.3)
PARAMETERS = {"controller": {"estimator.average_window": 20, "controller.period": STEP_S}}


def judged(detected_s: tuple[float, ...], force_n: float = 30.0) -> list[dict[str, Metric]]:
    """4 s; 10 ms late the controller estimates ``force_n`` along 14 deg, and a point 3 and 4 cm beside the true one."""
    time_s = np.arange(4001) * STEP_S
    pushed = (time_s >= 1.0 - 1e-9) & (time_s < 1.3 - 1e-9)
    felt = (time_s >= 1.01 - 1e-9) & (time_s < 1.31 - 1e-9)
    traces = {name: np.zeros(len(time_s)) for name in TRACES}
    traces["controller.mode"][:] = 1
    traces["testbed.truth.theta"][:] = math.radians(20.0)
    traces["controller.estimate.force"] = force_n * felt
    for axis, turn in (("x", math.cos), ("y", math.sin)):
        traces[f"testbed.push.force_{axis}"] = 40.0 * turn(PUSH.direction_rad) * pushed
        traces[f"controller.estimate.force_{axis}"] = force_n * turn(math.radians(14.0)) * felt
    traces["controller.detection.point_x"] = np.full(len(time_s), 0.13)
    traces["controller.detection.point_y"] = np.full(len(time_s), 0.09)
    for at in detected_s:
        row = round(at / STEP_S)
        traces["controller.detection.count"][row:] += 1
        traces["controller.detection.direction"][row:] = math.radians(14.0)
        traces["testbed.truth.x"][row:] += 0.5 * np.clip(time_s[row:] - at, 0.0, 1.0)
        traces["controller.mode"][row : row + 1000] = 2
    data = xarray.Dataset({name: ("time", values) for name, values in traces.items()}, coords={"time": time_s})
    found = responses((PUSH,), time_s, lambda name: data[name].values)
    return [{metric.name: metric for metric in push_metrics(one, data, PARAMETERS)} for one in found.pushes]


def test_a_push_that_is_felt() -> None:
    (found,) = judged((1.1,))
    near = pytest.approx
    assert found["felt after"].value == near(100.0, abs=1e-6)  # from the start of the push
    assert found["detections"].value == 1.0
    assert (found["force direction"].value, found["force direction"].truth) == (near(14.0), near(10.0))
    # The last 20 rows before the detection are all within the push.
    assert (found["force at detection"].value, found["force at detection"].truth) == (near(30.0), near(40.0))
    assert found["impulse at detection"].value == near(30.0 * 0.09)  # felt 10 ms late
    assert found["impulse at detection"].truth == near(40.0 * 0.1)
    assert (found["contact point x"].value, found["contact point x"].truth) == (near(130.0), near(100.0))
    assert found["location error"].value == near(50.0)  # 3-4-5 triangle
    assert found["gives way by"].value == near(0.5)
    assert found["back on the path after"].value == near(1.1)


def test_the_true_force_is_averaged_over_what_the_filter_has_seen() -> None:
    (early,) = judged((1.012,))
    # Of the 20 samples up to then, 12 ms were pushed.
    assert early["force at detection"].truth == pytest.approx(40.0 * 12 / 20)


def test_a_push_that_is_missed_has_no_numbers() -> None:
    (found,) = judged(())
    assert found.pop("detections").value == 0.0
    assert all(metric.value is None and metric.truth is None for metric in found.values())


def test_a_push_that_is_felt_twice_says_so() -> None:
    (found,) = judged((1.1, 1.5))
    assert found["detections"].value == 2.0
    assert found["felt after"].value == pytest.approx(100.0, abs=1e-6)


@pytest.fixture(scope="module")
def pushed() -> Result:
    return batch.run(giveway.read_scenario(EXAMPLE))


def test_the_example_feels_both_pushes_and_nothing_else(pushed: Result) -> None:
    assert len(pushed.pushes) == 2
    for push, (force_n, start_s) in zip(pushed.pushes, ((50.0, 5.0), (40.0, 23.0)), strict=True):
        found = {metric.name: metric for metric in push}
        assert 30.0 < (found["felt after"].value or 0.0) < 150.0
        assert found["detections"].value == 1.0
        direction, force = (found[name] for name in ("force direction", "force at detection"))
        # At the decision, while the force still rises: 15 deg, and some of it.
        assert abs((direction.value or 0.0) - (direction.truth or 0.0)) < 15.0
        assert 0.1 * force_n < (force.value or 0.0) < force_n
        # The escape turns once the direction is known better.
        assert found["gives way by"].value == pytest.approx(0.5, abs=0.03)
        assert start_s == 5.0 or found["back on the path after"].value is None  # the run ends before
    assert pushed.metric("false detections").value == 0.0
    assert false_detection_line(pushed) == ""
    assert pushed.warnings == ()


def test_the_controller_gets_sharper_after_the_decision(pushed: Result) -> None:
    """60 ms later each push is known to 5 deg and 2 cm; the robot faces along x."""
    count = pushed.traces["controller.detection.count"].values
    rows = np.flatnonzero(np.diff(count) > 0) + 1 + 60
    assert pushed.manifest["scenario"]["preset"] == "default"
    for row, push in zip(rows, giveway.read_scenario(EXAMPLE).push.pushes, strict=True):  # type: ignore[union-attr]
        felt = (
            pushed.traces[f"controller.detection.{name}"].values[row] for name in ("direction", "point_x", "point_y")
        )
        direction, x, y = (float(value) for value in felt)
        assert math.degrees(direction - push.direction_rad) == pytest.approx(0.0, abs=5.0)
        assert math.hypot(x - push.point_x_m, y - push.point_y_m) < 0.02


def test_nothing_of_a_collision_is_listed_where_nothing_can_be_hit(pushed: Result) -> None:
    names = [metric.name for metric in pushed.metrics]
    assert names == ["false detections", "distance from the plan", "angle from the plan", "energy residual"]


def test_its_page_has_a_row_and_a_plot_per_push(pushed: Result) -> None:
    page = render("pushed", "", [pushed])
    for words in ("<h2>Pushes</h2>", "1: 50 N at 5 s", "2: 40 N at 23 s", "<h2>Each push</h2>", "Path and pushes"):
        assert words in page
    assert "Wheel torques" not in page  # figures of a collision would be empty
    (shown,) = data_of(page)["scenes"]
    found = scene("pushed", pushed)
    assert shown["time"] == found["time"]
    assert [touch["what"] for touch in found["touches"]] == ["push", "push"]
    assert [touch["time"] for touch in found["touches"]] == [0.0, 18.0]
    late_s = [touch["detection"]["time"] - touch["time"] for touch in found["touches"]]
    assert late_s == pytest.approx([1e-3 * (push[0].value or 0.0) for push in pushed.pushes], abs=1e-4)


def test_the_plots_labels_say_what_they_draw(pushed: Result) -> None:
    figure = pushes._forces(pushed, responses_of(pushed.traces, pushed.manifest).pushes)
    panels = []
    for push in giveway.read_scenario(EXAMPLE).push.pushes:  # type: ignore[union-attr]
        since_s = pushed.traces["time"].values - push.start_s
        rows = (since_s >= -0.1) & (since_s <= push.duration_s + 0.4)
        true = np.hypot(*(pushed.traces[f"testbed.push.force_{axis}"].values[rows] for axis in "xy"))
        felt = pushed.traces["controller.estimate.force"].values[rows]
        panels.append([curve(since_s[rows], "s", felt, "N"), band(since_s[rows], "s", 0.0, true, "N")])
    check_planted(figure, lambda: check_panels(figure, panels))
    for axes, metrics in zip(figure.axes, pushed.pushes, strict=True):
        assert 1e3 * np.array(across(axes, "x")) == pytest.approx([metrics[0].value])  # ms


def test_rows_are_kept_with_the_run(pushed: Result, tmp_path: Path) -> None:
    again = giveway.load(pushed.save(tmp_path / "run"))
    assert again.pushes == pushed.pushes
    assert push_rows(again) == push_rows(pushed)
    stored = json.loads((tmp_path / "run" / "metrics.json").read_text(encoding="utf-8"))["pushes"]
    assert [push[0]["name"] for push in stored] == ["felt after", "felt after"]


@pytest.fixture(scope="module")
def by_the_paper() -> Result:
    """The example with the paper's estimator, which takes the start of its return for a push; the next comes then."""
    scenario = giveway.read_scenario(EXAMPLE)
    first, second = scenario.push.pushes  # type: ignore[union-attr]
    schedule = Pushes((first, dataclasses.replace(second, start_s=17.0)))
    return batch.run(dataclasses.replace(scenario, preset="paper", duration_s=21.0, push=schedule))


def test_what_no_push_caused_is_told_with_its_times(by_the_paper: Result) -> None:
    rows = push_rows(by_the_paper)
    assert {"felt after, ms", "detections", "force direction, deg"} <= set(rows[0])  # counts have no unit
    assert [row[1] for row in rows[1:]] == [rows[1][1], "not felt"]  # it was still giving way
    assert by_the_paper.metric("false detections").value == 3.0
    line = false_detection_line(by_the_paper)
    assert line.startswith("False detections, with no push in the 0.25 s before: at ")
    assert line.count(".") == 4
    assert line in render("pushed", "", [by_the_paper])


def test_the_rows_and_the_metric_have_one_definition(by_the_paper: Result) -> None:
    found = responses_of(by_the_paper.traces, by_the_paper.manifest)
    assert len(found.false_s) == by_the_paper.metric("false detections").value
    native = batch.run_many([dataclasses.replace(giveway.read_scenario(EXAMPLE), preset="paper", duration_s=21.0)])
    assert float(native["false detections"][0]) > 0.0


def test_a_push_that_had_not_begun_is_not_missed(by_the_paper: Result) -> None:
    scenario = giveway.read_scenario(EXAMPLE)
    result = batch.run(dataclasses.replace(scenario, duration_s=8.0))
    assert len(result.pushes) == 1


def test_the_terminal_shows_a_row_per_push(cli: Cli) -> None:
    said = cli("run", str(EXAMPLE), "--out", "out", "--duration", "8")
    assert said.returncode == 0, said.stderr
    assert "how each push was felt (true)" in said.stdout
    assert "1: 50 N at 5 s" in said.stdout
    assert "detection time" not in said.stdout
