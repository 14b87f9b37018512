"""Plans are what they say: closed forms, and derivatives that belong together; pushes have their shape and impulse."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from giveway.base.errors import GivewayError
from giveway.scenario.arcs import EVERY_WHEEL, Arcs
from giveway.scenario.plan import Circle, Pushes, Rest, Straight, TimedPush, start_values
from numpy.typing import NDArray

POSITION, VELOCITY, ACCELERATION = slice(0, 3), slice(3, 6), slice(6, 9)
MOVING = {
    "straight": Straight(0.22, 2.0, -1.0, 0.5, 0.3, acceleration_mps2=None),
    "straight from rest": Straight(0.22, 2.0, -1.0, 0.5, 0.3, acceleration_mps2=0.4),
    "circle": Circle(1.5, 0.16, 0.2, -0.1, 1.0, theta_rad=0.4, acceleration_mps2=None),
    "circle, turning, clockwise": Circle(1.5, -0.16, start_rad=-2.0, heading="turning", acceleration_mps2=None),
    "circle from rest": Circle(1.5, 0.16, acceleration_mps2=0.1),
    "circle from rest, turning": Circle(0.8, -0.3, heading="turning", acceleration_mps2=0.5),
}
ARCS = Arcs(EVERY_WHEEL, 1.5, 0.1, 2, 0.5, 0.1016, 0.24)


@pytest.mark.parametrize("name", MOVING)
def test_velocity_and_acceleration_are_the_derivatives(name: str) -> None:
    # Central differences over +-1e-4 s: their own error is (1e-4)^2/6 times the third derivative, which is below
    # 10 per s3 here, plus rounding of 1e-16/1e-4; 1e-7 is above both.
    step = 1e-4
    time_s = np.linspace(0.01, 9.0, 400)
    plan = MOVING[name]
    before, now, after = plan(time_s - step), plan(time_s), plan(time_s + step)
    assert np.abs((after - before)[:, POSITION] / (2 * step) - now[:, VELOCITY]).max() < 1e-7
    smooth = np.ones(len(time_s), dtype=bool)
    acceleration = plan.acceleration_mps2  # type: ignore[attr-defined]
    if acceleration is not None:  # the acceleration has a kink where it ends: no derivative across it
        end_s = math.pi * abs(plan.speed_mps) / (2.0 * acceleration)  # type: ignore[attr-defined]
        smooth = np.abs(time_s - end_s) > 2 * step
    assert np.abs((after - before)[smooth, VELOCITY] / (2 * step) - now[smooth, ACCELERATION]).max() < 1e-7


def test_a_circle_is_a_circle() -> None:
    time_s = np.linspace(0.0, 100.0, 1001)
    table = Circle(1.5, 0.16, 0.2, -0.1, 1.0, acceleration_mps2=None)(time_s)
    from_centre = table[:, :2] - (0.2, -0.1)
    np.testing.assert_allclose(np.hypot(*from_centre.T), 0.75, rtol=1e-14)
    np.testing.assert_allclose(np.hypot(*table[:, 3:5].T), 0.16, rtol=1e-14)
    np.testing.assert_allclose(table[:, 6:8], -from_centre * (0.16 / 0.75) ** 2, atol=1e-15)
    round_s = 1.5 * math.pi / 0.16
    np.testing.assert_allclose(
        Circle(1.5, 0.16, acceleration_mps2=None)(np.array([0.0, round_s]))[:, :2], [[0.75, 0.0]] * 2, atol=1e-15
    )
    anticlockwise = from_centre[0, 0] * from_centre[1, 1] - from_centre[0, 1] * from_centre[1, 0]
    assert anticlockwise > 0.0


def test_arcs_are_driven_one_after_the_other_and_end_where_they_began() -> None:
    """The wheels that swing, by the rates that the plan asks of each; the others stand."""
    plan = Arcs(EVERY_WHEEL, 1.5, 0.1, 2, 0.5, 0.1016, 0.24, x_m=1.0, y_m=-2.0, theta_rad=0.7)
    assert plan.duration_s == pytest.approx(6 * 20.5)
    angle = np.arange(3) * 2.0 * math.pi / 3.0
    for number, wheels in enumerate((*EVERY_WHEEL, EVERY_WHEEL[0])):
        start_s = number * 20.5
        table = plan(start_s + np.linspace(0.0, 20.5, 206, endpoint=False))
        azimuth = table[:, 2:3] + angle
        rate = (-np.sin(azimuth) * table[:, 3:4] + np.cos(azimuth) * table[:, 4:5] + 0.24 * table[:, 5:6]) / 0.1016
        moving_s = np.maximum(np.linspace(0.0, 20.5, 206, endpoint=False) - 0.5, 0.0)
        wanted = 1.5 * 0.2 * math.pi * np.sin(0.2 * math.pi * moving_s)[:, None] * np.array(wheels)
        np.testing.assert_allclose(rate, wanted, atol=1e-12)
        np.testing.assert_allclose(table[:5, POSITION], [[1.0, -2.0, 0.7]] * 5, atol=1e-12)


def test_a_turning_heading_keeps_the_same_side_ahead() -> None:
    table = MOVING["circle, turning, clockwise"](np.linspace(0.0, 60.0, 200))
    ahead = np.arctan2(table[:, 4], table[:, 3]) - table[:, 2]
    np.testing.assert_allclose(np.cos(ahead - ahead[0]), 1.0, rtol=1e-14)
    assert (table[:, 5] == -0.16 / 0.75).all()


@pytest.mark.parametrize("name", ["straight from rest", "circle from rest", "circle from rest, turning"])
def test_starting_from_rest_stays_below_the_asked_acceleration_and_reaches_it(name: str) -> None:
    plan = MOVING[name]
    asked, speed = plan.acceleration_mps2, plan.speed_mps  # type: ignore[attr-defined]
    table = plan(np.linspace(0.0, 9.0, 90_001))
    assert not table[0, VELOCITY].any()
    assert not table[0, ACCELERATION].any()
    rate = np.hypot(*table[:, 3:5].T)
    along = np.diff(rate) / 1e-4
    # A sine of w = 2 a/V <= 3.7 rad/s, seen as means over 0.1 ms around its peak: it misses (w 0.1 ms)^2/8 = 2e-8.
    assert along.max() == pytest.approx(asked, rel=3e-8)
    assert along.min() > -1e-11  # never slower; rounding is 1e-16/0.1 ms
    assert rate[-1] == pytest.approx(abs(speed), rel=1e-14)


def test_the_ramp_is_as_long_as_it_says() -> None:
    plan = Straight(0.22, acceleration_mps2=0.4)
    ends = plan(np.array([plan.ramp_s]))[0]
    assert ends[0] == pytest.approx(plan.ramp_m, rel=1e-12)
    assert ends[3] == pytest.approx(0.22, rel=1e-12)
    assert plan(np.array([0.99 * plan.ramp_s]))[0, 3] < 0.22
    assert Straight(0.22, acceleration_mps2=None).ramp_m == 0.0


def test_the_testbed_starts_where_the_plan_starts() -> None:
    found = start_values(
        Circle(1.5, 0.16, start_rad=math.pi / 2, heading="turning", theta_rad=0.5, acceleration_mps2=None)
    )
    wanted = {"x": 0.0, "y": 0.75, "theta": 0.5, "vx": -0.16, "vy": 0.0, "omega": 0.16 / 0.75}
    assert found == {f"start.{name}": pytest.approx(value, abs=1e-15) for name, value in wanted.items()}
    assert start_values(Rest(1.0, 2.0, 0.5))["start.vx"] == 0.0


@pytest.mark.parametrize(
    ("plan", "changes", "field"),
    [
        ("circle", {"diameter_m": 0.0}, "Circle.diameter_m"),
        ("circle", {"speed_mps": math.nan}, "Circle.speed_mps"),
        ("circle", {"heading": "tangent"}, "Circle.heading"),
        ("circle", {"start_rad": math.inf}, "Circle.start_rad"),
        ("circle", {"acceleration_mps2": 0.0}, "Circle.acceleration_mps2"),
        ("straight", {"speed_mps": -0.1}, "Straight.speed_mps"),
        ("straight", {"x_m": 1e5}, "Straight.x_m"),
    ],
)
def test_a_plan_refuses(plan: str, changes: dict[str, object], field: str) -> None:
    with pytest.raises(GivewayError) as caught:
        dataclasses.replace(MOVING[plan], **changes)  # type: ignore[type-var]
    assert caught.value.field == field


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"wheels": ()}, "Arcs.wheels"),
        ({"wheels": ((1.0, -1.0, 0.0),)}, "Arcs.wheels"),
        ({"wheels": ((2.0, 0.0, 0.0),)}, "Arcs.wheels"),
        ({"swing_rad": 0.0}, "Arcs.swing_rad"),
        ({"frequency_hz": math.inf}, "Arcs.frequency_hz"),
        ({"swings": 0}, "Arcs.swings"),
        ({"rest_s": -1.0}, "Arcs.rest_s"),
        ({"wheel_radius_m": 0.0}, "Arcs.wheel_radius_m"),
        ({"y_m": 1e5}, "Arcs.y_m"),
        ({"theta_rad": math.nan}, "Arcs.theta_rad"),
    ],
)
def test_arcs_refuse(changes: dict[str, Any], field: str) -> None:
    with pytest.raises(GivewayError) as caught:
        dataclasses.replace(ARCS, **changes)
    assert caught.value.field == field


def push(**changes: float) -> TimedPush:
    return TimedPush(**{  # type: ignore[arg-type]
        "force_n": 40.0, "direction_rad": 2.0, "point_x_m": 0.1, "point_y_m": -0.2, "start_s": 1.0, "duration_s": 0.5,
        "ramp_s": 0.1, **changes,
    })  # fmt: skip


def integral(table: NDArray[np.float64], step_s: float) -> float:
    return float(np.hypot(*table[:, :2].T).sum() * step_s)


def test_a_push_rises_holds_and_falls() -> None:
    times = np.array([0.99, 1.0, 1.05, 1.1, 1.3, 1.4, 1.45, 1.5, 2.0])
    np.testing.assert_allclose(push().force(times), [0.0, 0.0, 20.0, 40.0, 40.0, 40.0, 20.0, 0.0, 0.0], atol=1e-12)
    np.testing.assert_array_equal(push(ramp_s=0.0).force(np.array([0.999, 1.0, 1.499, 1.5])), [0.0, 40.0, 40.0, 0.0])


@pytest.mark.parametrize("ramp_s", [0.0, 0.1, 0.25])
def test_the_impulse_of_a_push_is_what_it_says(ramp_s: float) -> None:
    # Corners lie on the grid, so the sum is the trapezoidal rule, exact for straight pieces up to rounding.
    one = push(ramp_s=ramp_s)
    assert integral(Pushes((one,))(np.arange(2001) * 1e-3), 1e-3) == pytest.approx(one.impulse_newton_s, rel=1e-9)


def test_pushes_act_one_after_the_other_at_their_points() -> None:
    table = Pushes((push(), push(start_s=1.5, direction_rad=0.0, point_x_m=0.3)))(np.array([0.5, 1.2, 1.7]))
    np.testing.assert_allclose(table[0], 0.0)
    np.testing.assert_allclose(table[1], [40.0 * math.cos(2.0), 40.0 * math.sin(2.0), 0.1, -0.2])
    np.testing.assert_allclose(table[2], [40.0, 0.0, 0.3, -0.2])


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"force_n": -1.0}, "TimedPush.force_n"),
        ({"duration_s": 0.0}, "TimedPush.duration_s"),
        ({"ramp_s": 0.26}, "TimedPush.ramp_s"),
        ({"direction_rad": math.nan}, "TimedPush.direction_rad"),
        ({"start_s": -0.1}, "TimedPush.start_s"),
    ],
)
def test_a_push_refuses(changes: dict[str, float], field: str) -> None:
    with pytest.raises(GivewayError) as caught:
        push(**changes)
    assert caught.value.field == field


def test_pushes_do_not_overlap() -> None:
    with pytest.raises(GivewayError, match="one at a time"):
        Pushes((push(), push(start_s=1.4)))
