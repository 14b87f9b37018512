"""Two studies side by side: what differs in what was asked, both recommendations, and their margins."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from giveway.cli import _main
from giveway.study import Study, certainty, sure
from giveway.study.answers import Answers
from giveway.study.compare import compare
from giveway.study.limits import margins_of
from study_helpers import SPRING, judged_study


def limited(maximum: float, **changes: object) -> Study:
    study = judged_study(**changes).vary(SPRING, values=[0.6, 2.4], unit="N/mm")
    study.objective("peak force of the run")
    return study.constraint("bumper compression", maximum=maximum, unit="cm")


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> tuple[Answers, Answers]:
    folder = tmp_path_factory.mktemp("compared")
    first = limited(6.0).run(folder / "a", progress=False)
    second = limited(2.6, name="other").tolerance("testbed.bumper.travel", relative=0.1).tolerances(samples=1)
    return first, second.run(folder / "b", progress=False)


def test_only_what_was_asked_otherwise_is_told(both: tuple[Answers, Answers]) -> None:
    asked = {name: (a, b) for name, a, b in compare(*both).asked}
    assert asked == {
        "constraint": ("bumper compression: at most 6 cm", "bumper compression: at most 2.6 cm"),
        "tolerances": ("-", "1 samples, sobol"),
        "tolerance of testbed.bumper.travel": ("-", "+-10 %, uniform"),
        "robots": (
            "-",
            "one of its own in every tolerance sample, drawn as for `giveway crowd`; its controller keeps the file",
        ),
    }
    assert compare(both[0], both[0]).asked == []


def test_designs_and_margins_are_side_by_side(
    both: tuple[Answers, Answers], capsys: pytest.CaptureFixture[str]
) -> None:
    a, b = both
    found = compare(a, b)
    assert found.designs == (int(a.order[0]), int(b.order[0]))
    assert _main(["study", "compare", str(a.folder), str(b.folder), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert [one["design"] for one in document["studies"]] == list(found.designs)
    margins = {one["name"]: one for one in document["margins"]}
    for side, answers in (("A", a), ("B", b)):
        (margin,) = margins_of(answers, int(answers.order[0]))
        its = next(one[side] for one in margins.values() if one[side] is not None)
        assert (its["margin"], its["limit"], its["unit"]) == (margin.room, margin.limit, "cm")
        assert its["share"] == pytest.approx(margin.room / margin.limit)
    assert _main(["study", "compare", str(a.folder), str(b.folder)]) == 0
    said = capsys.readouterr().out
    for answers in both:
        (margin,) = margins_of(answers, int(answers.order[0]))
        assert f"{100.0 * margin.room / margin.limit:.3g}" in said.split()
    for words in ("other", "at most 6 cm", "at most 2.6 cm", f"Recommended: design {b.order[0]}"):
        assert words in said
    peaks = [one.values[one.order[0], 0] for one in both]
    rows = {row[0]: row for row in compare(a, a).recommended}
    assert rows["peak force of the run"][1:] == (f"{peaks[0]:.4g} N", f"{peaks[0]:.4g} N", "+0 %")
    assert list(found.table().columns) == ["A", "B"]


def test_the_change_is_known_across_units(both: tuple[Answers, Answers], tmp_path: Path) -> None:
    in_kn = limited(2.6).constraint("peak force of the run", maximum=1.0, unit="kN")
    found = compare(both[0], in_kn.run(tmp_path / "kn", progress=False))
    (name, a, b, change) = next(row for row in found.recommended if row[0] == "peak force of the run")
    old, new = float(a.removesuffix(" N")), 1e3 * float(b.removesuffix(" kN"))
    assert float(change.removesuffix(" %")) == pytest.approx(100.0 * (new - old) / old, abs=0.1), name


def test_a_study_that_allows_nothing_is_compared_by_its_nearest(both: tuple[Answers, Answers], tmp_path: Path) -> None:
    nothing = limited(0.1).run(tmp_path / "nothing", progress=False)
    found = compare(both[0], nothing)
    assert found.designs[1] is None
    assert "No design meets all constraints: design " in found.titles[1]
    (_, _, margin), *_ = found.margins
    assert margin is not None
    assert margin.room < 0.0


def test_a_folder_without_a_study_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert _main(["study", "compare", str(tmp_path), str(tmp_path)]) == 2
    assert "giveway sweep" in capsys.readouterr().err


def test_what_is_known_of_the_probability_is_side_by_side(both: tuple[Answers, Answers]) -> None:
    a, b = both
    design = int(b.order[0])
    found = sure.probability(b, design, sure.plan_with(b.setup.sure, 1000, "plain"))
    rows = {name: texts for name, *texts in compare(a, b).recommended}
    assert rows["P(a limit is exceeded)"] == ["-", certainty.probability_words(found), ""]
