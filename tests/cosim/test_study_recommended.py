"""The recommended design: its margins, what limits it, what comes next; and what is said if no design is allowed."""

from __future__ import annotations

import html
from pathlib import Path

import numpy as np
import pytest
from giveway.cli import _main
from giveway.study import Study
from giveway.study.advice import _percent, advice
from giveway.study.limits import limit_words, margins_of
from giveway.study.recommended import nearest, recommended
from giveway.study.report import write_report
from giveway.study.tables import counts
from study_helpers import LATCH, SPRING, judged_study, stored_runs

CATALOGUE = """name,maker,price [EUR],rate [N/mm]
soft,Made Up,3,0.6
hard,Made Up,2,2.4
"""


def compressing(maximum: float) -> Study:
    """The more compression the better, up to so many cm."""
    study = judged_study().vary(SPRING, values=[0.6, 1.2, 2.4], unit="N/mm")
    study.objective("bumper compression", goal="maximise")
    return study.constraint("bumper compression", maximum=maximum, unit="cm")


def test_margins_are_those_of_the_stored_runs_in_the_user_s_unit(tmp_path: Path) -> None:
    study = compressing(4.0).constraint("peak force of the run", minimum=0.02, unit="kN")
    study.tolerance(LATCH, relative=0.3).tolerances(kind="corners")
    found = study.run(tmp_path / "study", progress=False)
    runs = stored_runs(tmp_path / "study")
    design = int(found.order[0])
    travel = runs["bumper compression"].reshape(12, -1)[design].max()  # mm
    force = runs["peak force of the run"].reshape(12, -1)[design].min()  # N
    first, second = margins_of(found, design)
    assert (first.value, first.room) == pytest.approx((0.1 * travel, 4.0 - 0.1 * travel), rel=1e-12)
    assert first.share == pytest.approx((40.0 - travel) / 40.0, rel=1e-12)
    assert (second.value, second.room) == pytest.approx((1e-3 * force, 1e-3 * force - 0.02), rel=1e-12)
    assert (first.allowed, second.allowed) == ("at most 4 cm", "at least 0.02 kN")
    assert min(first.room, second.room) > 0.0


def test_the_limit_that_keeps_better_designs_out_is_named(tmp_path: Path) -> None:
    found = compressing(3.4).run(tmp_path / "study", progress=False)
    travel = stored_runs(tmp_path / "study")["bumper compression"]
    told = recommended(found)
    assert told is not None
    assert told.design == np.argmax(np.where(travel <= 34.0, travel, 0.0))
    assert told.tempting == np.argmin(np.where(travel > 34.0, travel, np.inf))
    assert (told.broken, told.barred) == ((0,), (travel > 34.0).sum())
    words = dict(advice(found).lines)
    assert words["limited by"].startswith("bumper compression, at most 3.4 cm: ")
    assert f"design {told.tempting}: gains: bumper compression " in words["limited by"]


def test_where_no_limit_keeps_a_better_design_out_the_range_does(tmp_path: Path) -> None:
    found = compressing(30.0).run(tmp_path / "study", progress=False)
    told = recommended(found)
    assert told is not None
    assert told.tempting is None
    said = [text for name, text in advice(found).lines if name == "limited by"]
    assert said[0].startswith("no constraint")
    assert "the lowest testbed.bumper.spring_rate of this study, 0.6 N/mm" in said
    assert "on the front" not in said[0]  # it is alone


def test_others_on_the_front_are_counted(tmp_path: Path) -> None:
    study = compressing(30.0).objective("peak force of the run", goal="maximise")
    found = study.run(tmp_path / "study", progress=False)
    others = found.pareto.sum() - 1
    assert others > 1
    said = dict(advice(found).lines[::-1])["limited by"]
    assert said.endswith(f"; {others} designs on the front are better in some of them")


