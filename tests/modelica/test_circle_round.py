"""The whole round of 5.4, simulated once for all its tests: it takes as long as everything else together.

`make test` has its first push instead, `CirclePushed` in test_agreement.py.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from giveway_modelica.agreement import SMOOTH, beside, bound, heights, outside, signals
from giveway_modelica.compiler import Compiler
from giveway_modelica.fmu_runs import RUNS, Pair, in_double
from giveway_modelica.tube import at
from test_reference_results import check_the_reference_result

pytestmark = pytest.mark.deep

EXAMPLE = "CircleRound"
# Of the controllers: the FMU's, and the block's.
MODES = {0: 1, 1: 2, 2: 3, 3: 4, 4: 5}


@pytest.fixture(scope="module")
def whole_round(compiler: Compiler) -> Any:
    return compiler.simulate(f"GiveWay.Examples.{EXAMPLE}")


@pytest.mark.parametrize("shipped", [False, True], ids=["double", "shipped"])
def test_the_round_lies_in_the_tube(whole_round: Any, shipped: bool) -> None:
    assert outside(whole_round, EXAMPLE, shipped) == {}


def test_push_escape_return_and_the_rest_of_the_round(whole_round: Any) -> None:
    reference = beside(EXAMPLE)
    mode = at(np.asarray(whole_round.time), np.asarray(whole_round["robot.controller.mode"]), reference["time"])
    # With the same samples: tare, plan, escape, settled, way back, plan.
    assert mode.astype(int).tolist() == [MODES[int(theirs)] for theirs in reference["controller.mode"]]
    assert [int(one) for one in mode[np.flatnonzero(np.diff(mode, prepend=0.0))]] == [1, 2, 3, 4, 5, 2]
    assert set(whole_round["robot.controller.hit_tick"]) == {-1, 8067}
    quiet = heights(whole_round, reference, signals(EXAMPLE), 8.067)
    assert max(quiet.values()) < SMOOTH


def test_another_way_back_leaves_the_tube(whole_round: Any) -> None:
    run = RUNS[EXAMPLE]
    assert isinstance(run, Pair)
    with in_double():
        other = replace(run, controller={**run.controller, "reference.rejoin_speed": 0.1001}).run(20.0)
    height = heights(whole_round, other, signals(EXAMPLE))
    assert height["reference"] > bound(EXAMPLE, "reference")


def test_the_round_closes(whole_round: Any) -> None:
    """Every side of the circle of 1.5 m is passed, and the end is beyond the beginning."""
    x, y = (np.asarray(whole_round[f"robot.base.body.{axis}"]) for axis in "xy")
    assert np.percentile(np.hypot(x, y - 0.75), 50) == pytest.approx(0.75, abs=5e-3)
    assert min(x.min(), -x.max()) == pytest.approx(-0.75, abs=5e-3)
    assert y.max() == pytest.approx(1.5, abs=5e-3)
    assert 0.0 < np.arctan2(x[-1], 0.75 - y[-1]) < 0.1


def test_the_reference_result_of_the_round_is_fresh(whole_round: Any) -> None:
    check_the_reference_result(whole_round, EXAMPLE)
