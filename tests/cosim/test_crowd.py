"""`giveway crowd`: every run by its number alone, the definitions against a formula of their own, today's limits."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from giveway import batch
from giveway.base import native
from giveway.base.errors import GivewayError
from giveway.cli import _main as cli_main
from giveway.crowd import calibrated, endurance, lifts, table
from giveway.crowd.blow import Blow
from giveway.crowd.command import ended_early
from giveway.crowd.crowd import compute, crowd, limits_of
from giveway.crowd.drive import Drive, Leg
from giveway.crowd.hits import PATTERN, PER_ROBOT, Hit, hit
from giveway.crowd.judged import RECORDED, Contact, Judged, judge, limits
from giveway.crowd.parts import Interrupted, Work, go_on
from giveway.crowd.population import GROUPS, IMU, POPULATION, Quantity, group_of, robot, robot_of, start_value
from giveway.crowd.statistics import count_interval, mean, percentile, rate_upper_bound
from giveway.robot.presets import NO_REFLEX, preset_values

DRAW = "tuning"
ROBOT = 3  # a planar one
NUMBERS = [*range(ROBOT * PER_ROBOT, ROBOT * PER_ROBOT + 10), 2 * PER_ROBOT]


@pytest.fixture(scope="module")
def records() -> list[dict[str, Any]]:
    return compute(DRAW, {}, NUMBERS, 2, lambda _done: None)


def test_a_hit_has_the_same_bits_alone_and_in_the_crowd(records: list[dict[str, Any]]) -> None:
    for place in (0, 8, 10):
        alone = compute(DRAW, {}, [NUMBERS[place]], 1, lambda _done: None)
        assert json.dumps(alone[0]) == json.dumps(records[place])


def test_every_robot_has_every_kind_of_hit() -> None:
    kinds = {(situation, kind) for situation, kind in PATTERN}
    assert {"free", "pulled", "clamped", "slow push", "moment"} == {kind for _, kind in kinds}
    assert {"rest", "motion", "starting", "stopping", "reacting"} <= {situation for situation, _ in kinds}
    for number in range(PER_ROBOT):
        one = hit(DRAW, number)
        assert (one.number, one.robot.number) == (number, 0)
        assert PATTERN[number][1] == one.kind


def test_draws_are_of_their_own_and_within_what_is_stated() -> None:
    by_group = {group: [robot_of(DRAW, number, group) for number in range(100)] for group in GROUPS}
    seen = by_group["single rollers"]
    assert robot(DRAW, 1).testbed["base.tipping"]
    assert len({tuple(one.testbed.items()) for one in seen}) == 100
    assert robot(DRAW, 0) == seen[0]
    assert robot("judging", 0).testbed != seen[0].testbed
    for quantity in POPULATION:
        for name in quantity.parameters:
            values = np.array([float(one.testbed[name]) for one in by_group[quantity.only or GROUPS[0]]])
            if quantity.scales:
                values /= start_value(name)
            if quantity.polar:
                values = np.array(
                    [math.hypot(*(float(one.testbed[name]) for name in quantity.parameters)) for one in seen]
                )
            assert quantity.low <= values.min() <= values.max() <= quantity.high
            # Of 100 uniform draws the outermost lie within a tenth of the ends (probability of failure 5e-5).
            reach = 0.1 * (quantity.high - quantity.low)
            assert values.min() < quantity.low + reach
            assert values.max() > quantity.high - reach


def test_a_parameter_that_the_testbed_does_not_have_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    unknown = Quantity("nothing", ("roller.colour",), 0.0, 1.0, scales=True)
    monkeypatch.setattr("giveway.robot.population.POPULATION", (*POPULATION, unknown))
    with pytest.raises(GivewayError, match=r"roller\.colour"):
        robot(DRAW, 0)


def test_a_tenth_and_more_has_each_other_plant() -> None:
    groups = [group_of(number) for number in range(1000)]
    assert all(groups.count(group) >= 100 for group in GROUPS)
    assert robot(DRAW, 0).testbed["roller.arrangement"] == 1
    for group in GROUPS:  # and in each, half are pushed slowly while they drive
        mine = [number for number in range(40) if group_of(number) == group]
        driving = [hit(DRAW, number * PER_ROBOT + 10).situation == "motion" for number in mine]
        assert sum(driving) == len(mine) / 2


def reference(one: Hit, traces: Mapping[str, Any], time_s: Any) -> dict[str, Any]:
    """The definitions again, row by row."""
    count = traces["controller.detection.count"]
    detected = [k for k in range(1, len(time_s)) if count[k] > count[k - 1]]
    force = [
        float(traces["testbed.truth.contact_force"][k])
        + math.hypot(traces["testbed.push.force_x"][k], traces["testbed.push.force_y"][k])
        for k in range(len(time_s))
    ]
    false = 0
    for k in detected:
        false += not any(force[j] > 0.5 for j in range(max(0, k - 100), k + 1))
    contacts = []
    k = 0
    while k < len(time_s):
        if force[k] <= 0.5:
            k += 1
            continue
        last = k
        while True:
            more = [j for j in range(last + 1, min(last + 101, len(time_s))) if force[j] > 0.5]
            if not [j for j in more if j - last < 100]:
                break
            last = more[0]
        # Trapezoids of the slider's force, rectangles of the push.
        impulse = np.zeros(2)
        passed = None
        for j in range(max(k - 1, 0), min(last + 1, len(time_s) - 1)):
            for axis, name in enumerate(("x", "y")):
                slider = traces[f"testbed.truth.contact_force_{name}"]
                impulse[axis] += 0.5e-3 * (slider[j] + slider[j + 1])
                impulse[axis] += 1e-3 * traces[f"testbed.push.force_{name}"][j] * (j >= k)
            if passed is None and math.hypot(*impulse) >= 1.0:
                passed = j + 1
        contacts.append((k, last, math.hypot(*impulse), passed))
        k = last + 1
    return {"detections": detected, "false": false, "contacts": contacts}


def test_judged_as_a_formula_of_its_own(records: list[dict[str, Any]]) -> None:
    hits = [hit(DRAW, number) for number in NUMBERS[:-1]]
    many = batch.Prepared([one.scenario for one in hits], traces=RECORDED).run(method="fixed-step")
    time_s = many["time"].values
    noticed = 0
    for index, one in enumerate(hits):
        traces = {name: many[name].values[index] for name in RECORDED}
        judged = judge(time_s, traces, limits_of(one))
        assert judged == Judged.of(records[index]["judged"])
        expected = reference(one, traces, time_s)
        assert [round(1e3 * time) for time in judged.detections_s] == expected["detections"]
        assert len(judged.false_s) == expected["false"]
        assert len(judged.contacts) == len(expected["contacts"])
        for contact, (first, last, impulse, passed) in zip(judged.contacts, expected["contacts"], strict=True):
            assert first - 1 <= 1e3 * contact.start_s <= first
            assert contact.end_s == pytest.approx(1e-3 * min(last + 1, len(time_s) - 1))
            # Trapezoids over 1 ms of a force that rises within some.
            assert contact.impulse_ns == pytest.approx(impulse, rel=0.02, abs=0.02)
            assert (contact.passed_s is None) == (passed is None) or abs(impulse - 1.0) < 0.05
            noticed += contact.verdict == "noticed"
            if contact.verdict == "noticed":
                assert round(1e3 * float(contact.detection_s or 0.0)) in expected["detections"]
                assert contact.delay_ms == pytest.approx(1e3 * (contact.detection_s - contact.start_s))
    assert noticed >= 5


def test_hits_at_rest_are_noticed(records: list[dict[str, Any]]) -> None:
    # Coarse: what the first detector already does on robots that are not its model.
    found = table.find(next(row for row in table.ROWS if row.name == "at rest, free"), table.read(records))
    assert found.hits >= 2
    assert found.missed == 0
    assert found.delay_median_ms is not None
    assert found.delay_median_ms[0] < 200.0


def test_the_table_has_rows_intervals_and_worst_cases(records: list[dict[str, Any]], tmp_path: Path) -> None:
    text, data = table.write(tmp_path, "A title", ["A note."], records)
    document = json.loads(data.read_text(encoding="utf-8"))
    assert document["not judged"] == []
    rows = {row["name"]: row for row in document["tables"]["planar"]}
    assert rows["all hits"]["runs"] == 11
    assert "| at rest, pulled |" in text.read_text(encoding="utf-8")
    targets = {
        line[:2]: line[2:]
        for line in table.target_rows("planar", [table.find(row, table.read(records)) for row in table.ROWS])
    }
    missed = rows["all hits"]["missed"]
    low, high = count_interval(missed, rows["all hits"]["hits"])
    ends = f"{low * rows['all hits']['hits']:.3g} to {high * rows['all hits']['hits']:.3g}"
    assert targets["all hits", "missed"] == ("0", str(missed), ends, "missed" if missed else "met")
    assert targets["moment in motion", "missed"][1:] == ("no hits", "-", "-")
    assert targets["at rest, 0.5 m/s, none", "delay 95 %, ms"][1] != "0"
    assert document["targets"]["planar"] == [[*names, *said] for names, said in targets.items()]
    assert table.target_rows("single rollers", []) == []
    assert list(document["worst"]) == ["planar"]
    assert all(number in NUMBERS for values in document["worst"]["planar"].values() for number, _ in values)


def test_every_line_asked_for_has_its_row_in_each_table() -> None:
    rows = {row.name for row in table.ROWS}
    asked = {
        ("missed", "all hits"): (0.0, 0.0),
        ("false detections per 10,000 runs", "all hits"): (10.0, 10.0),
        ("towards", "all hits"): (0.0, 0.0),
        ("missed", "second hit, 0.5 m/s"): (0.0, 0.0),
        ("delay longest, ms", "slow push in motion"): (500.0, 500.0),
        ("direction 95 %, deg", "all hits"): (15.0, 15.0),
        ("direction 30 ms later, deg", "all hits"): (5.0, 5.0),
        ("place 30 ms later mean, mm", "all hits"): (20.0, 20.0),
        ("place 30 ms later 95 %, mm", "all hits"): (50.0, 50.0),
    }
    for figure, share in (("delay median, ms", 0), ("delay 95 %, ms", 1)):
        for bumper in ("none", "spring", "magnetic"):
            asked[figure, f"at rest, 0.5 m/s, {bumper}"] = ((10.0, 12.0)[share], (5.0, 6.0)[share])
        for row in ("in motion, 0.5 m/s", "second hit, 0.5 m/s"):
            asked[figure, row] = ((20.0, 25.0)[share], (8.0, 10.0)[share])
    assert set(table.TARGETS) == {"planar", "tipping", "planar, IMU", "tipping, IMU"}
    for group, targets in table.TARGETS.items():
        assert {target.row for target in targets} <= rows
        most = {(target.what, target.row): target.most for target in targets}
        for place, values in asked.items():
            assert most[place] == values["IMU" in group]
        assert (("runs with a late lift", "all hits") in most) == group.startswith("tipping")


def test_a_robot_with_an_imu_is_the_same_robot_and_feels_sooner(records: list[dict[str, Any]]) -> None:
    without, own = robot(DRAW, ROBOT), robot(DRAW, ROBOT, imu=True)
    assert without.testbed.items() <= own.testbed.items()
    assert set(own.testbed) - set(without.testbed) == {
        "imu.present",
        *(name for quantity in IMU for name in quantity.parameters),
    }
    assert (own.table, without.table) == ("planar, IMU", "planar")
    one, plain = hit(DRAW, NUMBERS[0], imu=True), hit(DRAW, NUMBERS[0])
    assert one.scenario.plan == plain.scenario.plan
    assert one.scenario.controller["imu.use"] == 1
    found = compute(DRAW, {}, NUMBERS[:1], 1, lambda _done: None, imu=True)[0]
    assert found["group"] == "planar, IMU"
    assert found["judged"] != records[0]["judged"]


def test_towards_and_false_are_seen(records: list[dict[str, Any]]) -> None:
    """A run with its traces changed: a reaction against the push, and a detection long after it."""
    one = hit(DRAW, NUMBERS[0])
    many = batch.Prepared([one.scenario], traces=RECORDED).run(method="fixed-step")
    time_s, traces = many["time"].values, {name: many[name].values[0].copy() for name in RECORDED}
    before = judge(time_s, traces, limits_of(one))
    row = round(1e3 * before.detections_s[0])
    after = slice(row + 1, row + 200)
    traces["controller.mode"][after] = 2
    impulse = [float(traces[f"testbed.truth.contact_impulse_{axis}"][row]) for axis in "xy"]
    for axis, share in zip("xy", impulse, strict=True):
        traces[f"controller.reference.v{axis}"][after] = -0.1 * share / math.hypot(*impulse)
    assert judge(time_s, traces, limits_of(one)).towards_s[:1] == before.detections_s[:1]
    traces["controller.detection.count"][-5:] += 1
    force = traces["testbed.truth.contact_force"]
    force[-300:] = 0.0
    assert judge(time_s, traces, limits_of(one)).false_s[-1] == pytest.approx(time_s[-5])


def test_limits_are_those_of_the_controller() -> None:
    """Towards: allowed is what the controller's own limits leave, here in numbers that it has."""
    assert limits({"admittance.acceleration_limit": 2.0, "admittance.tip_height": 0.0}, 0.24).acceleration_mps2 == 2.0
    # Half of the wheels' distance less the offset, over the height, times gravity (known to 1e-3); half of it.
    own = {"admittance.tip_height": 0.4, "admittance.tip_slope": 0.0, "admittance.tip_share": 0.5}
    assert limits(own, 0.24).acceleration_mps2 == pytest.approx(0.5 * 9.81 * (0.12 - 0.03) / 0.4, rel=1e-3)
    assert limits({"admittance.kind": 2, "admittance.smoothing": 0.03}, 0.24).late_s == pytest.approx(0.06)
    assert limits({"admittance.kind": 0, "admittance.smoothing": 0.03}, 0.24).late_s == 0.0


