"""A plan beyond the controller's limits is refused before anything runs, by the name of its field."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import giveway
import pytest
from giveway import batch
from giveway.base.errors import GivewayError, InputFileError
from giveway.scenario.arcs import EVERY_WHEEL, Arcs
from giveway.scenario.plan import Circle, Plan, Straight
from giveway.scenario.plan_limits import Limits, check_plan
from giveway.scenario.scenario_file import read_scenario
from giveway.study import Study
from study_helpers import small_study, stored_runs

LIMITS = Limits(speed_mps=0.5, acceleration_mps2=1.5, yaw_rate_radps=1.5, yaw_acceleration_radps2=6.0)


def arcs(swing_rad: float, frequency_hz: float, wheels: tuple[tuple[float, float, float], ...] = EVERY_WHEEL) -> Arcs:
    return Arcs(wheels, swing_rad, frequency_hz, 2, 0.5, 0.1016, 0.24)


REFUSED: dict[str, tuple[Plan, str, str]] = {
    "speed": (Straight(0.51), "Straight.speed_mps: 0.51", "at most 0.5 m/s, controller.reference.speed_limit"),
    "acceleration": (Straight(0.2, acceleration_mps2=1.6), "Straight.acceleration_mps2: 1.6", "at most 1.5 m/s2"),
    "speed, clockwise": (Circle(2.0, -0.6), "Circle.speed_mps: -0.6", "at most 0.5 m/s"),
    "narrow": (Circle(0.3, 0.5), "centripetal acceleration: 1.67 m/s2", "controller.reference.acceleration_limit"),
    "yaw rate": (Circle(0.6, 0.48, heading="turning"), "yaw rate: 1.6 rad/s", "at most 1.5 rad/s"),
    "speeding up": (Circle(1.5, 0.2, acceleration_mps2=1.6), "Circle.acceleration_mps2: 1.6", "at most 1.5 m/s2"),
    # a sin(p) and (V (1 - cos p)/2)^2/r together: at most 1.562 m/s2, at p = 1.79
    "both": (Circle(0.34, 0.5, acceleration_mps2=1.5), "with the way round: 1.56 m/s2", "at most 1.5 m/s2"),
    "yaw acceleration": (
        Circle(0.3, 0.2, heading="turning", acceleration_mps2=1.0),
        "yaw acceleration: 6.67 rad/s2",
        "controller.reference.yaw_acceleration_limit",
    ),
    # 2/3 of the rim of the wheel that swings: 0.1016 (2/3) 1.5 (2 pi 1.3) = 0.83 m/s
    "arcs, speed": (arcs(1.5, 1.3), "Arcs.frequency_hz: 1.3 (speed: 0.83 m/s)", "at most 0.5 m/s"),
    "arcs, acceleration": (arcs(0.1, 3.0), "acceleration: 2.41 m/s2", "at most 1.5 m/s2"),
    "arcs on the spot": (arcs(10.0, 0.1, ((1.0, 1.0, 1.0),)), "yaw rate: 2.66 rad/s", "at most 1.5 rad/s"),
    "arcs on the spot, quick": (
        arcs(0.1, 2.0, ((1.0, 1.0, 1.0),)),
        "yaw acceleration: 6.69 rad/s2",
        "yaw_acceleration",
    ),
}
FOLLOWED: dict[str, Plan] = {
    "the limits themselves": Straight(0.5, acceleration_mps2=1.5),
    "already moving": Straight(0.5, acceleration_mps2=None),
    "a heading that stays": Circle(0.6, 0.48),
    "turning": Circle(1.0, -0.5, heading="turning", acceleration_mps2=1.0),
    "arcs": arcs(1.5, 0.1),
    "something of one's own": lambda time_s: Straight(5.0)(time_s),
}


@pytest.mark.parametrize(("plan", "what", "limit"), REFUSED.values(), ids=REFUSED)
def test_what_cannot_be_followed_is_refused(plan: Plan, what: str, limit: str) -> None:
    with pytest.raises(GivewayError) as caught:
        check_plan(plan, LIMITS)
    assert what in str(caught.value)
    assert limit in str(caught.value)


@pytest.mark.parametrize("plan", FOLLOWED.values(), ids=FOLLOWED)
def test_what_can_be_followed_is_not(plan: Plan) -> None:
    check_plan(plan, LIMITS)


@pytest.mark.parametrize("run", [giveway.run, batch.run, lambda scenario: batch.run_many([scenario])])
def test_no_way_to_run_it_lets_it_pass(run: Callable[[giveway.Scenario], object]) -> None:
    with pytest.raises(GivewayError, match=r"Straight\.speed_mps: 0\.8 is not allowed; allowed: at most 0\.5 m/s"):
        run(giveway.Scenario("fast", 1.0, plan=Straight(0.8)))


def test_the_limit_is_the_scenarios_own() -> None:
    plan = Straight(0.8, acceleration_mps2=1.0)
    faster = giveway.Scenario("fast", 0.3, controller={"reference.speed_limit": 0.8}, plan=plan)
    assert batch.run_many([faster])["status"].item() == "ok"
    slow = giveway.Scenario("slow", 0.3, controller={"reference.speed_limit": 0.1}, plan=Straight(0.2))
    with pytest.raises(GivewayError, match=r"at most 0\.1 m/s"):
        batch.run(slow)


FILE = """\
schema_version = 1
duration = 2.0

