"""The slider meets the robot where, when and as fast as `meet` was asked: measured in the plant, not computed again."""

from __future__ import annotations

import json
import math

import giveway
import numpy as np
import pytest
from giveway import batch
from giveway.base.errors import GivewayError
from giveway.library.run_up import RUN_UP, find_run_ups
from giveway.robot.variables import Value, table
from giveway.scenario.approach import Approach, edge_middle, meet, outline_of, outward_normal
from giveway.scenario.plan import Circle, Plan, Rest, Straight, start_values

TARE_S = 0.1


def parameters(**changes: Value) -> dict[str, Value]:
    """All of the testbed's parameters for a bare slider; names with "__" for the dot."""
    values = {v.name: v.start for v in table("testbed").select("parameter")}
    values |= {"bumper.kind": 0} | {name.replace("__", "."): value for name, value in changes.items()}
    return values  # type: ignore[return-value]


def first_touch(approach: Approach, plan: Plan, **changes: Value) -> tuple[float, float, float, float]:
    """Time (s), point (m, base frame) and slider speed (m/s) of the first contact in the testbed.

    The point is that of the first sample in contact. The speed is carried on to the contact from the two samples
    before it; that leaves the change of the acceleration, below 1 per s3 on the rail and 10 per s3 on the rope, times
    a step of 1 ms squared.
    """
    values = meet(approach, parameters(**changes), plan, TARE_S)
    overrides = {name.replace("__", "."): value for name, value in changes.items()} | values | start_values(plan)
    # Short: what comes after the contact is of no interest. The rope's run-up is below half a second here.
    duration = (0.4 if approach.time_s is None else approach.time_s) + 0.1
    scenario = giveway.Scenario("touch", duration, bumper="none", testbed=overrides, plan=plan)
    traces = batch.run(scenario).traces
    time_s = float(traces["testbed.truth.first_contact_time"][-1])
    assert time_s >= 0.0, "no contact"
    row = int(np.flatnonzero(traces["testbed.truth.contact"].values)[0])
    x, y = (float(traces[f"testbed.truth.contact_base_{axis}"][row]) for axis in "xy")
    at_s, speed = traces["time"].values, traces["testbed.truth.slider_speed"].values
    slope = (speed[row - 1] - speed[row - 2]) / (at_s[row - 1] - at_s[row - 2])
    return time_s, x, y, float(speed[row - 1] + slope * (time_s - at_s[row - 1]))


OUTLINE = outline_of(parameters())
MIDDLE = edge_middle(OUTLINE, 0)


@pytest.mark.parametrize("changes", [{}, {"slider__friction": 4.0}, {"slider__damping": 5.0, "slider__mass": 20.0}])
@pytest.mark.parametrize(("edge", "offset"), [(0, 0.0), (1, -0.12), (2, 0.2)])
def test_a_free_slider_meets_the_resting_robot(edge: int, offset: float, changes: dict[str, Value]) -> None:
    point = edge_middle(OUTLINE, edge, offset)
    time_s, x, y, speed = first_touch(Approach(point, 0.4, time_s=0.5), Rest(), **changes)
    # The rail's friction is full from 5 mm/s on and the robot stands: rounding of numbers around 1 m remains, and
    # what the robot moves in the first millisecond of the contact (1e-8 m); the run-up with damping is integrated, to
    # 1e-6 of each step. Seen: 4e-11 s, 2e-8 m, 4e-8 m/s.
    assert time_s == pytest.approx(0.5, abs=1e-9)
    assert (x, y) == pytest.approx(point, abs=1e-7)
    assert speed == pytest.approx(0.4, abs=1e-6)


def test_a_slider_slower_than_its_rails_friction_builds_up_meets_the_robot_in_time() -> None:
    # At 2 mm/s the friction is 0.38 of what it is from 5 mm/s on: taken for full, the contact is 3 ms off.
    time_s, _, _, speed = first_touch(Approach(MIDDLE, 0.002, time_s=0.5), Rest(), slider__friction=0.4)
    assert time_s == pytest.approx(0.5, abs=1e-6)
    assert speed == pytest.approx(0.002, abs=1e-6)


