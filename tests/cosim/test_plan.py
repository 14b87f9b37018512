"""Planned motions are consistent: position, speed and acceleration belong together."""

from __future__ import annotations

import math

import numpy as np
import pytest
from giveway.errors import GivewayError
from giveway.plan import Straight


def test_straight_speeds_up_and_keeps_its_speed() -> None:
    plan = Straight(0.22, math.pi / 3, 0.2)
    assert plan.ramp_s == pytest.approx(1.1)
    time_s = np.linspace(0.0, 3.0, 3001)
    table = plan(time_s)
    direction = np.array([math.cos(math.pi / 3), math.sin(math.pi / 3)])
    position, velocity, acceleration = (table[:, column : column + 2] @ direction for column in (0, 3, 6))
    assert position[0] == velocity[0] == 0.0
    assert position[1100] == pytest.approx(plan.ramp_m)
    assert velocity[1100:] == pytest.approx(0.22)
    assert np.diff(position) / 1e-3 == pytest.approx(0.5 * (velocity[1:] + velocity[:-1]), abs=1e-9)
    assert set(np.round(acceleration, 12)) == {0.2, 0.0}
    across = table[:, [0, 3, 6]] * direction[1] - table[:, [1, 4, 7]] * direction[0]
    assert across == pytest.approx(0.0, abs=1e-12)
    assert not table[:, [2, 5, 8]].any()


@pytest.mark.parametrize(
    ("field", "value"), [("speed_mps", -0.1), ("direction_rad", math.nan), ("acceleration_mps2", 0.0)]
)
def test_straight_refuses(field: str, value: float) -> None:
    with pytest.raises(GivewayError, match=rf"Straight\.{field}"):
        Straight(**{"speed_mps": 0.2, field: value})  # type: ignore[arg-type]
