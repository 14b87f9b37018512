"""The judge of pushes, on traces made by hand whose verdict is known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from giveway.scenario.plan import TimedPush
from giveway.simulation.push_response import TRACES, Responses, most_events, responses

STEP_S = 0.01
PUSH = TimedPush(40.0, math.radians(30.0), 0.1, 0.0, 1.0, 0.5)


def judged(detections: dict[float, float], pushes: tuple[TimedPush, ...] = (PUSH,), back: bool = True) -> Responses:
    """4 s in which the robot (heading 20 deg) moves by 0.5 m along 25 deg from each detection on, during one second;
    ``detections``: time in s to felt direction in deg, base frame."""
    time_s = np.arange(401) * STEP_S
    traces = {name: np.zeros(len(time_s)) for name in TRACES}
    traces["controller.mode"][:] = 1
    traces["testbed.truth.theta"][:] = math.radians(20.0)
    for at, felt in detections.items():
        row = round(at / STEP_S)
        traces["controller.detection.count"][row:] += 1
        traces["controller.detection.direction"][row:] = math.radians(felt)
        travel = 0.5 * np.clip((time_s - at) / 1.0, 0.0, 1.0)
        traces["testbed.truth.x"] += math.cos(math.radians(25.0)) * travel
        traces["testbed.truth.y"] += math.sin(math.radians(25.0)) * travel
        traces["controller.mode"][row : row + 100] = 2
        traces["controller.mode"][row + 100 :] = 4
        if back:
            traces["controller.mode"][row + 150 :] = 1
    return responses(pushes, time_s, traces.__getitem__)


def test_a_push_that_is_noticed() -> None:
    found = judged({1.1: 13.0})
    assert (found.detected, found.returned, found.invented_s) == (1, 1, ())
    one = found.pushes[0]
    assert one.detected_s == pytest.approx(1.1)
    assert one.felt_error_deg == pytest.approx(3.0)  # 20 + 13 - 30
    assert one.escape_m == pytest.approx(0.5)
    assert one.escape_error_deg == pytest.approx(-5.0)  # 25 - 30
    assert one.back_s == pytest.approx(2.6)
    assert found.off_path_m == pytest.approx(0.5)  # the plan stays at the origin


def test_a_push_that_is_missed() -> None:
    found = judged({})
    assert (found.detected, found.returned, found.invented_s) == (0, 0, ())
    assert math.isnan(found.pushes[0].escape_m)


@pytest.mark.parametrize("at", [0.9, 1.76, 3.0])
def test_what_no_push_explains_is_invented(at: float) -> None:
    # Before the push, and more than 0.25 s after it.
    found = judged({at: 0.0})
    assert found.detected == 0
    assert found.invented_s == pytest.approx((at,))


def test_a_second_detection_of_one_push_is_invented_and_ends_the_escape() -> None:
    found = judged({1.1: 10.0, 1.6: -170.0})
    assert found.detected == 1
    assert found.invented_s == pytest.approx((1.6,))
    assert found.returned == 0
    assert found.pushes[0].escape_m == pytest.approx(0.25, abs=0.01)  # half a second of it, to one sample of 5 mm


def test_what_is_felt_again_is_not_false() -> None:
    found = judged({1.1: 10.0, 1.6: -170.0, 3.0: 0.0})
    assert found.pushes[0].again_s == pytest.approx((1.6,))
    assert found.false_s == pytest.approx((3.0,))
    assert found.invented_s == pytest.approx((1.6, 3.0))


def test_a_detection_belongs_to_the_push_that_began_last() -> None:
    other = TimedPush(40.0, math.radians(30.0), 0.1, 0.0, 1.6, 0.3)  # 0.1 s after the end of the first
    found = judged({1.7: 10.0}, (PUSH, other))
    assert [one.detected_s for one in found.pushes] == [None, pytest.approx(1.7)]


def test_a_robot_that_does_not_come_back() -> None:
    assert judged({1.1: 10.0}, back=False).returned == 0


def test_a_run_that_ends_while_the_robot_still_reacts() -> None:
    late = TimedPush(40.0, math.radians(30.0), 0.1, 0.0, 3.3, 0.5)
    found = judged({3.5: 10.0}, (late,))
    assert found.pushes[0].escape_m == pytest.approx(0.25)  # what there is of it, until 4 s
    assert found.returned == 0


def test_each_push_has_its_own_detection() -> None:
    other = TimedPush(40.0, math.radians(30.0), 0.1, 0.0, 3.0, 0.3)
    found = judged({1.1: 10.0, 3.1: 10.0}, (PUSH, other))
    assert [one.detected_s for one in found.pushes] == pytest.approx([1.1, 3.1])
    assert found.invented_s == ()


def test_bounds_of_a_poisson_mean() -> None:
    # -ln 0.05, and tabulated one-sided 95 % limits (chi-square quantiles at 0.95 with 2 (n + 1) degrees, halved).
    assert most_events(0) == pytest.approx(-math.log(0.05), rel=1e-12)
    assert most_events(1) == pytest.approx(4.7439, abs=1e-4)
    assert most_events(10) == pytest.approx(16.962, abs=1e-3)
    assert most_events(0, 0.99) == pytest.approx(-math.log(0.01), rel=1e-12)
