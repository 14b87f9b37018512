"""Designs and distributions: what the samplers were asked for is what comes out."""

from __future__ import annotations

import numpy as np
import pytest
from giveway.study.designs import DesignPlan, deviations, make, problem
from giveway.study.distributions import Spread, Tolerance, Varied, check_spread
from giveway.study.quantities import columns, find

RATE, LATCH, MASS = (
    find("quantity", f"testbed.{name}") for name in ("bumper.spring_rate", "bumper.latch_force", "base.mass")
)


def over(
    quantity: object, low: float, high: float, levels: tuple[float, ...] = (), nominal: float | None = None
) -> Varied:
    return Varied(quantity, nominal, levels, Spread("uniform", low, high))  # type: ignore[arg-type]


def test_a_factorial_has_every_combination_once() -> None:
    found = make(DesignPlan("factorial"), [over(RATE, 1, 2, (1.0, 1.5, 2.0)), over(LATCH, 0, 9, (0.0, 9.0))], 1)
    assert sorted(map(tuple, found)) == [(r, f) for r in (1.0, 1.5, 2.0) for f in (0.0, 9.0)]


def test_a_latin_hypercube_has_one_design_in_every_slice() -> None:
    found = make(DesignPlan("latin-hypercube", count=50), [over(RATE, 100.0, 300.0), over(LATCH, 0.0, 10.0)], 3)
    for column, (low, high) in zip(found.T, ((100.0, 300.0), (0.0, 10.0)), strict=True):
        assert sorted(((column - low) / (high - low) * 50).astype(int)) == list(range(50))


def test_sobol_points_fill_evenly_and_come_again_with_the_seed() -> None:
    plan, varied = DesignPlan("sobol", count=256), [over(RATE, 0.0, 1.0), over(LATCH, 0.0, 1.0)]
    found = make(plan, varied, 7)
    np.testing.assert_array_equal(found, make(plan, varied, 7))
    assert not np.array_equal(found, make(plan, varied, 8))
    counts, _, _ = np.histogram2d(*found.T, bins=16, range=((0, 1), (0, 1)))
    assert (counts == 1).all()  # a (0, 8, 2)-net: one of 256 points in each of 16 x 16 squares


def test_one_at_a_time_changes_one_quantity_only() -> None:
    nominal = np.array([948.0, 45.0])
    varied = [over(RATE, 500, 2000, (500.0, 948.0, 2000.0), 948.0), over(LATCH, 0, 90, (0.0, 90.0), 45.0)]
    found = make(DesignPlan("one-at-a-time"), varied, 1)
    assert found[0].tolist() == nominal.tolist()
    assert sorted(map(tuple, found[1:])) == [(500.0, 45.0), (948.0, 0.0), (948.0, 90.0), (2000.0, 45.0)]


@pytest.mark.parametrize("plan", [
    DesignPlan("factorial"), DesignPlan("one-at-a-time"), DesignPlan("sobol", count=10),
    DesignPlan("sobol-indices", count=8), DesignPlan("morris", trajectories=5), DesignPlan("latin-hypercube", count=11),
])  # fmt: skip
def test_the_size_is_known_before_the_designs_are_made(plan: DesignPlan) -> None:
    varied = [
        over(RATE, 1, 2, (1.0, 2.0), 1.0),
        over(LATCH, 0, 9, (0.0, 3.0, 9.0), 0.0),
        over(MASS, 30, 40, (30.0, 40.0), 30.0),
    ]
    assert len(make(plan, varied, 1)) == plan.size(varied)


def test_morris_steps_change_one_quantity_each() -> None:
    varied = [over(RATE, 0.0, 1.0), over(LATCH, 0.0, 1.0), over(MASS, 0.0, 1.0)]
    found = make(DesignPlan("morris", trajectories=6), varied, 2).reshape(6, 4, 3)
    assert ((np.diff(found, axis=1) != 0.0).sum(axis=2) == 1).all()


def test_listed_values_come_equally_often() -> None:
    bumper = find("quantity", "bumper")
    found = make(DesignPlan("sobol", count=300), [Varied(bumper, None, (0.0, 1.0, 2.0)), over(RATE, 0, 1)], 1)
    assert np.bincount(found[:, 0].astype(int)).tolist() == pytest.approx(
        [100, 100, 100], abs=3
    )  # 300 is no power of 2


SHARES = (np.arange(100_000) + 0.5) / 100_000


@pytest.mark.parametrize(("spread", "mean", "deviation"), [
    (Spread("uniform", 2.0, 6.0), 4.0, 4.0 / 12**0.5),
    (Spread("triangular", 0.0, 3.0, mode=0.0), 1.0, 3.0 / 18**0.5),
    (Spread("loguniform", 1.0, np.e**2), (np.e**2 - 1.0) / 2.0, None),
    (Spread("normal", -8.0, 8.0, mean=0.0, sigma=1.0), 0.0, 1.0),
])  # fmt: skip
def test_distributions_have_their_moments(spread: Spread, mean: float, deviation: float | None) -> None:
    values = spread.at(SHARES)
    # The midpoint rule over 100,000 shares.
    assert values.mean() == pytest.approx(mean, abs=1e-4)
    if deviation is not None:
        assert values.std() == pytest.approx(deviation, rel=1e-3)


def test_a_normal_distribution_ends_at_three_sigma() -> None:
    spread = check_spread("vary[0]", RATE, "normal", {"mean": 1000.0, "sigma": 100.0})
    assert spread.at(np.array([0.0, 1.0])).tolist() == [700.0, 1300.0]


def test_tolerances_begin_with_none_and_stay_inside() -> None:
    tolerances = [
        Tolerance(LATCH, True, Spread("uniform", -0.3, 0.3)),
        Tolerance(RATE, False, Spread("normal", -9.0, 9.0, 0, 0, 3.0)),
    ]
    found = deviations(tolerances, "sobol", 64, 1)
    assert found.shape == (65, 2)
    assert found[0].tolist() == [0.0, 0.0]
    assert (np.abs(found) <= [0.3, 9.0]).all()
    assert np.abs(found[:, 0]).max() > 0.28
    corners = deviations(tolerances, "corners", 64, 1)
    assert sorted(map(tuple, corners)) == sorted([(0.0, 0.0), (-0.3, -9.0), (-0.3, 9.0), (0.3, -9.0), (0.3, 9.0)])


def test_a_number_of_the_robot_is_all_variables_that_take_it() -> None:
    names = {columns().names[i] for i in find("quantity", "robot.drivetrain.stiffness").columns}
    assert names == {"testbed.drivetrain.stiffness", "controller.estimator.drivetrain_stiffness"}
    assert len(find("quantity", "robot.roller.presliding_stiffness").columns) == 6


def test_the_problem_names_the_quantities() -> None:
    assert problem([over(RATE, 0, 1)]) == {
        "num_vars": 1,
        "names": ["testbed.bumper.spring_rate"],
        "bounds": [[0.0, 1.0]],
    }
