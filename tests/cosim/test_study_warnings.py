"""Studies: what happened otherwise than asked stands in the stored runs, the table, the export and the report."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest
from cosim_helpers import Cli
from giveway import batch
from giveway.simulation.run_warnings import MEANINGS
from giveway.study.answers import Answers
from giveway.study.chosen import scenario_of_run
from giveway.study.export import export_table
from giveway.study.report import write_report
from giveway.study.tables import counts, design_rows, goal_header
from study_helpers import judged_study, stored_runs

TRAVEL = "testbed.bumper.travel"


def bottoming(folder: Path) -> Answers:
    """Bumpers of 5 and 120 mm: the short one is pressed into its stop; each is hit twice."""
    study = judged_study(vary=[]).vary(TRAVEL, values=[0.12, 0.005])
    study.collision("slow", speed=0.05, mass=9.08, edge=1, time=0.12)
    return study.objective("peak force of the run").run(folder)


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> Answers:
    return bottoming(tmp_path_factory.mktemp("warned") / "study")


def test_each_stored_run_has_its_own(answers: Answers) -> None:
    runs = stored_runs(answers.folder)
    assert runs["warnings"].tolist() == ["", "", "bumper bottomed", ""]


def test_a_run_alone_says_the_same(answers: Answers) -> None:
    for run, codes in enumerate(stored_runs(answers.folder)["warnings"].tolist()):
        design, sample, case = (int(index) for index in answers.runs.split(run))  # type: ignore[arg-type]
        scenario = scenario_of_run(answers.setup, answers.runs, design, sample, case)
        assert scenario.contact is not None
        assert "; ".join(warning.code for warning in batch.run(scenario).warnings) == codes


def test_they_are_counted_by_design(answers: Answers) -> None:
    assert answers.warnings == {1: {"bumper bottomed": 1}}
    assert answers.table()["warnings"].values.tolist() == ["", "bumper bottomed (1 run)"]
    assert "1 with warnings" in counts(answers)
    assert goal_header(answers)[-1] == "warnings"
    assert {row[0]: row[-1] for row in design_rows(answers)} == {"0": "", "1": "bumper bottomed (1 run)"}


def test_the_export_and_the_report_have_them(answers: Answers, tmp_path: Path) -> None:
    export_table(answers, tmp_path / "table.csv")
    with (tmp_path / "table.csv").open(encoding="utf-8") as file:
        assert [row["warnings"] for row in csv.DictReader(file)] == ["", "bumper bottomed (1 run)"]
    write_report(tmp_path / "report.html", answers)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "<h2>Warnings</h2>" in page
    assert MEANINGS["bumper bottomed"] in page


def test_without_any_there_is_no_column(tmp_path: Path) -> None:
    found = (
        judged_study(vary=[]).vary(TRAVEL, values=[0.12, 0.1]).objective("peak force of the run").run(tmp_path / "s")
    )
    assert found.warnings == {}
    assert "warnings" not in goal_header(found)
    assert "warnings" not in counts(found)


def test_results_that_were_taken_over_are_judged_by_what_this_study_states(tmp_path: Path) -> None:
    """The slider's start is that of an equal run; only what was stated could differ, and it does not."""
    first = bottoming(tmp_path / "first")
    again = bottoming(tmp_path / "second")
    assert stored_runs(again.folder)["warnings"].tolist() == stored_runs(first.folder)["warnings"].tolist()


def test_a_run_that_failed_has_no_warning(tmp_path: Path) -> None:
    study = judged_study(vary=[]).vary("testbed.bumper.plate_mass", values=[0.5, 9.0])
    study.run(tmp_path / "study")
    runs = stored_runs(tmp_path / "study")
    assert runs["status"].tolist() == ["ok", "refused"]
    assert runs["warnings"].tolist() == ["", ""]


def test_the_speeds_of_the_contact_are_always_shown(answers: Answers, tmp_path: Path) -> None:
    assert "contact speed, worst collision, m/s" in goal_header(answers)
    assert "robot speed at contact, worst collision, m/s" not in goal_header(answers)
    study = judged_study(vary=[]).vary("collision.mass", values=[5.0, 9.0])
    study.document["scenario"] = {"duration": 1.2, "plan": {"kind": "straight", "speed": 0.3, "direction": 60.0}}
    study.document["collision"] = [{"name": "standing", "speed": 0.0, "edge": 0, "time": 1.0}]
    found = study.objective("peak force of the run").run(tmp_path / "study")
    assert goal_header(found)[-4:] == ("contact speed, m/s", "robot speed at contact, m/s", "front", "warnings")
    # A ramp of 2.4 s: the robot is far from 0.3 m/s after 1 s.
    assert all("robot speed" in found.warning_text(design) for design in (0, 1))


def test_the_terminal_shows_them(process: Cli, tmp_path: Path, answers: Answers) -> None:
    said = process("study", "show", str(answers.folder))
    assert said.returncode == 0, said.stderr
    assert "1 with warnings" in said.stdout
    assert "bumper bottomed (1 run)" in said.stdout
