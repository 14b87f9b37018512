"""Warnings: what happened otherwise than it was asked, and nothing else."""

from __future__ import annotations

import dataclasses
import functools
import json
import math
from pathlib import Path

import giveway
import numpy as np
import pytest
from cosim_helpers import Cli, short
from giveway import batch
from giveway.base.errors import GivewayError
from giveway.experiments.reproduction.findings import warning_notes
from giveway.report import render
from giveway.scenario.plan import Straight
from giveway.scenario.scenario_file import scenario_of
from giveway.scenario.stated_contact import StatedContact
from giveway.simulation.run_warnings import BOUNDS, CODES, METRICS, Stated, masks, warnings_of
from giveway.simulation.summary import summary, warning_lines
from numpy.typing import NDArray

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.toml"))
AS_ASKED = {
    "contact time": 0.5,
    "contact speed": 0.4,
    "first contact x": 88.0,
    "first contact y": 152.0,
    "robot speed at contact": 0.2,
    "distance from the plan": 0.01,
    "angle from the plan": 0.0,
    "sensed torque share": 0.4,
    "motor torque share": 0.8,
    "time in sensor fault": 0.0,
    "bottoming margin": 30.0,
    "lasting force": 12.0,
    "contact at end": 1.0,
    "longest contact": 1.3,
    "peak force of the first contact": 90.0,
    "peak force of the run": 90.0,
}
STATED = StatedContact(0.4, (0.088, 0.152), 0.5)
SCENARIO = giveway.Scenario(
    "stated",
    2.0,
    testbed={"slider.present": True},
    plan=Straight(0.2, acceleration_mps2=None),
    judge_as="lower leg",
    contact=STATED,
)
# What is otherwise; just inside its bound and just beyond.
OTHERWISE: dict[str, tuple[str, float, float]] = {
    "no contact": ("contact time", 0.5, math.nan),
    "contact speed": ("contact speed", 0.4 * 0.981, 0.4 * 0.979),
    "contact place": ("first contact x", 97.9, 98.1),
    "contact time": ("contact time", 0.519, 0.521),
    "robot speed": ("robot speed at contact", 0.2039, 0.2041),
    "plan not followed": ("distance from the plan", 9.9, 10.1),
    "torque sensor saturated": ("sensed torque share", 0.999, 1.0),
    "motor saturated": ("motor torque share", 0.999, float(np.float32(20.0 * (1.0 - 1e-8))) / 20.0),
    "sensor fault": ("time in sensor fault", 0.0, 0.001),
    "bumper bottomed": ("bottoming margin", 0.1, -0.1),
    "lasting force unknown": ("lasting force", 0.0, math.nan),
    "contact cut off": ("lasting force", 89.9, 90.0),
    "second hit harder": ("peak force of the run", 90.0, 90.1),
}


def found(scenario: giveway.Scenario = SCENARIO, **changes: float) -> list[str]:
    numbers = {name: np.array([value]) for name, value in (AS_ASKED | changes).items()}
    return [code for code, mask in masks(Stated.of([scenario]), numbers).items() if mask[0]]


def test_every_warning_is_in_the_table() -> None:
    assert set(OTHERWISE) == set(CODES)
    assert set(AS_ASKED) == set(METRICS)
    # The bounds: 2 %, 10 mm, 20 ms.
    assert (BOUNDS["speed"], BOUNDS["place_mm"], BOUNDS["time_s"]) == (0.02, 10.0, 0.02)


@pytest.mark.parametrize(("code", "case"), OTHERWISE.items(), ids=OTHERWISE)
def test_each_warning_begins_at_its_bound(code: str, case: tuple[str, float, float]) -> None:
    name, inside, beyond = case
    assert found() == []
    assert found(**{name: inside}) == []
    released = {"contact at end": 0.0} if code == "lasting force unknown" else {}  # a contact may be cut off, too
    assert found(**{name: beyond}, **released) == [code]


def test_a_contact_is_cut_off_while_its_force_may_grow() -> None:
    assert found(**{"lasting force": math.nan}) == ["lasting force unknown", "contact cut off"]
    for longest_s, codes in ((1.39, []), (1.41, ["contact cut off"])):  # of 1.5 s from the contact to the end
        assert found(**{"lasting force": 90.0, "contact at end": 0.0, "longest contact": longest_s}) == codes


def test_a_heading_that_falls_behind_is_one_too() -> None:
    assert found(**{"angle from the plan": 1.1}) == ["plan not followed"]


def test_what_was_not_stated_is_not_compared() -> None:
    nothing = dataclasses.replace(SCENARIO, contact=None, judge_as=None)
    far = {"contact time": 1.9, "contact speed": 3.0, "first contact x": 900.0, "robot speed at contact": 3.0}
    soft = {"lasting force": math.nan, "contact at end": 0.0, "longest contact": math.nan}
    assert found(nothing, **far, **soft) == []
    assert found(nothing, **{"contact time": math.nan}) == []
    only_speed = dataclasses.replace(SCENARIO, contact=StatedContact(0.4))
    assert found(only_speed, **far) == ["contact speed", "robot speed"]


