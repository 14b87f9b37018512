"""The table of runs: a row is what a scenario of the same values would be, bit for bit, and as fast as it must be."""

from __future__ import annotations

import math

import numpy as np
import pytest
from giveway import batch
from giveway.base import native
from giveway.library.work import result_columns, run_work
from giveway.robot.population import start_value
from giveway.robot.variables import table
from giveway.scenario.approach import Approach, edge_middle, meet_as_stated, outline_of
from giveway.scenario.plan import Rest, Straight
from giveway.scenario.scenario import Scenario
from giveway.study import Study
from giveway.study.chosen import scenario_of_run
from giveway.study.designs import deviations
from giveway.study.engine import plan_runs
from giveway.study.runs import RunTable
from study_helpers import LATCH, small_study

VARIED = {
    "testbed.bumper.spring_rate": {"low": 500.0, "high": 2000.0},
    "robot.drivetrain.stiffness": {"low": 500.0, "high": 900.0},
    "controller.detector.impulse_threshold": {"low": 1.0, "high": 2.0},
    "testbed.roller.model": {"values": [0, 1]},
    "bumper": {"values": ["none", "spring", "magnetic"]},
    "temperature": {"low": -20.0, "high": 60.0},
    "collision.speed": {"low": 0.2, "high": 0.6},
    "collision.mass": {"low": 5.0, "high": 20.0},
    "collision.offset": {"low": -0.2, "high": 0.2},
    "collision.angle": {"low": -30.0, "high": 30.0},
}
"""One of every kind of quantity."""


def varied_table(count: int = 6) -> tuple[RunTable, object]:
    study = small_study(vary=[]).collision("rope", speed=0.3, edge=1, rope=True)
    study.document["scenario"]["duration"] = 0.3  # a heavy slider takes longer to be pulled
    for quantity, keys in VARIED.items():
        study.vary(quantity, **keys)
    study.tolerance(LATCH, relative=0.3).tolerance("testbed.base.mass", absolute=2.0, distribution="normal")
    study.tolerances(samples=2, noise_seeds=True, robot="file").designs("latin-hypercube", count=count)
    setup = study.setup()
    return plan_runs(setup), setup


def run_natively(runs: RunTable, which: np.ndarray) -> dict[str, np.ndarray]:
    design, sample, case = runs.split(which)
    values = np.empty((len(which), len(runs.columns.names)))
    for number in range(len(runs.cases)):
        mine = case == number
        rows = runs.rows(design[mine], sample[mine], number)
        assert not rows.refused
        values[mine] = rows.values
    done = run_work(runs.work(values, case, "event-exact", None), threads=2)
    assert (done.status == 0).all(), done.messages
    return {name: done.numbers[:, j] for j, (name, _) in enumerate(result_columns())}


def test_a_row_runs_as_its_scenario_does() -> None:
    runs, setup = varied_table()
    which = np.arange(0, runs.count, 7)
    results = run_natively(runs, which)
    scenarios = [
        scenario_of_run(setup, runs, *(int(i) for i in index)) for index in zip(*runs.split(which), strict=True)
    ]  # type: ignore[arg-type]
    expected = batch.run_many(scenarios, threads=2)
    for metric in batch.native_metrics():
        np.testing.assert_array_equal(results[metric.name], expected[metric.name].values, metric.name)


