"""The robot from above: wheels, hull, and the controller's outline."""

from __future__ import annotations

import math

import numpy as np
import pytest
from giveway.base.errors import GivewayError
from giveway.robot.footprint import controller_outline, hull, wheel_corners
from giveway.robot.variables import Value, table
from giveway.scenario.approach import outline_of
from scipy.spatial import ConvexHull


def trikey() -> dict[str, Value]:
    return {v.name: v.start for v in table("testbed").select("parameter") if v.start is not None}


def test_wheels_lie_on_their_axles() -> None:
    corners = wheel_corners(trikey())
    assert corners.mean(axis=1) == pytest.approx(
        0.24 * np.array([[math.cos(a), math.sin(a)] for a in (0.0, 2.0 * math.pi / 3.0, 4.0 * math.pi / 3.0)])
    )
    for wheel in corners:
        sides = np.hypot(*(np.roll(wheel, -1, axis=0) - wheel).T)
        assert sides == pytest.approx([0.025, 2.0 * 0.1016, 0.025, 2.0 * 0.1016])
        assert ConvexHull(wheel).volume == pytest.approx(0.025 * 2.0 * 0.1016)
    # Wheel 0 rolls along y.
    assert np.ptp(corners[0], axis=0) == pytest.approx([0.025, 2.0 * 0.1016])


def test_chord_of_a_wheel() -> None:
    """The chord of its disc by Pythagoras, equal above and below the axle."""
    for height in (0.03, 0.1732):
        assert np.ptp(wheel_corners(trikey(), height)[0][:, 1]) == pytest.approx(2.0 * math.sqrt(0.1016**2 - 0.0716**2))
    for height in (0.0, 0.3):
        with pytest.raises(GivewayError, match="height_m"):
            wheel_corners(trikey(), height)


def test_hull_against_scipy() -> None:
    rng = np.random.default_rng(7)
    for count in (3, 4, 10, 200):
        points = rng.normal(size=(count, 2))
        found = hull([*points, *points, points.mean(axis=0)])  # twice each, and one inside
        wanted = points[ConvexHull(points).vertices]
        start = int(np.argmin(np.hypot(*(found - wanted[0]).T)))
        assert np.roll(found, -start, axis=0) == pytest.approx(wanted)


def test_hull_drops_points_on_its_sides_and_refuses_too_few() -> None:
    assert len(hull([(0, 0), (1, 0), (2, 0), (2, 2), (0, 2), (0, 1)])) == 4
    with pytest.raises(GivewayError, match="points"):
        hull([(0, 0), (1, 1), (0, 0)])


def test_outline_for_the_controller() -> None:
    corners = hull([*outline_of(trikey()), *wheel_corners(trikey()).reshape(-1, 2)])
    assert len(corners) == 9  # three of the body, two of each wheel
    values = controller_outline(corners)
    assert table("controller").check_all(values) == values
    with pytest.raises(GivewayError, match="corners: 17"):
        controller_outline(np.zeros((17, 2)))
