"""`giveway reproduce`: order, table, JSON and report; failures and Ctrl-C cost only what they hit."""

from __future__ import annotations

import json
import math
import os
import re
import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from cosim_helpers import Cli
from giveway import experiments
from giveway.base.errors import GivewayError, UnknownNameError
from giveway.experiments import Experiment
from giveway.experiments.reproduction import findings as findings_module
from giveway.experiments.reproduction.findings import Effort, Findings, Picture, Row, Target
from giveway.experiments.reproduction.page import render
from giveway.experiments.reproduction.reproduce import chosen, reproduce, table_rows, write_table
from giveway.paper.matched import matched
from giveway.paper.printed import printed
from matplotlib.figure import Figure
from page_arrays import data_of

Registry = Callable[..., None]


@pytest.fixture
def registry(monkeypatch: pytest.MonkeyPatch) -> Registry:
    """Put experiments of the test's own in the place of the real ones."""

    def put(*entries: Experiment) -> None:
        monkeypatch.setattr(experiments, "all_experiments", lambda: {entry.name: entry for entry in entries})

    return put


def findings(effort: Effort) -> Findings:
    effort.progress(0.5)
    figure = Figure(figsize=(4.0, 2.0))
    figure.subplots().plot([0, 1], [0, effort.pick(2, 1)])
    rows = (
        Row("detection time, spring", 101.0, "ms", "fitted", printed("detection, spring"), Target.around(95.0, 10.0)),
        Row("plateau", 0.95, "1", "fitted", printed("plateau, no bumper"), Target(0.7, 0.9), "k_b would be 2 N/m", 2),
        Row("noticed", 1.0, "1", "computed", "each", Target(minimum=1.0)),
        Row("seen", math.nan, "m", "computed"),
    )
    pictures = (Picture("force", "A figure", "What <to> look for", figure, (("detection, spring", "95 ms"),)),)
    return Findings(rows, pictures, ("Nothing else.",))


def broken(_effort: Effort) -> Findings:
    raise ZeroDivisionError("no wheels")


def refused(_effort: Effort) -> Findings:
    raise GivewayError("slider.mass", -1.0, "above 0")


def interrupted(_effort: Effort) -> Findings:
    os.kill(os.getpid(), signal.SIGINT)
    return Findings(())


FIRST = Experiment("first", "The first one.", section="5.2", reproduce=findings)
EARLIER = Experiment("earlier", "In an earlier section.", section="4.2", reproduce=findings)
EXTRA = Experiment("extra", "Not in the paper.", reproduce=findings)
BROKEN = Experiment("broken", "Raises.", section="5.1", reproduce=broken)
REFUSED = Experiment("refused", "Is refused.", section="5.3", reproduce=refused)
CUT = Experiment("cut", "Ctrl-C comes.", section="5.25", reproduce=interrupted)
SINGLE = Experiment("single", "Has no part.", section="1")


def test_a_target_in_words_and_its_edges() -> None:
    around = Target.around(45.0, 10.0)
    assert around.text == "45 ± 10"
    assert [around.met(value) for value in (34.9, 35.0, 55.0, 55.1, None)] == [False, True, True, False, False]
    assert Target(minimum=0.95).text == "at least 0.95"
    assert Target(0.7, 0.9).text == "at least 0.7 and at most 0.9"
    with pytest.raises(GivewayError, match=r"minimum.*2.*at most the maximum, 1"):
        Target(2.0, 1.0)


def test_a_row_says_how_its_number_came_about() -> None:
    with pytest.raises(GivewayError, match=r"guessed.*fitted"):
        Row("x", 1.0, "m", "guessed")
    assert Row("x", math.inf, "m", "given").ours is None
    assert Row("x", None, "m", "given", target=Target(0.0)).met is False


def test_a_row_s_class_comes_from_what_was_fitted(monkeypatch: pytest.MonkeyPatch) -> None:
    target = Target.around(100.0, 10.0)
    fitted = Row("x", 101.0, "ms", "computed", printed("detection, spring"), target)
    predicted = Row("x", 101.0, "ms", "fitted", printed("plateau, no bumper"), target)
    assert (fitted.kind, predicted.kind) == ("fitted", "predicted")  # whatever the provenance of ours
    assert Row("x", 1.0, "1", "fitted", "about as much", target).kind == "own requirement"
    assert Row("x", 1.0, "1", "fitted", target=target).kind == "own requirement"
    assert Row("x", 1.0, "1", "fitted").kind == ""
    # A number that the fit takes up, or drops, changes the class of its rows, and nothing else has to.
    planted = {name: how for name, how in matched().items() if name != "detection, spring"}
    planted["plateau, no bumper"] = ("giveway fit",)
    monkeypatch.setattr(findings_module, "matched", lambda: planted)
    assert (fitted.kind, predicted.kind) == ("predicted", "fitted")


def test_a_number_of_the_paper_has_a_target_and_stands_in_the_list() -> None:
    with pytest.raises(GivewayError, match=r"x: target: None is not allowed; allowed: one for the paper's 95 ms"):
        Row("x", 1.0, "ms", "fitted", printed("detection, spring"))
    with pytest.raises(GivewayError, match=r"x: paper: 95.0 is not allowed"):
        Row("x", 1.0, "ms", "fitted", 95.0, Target(0.0))  # type: ignore[arg-type]
    with pytest.raises(UnknownNameError, match=r"detection, sprung.*did you mean detection, spring"):
        printed("detection, sprung")


