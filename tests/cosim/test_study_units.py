"""What a user wrote comes back as it was written, and what cannot be told says why."""

from __future__ import annotations

import csv
import dataclasses
import html
from pathlib import Path

import numpy as np
import pytest
from figure_labels import across, check_panel, check_panels, check_planted, curve, in_si, unit_in
from giveway.base.units import WrittenUnit
from giveway.report.inline_svg import inline_svg
from giveway.robot.variables import table
from giveway.study import Study, figures
from giveway.study.answers import Answers
from giveway.study.asked import asked
from giveway.study.chosen import simulate
from giveway.study.export import export_design, export_table
from giveway.study.report import write_report
from giveway.study.tables import design_rows, goal_header, sensitivity_rows
from study_helpers import LATCH, SPRING, small_study


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> Answers:
    """Of a study in units of its own: N/mm, km/h, cm, and an absolute tolerance in kN."""
    study = small_study(vary=[])
    study.vary(SPRING, values=[0.6, 2.4], unit="N/mm").vary("collision.speed", low=1.2, high=2.1, levels=2, unit="km/h")
    study.tolerance(LATCH, absolute=0.002, unit="kN").tolerances(samples=1)
    study.objective("bumper compression").objective("peak force of the run")
    study.constraint("bumper compression", maximum=3.0, unit="cm")
    return study.run(tmp_path_factory.mktemp("units"), progress=False)


def test_units_come_back_in_the_table(answers: Answers) -> None:
    header = goal_header(answers)
    assert header[1:3] == ("testbed.bumper.spring_rate, N/mm", "collision.speed, km/h")
    assert any(name.startswith("bumper compression") and name.endswith(", cm") for name in header)
    rows = {int(row[0]): row for row in design_rows(answers)}
    assert {row[1:3] for row in rows.values()} <= {(k, v) for k in ("0.6", "2.4") for v in ("1.2", "2.1")}
    design = min(rows)
    shown = float(rows[design][3])
    assert shown == pytest.approx(0.1 * answers.values[design, 0], rel=1e-3)  # mm in cm, four digits
    shown_table = answers.table()
    assert shown_table["testbed.bumper.spring_rate"].attrs["units"] == "N/mm"
    assert sorted(set(shown_table["testbed.bumper.spring_rate"].values)) == [0.6, 2.4]
    assert sorted(set(answers.designs[:, 0])) == [600.0, 2400.0]  # what is computed with stays in our units


def test_units_come_back_in_exports(answers: Answers, tmp_path: Path) -> None:
    export_table(answers, tmp_path / "all.csv")
    rows = list(csv.DictReader((tmp_path / "all.csv").open()))
    assert {row["testbed.bumper.spring_rate [N/mm]"] for row in rows} == {"0.6", "2.4"}
    assert {row["collision.speed [km/h]"] for row in rows} == {"1.2", "2.1"}
    name = next(name for name in rows[0] if name.startswith("bumper compression"))
    assert name.endswith("[cm]")
    export_design(answers, 3, tmp_path / "one.csv")
    assert (tmp_path / "one.csv").read_text().splitlines() == [
        "quantity,value,unit",
        "testbed.bumper.spring_rate,2.4,N/mm",
        "collision.speed,2.1,km/h",
    ]


def test_the_figures_labels_say_what_they_draw(answers: Answers) -> None:
    compression_m, peak_n = 1e-3 * answers.values[:, 0], answers.values[:, 1]
    figure = figures.trade_off(answers)
    front = np.flatnonzero(answers.pareto)
    front = front[np.argsort(compression_m[front])]
    others = [np.flatnonzero(~answers.feasible), np.flatnonzero(answers.feasible & ~answers.pareto)]
    best = [np.array([design]) for design in answers.order[:3]]
    clouds = [curve(compression_m[some], "m", peak_n[some], "N") for some in (front, *others, *best) if len(some)]
    check_planted(figure, lambda: check_panels(figure, [clouds]))
    assert across(figure.axes[0], "x") == [3.0]  # cm, the limit
    assert "at most 3 cm" in [text.get_text() for text in figure.axes[0].texts]

    figure = figures.effects(answers)
    good, bad = np.flatnonzero(answers.feasible), np.flatnonzero(~answers.feasible)
    panels = []
    for values, unit in ((compression_m, "m"), (peak_n, "N")):
        for column, x_unit in ((0, "N/m"), (1, "m/s")):
            x = answers.designs[:, column]
            panels.append([curve(x[some], x_unit, values[some], unit) for some in (good, bad)])
    check_planted(figure, lambda: check_panels(figure, panels))
    assert [across(axes, "y") for axes in figure.axes] == [[3.0], [3.0], [], []]


