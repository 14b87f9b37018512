"""The search for the best designs: known fronts are found, and nothing that happens on the way changes a bit."""

from __future__ import annotations

import os
import random
import signal
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from giveway.base.errors import GivewayError
from giveway.base.extras import MissingExtraError, extra
from giveway.bench.known_fronts import PROBLEMS, part, real, searched
from giveway.cli import _main
from giveway.study import Study, optimum, study_file
from giveway.study.answers import load
from giveway.study.designs import DesignPlan, make
from giveway.study.distributions import Spread, Varied
from giveway.study.engine import plan_runs
from giveway.study.hypervolume import hypervolume, reference_of, stopped
from giveway.study.optimiser import Known, Space, next_generation
from giveway.study.optimum import optimise, violation_of
from giveway.study.quantities import Quantity
from giveway.study.report import write_report
from giveway.study.search_plan import SearchPlan
from giveway.study.setup import Constraint, Goal, Metric, Setup
from giveway.study.store import PARTS, read_designs, read_manifest
from study_helpers import LATCH, LATCH_STUDY, SPRING, interrupt, judged_study, part_files, small_study, stored_runs

TRAVEL = "testbed.bumper.travel"


SHARES = {"Binh-Korn": (400, 0.985), "ZDT1 with a gap": (1600, 0.97), "ZDT1 of parts": (1600, 0.95)}
"""By problem: designs, and the share of the front's hypervolume, with room for what seeds differ by."""


@pytest.mark.parametrize("name", PROBLEMS)
def test_the_known_front_of_a_problem_is_found(name: str) -> None:
    problem, (count, wanted) = PROBLEMS[name], SHARES[name]
    point = np.array(problem.reference)
    known = searched(problem, 1, count)
    best = hypervolume(problem.front(), point)
    found = hypervolume(known.costs[known.feasible], point) / best
    assert wanted < found <= 1.0 + 1e-6  # a finite number of points is always a little behind the curve
    costs, constraints = problem.judge(make(DesignPlan("sobol", count=20 * count), problem.varied, 1))
    met = (constraints <= 0.0).all(axis=1)
    evenly = hypervolume(costs[met], point) / best
    assert evenly <= 1.0 + 1e-6, "the front is not the front"
    if len(problem.varied) > 2:  # two quantities are a plane that even points fill, too
        assert evenly < 0.8
    assert len(np.unique(Space(problem.varied).coordinates(known.designs), axis=0)) == count, "a design was tried twice"


def test_the_first_designs_are_a_sobol_sequence_and_the_same_seed_gives_the_same() -> None:
    problem = PROBLEMS["ZDT1 of parts"]
    one, again = (searched(problem, 3, 120).designs for _ in range(2))
    np.testing.assert_array_equal(one, again)
    np.testing.assert_allclose(one[:24], make(DesignPlan("sobol", count=24), problem.varied, 3), rtol=1e-15)
    assert not np.array_equal(one, searched(problem, 4, 120).designs)


def test_only_designs_that_meet_all_constraints_are_feasible() -> None:
    costs = np.array([[1.0], [1.0], [np.nan], [1.0], [np.inf]])
    known = Known(np.zeros((5, 1)), costs, np.array([0.0, 0.1, 0.0, np.nan, 0.0]))
    assert known.judged.tolist() == [True, True, False, False, False]
    assert known.feasible.tolist() == [True, False, False, False, False]


def test_designs_that_break_a_constraint_come_after_all_that_meet_them() -> None:
    """Parents are left of 1, where everything is worse: their children are, too."""
    space = Space((real("a", 0.0, 3.0), real("b", 0.0, 3.0)))
    designs = make(DesignPlan("sobol", count=64), space.varied, 1)
    costs = np.stack([4.0 - designs[:, 0], 4.0 - designs[:, 0] + designs[:, 1]], 1)
    broken = Known(designs, costs, np.maximum(designs[:, 0] - 1.0, 0.0))
    assert np.median(next_generation(space, broken, 1, 1, 8)[:, 0]) < 1.1
    free = Known(designs, costs, np.zeros(64))
    assert np.median(next_generation(space, free, 1, 1, 8)[:, 0]) > 2.0


