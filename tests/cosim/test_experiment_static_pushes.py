"""The paper's 5.1: groups of four pushes, and what a calibration leaves of their errors."""

from __future__ import annotations

import math

import numpy as np
import pytest
from giveway import batch
from giveway.experiments import get
from giveway.experiments.reproduction.findings import Effort, Findings, Row
from giveway.experiments.static_push_study.groups import PRINTED, group_values, percentile_of
from giveway.experiments.static_push_study.placements import (
    CONE_RAD,
    Placement,
    default_outline,
    paper_placements,
    random_placements,
)
from giveway.experiments.static_push_study.robots import pushed_robot
from giveway.experiments.static_push_study.trials import Readings, Trial
from giveway.scenario.scenario import Scenario


@pytest.fixture(scope="module")
def told() -> list[float]:
    return []


@pytest.fixture(scope="module")
def findings(told: list[float]) -> Findings:
    reproduce = get("static_pushes").reproduce
    assert reproduce is not None
    return reproduce(Effort(full=False, threads=1, progress=told.append))


def row(findings: Findings, quantity: str) -> Row:
    return next(row for row in findings.rows if row.quantity == quantity)


@pytest.mark.parametrize("quantity", ["magnitude", "direction", "location"])
@pytest.mark.parametrize("which", ["mean", "95th percentile"])
def test_a_calibrated_controller_meets_the_targets(findings: Findings, quantity: str, which: str) -> None:
    assert row(findings, f"{quantity} error, compensated, {which}").met


def test_the_papers_controller_feels_less_than_the_push(findings: Findings) -> None:
    # A roller's share is sigma0/(sigma0 + k_w), 0.29 on the median robot: no scatter makes it nothing or all.
    for which in ("weakest", "strongest"):
        median = row(findings, f"magnitude error, {which} of four pushes, median").ours
        assert median is not None
        assert -70.0 < median < -10.0


def test_every_number_of_the_paper_has_its_place(findings: Findings) -> None:
    for printed in PRINTED:
        place = row(findings, f"{printed.name}: percentile of the paper's {printed.value:g} {printed.unit}")
        assert place.ours is not None
        assert 0.0 <= place.ours <= 100.0
        assert place.met or place.reason


def test_no_push_is_felt_in_full_and_the_report_says_why(findings: Findings) -> None:
    place = row(findings, "magnitude error, strongest of four pushes: percentile of the paper's 0 %")
    assert place.ours == 100.0
    assert "scatter" in place.reason
    assert "drift" in place.reason


def test_it_shows_what_it_found(findings: Findings, told: list[float]) -> None:
    assert [picture.name for picture in findings.pictures] == ["placements", "clouds", "groups"]
    assert told == sorted(told)
    assert told[-1] == 1.0


def test_nothing_is_calibrated_and_judged_on_the_same_push() -> None:
    robots = [pushed_robot(number, 8) for number in range(5)]
    seeds = [trial.seed for robot in robots for trial in (*robot.known, *robot.paper, *robot.random)]
    assert len(set(seeds)) == len(seeds)
    for robot in robots:
        assert not {trial.placement for trial in robot.known} & {trial.placement for trial in robot.random}
        assert len({trial.stiffness_n_per_m for trial in (*robot.known, *robot.paper, *robot.random)}) == 1
        assert min(robot.known[0].stiffness_n_per_m) != max(robot.known[0].stiffness_n_per_m)
    assert pushed_robot(3, 8) == robots[3]


class DriveAndStop:
    """Straight ahead in a direction for 1 s, with a turn, the speed a squared sine; then rest."""

    def __init__(self, speed_mps: float, direction_rad: float, turn_radps: float) -> None:
        self.rates = (speed_mps * math.cos(direction_rad), speed_mps * math.sin(direction_rad), turn_radps)

    def __call__(self, time_s: np.ndarray) -> np.ndarray:
        t = np.minimum(time_s, 1.0)
        shape = (t / 2.0 - np.sin(2.0 * math.pi * t) / (4.0 * math.pi), np.sin(math.pi * t) ** 2)
        shapes = (*shape, math.pi * np.sin(2.0 * math.pi * t))
        return np.stack([rate * values for values in shapes for rate in self.rates], axis=1)


def test_driving_and_stopping_loads_the_rollers_as_the_robots_are() -> None:
    draw = np.random.default_rng(4)
    drives = [
        DriveAndStop(draw.uniform(0.02, 0.2), draw.uniform(0, 2 * math.pi), draw.uniform(-0.5, 0.5)) for _ in range(16)
    ]
    names = [f"testbed.truth.roller_force[{wheel}]" for wheel in range(3)]
    quiet = {"detector.impulse_threshold": 1000.0}
    scenarios = [
        Scenario("stop", 2.0, testbed={"slider.present": False}, controller=quiet, plan=drive) for drive in drives
    ]
    table = batch.run_many(scenarios, threads=1, traces=names)
    left = np.abs([table[name].values[:, -1] for name in names])
    drawn = [np.abs(trial.roller_load_n) for number in range(20) for trial in pushed_robot(number, 4).random]
    # Uniform loads are as large in the mean as those of stops, and seldom exceeded.
    assert np.mean(drawn) == pytest.approx(left.mean(), rel=0.25)
    assert np.mean(left > np.max(drawn)) < 0.05


def test_random_pushes_act_on_the_outline_and_into_the_body() -> None:
    outline = default_outline()
    for placement in random_placements(outline, 200, np.random.default_rng(3)):
        point = np.array([placement.x_m, placement.y_m])
        inward = []
        for start, end in zip(outline, np.roll(outline, -1, axis=0), strict=True):
            normal = np.array([start[1] - end[1], end[0] - start[0]]) / np.hypot(*(end - start))
            inward.append((float(normal @ (point - start)), math.atan2(normal[1], normal[0])))
        depth, direction = min(inward)
        assert depth == pytest.approx(0.0, abs=1e-12)
        lean = (placement.direction_rad - direction + math.pi) % (2.0 * math.pi) - math.pi
        assert abs(lean) <= CONE_RAD + 1e-12


def test_the_papers_pushes_act_on_one_side() -> None:
    assert {round(placement.x_m, 9) for placement in paper_placements(default_outline())} == {-0.176092}


def test_a_group_is_its_extremes_and_means() -> None:
    trial = Trial(Placement(0.0, 0.0, math.pi - 0.01), (1e4, 1e4, 1e4))
    readings = Readings(
        trials=[trial] * 4,
        force_n=np.array([5.5, 7.0, 8.0, 10.0]),
        direction_rad=np.array([-math.pi + 0.01, math.pi - 0.01, math.pi - 0.01, math.pi - 0.05]),
        point_m=np.array([[0.01, 0.0], [0.0, 0.11], [0.0, 0.0], [0.03, 0.04]]),
        on_outline=np.full(4, True),
        torque_nm=np.zeros((4, 3)),
    )
    turned, most = math.degrees(0.02), math.degrees(0.04)
    expected = [-45.0, 0.0, most, (turned + most) / 4.0, 11.0, 17.0 / 4.0]
    np.testing.assert_allclose(group_values(readings), [expected], atol=1e-9)


def test_percentiles_count_equals_half() -> None:
    assert percentile_of(2.0, np.array([1.0, 2.0, 3.0, 4.0])) == 37.5
