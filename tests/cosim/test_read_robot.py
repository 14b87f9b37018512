"""Robot files: units are converted or refused, and what is not known is refused, with file, line and key."""

from __future__ import annotations

from pathlib import Path

import pytest
from cosim_helpers import Cli, folder_content
from giveway.base import native
from giveway.base.errors import GivewayError
from giveway.base.toml_lines import line_of
from giveway.identification.presliding import Base
from giveway.robot.robot_file import read_robot
from giveway.robot.variables import table

TRIKEY = native.robot().read_text(encoding="utf-8")
MASS = 'value = 34.7\nunit = "kg"'
RADIUS = 'value = 0.1016\nunit = "m"'


def written(folder: Path, *changes: tuple[str, str]) -> Path:
    text = TRIKEY
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    path = folder / "robot.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_units_of_the_same_kind_are_converted(tmp_path: Path) -> None:
    path = written(
        tmp_path,
        (MASS, 'value = 80\nunit = "lb"'),
        (RADIUS, 'value = 101.6\nunit = "mm"'),
        ('value = [0.352184, -0.176092, -0.176092]\nunit = "m"', 'value = [35.2184, -17.6, -17.6]\nunit = "cm"'),
        ('value = 721.0\nunit = "N.m/rad"', 'value = 0.721\nunit = "kN.m/rad"'),
    )
    testbed, controller = (table(model).robot_values(read_robot(path)) for model in ("testbed", "controller"))
    # Each is one product: half an ulp of it and as much of the factor.
    assert testbed["base.mass"] == controller["base.mass"] == pytest.approx(36.2873896, rel=1e-15)
    assert testbed["wheel.radius"] == pytest.approx(0.1016, rel=3e-16)
    assert [testbed[f"outline.x[{i}]"] for i in range(3)] == pytest.approx([0.352184, -0.176, -0.176], rel=3e-16)
    assert testbed["drivetrain.stiffness"] == pytest.approx(721.0, rel=3e-16)
    assert Base.of_robot(path).wheel_radius_m == pytest.approx(0.1016, rel=3e-16)


def test_what_is_in_the_tables_units_keeps_its_bits_and_type() -> None:
    robot = read_robot(native.robot())
    assert all(entry.scale == 1.0 for _, entry in robot.entries())
    assert robot.value("base.mass") == 34.7
    assert isinstance(robot.value("drivetrain.encoder_counts"), int)


def test_a_file_may_say_nothing_of_equipment_that_its_robot_has_not(tmp_path: Path) -> None:
    """A file from before there was an accelerometer: the starts stay. Half of its numbers are refused."""
    start = TRIKEY.index("# --- Accelerometer")
    block = TRIKEY[start : TRIKEY.index("# --- Body outline")]
    values = table("testbed").robot_values(read_robot(written(tmp_path, (block, ""))))
    assert "base.mass" in values
    assert not [name for name in values if name.startswith("imu.")]
    height = block[block.index("[imu.height]") : block.index("[imu.acceleration_noise]")]
    with pytest.raises(GivewayError, match=r"imu\.height is missing"):
        table("testbed").robot_values(read_robot(written(tmp_path, (height, ""))))


def test_entries_are_shown_as_the_file_states_them(tmp_path: Path) -> None:
    entries = dict(read_robot(written(tmp_path, (MASS, 'value = 80\nunit = "lb"'))).entries())
    assert entries["base.mass"].text == "80 lb"
    assert entries["base.mass"].unit == "kg"
    assert entries["wheel.grip_friction"].text == "0.7"


