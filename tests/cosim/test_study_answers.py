"""First answers: the front is what brute force finds, goals are taken as asked, indices are the known ones."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from giveway import batch
from giveway.base.errors import GivewayError
from giveway.study import answers, first_order
from giveway.study.answers import over_runs
from giveway.study.chosen import simulate
from giveway.study.designs import DesignPlan, make
from giveway.study.distributions import Spread, Varied
from giveway.study.metrics import Metric
from giveway.study.pareto import front, scores
from giveway.study.quantities import find
from giveway.study.setup import Goal
from study_helpers import LATCH, SPRING, judged_study, part_files, stored_runs


@pytest.mark.parametrize("objectives", [1, 2, 3, 5])
def test_the_front_is_that_of_every_pair_compared(objectives: int) -> None:
    # Few levels, so that there are ties; some NaN, which are on no front.
    pick = np.random.default_rng(objectives)
    costs = pick.integers(0, 6, (400, objectives)).astype(float)
    costs[pick.integers(0, 400, 20), 0] = np.nan
    beaten = np.zeros(400, dtype=bool)
    for i in range(400):
        worse = (costs <= costs[i]).all(axis=1) & (costs < costs[i]).any(axis=1)
        beaten[i] = worse.any() or np.isnan(costs[i]).any()
    np.testing.assert_array_equal(front(costs), ~beaten)


def test_scores_measure_in_widths_of_the_front() -> None:
    costs = np.array([[0.0, 20.0], [10.0, 0.0], [5.0, 5.0], [20.0, 20.0]])
    found = scores(costs, front(costs), np.array([1.0, 4.0]))
    assert found == pytest.approx([2.0, 1.0, math.sqrt(0.25 + 4.0 * 0.0625), math.sqrt(8.0)])


RUNS = np.array(
    [[[1.0, 5.0], [3.0, 4.0], [2.0, 9.0]], [[np.nan, 1.0], [2.0, 2.0], [2.0, 2.0]]]
)  # designs, samples, hits


@pytest.mark.parametrize(("sense", "collisions", "tolerances", "expected"), [
    (1, "worst", "worst", [9.0, np.nan]),
    (-1, "worst", "worst", [1.0, np.nan]),
    (1, "worst", "nominal", [5.0, np.nan]),
    (1, "mean", "nominal", [3.0, np.nan]),
    (1, "mean", "mean", [4.5, 2.0]),  # of the samples 1 and 2; the nominal one does not count
    (1, "worst", "mean", [6.5, 2.0]),
])  # fmt: skip
def test_goals_are_taken_over_runs_as_asked(
    sense: int, collisions: str, tolerances: str, expected: list[float]
) -> None:
    goal = Goal(Metric("x", "N", "x"), sense, collisions, tolerances)
    np.testing.assert_array_equal(over_runs(goal, RUNS), expected)


def test_the_answers_are_those_of_the_stored_runs(tmp_path: Path) -> None:
    study = judged_study().vary(SPRING, values=[600.0, 1200.0]).collision("slow", speed=0.3, edge=1, time=0.12)
    study.objective("peak force of the run").objective("bumper compression", collisions="mean", goal="minimise")
    study.constraint("bumper compression", maximum=4.0, unit="cm").tolerance(LATCH, relative=0.3).tolerances(samples=3)
    study.document["part_runs"] = 5  # designs end in the middle of parts
    found = study.run(tmp_path / "study", threads=2)
    runs = stored_runs(tmp_path / "study")
    peak = runs["peak force of the run"].reshape(8, 4, 2)
    travel = runs["bumper compression"].reshape(8, 4, 2)
    np.testing.assert_array_equal(found.values[:, 0], peak.max(axis=(1, 2)))
    np.testing.assert_allclose(found.values[:, 1], travel.mean(axis=2).max(axis=1), rtol=1e-15)
    np.testing.assert_array_equal(found.feasible, travel.max(axis=(1, 2)) <= 40.0)
    assert 0 < found.feasible.sum() < 8
    assert found.complete
    assert set(found.order) == set(np.flatnonzero(found.feasible))
    assert found.pareto[found.order[0]]
    assert found.table()["peak force of the run, worst collision, worst of tolerances"].attrs["units"] == "N"


def compared_by_hand(costs: np.ndarray, weights: tuple[float, float]) -> tuple[list[bool], list[int]]:
    """Front and ranking of ``costs`` (designs, 2; less is better), pair by pair."""
    designs = range(len(costs))
    beaten = [
        any((costs[i] <= costs[j]).all() and (costs[i] < costs[j]).any() for i in designs)
        for j in designs
    ]  # fmt: skip
    on_front = [not one for one in beaten]
    best = [min(costs[i][k] for i in designs if on_front[i]) for k in (0, 1)]
    worst = [max(costs[i][k] for i in designs if on_front[i]) for k in (0, 1)]

    def distance(i: int) -> float:
        shares = ((costs[i][k] - best[k]) / ((worst[k] - best[k]) or 1.0) for k in (0, 1))
        return math.sqrt(sum(weight * share**2 for weight, share in zip(weights, shares, strict=True)))

    return on_front, sorted(designs, key=lambda i: (beaten[i], distance(i)))


@pytest.mark.parametrize(("force", "travel"), [
    ("minimise", "minimise"), ("minimise", "maximise"), ("maximise", "minimise"), ("maximise", "maximise"),
])  # fmt: skip
def test_goals_and_weights_decide_front_and_ranking(force: str, travel: str, tmp_path: Path) -> None:
    orders = []
    for weights in ((1.0, 16.0), (16.0, 1.0)):
        study = judged_study().vary(SPRING, values=[600.0, 2500.0])
        study.objective("peak force of the run", goal=force, weight=weights[0])
        study.objective("bumper compression", goal=travel, weight=weights[1])
        found = study.run(tmp_path / "study", threads=2)  # the second only looks at the runs of the first
        runs = stored_runs(tmp_path / "study")
        costs = np.stack([runs["peak force of the run"], runs["bumper compression"]], axis=1)
        costs *= [1.0 if goal == "minimise" else -1.0 for goal in (force, travel)]
        on_front, order = compared_by_hand(costs, weights)
        assert found.pareto.tolist() == on_front
        assert found.order.tolist() == order
        orders.append(order)
    assert orders[0] != orders[1]  # else the weights would not have been needed


def test_goals_and_weights_are_read_as_they_are_written() -> None:
    study = judged_study().objective("contact impulse").objective("rebound speed", goal="maximise", weight=3.0)
    assert [(one.sense, one.weight) for one in study.setup().objectives] == [(1, 1.0), (-1, 3.0)]
    for wrong in ("maximize", "max", ""):
        with pytest.raises(GivewayError, match=r"objective\[0\]\.goal: .*maximise.*minimise"):
            judged_study().objective("contact impulse", goal=wrong).setup()


@pytest.mark.parametrize(("limit", "bound"), [("minimum", 30.0), ("maximum", 60.0)])
def test_a_constraint_is_met_by_the_worst_of_all_runs(limit: str, bound: float, tmp_path: Path) -> None:
    study = judged_study().collision("slow", speed=0.3, edge=1, time=0.12)
    study.tolerance(LATCH, relative=0.5).tolerances(samples=3)
    found = study.constraint("peak force of the run", **{limit: bound}).run(tmp_path / "study", threads=2)
    peaks = stored_runs(tmp_path / "study")["peak force of the run"].reshape(4, 8)
    least, most = peaks.min(axis=1), peaks.max(axis=1)
    assert found.feasible.tolist() == (least >= bound if limit == "minimum" else most <= bound).tolist()
    assert ((least < bound) & (most > bound)).any()  # in some design, the best run alone would have done
    assert found.feasible.any()


@pytest.mark.parametrize("limit", ["minimum", "maximum"])
def test_a_limit_is_itself_allowed(limit: str, tmp_path: Path) -> None:
    found = judged_study().constraint("false detections", **{limit: 0}).run(tmp_path / "study", threads=2)
    assert not stored_runs(tmp_path / "study")["false detections"].any()
    assert found.feasible.all()


def test_a_design_with_a_failed_run_is_not_among_the_answers(tmp_path: Path) -> None:
    study = judged_study(vary=[]).vary("collision.offset", values=[0.0, 0.9]).objective("peak force of the run")
    found = study.run(tmp_path / "study", threads=2)
    assert found.feasible.tolist() == [True, False]
    assert found.failed.tolist() == [0, 1]
    assert "0.9 is not allowed" in found.reason[1]
    assert found.order.tolist() == [0]
    without = judged_study(vary=[]).vary("collision.offset", values=[0.0, 0.9]).run(tmp_path / "study", threads=2)
    assert without.feasible.tolist() == [True, False]  # whatever is asked for


def test_chosen_designs_run_again_as_they_did(tmp_path: Path) -> None:
    study = judged_study().objective("peak force of the run")
    found = study.run(tmp_path / "study", threads=2)
    design = int(found.order[0])
    result = simulate(found.setup, found.runs, tmp_path / "study", design)["front"]
    stored = stored_runs(tmp_path / "study")
    for metric in result.metrics:
        # The same run over the traces, in Python: the sums are in another order.
        value = np.nan if metric.value is None else metric.value
        np.testing.assert_allclose(stored[metric.name][design], value, rtol=1e-9, atol=1e-12, err_msg=metric.name)
    folder = tmp_path / "study" / "chosen" / f"design-{design}" / "front"
    assert {path.name for path in folder.iterdir()} == {"traces.parquet", "metrics.json", "manifest.json"}


ISHIGAMI = {"first": [0.3139, 0.4424, 0.0], "total": [0.5576, 0.4424, 0.2437]}  # a = 7, b = 0.1: known exactly


def ishigami(x: np.ndarray) -> np.ndarray:
    return np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


@pytest.mark.parametrize(
    ("kind", "count", "within"), [("sobol-indices", 2048, 0.03), ("sobol", 4096, 0.05), ("latin-hypercube", 4096, 0.05)]
)
def test_sensitivities_are_the_known_ones_of_a_known_function(kind: str, count: int, within: float) -> None:
    from giveway.study.answers import sensitivities_of

    names = ("bumper.spring_rate", "bumper.latch_force", "base.mass")
    varied = tuple(
        Varied(find("q", f"testbed.{name}"), None, (), Spread("uniform", -math.pi, math.pi)) for name in names
    )
    plan = DesignPlan(kind, count=count)
    designs = make(plan, varied, 1)
    found = sensitivities_of(plan, varied, 1, designs, ishigami(designs), "y")
    # The estimates' own 95 % intervals are about this wide at these sizes.
    assert [one.main for one in found] == pytest.approx(ISHIGAMI["first"], abs=within)
    if kind == "sobol-indices":
        assert [one.total for one in found] == pytest.approx(ISHIGAMI["total"], abs=within)
        assert all(one.total_interval is not None and 0.0 < one.total_interval < 3.0 * within for one in found)
        # Alone, the last one decides nothing; it has part in much.
        assert [one.main > one.interval for one in found] == [True, True, False]
        assert all(one.telling for one in found)
    else:
        assert [one.telling for one in found] == [True, True, False]


def test_first_order_indices_are_those_of_salib() -> None:
    from giveway.study.first_order import first_order
    from SALib.analyze import rbd_fast

    rng = np.random.default_rng(5)
    for count in (64, 65, 1000):
        points = rng.uniform(-math.pi, math.pi, (count, 3))
        values = ishigami(points)
        problem = {"num_vars": 3, "names": ["a", "b", "c"], "bounds": [[-math.pi, math.pi]] * 3}
        theirs = rbd_fast.analyze(problem, points, values, seed=1)
        indices, intervals = first_order(points, values, 1)
        assert indices == pytest.approx(theirs["S1"], abs=1e-12)
        # The spread of 100 resamples is itself uncertain by 7 %; for two of them, 4 sigma of the difference are 40 %.
        assert intervals == pytest.approx(theirs["S1_conf"], rel=0.4)


def test_the_first_harmonics_are_those_of_the_whole_transform(monkeypatch: pytest.MonkeyPatch) -> None:
    series = np.random.default_rng(1).normal(size=1000)
    whole = np.fft.rfft(series)[1 : first_order.HARMONICS + 1]
    np.testing.assert_allclose(first_order._harmonics(series), whole, rtol=0.0, atol=1e-10)
    first_order._waves.cache_clear()
    monkeypatch.setattr(first_order, "BLOCK", 300)  # the last block is a short one
    np.testing.assert_allclose(first_order._harmonics(series), whole, rtol=0.0, atol=1e-10)
    first_order._waves.cache_clear()


def test_elementary_effects_of_a_plane_are_its_slopes() -> None:
    from giveway.study.answers import sensitivities_of

    varied = tuple(
        Varied(find("q", f"testbed.{name}"), None, (), Spread("uniform", 0.0, 1.0))
        for name in ("bumper.travel", "base.mass")
    )
    plan = DesignPlan("morris", trajectories=8)
    designs = make(plan, varied, 1)
    found = sensitivities_of(plan, varied, 1, designs, 3.0 * designs[:, 0] - 0.5 * designs[:, 1], "y")
    assert [one.main for one in found] == pytest.approx([3.0, 0.5])
    assert [one.total for one in found] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_the_names_of_metrics_are_the_library_s(tmp_path: Path) -> None:
    from giveway.study.metrics import all_metrics

    known = all_metrics()
    assert {metric.name for metric in batch.native_metrics()} <= set(known)
    assert known["force at detection (error)"].columns == ("force at detection", "force at detection (true)")


def test_an_unfinished_study_has_answers_so_far(tmp_path: Path) -> None:
    study = judged_study(part_runs=2).objective("peak force of the run")
    study.run(tmp_path / "study", threads=2)
    part_files(tmp_path / "study")[1].unlink()
    found = answers.load(tmp_path / "study")
    assert not found.complete
    assert found.stored.tolist() == [1, 1, 0, 0]
    assert set(found.order) == {0, 1}
