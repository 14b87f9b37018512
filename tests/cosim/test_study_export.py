"""An exported design does what it did in the study: as parameters of the FMU, as a scenario, as a list."""

from __future__ import annotations

import csv
import math
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import fmpy.ssp
import giveway
import numpy as np
import pyarrow
import pytest
from giveway import batch
from giveway.base import native
from giveway.base.errors import GivewayError
from giveway.robot.changes import NewValue, changed_robot
from giveway.study.answers import Answers, load
from giveway.study.engine import sweep
from giveway.study.export import SSV, arrow_array, export_design, export_table, powers
from lxml import etree
from study_helpers import LATCH, SPRING, small_study, stored_runs

DESIGN = 5
SCHEMA = Path(fmpy.ssp.__file__).parent / "schema" / "SystemStructureParameterValues.xsd"


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> Answers:
    """Eight designs in which everything varies that an export must carry."""
    study = small_study(vary=[]).collision("side", speed=0.4, edge=1, offset=0.05, time=0.12, height=0.5)
    study.vary(LATCH, low=10.0, high=60.0).vary(SPRING, low=500.0, high=2000.0)
    study.vary("bumper", values=["spring", "magnetic"]).vary("robot.base.mass", low=30.0, high=40.0)
    study.vary("collision.around", low=0.0, high=1.0).vary("collision.angle", low=-20.0, high=20.0)
    study.vary("collision.speed", low=0.3, high=0.6).vary("temperature", low=-10.0, high=50.0)
    study.vary("controller.detector.kind", values=[0, 1]).vary("testbed.electronics.seed", low=1, high=1000)
    study.vary("collision.mass", low=5.0, high=15.0)
    study.designs("latin-hypercube", count=8).objective("peak force of the run")
    return study.run(tmp_path_factory.mktemp("export") / "study", threads=2)


def stored(answers: Answers, collision: str) -> dict[str, float]:
    runs = stored_runs(answers.folder)
    row = np.flatnonzero((runs["design"] == DESIGN) & (runs["collision"] == collision))[0]
    assert runs["status"][row] == "ok"
    return {
        name: runs[name][row]
        for name in ("peak force of the run", "bumper compression", "contact impulse", "contact speed")
    }


def test_an_ssv_is_valid_and_gives_the_fmu_the_design(answers: Answers, tmp_path: Path) -> None:
    values: dict[str, dict[str, object]] = {}
    schema = etree.XMLSchema(etree.parse(SCHEMA))
    for model in ("testbed", "controller"):
        export_design(answers, DESIGN, tmp_path / f"{model}.ssv", model=model)
        schema.assertValid(etree.parse(tmp_path / f"{model}.ssv"))
        values[model] = {}
        for parameter in ElementTree.parse(tmp_path / f"{model}.ssv").iter(f"{{{SSV}}}Parameter"):
            (entry,) = parameter
            values[model][parameter.attrib["name"]] = entry.attrib["value"]
    # The FMUs themselves, over FMPy, with nothing but the file's values.
    bumper = ("none", "spring", "magnetic")[int(str(values["testbed"].pop("bumper.kind")))]
    scenario = giveway.Scenario("exported", 0.2, bumper=bumper, **values)  # type: ignore[arg-type]
    result = giveway.run(scenario)
    expected = stored(answers, "front")
    assert result.metric("peak force of the run").value == pytest.approx(expected["peak force of the run"], rel=1e-12)
    assert result.metric("bumper compression").value == pytest.approx(expected["bumper compression"], rel=1e-12)