def too_fast(time_s: NDArray[np.float64]) -> NDArray[np.float64]:
    """0.8 m/s where 0.5 m/s is the limit."""
    rows = np.zeros((len(time_s), 9))
    rows[:, 0], rows[:, 3] = 0.8 * time_s, 0.8
    return rows


longer = functools.partial(short, duration_s=1.0)  # until the contact is over
# A run, the codes that it has, and words of the first line.
RUNS: dict[str, tuple[giveway.Scenario, list[str], str]] = {
    "motionless": (longer(), [], ""),
    "over before its contact": (short(), ["contact cut off"], "the run ended during the contact"),
    "motionless, pulled over a longer distance": (
        longer("none", testbed={"slider.present": True, "slider.run_up": 0.06}),
        ["contact speed"],
        "asked for 0.5 m/s",
    ),
    "nothing to hit": (short(testbed={"slider.present": False}), ["no contact"], "did not touch"),
    # The paper's reflex: the default one is so soon that the second hit is the weaker one.
    "hit twice": (longer("none", preset="paper"), ["second hit harder"], "203 N after 187 N"),
    "a plan beyond the limits": (
        short(plan=too_fast, testbed={"slider.present": False}, contact=None),
        ["plan not followed"],
        "limits of controller.reference",
    ),
    "sensor at its end": (
        longer("none", testbed={"electronics.torque_range": 3.0}),
        ["torque sensor saturated"],
        "torque sensor",
    ),
    "motor at its end": (
        longer(testbed={"drivetrain.torque_limit": 5.0}, preset="paper"),
        ["motor saturated"],
        "largest torque",
    ),
    "pressed into its stop": (longer("spring", testbed={"bumper.travel": 0.01}), ["bumper bottomed"], "mm beyond"),
    "too short to judge": (
        short(judge_as="lower leg"),
        ["lasting force unknown", "contact cut off"],
        "0.5 s after the contact",
    ),
}


@pytest.mark.parametrize(("scenario", "codes", "words"), RUNS.values(), ids=RUNS)
def test_runs_have_the_warnings_that_are_theirs(scenario: giveway.Scenario, codes: list[str], words: str) -> None:
    result = batch.run(scenario)
    assert [warning.code for warning in result.warnings] == codes
    assert words in (result.warnings[0].text if result.warnings else "")


# The others collide with what these state.
@pytest.mark.parametrize("name", ["motionless", "moving", "clamping"])
def test_every_experiment_does_what_it_asks_for(name: str) -> None:
    scenario = giveway.experiment(name).scenario("magnetic")
    assert scenario.contact is not None
    assert batch.run(dataclasses.replace(scenario, duration_s=min(scenario.duration_s, 3.0))).warnings == ()


@pytest.mark.parametrize("name", ["bicycle", "hand", "person"])
def test_every_scene_is_met_as_it_says(name: str) -> None:
    from giveway.experiments.scenes import scenario

    scene = scenario(name)
    assert scene.contact is not None
    assert batch.run(dataclasses.replace(scene, duration_s=3.0)).warnings == ()


def test_a_reproduction_notes_them() -> None:
    assert warning_notes({"no bumper": batch.run(RUNS["hit twice"][0])}) == [
        "no bumper: a later contact was harder than the first: 203 N after 187 N."
    ]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_every_example_does_what_it_asks_for(path: Path) -> None:
    assert batch.run(giveway.read_scenario(path)).warnings == ()


TROLLEY = {
    "schema_version": 1,
    "duration": 1.0,
    "collision": {"mass": 12.0, "speed": 0.4, "edge": 0, "offset": 0.05, "time": 0.6},
}


def trolley(**changes: object) -> giveway.Scenario:
    scenario = scenario_of(TROLLEY, Path("case.toml"))
    return dataclasses.replace(scenario, testbed={**scenario.testbed, **changes})


def test_a_file_states_its_contact() -> None:
    contact = trolley().contact
    assert contact is not None
    assert (contact.speed_mps, contact.time_s) == (pytest.approx(0.4), 0.6)
    assert contact.point_m == pytest.approx((0.0447, 0.1775), abs=1e-3)
    assert batch.run(trolley()).warnings == ()


@pytest.mark.parametrize(
    ("changes", "codes"),
    [
        ({"slider.speed": 0.38}, ["contact speed", "contact time"]),
        ({"slider.target_x": 0.0747}, ["contact place", "contact time"]),
        ({"slider.friction": 20.0}, ["no contact"]),
    ],
)
def test_a_change_that_spoils_the_contact_is_told(changes: dict[str, float], codes: list[str]) -> None:
    assert [warning.code for warning in batch.run(trolley(**changes)).warnings] == codes


