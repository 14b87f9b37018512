"""What a user wrote comes back as it was written, and what cannot be told says why."""

from __future__ import annotations

import copy
import csv
import dataclasses
import html
from pathlib import Path

import numpy as np
import pytest
from figure_labels import check_panels, check_planted, curve, in_si, unit_in
from giveway.base.units import WrittenUnit, factor
from giveway.report.figure_data import figure_data
from giveway.robot.variables import table
from giveway.study import Study, figures
from giveway.study.answers import Answers
from giveway.study.asked import asked
from giveway.study.export import export_design, export_table
from giveway.study.page_columns import FEASIBLE, FRONT, KNOWN
from giveway.study.page_data import page_data
from giveway.study.report import write_report
from giveway.study.tables import design_rows, goal_header, sensitivity_rows
from page_arrays import page_array, page_values
from study_helpers import LATCH, SPRING, judged_study


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> Answers:
    """Of a study in units of its own: N/mm, km/h, cm, and an absolute tolerance in kN."""
    study = judged_study(vary=[])
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


def test_the_page_s_columns_are_in_the_units_of_their_labels(answers: Answers) -> None:
    data = page_data(answers)
    wanted = [
        ("bumper.spring_rate", "N/mm", answers.designs[:, 0], "N/m"),
        ("collision.speed", "km/h", answers.designs[:, 1], "m/s"),
        ("bumper compression, worst of tolerances", "cm", 1e-3 * answers.values[:, 0], "m"),
        ("peak force of the run, worst of tolerances", "N", answers.values[:, 1], "N"),
    ]
    for column, (label, unit, values, si) in zip(data["columns"][:4], wanted, strict=True):
        assert (column["label"], column["unit"]) == (label, unit)
        shown = page_array(data, column["values"]) / column["scale"]
        np.testing.assert_allclose(shown * factor("", unit, si), values, rtol=1e-12)
        assert (column["unit"] != si) == (not np.allclose(shown, values, rtol=1e-3))  # another unit would be seen
    limits = [column["limits"] for column in data["columns"][:4]]
    assert limits == [[], [], [{"at": 3.0, "words": "at most 3 cm"}], []]  # once, though it is a constraint, too
    assert [column["role"] for column in data["columns"][:4]] == ["quantity"] * 2 + ["objective"] * 2
    kept = page_values(data["flags"]).astype(int)
    np.testing.assert_array_equal(kept & FEASIBLE > 0, answers.feasible)
    np.testing.assert_array_equal(kept & FRONT > 0, answers.pareto)
    assert (kept & KNOWN > 0).all()
    assert page_values(data["rank"])[answers.order].tolist() == list(range(len(answers.order)))
    assert data["chosen"] == answers.order[0]


def test_the_growth_of_a_search_is_in_shares_of_its_end(answers: Answers) -> None:
    told = {"designs": [24, 48, 72], "hypervolume": [2.0, 3.0, 4.0], "reference": None, "reason": "enough"}
    figure = figures.growth(dataclasses.replace(answers, manifest=answers.manifest | {"optimum": told}))
    assert figure is not None
    wanted = curve([24.0, 48.0, 72.0], "1", [0.5, 0.75, 1.0], "1")
    check_planted(figure, lambda: check_panels(figure, [[wanted]]))


def test_limits_of_forces_and_times_are_in_the_curves_too(tmp_path: Path) -> None:
    study = judged_study().objective("peak force of the run").constraint("detection time", maximum=1.0, unit="s")
    found = study.constraint("peak force of the run", maximum=0.07, unit="kN").run(tmp_path / "study", progress=False)
    data = page_data(found)
    limits = [{"at": 0.07, "words": "peak force of the run at most 0.07 kN"}]
    assert data["force"] == {"unit": "kN", "scale": 1e3, "limits": limits}
    assert data["time"] == {"unit": "s", "scale": 1e3, "limits": [{"at": 1.0, "words": "detection time at most 1 s"}]}


def test_of_many_designs_the_page_has_the_best_and_those_that_the_text_names(answers: Answers) -> None:
    many = 20_000
    repeated = np.tile(np.arange(4), many // 4)
    runs = copy.copy(answers.runs)
    runs.designs = answers.designs[repeated] * (1.0 + 1e-6 * np.random.default_rng(1).random((many, 2)))
    wide = dataclasses.replace(
        answers,
        runs=runs,
        values=answers.values[repeated]
        * (1.0 + 0.1 * np.random.default_rng(2).random((many, answers.values.shape[1]))),
        feasible=np.ones(many, dtype=bool),
        pareto=np.arange(many) == 77,
        order=np.roll(np.arange(many), -77),
        score=np.zeros(many),
        stored=answers.stored[repeated],
        failed=answers.failed[repeated],
        cut_off=answers.cut_off[repeated],
    )
    data = page_data(wide)
    assert data["count"] == data["total"] == many
    assert sum(map(len, map(str, data["arrays"]))) < 4_500_000
    few = page_data(wide, most=1000)
    designs = page_values(few["designs"])
    assert len(designs) == few["count"] == 1000
    assert set(range(77, 577)) <= set(designs.tolist())
    assert (np.diff(designs) > 0).all()
    small = page_data(wide, size=100_000)
    assert sum(map(len, map(str, small["arrays"]))) < 110_000
    assert 500 < small["count"] < 10_000


def test_elementary_effects_are_in_the_unit_of_their_title(tmp_path: Path) -> None:
    study = judged_study(vary=[], designs={"kind": "morris", "trajectories": 2}).objective("bumper compression")
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


@pytest.mark.parametrize("goals", [("detection time",), ("detection time", "location error")], ids=["one", "two"])
def test_what_decides_names_its_quantities_from_the_top(goals: tuple[str, ...], tmp_path: Path) -> None:
    study = judged_study(vary=[], designs={"kind": "morris", "trajectories": 2})
    study.vary(LATCH, low=0, high=60).vary(SPRING, low=0.6, high=2.4, unit="N/mm")
    for goal in goals:
        study.objective(goal)
    figure = figures.sensitivities(study.run(tmp_path / "study", progress=False))
    panels = figure_data(figure)["axes"]  # type: ignore[arg-type]
    assert len(panels) == len(goals)
    for panel in panels:
        assert panel["y"]["ticks"] == [[0.0, "bumper.latch_force"], [1.0, "bumper.spring_rate"]]
        assert panel["y"]["first"] > panel["y"]["last"]


def test_the_report_says_what_was_asked(answers: Answers, tmp_path: Path) -> None:
    write_report(tmp_path / "report.html", answers)
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
    study = judged_study(vary=[{"quantity": "bumper", "values": ["spring", "magnetic"]}])
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
    study = judged_study(vary=[]).objective("peak force of the run")
    study.vary(LATCH, low=0, high=60, levels=2).vary(SPRING, low=0.6, high=2.4, levels=2, unit="N/mm")
    study.document.update(tables)
    found = study.run(tmp_path / "study", progress=False).sensitivities()
    assert len(found) == 0
    assert found.reason.startswith(reason)
    assert repr(found) == f"[] ({found.reason})"