def test_an_ssv_for_the_bumper_fmu_holds_the_bumper(answers: Answers, tmp_path: Path) -> None:
    export_design(answers, DESIGN, tmp_path / "bumper.ssv", model="bumper")
    root = ElementTree.parse(tmp_path / "bumper.ssv").getroot()
    names = {parameter.attrib["name"] for parameter in root.iter(f"{{{SSV}}}Parameter")}
    assert names == {"bumper.kind", "bumper.spring_rate", "bumper.latch_force"}
    common = "{http://ssp-standard.org/SSP1/SystemStructureCommon}"
    units = {one.attrib["name"]: one.find(f"{common}BaseUnit") for one in root.iter(f"{common}Unit")}
    assert {name: dict(base.attrib) for name, base in units.items() if base is not None} == {
        "N": {"kg": "1", "m": "1", "s": "-2"},
        "N/m": {"kg": "1", "s": "-2"},
    }


@pytest.mark.parametrize("collision", ["front", "side"])
def test_a_scenario_file_runs_as_in_the_study(answers: Answers, collision: str, tmp_path: Path) -> None:
    export_design(answers, DESIGN, tmp_path / "design.toml", collision=collision)
    result = batch.run(giveway.read_scenario(tmp_path / "design.toml"))
    expected = stored(answers, collision)
    for name in ("peak force of the run", "bumper compression", "contact speed"):
        # Degrees and back, and the place from its coordinates: the slider's start differs in its last digits.
        assert result.metric(name).value == pytest.approx(expected[name], rel=1e-9), name


def test_a_warm_magnet_is_exported_as_weak_as_it_is(tmp_path: Path) -> None:
    answers = small_study(vary=[]).vary("temperature", values=[70.0]).run(tmp_path / "study", threads=2)
    export_design(answers, 0, tmp_path / "warm.toml")
    scenario = giveway.read_scenario(tmp_path / "warm.toml")
    assert scenario.testbed["bumper.latch_force"] == pytest.approx(45.8 * (1.0 - 0.0024 * 50.0), rel=1e-12)


def test_another_gear_is_exported_as_what_it_changes(tmp_path: Path) -> None:
    answers = small_study(vary=[]).vary("gear_ratio", values=[2.0]).run(tmp_path / "study", threads=2)
    export_design(answers, 0, tmp_path / "geared.toml")
    result = batch.run(giveway.read_scenario(tmp_path / "geared.toml"))
    assert result.metric("peak force of the run").value == stored_runs(answers.folder)["peak force of the run"][0]


def test_a_design_with_a_body_region_is_exported_with_its_mass_and_stiffness(tmp_path: Path) -> None:
    study = small_study(vary=[{"quantity": "robot.contact.stiffness", "values": [5000.0, 20000.0]}])
    del study.document["collision"][0]["mass"]
    study.document["scenario"]["body_region"] = "hand"
    answers = study.run(tmp_path / "study", threads=2)
    export_design(answers, 1, tmp_path / "design.toml")
    scenario = giveway.read_scenario(tmp_path / "design.toml")
    assert scenario.judge_as == "hand"
    assert scenario.testbed["slider.mass"] == 0.6
    assert scenario.testbed["contact.stiffness"] == 1.0 / (1.0 / 75000.0 + 1.0 / 20000.0)
    peak = stored_runs(answers.folder)["peak force of the run"][1]
    # Degrees and back: the slider's start differs in its last digits.
    assert batch.run(scenario).metric("peak force of the run").value == pytest.approx(peak, rel=1e-9)


def test_a_folder_says_all_by_itself(tmp_path: Path) -> None:
    """Robot file and designs may be gone: the study keeps copies."""
    (tmp_path / "from").mkdir()
    robot, designs = tmp_path / "from" / "heavy.toml", tmp_path / "from" / "mine.csv"
    text = changed_robot(native.robot(), {"base.mass": NewValue(50.0, "a test", "assumed")})
    robot.write_text(text, encoding="utf-8")
    designs.write_text(f"{LATCH}\n30\n", encoding="utf-8")
    study = small_study(vary=[], designs={"kind": "csv", "file": "mine.csv"})
    study.document["scenario"]["robot"] = "heavy.toml"
    sweep(study.setup(tmp_path / "from"), tmp_path / "study", threads=2)
    robot.unlink()
    designs.unlink()
    answers = load(tmp_path / "study")
    export_design(answers, 0, tmp_path / "design.toml")
    moved = tmp_path.rename(tmp_path.with_name("elsewhere"))  # robots are named as seen from the scenario
    answers = load(moved / "study")
    scenario = giveway.read_scenario(moved / "design.toml")
    assert scenario.parameters("testbed")["base.mass"] == 50.0
    peak = batch.run(scenario).metric("peak force of the run").value
    assert stored_runs(moved / "study")["peak force of the run"][0] == pytest.approx(peak, rel=1e-12)


