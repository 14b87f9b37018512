"""In Python: the same files as from the command, every answer as a table, a traced run of any design in one call."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from giveway.base.errors import GivewayError
from giveway.cli import _main
from giveway.study.answers import Answers
from giveway.study.limits import margins_of
from study_helpers import LATCH, SPRING, judged_study, stored_runs

CREATED = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\+00:00")


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> Answers:
    """Of eight designs with two hits each, at nominal values and with one tolerance sample."""
    study = judged_study().vary(SPRING, values=[0.6, 2.4], unit="N/mm")
    study.collision("slow", speed=0.3, mass=9.08, edge=1, time=0.12).tolerance(LATCH, relative=0.3)
    study.tolerances(samples=1).objective("peak force of the run").objective("bumper compression")
    study.constraint("bumper compression", maximum=3.0, unit="cm")
    return study.run(tmp_path_factory.mktemp("frames"), progress=False)


def test_python_writes_the_files_of_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    study = judged_study().objective("peak force of the run").report(chosen=1)
    found = study.run(tmp_path / "study", files=True)
    assert {"[1 of 2] chosen designs", "[2 of 2] report"} <= set(capsys.readouterr().err.splitlines())
    mine = {name: (tmp_path / "study" / name).read_text(encoding="utf-8") for name in ("report.html", "table.csv")}
    assert f"design {found.order[0]}" in mine["report.html"]
    assert "Chosen designs" in mine["report.html"]
    traces = tmp_path / "study" / "chosen" / f"design-{found.order[0]}" / "front" / "traces.parquet"
    assert traces.is_file()
    assert _main(["study", "show", str(tmp_path / "study")]) == 0  # without traces, which it does not make
    theirs = {name: (tmp_path / "study" / name).read_text(encoding="utf-8") for name in mine}
    assert theirs["table.csv"] == mine["table.csv"]
    of_both = [CREATED.sub("", text[: text.index("Trade-off" if "Trade-off" in text else "What each")])
               for text in (mine["report.html"], theirs["report.html"])]  # fmt: skip
    assert of_both[0] == of_both[1]


def test_without_files_nothing_but_the_runs_is_written(tmp_path: Path) -> None:
    judged_study().run(tmp_path / "study", files=False, progress=False)
    assert {path.name for path in (tmp_path / "study").iterdir()} == {"manifest.json", "parts", ".lock"}


def test_the_ranking_is_a_frame_in_the_user_s_units(answers: Answers) -> None:
    frame = answers.ranking()
    assert frame.index.tolist() == answers.order.tolist()
    assert set(frame["testbed.bumper.spring_rate [N/mm]"]) <= {0.6, 2.4}
    (name,) = [name for name in frame.columns if name.startswith("bumper compression")]
    assert name.endswith("[cm]")
    np.testing.assert_allclose(frame[name], 0.1 * answers.values[answers.order, 1])
    assert frame["pareto"].tolist() == answers.pareto[answers.order].tolist()


def test_margins_recommendation_and_misfits_are_frames(answers: Answers) -> None:
    (margin,) = margins_of(answers, int(answers.order[0]))
    frame = answers.margins()
    assert frame.loc[0, ["value", "at", "margin", "unit"]].tolist() == [margin.value, 3.0, margin.room, "cm"]
    worst = int(np.argmax(answers.values[:, 1]))
    assert answers.margins(worst).loc[0, "margin"] < 0.0
    assert answers.recommendation().loc[0, "text"] == f"Recommended: design {answers.order[0]}"
    assert answers.misfits().empty
    columns = ["goal", "quantity", "main", "total", "interval", "total_interval", "telling"]
    assert list(answers.sensitivities().table().columns) == columns


def test_every_stored_run_has_its_place(answers: Answers) -> None:
    runs = stored_runs(answers.folder)
    found = answers.every_run("peak force of the run", "force at detection (error)")
    peak = found["peak force of the run"]
    assert (peak.dims, peak.attrs["units"]) == (("design", "sample", "collision"), "N")
    for index in (0, 5, 31):
        at = {name: int(runs[column][index]) for name, column in (("design", "design"), ("sample", "tolerance sample"))}
        assert float(peak.sel(**at, collision=runs["collision"][index])) == runs["peak force of the run"][index]
    assert found["force at detection (error)"].shape == (8, 2, 2)
    everything = answers.every_run()
    assert {"detection time", "force at detection (true)", "lasting force"} <= set(everything)
    assert "servo gain margin" not in everything  # this study did not ask for it
    with pytest.raises(GivewayError, match="metrics: peak forse"):
        answers.every_run("peak forse")


def test_a_design_is_traced_in_one_call(answers: Answers) -> None:
    runs = stored_runs(answers.folder)
    result = answers.trace(3, collision="slow", sample=1)
    (where,) = np.flatnonzero((runs["design"] == 3) & (runs["tolerance sample"] == 1) & (runs["collision"] == "slow"))
    assert result.metric("peak force of the run").value == pytest.approx(runs["peak force of the run"][where], rel=1e-9)
    force = result.traces["testbed.truth.contact_force"]
    assert float(force.max()) <= runs["peak force of the run"][where] * (1.0 + 1e-9)
    best = answers.trace()
    (where,) = np.flatnonzero(
        (runs["design"] == answers.order[0]) & (runs["tolerance sample"] == 0) & (runs["collision"] == "front")
    )
    assert best.metric("peak force of the run").value == pytest.approx(runs["peak force of the run"][where], rel=1e-9)


@pytest.mark.parametrize(("arguments", "words"), [
    ({"design": 8}, "--design: 8 is not allowed"),
    ({"collision": "slwo"}, "collision: slwo"),
    ({"sample": 2}, "sample: 2 is not allowed"),
])  # fmt: skip
def test_what_is_not_there_cannot_be_traced(answers: Answers, arguments: dict[str, object], words: str) -> None:
    with pytest.raises(GivewayError, match=words):
        answers.trace(**arguments)  # type: ignore[arg-type]


def test_without_an_allowed_design_a_number_is_asked_for(tmp_path: Path) -> None:
    found = judged_study().objective("peak force of the run").constraint("peak force of the run", maximum=1.0)
    with pytest.raises(GivewayError, match="no design meets all constraints"):
        found.run(tmp_path / "study", progress=False).margins()
