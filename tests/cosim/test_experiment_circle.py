"""The paper's 5.4 for real: pushed on a circle, noticed, gave way along the push, came back."""

from __future__ import annotations

import math

import giveway
import numpy as np
import pytest
from figure_labels import Curve, check_panels, check_planted, curve, keeping
from giveway import batch
from giveway.base.errors import GivewayError
from giveway.experiments import circle
from giveway.experiments.reproduction.findings import Effort, Findings
from giveway.robot.variables import table
from giveway.simulation import runner
from giveway.simulation.push_response import Responses, responses
from giveway.simulation.result import Result
from matplotlib.patches import Polygon
from numpy.typing import ArrayLike, NDArray


@pytest.fixture(scope="module")
def runs() -> list[Result]:
    """Those of the findings that are run alone: a pushed round with either estimator, then one without pushes."""
    return []


@pytest.fixture(scope="module")
def findings(runs: list[Result]) -> Findings:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(runner, "run", keeping(runner.run, runs))
        return circle.reproduce(Effort(full=False))


@pytest.fixture(scope="module")
def pushed() -> Responses:
    """The whole round with all pushes, as `giveway run circle` makes it."""
    scenario = giveway.experiment("circle").scenario("none")
    traces = batch.run(scenario).traces
    return responses(scenario.push.pushes, traces["time"].values, lambda name: traces[name].values)  # type: ignore[union-attr]


def row(findings: Findings, start: str) -> float | None:
    (found,) = (one for one in findings.rows if one.quantity.startswith(start))
    return found.ours


def test_every_push_is_noticed_and_none_invented(pushed: Responses) -> None:
    assert pushed.detected == len(circle.BY_HAND) == 6
    assert pushed.invented_s == ()


def test_it_moves_away_along_the_push(pushed: Responses) -> None:
    for one in pushed.pushes:
        assert abs(one.escape_error_deg) < 12.0  # the paper's largest error of a direction
        assert one.escape_m == pytest.approx(0.5, abs=0.05)  # it had 0.16 m/s in another direction before


def test_it_comes_back_to_its_path(pushed: Responses) -> None:
    assert pushed.returned == 6
    # Undisturbed it is up to 6 mm off, by the lag of the servo; a lasting error would be as large as an escape.
    assert pushed.off_path_m < 0.01


def test_pushes_come_from_all_sides_and_push_into_the_robot() -> None:
    scenario = circle.scenario()
    directions = [push.direction_rad for push in scenario.push.pushes]  # type: ignore[union-attr]
    points = [(push.point_x_m, push.point_y_m) for push in scenario.push.pushes]  # type: ignore[union-attr]
    assert {side for side, *_ in circle.BY_HAND} == {0, 1, 2}
    for direction, point in zip(directions, points, strict=True):
        inwards = math.cos(direction) * point[0] + math.sin(direction) * point[1]
        assert inwards < 0.0


def test_the_plan_is_the_papers_circle() -> None:
    table = circle.scenario().plan(np.linspace(3.0, 33.0, 100))
    np.testing.assert_allclose(np.hypot(table[:, 0], table[:, 1]), 0.75, rtol=1e-12)
    np.testing.assert_allclose(np.hypot(table[:, 3], table[:, 4]), 0.16, rtol=1e-12)


def test_the_reduced_experiment_has_every_row(findings: Findings) -> None:
    by_name = {one.quantity: one for one in findings.rows}
    assert len(by_name) == len(findings.rows)
    assert by_name["pushes noticed, of 2"].met
    assert by_name["pushes invented"].met
    assert by_name["false alarms in 0.01 h undisturbed, full estimator"].ours == 0.0
    assert all(one.ours is not None for one in findings.rows)
    assert [picture.name for picture in findings.pictures] == ["path", "alarm"]


def test_the_undisturbed_rounds_start_from_all_headings_and_encoder_phases() -> None:
    runs = circle.undisturbed_runs(circle.FULL, 1.0, 90)
    assert sum(run.duration_s for run in runs) == pytest.approx(3600.0)
    headings = np.array([float(run.testbed["start.theta"]) for run in runs])
    assert sorted(np.floor(np.degrees(headings % (2.0 * np.pi)) / 4.0)) == list(range(90))
    for run, heading in zip(runs, headings, strict=True):
        assert run.plan(np.zeros(1))[0, 2] == heading  # the plan keeps it
    for wheel in range(3):
        phases = [float(run.testbed[f"electronics.encoder_phase[{wheel}]"]) for run in runs]
        assert np.histogram(phases, bins=10, range=(0.0, 1.0))[0].min() >= 2
    assert len({run.seed for run in runs}) == 90
    again = circle.undisturbed_runs(circle.PAPER, 1.0, 90)
    assert [run.testbed for run in again] == [run.testbed for run in runs]  # the same for every estimator