def test_wheels_that_lift_are_seen_and_excused_by_the_blocked_run() -> None:
    def judged(start_s: float, end_s: float) -> Judged:
        return Judged((Contact(start_s, end_s, 5.0, start_s, "noticed", 1),), (), (), ())

    def loads(*lifted: tuple[int, int, int]) -> dict[str, Any]:
        found = {name: np.full(1000, 100.0) for name in lifts.RECORDED}
        for wheel, first, last in lifted:
            found[lifts.RECORDED[wheel]][first:last] = 0.0
        return found

    nothing = {"late_s": 0.0, "late_blocked_s": 0.0, "caused": 0}
    own, longer = judged(0.2, 0.3), judged(0.2, 0.5)

    def found(mine: Any, blocked: Any) -> dict[str, float]:
        return lifts.lifts(1e-3, mine, own, blocked, longer)

    assert found(loads(), loads()) == nothing
    assert found(loads((0, 100, 150), (1, 310, 390)), loads()) == nothing  # before, and until 0.1 s after
    assert found(loads((1, 390, 450)), loads())["late_s"] == pytest.approx(
        0.050, abs=1.5e-3
    )  # from 401 on, a row either way
    assert found(loads((1, 250, 260)), loads())["caused"] == 1
    assert found(loads((1, 250, 260), (2, 250, 260)), loads((1, 480, 490)))["caused"] == 1
    assert found(loads(), loads((0, 590, 650)))["late_blocked_s"] == pytest.approx(0.050, abs=1.5e-3)


