"""A robot file with values replaced keeps all the rest, comments and order included."""

from __future__ import annotations

import dataclasses
import difflib
from pathlib import Path

import pytest
from giveway.base import native
from giveway.base.errors import FileError
from giveway.robot.changes import NewValue, changed_robot
from giveway.robot.robot_file import read_robot

NEW = NewValue(0.25, "a test", "fitted", "medium", "a note")


def test_only_the_entry_changes(tmp_path: Path) -> None:
    old = native.robot().read_text()
    new = changed_robot(native.robot(), {"roller.coulomb_torque": NEW})
    changes = [line for line in difflib.ndiff(old.splitlines(), new.splitlines()) if line[0] in "+-"]
    assert [line for line in changes if line.startswith("+")] == [
        "+ value = 0.25",
        '+ source = "a test"',
        '+ confidence = "medium"',
        '+ provenance = "fitted"',
        '+ note = "a note"',
    ]
    assert sum(line.startswith("-") for line in changes) == 5
    (tmp_path / "new.toml").write_text(new)
    read = read_robot(tmp_path / "new.toml")
    assert read.value("roller.coulomb_torque") == 0.25
    assert dict(read.entries())["roller.coulomb_torque"].text == "0.25 N.m"


def test_comments_and_odd_layouts_stay(tmp_path: Path) -> None:
    text = (
        "# mine\nschema_version = 1 # first\n"
        "roller.radius = { value = 1.0, unit = 'mm' } # inline\n[servo.kp]\nvalue = 3\nunit = 'N.m/rad'\n"
    )
    (tmp_path / "robot.toml").write_text(text)
    new = changed_robot(tmp_path / "robot.toml", {"roller.radius": NEW, "servo.kp": NEW})
    for kept in ("# mine", "schema_version = 1 # first", "# inline", "unit = 'mm'"):
        assert kept in new


def test_a_setting_is_added_at_the_end_and_then_replaced(tmp_path: Path) -> None:
    new = dataclasses.replace(NEW, value=2.5, unit="N", note='of "logs"')
    names = ("controller.channels.fast_rest", "controller.channels.slow_rest")
    first = tmp_path / "first.toml"
    first.write_text(changed_robot(native.robot(), dict.fromkeys(names, new)), encoding="utf-8")
    assert first.read_text(encoding="utf-8").startswith(native.robot().read_text(encoding="utf-8").rstrip("\n"))
    read = read_robot(first)
    assert [read.value(name) for name in names] == [2.5, 2.5]
    assert read[names[0]].note == 'of "logs"'
    second = changed_robot(first, {names[0]: dataclasses.replace(new, value=3.5)})
    assert second == first.read_text(encoding="utf-8").replace("value = 2.5", "value = 3.5", 1)
    inline = tmp_path / "inline.toml"
    text = native.robot().read_text(encoding="utf-8")
    entry = '{ value = 1.0, unit = "N" }'
    inline.write_text(f"{text}\n[controller]\nchannels = {{ fast_rest = {entry} }}\n", encoding="utf-8")
    with pytest.raises(FileError, match=r"controller\.channels\.slow_rest cannot be added"):
        changed_robot(inline, {names[1]: new})


def test_what_is_not_there_is_not_added() -> None:
    with pytest.raises(FileError, match=r"roller\.coulomb is missing.*roller\.coulomb_torque"):
        changed_robot(native.robot(), {"roller.coulomb": NEW})


def test_the_new_value_is_written_in_the_unit_of_the_file(tmp_path: Path) -> None:
    text = native.robot().read_text().replace('value = 0.2\nunit = "N.m"', 'value = 200.0\nunit = "N.mm"')
    path = tmp_path / "robot.toml"
    path.write_text(text)
    assert read_robot(path).value("roller.coulomb_torque") == 0.2
    path.write_text(changed_robot(path, {"roller.coulomb_torque": NEW}))
    assert 'value = 250.0\nunit = "N.mm"' in path.read_text()
    assert read_robot(path).value("roller.coulomb_torque") == 0.25