def test_oblique_pushes_have_their_targets_and_reasons(findings: Findings) -> None:
    oblique = [one for one in findings.rows if "oblique" in one.quantity]
    assert len(oblique) == 4
    assert all(one.target is not None for one in oblique)
    assert all(one.reason for one in findings.rows if one.met is False)


def test_rollers_that_rub_unlike_the_model_do_raise_false_alarms(findings: Findings) -> None:
    # The count of undisturbed rounds could not be trusted if nothing ever raised one: 20 % of 42 N is 8.4 N, far above
    # the 3 N that the detector ignores in motion, and below the 9 N of the last row.
    for word in ("more", "less"):
        assert row(findings, f"rollers may rub so much {word} without a false alarm, full") == 0.0
    assert row(findings, "false alarms in a round each at friction +-20 %") == 0.0


def test_the_experiment_has_no_bumper() -> None:
    with pytest.raises(GivewayError, match="bumper"):
        circle.scenario("spring")


def in_world(pose: NDArray[np.float64], points: ArrayLike) -> NDArray[np.float64]:
    """Points of the base frame, shape (n, 2), m, of a robot at ``pose`` (x, y, heading)."""
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    return np.asarray(np.asarray(points) @ [[cos, sin], [-sin, cos]] + pose[:2])


def seen_from_above(result: Result) -> tuple[list[Curve], list[NDArray[np.float64]]]:
    """Plan, path by mode, what was invented, and the pushes: 6 mm of arrow for each newton, to where it was felt.

    And the corners of the robot as it stood then.
    """
    scenario = circle.scenario(pushes=2)
    pushes = scenario.push.pushes  # type: ignore[union-attr]
    trace = {str(name): values.values.astype(float) for name, values in result.traces.data_vars.items()}
    time_s = result.traces["time"].values
    found = responses(pushes, time_s, lambda name: trace[name])
    poses = np.stack([trace[f"testbed.truth.{name}"] for name in ("x", "y", "theta")], axis=1)
    x, y = poses[:, 0], poses[:, 1]
    curves = [curve(trace["controller.plan.x"], "m", trace["controller.plan.y"], "m")]
    for mode in (1, 2, 4):
        there = trace["controller.mode"] == mode
        curves.append(curve(np.where(there, x, np.nan), "m", np.where(there, y, np.nan), "m"))
    rows = np.searchsorted(time_s, found.invented_s)
    if len(rows):
        curves.append(curve(x[rows], "m", y[rows], "m"))
    start, bodies = {v.name: float(v.start or 0.0) for v in table("testbed").select("parameter")}, []
    outline = [[start[f"outline.{axis}[{i}]"] for axis in "xy"] for i in range(int(start["outline.count"]))]
    for one in found.pushes:
        pose, push = poses[int(np.searchsorted(time_s, one.detected_s or one.push.start_s))], one.push
        (point,) = in_world(pose, [[push.point_x_m, push.point_y_m]])
        arrow = 0.006 * push.force_n * np.array([math.cos(push.direction_rad), math.sin(push.direction_rad)])
        ends = np.stack([point - arrow, point])
        curves.append(curve(ends[:, 0], "m", ends[:, 1], "m"))
        bodies.append(in_world(pose, outline))
    return curves, bodies


def test_the_path_s_labels_say_what_it_draws(findings: Findings, runs: list[Result]) -> None:
    figure = findings.pictures[0].figure
    wanted = [seen_from_above(run) for run in runs[:2]]
    check_planted(figure, lambda: check_panels(figure, [curves for curves, _ in wanted]))
    for axes, (_, bodies) in zip(figure.axes, wanted, strict=True):  # whose lengths are in metres by now
        for drawn, corners in zip(axes.patches, bodies, strict=True):
            assert isinstance(drawn, Polygon)
            assert drawn.get_xy()[:-1] == pytest.approx(corners)