# What replaces what in Trikey's file; what the line begins with; words of the message.
WRONG: dict[str, tuple[str, str, str, tuple[str, ...]]] = {
    "another kind": (MASS, 'value = 34.7\nunit = "m"', "unit", ("base.mass.unit: m ", "kg, or a unit of the same")),
    "unknown unit": (MASS, 'value = 34.7\nunit = "stone"', "unit", ("base.mass.unit: stone", "kg")),
    "unit of a number without": ('value = 0.7\nunit = "1"', 'value = 0.7\nunit = "N"', "unit", ("it has no unit",)),
    "no unit": (MASS, "value = 34.7", "[base.mass]", ("base.mass.unit: nothing", '"kg"', "needed")),
    "no value": (MASS, 'unit = "kg"', "[base.mass]", ("base.mass.value: nothing", "needed")),
    "out of range": (RADIUS, 'value = 0.05\nunit = "mm"', "value", ("wheel.radius: 0.05 mm (5e-05 m)", "0.01 to 1 m")),
    "unknown number": ("[wheel.width]", "[wheel.count]", "[wheel.count]", ("wheel.count: count", "width")),
    "unknown word": ("[base.mass]", "[base.maas]", "[base.maas]", ("did you mean mass?",)),
    "unknown table": ("[base.mass]", "[bass.mass]", "[bass.mass]", ("bass", "did you mean base?")),
    "unknown key": ("confidence = ", "confidense = ", "confidense", ("confidense", "did you mean confidence?")),
    "unknown provenance": ('provenance = "sourced"', 'provenance = "guessed"', "provenance", ("guessed", "assumed")),
    "unknown confidence": ('confidence = "medium"', 'confidence = "medum"', "confidence", ("did you mean medium?",)),
    "source is no text": ('note = "4 in"', "note = 4", "note", ("wheel.radius.note: 4", "text in quotes")),
    "a list": (MASS, 'value = [34.7, 1.0]\nunit = "kg"', "value", ("base.mass.value: [34.7, 1.0]", "one number")),
    "too long a list": ("value = [0.352184,", f"value = [{'0.1, ' * 15}", "value", ("outline.x.value", "1 to 16")),
    "text": (MASS, 'value = "34.7"\nunit = "kg"', "value", ("base.mass.value", "finite number")),
    "NaN": (MASS, 'value = nan\nunit = "kg"', "value", ("base.mass.value: nan", "finite number")),
    "no table": (
        TRIKEY[TRIKEY.index("[contact.damping]") :],
        "[contact]\ndamping = 0.3\n",
        "damping",
        ("contact.damping: 0.3", "a table with value and unit"),
    ),
    "of the robot": ('name = "Trikey"', 'nme = "Trikey"', "nme", ("robot.nme", "did you mean name?")),
    "version": ("schema_version = 1", "schema_version = 7", "schema_version", ("schema_version: 7", "allowed: 1")),
    "no TOML": ("[base.mass]", "[base.mass", "[base.mass", ("not TOML",)),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_files_are_refused_by_file_line_and_key(case: str, tmp_path: Path) -> None:
    old, new, begins, words = WRONG[case]
    path = written(tmp_path, (old, new))
    with pytest.raises(GivewayError) as caught:
        table("testbed").robot_values(read_robot(path))
    message = str(caught.value)
    assert message.startswith(f"{path}:")
    line = int(message.removeprefix(f"{path}:").partition(":")[0])
    assert path.read_text().splitlines()[line - 1].startswith(begins), message
    for word in words:
        assert word in message


def test_every_command_that_takes_a_robot_refuses(cli: Cli, tmp_path: Path) -> None:
    written(tmp_path, ("[wheel.width]", "[wheel.count]"))
    (tmp_path / "case.toml").write_text('schema_version = 1\nduration = 0.1\nrobot = "robot.toml"\n')
    (tmp_path / "log.csv").write_text("")
    robot = ("--robot", "robot.toml")
    for command in (
        ("run", "motionless", *robot, "--out", "out"),
        ("run", "case.toml", "--out", "out"),
        ("drivetrain", *robot),
        ("calibrate", "log.csv", *robot, "--out", "new.toml"),
        ("fit", *robot, "--out", "new.toml"),
        ("ssp", *robot, "--out", "new.ssp"),
    ):
        done = cli(*command)
        assert done.returncode == 2, command
        assert len(done.stderr.splitlines()) == 1, done.stderr
        assert "robot.toml:" in done.stderr
        assert "wheel.count" in done.stderr
    assert folder_content(tmp_path) == ["case.toml", "log.csv", "robot.toml"]


def test_the_line_of_a_name_is_where_its_statement_begins() -> None:
    """Against the definition: the first beginning of the text that sets the name, tried line by line."""
    text = "a = 1\n# a comment\n[b]\nc = [\n  1,\n  2,\n]\n\nd = 4\n[[e]]\nf = 1\n[[e]]\nf = 2\n"
    lines = {"a": 1, "b": 3, "b.c": 4, "b.c[1]": 4, "b.d": 9, "e[0].f": 11, "e[1]": 12, "e[1].f": 13}
    assert {name: line_of(text, name) for name in lines} == lines
    assert line_of(text, "b.missing") == 3
    assert line_of(text, "missing") == 1
