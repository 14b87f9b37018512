"""What a robot can feel: places on the outline, the search against single runs and the linear estimate, the command."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest
from cosim_helpers import Cli, folder_content
from figure_labels import check_planted, in_si, keeping, same, unit_in
from giveway.base.errors import GivewayError
from giveway.detectability import causes, figure, found, probes, record, search
from giveway.detectability.alarms import Alarms, alarms
from giveway.detectability.causes import CAUSES, THRESHOLDS, raised
from giveway.detectability.found import Asked, Detectability, detect
from giveway.detectability.probes import IMPULSE, MOTION, PUSH, REST, Drive, places, scenario
from giveway.detectability.robots import differing, subject
from giveway.detectability.search import noticed, smallest
from giveway.drivetrain.smallest_push import CONTROLLER, TESTBED, smallest_push_n
from giveway.robot.population import POPULATION
from giveway.robot.variables import table
from giveway.scenario.approach import outline_of
from giveway.scenario.plan import Pushes
from matplotlib.figure import Figure
from motor_current_robot import trikey_by_current

RESOLUTION = 10.0 ** (search.DECADES / 2**search.STEPS)


def test_a_force_enters_the_outline_on_its_line() -> None:
    whose = subject(None)
    outline = outline_of(whose.testbed)
    for probe in places(whose, 7):
        along = np.array([math.cos(probe.direction_rad), math.sin(probe.direction_rad)])
        left = np.array([-along[1], along[0]])
        reach = outline @ left
        share = probes.PLACES[probe.place]
        wanted = share * (reach.max() if share > 0.0 else -reach.min())
        assert np.dot(probe.point_m, left) == pytest.approx(wanted, abs=1e-12)
        # On the outline: inside of all sides and on one; and behind it the force is inside.
        sides = np.roll(outline, -1, axis=0) - outline
        inward = np.column_stack((-sides[:, 1], sides[:, 0])) / np.hypot(*sides.T)[:, None]
        depth = ((np.array(probe.point_m) - outline) * inward).sum(axis=1)
        assert depth.min() == pytest.approx(0.0, abs=1e-12)
        assert ((np.array(probe.point_m) + 1e-3 * along - outline) * inward).sum(axis=1).min() > 0.0
    assert places(whose, 4, ("middle",))[1].from_deg == 90.0


def test_robots_differ_within_the_population_of_their_own_file(tmp_path: Path) -> None:
    text = trikey_by_current(tmp_path, ("value = 34.7", "value = 20.0"))
    whose = subject(text, {"testbed": {"floor.slope": 0.0}, "controller": {}})
    robots = differing(whose, 30)
    assert robots[:3] == differing(whose, 3)
    masses = [robot["base.mass"] for robot in robots]
    assert 19.0 <= min(masses) < 20.0 < max(masses) <= 25.0
    assert {robot["floor.slope"] for robot in robots} == {0.0}
    gains = [robot[f"electronics.torque_gain[{i}]"] for robot in robots for i in range(3)]
    assert 0.9 <= min(gains) < 0.97 < 1.03 < max(gains) <= 1.1  # torque constants
    drawn = {name for quantity in POPULATION if quantity.only is None for name in quantity.parameters}
    assert set(robots[0]) == drawn


def test_pushes_and_impulses_are_of_their_size() -> None:
    whose = subject(None)
    (probe,) = places(whose, 1, ("middle",))
    for kind, size in ((PUSH, 7.0), (IMPULSE, 0.4)):
        made = scenario(whose, {}, 0, None, kind, probe, size, {})
        assert isinstance(made.push, Pushes)
        (push,) = made.push.pushes
        assert push.direction_rad == pytest.approx(-math.pi)
        assert (push.force_n if kind == PUSH else push.impulse_newton_s) == pytest.approx(size)
        assert push.start_s >= 0.8
        if kind == PUSH:  # held until the run ends
            assert push.end_s - push.ramp_s > made.duration_s


def test_what_is_found_is_what_single_runs_notice() -> None:
    """Of a robot in motion that differs from its file: half a step above it, and not a step and a half below."""
    whose = subject(None)
    robots, drives = differing(whose, 2), [Drive(0.2, 0.4), Drive(0.2, -2.0)]
    chosen = places(whose, 2, ("left",))
    result = smallest(whose, robots, drives, IMPULSE, chosen, {}, 2)
    assert (result.situation, result.kind, result.values.shape) == (MOTION, IMPULSE, (2, 2))
    assert not result.alarmed.any()
    for factor, seen in ((RESOLUTION**0.1, True), (RESOLUTION**-1.1, False)):
        runs = (
            scenario(whose, robots[i], i, drives[i], IMPULSE, chosen[j], factor * result.values[i, j], {})
            for i in range(2)
            for j in range(2)
        )
        assert noticed(runs, 2).tolist() == [seen] * 4


def test_at_rest_it_is_near_the_linear_estimate(monkeypatch: pytest.MonkeyPatch) -> None:
    """A robot that is its file: the estimate leaves out the noise, which helps, and the bristles, which take some."""
    whose = subject(None)
    (probe,) = places(whose, 1, ("middle",))
    estimate = smallest_push_n(
        {name: np.array([float(whose.controller[name])]) for name in CONTROLLER},
        {name: np.array([float(whose.testbed[name])]) for name in TESTBED},
    )[0]
    value = smallest(whose, [{}], None, PUSH, [probe], {}, 1).values[0, 0]
    assert 0.7 < value / estimate < 1.5


def test_without_torque_sensors_the_gears_keep_it_from_the_motor(tmp_path: Path) -> None:
    """At rest two thirds of a push along wheel 0's rolling are its, up to the stiction of 2.75 N m."""
    whose = subject(trikey_by_current(tmp_path), {"testbed": {f"electronics.torque_offset[{i}]": 0.0 for i in range(3)},
                                                  "controller": {}})  # fmt: skip
    across = [one for one in places(whose, 4, ("middle",)) if abs(math.sin(one.direction_rad)) > 0.5]
    value = smallest(whose, [{}], None, PUSH, across, {}, 2).values.min()
    assert value > 0.9 * 1.5 * 2.75 / 0.1016 / (1.0 + 1e-9) - 10.0  # the bristles and gears of the others take some
    felt = smallest(subject(None), [{}], None, PUSH, across, {}, 2).values.min()
    assert value > 5.0 * felt


