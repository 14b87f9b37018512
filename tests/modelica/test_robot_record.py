"""The record of the robot's numbers is the robot file, neither more nor less."""

from pathlib import Path

from giveway_modelica.compiler import PACKAGE, Compiler
from giveway_modelica.robot_record import numbers, record

ROBOT = Path(__file__).parents[2] / "robots" / "trikey.toml"
RECORD = PACKAGE / "Parameters" / "Trikey.mo"


def test_the_record_is_fresh() -> None:
    assert RECORD.read_text() == record(ROBOT), "run `PYTHONPATH=modelica .venv/bin/python -m giveway_modelica record`"


def test_the_compiler_reads_the_robot_files_numbers(compiler: Compiler) -> None:
    parameters = compiler.load("GiveWay.Components.Drivetrain").parameters
    entries = dict(numbers(ROBOT))
    assert len(entries) > 50
    for name, entry in entries.items():
        if not entry.is_list:  # rumoca does not tell the value of an array
            assert parameters[f"robot.{name}"].value == entry.values[0], name


def test_a_changed_number_changes_the_record(tmp_path: Path) -> None:
    changed = tmp_path / "trikey.toml"
    changed.write_text(ROBOT.read_text().replace("value = 34.7", "value = 34.8"))
    assert record(changed) != RECORD.read_text()


def test_another_unit_makes_the_same_record(tmp_path: Path) -> None:
    changed = tmp_path / "trikey.toml"
    changed.write_text(ROBOT.read_text().replace('value = 721.0\nunit = "N.m/rad"', 'value = 0.721\nunit = "kN.m/rad"'))
    assert "kN.m" in changed.read_text()
    assert record(changed) == RECORD.read_text()