def test_failed_designs_are_excluded_and_not_penalised() -> None:
    """The next generation is the one that there would be without them."""
    problem = PROBLEMS["Binh-Korn"]
    space, known = Space(problem.varied), searched(problem, 1, 80)
    failed = np.array([[4.9, 2.9], [0.1, 2.8], [2.5, 1.5]])
    with_failed = Known(
        np.concatenate([known.designs, failed]),
        np.concatenate([known.costs, np.full((3, 2), np.nan)]),
        np.append(known.violation, [0.0, np.nan, 0.0]),
    )
    expected = next_generation(space, known, 1, 2, 40)
    np.testing.assert_array_equal(next_generation(space, with_failed, 1, 2, 40), expected)
    penalised = Known(with_failed.designs, np.nan_to_num(with_failed.costs, nan=0.0), np.zeros(83))
    assert not np.array_equal(next_generation(space, penalised, 1, 2, 40), expected)  # so the test can fail


def test_as_long_as_nothing_can_be_judged_the_sample_goes_on() -> None:
    varied = PROBLEMS["Binh-Korn"].varied
    space = Space(varied)
    sobol = make(DesignPlan("sobol", count=60), varied, 1)
    known = Known(sobol[:40], np.full((40, 2), np.nan), np.zeros(40))
    np.testing.assert_allclose(next_generation(space, known, 1, 1, 20), sobol[40:], rtol=1e-15)


def test_coordinates_come_back_as_the_values_that_they_were() -> None:
    wide = Varied(Quantity("w", "N", "real", 0.0, 1e9), spread=Spread("loguniform", 1e-3, 1e5))
    whole = Varied(Quantity("n", "", "integer", 0.0, 99.0), spread=Spread("uniform", 2.0, 9.0))
    levels = Varied(Quantity("l", "N", "real", 0.0, 99.0), levels=(3.0, 1.0, 7.5))
    space = Space((wide, whole, levels, part("p", 4)))
    designs = np.array([[1e-3, 2.0, 7.5, 0.0], [1e5, 9.0, 3.0, 3.0], [10.0, 5.0, 1.0, 1.0]])
    coordinates = space.coordinates(designs)
    np.testing.assert_allclose(coordinates, [[0, 0, 2, 0], [1, 7, 0, 3], [0.5, 3, 1, 1]])
    np.testing.assert_allclose(space.designs(coordinates), designs, rtol=1e-12)
    np.testing.assert_array_equal(space.coordinates(space.designs(coordinates)), coordinates)


def test_a_hypervolume_is_the_volume_of_boxes() -> None:
    assert hypervolume(np.array([[3.0], [1.0]]), np.array([4.0])) == 3.0
    two = np.array([[0.0, 2.0], [1.0, 1.0], [2.0, 0.0], [2.0, 2.0]])
    assert hypervolume(two, np.array([3.0, 3.0])) == pytest.approx(1 * 1 + 1 * 2 + 1 * 3)
    assert hypervolume(two, np.array([1.5, 1.5])) == pytest.approx(0.25)
    assert hypervolume(np.array([[0.0, 0.0, 0.0], [5.0, 5.0, 5.0]]), np.array([2.0, 3.0, 4.0])) == pytest.approx(24.0)
    assert hypervolume(np.empty((0, 2)), np.array([1.0, 1.0])) == 0.0
    assert reference_of(np.array([[1.0, 5.0]])) is None
    np.testing.assert_allclose(reference_of(np.array([[1.0, 5.0], [3.0, 5.0]])), [3.2, 5.5])  # type: ignore[arg-type]