def test_few_hours_cannot_show_a_low_rate() -> None:
    assert Asked(rate_per_hour=0.1).hours_needed == pytest.approx(-math.log(0.05) / 0.1)
    assert not Asked(rate_per_hour=0.1).can_show
    assert Asked().can_show


def test_a_rate_of_alarms_counts_until_the_first() -> None:
    assert Alarms(2.0, 240, 0).per_hour[:2] == (0.0, 0.0)
    assert Alarms(2.0, 240, 0).per_hour[2] == pytest.approx(-math.log(0.05) / 2.0)
    rate, low, high = Alarms(0.5, 60, 4).per_hour
    assert low < rate == 8.0 < high


def test_free_motion_alarms_a_robot_that_does_not_know_its_gears(tmp_path: Path) -> None:
    """Torque sensors do not feel the gears, a motor's current does."""
    hours = 4 * 30.0 / 3600.0
    stiff = {f"drivetrain.friction_scale[{wheel}]": 2.0 for wheel in range(3)}
    quiet = alarms(subject(None), [{**one, **stiff} for one in differing(subject(None), 2)], hours, {}, 2)
    assert (quiet.alarms, quiet.drives) == (0, 4)
    assert quiet.hours == pytest.approx(hours)
    whose = subject(trikey_by_current(tmp_path))
    loud = alarms(whose, [{**one, **stiff} for one in differing(whose, 2)], hours, {}, 2)
    assert (loud.alarms, loud.drives) == (4, 4)
    assert loud.hours < 0.2 * hours


def test_every_detector_has_thresholds_and_every_cause_its_parameters() -> None:
    whose = subject(None)
    variables = {model: table(model) for model in ("testbed", "controller")}
    assert all(name in variables["controller"] for names in THRESHOLDS.values() for name in names)
    for _, change in CAUSES.values():
        changed = change(whose)
        variables["testbed"].check_all(changed.testbed)
        variables["controller"].check_all(changed.controller)
    assert raised(whose, 3.0)["channels.fast_rest"] == 3.0 * float(whose.controller["channels.fast_rest"])
    assert raised(whose, 1e6)["channels.fast_rest"] == variables["controller"]["channels.fast_rest"].maximum