def test_every_two_objectives_are_drawn_against_each_other(tmp_path: Path) -> None:
    study = (
        small_study().objective("peak force of the run").objective("bumper compression").objective("contact impulse")
    )
    study.constraint("bumper compression", maximum=3.0, unit="cm").constraint("peak force of the run", maximum=9000.0)
    found = study.run(tmp_path / "study", progress=False)
    values = {"N": found.values[:, 0], "m": 1e-3 * found.values[:, 1], "N.s": found.values[:, 2]}
    figure = figures.trade_off(found)
    clouds = [np.flatnonzero(found.pareto), np.flatnonzero(found.feasible & ~found.pareto)]
    clouds = [*clouds, np.flatnonzero(~found.feasible), *(np.array([design]) for design in found.order[:3])]
    panels = []
    for x, y in (("N", "m"), ("N", "N.s"), ("m", "N.s")):
        clouds[0] = clouds[0][np.argsort(values[x][clouds[0]], kind="stable")]  # joined by a line
        seen = [some for some in clouds if len(some)]
        panels.append([curve(values[x][some], x, values[y][some], y) for some in seen])
    drawn = [axes for axes in figure.axes if axes.axison]
    for axes, wanted in zip(drawn, panels, strict=True):
        check_panel(figure, axes, wanted)
    assert [across(axes, "y") for axes in drawn] == [[3.0], [], []]
    assert [across(axes, "x") for axes in drawn] == [[], [], [3.0]]
    # A limit that would leave no room for the points is named at the edge, and no line is drawn.
    assert "at most 9000 N: above this range" in [text.get_text() for text in drawn[0].texts]


def test_the_growth_of_a_search_is_in_shares_of_its_end(answers: Answers) -> None:
    told = {"designs": [24, 48, 72], "hypervolume": [2.0, 3.0, 4.0], "reference": None, "reason": "enough"}
    figure = figures.growth(dataclasses.replace(answers, manifest=answers.manifest | {"optimum": told}))
    assert figure is not None
    wanted = curve([24.0, 48.0, 72.0], "1", [0.5, 0.75, 1.0], "1")
    check_planted(figure, lambda: check_panels(figure, [[wanted]]))


def test_one_objective_is_drawn_against_what_has_a_limit(tmp_path: Path) -> None:
    study = small_study().objective("peak force of the run").constraint("bumper compression", maximum=3.0, unit="cm")
    found = study.run(tmp_path / "study", progress=False)
    assert figures.pairs(found) == [(0, 1)]
    (axes,) = figures.trade_off(found).axes
    assert across(axes, "y") == [3.0]


def test_limits_of_forces_are_in_the_traces_too(tmp_path: Path) -> None:
    study = (
        small_study().objective("peak force of the run").constraint("peak force of the run", maximum=0.07, unit="kN")
    )
    found = study.run(tmp_path / "study", progress=False)
    design = int(found.order[0])
    results = {design: simulate(found.setup, found.runs, found.folder, design)}
    figure = figures.traces(results, found)
    (axes,) = figure.axes
    assert unit_in(axes.get_ylabel()) == (1.0, "kN")
    assert across(axes, "y") == [0.07]
    force = results[design]["front"].traces["testbed.truth.contact_force"].values
    assert 1e3 * max(np.asarray(axes.lines[0].get_ydata())) == pytest.approx(force.max())
    assert "peak force of the run at most 0.07 kN" in [text.get_text() for text in axes.texts]