[plan]
kind = "{kind}"
{keys}
"""


@pytest.mark.parametrize(
    ("kind", "keys", "line", "message"),
    [
        ("straight", "speed = 0.8", 6, "plan.speed: 0.8 is not allowed; allowed: at most 0.5 m/s"),
        (
            "straight",
            "speed = 0.2\nacceleration = 3.0",
            7,
            "plan.acceleration: 3.0 is not allowed; allowed: at most 1.5",
        ),
        ("circle", "diameter = 0.2\nspeed = 0.5", 7, "plan.speed: 0.5 (centripetal acceleration: 2.5 m/s2)"),
    ],
)
def test_a_file_is_refused_with_its_line(tmp_path: Path, kind: str, keys: str, line: int, message: str) -> None:
    path = tmp_path / "case.toml"
    path.write_text(FILE.format(kind=kind, keys=keys), encoding="utf-8")
    with pytest.raises(InputFileError) as caught:
        read_scenario(path)
    assert caught.value.line == line
    assert message in str(caught.value)


def driving(**changes: object) -> Study:
    """A study of a robot that shall drive at 0.6 m/s into something that stands."""
    study = small_study(vary=[])
    study.document["scenario"] = {
        "duration": 0.5,
        "plan": {"kind": "straight", "speed": 0.6, "direction": 60.0, "acceleration": 1.4},
    }
    study.document["collision"] = [{"name": "standing", "speed": 0.0, "edge": 0, "time": 0.3}]
    study.document.update(changes)
    return study


def test_a_study_that_no_design_can_do_is_refused_as_a_whole(tmp_path: Path) -> None:
    with pytest.raises(GivewayError, match=r"scenario\.plan\.speed: 0\.6 is not allowed; allowed: at most 0\.5 m/s"):
        driving().vary("collision.mass", values=[5.0, 9.0]).run(tmp_path / "study")
    assert not (tmp_path / "study").exists()


def test_designs_that_cannot_do_it_are_refused_one_by_one(tmp_path: Path) -> None:
    study = driving().vary("controller.reference.speed_limit", values=[0.5, 0.6, 0.7])
    study.run(tmp_path / "study")
    runs = stored_runs(tmp_path / "study")
    assert runs["status"].tolist() == ["refused", "ok", "ok"]
    assert runs["message"][0].startswith("scenario.plan.speed: 0.6 is not allowed; allowed: at most 0.5 m/s")


def test_a_hit_after_the_end_is_refused_in_a_study(tmp_path: Path) -> None:
    study = small_study(vary=[]).vary("collision.time", values=[0.12, 0.2])
    study.run(tmp_path / "study")
    runs = stored_runs(tmp_path / "study")
    assert runs["status"].tolist() == ["ok", "refused"]
    assert runs["message"][1] == "collision.time: 0.2 is not allowed; allowed: before the end of the run at 0.2 s"