def test_a_search_ends_when_the_hypervolume_no_longer_grows() -> None:
    plan = SearchPlan(designs=100, patience=3, growth=0.01)
    assert stopped(plan, [0.0, 0.0, 0.0, 0.0], 40) == ""  # nothing feasible yet
    assert stopped(plan, [1.0, 1.005, 1.009], 40) == ""
    assert stopped(plan, [1.0, 1.0, 1.0, 1.02], 40) == ""
    words = "the hypervolume grew by 0.9 % in 3 generations, no more than 1 %"
    assert stopped(plan, [0.5, 1.0, 1.0, 1.005, 1.009], 40) == words
    assert stopped(plan, [1.0], 100) == "100 designs, as many as were asked for"


def test_a_constraint_is_broken_in_shares_of_its_limit() -> None:
    goal = Goal(Metric("x", "N", "x"), 1)
    values = np.array([50.0, 100.0, 150.0, np.nan, np.inf])
    np.testing.assert_array_equal(violation_of(Constraint(goal, -np.inf, 100.0), values), [0, 0, 0.5, np.nan, np.inf])
    np.testing.assert_array_equal(violation_of(Constraint(goal, 100.0, np.inf), values), [0.5, 0, 0, np.nan, 0])


CATALOGUE = """\
name, price [EUR], rate [N/mm]
a, 1, 0.5
b, 2, 1.1
c, 3, 0.8
d, 9, 2.0
"""


def bumper(folder: Path, **options: object) -> Study:
    """A small search: springs from a catalogue, latch and travel; a short travel makes the run fail."""
    (folder / "springs.csv").write_text(CATALOGUE, encoding="utf-8")
    study = judged_study(
        vary=[], method="fixed-step", part_runs=3, optimise={"designs": 40, "population": 8, **options}
    )
    study.parts("spring", folder / "springs.csv", sets={SPRING: "rate"}).vary(LATCH, low=0.0, high=60.0)
    study.vary(TRAVEL, low=0.02, high=0.1).tolerance(TRAVEL, absolute=0.03).tolerances(kind="corners")
    study.objective("peak force of the run", tolerances="mean").objective("price of parts")
    return study.constraint("bumper compression", maximum=60, unit="mm")


def search_of(study: Study) -> Setup:
    study.document["designs"] = {"kind": "optimised"}
    return study.setup()


def same(one: Path, other: Path) -> None:
    first, second = stored_runs(one), stored_runs(other)
    assert first.keys() == second.keys()
    for name in first:
        np.testing.assert_array_equal(first[name], second[name], name)
    told, again = read_manifest(one), read_manifest(other)
    assert told["optimum"] == again["optimum"]
    hashes = [folder / PARTS / found["fingerprint"][:16] for folder, found in ((one, told), (other, again))]
    np.testing.assert_array_equal(read_designs(hashes[0])[0], read_designs(hashes[1])[0])


def in_a_child(setup: Setup, folder: Path) -> int:
    pid = os.fork()
    if pid == 0:
        try:
            optimise(setup, folder, threads=1)
        finally:
            os._exit(0)
    return pid


@pytest.fixture(scope="module")
def timed(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, float]:
    """A finished search of 40 designs, and how long it took, s."""
    folder = tmp_path_factory.mktemp("search")
    done = optimise(search_of(bumper(folder)), folder / "whole", threads=1)
    assert done.reason == "40 designs, as many as were asked for"
    assert done.outcome.stored == done.outcome.runs == 40 * 3
    return folder / "whole", done.outcome.wall_s


@pytest.fixture
def found(timed: tuple[Path, float]) -> Path:
    """Its folder."""
    return timed[0]


def test_kills_at_random_moments_change_nothing(timed: tuple[Path, float], tmp_path: Path) -> None:
    setup, killed = search_of(bumper(tmp_path)), tmp_path / "k" / "killed"
    pick, kills, seen = random.Random(7), 0, 0
    while kills < 60:
        pid = in_a_child(setup, killed)
        time.sleep(pick.uniform(0.0, timed[1] / 6.0))
        os.kill(pid, signal.SIGKILL)
        _, status = os.waitpid(pid, 0)
        if not os.WIFSIGNALED(status):
            break
        kills += 1
        stored = len(part_files(killed)) if killed.exists() else 0
        assert stored >= seen, "a part that was there is gone"
        seen = stored
    assert kills >= 3, "the search ended before it was killed: make it longer"
    optimise(setup, killed, threads=2)
    same(timed[0], killed)
    assert not [path.name for path in killed.rglob(".*-*")], "left by a kill"