def test_a_list_of_the_design_is_one_of_designs(answers: Answers, tmp_path: Path) -> None:
    export_design(answers, DESIGN, tmp_path / "design.csv")
    with (tmp_path / "design.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["quantity"] for row in rows] == [one.quantity.name for one in answers.setup.varied]
    (tmp_path / "again.csv").write_text(
        ",".join(row["quantity"] for row in rows) + "\n" + ",".join(row["value"] for row in rows) + "\n",
        encoding="utf-8",
    )
    again = small_study(vary=[], designs={"kind": "csv", "file": "again.csv"}).setup(tmp_path)
    assert again.plan.rows is not None
    np.testing.assert_array_equal(again.plan.rows[0], answers.designs[DESIGN])


def test_the_table_has_every_design_and_goal(answers: Answers, tmp_path: Path) -> None:
    export_table(answers, tmp_path / "all.csv")
    with (tmp_path / "all.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == len(answers.designs)
    peaks = [float(row["peak force of the run, worst collision [N]"] or math.nan) for row in rows]
    np.testing.assert_array_equal(peaks, answers.values[:, 0])


@pytest.mark.parametrize(("design", "name", "keys", "words"), [
    (8, "a.csv", {}, "--design: 8 .* from 0 to 7"),
    (0, "a.txt", {}, r"\.ssv, \.toml or \.csv"),
    (0, "a.toml", {"collision": "frnt"}, "front"),
    (0, "a.ssv", {"model": "drivetrain"}, "--model: drivetrain is unknown"),
])  # fmt: skip
def test_what_cannot_be_exported_is_said(
    answers: Answers, design: int, name: str, keys: dict[str, str], words: str, tmp_path: Path
) -> None:
    with pytest.raises(GivewayError, match=words):
        export_design(answers, design, tmp_path / name, **keys)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        ("kg.m2", {"kg": 1, "m": 2}),
        ("N.m.s/rad", {"kg": 1, "m": 2, "s": -1, "rad": -1}),
        ("m/s2", {"m": 1, "s": -2}),
        ("1", {}),
    ],
)
def test_a_unit_is_told_in_base_units(unit: str, expected: dict[str, int]) -> None:
    assert powers(unit) == expected


def test_a_column_is_what_pyarrow_would_make_of_it() -> None:
    columns = (
        np.array([1.5, np.nan, -np.inf, 1e-300]),
        np.arange(9, dtype=np.float64)[::2],
        np.array([True, False] * 9),
        np.array([], dtype=np.bool_),
        np.array([3, -4], dtype=np.int32),
        np.array(["", "straße", "a,b"], dtype=object),
        ["none", "spring"],
        [],
    )
    for values in columns:
        made = arrow_array(values)
        made.validate(full=True)
        expected = pyarrow.array(np.asarray(values), from_pandas=True)
        assert made.to_pylist() == expected.to_pylist()
        assert str(made.type) == {"int32": "int64", "null": "double"}.get(str(expected.type), str(expected.type))


def test_showing_a_study_imports_no_pandas(tmp_path: Path) -> None:
    small_study().run(tmp_path / "study")
    code = (
        "import sys; from giveway.cli import _main; _main(['study', 'show', 'study']); print('pandas' in sys.modules)"
    )
    found = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert found.stdout.splitlines()[-1] == "False"