@pytest.fixture(scope="module")
def coarse(tmp_path_factory: pytest.TempPathFactory) -> Detectability:
    """Two robots by motor current, one side; a wish that raised thresholds can keep in this short time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(search, "STEPS", 2)
        patch.setattr(found, "CAUSE_DIRECTIONS", 1)
        patch.setattr(found, "FACTORS", (1.0, 48.0))
        path = trikey_by_current(tmp_path_factory.mktemp("robot"))
        return detect(subject(path), Asked(2, 1, 0.2, 0.01, 400.0), 2)


def test_the_figure_shows_the_pushes_in_their_unit(
    coarse: Detectability, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    curves = {
        (situation, kind): {
            place: [(90.0 * i, 2.0 + row + 3.0 * column + i) for i in range(4)] for place in probes.PLACES
        }
        for row, kind in enumerate((PUSH, IMPULSE))
        for column, situation in enumerate((REST, MOTION))
    }
    kept: list[Figure] = []
    monkeypatch.setattr(figure, "Figure", keeping(Figure, kept))
    monkeypatch.setattr(figure, "polar", lambda _found, _level, situation, kind: curves[situation, kind])
    figure.write_figure(tmp_path / "one.svg", coarse)

    def check() -> None:
        for axes, ((_, kind), wanted) in zip(kept[0].axes, curves.items(), strict=True):
            unit = unit_in(axes.get_title("left") or axes.get_title())
            assert unit is not None
            for line, points in zip(axes.lines, wanted.values(), strict=False):  # the outline comes after them
                closed = np.array([*points, points[0]])
                assert same(np.asarray(line.get_xdata()), np.radians(closed[:, 0]))
                try:
                    drawn = in_si(line.get_ydata(), unit, {PUSH: "N", IMPULSE: "N.s"}[kind])
                except GivewayError as error:
                    raise AssertionError(str(error)) from None
                assert same(drawn, closed[:, 1])

    check_planted(kept[0], check)


def test_it_says_what_the_gears_cost(coarse: Detectability) -> None:
    assert coarse.stated.smallest[MOTION, PUSH].alarmed.all()
    assert [row[5] for row in record.rows(coarse.stated)] == ["0 %", "0 %", "100 %", "100 %"]
    assert record.rows(coarse.stated)[2][1:4] == ("none",) * 3
    text = " ".join(record.remarks(coarse))
    assert "knows the gears' friction from the file while they turn" in text
    assert coarse.gearless is not None
    assert coarse.gearless.per_hour[0] < 0.1 * coarse.stated.alarms.per_hour[0]
    assert set(coarse.causes) == set(causes.CAUSES)


def test_the_record_is_whole(coarse: Detectability, tmp_path: Path) -> None:
    record.write_json(tmp_path / "table.json", coarse)
    document = json.loads((tmp_path / "table.json").read_text())
    assert document["sensing"] == "motor current"
    levels = document["levels"]
    assert levels[0]["threshold_factor"] == 1.0
    at_rest = levels[0]["smallest"][f"{PUSH} {REST}"]
    assert [probe["place"] for probe in at_rest["probes"]] == list(probes.PLACES)
    record.write_csv(tmp_path / "smallest.csv", coarse)
    rows = list(csv.DictReader((tmp_path / "smallest.csv").open()))
    assert len(rows) == len(levels) * 4 * 2 * 3
    assert {row["alarmed"] for row in rows if row["situation"] == MOTION and row["threshold_factor"] == "1.0"} == {"1"}


def test_the_command_writes_table_rows_and_figure(
    cli: Cli, tmp_path: Path, coarse: Detectability, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(found, "detect", lambda *_: coarse)
    done = cli("detectability", str(trikey_by_current(tmp_path)), "--out", "out")
    assert done.returncode == 0, done.stderr
    assert "push in motion" in done.stdout
    assert "a tenth of the gears' friction" in done.stdout
    assert folder_content(tmp_path) == [
        "by_current.toml", "out", "out/polar.png", "out/smallest.csv", "out/table.json",
    ]  # fmt: skip
    again = cli("detectability", "--out", "out")  # its own result may be replaced
    assert again.returncode == 0, again.stderr


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--robots", "0"), "--robots: 0 is not allowed; allowed: a whole number from 1 to 10000"),
        (("--speed", "0"), "--speed: 0.0 is not allowed"),
        (("--false-alarms", "0"), "--false-alarms: 0.0 is not allowed"),
        (("--hours", "inf"), "--hours: inf is not allowed"),
        (("--set", "testbed.base.tipping=true"), "testbed.base.tipping: True is not allowed"),
        (("missing.toml",), "missing.toml"),
    ],
)
def test_wrong_input_is_one_line(words: tuple[str, ...], told: str, cli: Cli, tmp_path: Path) -> None:
    done = cli("detectability", *words, "--out", "out")
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert told in done.stderr
    assert folder_content(tmp_path) == []


def test_a_light_robot_slides_far_without_its_rollers_friction(cli: Cli, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its bristles at 5 m/s were too fast for the fixed steps, which are chosen before a push is known."""
    monkeypatch.setattr(search, "STEPS", 2)
    monkeypatch.setattr(found, "CAUSE_DIRECTIONS", 1)
    sizes = ("--mass", "22 kg", "--wheel-radius", "3 in", "--wheel-distance", "220 mm", "--outline", "circle 0.45")
    assert cli("robot", "new", "mine.toml", *sizes, "--height", "0.4 m").returncode == 0
    few = ("--robots", "1", "--directions", "1", "--hours", "0.01")
    done = cli("detectability", "mine.toml", *few)
    assert done.returncode == 0, done.stderr
    assert "with a hundredth of the rollers' friction" in done.stdout
