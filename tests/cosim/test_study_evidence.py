"""The evidence of a design: its runs over speed, place and mass, the worst of all samples, as HTML and CSV."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from figure_labels import across, check_panels, check_planted, curve
from giveway.base.errors import GivewayError
from giveway.cli import _main
from giveway.study.answers import Answers
from giveway.study.evidence import NOTICE, PLACES, Evidence, evidence, evidence_setup
from giveway.study.evidence_page import forces, summary, write_evidence
from study_helpers import LATCH, SPRING, judged_study, stored_runs

SPEEDS, MASSES = [0.3, 0.5], [5.0, 9.08]


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Answers:
    """Four latches and two springs, whose travel is so short that some hits reach the stop."""
    made = judged_study().vary(SPRING, values=[0.6, 2.4], unit="N/mm").tolerance(LATCH, relative=0.3)
    made.document["scenario"] |= {"contact_area": {"value": 30.0, "unit": "cm2"}, "judge_as": "lower leg"}
    made.document["scenario"]["testbed"] = {"bumper": {"travel": 0.02}}
    made.tolerances(kind="corners").objective("peak force of the run").constraint(
        "transient force", maximum=0.2, unit="kN"
    )
    return made.run(tmp_path_factory.mktemp("evidence") / "study", progress=False)


@pytest.fixture(scope="module")
def found(study: Answers) -> Evidence:
    return evidence(study, speeds=SPEEDS, masses=MASSES)


def test_it_is_the_design_over_speed_place_and_mass(study: Answers, found: Evidence) -> None:
    design = int(study.order[0])
    assert found.design == design
    assert len(found.table) == len(SPEEDS) * len(MASSES) * 3 * len(PLACES)  # the robot has three sides
    assert sorted(set(found.table["speed [m/s]"])) == SPEEDS
    assert sorted(set(found.table["mass [kg]"])) == MASSES
    assert len(set(zip(found.table["x [mm]"], found.table["y [mm]"], strict=True))) == 9
    runs = stored_runs(found.folder)
    for name, value in zip((LATCH, SPRING), study.designs[design], strict=True):
        assert set(runs[name]) == {value}
    assert sorted(set(np.round(runs[f"deviation of {LATCH}"], 12))) == [-0.3, 0.0, 0.3]


def test_its_numbers_are_those_of_the_runs(found: Evidence) -> None:
    runs = stored_runs(found.folder)
    transient = runs["transient force"].reshape(-1, 3)
    table = found.table
    np.testing.assert_allclose(table["peak force, nominal [kN]"], 1e-3 * transient[:, 0], rtol=1e-12)  # the user's kN
    np.testing.assert_allclose(table["peak force, worst [kN]"], 1e-3 * transient.max(axis=1), rtol=1e-12)
    np.testing.assert_allclose(table["peak pressure, worst [N/cm2]"], transient.max(axis=1) / 30.0, rtol=1e-12)
    travel = runs["bumper compression"].reshape(-1, 3)
    np.testing.assert_allclose(table["travel, worst [mm]"], travel.max(axis=1), rtol=1e-12)
    np.testing.assert_allclose(table["over-travel, worst [mm]"], np.maximum(travel.max(axis=1) - 20.0, 0.0), atol=1e-6)
    assert (table["over-travel, worst [mm]"] > 0.0).any()
    assert not table["lasting force, worst [N]"].isna().any()  # the runs last long enough to know it


def test_the_page_says_what_it_is_and_has_every_number(study: Answers, found: Evidence) -> None:
    page, listed = write_evidence(study, found)
    text = page.read_text(encoding="utf-8")
    assert NOTICE in text
    assert "simulation, not certification" in NOTICE
    with listed.open(encoding="utf-8") as file:
        assert file.readline() == f"# {NOTICE}\n"
        rows = list(csv.DictReader(file))
    assert len(rows) == len(found.table)
    assert float(rows[5]["peak force, worst [kN]"]) == pytest.approx(found.table["peak force, worst [kN]"][5])
    worst = found.table[found.table["speed [m/s]"] == 0.5]["peak force, worst [kN]"].max()
    assert summary(found)[2][:2] == ("0.5", f"{worst:.4g}")
    assert f"<td>{worst:.4g}</td>" in text


def test_the_figure_s_labels_say_what_it_draws(study: Answers, found: Evidence) -> None:
    runs = stored_runs(found.folder)
    transient = runs["transient force"].reshape(-1, 3)
    table, wanted = found.table, []
    for mass in MASSES:
        for peak in (transient[:, 0], transient.max(axis=1)):
            chosen = [(table["speed [m/s]"] == speed) & (table["mass [kg]"] == mass) for speed in SPEEDS]
            wanted.append(curve(SPEEDS, "m/s", [peak[one.to_numpy()].max() for one in chosen], "N"))
    figure = forces(study, found)
    check_planted(figure, lambda: check_panels(figure, [wanted]))
    assert across(figure.axes[0], "y") == [0.2]  # kN


def test_the_command_writes_it_and_takes_what_is_stored(study: Answers, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["study", "evidence", str(study.folder), "--design", "1", "--speeds", "0.4", "--masses", "9.08"]
    assert _main(arguments) == 0
    said = capsys.readouterr().out
    assert NOTICE in said
    folder = study.folder / "evidence" / "design-1"
    assert {"evidence.html", "evidence.csv"} <= {path.name for path in folder.iterdir()}
    assert len(stored_runs(folder)["run"]) == 27
    assert _main([*arguments[:-3], "0.4,x", *arguments[-2:]]) == 2
    assert "--speeds: 0.4,x is not allowed" in capsys.readouterr().err


@pytest.mark.parametrize(("option", "value"), [("--masses", 0.0), ("--speeds", -0.1)])
def test_a_wrong_number_names_its_option(option: str, value: float, study: Answers) -> None:
    stated = {option.removeprefix("--"): [value]}
    with pytest.raises(GivewayError) as caught:
        evidence(study, 1, **stated)  # type: ignore[arg-type]
    assert (caught.value.field, caught.value.value) == (option, value)
    assert "a finite number from " in caught.value.allowed


def test_speeds_and_masses_are_around_those_of_the_study(study: Answers) -> None:
    setup = evidence_setup(study, 0, None, None)
    levels = {one.quantity.name: one.levels for one in setup.varied}
    assert levels["collision.speed"] == (0.125, 0.25, 0.375, 0.5, 0.625)
    assert levels["collision.mass"] == (4.54, 9.08, 18.2)


def test_a_body_region_keeps_its_mass_and_a_place_its_direction(tmp_path: Path) -> None:
    made = judged_study(collision=[]).collision("front", speed=0.5, edge=0, direction=-120.0, time=0.12)
    made.document["scenario"]["body_region"] = "lower leg"
    answers = made.objective("peak force of the run").run(tmp_path / "study", progress=False)
    setup = evidence_setup(answers, 1, [0.2], None)
    assert [one.quantity.name for one in setup.varied] == [LATCH, "collision.speed"]
    with pytest.raises(GivewayError, match=r"--masses: .*body region has its own mass"):
        evidence_setup(answers, 1, [0.2], [3.0])


def test_what_one_sample_does_not_know_the_worst_case_does_not_either(tmp_path: Path) -> None:
    made = judged_study().objective("peak force of the run").tolerance(LATCH, relative=0.3).tolerances(samples=2)
    found = evidence(made.run(tmp_path / "study", progress=False), speeds=[0.001], masses=[0.5])
    runs = stored_runs(found.folder)
    missed = np.isnan(runs["detection time"].reshape(-1, 3)).any(axis=1)
    assert missed.any()
    for row, unknown in zip(found.table["detection time, worst [ms]"], missed, strict=True):
        assert math.isnan(row) == unknown
