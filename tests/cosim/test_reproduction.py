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
from giveway.experiments.reproduction.findings import Effort, Findings, Picture, Row, Target
from giveway.experiments.reproduction.page import render
from giveway.experiments.reproduction.reproduce import chosen, reproduce, table_rows, write_table
from matplotlib.figure import Figure

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
        Row("detection time, spring", 101.0, "ms", "fitted", 95.0, Target.around(95.0, 10.0)),
        Row(
            "peak torque, spring to none", 0.95, "1", "fitted", "about -20 %", Target(0.7, 0.9), "k_b would be 2 N/m", 2
        ),
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
    assert (found.count(True), found.count(False), found.failed) == (1, 1, False)
    assert table_rows(found) == [
        ("5.2 first", "detection time, spring", "95.0", "101.0", "ms", "95 ± 10", "yes", "fitted"),
        ("5.2 first", "peak torque, spring to none", "about -20 %", "0.95", "", "at least 0.7 and at most 0.9", "MISS",
         "fitted"),
        ("5.2 first", "seen", "-", "-", "m", "", "", "computed"),
    ]  # fmt: skip
    write_table(tmp_path / "table.json", found)
    table = json.loads((tmp_path / "table.json").read_text(encoding="utf-8"))
    assert table["schema_version"] == 1
    assert table["rows"][1] == {
        "experiment": "first",
        "quantity": "peak torque, spring to none",
        "paper": "about -20 %",
        "ours": 0.95,
        "unit": "1",
        "target": "at least 0.7 and at most 0.9",
        "met": False,
        "provenance": "fitted",
        "reason": "k_b would be 2 N/m",
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
    assert not re.search(r"url\((?!#)|@import|https?://", page)
    ids = re.findall(r'\sid="([^"]*)"', page)
    assert len(ids) == len(set(ids))
    assert page.count("<svg") == 2
    assert "What &lt;to&gt; look for" in page
    assert "<dt>detection, spring</dt><dd>95 ms</dd>" in page
    assert "k_b would be 2 N/m" in page
    assert "fitted (" in page  # the parameter set by provenance


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