def test_a_run_that_can_tip_is_judged_beside_the_blocked_one() -> None:
    (run,) = compute(DRAW, {}, [PER_ROBOT], 1, lambda _done: None)
    assert run["group"] == "tipping"
    assert set(run["lifts"]) == {"late_s", "late_blocked_s", "caused"}
    (blind,) = compute(DRAW, NO_REFLEX, [PER_ROBOT], 1, lambda _done: None)
    assert blind["lifts"]["caused"] == 0
    assert blind["lifts"]["late_s"] == blind["lifts"]["late_blocked_s"] == run["lifts"]["late_blocked_s"]


def test_a_missed_hit_counts_as_infinite(records: list[dict[str, Any]]) -> None:
    blind = compute(DRAW, NO_REFLEX, NUMBERS[:2], 2, lambda _done: None)
    found = table.find(table.ROWS[0], table.read(blind))
    assert (found.missed, found.hits) == (2, 2)
    assert found.delay_median_ms is not None
    assert math.isinf(found.delay_median_ms[0])
    assert found.direction_p95_deg is None


def test_plans_are_smooth_and_end_where_they_should() -> None:
    legs = (
        Leg(0.3, 0.3, 0.5, 1.0, direction_rad=0.4, curvature_pm=-1.6, turning=True),
        Leg(4.0, 0.2, 0.4, 0.5, direction_rad=2.0),
        Leg(8.0, 0.5, 1.0, 1.0, curvature_pm=-1.0, on_the_spot=True),
    )
    time_s = np.arange(0.0, 12.0, 1e-3)
    plan = Drive(legs, 0.7)(time_s)
    # Central differences of 1 ms: the third derivative, at most a (pi / ramp)^2 times h^2 / 6.
    for derivative in (0, 3):
        by_difference = np.gradient(plan[:, derivative : derivative + 3], time_s, axis=0)[1:-1]
        assert np.abs(by_difference - plan[1:-1, derivative + 3 : derivative + 6]).max() < 5e-3
    travelled = np.hypot(*(np.diff(plan[:, :2], axis=0).T)).sum()
    assert travelled == pytest.approx(sum(leg.speed_mps * (leg.ramp_s + leg.cruise_s) for leg in legs[:2]), rel=1e-5)
    assert np.abs(plan[-1, 3:]).max() == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(GivewayError, match="one leg after the other"):
        Drive((legs[1], legs[0]))