def test_a_finished_search_is_not_run_again_and_another_takes_over_its_runs(found: Path, tmp_path: Path) -> None:
    folder = found.parent
    again = optimise(search_of(bumper(folder)), found, threads=1)
    assert (again.outcome.ran, again.reason) == (0, "40 designs, as many as were asked for")
    longer = optimise(search_of(bumper(folder, designs=48)), folder / "longer", threads=1)
    assert longer.outcome.reused + longer.outcome.failed >= 40 * 3
    assert longer.outcome.ran <= 8 * 3


def test_answers_and_report_tell_how_the_search_went(found: Path, tmp_path: Path) -> None:
    answers = load(found)
    assert answers.complete
    assert len(answers.designs) == 40
    # 0.02 m less 0.03 m is no travel: such runs fail, and their designs are on no front.
    assert (answers.failed > 0).any()
    assert not answers.feasible[answers.failed > 0].any()
    told = answers.manifest["optimum"]
    assert told["designs"] == [8, 16, 24, 32, 40]
    assert told["hypervolume"] == sorted(told["hypervolume"])
    costs = answers.values[answers.feasible][:, :2]
    assert hypervolume(costs, np.array(told["reference"])) == pytest.approx(told["hypervolume"][-1], rel=1e-12)
    write_report(tmp_path / "report.html", answers)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "How the search went" in page
    assert "kind = optimised, designs = at most 40, population = 8" in page
    assert "The search ended: 40 designs, as many as were asked for." in page


def test_every_design_is_tried_at_most_once(tmp_path: Path) -> None:
    study = bumper(tmp_path, designs=500, population=4)
    study.document["vary"] = [{"quantity": LATCH, "values": [0.0, 20.0, 40.0]}]
    study.document["tolerance"] = []
    done = optimise(search_of(study), tmp_path / "s", threads=1)
    assert done.reason == "every design has been tried"
    assert done.outcome.runs == 12


def test_a_python_study_is_optimised_in_one_call(tmp_path: Path) -> None:
    answers = bumper(tmp_path).optimise(tmp_path / "s", designs=16, population=8, threads=1, progress=False)
    assert len(answers.designs) == 16
    assert answers.manifest["optimum"]["reason"].startswith("16 designs")


STUDY = f"""\
schema_version = 1
{LATCH_STUDY}[[objective]]
metric = "peak force of the run"
[optimise]
designs = 3000
population = 30
reference = [500.0]
"""


