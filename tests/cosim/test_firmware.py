"""`giveway firmware`: what it writes compiles, for this machine and for a Cortex-M4F, and has the FMU's bits."""

from __future__ import annotations

import os
import random
import re
import struct
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from cosim_helpers import Cli, folder_content
from giveway.base import native
from giveway.firmware.c_text import comment, quoted, real
from giveway.firmware.config_source import config_source
from giveway.firmware.core import core_files
from giveway.firmware.settings import Settings
from giveway.robot.variables import table
from giveway.scenario.scenario import Scenario

ROOT = Path(__file__).parents[2]
ROBOTS = sorted(native.robots())


@pytest.fixture(scope="module")
def workshop(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder for firmware whose C library is compiled once."""
    return tmp_path_factory.mktemp("firmware")


def make(folder: Path, *targets: str, flags: str = "-O2 -Werror") -> subprocess.CompletedProcess[str]:
    environment = {name: value for name, value in os.environ.items() if not name.startswith("MAKE")}
    return subprocess.run(
        ["make", "-sj2", "-C", folder, f"CORE_BUILD={folder.parent / 'core'}", f"CFLAGS={flags}", *targets],
        capture_output=True, text=True, check=False, timeout=300, env=environment,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("robot", "target"),
    [
        *((robot, "test") for robot in ROBOTS),
        ("delivery", "test-arm"),  # it has sensors of every kind
        *(pytest.param(robot, "test-arm", marks=pytest.mark.deep) for robot in ROBOTS if robot != "delivery"),
    ],
)
def test_the_self_test_passes_here_and_on_a_cortex_m4f(robot: str, target: str, workshop: Path, cli: Cli) -> None:
    folder = workshop / f"{robot}-{target}"
    done = cli("firmware", robot, "--out", str(folder))
    assert done.returncode == 0, done.stderr
    assert "at 0.5 m/s, which the controller notices" in done.stdout
    outputs = len(table("controller").select("output"))
    tested = make(folder, target)
    assert tested.returncode == 0, tested.stdout + tested.stderr
    bits, drives = tested.stdout.splitlines()
    assert re.fullmatch(rf"\w.*: \d+ ticks of {outputs} outputs: the recorded bits; hits: [1-9]\d*", bits)
    assert drives == "without sensors: wheels held, then drives off"


def test_another_configuration_is_noticed_and_named(workshop: Path, cli: Cli) -> None:
    """One unit in the last place of the mass; and one that the library refuses."""
    folder = workshop / "changed"
    assert cli("firmware", "trikey", "--out", str(folder), "--set", "controller.channels.fast_rest=8").returncode == 0
    assert make(folder, "test").returncode == 0
    config = folder / "robot_config.c"
    text = config.read_text()
    (mass,) = re.findall(r"\.base\.mass_kg = ([\d.]+)F,", text)
    more = real(float(np.nextafter(np.float32(mass), np.float32(1e9))))
    config.write_text(text.replace(f".base.mass_kg = {mass}F", f".base.mass_kg = {more}"))
    told = make(folder, "test")
    assert told.returncode != 0
    names = "|".join(re.escape(variable.name) for variable in table("controller").select("output"))
    assert re.fullmatch(
        rf"tick \d+: ({names}) has the bits [0-9a-f]{{16}}, recorded were [0-9a-f]{{16}}\n", told.stdout
    )
    config.write_text(text.replace(f".base.mass_kg = {mass}F", ".base.mass_kg = -1.0F"))
    assert make(folder, "test").stdout == "the configuration was refused: base.mass\n"


def structures(headers: str) -> dict[str, list[tuple[str, str, int]]]:
    """Name of each structure to type, name and length (0: no array) of its members."""
    headers = re.sub(r"/\*.*?\*/", "", headers, flags=re.DOTALL)
    sizes = dict(re.findall(r"#define (GW_\w+) (\d+)U$", headers, re.MULTILINE))
    found = {}
    for body, name in re.findall(r"typedef struct \{([^{}]*)\} (gw_(?:\w+_config|vector|\w+_floors)_t);", headers):
        members = re.findall(r"^\s+(\w+) (\w+)(?:\[(\w+)\])?;", body, re.MULTILINE)
        assert len(members) == body.count(";"), name
        found[name] = [(kind, member, int(sizes[size]) if size else 0) for kind, member, size in members]
    return found


def leaves(known: dict[str, list[tuple[str, str, int]]], structure: str, before: str = "") -> Iterator[str]:
    """Every number in a structure, as a designator."""
    for kind, member, length in known[structure]:
        for place in [f"[{index}]" for index in range(length)] if length else [""]:
            name = f"{before}.{member}{place}"
            yield from leaves(known, kind, name) if kind in known else [name]


def set_fields(text: str) -> list[str]:
    return re.findall(r"^    (\.[\w.\[\]]+) = ", text, re.MULTILINE)


def test_every_field_of_the_configuration_is_written_once() -> None:
    files = core_files()
    headers = "\n".join(content.decode() for name, content in files.items() if name.startswith("c_core/include/"))
    written = set_fields(config_source(Settings.of(native.robot())))
    fields = list(leaves(structures(headers), "gw_controller_config_t"))
    assert len(fields) > 100
    assert sorted(written) == sorted(fields)
    # A field that is added to any part of it would be missed.
    for planted in ("gw_controller_config_t", "gw_imu_config_t", "gw_geometry_config_t"):
        more = headers.replace(f"}} {planted};", f"    gw_real_t planted_m;\n}} {planted};")
        assert sorted(written) != sorted(leaves(structures(more), "gw_controller_config_t"))


def test_each_field_has_value_unit_and_origin() -> None:
    settings = Settings.of(native.robots()["delivery"], "paper", {"channels.fast_rest": 7.5})
    text = re.sub(r"\n +\* ", " ", config_source(settings))
    for words in (
        "/* base.mass [kg]: Mass of the robot, wheels included. From delivery.toml, base.mass: assumed, medium "
        "confidence, design target of the made-up robot, wheels and a load of 10 kg included; empty 50 kg. */\n"
        "    .base.mass_kg = 60.0F,\n",
        'Of the preset "paper". */\n    .detector.kind = 1U,\n',
        "Set on the command line. */\n    .channels.fast.rest_n = 7.5F,\n",
        "Start value of the controller. */\n    .drives_enabled = true,\n",
        "From delivery.toml, the number of corners. */\n",
    ):
        assert words in text


@pytest.mark.parametrize("preset", ["default", "paper"])
@pytest.mark.parametrize("robot", ROBOTS)
def test_values_are_those_of_a_run(robot: str, preset: str) -> None:
    path, assigned = native.robots()[robot], {"contact.minimum_force": 3.25, "controller.drives_enabled": False}
    scenario = Scenario("any", 1.0, robot=path, preset=preset, controller=assigned)
    start = {variable.name: variable.start for variable in table("controller").select("parameter")}
    assert Settings.of(path, preset, assigned).parameters() == start | scenario.parameters("controller")


def test_the_library_is_that_of_the_repository() -> None:
    for name, content in core_files().items():
        assert content == (ROOT / name).read_bytes(), name
    there = {path.relative_to(ROOT).as_posix() for path in (ROOT / "c_core").rglob("gw_*.[ch]")}
    assert there <= set(core_files())


def test_reals_have_the_bits_of_the_value() -> None:
    draw = random.Random(1)
    values = [struct.unpack("<f", struct.pack("<I", draw.getrandbits(32)))[0] for _ in range(2000)]
    for value in [0.0, -0.0, 1.0, 1e-45, 3.4028234663852886e38, 0.1, *values]:
        if np.isfinite(value):
            text = real(value)
            assert re.fullmatch(r"-?\d+(\.\d+)?(e[+-]\d+)?F", text), text
            assert "." in text or "e" in text, text
            assert np.float32(text.removesuffix("F")).tobytes() == np.float32(value).tobytes()


def test_words_of_a_robot_file_cannot_become_code() -> None:
    assert comment("a */ int x; /* b\nc \\") == "/* a * / int x; / * b c / */\n"
    assert quoted('My "first"\\ ro??/bot é') == '"My \\"first\\"\\\\ ro?/bot ?"'


def test_a_robot_without_a_resolution_gets_one_that_is_named(cli: Cli, tmp_path: Path) -> None:
    text = native.robot().read_text(encoding="utf-8")
    section = "[drivetrain.torque_sensor_resolution]\nvalue = "
    text = text.replace(f"{section}0.0143", f"{section}0.0")
    (tmp_path / "mine.toml").write_text(text, encoding="utf-8")
    done = cli("firmware", "mine.toml", "--out", "out")
    assert done.returncode == 0, done.stderr
    assert "mine.toml states no resolution of the torque signal: a count is assumed as 16 bits" in done.stdout
    header = (tmp_path / "out" / "robot_config.h").read_text()
    assert f"#define ROBOT_TORQUE_NM_PER_COUNT {real(28.0 / 32767.0)}\n" in header


WRONG = {
    "no such robot": (("firmware", "trikee", "--out", "out"), ("ROBOT: trikee is unknown", "trikey?")),
    "no such file": (("firmware", "mine.toml", "--out", "out"), ("mine.toml", "no such file")),
    "no folder": (("firmware", "trikey"), ("--out",)),
    "a file as folder": (("firmware", "trikey", "--out", "/dev/null"), ("/dev/null",)),
    "no such preset": (("firmware", "trikey", "--out", "out", "--preset", "quick"), ("--preset", "quick", "paper")),
    "the testbed": (
        ("firmware", "trikey", "--out", "out", "--set", "testbed.base.mass=3"),
        ("--set: testbed.base.mass", "controller.NAME=VALUE"),
    ),
    "out of range": (
        ("firmware", "trikey", "--out", "out", "--set", "controller.base.mass=0"),
        ("controller.base.mass", "0.1 to 2000 kg"),
    ),
    "refused together": (
        ("firmware", "trikey", "--out", "out", "--set", "controller.geometry.wheel_slot[0]=1"),
        ("geometry.wheel_slot",),
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_input_is_one_line_and_writes_nothing(case: str, cli: Cli, tmp_path: Path) -> None:
    arguments, words = WRONG[case]
    done = cli(*arguments)
    assert done.returncode != 0
    assert len(done.stderr.splitlines()) == 1, done.stderr
    for word in words:
        assert word in done.stderr
    assert folder_content(tmp_path) == []


def test_files_of_others_stay(cli: Cli, tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "bus.c").write_text("/* years of work */")
    (tmp_path / "mine" / "robot_config.c").write_text("old")
    done = cli("firmware", "trikey", "--out", "mine")
    assert done.returncode == 2
    assert "mine: is not empty; give a new or an empty folder, or --force" in done.stderr
    assert sorted(path.name for path in (tmp_path / "mine").iterdir()) == ["bus.c", "robot_config.c"]
    assert cli("firmware", "trikey", "--out", "mine", "--force").returncode == 0
    assert (tmp_path / "mine" / "bus.c").read_text() == "/* years of work */"
    assert (tmp_path / "mine" / "robot_config.c").read_text().startswith("#include")
    assert (tmp_path / "mine" / "c_core" / "src" / "gw_controller.c").is_file()


def test_the_command_line_writes_it(process: Cli, tmp_path: Path) -> None:
    done = process("firmware", "trikey", "--out", "out", "--preset", "paper")
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "Written: out; build and test it with: make -C out test"
    assert (tmp_path / "out" / "main_step.c").is_file()