def test_a_blow_gives_back_its_momentum() -> None:
    time_s = np.arange(0.0, 3.0, 1e-4)
    for bumper, share in (("none", 1e-3), ("spring", 0.05), ("magnetic", 0.15)):
        pushed = Blow(bumper, 10.0, 0.5, 0.3, (0.1, 0.2), 0.5)(time_s)
        reduced = 10.0 * 34.7 / 44.7
        impulse = np.hypot(*pushed[:, :2].T).sum() * 1e-4
        # Elastic: twice the momentum of the reduced mass; onset and latch are not part of the spring's motion.
        assert impulse == pytest.approx(2.0 * reduced * 0.5, rel=share)
        assert pushed[time_s < 0.5].max() == 0.0


def test_intervals_against_tables() -> None:
    # Clopper and Pearson: 0 and 5 of 10, from any table of exact binomial limits.
    assert count_interval(0, 10) == pytest.approx((0.0, 0.3085), abs=1e-4)
    assert count_interval(5, 10) == pytest.approx((0.1871, 0.8129), abs=1e-4)
    # No event: the rule of three, -ln 0.05.
    assert rate_upper_bound(0, 300.0) == pytest.approx(-math.log(0.05) / 300.0)
    # Median of 10: the classic interval is from the 2nd to the 9th value.
    assert percentile([float(value) for value in range(1, 11)], 0.5) == (5.0, 2.0, 9.0)
    assert percentile([1.0, math.inf], 0.95) == (math.inf, 1.0, math.inf)
    centre, low, high = mean([1.0, 3.0]) or (0.0, 0.0, 0.0)
    assert (centre, high - centre) == (2.0, pytest.approx(1.96 / math.sqrt(2.0), rel=1e-3))
    assert low + high == pytest.approx(4.0)