@pytest.mark.parametrize(("old", "new", "line", "words"), [
    ("designs = 3000", "designs = 20", 17, "optimise.designs: 20 is not allowed; allowed: a whole number from 30 to"),
    ("population = 30", "population = 3", 18, "optimise.population: 3 is not allowed; allowed: a whole number from 4"),
    ("[500.0]", "[500.0, 1.0]", 19, "allowed: a list of 1 numbers, one for each objective"),
    ("[500.0]", '["far"]', 19, "optimise.reference[0]: far is not allowed; allowed: a finite number"),
    ("population", "populatoin", 18, "optimise.populatoin: populatoin is unknown"),
    ("[optimise]", "[optimise]\ngrowth = 2.0", 17, "optimise.growth: 2.0 is not allowed; allowed: a number from 0"),
])  # fmt: skip
def test_a_wrong_table_is_refused_with_line_and_key(old: str, new: str, line: int, words: str, tmp_path: Path) -> None:
    path = tmp_path / "s.toml"
    path.write_text(STUDY.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(GivewayError) as caught:
        study_file.read(path, search=True)
    assert str(caught.value).startswith(f"{path}:{line}: ")
    assert words in str(caught.value)


def test_a_search_needs_an_objective_and_something_that_varies(tmp_path: Path) -> None:
    with pytest.raises(GivewayError, match=r"designs\.kind: optimised .* at least one \[\[vary\]\] or \[\[parts\]\]"):
        small_study(vary=[]).optimise(tmp_path / "s")
    with pytest.raises(GivewayError, match=r"objective: nothing .* \[\[objective\]\]"):
        small_study().optimise(tmp_path / "s")
    assert not (tmp_path / "s").exists()


def test_more_designs_than_the_disk_holds_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from giveway.study import engine

    (tmp_path / "s.toml").write_text(STUDY, encoding="utf-8")
    monkeypatch.setattr(engine.shutil, "disk_usage", lambda _: SimpleNamespace(free=900))
    with pytest.raises(GivewayError, match=r"s\.toml:17: optimise\.designs: 3000 runs .* free space"):
        optimise(study_file.read(tmp_path / "s.toml", search=True), tmp_path / "s")
    assert not (tmp_path / "s").exists()


def test_a_sweep_of_designs_that_are_searched_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "s.toml"
    path.write_text(STUDY + '[designs]\nkind = "optimised"\n', encoding="utf-8")
    with pytest.raises(GivewayError, match=r"s\.toml:21: designs\.kind: optimised .* `giveway optimise`"):
        plan_runs(study_file.read(path))


def test_a_missing_extra_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "s.toml").write_text(STUDY, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, "pymoo", None)
    for arguments in (["optimise", "s.toml"], ["optimise", "s.toml", "--check"]):
        assert _main(arguments) == 2
        said = capsys.readouterr().err
        assert said == "giveway: pymoo is not installed; `pip install 'giveway[optimise]'` installs it\n"
    assert [path.name for path in tmp_path.iterdir()] == ["s.toml"]


def test_what_an_extra_lacks_itself_is_not_taken_for_the_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "half_there.py").write_text("import nowhere_at_all\n", encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(ModuleNotFoundError, match="nowhere_at_all"):
        extra("half_there", "optimise")
    with pytest.raises(MissingExtraError, match=r"not_there is not installed; `pip install 'giveway\[x\]'`"):
        extra("not_there", "x")


def test_ctrl_c_keeps_what_is_stored_and_the_same_command_goes_on(tmp_path: Path) -> None:
    (tmp_path / "s.toml").write_text("part_runs = 5\n" + STUDY, encoding="utf-8")
    _, said = interrupt(tmp_path, ["optimise", "s.toml", "--out", "s"], parts=8)
    assert "`giveway optimise s.toml --out s` goes on from there" in said
    assert len(stored_runs(tmp_path / "s")["run"]) >= 40
    assert not read_manifest(tmp_path / "s")["complete"]


def test_ctrl_c_between_two_generations_is_answered_alike(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def pressed(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(optimum, "optimise", pressed)
    (tmp_path / "s.toml").write_text(STUDY, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert _main(["optimise", "s.toml", "--out", "s"]) == 130
    assert "`giveway optimise s.toml --out s` goes on from there" in capsys.readouterr().err


def test_at_the_command_line_it_says_why_it_ended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    text = STUDY.replace("3000", "24").replace("population = 30", "population = 8")
    (tmp_path / "s.toml").write_text(text + "[report]\nchosen = 0\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert _main(["optimise", "s.toml", "--check"]) == 0
    assert "at most 24 designs, 8 in a generation, 1 run each" in capsys.readouterr().out
    assert not (tmp_path / "out").exists()
    assert _main(["optimise", "s.toml"]) == 0
    said = capsys.readouterr().out
    assert "The search ended: 24 designs, as many as were asked for." in said
    assert (tmp_path / "out" / "optima" / "s" / "report.html").is_file()
    assert _main(["study", "export", "out/optima/s", "--design", "0", "--out", "d.toml"]) == 0


def test_the_examples_can_be_searched() -> None:
    for path in sorted((Path(__file__).parents[2] / "examples" / "studies").glob("*.toml")):
        setup = study_file.read(path, search=True)
        assert setup.plan.kind == "optimised"
        assert setup.plan.count == setup.search.designs
