"""Where the window of each metric begins and ends, and the tip margin by statics: in the library and in the reference.

The traces are those of synthetic_collision.py with single rows changed; every expected number follows by hand. Rows are
1 ms apart, the contact begins at row 100 and ends after row 299, the detection is at row 150.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
import pytest
import reference_metrics
import synthetic_collision as synthetic
import xarray
from giveway.scenario.body_regions import BodyRegion, body_region
from giveway.simulation import metrics

CONTACT, DETECTED, LAST_TOUCH = 100, 150, 299
PARAMETERS = {
    "testbed": {
        **synthetic.PARAMETERS["testbed"], "bumper.kind": 1, "bumper.travel": 0.12, "base.tipping": False,
        "base.mass": 40.0, "base.com_height": 0.3, "contact.height": 0.5, "push.height": 0.7,
    },
    "controller": synthetic.PARAMETERS["controller"],
}  # fmt: skip
Numbers = dict[str, tuple[float, float]]
Evaluate = Callable[..., Numbers]


def library(
    traces: xarray.Dataset, parameters: Mapping[str, Mapping[str, Any]], region: BodyRegion | None = None
) -> Numbers:
    return numbers(metrics.evaluate(traces, parameters, region).values())


def reference(
    traces: xarray.Dataset, parameters: Mapping[str, Mapping[str, Any]], region: BodyRegion | None = None
) -> Numbers:
    found = reference_metrics.collision(traces, parameters), reference_metrics.design(traces, parameters, region)
    return numbers((*found[0], *found[1]))


def numbers(found: Iterable[metrics.Metric]) -> Numbers:
    return {m.name: tuple(math.nan if v is None else v for v in (m.value, m.truth)) for m in found}  # type: ignore[misc]


@pytest.fixture(params=[library, reference], ids=["library", "reference"])
def evaluate(request: pytest.FixtureRequest) -> Evaluate:
    found: Evaluate = request.param
    return found


Rows = int | slice
Changes = Mapping[str, list[tuple[Rows, float]]]


def changed(columns: Changes, **arguments: Any) -> xarray.Dataset:
    """The traces with these rows of these columns at these values; a column that is missing is 0 elsewhere."""
    traces = synthetic.traces(**arguments)
    nothing = np.zeros(traces.sizes["time"])
    for name in ("testbed.truth.latched", "testbed.push.force_x", "testbed.push.force_y"):
        traces[name] = ("time", nothing.astype(bool) if name.endswith("latched") else nothing.copy())
    for name, rows in columns.items():
        for row, value in rows:
            traces[name].values[row] = value
    return traces


def test_every_number_of_the_closed_form(evaluate: Evaluate) -> None:
    found = evaluate(changed({}), PARAMETERS, body_region("lower leg"))
    expected = {
        "contact speed": 0.5, "false detections": 0.0, "detection time": 50.0, "force direction": -160.0,
        "direction error": -10.0, "contact point x": 130.0, "contact point y": 90.0, "location error": 50.0,
        "force at detection": 30.0, "impulse at detection": 51 * 0.03,  # rows 100 to 150, both in it
        "peak force of the run": 40.0, "bumper compression": 30.0, "peak wheel torque": 4.0,
        "peak torque, any sign": 6.0, "escape distance": 0.5, "energy residual": 1e-6, "transient force": 40.0,
        "lasting force": 0.0, "longest contact": 0.199, "transient force share": 40.0 / 260.0,
        "lasting force share": 0.0, "bottoming margin": 90.0, "contacts": 1.0, "rebound speed": 0.5,
        "re-latches": 0.0, "re-latch time": math.nan, "peak force of the first contact": 40.0,
        "first contact x": 100.0, "first contact y": 50.0, "robot speed at contact": 0.0, "distance from the plan": 0.0,
        "angle from the plan": 0.0, "sensed torque share": 4.0 / 25.0, "motor torque share": 0.0,
        "time in sensor fault": 0.0, "contact time": 0.1,
    }  # fmt: skip
    truth = {
        "force direction": -150.0, "contact point x": 100.0, "contact point y": 50.0, "force at detection": 40.0,
        "impulse at detection": 2.0, "escape distance": 0.48,
    }  # fmt: skip
    # Sums of some hundred rows, and differences of directions near 180 deg.
    near = {"rel": 1e-12, "abs": 1e-12, "nan_ok": True}
    assert {name: found[name][0] for name in expected} == pytest.approx(expected, **near)
    assert {name: found[name][1] for name in truth} == pytest.approx(truth, **near)


def test_the_peak_torque_is_that_of_the_first_350_ms(evaluate: Evaluate) -> None:
    late = {"testbed.truth.wheel_torque[1]": [(CONTACT + 349, -5.0), (CONTACT + 351, -7.0)]}
    assert evaluate(changed(late), PARAMETERS)["peak wheel torque"][0] == 5.0


@pytest.mark.parametrize(("beside_deg", "peak_nm"), [(1.0, 4.0), (-1.0, 9.0)])
def test_a_wheel_counts_from_half_of_the_largest_share_on(
    evaluate: Evaluate, beside_deg: float, peak_nm: float
) -> None:
    # Without a moment, a force d beside the rolling direction of wheel 1 loads wheel 2 with cos(120 deg - d)/cos(d)
    # of what wheel 1 gets, the other way round: half at d = 0.
    angle = synthetic.DIRECTION_RAD + math.radians(beside_deg)
    columns: dict[str, list[tuple[Rows, float]]] = {"testbed.truth.wheel_torque[2]": [(CONTACT + 20, 9.0)]}
    for axis, share in (("x", math.cos(angle)), ("y", math.sin(angle))):
        columns[f"testbed.truth.contact_impulse_{axis}"] = [(DETECTED, 2.0 * share)]
        columns[f"testbed.truth.contact_base_{axis}"] = [(slice(None), 0.0)]
    assert evaluate(changed(columns), PARAMETERS)["peak wheel torque"][0] == peak_nm


@pytest.mark.parametrize("cause", ["contact", "push"])
@pytest.mark.parametrize(("after", "false"), [(249, 0.0), (251, 1.0)])
def test_a_detection_is_false_250_ms_after_the_last_touch(
    evaluate: Evaluate, cause: str, after: int, false: float
) -> None:
    late: Changes = {"controller.detection.count": [(slice(LAST_TOUCH + after, None), 2.0)]}
    push: Changes = {"testbed.push.force_y": [(LAST_TOUCH, -1.0)]}
    traces = changed(late) if cause == "contact" else changed({**late, **push}, hit=False)
    assert evaluate(traces, PARAMETERS)["false detections"][0] == false


def test_the_estimate_is_compared_with_the_force_of_its_window(evaluate: Evaluate) -> None:
    # A window of 10 rows ends at the detection; of its force of 40 N, the first is doubled, the one before not.
    rows = ((DETECTED - 10, 1e6), (DETECTED - 9, 80.0))
    columns = {
        f"testbed.truth.contact_force_{axis}": [(row, force * share) for row, force in rows]
        for axis, share in (("x", math.cos(synthetic.DIRECTION_RAD)), ("y", math.sin(synthetic.DIRECTION_RAD)))
    }
    assert evaluate(changed(columns), PARAMETERS)["force at detection"][1] == pytest.approx(44.0, rel=1e-12)


def test_a_contact_lasts_when_it_is_longer_than_half_a_second(evaluate: Evaluate) -> None:
    force = {"testbed.truth.contact_force": [(CONTACT + 499, 60.0), (CONTACT + 501, 50.0)]}
    found = evaluate(changed(force), PARAMETERS)
    assert (found["transient force"][0], found["lasting force"][0]) == (60.0, 50.0)
    assert found["longest contact"][0] == pytest.approx(0.501, rel=1e-12)


@pytest.mark.parametrize(("gap", "longest_s"), [(499, 0.698), (501, 0.199)])
def test_a_contact_goes_on_after_less_than_half_a_second(evaluate: Evaluate, gap: int, longest_s: float) -> None:
    found = evaluate(changed({"testbed.truth.contact_force": [(LAST_TOUCH + gap, 50.0)]}), PARAMETERS)
    assert found["longest contact"][0] == pytest.approx(longest_s, rel=1e-12)
    assert (found["transient force"][0], found["lasting force"][0]) == (
        (40.0, 50.0) if gap < 500 else (50.0, 0.0)
    )  # fmt: skip


@pytest.mark.parametrize(("rows", "known"), [(499, False), (501, True)])
def test_the_lasting_force_is_known_half_a_second_after_the_contact(evaluate: Evaluate, rows: int, known: bool) -> None:
    found = evaluate(changed({}).isel(time=slice(0, CONTACT + rows + 1)), PARAMETERS, body_region("lower leg"))
    for name in ("lasting force", "lasting force share"):
        assert found[name][0] == pytest.approx(0.0 if known else math.nan, nan_ok=True)


def test_contact_and_rebound_speed_are_of_the_rows_next_to_the_contact(evaluate: Evaluate) -> None:
    traces = changed({})
    speed = np.full(traces.sizes["time"] - 1, 9.0)
    speed[CONTACT - 2], speed[LAST_TOUCH + 1] = 0.7, 0.3
    distance = np.concatenate([[0.0], np.cumsum(1e-3 * speed)])
    for axis, share in (("x", 0.6), ("y", -0.8)):
        traces[f"testbed.truth.nose_{axis}"].values[:] = share * distance
    found = evaluate(traces, PARAMETERS)
    # Displacements of some metres, 1 ms apart: rounding of 1e-12.
    assert found["contact speed"][0] == pytest.approx(0.7, rel=1e-11)
    assert found["rebound speed"][0] == pytest.approx(0.3, rel=1e-11)


def test_re_latching_is_counted_from_the_contact(evaluate: Evaluate) -> None:
    latched = {"testbed.truth.latched": [(slice(0, 120), 1.0), (slice(350, 400), 1.0), (500, 1.0)]}
    found = evaluate(changed(latched), PARAMETERS)
    assert found["re-latches"][0] == 2.0
    assert found["re-latch time"][0] == pytest.approx(250.0, rel=1e-12)


@pytest.mark.parametrize(("gap", "contacts", "first_n"), [(99, 1.0, 60.0), (101, 2.0, 40.0)])
def test_touches_less_than_a_tenth_of_a_second_apart_are_one_contact(
    evaluate: Evaluate, gap: int, contacts: float, first_n: float
) -> None:
    again = slice(LAST_TOUCH + gap, LAST_TOUCH + gap + 50)
    touches: Changes = {"testbed.truth.contact": [(again, 1.0)], "testbed.truth.contact_force": [(again, 60.0)]}
    traces = changed(touches)
    # 9 m/s after the first touch, 2 m/s after the second.
    speed = np.where(np.arange(traces.sizes["time"] - 1) < again.start, 9.0, 2.0)
    distance = np.concatenate([[0.0], np.cumsum(1e-3 * speed)])
    for axis, share in (("x", 0.6), ("y", -0.8)):
        traces[f"testbed.truth.nose_{axis}"].values[:] = share * distance
    found = evaluate(traces, PARAMETERS)
    assert (found["contacts"][0], found["peak force of the first contact"][0]) == (contacts, first_n)
    assert found["peak force of the run"][0] == 60.0
    assert found["rebound speed"][0] == pytest.approx(2.0 if contacts == 1.0 else 9.0, rel=1e-11)


def test_the_place_is_that_of_the_first_row_and_the_robots_speed_of_the_one_before(evaluate: Evaluate) -> None:
    found = evaluate(
        changed({
            "testbed.truth.contact_base_x": [(CONTACT, 0.2), (CONTACT + 1, 0.9)],
            "testbed.truth.contact_base_y": [(CONTACT, -0.1), (CONTACT + 1, 0.9)],
            "testbed.truth.vx": [(CONTACT - 2, 9.0), (CONTACT - 1, 0.3), (CONTACT, 9.0)],
            "testbed.truth.vy": [(CONTACT - 1, -0.4)],
        }),
        PARAMETERS,
    )  # fmt: skip
    assert (found["first contact x"][0], found["first contact y"][0]) == pytest.approx((200.0, -100.0), rel=1e-12)
    assert found["robot speed at contact"][0] == pytest.approx(0.5, rel=1e-12)


def test_the_robots_speed_is_that_of_the_first_row_if_the_second_is_the_contact(evaluate: Evaluate) -> None:
    traces = changed({"testbed.truth.vx": [(CONTACT - 1, 0.3), (CONTACT, 9.0)]})
    found = evaluate(traces.isel(time=slice(CONTACT - 1, None)), PARAMETERS)
    assert found["robot speed at contact"][0] == 0.3
    found = evaluate(traces.isel(time=slice(CONTACT, None)), PARAMETERS)
    assert math.isnan(found["robot speed at contact"][0]), "no row before the contact"


def test_touches_a_tenth_of_a_second_apart_are_two_contacts(evaluate: Evaluate) -> None:
    last = 210
    touches: Changes = {"testbed.truth.contact": [(slice(last + 1, None), 0.0), (last + 100, 1.0)]}
    time_s = changed(touches)["time"].values
    assert time_s[last + 100] - time_s[last] == 0.1, "the bits of another row"
    assert evaluate(changed(touches), PARAMETERS)["contacts"][0] == 2.0


def test_the_energy_residual_is_a_share_of_the_work_where_that_is_the_largest(evaluate: Evaluate) -> None:
    work = {"testbed.energy.work_in": [(500, -100.0)]}  # J; 4 J are released, 6 J dissipated
    assert evaluate(changed(work), PARAMETERS)["energy residual"][0] == pytest.approx(6e-6 / 100.0, rel=1e-12)


@pytest.mark.parametrize("what", ["contact", "latched", "rope_taut"])
def test_what_holds_at_the_end_is_that_of_the_last_row(what: str) -> None:
    name = f"{what.replace('_', ' ')} at end"
    for rows, at_end in ((-1, 1.0), (slice(0, -1), 0.0)):
        traces = changed({f"testbed.truth.{what}": [(slice(0, None), 0.0), (rows, 1.0)]})
        assert library(traces, PARAMETERS)[name][0] == at_end


def test_the_plan_is_compared_while_it_is_followed_and_until_the_first_reaction(evaluate: Evaluate) -> None:
    away: Changes = {
        # Taring, tracking, reacting, and tracking again.
        "controller.mode": [
            (slice(0, 50), 0.0),
            (slice(50, 150), 1.0),
            (slice(150, 600), 2.0),
            (slice(600, None), 1.0),
        ],
        "controller.plan.x": [(40, 9.0), (60, 0.03), (149, 0.01), (150, 9.0), (700, 9.0)],
        "controller.plan.y": [(60, 0.04), (700, 9.0)],
        "controller.plan.theta": [(70, 2.0 * math.pi + 0.1), (700, 1.0)],
    }
    traces = changed(away)
    for axis in "xy":  # the reference of these rows stands
        traces[f"controller.reference.{axis}"].values[:150] = 0.0
    found = evaluate(traces, PARAMETERS)
    assert found["distance from the plan"][0] == pytest.approx(50.0, rel=1e-12)
    assert found["angle from the plan"][0] == pytest.approx(math.degrees(0.1), rel=1e-12)


def test_what_is_at_its_limit(evaluate: Evaluate) -> None:
    found = evaluate(
        changed({
            "testbed.sensor.torque[2]": [(5, -12.5)],
            "testbed.truth.motor_torque[0]": [(900, -18.0)],
            "controller.mode": [(slice(0, 200), 1.0), (slice(200, 207), 6.0), (slice(207, None), 3.0)],
        }),
        PARAMETERS,
    )  # fmt: skip
    assert found["sensed torque share"][0] == 0.5  # of the 25 N m that count as saturated, not of the range of 30 N m
    assert found["motor torque share"][0] == 0.9
    assert found["time in sensor fault"][0] == pytest.approx(0.007, rel=1e-12)
    narrow = {**PARAMETERS, "testbed": {**PARAMETERS["testbed"], "electronics.torque_range": 20.0}}
    assert evaluate(changed({}), narrow)["sensed torque share"][0] == 0.2


def least_share_of_a_wheel(moment_x: float, moment_y: float, heading_rad: float) -> float:
    """Three times the least load of a wheel over the weight; ``moment``: sum of height times horizontal force, N m.

    The wheels stand at the corners of an equilateral triangle; their loads hold the weight and the moments about the
    base's centre at floor level: sum N = m g, sum N x = moment_x, sum N y = moment_y.
    """
    testbed = PARAMETERS["testbed"]
    weight, distance = testbed["base.mass"] * 9.81, testbed["wheel.distance"]
    azimuth = heading_rad + np.arange(3) * 2.0 * math.pi / 3.0
    places = np.stack([np.ones(3), distance * np.cos(azimuth), distance * np.sin(azimuth)])
    loads = np.linalg.solve(places, [weight, moment_x, moment_y])
    return float(3.0 * loads.min() / weight)


@pytest.mark.parametrize("heading_rad", [0.0, 0.5, -2.0])
@pytest.mark.parametrize("what", ["contact", "push", "acceleration", "all"])
def test_the_tip_margin_is_that_of_the_least_loaded_wheel(evaluate: Evaluate, what: str, heading_rad: float) -> None:
    testbed = PARAMETERS["testbed"]
    traces = changed({}, heading_rad=heading_rad)
    moment = np.zeros(2)
    for i, axis in enumerate("xy"):
        force = (-30.0, 11.0)[i] if what in ("contact", "all") else 0.0
        push = (5.0, 25.0)[i] if what in ("push", "all") else 0.0
        acceleration = (0.4, -0.3)[i] if what in ("acceleration", "all") else 0.0
        traces[f"testbed.truth.contact_force_{axis}"].values[:] = force
        traces[f"testbed.push.force_{axis}"].values[:] = push
        traces[f"testbed.truth.v{axis}"].values[:] = acceleration * traces["time"].values
        moment[i] = testbed["contact.height"] * force + testbed["push.height"] * push
        moment[i] -= testbed["base.com_height"] * testbed["base.mass"] * acceleration
    expected = least_share_of_a_wheel(*moment, heading_rad)
    assert 0.4 < expected < 0.95
    # Speeds of 0.4 m/s, 1 ms apart: rounding of 1e-13 in the acceleration.
    assert evaluate(traces, PARAMETERS)["tip margin"][0] == pytest.approx(expected, rel=1e-12)


def test_the_tip_margin_is_the_least_of_the_run(evaluate: Evaluate) -> None:
    traces = changed({f"testbed.truth.contact_force_{axis}": [(slice(None), 0.0)] for axis in "xy"})
    assert evaluate(traces, PARAMETERS)["tip margin"][0] == 1.0
    traces["testbed.push.force_x"].values[700] = 100.0
    expected = least_share_of_a_wheel(70.0, 0.0, 0.0)
    assert evaluate(traces, PARAMETERS)["tip margin"][0] == pytest.approx(expected, rel=1e-12)


def test_a_base_that_tips_measures_its_margin_itself(evaluate: Evaluate) -> None:
    traces = changed({})
    traces["testbed.truth.tip_margin"] = traces["time"] + 0.25
    tipping = {**PARAMETERS, "testbed": {**PARAMETERS["testbed"], "base.tipping": True}}
    assert evaluate(traces, tipping)["tip margin"][0] == 0.25
    traces["testbed.truth.tip_margin"] = traces["time"] + 1.25
    assert evaluate(traces, tipping)["tip margin"][0] == 1.0
