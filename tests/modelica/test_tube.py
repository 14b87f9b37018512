"""The tube tolerates a short time and a small value, and nothing else."""

import numpy as np
from giveway_modelica.tube import at, excess

TIME_S = np.linspace(0.0, 1.0, 101)
STEP = np.where(TIME_S < 0.5, 0.0, 1.0)


def outside(values: np.ndarray, width_s: float = 0.0, height: float = 0.0) -> float:
    return excess(TIME_S, values, TIME_S, STEP, width_s, height).value


def test_the_reference_itself_is_inside() -> None:
    assert outside(STEP) <= 0.0


def test_a_jump_may_come_early_or_late_by_the_width() -> None:
    for shifted in (np.append(STEP[1:], 1.0), np.insert(STEP, 0, 0.0)[:-1]):
        assert outside(shifted, width_s=0.0101) <= 0.0
        assert outside(shifted, width_s=0.0) > 0.9
    assert outside(np.append(STEP[2:], [1.0, 1.0]), width_s=0.0101) > 0.9


def test_a_value_may_be_off_by_the_height() -> None:
    assert outside(STEP + 0.009, height=0.01) <= 0.0
    values = STEP.copy()
    values[70] += 0.02
    found = excess(TIME_S, values, TIME_S, STEP, 0.005, 0.01)
    assert np.isclose(found.value, 0.01)
    assert found.time_s == TIME_S[70]


def test_a_peak_that_the_width_does_not_reach_is_outside() -> None:
    values = STEP.copy()
    values[20] = 0.5
    assert outside(values, width_s=0.05, height=0.1) > 0.3


def test_at_takes_the_value_after_an_event() -> None:
    time_s, values = np.array([0.0, 0.5, 0.5, 1.0]), np.array([0.0, 1.0, 2.0, 3.0])
    assert at(time_s, values, np.array([0.0, 0.5, 0.75, 1.0])).tolist() == [0.0, 2.0, 2.0, 3.0]