@pytest.mark.parametrize("rope", [True, False])
def test_travels_before_contact_are_those_of_the_testbed(rope: bool) -> None:
    approach = Approach(MIDDLE, 0.5, rope=rope, time_s=None if rope else 0.4)
    values = parameters(slider__friction=4.0, slider__damping=3.0)
    scenario = giveway.Scenario(
        "run up",
        0.15,
        bumper="none",
        testbed={k: v for k, v in values.items() if k != "bumper.kind"} | meet(approach, values, Rest()),
    )
    traces = batch.run(scenario).traces
    run_up = np.zeros(1, dtype=RUN_UP)
    for name in run_up.dtype.names or ():
        if name in values:
            run_up[name] = values[name]
    run_up["rope.attached"], run_up["end_speed_mps"], run_up["duration_s"] = rope, 0.5, 0.4
    times = traces["time"].values
    travels = find_run_ups(run_up, times[None, :])[0]
    before_contact = times < run_up["duration_s"]
    assert before_contact.sum() > 100
    # The cubic between the knots is good to a micrometre.
    found = traces["testbed.truth.slider_position"].values
    np.testing.assert_allclose(travels[before_contact], found[before_contact], rtol=0.0, atol=1e-6)


@pytest.mark.parametrize("changes", [
    {}, {"slider__friction": 4.0}, {"slider__damping": 5.0}, {"slider__mass": 20.0}, {"rope__hanging_mass": 3.0},
    {"rope__damping": 400.0}, {"rope__stiffness": 3000.0},
])  # fmt: skip
@pytest.mark.parametrize("speed", [0.25, 0.5, 0.7])
def test_the_weight_makes_the_slider_as_fast_as_asked(speed: float, changes: dict[str, Value]) -> None:
    _, x, y, found = first_touch(Approach(MIDDLE, speed, rope=True), Rest(), **changes)
    assert (x, y) == pytest.approx(MIDDLE, abs=1e-7)
    assert found == pytest.approx(speed, abs=1e-5)  # see first_touch


@pytest.mark.parametrize("angle_deg", [-60.0, -25.0, 25.0, 60.0])
def test_an_oblique_nose_touches_the_point_all_the_same(angle_deg: float) -> None:
    # 60 deg off, the disc's side touches, 17 mm beside its tip. It is seen 0.7 ms later, at the next sample, when the
    # nose has slid along the side; what the force has changed by then is below 0.2 um.
    point = edge_middle(OUTLINE, 1)  # the side that looks along -x
    angle_rad = math.radians(angle_deg)
    time_s, x, y, _ = first_touch(Approach(point, 0.5, angle_rad, time_s=0.5003), Rest())
    assert time_s == pytest.approx(0.5003, abs=1e-13)
    assert (x, y) == pytest.approx((point[0], point[1] + 0.5 * 0.7e-3 * math.sin(angle_rad)), abs=5e-7)


def test_a_corner_is_met() -> None:
    corner = (float(OUTLINE[0, 0]), float(OUTLINE[0, 1]))
    time_s, x, y, _ = first_touch(Approach(corner, 0.5, time_s=0.5), Rest())
    assert time_s == pytest.approx(0.5, abs=1e-13)
    assert (x, y) == pytest.approx(corner, abs=1e-12)


def test_the_robot_may_stand_anywhere() -> None:
    plan = Rest(2.0, -1.0, 2.5)
    time_s, x, y, _ = first_touch(Approach(MIDDLE, 0.5, time_s=0.5), plan)
    assert time_s == pytest.approx(0.5, abs=1e-13)
    assert (x, y) == pytest.approx(MIDDLE, abs=1e-12)


