"""5.2 with tipping, reduced: what has to hold at any effort."""

from __future__ import annotations

import pytest
from giveway.experiments.reproduction.findings import Effort, Findings
from giveway.experiments.tipping import EXPERIMENT


@pytest.fixture(scope="module")
def findings() -> Findings:
    assert EXPERIMENT.reproduce is not None
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


def test_every_miss_has_its_reason_and_every_picture_is_drawn(findings: Findings) -> None:
    assert all(r.reason for r in findings.rows if r.met is False)
    assert [p.name for p in findings.pictures] == ["wheel-torque"]
    assert findings.pictures[0].figure.axes
