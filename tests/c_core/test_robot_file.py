"""All C constants of Trikey equal the numbers of the robot file."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from giveway.robot.robot_file import read_robot

ROOT = Path(__file__).parents[2]
HEADER = ROOT / "c_core" / "include" / "giveway" / "gw_trikey.h"
DEFINE = re.compile(r"^#define GW_TRIKEY_(\w+) (?:\(\(gw_real_t\)(\S+?)\)|(\d+)U)", re.MULTILINE)


def robot_values() -> dict[str, float]:
    """Name in capitals, such as BASE_MASS, to value; lists by element."""
    values: dict[str, float] = {}
    for name, entry in read_robot(ROOT / "robots" / "trikey.toml").entries():
        key = name.replace(".", "_").upper()
        if entry.is_list:
            values |= {f"{key}{index}": value for index, value in enumerate(entry.values)}
        else:
            values[key] = entry.values[0]
    return values


def constants() -> dict[str, float]:
    return {name: float(real or count) for name, real, count in DEFINE.findall(HEADER.read_text(encoding="utf-8"))}


def test_the_header_is_read_whole() -> None:
    assert len(constants()) == HEADER.read_text(encoding="utf-8").count("#define GW_TRIKEY_") - 1  # the guard


@pytest.mark.parametrize("name", sorted(set(constants()) - {"OUTLINE_COUNT"}))
def test_constant_is_the_robot_files_number(name: str) -> None:
    values = robot_values()
    # The rest of the constant's name is its unit.
    keys = [key for key in values if name == key or name.startswith(f"{key}_")]
    assert keys, f"{name} has no entry in the robot file"
    assert constants()[name] == values[max(keys, key=len)]


def test_outline_has_as_many_corners() -> None:
    assert constants()["OUTLINE_COUNT"] == sum(key.startswith("OUTLINE_X") for key in robot_values())