def test_the_controller_is_as_asked_and_the_robot_is_not() -> None:
    one, default = hit(DRAW, 5, {"detector.impulse_threshold": 2.0}), hit(DRAW, 5)
    assert one.scenario.controller == {"detector.impulse_threshold": 2.0}
    assert default.scenario.controller == {}
    assert one.scenario.testbed == default.scenario.testbed


def test_free_motion_has_the_same_bits_alone_and_its_alarms_are_counted() -> None:
    numbers = [0, 1, endurance.SHARED]
    paper = preset_values("paper")
    many = endurance.compute(DRAW, "planar", paper, numbers, 2, lambda _done: None)
    assert endurance.compute(DRAW, "planar", paper, numbers[2:], 1, lambda _done: None) == many[2:]
    # Of robots with other friction than their file's the paper's detector makes many.
    found = endurance.rates(many)
    assert found["false alarms"] == sum(record["detections"] for record in many) > 0
    assert found["hours"] == pytest.approx(3.0 * endurance.RUN_S / 3600.0)
    quiet = endurance.rates(endurance.compute(DRAW, "planar", NO_REFLEX, numbers[:1], 1, lambda _done: None))
    assert (quiet["false alarms"], quiet["runs with one"], quiet["worst"]) == (0, 0, [])
    assert quiet["per hour, upper 95 % bound"] == pytest.approx(-math.log(0.05) * 3600.0 / endurance.RUN_S)


