"""Metrics on a collision in closed form: every expected number follows by hand from synthetic_collision.py."""

from __future__ import annotations

import math

import pytest
import synthetic_collision as synthetic
from giveway.simulation.metrics import Collision, Metric, collision

# Sums over a 1 ms grid against integrals: at most one step's worth of force (40 N x 1 ms) on 2 N s.
ONE_STEP = 0.04 + 1e-9


def hit(**changes: object) -> Collision:
    return Collision(synthetic.traces(**changes), synthetic.PARAMETERS)  # type: ignore[arg-type]


def test_detection_time_runs_from_contact_to_decision() -> None:
    assert hit().detection_time().value == pytest.approx(50.0, abs=1e-6)


def test_contact_speed_is_that_of_the_nose() -> None:
    assert hit().contact_speed().value == pytest.approx(0.5, rel=1e-9)


@pytest.mark.parametrize("heading", [0.0, 1.0, -2.5])
def test_direction_is_in_the_base_frame(heading: float) -> None:
    direction = hit(heading_rad=heading).direction()
    expected = 210.0 - math.degrees(heading)
    assert math.cos(math.radians(direction.truth - expected)) == pytest.approx(1.0, abs=1e-12)
    assert direction.value - direction.truth == pytest.approx(-10.0, abs=1e-9)


def test_direction_error_wraps() -> None:
    assert hit(heading_rad=math.radians(205.0)).direction_error().value == pytest.approx(-10.0, abs=1e-9)


def test_location_and_its_error() -> None:
    x, y, error = hit().location()
    assert (x.value, y.value) == pytest.approx([1e3 * m for m in synthetic.ESTIMATED_POINT_M])
    assert (x.truth, y.truth) == pytest.approx([1e3 * m for m in synthetic.POINT_M])
    assert error.value == pytest.approx(50.0)  # 3-4-5 triangle of 3 and 4 cm


def test_magnitude_averages_the_truth_over_the_filter_window() -> None:
    magnitude = hit().magnitude()
    assert (magnitude.value, magnitude.truth) == pytest.approx((30.0, 40.0))


def test_magnitude_window_reaches_back_before_contact() -> None:
    long = {**synthetic.PARAMETERS, "controller": {"estimator.average_window": 102, "controller.period": 0.001}}
    # 51 samples of the contact (both ends of 50 ms) among 102.
    assert Collision(synthetic.traces(), long).magnitude().truth == pytest.approx(20.0)


def test_impulse_is_the_plants_own_integral() -> None:
    impulse = hit().impulse()
    assert impulse.truth == pytest.approx(40.0 * 0.05)
    assert impulse.value == pytest.approx(30.0 * 0.05, abs=ONE_STEP)


@pytest.mark.parametrize("heading", [0.0, math.radians(240.0)])
def test_loaded_wheels_follow_the_torque_at_rest(heading: float) -> None:
    # 40 N along 210 deg at heading 0 loads wheel 1 (rolling direction 210 deg) with -r 2/3 F, the others with half.
    loaded = hit(heading_rad=heading).loaded_wheels()
    first = max(loaded, key=lambda wheel: wheel == (1 if heading == 0.0 else 2))
    assert loaded[first] == -1.0


def test_peak_torque_takes_the_sign_of_the_impact() -> None:
    assert hit().peak_torque().value == pytest.approx(4.0)  # not the reversal's 6 N m


def test_peak_torque_of_either_sign_sees_the_reversal() -> None:
    assert hit().peak_torque_any().value == pytest.approx(6.0)


def test_peak_force_and_bumper_compression() -> None:
    assert hit().peak_force().value == pytest.approx(40.0)
    assert hit().bumper_compression().value == pytest.approx(30.0)


def test_escape_of_reference_and_base() -> None:
    escape = hit().escape()
    assert (escape.value, escape.truth) == pytest.approx((0.5, 0.48))


def test_energy_residual_is_relative_to_the_energy_in_play() -> None:
    assert hit().energy_residual().value == pytest.approx(1e-6)  # 6e-6 J of 6 J


def test_nothing_hit_gives_no_numbers_but_no_error() -> None:
    numbers = {metric.name: metric for metric in collision(synthetic.traces(hit=False), synthetic.PARAMETERS)}
    for name in ("detection time", "force direction", "escape distance", "peak wheel torque"):
        assert numbers[name].value is None
    assert numbers["false detections"].value == 0.0
    assert numbers["peak force of the run"].value == 0.0


def test_unnoticed_hit_has_force_but_no_detection() -> None:
    numbers = {metric.name: metric for metric in collision(synthetic.traces(noticed=False), synthetic.PARAMETERS)}
    assert numbers["detection time"].value is None
    assert numbers["peak wheel torque"].value == pytest.approx(4.0)


def test_a_false_alarm_before_contact_is_not_a_detection_of_the_hit() -> None:
    traces = synthetic.traces(noticed=False)
    traces["controller.detection.count"].values[20:] = 1
    early = Collision(traces, synthetic.PARAMETERS)
    assert early.false_detections().value == 1.0
    assert early.detected is None


def test_a_false_alarm_long_after_contact_is_counted() -> None:
    traces = synthetic.traces()
    assert Collision(traces, synthetic.PARAMETERS).false_detections().value == 0.0
    traces["controller.detection.count"].values[540:] = 2  # contact ended at 300 ms: still its echo
    assert Collision(traces, synthetic.PARAMETERS).false_detections().value == 0.0
    traces["controller.detection.count"].values[560:] = 3
    assert Collision(traces, synthetic.PARAMETERS).false_detections().value == 1.0


def test_escape_starts_anew_with_every_detection() -> None:
    traces = synthetic.traces()
    traces["controller.detection.count"].values[575:] = 2  # halfway between 150 and 1000 ms
    escape = Collision(traces, synthetic.PARAMETERS).escape()
    assert (escape.value, escape.truth) == pytest.approx((0.25, 0.24))


def test_metrics_never_hold_nan() -> None:
    metric = Metric("x", math.nan, "m", math.inf)
    assert metric.value is None
    assert metric.truth is None