def test_a_robot_that_still_speeds_up_is_told() -> None:
    document = {
        "schema_version": 1,
        "duration": 1.0,
        "plan": {"kind": "straight", "speed": 0.4, "direction": 60.0},
        "collision": {"mass": 12.0, "speed": 0.2, "edge": 0, "time": 0.6},
    }
    lags, slow = batch.run(scenario_of(document, Path("case.toml"))).warnings
    assert (lags.code, slow.code) == ("contact speed", "robot speed")
    assert "its plan asks for 0.4 m/s" in slow.text


@pytest.mark.parametrize(
    ("collision", "field", "allowed"),
    [
        ({"time": 0.15}, "collision.time", "before the end of the run at 0.15 s"),
        ({"rope": True}, "duration", "above 0.156 s, when the weight has pulled the slider to the robot"),
    ],
)
def test_a_contact_after_the_end_is_refused(collision: dict[str, object], field: str, allowed: str) -> None:
    document = {**TROLLEY, "duration": 0.15, "collision": {"speed": 0.5, "edge": 0, **collision}}
    with pytest.raises(GivewayError) as caught:
        scenario_of(document, Path("case.toml"))
    assert caught.value.field == field
    assert allowed in caught.value.allowed


def test_a_push_after_the_end_is_refused() -> None:
    push = {"force": 30.0, "direction": 0.0, "point": [0.1, 0.0], "start": 2.0, "duration": 0.5}
    with pytest.raises(GivewayError) as caught:
        scenario_of({"schema_version": 1, "duration": 2.0, "push": [push]}, Path("case.toml"))
    assert caught.value.field == "push[0].start"
    assert "before the end of the run at 2 s" in caught.value.allowed


def test_a_batch_has_the_codes() -> None:
    cases = [scenario for scenario, _, _ in RUNS.values()] + [trolley(**{"slider.speed": 0.38})]
    expected = ["; ".join(codes) for _, codes, _ in RUNS.values()] + ["contact speed; contact time"]
    assert batch.run_many(cases)["warnings"].values.tolist() == expected


def test_a_run_that_fails_has_no_codes_in_a_batch() -> None:
    refused = dataclasses.replace(trolley(), testbed={**trolley().testbed, "drivetrain.gear_stiction": 0.0})
    table = batch.run_many([refused])
    assert table["status"].item() == "refused"
    assert table["warnings"].item() == ""


def test_warnings_are_kept_and_shown(tmp_path: Path) -> None:
    result = batch.run(RUNS["hit twice"][0])
    text = result.warnings[0].text
    folder = result.save(tmp_path / "run")
    again = giveway.load(folder)
    assert again.warnings == result.warnings
    assert json.loads((folder / "metrics.json").read_text(encoding="utf-8"))["warnings"] == [
        {"code": "second hit harder", "text": text}
    ]
    assert json.loads((folder / "manifest.json").read_text(encoding="utf-8"))["warnings"] == [text]
    page = render("hit twice", "", [result])
    assert "<h2>Warnings</h2>" in page
    assert text in page
    assert "<h2>Warnings</h2>" not in render("as asked", "", [batch.run(longer())])


def test_several_results_say_whose_they_are() -> None:
    results = {"none": batch.run(RUNS["hit twice"][0]), "spring": batch.run(RUNS["pressed into its stop"][0])}
    twice, pressed = (result.warnings[0].text for result in results.values())
    assert warning_lines(results) == [f"no bumper: {twice}", f"spring: {pressed}"]
    assert warning_lines({"none": results["none"]}) == [twice]
    assert summary(results)["warnings"] == [
        {"bumper": "none", "code": "second hit harder", "text": twice},
        {"bumper": "spring", "code": "bumper bottomed", "text": pressed},
    ]


def test_the_terminal_shows_them(cli: Cli) -> None:
    said = cli("run", "motionless", "--bumper", "none", "--preset", "paper", "--duration", "1.0", "--out", "out")
    assert said.returncode == 0, said.stderr
    assert 'The controller has the preset "paper": ' in said.stdout
    assert "Warnings\n  a later contact was harder than the first: 203 N after 187 N\n" in said.stdout


def test_an_interrupted_run_has_none() -> None:
    calls = []

    def stop(now_s: float, _duration_s: float) -> None:
        calls.append(now_s)
        if len(calls) == 2:
            raise KeyboardInterrupt

    scenario = dataclasses.replace(trolley(), duration_s=3.0)
    result = giveway.run(scenario, stop)
    assert result.interrupted
    assert result.warnings == ()
    assert [one.code for one in warnings_of(scenario, all_metrics(result))] == ["no contact"]


def all_metrics(result: giveway.Result) -> list[object]:  # type: ignore[name-defined]
    from giveway.simulation import metrics

    return list(metrics.evaluate(result.traces, result.manifest["parameters"]).values())
