"""Bumpers from data sheets: `[bumper]` of scenario and study files, measured tables, and what is wrong with them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import giveway
import numpy as np
import pytest
from giveway import batch
from giveway.base.errors import GivewayError, InputFileError
from giveway.robot.variables import table
from giveway.scenario.force_table import read_force_table
from giveway.scenario.scenario import BUMPERS
from giveway.scenario.scenario_file import read_scenario
from giveway.scenario.stated_bumper import NUMBERS, stated_bumper
from giveway.study.asked import asked
from giveway.study.export import export_design
from study_helpers import SmallStudy, stored_runs

SCENARIO = """\
schema_version = 1
duration = 0.4
{bumper}
[collision]
mass = 12.0
speed = 0.5
edge = 0
time = 0.15
"""
LAWS = {
    "foam": """\
thickness = { value = 60, unit = "mm" }
force_25 = 22
force_50 = { value = 0.04, unit = "kN" }
force_75 = 105.0
hysteresis = { value = 40, unit = "%" }
rate_gain = 0.5
""",
    "gas": "force = 40\nforce_compressed = 75\nstroke = { value = 50, unit = 'mm' }\nexponent = 1.3\n",
    "damper": "rate = 90\nsquare = 40\nrebound = 0.3\nspring_rate = { value = 0.2, unit = 'N/mm' }\n",
    "series": "spring_rate = 600\nsecond_rate = 3000\nfirst_travel = { value = 3, unit = 'cm' }\npreload = 3\n",
    "lever": "spring_rate = 400\nratio = 1.5\nmass = { value = 80, unit = 'g' }\npreload = 2\n",
    "table": 'file = "foam.csv"\n',
}
MEASURED = """\
# Made up.
travel [mm], speed [mm/s], force [N]
0, 1, 0
20, 1, 20
40, 1, 35
60, 1, 90

