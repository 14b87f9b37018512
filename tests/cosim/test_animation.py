"""What the animation draws stands where it should: the obstacle outside the robot, on the side where it touches."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import giveway
import numpy as np
import pytest
from giveway.report.animation import scene
from numpy.typing import NDArray

EXAMPLES = Path(__file__).parents[2] / "examples"
ROUNDED_M = 2e-4  # two lengths are rounded to 0.1 mm each; turning by the rounded angle moves a corner by less
TOUCHING_M = 0.035  # the softest body here gives by 300 N / 10.1 kN/m

Polygon = NDArray[np.float64]


def oblique(testbed: dict[str, Any], **changes: Any) -> giveway.Scenario:
    """A slider that comes 40 deg from straight into the first side."""
    scenario = giveway.experiment("motionless").scenario("magnetic")
    turned = {
        "slider.direction": math.radians(-80.0),
        "slider.speed": 0.3,
        "slider.run_up": 0.3,
        "rope.attached": False,
    }
    return dataclasses.replace(scenario, testbed={**scenario.testbed, **turned, **testbed}, **changes)


SCENARIOS = {
    "the robot drives into a slider with a bumper": lambda: giveway.experiment("moving").scenario("magnetic"),
    "the robot drives into a rigid slider": lambda: giveway.experiment("moving").scenario("none"),
    "the robot drives into a leg": lambda: giveway.read_scenario(EXAMPLES / "into_a_leg.toml"),
    "a slider hits the resting robot": lambda: giveway.experiment("motionless").scenario("spring"),
    "a slider comes from the side": lambda: oblique({}),
    "an edge comes from the side": lambda: oblique({"contact.nose_shape": 1}),
    "the bumper is on the robot": lambda: oblique({"bumper.mount": 1}),
}


def world(points: Any, x: float, y: float, theta: float) -> Polygon:
    turn = np.array([[math.cos(theta), -math.sin(theta)], [math.sin(theta), math.cos(theta)]])
    return np.asarray(np.asarray(points) @ turn.T + [x, y])


def placed(points: Any, scene: dict[str, Any], row: int, moved: float = 0.0) -> Polygon:
    """Points behind the nose in the world, as the page's script places them."""
    rail = np.array(scene["obstacle"]["rail"])
    nose = [values[row] for values in scene["nose"]]
    back, left = np.asarray(points).T
    return np.asarray(nose - np.outer(back - moved, rail) + np.outer(left, [-rail[1], rail[0]]))


def obstacle_at(scene: dict[str, Any], row: int) -> list[Polygon]:
    """Everything of the obstacle that is drawn at ``row``: nose, what carries it, body, rail."""
    drawn = scene["obstacle"]
    moved = scene["compression"][row] if drawn["sprung"] else 0.0
    turns = np.linspace(0.0, 2.0 * math.pi, 33)
    if drawn["edge"] is None:
        nose = drawn["radius"] * np.stack([1.0 - np.cos(turns), np.sin(turns)], axis=1)
    else:
        nose = drawn["edge"]
    between = [[drawn["front"], 0.0], [drawn["body"][0][0] - moved, 0.0]]
    rail = [[drawn["body"][1][0] - moved, 0.0], [2.0, 0.0]]
    return [
        placed(nose, scene, row),
        placed(between, scene, row),
        placed(drawn["body"], scene, row, moved),
        placed(rail, scene, row),
    ]


def gap(one: Polygon, other: Polygon) -> float:
    """Largest distance between two convex polygons along a normal of a side, m; negative: they overlap."""
    found = -math.inf
    for polygon in (one, other):
        sides = np.roll(polygon, -1, axis=0) - polygon
        lengths = np.hypot(*sides.T)
        for side, length in zip(sides, lengths, strict=True):
            if length > 0.0:
                normal = np.array([side[1], -side[0]]) / length
                first, second = one @ normal, other @ normal
                found = max(found, float(second.min() - first.max()), float(first.min() - second.max()))
    return found


@pytest.fixture(scope="module", params=SCENARIOS)
def drawn(request: pytest.FixtureRequest) -> dict[str, Any]:
    scenario = SCENARIOS[request.param]()
    result = giveway.run(dataclasses.replace(scenario, duration_s=min(scenario.duration_s, 5.0)))
    found = scene(request.param, result)
    assert min(found["time"]) < 0.0 < max(found["time"]), "there was no contact"
    return found


def test_no_part_of_the_obstacle_is_inside_the_robot_before_contact(drawn: dict[str, Any]) -> None:
    for row in np.flatnonzero(np.array(drawn["time"]) < 0.0):
        robot = world(drawn["outline"], *(values[row] for values in drawn["base"]))
        for part in obstacle_at(drawn, row):
            assert gap(robot, part) > -ROUNDED_M


def test_the_nose_is_where_it_touches_and_the_slider_behind_it(drawn: dict[str, Any]) -> None:
    force = np.hypot(*np.array(drawn["force"]))
    row = int(np.flatnonzero(force > 0.0)[0])
    contact = np.array([values[row] for values in drawn["point"]])
    nose, *_, body, rail = obstacle_at(drawn, row)
    # Of a convex polygon, the largest distance to a side says how near it is to a point.
    assert abs(gap(nose, np.array([contact]))) < TOUCHING_M
    base = np.array([values[row] for values in drawn["base"][:2]])
    beyond = contact - base
    for part in (body, rail):
        assert ((part - contact) @ beyond > 0.0).all(), "the slider is on the robot's side of the contact"


def test_a_bumper_on_the_robot_is_drawn_there() -> None:
    testbed = {"bumper.mount": 1}
    result = giveway.run(oblique(testbed, duration_s=0.01))
    found = scene("", result)
    assert not found["obstacle"]["sprung"]
    parameters = result.manifest["parameters"]["testbed"]
    mount = np.array([parameters["bumper.mount_x"], parameters["bumper.mount_y"]])
    ends, foot, inward = (np.array(found["plate"][name]) for name in ("ends", "foot", "inward"))
    assert ends.mean(axis=0) == pytest.approx(mount)
    assert (ends[1] - ends[0]) @ inward == pytest.approx(0.0, abs=1e-12)
    outline = np.array(found["outline"])
    assert gap(outline, np.array([foot, foot + 1e-9])) == pytest.approx(0.0, abs=1e-6)  # on the outline
    across = np.array([-inward[1], inward[0]])
    assert (foot - mount) @ across == pytest.approx(0.0, abs=1e-12)


def test_without_a_slider_nothing_is_drawn() -> None:
    result = giveway.run(oblique({"slider.present": False}, duration_s=0.01))
    assert scene("", result)["obstacle"] is None