def test_the_papers_number_is_shown_in_words_where_the_row_has_another_unit() -> None:
    other = Row("x", 5.0, "% of groups", "assumed", printed("direction error, largest of four pushes"), Target(0.0))
    assert other.papers == "12 deg"
    assert Row("x", 5.0, "deg", "assumed", other.paper, Target(0.0)).papers == 12.0


def test_the_order_is_the_papers(registry: Registry) -> None:
    registry(EXTRA, FIRST, EARLIER, SINGLE)
    assert [entry.name for entry in chosen()] == ["earlier", "first", "extra"]
    assert [entry.name for entry in chosen(["extra", "earlier"])] == ["earlier", "extra"]
    with pytest.raises(UnknownNameError, match=r"--only: singel is unknown.*earlier, extra, first"):
        chosen(["singel"])


def test_the_table_and_its_json(registry: Registry, tmp_path: Path) -> None:
    registry(FIRST)
    told: list[tuple[str, float]] = []
    found = reproduce(full=False, progress=lambda name, share: told.append((name, share)))
    assert told == [("first", 0.0), ("first", 0.5), ("first", 1.0)]
    assert found.summary() == ["predicted: 0 met of 1", "fitted: 1 met of 1", "own requirements: 1 met of 1"]
    assert not found.failed
    assert table_rows(found) == [
        ("5.2 first", "detection time, spring", "95.0", "101.0", "ms", "95 ± 10", "yes", "fitted", "fitted"),
        ("5.2 first", "plateau", "about 50", "0.95", "", "at least 0.7 and at most 0.9", "MISS", "predicted", "fitted"),
        ("5.2 first", "noticed", "each", "1.0", "", "at least 1", "yes", "own requirement", "computed"),
        ("5.2 first", "seen", "-", "-", "m", "", "", "", "computed"),
    ]  # fmt: skip
    write_table(tmp_path / "table.json", found)
    table = json.loads((tmp_path / "table.json").read_text(encoding="utf-8"))
    assert table["schema_version"] == 1
    assert table["rows"][1] == {
        "experiment": "first",
        "quantity": "plateau",
        "paper": "about 50",
        "ours": 0.95,
        "unit": "1",
        "target": "at least 0.7 and at most 0.9",
        "met": False,
        "class": "predicted",
        "provenance": "fitted",
        "reason": "k_b would be 2 N/m",
    }
    assert table["rows"][0]["paper"] == 95.0
    assert table["counts"] == {
        "predicted": {"met": 0, "missed": 1},
        "fitted": {"met": 1, "missed": 0},
        "own requirement": {"met": 1, "missed": 0},
    }
    assert table["manifest"]["effort"] == "reduced"


def test_a_failure_costs_only_its_own_experiment(registry: Registry) -> None:
    registry(EARLIER, BROKEN, FIRST, REFUSED)
    found = reproduce()
    assert [bool(chapter.failure) for chapter in found.chapters] == [False, True, False, True]
    assert re.fullmatch(r"ZeroDivisionError in test_reproduction.py:\d+: no wheels", found.chapters[1].failure)
    assert "slider.mass: -1.0 is not allowed" in found.chapters[3].failure
    assert found.failed
    assert "failed: ZeroDivisionError" in render(found)


def test_ctrl_c_keeps_what_was_found(registry: Registry) -> None:
    registry(EARLIER, CUT, FIRST, EXTRA)
    handler = signal.getsignal(signal.SIGINT)
    found = reproduce()
    assert signal.getsignal(signal.SIGINT) is handler
    assert [chapter.experiment.name for chapter in found.chapters] == ["earlier", "first"]
    assert found.interrupted == ["cut", "extra"]
    assert "Not run: cut, extra" in render(found)


def test_ctrl_c_that_is_ignored_stays_ignored(registry: Registry) -> None:
    registry(CUT, FIRST)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    found = reproduce()
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    assert found.interrupted == []
    assert len(found.chapters) == 2


def test_the_report_stands_alone_and_shows_the_paper_beside_the_figure(registry: Registry) -> None:
    registry(FIRST, EARLIER)
    page = render(reproduce())
    assert not re.search(r"url\((?!#)|@import|https?://(?!www\.w3\.org)", page)
    ids = re.findall(r'\sid="([^"]*)"', page)
    assert len(ids) == len(set(ids))
    assert page.count('class="drawn"') == len(data_of(page)["figures"]) == 2
    assert "What &lt;to&gt; look for" in page
    assert "<dt>detection, spring</dt><dd>95 ms</dd>" in page
    assert "k_b would be 2 N/m" in page
    assert "fitted (" in page  # the parameter set by provenance
    assert "<strong>predicted: 0 met of 2</strong>" in page
    assert "<strong>own requirements: 2 met of 2</strong>" in page
    assert "the same event as the detection after 45 ms" in page  # what no row judges


def test_wrong_input_is_refused_before_anything_runs(process: Cli, tmp_path: Path) -> None:
    done = process("reproduce", "--only", "motionles")
    assert done.returncode == 2
    assert "--only: motionles is unknown" in done.stderr
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "letter.txt").write_text("dear", encoding="utf-8")
    done = process("reproduce", "--reduced", "--out", "full")
    assert done.returncode == 2
    assert "is not empty and holds no giveway result" in done.stderr
    with pytest.raises(GivewayError, match=r"threads: 0 is not allowed; allowed: 1 to 256"):
        reproduce(threads=0)