def test_the_next_best_says_what_it_loses_and_the_next_with_other_parts(tmp_path: Path) -> None:
    (tmp_path / "springs.csv").write_text(CATALOGUE, encoding="utf-8")
    study = judged_study().parts("spring", tmp_path / "springs.csv", sets={SPRING: "rate"})
    found = study.objective("peak force of the run").run(tmp_path / "study", progress=False)
    told = recommended(found)
    assert told is not None
    parts = found.designs[:, 0]
    others = [int(design) for design in found.order if parts[design] != parts[told.design]]
    assert told.following == tuple(dict.fromkeys([int(found.order[1]), others[0]]))
    words = dict(advice(found).lines)
    assert words["spring"] == ("soft (Made Up, 3 EUR)" if parts[told.design] == 0 else "hard (Made Up, 2 EUR)")
    second, best = found.values[told.following[0], 0], found.values[told.design, 0]
    assert f"loses: peak force of the run {second:.4g} instead of {best:.4g} N" in words["next best"]


def test_if_no_design_is_allowed_the_nearest_is_named_and_what_it_misses(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    study = compressing(2.0).constraint("peak force of the run", maximum=10.0)
    found = study.run(tmp_path / "study", progress=False)
    runs = stored_runs(tmp_path / "study")
    beyond = np.stack([runs["bumper compression"] / 20.0, runs["peak force of the run"] / 10.0]) - 1.0
    near = nearest(found)
    assert near is not None
    assert recommended(found) is None
    assert near.design == np.argmin(np.maximum(beyond, 0.0).max(axis=0))
    assert near.worst == np.argmax(beyond[:, near.design])
    assert near.never == tuple((i, int(np.argmin(beyond[i]))) for i in (0, 1) if (beyond[i] > 0.0).all())
    assert (1, int(np.argmin(beyond[1]))) in near.never
    assert _main(["study", "show", str(tmp_path / "study")]) == 0
    said = capsys.readouterr().out
    assert said.splitlines()[0].strip() == "No design meets all constraints"
    share = 100.0 * beyond[near.worst, near.design]
    assert f"is missed by {10.0 * share / 100.0 if near.worst else 2.0 * share / 100.0:.4g}" in said
    assert f"({share:.3g} %)" in said


def test_terminal_and_report_begin_with_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = compressing(3.0).run(tmp_path / "study", progress=False)
    assert _main(["study", "show", str(tmp_path / "study")]) == 0
    said, first = capsys.readouterr().out, advice(found)
    assert said.splitlines()[0].strip() == first.title == f"Recommended: design {found.order[0]}"
    write_report(tmp_path / "report.html", found)
    page = html.unescape((tmp_path / "report.html").read_text(encoding="utf-8"))
    assert page.index(f"<h2>{first.title}</h2>") < page.index("<h2>The best designs</h2>")
    for _, text in first.lines:
        assert text in said
        assert f"<td>{text}</td>" in page
    for cell in first.margins[0]:
        assert cell in said


def test_limits_of_a_body_region_have_its_name() -> None:
    study = judged_study()
    study.document["scenario"]["judge_as"] = "lower leg"
    study.constraint("transient force", maximum="transient limit").constraint("lasting force", maximum=0.1, unit="kN")
    setup = study.setup()
    limit = setup.constraints[0].maximum
    assert limit_words(setup, 0) == f"at most {limit:g} N (transient limit of lower leg)"
    assert limit_words(setup, 1) == "at most 0.1 kN"


def test_without_objectives_nothing_is_recommended(tmp_path: Path) -> None:
    found = judged_study().run(tmp_path / "study", progress=False)
    assert recommended(found) is None
    assert "no objective" in advice(found).lines[0][1]


# ---- runs that end too early


def test_what_is_cut_off_is_not_recommended_but_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A soft spring looks gentle until its run is long enough."""
    ended = judged_study(vary=[]).vary(SPRING, values=[0.3, 10.0], unit="N/mm")
    ended.document["scenario"]["duration"] = 0.35
    found = ended.objective("bumper compression").run(tmp_path / "ended", progress=False)
    assert found.cut_off.tolist() == [True, False]
    assert found.values[0, 0] > found.values[1, 0]
    assert found.order.tolist() == [1]
    told = advice(found)
    assert told.title == "Recommended: design 1"
    assert dict(told.lines)["cut off"].startswith("1 design (0) cannot be judged: a run ended before its contact")
    assert dict(told.lines)["cut off"].endswith("give scenario.duration more than 0.35 s")
    assert "1 cut off by the end of their runs" in counts(found)
    ended.document["scenario"]["duration"] = 0.2
    found = ended.run(tmp_path / "all ended", progress=False)
    assert not len(found.order)
    assert advice(found).title == "No design is recommended"
    assert _main(["study", "show", str(tmp_path / "all ended")]) == 0
    assert "2 designs (0, 1) cannot be judged" in " ".join(capsys.readouterr().out.split())
    assert _main(["study", "evidence", str(tmp_path / "all ended")]) == 2
    assert "some are cut off" in capsys.readouterr().err
    ended.document["scenario"]["duration"] = 0.9
    whole = ended.run(tmp_path / "whole", progress=False)
    assert not whole.cut_off.any()
    assert len(whole.order) == 2
    assert whole.values[0, 0] > 1.5 * found.values[0, 0]


def test_a_search_does_not_judge_what_is_cut_off(tmp_path: Path) -> None:
    study = judged_study(vary=[], method="fixed-step").vary(SPRING, low=0.3, high=20.0, unit="N/mm")
    study.document["scenario"]["duration"] = 0.35
    study.objective("peak force of the run").sure(probability=False)
    found = study.optimise(tmp_path / "search", designs=24, progress=False)
    soft, stiff = found.designs[found.cut_off, 0], found.designs[~found.cut_off, 0]
    assert 0 < len(soft) < 24
    assert soft.max() < stiff.min()
    told = found.manifest["optimum"]
    assert told["hypervolume"][-1] > 0.0
    assert told["reference"][0] > found.values[~found.cut_off, 0].max()


def test_what_no_contact_decides_is_judged_all_the_same(tmp_path: Path) -> None:
    study = judged_study().objective("detection time")
    study.document["scenario"]["duration"] = 0.2
    found = study.run(tmp_path / "study", progress=False)
    assert "contact cut off" in found.warning_text(0)
    assert not found.cut_off.any()
    assert len(found.order) == 4


# ---- what decides nothing


def test_the_end_of_a_range_that_decides_nothing_limits_nothing(tmp_path: Path) -> None:
    study = judged_study(vary=[]).vary("bumper", values=["none", "spring"]).vary(SPRING, values=[0.6, 1.2], unit="N/mm")
    found = study.objective("detection time").run(tmp_path / "study", progress=False)
    told = recommended(found)
    assert told is not None
    assert found.designs[told.design, 0] == 0.0  # without a bumper it is felt sooner
    assert found.designs[told.design, 1] == 600.0
    assert told.ends == ()
    assert "limited by" not in dict(advice(found).lines)


def test_equal_designs_on_the_front_are_not_called_better(tmp_path: Path) -> None:
    study = judged_study(vary=[]).vary("testbed.bumper.travel", values=[0.1, 0.11, 0.12])
    study.objective("peak force of the run").constraint("bumper compression", maximum=9.0, unit="cm")
    found = study.run(tmp_path / "study", progress=False)
    assert found.pareto.tolist() == [True] * 3
    said = [text for name, text in advice(found).lines if name == "limited by"]
    assert said[0].endswith("better in all objectives; 2 designs on the front are equal in all of them")


def test_a_change_has_all_digits_before_the_point() -> None:
    assert [_percent(share) for share in (0.0123, -3.456, 99.4, 99.6, -1234.5)] == [
        "+0.012 %", "-3.5 %", "+99 %", "+100 %", "-1,234 %",
    ]  # fmt: skip
