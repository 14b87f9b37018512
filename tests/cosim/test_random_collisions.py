"""Random collisions: places, directions and speeds are as promised, and a scenario depends on its number."""

from __future__ import annotations

import math

import numpy as np
import pytest
from giveway.robot.variables import table
from giveway.scenario.approach import outline_of
from giveway.scenario.random_collisions import FACTORS, random_collisions
from giveway.scenario.scenario import Scenario

START = {variable.name: variable.start for variable in table("testbed")}
COUNT = 300
GRAVITY = 9.81


@pytest.fixture(scope="module")
def drawn() -> list[Scenario]:
    return random_collisions(COUNT, 4)


def placed(scenario: Scenario) -> tuple[float, float]:
    """Where the nose touches its side, as a share of half the side's length from the middle, and the angle between
    its motion and the side's normal, rad."""
    values = {name: value for name, value in (START | scenario.testbed).items() if value is not None}
    direction, radius = float(values["slider.direction"]), float(values["contact.nose_radius"])
    tip = np.array([float(values[f"slider.target_{axis}"]) for axis in "xy"])
    centre = tip - radius * np.array([math.cos(direction), math.sin(direction)])
    outline = outline_of(values)
    for start, end in zip(outline, np.roll(outline, -1, 0), strict=True):
        half = 0.5 * (end - start)
        inwards = np.array([-half[1], half[0]]) / math.hypot(*half)
        from_middle = centre + radius * inwards - (start + half)
        share = float(from_middle @ half / (half @ half))
        if abs(from_middle @ inwards) < 1e-9 and abs(share) < 1.0:
            return share, math.remainder(direction - math.atan2(inwards[1], inwards[0]), 2.0 * math.pi)
    raise AssertionError("beside the outline")


def test_places_and_directions_fill_their_ranges(drawn: list[Scenario]) -> None:
    shares, angles = np.transpose([placed(one) for one in drawn])
    for values, limit in ((shares, 0.6), (np.degrees(angles), 35.0)):
        assert np.abs(values).max() <= limit * (1.0 + 1e-9)
        # Of 300 uniform numbers the chance that none lies in a tenth at either end is 1e-7.
        assert values.max() > 0.9 * limit
        assert values.min() < -0.9 * limit


def test_speeds_are_uniform_on_a_logarithmic_scale(drawn: list[Scenario]) -> None:
    """Of those that are thrown; friction takes some of it before the hit."""
    speeds = [float(one.testbed["slider.speed"]) for one in drawn if not one.testbed["rope.attached"]]  # type: ignore[arg-type]
    assert 0.3 * COUNT < len(speeds) < 0.7 * COUNT
    assert min(speeds) >= 0.1
    assert max(speeds) < 1.2
    below = np.mean(np.array(speeds) < math.sqrt(0.1 * 1.0))
    assert 0.3 < below < 0.6  # a half without friction; of uniform speeds it were a quarter


def test_what_is_pulled_hits_in_time_and_does_not_fall_far(drawn: list[Scenario]) -> None:
    for one in drawn:
        if one.testbed["rope.attached"]:
            weight, slider = (float(one.testbed[name]) for name in ("rope.hanging_mass", "slider.mass"))  # type: ignore[arg-type]
            pull = GRAVITY * weight / (weight + slider)
            run_up = float(one.testbed["slider.run_up"])  # type: ignore[arg-type]
            assert one.testbed["slider.speed"] == 0.0
            # Friction, and a rope that has to stretch first.
            assert run_up < 1.2 * min(0.15, 0.5 * pull * 0.25**2)
            assert run_up > 0.5 * min(0.15, 0.5 * pull * 0.12**2)


def test_each_number_is_within_its_factor_and_spread_over_it(drawn: list[Scenario]) -> None:
    for name, factor in FACTORS.items():
        ratios = np.array([float(one.testbed[name]) / float(START[name]) for one in drawn])  # type: ignore[arg-type]
        shares = np.log(ratios) / math.log(factor)
        assert np.abs(shares).max() <= 1.0 + 1e-9, name
        assert shares.max() > 0.9, name
        assert shares.min() < -0.9, name


def test_a_scenario_depends_on_seed_and_number_alone(drawn: list[Scenario]) -> None:
    assert random_collisions(7, 4) == drawn[:7]
    assert random_collisions(7, 5) != drawn[:7]