MOVING = {
    "straight": (Straight(0.22, 1.0, acceleration_mps2=0.3), 2.0),
    "around a circle": (Circle(1.5, 0.16, theta_rad=0.3, acceleration_mps2=0.1), 4.0),
    "around a circle, clockwise, turning": (Circle(1.5, -0.16, heading="turning", acceleration_mps2=0.1), 4.0),
}


@pytest.mark.parametrize("case", MOVING)
@pytest.mark.parametrize("speed", [0.0, 0.3])
def test_a_moving_robot_is_led(case: str, speed: float) -> None:
    plan, when = MOVING[case]
    heading = plan(np.array([when - TARE_S]))[0]
    # The point that looks most along the robot's motion, so that a resting slider is reached at all.
    world = math.atan2(heading[4], heading[3]) - heading[2]
    edge = max(range(3), key=lambda e: float(normal_of(e) @ (math.cos(world), math.sin(world))))
    point = edge_middle(OUTLINE, edge, 0.05)
    time_s, x, y, found = first_touch(Approach(point, speed, time_s=when), plan)
    # The robot lags its plan by what friction deflects servo and drivetrains (2.8 N m over 203 N m/rad at a wheel of
    # 0.1 m: 1.4 mm, plus the rollers' 42 N over 29 kN/m) and by two bus cycles: up to 5 mm. It is never ahead.
    lag_m = 5e-3
    assert (x, y) == pytest.approx(point, abs=lag_m)
    late_s = time_s - when
    assert 0.0 < late_s < lag_m / (math.hypot(heading[3], heading[4]) + speed)
    assert found == pytest.approx(rolled_out(speed, late_s), abs=1e-6)


@pytest.mark.parametrize("rate_radps", [0.5, -0.5])
def test_a_robot_that_turns_on_the_spot_sweeps_half_a_side_towards_the_slider(rate_radps: float) -> None:
    # 0.2 m from the middle of a side, the surface moves at 0.1 m/s along its normal: outwards ahead of the middle,
    # seen in the sense of the turn, inwards behind it.
    radius_m = 0.5e-3
    plan = Circle(2.0 * radius_m, rate_radps * radius_m, heading="turning", acceleration_mps2=1e-3)
    ahead, behind = (edge_middle(OUTLINE, 0, math.copysign(0.2, -rate_radps) * sign) for sign in (1.0, -1.0))
    time_s, x, y, _ = first_touch(Approach(ahead, 0.0, time_s=1.0), plan)
    # The servo lags as in the test above, but the rollers are not loaded sideways.
    lag_m = 1.4e-3 + 2e-3 * 0.1
    assert (x, y) == pytest.approx(ahead, abs=lag_m)
    assert 0.0 < time_s - 1.0 < lag_m / 0.1
    for speed, meets in ((0.0, False), (0.099, False), (0.101, True)):
        approach = Approach(behind, speed, time_s=1.0)
        if meets:
            assert meet(approach, parameters(), plan, TARE_S)["slider.speed"] > speed  # friction takes the rest
        else:
            with pytest.raises(GivewayError, match="approach each other"):
                meet(approach, parameters(), plan, TARE_S)


def rolled_out(speed: float, time_s: float) -> float:
    """Of the slider in m/s, ``time_s`` after it had ``speed``: friction and damping of the rail slow it down."""
    mass, friction, damping = (float(parameters()[f"slider.{name}"]) for name in ("mass", "friction", "damping"))
    assert damping == 0.0
    return speed - friction / mass * time_s if speed > 0.0 else 0.0


def normal_of(edge: int) -> np.ndarray:
    return outward_normal(OUTLINE, edge_middle(OUTLINE, edge))