def test_thousands_of_points_are_an_image_and_labels_stay_text(answers: Answers) -> None:
    many = 20_000
    wide = dataclasses.replace(
        answers,
        values=np.tile(answers.values, (many // 4, 1)),
        feasible=np.ones(many, dtype=bool),
        pareto=np.arange(many) == answers.order[0],
    )
    text = inline_svg(figures.trade_off(wide), "x")
    assert text.count("<image") == 1
    assert len(text) < 1_000_000
    for words in ("at most 3 cm", f"design {answers.order[0]}", "bumper compression"):
        assert words in text


def test_elementary_effects_are_in_the_unit_of_their_title(tmp_path: Path) -> None:
    study = small_study(vary=[], designs={"kind": "morris", "trajectories": 2}).objective("bumper compression")
    study.vary(LATCH, low=0, high=60).vary(SPRING, low=0.6, high=2.4, unit="N/mm")
    answers = study.constraint("bumper compression", maximum=3.0, unit="cm").run(tmp_path / "study", progress=False)
    effects = answers.sensitivities()  # in mm
    (axes,) = figures.sensitivities(answers).axes  # type: ignore[union-attr]
    unit = unit_in(axes.get_title())
    assert unit == (1.0, "cm")
    bars = in_si([bar.get_width() for bar in axes.patches], unit, "m")  # type: ignore[attr-defined]
    spread = [one.total or 0.0 for one in effects]
    assert 1e3 * bars == pytest.approx([one.main for one in effects] + spread)
    assert max(bars) > 1e-3
    rows = {row[1]: row for row in sensitivity_rows(answers)}
    for one in effects:
        assert rows[one.quantity][0] == "bumper compression, cm"
        assert float(rows[one.quantity][3]) == pytest.approx(0.1 * one.main, rel=5e-3)  # three digits


def test_the_report_says_what_was_asked(answers: Answers, tmp_path: Path) -> None:
    write_report(tmp_path / "report.html", answers, {})
    page = html.unescape((tmp_path / "report.html").read_text(encoding="utf-8"))
    for words in ("0.6, 2.4 N/mm", "1.2 to 2.1 km/h", "+-0.002 kN", "bumper compression: at most 3 cm"):
        assert words in page
    definition = "largest compression: what the collision used of the bumper's travel, which is a parameter"
    assert f"<tr><th>bumper compression</th><td>{definition}</td></tr>" in html.unescape(page)
    for name, text in asked(answers.setup):
        assert f"<th>{name}</th><td>{text}</td>" in page
    said = dict(asked(answers.setup))
    assert said["robot"] == "trikey.toml, which the FMUs were built with"
    assert said["plan"] == "rest: the robot stands"
    assert said["bumper"].startswith("magnetic, on the slider, spring rate varies, preload 2 N, ")
    assert said["preset"].startswith("default: ")
    assert "contact area" not in said
    assert said["body region"] == "none"
    assert f"stiffness {table('testbed')['contact.stiffness'].start:g} N/m" in said["contact"]
    assert said["objectives"] == "metric = bumper compression; metric = peak force of the run"


def test_everything_that_a_scenario_sets_is_said() -> None:
    study = Study("all", duration=0.3, bumper="none", preset="paper", judge_as="lower leg", noise_seed=7,
                  contact_area={"value": 30.0, "unit": "cm2"}, testbed={"slider.friction": 2.0},
                  controller={"admittance": {"speed_limit": 0.4}})  # fmt: skip
    said = dict(asked(study.collision("front", speed=0.5, mass=9.08, edge=0, time=0.12).setup()))
    assert said["preset"].startswith("paper: ")
    assert said["bumper"] == "none"
    assert said["contact area"] == "30 cm2"
    assert said["testbed"] == "slider.friction = 2.0"
    assert said["controller"] == "admittance.speed_limit = 0.4"
    assert said["sensor noise"] == "seed 7"


def test_what_varies_is_said_to_vary() -> None:
    study = small_study(vary=[{"quantity": "bumper", "values": ["spring", "magnetic"]}])
    study.vary("testbed.contact.stiffness", values=[5.0, 9.0], unit="kN/m")
    study.document["scenario"] |= {"judge_as": "lower leg", "plan": {"kind": "rest", "x": 0.1}}
    said = dict(asked(study.setup()))
    assert said["bumper"].startswith("varies, on the slider, spring rate ")
    assert "stiffness varies" in said["contact"]
    assert said["body region"] == "lower leg: its limits only"
    assert said["plan"] == "kind = rest, x = 0.1"


def test_a_unit_there_and_back_is_what_was_written() -> None:
    unit = WrittenUnit("km/h", 1.0 / 3.6)
    for value in (1.2, 2.1, 0.1, 7.3):
        assert unit.of(value * unit.scale) == value


@pytest.mark.parametrize(
    ("tables", "reason"),
    [
        ({}, "designs of the kind factorial do not tell; latin-hypercube or sobol with 64 designs or more"),
        ({"designs": {"kind": "sobol", "count": 4}}, "4 designs have a peak force of the run, and it takes 64"),
        ({"objective": []}, "the study has no objective"),
    ],
)
def test_sensitivities_that_are_not_there_say_why(tables: dict[str, object], reason: str, tmp_path: Path) -> None:
    study = small_study(vary=[]).objective("peak force of the run")
    study.vary(LATCH, low=0, high=60, levels=2).vary(SPRING, low=0.6, high=2.4, levels=2, unit="N/mm")
    study.document.update(tables)
    found = study.run(tmp_path / "study", progress=False).sensitivities()
    assert len(found) == 0
    assert found.reason.startswith(reason)
    assert repr(found) == f"[] ({found.reason})"