def test_free_motion_goes_everywhere_within_the_limits() -> None:
    directions, stops = [], 0
    time_s = np.arange(0.0, endurance.RUN_S, 0.01)
    for number in range(40):
        _, scenario = endurance.drive(DRAW, "planar", endurance.SHARED * number, {})
        plan = scenario.plan(time_s)
        speed, acceleration = np.hypot(*plan[:, 3:5].T), np.hypot(*plan[:, 6:8].T)
        # The controller's limits: 0.5 m/s, 1.5 m/s2, 1.5 rad/s, 6 rad/s2.
        assert speed.max() < 0.5
        assert acceleration.max() < 1.5
        assert np.abs(plan[:, 5]).max() < 1.5
        assert np.abs(plan[:, 8]).max() < 6.0
        base = np.arctan2(plan[:, 4], plan[:, 3]) - plan[:, 2]
        directions += np.remainder(base[speed > 0.04], 2.0 * math.pi).tolist()
        stops += int((np.diff((speed > 0.0).astype(int)) < 0).sum())
    share = np.histogram(directions, bins=24, range=(0.0, 2.0 * math.pi))[0]
    assert share.min() > 0  # every 15 degrees of travel in the base frame
    assert stops > 40


def test_work_goes_on_where_it_was_interrupted(tmp_path: Path) -> None:
    asked: list[int] = []
    stop_at = [4]

    def compute_some(numbers: Any, _threads: int, _progress: Any) -> list[dict[str, Any]]:
        if numbers[0] >= stop_at[0]:
            raise Interrupted
        asked.extend(numbers)
        return [{"number": number} for number in numbers]

    work = Work("work", {"draw": DRAW}, 7, 2, compute_some, ("parts.py",))
    first = go_on(work, tmp_path / "work", 1, lambda _progress: None)
    assert (first.interrupted, first.ran, asked) == (True, 4, [0, 1, 2, 3])
    stop_at[0] = 100
    second = go_on(work, tmp_path / "work", 1, lambda _progress: None)
    assert (second.interrupted, second.ran, asked) == (False, 3, [*range(7)])
    assert [record["number"] for record in second.records] == [*range(7)]
    manifest = json.loads((tmp_path / "work" / "manifest.json").read_text(encoding="utf-8"))
    assert (manifest["kind"], manifest["complete"]) == ("giveway crowd", True)
    other = Work("work", {"draw": "judging"}, 7, 2, compute_some, ("parts.py",))
    assert len(go_on(other, tmp_path / "work", 1, lambda _progress: None).records) == 7
    assert len(asked) == 14  # what was asked for is another thing: nothing is taken over


def test_one_plant_alone_has_the_same_numbers() -> None:
    work = crowd(DRAW, 12, {}, group="tipping")
    assert work.count == 3 * PER_ROBOT  # robots 1, 4 and 11
    alone = work.compute([PER_ROBOT + 8], 1, lambda _done: None)
    assert alone == compute(DRAW, {}, [4 * PER_ROBOT + 8], 1, lambda _done: None)
    assert alone[0]["group"] == "tipping"