REFUSED: dict[str, tuple[dict[str, object], Plan, str, str]] = {
    "beside the robot": ({"point_m": (0.5, 0.5)}, Rest(), "point_m", "nearest is"),
    "inside the robot": ({"point_m": (0.0, 0.0)}, Rest(), "point_m", "outline"),
    "away from the side": ({"direction_rad": 1.0}, Rest(), "direction_rad", "approach"),
    "both stand": ({"speed_mps": 0.0}, Rest(), "speed_mps", "approach"),
    "too fast for the weight": ({"speed_mps": 3.0, "rope": True, "time_s": None}, Rest(), "speed_mps", "at most 1.1"),
    "a corner sweeps over the nose": ({"speed_mps": 0.05, "time_s": 3.0}, Circle(0.2, 0.5, heading="turning"),
                                      "point_m", "before"),
}  # fmt: skip


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_met_is_refused(case: str) -> None:
    changes, plan, field, words = REFUSED[case]
    given = {"point_m": MIDDLE, "speed_mps": 0.5, "time_s": 0.5, **changes}
    with pytest.raises(GivewayError, match=words) as caught:
        meet(Approach(**given), parameters(), plan)  # type: ignore[arg-type]
    assert caught.value.field == field
    assert field == "point_m" or caught.value.value == given[field]


@pytest.mark.parametrize("share", [0.5, 1.0])
def test_a_slider_that_leaves_the_robot_straight_is_refused_for_its_speed(share: float) -> None:
    """Nobody gave a direction that could be wrong: straight into a side that goes away faster."""
    normal = normal_of(0)
    away = Straight(0.2, math.atan2(-normal[1], -normal[0]), acceleration_mps2=None)
    with pytest.raises(GivewayError, match="approach each other") as caught:
        meet(Approach(MIDDLE, share * 0.2, time_s=0.5), parameters(), away)
    assert caught.value.value == share * 0.2


def test_a_rail_that_would_ask_for_too_fast_a_start_is_told_the_time() -> None:
    with pytest.raises(GivewayError, match="rail's friction") as caught:
        meet(Approach(MIDDLE, 0.5, time_s=60.0), parameters(slider__damping=10.0), Rest())
    assert (caught.value.field, caught.value.value) == ("time_s", 60.0)


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"speed_mps": -0.1}, "speed_mps"),
        ({"time_s": None}, "time_s"),
        ({"time_s": math.nan}, "time_s"),
        ({"rope": True}, "time_s"),
        ({"rope": True, "time_s": None, "speed_mps": 0.0}, "speed_mps"),
        ({"direction_rad": math.inf}, "direction_rad"),
    ],
)
def test_an_approach_refuses(changes: dict[str, object], field: str) -> None:
    given = {"point_m": MIDDLE, "speed_mps": 0.5, "time_s": 0.5, **changes}
    with pytest.raises(GivewayError) as caught:
        Approach(**given)  # type: ignore[arg-type]
    assert caught.value.field == field


def test_edges_are_counted_from_their_first_corner() -> None:
    assert edge_middle(OUTLINE, 1) == pytest.approx((-0.176092, 0.0), abs=1e-12)
    assert edge_middle(OUTLINE, 1, 0.1) == pytest.approx((-0.176092, -0.1), abs=1e-12)
    with pytest.raises(GivewayError, match="0 to 2"):
        edge_middle(OUTLINE, 3)
    with pytest.raises(GivewayError, match="offset_m"):
        edge_middle(OUTLINE, 0, 0.31)


@pytest.mark.parametrize("edge", range(len(OUTLINE)))
def test_a_point_beside_the_robot_is_told_the_nearest_on_its_outline(edge: int) -> None:
    middle = edge_middle(OUTLINE, edge)
    beside = tuple(float(value) for value in np.asarray(middle) + 0.05 * np.asarray(outward_normal(OUTLINE, middle)))
    with pytest.raises(GivewayError) as caught:
        meet(Approach(beside, 0.5, time_s=0.5), parameters(), Rest())  # type: ignore[arg-type]
    told = caught.value.allowed.partition("the nearest is ")[2]
    assert json.loads(told) == pytest.approx(middle, abs=0.6e-3)  # the message is in millimetres
