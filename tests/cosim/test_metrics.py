"""Metrics on a collision in closed form: every expected number follows by hand from synthetic_collision.py."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
import reference_metrics
import synthetic_collision as synthetic
from giveway.base.errors import GivewayError
from giveway.library import recorded
from giveway.library.batch_library import native_metrics
from giveway.scenario.body_regions import body_region
from giveway.simulation.metrics import Collision, Metric, collision, design, evaluate, without_collision

# Sums over a 1 ms grid against integrals: at most one step's worth of force (40 N x 1 ms) on 2 N s.
ONE_STEP = 0.04 + 1e-9


def numbers(*, parameters: Mapping[str, Any] = synthetic.PARAMETERS, **changes: Any) -> dict[str, Metric]:
    return evaluate(synthetic.traces(**changes), parameters)


def test_detection_time_runs_from_contact_to_decision() -> None:
    assert numbers()["detection time"].value == pytest.approx(50.0, abs=1e-6)


def test_contact_speed_is_that_of_the_nose() -> None:
    assert numbers()["contact speed"].value == pytest.approx(0.5, rel=1e-9)


@pytest.mark.parametrize("heading", [0.0, 1.0, -2.5])
def test_direction_is_in_the_base_frame(heading: float) -> None:
    direction = numbers(heading_rad=heading)["force direction"]
    expected = 210.0 - math.degrees(heading)
    assert direction.value is not None
    assert direction.truth is not None
    assert math.cos(math.radians(direction.truth - expected)) == pytest.approx(1.0, abs=1e-12)
    assert direction.value - direction.truth == pytest.approx(-10.0, abs=1e-9)


def test_direction_error_wraps() -> None:
    found = numbers(heading_rad=math.radians(205.0))
    assert found["direction error"].value == pytest.approx(-10.0, abs=1e-9)


def test_location_and_its_error() -> None:
    found = numbers()
    x, y = found["contact point x"], found["contact point y"]
    assert (x.value, y.value) == pytest.approx([1e3 * m for m in synthetic.ESTIMATED_POINT_M])
    assert (x.truth, y.truth) == pytest.approx([1e3 * m for m in synthetic.POINT_M])
    assert found["location error"].value == pytest.approx(50.0)  # 3-4-5 triangle of 3 and 4 cm


def test_magnitude_averages_the_truth_over_the_filter_window() -> None:
    magnitude = numbers()["force at detection"]
    assert (magnitude.value, magnitude.truth) == pytest.approx((30.0, 40.0))


def test_magnitude_window_reaches_back_before_contact() -> None:
    long = {**synthetic.PARAMETERS, "controller": {"estimator.average_window": 102, "controller.period": 0.001}}
    # 51 samples of the contact (both ends of 50 ms) among 102.
    assert numbers(parameters=long)["force at detection"].truth == pytest.approx(20.0)


def test_impulse_is_the_plants_own_integral() -> None:
    impulse = numbers()["impulse at detection"]
    assert impulse.truth == pytest.approx(40.0 * 0.05)
    assert impulse.value == pytest.approx(30.0 * 0.05, abs=ONE_STEP)


def test_peak_torque_takes_the_sign_of_the_impact() -> None:
    assert numbers()["peak wheel torque"].value == pytest.approx(4.0)  # not the reversal's 6 N m


def test_peak_torque_of_either_sign_sees_the_reversal() -> None:
    assert numbers()["peak torque, any sign"].value == pytest.approx(6.0)


def test_peak_force_and_bumper_compression() -> None:
    found = numbers()
    assert found["peak force of the run"].value == pytest.approx(40.0)
    assert found["bumper compression"].value == pytest.approx(30.0)


def test_escape_of_reference_and_base() -> None:
    escape = numbers()["escape distance"]
    assert (escape.value, escape.truth) == pytest.approx((0.5, 0.48))


def test_energy_residual_is_relative_to_the_energy_in_play() -> None:
    assert numbers()["energy residual"].value == pytest.approx(1e-6)  # 6e-6 J of 6 J


def test_nothing_hit_gives_no_numbers_but_no_error() -> None:
    found = numbers(hit=False)
    for name in ("detection time", "force direction", "escape distance", "peak wheel torque"):
        assert found[name].value is None
    assert found["false detections"].value == 0.0
    assert found["peak force of the run"].value == 0.0


def test_unnoticed_hit_has_force_but_no_detection() -> None:
    found = numbers(noticed=False)
    assert found["detection time"].value is None
    assert found["peak wheel torque"].value == pytest.approx(4.0)


def test_a_false_alarm_before_contact_is_not_a_detection_of_the_hit() -> None:
    traces = synthetic.traces(noticed=False)
    traces["controller.detection.count"].values[20:] = 1
    early = Collision(traces, synthetic.PARAMETERS)
    assert early.metrics["false detections"].value == 1.0
    assert early.detected is None


def test_a_false_alarm_long_after_contact_is_counted() -> None:
    traces = synthetic.traces()
    for row, count, false in ((1001, 1, 0.0), (540, 2, 0.0), (560, 3, 1.0)):  # contact ended at 300 ms: 540 is its echo
        traces["controller.detection.count"].values[row:] = count
        assert evaluate(traces, synthetic.PARAMETERS)["false detections"].value == false


def test_escape_starts_anew_with_every_detection() -> None:
    traces = synthetic.traces()
    traces["controller.detection.count"].values[575:] = 2  # halfway between 150 and 1000 ms
    escape = evaluate(traces, synthetic.PARAMETERS)["escape distance"]
    assert (escape.value, escape.truth) == pytest.approx((0.25, 0.24))


def test_what_figures_draw_besides() -> None:
    traces = synthetic.traces()
    traces["testbed.truth.wheel_torque[1]"].values[120] = -4.5
    hit = Collision(traces, synthetic.PARAMETERS)
    assert (hit.contact_s, hit.start, hit.detected) == (0.1, 100, 150)
    assert hit.true_point() == pytest.approx(synthetic.POINT_M)
    direction = [math.cos(synthetic.DIRECTION_RAD), math.sin(synthetic.DIRECTION_RAD)]
    assert hit.true_impulse() == pytest.approx([2.0 * share for share in direction])
    assert hit.peak_torque_row() == 120  # of the impact; the reversal's comes later
    assert [hit.impact_sign(wheel) for wheel in range(3)] == [1.0, -1.0, 1.0]
    missed = Collision(synthetic.traces(noticed=False), synthetic.PARAMETERS)
    assert (missed.detected, missed.true_point(), missed.true_impulse()) == (None, None, None)
    nothing = Collision(synthetic.traces(hit=False), synthetic.PARAMETERS)
    assert (nothing.contact_s, nothing.peak_torque_row(), nothing.impact_sign(0)) == (None, None, 1.0)


def test_tables_show_their_metrics_in_the_order_of_the_table() -> None:
    traces = synthetic.traces()
    found = list(evaluate(traces, synthetic.PARAMETERS))
    shown = [
        [metric.name for metric in table(traces, synthetic.PARAMETERS)]
        for table in (collision, design, without_collision)
    ]
    for names in shown:
        assert names == sorted(names, key=found.index)
    assert shown[0] == [metric.name for metric in reference_metrics.collision(traces, synthetic.PARAMETERS)]
    assert shown[2] == ["false detections", "distance from the plan", "angle from the plan", "energy residual"]
    assert set(found) - set(shown[0]) - set(shown[1]) == {
        "detections", "contact impulse", "contact at end", "latched at end", "rope taut at end", "events",
    }  # fmt: skip


def test_traces_that_are_not_those_of_a_run_are_refused() -> None:
    traces = synthetic.traces()
    with pytest.raises(GivewayError, match=r"traces: a run without testbed\.truth\.latched"):
        evaluate(traces.drop_vars("testbed.truth.latched"), synthetic.PARAMETERS)
    with pytest.raises(GivewayError, match=r"time_s\[1\] = 0 is not allowed: finite and above the one before it"):
        evaluate(traces.isel(time=[0, 0, 1]), synthetic.PARAMETERS)
    with pytest.raises(GivewayError, match=r"rows = 0 is not allowed"):
        evaluate(traces.isel(time=[]), synthetic.PARAMETERS)
    with pytest.raises(GivewayError, match=r"testbed\.wheel\.radius: -1\.0 is not allowed"):
        evaluate(traces, {**synthetic.PARAMETERS, "testbed": {"wheel.radius": -1.0}})
    short = {"testbed.truth.x": np.zeros(3)}
    with pytest.raises(GivewayError, match=r"one value per time"):
        recorded.evaluate(traces["time"].values, short, synthetic.PARAMETERS)


def test_variables_that_no_metric_reads_may_be_there_or_not() -> None:
    traces = synthetic.traces()
    more = traces.assign({"testbed.truth.omega": traces["time"], "my own": traces["time"]})
    parameters = {**synthetic.PARAMETERS, "testbed": {**synthetic.PARAMETERS["testbed"], "no.such": 1.0}}
    assert evaluate(more, parameters) == evaluate(traces, synthetic.PARAMETERS)


def test_every_metric_says_what_it_is() -> None:
    for metric in native_metrics():
        assert len(metric.description) > 20
        assert "likewise" not in metric.description
    assert recorded.windows() == recorded.Windows(
        cause_s=reference_metrics.CAUSE_WINDOW_S,
        transient_s=reference_metrics.TRANSIENT_S,
        contact_gap_s=reference_metrics.CONTACT_GAP_S,
        peak_torque_s=reference_metrics.PEAK_WINDOW_S,
    )


def test_metrics_never_hold_nan() -> None:
    metric = Metric("x", math.nan, "m", math.inf)
    assert metric.value is None
    assert metric.truth is None


def test_without_a_body_region_no_share_of_its_limits_is_told() -> None:
    region = body_region("lower leg")
    traces = synthetic.traces()
    told, untold = evaluate(traces, synthetic.PARAMETERS, region), evaluate(traces, synthetic.PARAMETERS)
    for name in ("transient force share", "lasting force share"):
        assert told[name].value is not None, name
        assert untold[name].value is None, name