0, 500, 1
20, 500, 31
40, 500, 50
60, 500, 130
"""


def written(folder: Path, law: str, lines: str | None = None, measured: str = MEASURED, more: str = "") -> Path:
    (folder / "foam.csv").write_text(measured)
    text = f'[bumper]\nlaw = "{law}"\ntravel = {{ value = 50, unit = "mm" }}\nplate_mass = 0.2\n'
    path = folder / "case.toml"
    path.write_text(SCENARIO.format(bumper=text + (LAWS[law] if lines is None else lines)) + more)
    return path


@pytest.mark.parametrize("law", LAWS)
def test_every_law_runs_from_its_numbers(law: str, tmp_path: Path) -> None:
    scenario = giveway.read_scenario(written(tmp_path, law))
    assert scenario.bumper == law
    values = scenario.parameters("testbed")
    assert values["bumper.kind"] == BUMPERS[law]
    assert values["bumper.travel"] == 0.05
    assert values["bumper.damping"] == values["bumper.guide_friction"] == 0.0  # not stated
    result = batch.run(scenario)
    assert 5.0 < float(result.metric("bumper compression").value or 0.0) < 52.0
    # Of the energy turned over, at the usual tolerance of 1e-6 and over the knees of some laws.
    assert abs(float(result.metric("energy residual").value or 1.0)) < 1e-5


def test_units_are_converted(tmp_path: Path) -> None:
    values = giveway.read_scenario(written(tmp_path, "foam")).parameters("testbed")
    assert values["bumper.foam_force_50"] == pytest.approx(40.0, rel=1e-15)
    assert values["bumper.foam_hysteresis"] == pytest.approx(0.4, rel=1e-15)
    assert values["bumper.foam_thickness"] == pytest.approx(0.06, rel=1e-15)


def test_a_gas_spring_has_the_force_of_its_data_sheet(tmp_path: Path) -> None:
    values = giveway.read_scenario(written(tmp_path, "gas")).parameters("testbed")
    length = float(values["bumper.gas_length"])
    assert 40.0 * (1.0 - 0.05 / length) ** -1.3 == pytest.approx(75.0, rel=1e-12)


def test_a_measured_table_keeps_its_points(tmp_path: Path) -> None:
    found = read_force_table(written(tmp_path, "table").with_name("foam.csv"))
    assert found.travels_m == pytest.approx((0.0, 0.02, 0.04, 0.06))
    assert found.speeds_mps == pytest.approx((0.0, 0.001, 0.5))  # at rest as at the slowest compression
    assert found.forces_n[2] == (35.0, 35.0, 50.0)
    values = giveway.read_scenario(tmp_path / "case.toml").parameters("testbed")
    assert values["bumper.table_rows"] == 4
    assert values["bumper.table_columns"] == 3
    assert [values[f"bumper.table_force[{6 * 2 + j}]"] for j in range(3)] == [35.0, 35.0, 50.0]
    assert {name for name in values if name.startswith("bumper.table_")} == {
        variable.name for variable in table("testbed") if variable.name.startswith("bumper.table_")
    }


def test_the_force_at_rest_is_between_both_directions(tmp_path: Path) -> None:
    path = tmp_path / "both.csv"
    path.write_text("travel [m],speed [m/s],force [N]\n" + "".join(
        f"{c},{v},{1000 * c + (20 * v + 4 if v > 0 else 10 * v + 2)}\n" for c in (0.0, 0.05) for v in (-0.1, 0.3)
    ))  # fmt: skip
    found = read_force_table(path)
    assert found.speeds_mps == (-0.1, 0.0, 0.3)
    assert found.forces_n[1][1] == pytest.approx(51.0 + 0.25 * (60.0 - 51.0))


def test_more_travels_than_there_is_room_for_are_thinned_out(tmp_path: Path) -> None:
    """Those that stay are measured points, and the lines between them are as close as is said."""
    travels = np.linspace(0.0, 0.06, 61)
    forces = 20.0 * (travels / 0.02) + 300.0 * (travels / 0.06) ** 4
    path = tmp_path / "long.csv"
    path.write_text(
        "travel [m],speed [m/s],force [N]\n" + "".join(f"{c},0,{f}\n" for c, f in zip(travels, forces, strict=True))
    )
    found = read_force_table(path)
    assert len(found.travels_m) == 12
    assert {found.travels_m[0], found.travels_m[-1]} == {0.0, 0.06}
    kept = np.array(found.forces_n)[:, 0]
    off = np.abs(np.interp(travels, found.travels_m, kept) - forces)
    assert found.residual_n == pytest.approx(off.max(), rel=1e-12)
    assert 0.0 < found.residual_n < 0.02 * forces.max()


WRONG: dict[str, tuple[str, str | None, str, list[str]]] = {
    "no such law": ("rubber", "", "", ["case.toml:4:", "bumper.law", "foam"]),
    "a number is missing": ("foam", "thickness = 0.06\nforce_25 = 22\n", "", ["bumper.force_50", "it is needed"]),
    "a key of another law": ("gas", "force = 40\nlength = 0.1\nratio = 2\n", "", [":9:", "bumper.ratio: ratio"]),
    "another unit": (
        "foam", LAWS["foam"].replace('"mm"', '"kg"'), "", [":7:", "bumper.thickness.unit", "kg", "m, or a unit"],
    ),
    "out of range": ("lever", "spring_rate = 400\nratio = 200\n", "", [":8:", "bumper.ratio", "0.01 to 100"]),
    "foam too thin": (
        "foam", LAWS["foam"].replace("60,", "50,"), "", [":5:", "bumper.travel", "at most 0.95 foam_thickness"],
    ),
    "gas that gets weaker": (
        "gas", LAWS["gas"].replace("75", "30"), "", [":8:", "bumper.force_compressed", "above force, 40 N"],
    ),
    "both lengths of gas": ("gas", LAWS["gas"] + "length = 0.1\n", "", [":11:", "bumper.length", "one of both"]),
    "half a data sheet": ("gas", "force = 40\nstroke = 0.05\n", "", ["bumper.force_compressed", "it is needed"]),
    "a second spring that never moves": (
        "series", LAWS["series"] + "second_preload = 40\n", "", [":11:", "bumper.second_preload", "at most 21 N"],
    ),
    "set twice": ("lever", None, "[testbed]\nbumper.travel = 0.04\n", ["testbed.bumper.travel", "one place"]),
    "a table that is not there": ("table", 'file = "missing.csv"\n', "", ["missing.csv", "no such file"]),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_what_is_wrong_is_named(case: str, tmp_path: Path) -> None:
    law, lines, more, words = WRONG[case]
    path = written(tmp_path, law, lines, more=more)
    with pytest.raises(GivewayError) as caught:
        giveway.read_scenario(path)
    for word in words:
        assert word in str(caught.value), caught.value


BAD_TABLES = {
    "falls with the speed": (
        "20, 500, 31", "20, 500, 19", [":9:", "column 3, force [N]", "19", "at least 20", "line 4", "energy"],
    ),
    "no number": ("40, 1, 35", "40, 1, x", [":5:", "column 3, force [N]", "x", "finite"]),
    "pulls": ("40, 1, 35", "40, 1, -3", [":5:", "-3", "only pushes"]),
    "behind full extension": ("20, 1, 20", "-20, 1, 20", [":4:", "column 1, travel [mm]", "-20"]),
    "twice": ("40, 1, 35", "20, 1, 35", [":5:", "line 4 has it"]),
    "a hole": ("60, 500, 130\n", "", [":2:", "0.06 m and 0.5 m/s"]),
    "no column": ("force [N]", "force", [":2:", "column 3", "travel [mm], speed [mm/s] and force [N]"]),
    "another unit": ("force [N]", "force [mm]", [":2:", "column 3", "mm", "N, or a unit"]),
    "a cell too many": ("60, 1, 90", "60, 1, 90, 1", [":6:", "columns", "4", "3"]),
    "starts late": ("0, 1, 0\n", "", ["0 m and 0.001 m/s"]),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD_TABLES)
def test_what_is_wrong_in_a_table_is_named(case: str, tmp_path: Path) -> None:
    old, new, words = BAD_TABLES[case]
    assert old in MEASURED
    path = written(tmp_path, "table", measured=MEASURED.replace(old, new, 1))
    with pytest.raises(InputFileError) as caught:
        giveway.read_scenario(path)
    for word in ("foam.csv", *words):
        assert word in str(caught.value), caught.value


def test_a_bumper_needs_something_that_collides(tmp_path: Path) -> None:
    path = written(tmp_path, "lever")
    path.write_text(path.read_text().partition("[collision]")[0])
    with pytest.raises(GivewayError, match="none without"):
        giveway.read_scenario(path)


def test_another_bumper_on_the_command_line_replaces_it(tmp_path: Path) -> None:
    scenario = read_scenario(written(tmp_path, "foam"), bumper="spring")
    assert scenario.bumper == "spring"
    assert "bumper.foam_thickness" not in scenario.testbed


def test_names_of_numbers_are_parameters() -> None:
    for law in BUMPERS:
        for name in NUMBERS[law]:
            assert f"bumper.{name}" in table("testbed")


def study_of(bumper: Any) -> giveway.Study:
    study = SmallStudy("laws", duration=0.3, bumper=bumper)
    return study.collision("front", speed=0.5, mass=12.0, edge=0, time=0.15)


def test_a_study_varies_a_law_and_exports_it(tmp_path: Path) -> None:
    """The exported design has the table's points, and does what it did in the study."""
    (tmp_path / "foam.csv").write_text(MEASURED)
    study = study_of({"law": "table", "file": str(tmp_path / "foam.csv")})
    study.vary("testbed.bumper.plate_mass", values=[0.1, 0.3]).objective("peak force of the run")
    words = dict(asked(study.setup()))["bumper"]
    assert words.startswith("table, foam.csv: 4 travels, 3 speeds")
    answers = study.run(tmp_path / "out", threads=1)
    assert (tmp_path / "out" / "bumper.csv").read_text() == MEASURED
    export_design(answers, 1, tmp_path / "design.toml")
    again = batch.run(giveway.read_scenario(tmp_path / "design.toml"))
    wanted = stored_runs(answers.folder)["peak force of the run"][1]
    assert again.metric("peak force of the run").value == pytest.approx(wanted, rel=1e-12)


def test_laws_are_compared_in_one_study(tmp_path: Path) -> None:
    """`bumper` chooses among laws whose numbers are parameters."""
    study = study_of("foam")
    study.vary("bumper", values=["spring", "foam", "gas", "damper", "series", "lever", "table"])
    answers = study.objective("peak force of the run").run(tmp_path / "out", threads=1)
    peaks = stored_runs(answers.folder)["peak force of the run"]
    assert len(set(np.round(peaks, 6))) == 7


def test_in_python() -> None:
    law, numbers = stated_bumper({"law": "lever", "travel": 0.05, "spring_rate": 500, "ratio": 2}, Path())
    assert law == "lever"
    assert numbers["bumper.lever_ratio"] == 2.0
    assert numbers["bumper.preload"] == 0.0