def test_hits_of_some_situations_alone_have_the_same_numbers(records: list[dict[str, Any]]) -> None:
    work = crowd(DRAW, ROBOT + 1, {}, group="planar", situations=("stopping", "reacting"))
    assert work.count == 2 * sum(group_of(number) == "planar" for number in range(ROBOT + 1))
    assert work.compute([work.count - 2], 1, lambda _done: None) == records[8:9]
    whole = crowd(DRAW, ROBOT + 1, {}, group="planar")
    assert (whole.count, work.asked != whole.asked) == (work.count // 2 * PER_ROBOT, True)


def test_robots_may_be_alike_in_a_parameter_and_are_hit_as_before() -> None:
    same = {"electronics.encoder_counts": 85000, "floor.slope": 0.0}
    drawn, alike = hit(DRAW, NUMBERS[0]).scenario, hit(DRAW, NUMBERS[0], same=same).scenario
    assert drawn.testbed["floor.slope"] != 0.0
    assert (dict(alike.testbed), alike.contact, alike.plan) == ({**drawn.testbed, **same}, drawn.contact, drawn.plan)
    asked = crowd(DRAW, 1, {}, same=same).asked
    assert asked["same"] == same  # another work than that of the robots as drawn
    assert "same" not in crowd(DRAW, 1, {}).asked
    for name in ("slider.mass", "contact.height", "imu.present"):
        with pytest.raises(GivewayError, match=f"testbed.{name}"):
            hit(DRAW, NUMBERS[0], same={name: 1})


def test_nothing_starts_inside_a_robot() -> None:
    """The first draw of this leg stands 1 mm inside the robot, which starts beside it and comes round to it."""
    one = hit("judging", 7674, imu=True)
    assert (one.situation, one.kind) == ("motion", "clamped")
    ran = batch.Prepared([one.scenario]).run(method="fixed-step")
    assert ran["status"].values.tolist() == ["ok"]


def test_a_refused_run_is_not_one_that_tipped_over() -> None:
    ended = [("ok", {"contacts": []}), ("failed", {"contacts": []}), ("failed", None), ("refused", None)]
    failed, over = ended_early([{"status": status, "judged": judged} for status, judged in ended])
    assert ([one["status"] for one in failed], over) == (["failed", "refused"], 1)


def test_a_calibrated_controller_believes_what_was_found_for_its_own_robot(records: list[dict[str, Any]]) -> None:
    own = {ROBOT: NO_REFLEX, ROBOT + 1: {}}
    blind = compute(DRAW, {}, NUMBERS[:1], 1, lambda _done: None, own)
    assert Judged.of(blind[0]["judged"]).detections_s == ()
    other = compute(DRAW, {}, NUMBERS[:1], 1, lambda _done: None, {ROBOT + 1: NO_REFLEX})
    assert other == records[:1]
    asked = compute(DRAW, {"detector.impulse_threshold": 2.0}, NUMBERS[:1], 1, lambda _done: None, own)
    assert Judged.of(asked[0]["judged"]).detections_s  # what is asked for goes before what was found


def test_robots_of_another_file_are_calibrated_on_arcs_of_their_own() -> None:
    """The identification finds the rollers of the robot that was drawn, not those of its file."""
    file = native.robots()["delivery"]
    (found,) = calibrated.compute(DRAW, [ROBOT], 1, lambda _done: None, file)
    assert found["message"] == ""
    own = robot(DRAW, ROBOT, file=file).testbed
    scales = [float(own[f"roller.friction_scale[{wheel}]"]) for wheel in range(3)]
    true = float(own["roller.coulomb_torque"]) * np.mean(scales)
    # 5 % are left by the sensors' gains, by a mass that the fit believes, and by wheels of which not all move alike.
    assert found["controller"]["friction.coulomb_torque"] == pytest.approx(true, rel=0.1)
    assert start_value("roller.coulomb_torque", robot=file) > 1.2 * true  # what the controller believed before
    usual, whose = (calibrated.calibrations(DRAW, 1, one) for one in (None, file))
    assert usual.asked != whose.asked  # what is stored of one is not taken for the other


def test_the_command_writes_tables_and_refuses_what_it_cannot_do(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "crowd"
    assert cli_main(["crowd", "--robots", "1", "--out", str(out)]) == 0
    printed = capsys.readouterr()
    assert printed.out.count(f"{PER_ROBOT} runs in") == 2  # without and with an IMU
    assert list(json.loads((out / "table.json").read_text(encoding="utf-8"))["tables"]) == [
        "single rollers",
        "single rollers, IMU",
    ]
    assert json.loads((out / "table.json").read_text(encoding="utf-8"))["not judged"] == []
    assert cli_main(["crowd", "--robots", "1", "--out", str(out)]) == 0  # everything is there
    assert "runs in" not in capsys.readouterr().out
    for wrong, said in (
        (["--draw", "both"], "both"),
        (["--robots", "0"], "--robots"),
        (["--threads", "0"], "--threads"),
        (["--group", "floating"], "floating"),
        (["--set", "testbed.slider.mass=4"], "testbed.slider.mass"),
        (["--set", "testbed.base.tipping=1"], "testbed.base.tipping"),
        (["--set", "testbed.base.mass=40", "--calibrated"], "--calibrated"),
        (["--situation", "asleep"], "asleep"),
        (["endurance", "--set", "testbed.base.mass=40"], "testbed.base.mass"),
        (["--set", "controller.no=1"], "no"),
        (["--only", "-1"], "--only"),
        (["endurance", "--group", "floating"], "floating"),
        (["endurance", "--hours", "0"], "--hours"),
    ):
        assert (
            cli_main(
                ["crowd", *wrong, "--out", str(tmp_path / "other")] if wrong[0] != "endurance" else ["crowd", *wrong]
            )
            == 2
        )
        assert said in capsys.readouterr().err
    assert not (tmp_path / "other").exists()


def test_the_robots_of_another_file_differ_from_its_numbers(tmp_path: Path) -> None:
    file = native.robots()["delivery"]
    mine, trikeys = robot(DRAW, ROBOT, file=file), robot(DRAW, ROBOT)
    assert mine.testbed["base.mass"] / 60.0 == pytest.approx(trikeys.testbed["base.mass"] / 34.7)
    assert mine.testbed["electronics.torque_gain[0]"] == trikeys.testbed["electronics.torque_gain[0]"]
    offset = "electronics.torque_offset[0]"  # in proportion to the sensor's range
    assert mine.testbed[offset] == pytest.approx(trikeys.testbed[offset] * 30.0 / 28.0)
    one = hit(DRAW, NUMBERS[0], file=file)
    assert one.scenario.robot == file
    assert one.scenario.parameters("testbed")["imu.present"] is False
    assert one.scenario.parameters("controller")["imu.use"] == 0
    with_imu = hit(DRAW, NUMBERS[0], file=file, imu=True).scenario
    assert with_imu.parameters("testbed")["imu.present"] is True
    assert with_imu.parameters("controller")["imu.use"] == 1
    records = compute(DRAW, {}, NUMBERS[:4], 2, lambda _done: None, robot=file)
    assert all(record["status"] == "ok" for record in records)
    assert all(contact["verdict"] == "noticed" for record in records for contact in record["judged"]["contacts"][:1])
    _, driven = endurance.drive(DRAW, "planar", 0, {}, robot=file)
    assert (driven.robot, driven.parameters("controller")["base.mass"]) == (file, 60.0)


def test_a_light_and_slow_robot_is_hit_and_driven_accordingly(tmp_path: Path) -> None:
    file = tmp_path / "light.toml"
    text = native.robot().read_text(encoding="utf-8").replace("value = 34.7", "value = 3.47")
    speed = text.index("[admittance.speed_limit]")
    file.write_text(text[:speed] + text[speed:].replace("value = 0.5", "value = 0.2", 1), encoding="utf-8")
    for number in NUMBERS[:8]:
        light, heavy = hit(DRAW, number, file=file), hit(DRAW, number)
        assert light.mass_kg == pytest.approx(0.1 * heavy.mass_kg)
        assert batch.Prepared([light.scenario])  # the plan is within the limits
    moving = [hit(DRAW, number, file=file).scenario.plan for number in NUMBERS[3:8]]
    assert all(leg.speed_mps <= 0.1601 for plan in moving if isinstance(plan, Drive) for leg in plan.legs)


def test_the_command_names_what_a_robot_file_lacks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "bare.toml"
    text = native.robot().read_text(encoding="utf-8")
    file.write_text(text[: text.index("# --- Accelerometer")] + text[text.index("# --- Body outline") :])
    for arguments, words in (
        (("crowd", "--robot", str(file), "--imu"), "--imu: "),
        (("crowd", "endurance", "--robot", str(file), "--imu"), "--imu: "),
        (("crowd", "--robot", "robotino", "--calibrated"), "torque sensors: by motor current the gears' friction"),
    ):
        assert cli_main(list(arguments)) == 2
        error = capsys.readouterr().err
        assert words in error
        assert len(error.splitlines()) == 1
