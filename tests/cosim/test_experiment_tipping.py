"""5.2 with tipping, reduced: what has to hold at any effort."""

from __future__ import annotations

import numpy as np
import pytest
from figure_labels import Curve, across, check_panels, check_planted, curve, in_si, keeping, unit_of_axis
from giveway.experiments import tipping
from giveway.experiments.reproduction.findings import Effort, Findings
from giveway.experiments.tipping import EXPERIMENT
from giveway.robot.wheels import WHEELS
from giveway.simulation.result import Result
from numpy.typing import NDArray


@pytest.fixture(scope="module")
def runs() -> list[Result]:
    """Those of the findings, in their order: planar, tipping, then others."""
    return []


@pytest.fixture(scope="module")
def findings(runs: list[Result]) -> Findings:
    assert EXPERIMENT.reproduce is not None
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tipping, "run", keeping(tipping.run, runs))
        return EXPERIMENT.reproduce(Effort(full=False))


def row(findings: Findings, start: str) -> float:
    (found,) = [r for r in findings.rows if r.quantity.startswith(start)]
    assert found.ours is not None, found
    return found.ours


def test_a_hard_hit_above_the_centre_of_mass_lifts_wheels_and_the_planar_robot_has_no_plateau(
    findings: Findings,
) -> None:
    assert row(findings, "longest time a wheel is in the air") > 10.0
    assert row(findings, "plateau of the motion, no bumper, planar") == 0.0


def test_the_torque_dips_where_the_planar_one_only_rises(findings: Findings) -> None:
    assert row(findings, "dip of wheel 0's torque") > 1.0
    # Until it is detected the planar robot's torque rises; half an encoder count of the servo's ripple at most.
    assert row(findings, "the same, planar") < 0.1


def test_it_stays_on_its_wheels_in_the_end(findings: Findings) -> None:
    assert 0.0 < row(findings, "least tip margin, no bumper") < 1.0


def test_with_the_wheels_kept_down_it_is_the_planar_robot(findings: Findings) -> None:
    (agreement,) = [r for r in findings.rows if r.quantity.startswith("largest deviation")]
    assert agreement.met


def test_the_papers_times_of_detection_have_targets_with_tipping_too(findings: Findings) -> None:
    (found,) = [r for r in findings.rows if r.quantity == "detection time with tipping, no bumper"]
    assert (found.kind, found.met) == ("fitted", False)
    assert "only one below the centre of mass, at 0.3 m, after 4" in found.reason


def test_a_lighter_reaction_tips_it_over_and_a_heavier_one_does_not(findings: Findings) -> None:
    (found,) = [r for r in findings.rows if r.quantity.startswith("largest M_des")]
    assert found.kind == "predicted"
    assert found.ours is not None
    assert 0.3 < found.ours < 2.0
    assert tipping._tips_at(("none",), (2.4,), {}) is None


def test_every_miss_has_its_reason_and_there_is_a_picture(findings: Findings) -> None:
    assert all(r.reason for r in findings.rows if r.met is False)
    assert [p.name for p in findings.pictures] == ["wheel-torque"]


def panels(run: Result) -> tuple[list[Curve], list[Curve], list[Curve]]:
    """Torque of wheel 0, travel along the push and load of each wheel, from the contact to 0.35 s after it."""
    time_s = run.traces["time"].values - float(run.traces["testbed.truth.first_contact_time"].values[-1])
    rows = (time_s >= 0.0) & (time_s <= 0.35)

    def trace(name: str) -> NDArray[np.float64]:
        return run.traces[f"testbed.truth.{name}"].values[rows].astype(float)

    impulse = np.array([trace(f"contact_impulse_{axis}")[-1] for axis in "xy"])
    place = np.stack([trace("x"), trace("y")], axis=1) @ (impulse / np.linalg.norm(impulse))
    return (
        [curve(time_s[rows], "s", trace("wheel_torque[0]"), "N.m")],
        [curve(time_s[rows], "s", place - place[0], "m")],
        [curve(time_s[rows], "s", trace(f"wheel_load[{wheel}]"), "N") for wheel in range(WHEELS)],
    )


def test_the_figure_s_labels_say_what_it_draws(findings: Findings, runs: list[Result]) -> None:
    figure = findings.pictures[0].figure
    planar, tips = (panels(run) for run in runs[:2])
    wanted = [planar[0] + tips[0], planar[1] + tips[1], tips[2]]
    check_planted(figure, lambda: check_panels(figure, wanted))
    detected_s = sorted(1e-3 * (run.metric("detection time").value or 0.0) for run in runs[:2])
    for axes in figure.axes:
        unit = unit_of_axis(figure, axes, "x")
        assert unit is not None
        assert in_si(across(axes, "x"), unit, "s") == pytest.approx(detected_s)