def test_values_end_up_where_they_belong() -> None:
    runs, _ = varied_table()
    at = runs.columns.index
    names = list(VARIED)
    design = np.array([3])
    value = dict(zip(names, runs.designs[3], strict=True))
    nominal = runs.rows(design, np.array([0]), 0).values[0]
    other = runs.rows(design, np.array([2]), 0).values[0]
    for name in ("testbed.drivetrain.stiffness", "controller.estimator.drivetrain_stiffness"):
        assert nominal[at[name]] == value["robot.drivetrain.stiffness"]
    assert nominal[at["testbed.slider.mass"]] == value["collision.mass"]
    assert nominal[at["testbed.bumper.kind"]] == value["bumper"]
    start = runs.columns.start[at[LATCH]]
    warm = 1.0 - 0.0024 * (value["temperature"] - 20.0)
    assert nominal[at[LATCH]] == pytest.approx(start * warm, rel=1e-15)
    by = runs.deviations[2]
    assert other[at[LATCH]] == pytest.approx(start * (1.0 + by[0]) * warm, rel=1e-15)
    # The load is on the robot; the controller does not know it.
    assert other[at["testbed.base.mass"]] == nominal[at["testbed.base.mass"]] + by[1]
    assert other[at["controller.base.mass"]] == nominal[at["controller.base.mass"]]
    assert other[at["testbed.electronics.seed"]] == nominal[at["testbed.electronics.seed"]] + 2
    # A hit from 20 deg beside straight comes from there, and with the asked speed after the rail's friction.
    side = runs.cases[0].outline[1] - runs.cases[0].outline[0]
    inward = math.atan2(side[0], -side[1])
    turned = nominal[at["testbed.slider.direction"]] - inward - math.radians(value["collision.angle"])
    assert math.remainder(turned, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("plan", [Rest(0.3, -0.2, 0.4), Straight(0.2, 0.5, theta_rad=0.1)], ids=["rest", "moving"])
@pytest.mark.parametrize("rope", [False, True])
def test_many_approaches_are_as_one_by_one(plan: object, rope: bool) -> None:
    from giveway.scenario.approach import Approaches, meet_many

    testbed = {v.name: v.start for v in table("testbed").select("parameter") if v.start is not None} | {
        "bumper.kind": 0
    }
    outline = outline_of(testbed)
    offsets, speeds = np.linspace(-0.2, 0.2, 7), np.linspace(0.2, 0.6, 7)
    masses = np.linspace(5.0, 15.0, 7)
    points = np.array([edge_middle(outline, 0, float(offset)) for offset in offsets])
    time_s = None if rope else np.full(7, 0.6)
    many = meet_many(
        Approaches(points, speeds, np.full(7, np.nan), time_s),
        {**testbed, "slider.mass": masses},
        plan,
        np.full(7, 0.1),
    )
    assert not many.refused
    for i in range(7):
        one = Approach(tuple(points[i]), float(speeds[i]), None, None if rope else 0.6, rope)
        alone, stated, when_s = meet_as_stated(one, {**testbed, "slider.mass": float(masses[i])}, plan, 0.1)
        for name, values in many.slider.items():
            assert values[i] == alone[name], name
        assert (many.contact_speed_mps[i], many.time_s[i]) == (stated.speed_mps, when_s)


def test_a_hit_anywhere_around_comes_straight_in() -> None:
    study = small_study(vary=[]).vary("collision.around", values=[0.05, 0.3, 0.45, 0.7, 0.95])
    study.document["scenario"] = {"duration": 0.3, "bumper": "none"}
    runs = plan_runs(study.setup())
    metrics = run_natively(runs, np.arange(5))
    # 0.5 m/s at the contact, less a step of friction.
    assert metrics["contact speed"] == pytest.approx(np.full(5, 0.5), abs=5e-3)
    rows = runs.rows(np.arange(5), np.zeros(5, dtype=int), 0)
    found = 1e-3 * np.stack([metrics["contact point x (true)"], metrics["contact point y (true)"]], axis=1)
    expected = np.stack([rows.hit["point_x"], rows.hit["point_y"]], axis=1)
    np.testing.assert_allclose(found, expected, atol=2e-3)  # the base gives way under the nose until detection


def test_a_moving_robot_is_met_in_time_however_long_the_tare_holds_it() -> None:
    plan = {"kind": "straight", "speed": 0.2, "direction": 60.0}
    study = Study("tares", duration=1.7, bumper="none", plan=plan).collision("head-on", speed=0.0, edge=0, time=1.6)
    study.vary("controller.estimator.tare_ticks", values=[0, 50, 400])
    results = run_natively(plan_runs(study.setup()), np.arange(3))
    # The robot lags its plan by up to 5 mm (see test_approach.py); 50 ms of tare are 10 mm.
    late_s = results["contact time"] - 1.6
    assert ((late_s > 0.0) & (late_s < 5e-3 / 0.2)).all(), late_s


def test_the_hit_has_its_tolerances() -> None:
    study = small_study(vary=[]).tolerance("collision.speed", relative=0.1).tolerance("collision.angle", absolute=5.0)
    study.tolerance("collision.offset", absolute=10, unit="mm").tolerance("collision.mass", relative=0.05)
    runs = plan_runs(study.tolerances(kind="corners").setup())
    assert runs.count == 17
    rows = runs.rows(np.zeros(17, dtype=int), np.arange(17), 0)
    assert not rows.refused
    by = runs.deviations
    np.testing.assert_allclose(rows.hit["speed"], 0.5 * (1.0 + by[:, 0]), rtol=1e-15)
    straight = rows.values[0, runs.columns.index["testbed.slider.direction"]]
    turned = np.degrees(rows.values[:, runs.columns.index["testbed.slider.direction"]] - straight)
    np.testing.assert_allclose(turned, by[:, 1], atol=1e-12)
    middle = np.array([rows.hit["point_x"][0], rows.hit["point_y"][0]])
    away = np.hypot(rows.hit["point_x"] - middle[0], rows.hit["point_y"] - middle[1])
    np.testing.assert_allclose(away, np.abs(by[:, 2]), atol=1e-15)
    assert set(np.abs(by[1:, 2])) == {0.01}
    np.testing.assert_allclose(rows.values[:, runs.columns.index["testbed.slider.mass"]], 9.08 * (1.0 + by[:, 3]))


def test_a_gear_s_ratio_changes_what_is_seen_at_the_wheel() -> None:
    study = (
        small_study(vary=[])
        .vary("gear_ratio", values=[1.0, 1.5])
        .vary("robot.drivetrain.encoder_counts", values=[1001])
    )
    study.vary("testbed.drivetrain.motor_inertia", values=[0.08])
    runs = plan_runs(study.setup())
    rows = runs.rows(np.array([0, 1]), np.array([0, 0]), 0).values
    own, geared = ({name: row[i] for name, i in runs.columns.index.items()} for row in rows)
    assert own["testbed.drivetrain.motor_inertia"] == 0.08
    factors = {name: geared[name] / own[name] for name in own if geared[name] != own[name]}
    squared = dict.fromkeys(("testbed.drivetrain.motor_inertia", "testbed.drivetrain.gear_viscous"), 2.25)
    once = ("testbed.drivetrain.gear_coulomb", "testbed.drivetrain.gear_stiction", "testbed.drivetrain.torque_limit")
    counts = dict.fromkeys(("testbed.electronics.encoder_counts", "controller.estimator.encoder_counts"), 1502 / 1001)
    motor = ("controller.motor.coulomb_torque", "controller.motor.torque_limit")
    known = {"controller.motor.inertia": 2.25, **dict.fromkeys(motor, 1.5)}
    assert factors == pytest.approx(squared | dict.fromkeys(once, 1.5) | counts | known, rel=1e-15)


def test_a_controller_knows_of_the_motors_what_is_the_robots() -> None:
    study = small_study(vary=[]).vary("robot.drivetrain.motor_inertia", values=[0.02, 0.08])
    study.vary("robot.servo.kp", values=[100.0]).vary("testbed.servo.kd", values=[5.0])
    runs = plan_runs(study.setup())
    rows = runs.rows(np.array([0, 1]), np.array([0, 0]), 0).values
    found = {name: rows[:, i].tolist() for name, i in runs.columns.index.items()}
    assert found["controller.motor.inertia"] == found["testbed.drivetrain.motor_inertia"] == [0.02, 0.08]
    assert found["controller.motor.kp"] == found["testbed.servo.kp"] == [100.0, 100.0]
    assert found["testbed.servo.kd"] == [5.0, 5.0]
    assert found["controller.motor.kd"] == [runs.columns.start[runs.columns.index["testbed.servo.kd"]]] * 2


@pytest.mark.parametrize("of", [{"preset": "paper"}, {"robot": "robotino"}], ids=["paper", "current"])
def test_a_controller_that_observes_no_motors_goes_on_not_observing_them(of: dict[str, str]) -> None:
    def small() -> Study:
        study = small_study(vary=[])
        study.document["scenario"].update(of)
        return study

    study = small().vary("robot.drivetrain.motor_inertia", values=[0.02, 0.08])
    study.vary("robot.servo.kp", values=[100.0, 120.0]).tolerance("robot.drivetrain.motor_inertia", relative=0.1)
    setup = study.tolerances(samples=4, robot="file").designs("one-at-a-time").setup()
    runs = plan_runs(setup)
    every = np.arange(len(runs.designs))
    for sample in (0, 3):
        rows = runs.rows(every, np.full(len(every), sample), 0).values
        assert set(rows[:, runs.columns.index["controller.motor.inertia"]]) == {0.0}
    own = start_value("drivetrain.motor_inertia", robot=native.robots()[of.get("robot", "trikey")])
    nominal = runs.rows(every, np.zeros(len(every), dtype=np.int64), 0).values
    assert own in nominal[:, runs.columns.index["testbed.drivetrain.motor_inertia"]]  # while kp varies
    asked = small().vary("controller.motor.inertia", values=[0.02]).setup()
    (row,) = plan_runs(asked).rows(np.array([0]), np.array([0]), 0).values
    assert row[runs.columns.index["controller.motor.inertia"]] == 0.02


def test_a_controller_knows_how_long_the_bus_takes() -> None:
    study = small_study(vary=[]).vary("robot.electronics.bus_delay", values=[0, 3, 4])
    runs = plan_runs(study.setup())
    rows = runs.rows(np.arange(3), np.zeros(3, dtype=np.int64), 0).values
    found = {name: rows[:, i].tolist() for name, i in runs.columns.index.items()}
    assert found["testbed.electronics.command_delay"] == found["testbed.electronics.sensor_delay"] == [0.0, 3.0, 4.0]
    assert found["controller.motor.delay"] == [1.0, 7.0, 8.0]
    assert found["controller.motor.inertia"] == [0.0523, 0.0523, 0.0]  # it remembers no more than 8 ticks
    assert {"controller.motor.delay", "controller.motor.inertia"} <= {runs.columns.names[i] for i in runs.used}
    mine = plan_runs(study.vary("controller.motor.delay", values=[5]).setup())
    own = mine.rows(np.arange(3), np.zeros(3, dtype=np.int64), 0).values
    assert set(own[:, runs.columns.index["controller.motor.delay"]]) == {5.0}


def test_tolerance_samples_are_those_of_the_study_s_next_seed() -> None:
    """The designs take the seed itself; with samples of another seed a stored study could not be continued."""
    study = small_study(vary=[], seed=5).vary(LATCH, low=0.0, high=60.0).tolerance("testbed.base.mass", absolute=2.0)
    study.tolerances(samples=16, kind="latin-hypercube", robot="file")
    setup = study.designs("latin-hypercube", count=16).setup()
    found = plan_runs(setup)
    expected = deviations(setup.tolerances, "latin-hypercube", 16, 6)
    np.testing.assert_array_equal(found.deviations, expected)
    assert not np.array_equal(expected, deviations(setup.tolerances, "latin-hypercube", 16, 5)), "no seed is seen"


def test_a_place_beside_the_side_is_refused_with_its_reason() -> None:
    study = small_study(vary=[]).vary("collision.offset", values=[0.0, 0.5])
    rows = plan_runs(study.setup()).rows(np.array([0, 1]), np.array([0, 0]), 0)
    assert list(rows.refused) == [1]
    assert "collision.offset: 0.5 is not allowed" in rows.refused[1]


def test_keys_are_those_of_the_values() -> None:
    runs, _ = varied_table(4)
    contexts = [case.context({"code": 1}) for case in runs.cases]
    design, sample, case = runs.split(np.arange(runs.count))
    keys = []
    for number in range(2):
        mine = case == number
        keys += runs.keys(contexts, runs.rows(design[mine], sample[mine], number), number)
    assert len(set(keys)) == runs.count
    again = runs.keys(contexts, runs.rows(np.array([2]), np.array([1]), 1), 1)[0]
    assert again in keys
    other_code = [case.context({"code": 2}) for case in runs.cases]
    assert runs.keys(other_code, runs.rows(np.array([2]), np.array([1]), 1), 1)[0] not in keys


def test_another_plan_or_push_is_another_run() -> None:
    keys = set()
    push = {"force": 30.0, "direction": 0.0, "point": [0.088, 0.1525], "start": 0.1, "duration": 0.1}
    for scenario in (
        {"duration": 0.2, "plan": {"kind": "straight", "speed": 0.1}},
        {"duration": 0.2, "plan": {"kind": "straight", "speed": 0.2}},
        {"duration": 0.3, "plan": {"kind": "straight", "speed": 0.2}},
        {"duration": 0.2, "plan": {"kind": "straight", "speed": 0.2}, "push": [push]},
        {"duration": 0.2, "plan": {"kind": "straight", "speed": 0.2}, "push": [{**push, "force": 31.0}]},
    ):
        runs = plan_runs(Study("no collision", **scenario).setup())
        (case,) = runs.cases
        rows = runs.rows(np.array([0]), np.array([0]), 0)
        keys.add(runs.keys([case.context({})], rows, 0)[0])
    assert len(keys) == 5


def test_the_scenario_of_a_run_has_its_values() -> None:
    runs, setup = varied_table(4)
    scenario = scenario_of_run(setup, runs, 2, 1, 1)  # type: ignore[arg-type]
    assert isinstance(scenario, Scenario)
    values = runs.rows(np.array([2]), np.array([1]), 1).values[0]
    for model in ("controller", "testbed"):
        known = scenario.parameters(model)
        for name, column in runs.columns.index.items():
            if name.startswith(f"{model}."):
                short = name.partition(".")[2]
                assert float(known.get(short, runs.columns.start[column])) == values[column], name
