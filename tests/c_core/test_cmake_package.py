"""Other CMake projects can use c_core: installed and found by find_package, or as a subdirectory."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

CORE = Path(__file__).parents[2] / "c_core"
USER = Path(__file__).parent / "package"
CMAKE = str(Path(sys.executable).parent / "cmake")


def cmake(*arguments: str | Path, fails: bool = False) -> str:
    answer = subprocess.run([CMAKE, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    assert (answer.returncode != 0) == fails, answer.stdout + answer.stderr
    return answer.stdout + answer.stderr


def check_programs(build: Path) -> None:
    cmake("--build", build)
    for program, size in (("use_core", 4), ("use_core_double", 8)):
        answer = subprocess.run([build / program], capture_output=True, text=True, check=True)
        assert answer.stdout == f"{size} 34.7\n"


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("giveway")
    cmake("-S", CORE, "-B", folder / "build")
    cmake("--build", folder / "build")
    cmake("--install", folder / "build", "--prefix", folder / "usr")
    return folder / "usr"


def test_find_package_finds_what_was_installed(installed: Path, tmp_path: Path) -> None:
    cmake("-S", USER, "-B", tmp_path, f"-DCMAKE_PREFIX_PATH={installed}")
    check_programs(tmp_path)


def test_another_minor_version_is_refused(installed: Path, tmp_path: Path) -> None:
    project = tmp_path / "user"
    project.mkdir()
    text = (USER / "CMakeLists.txt").read_text()
    assert "giveway 0.1 " in text
    (project / "CMakeLists.txt").write_text(text.replace("giveway 0.1 ", "giveway 0.2 "))
    (project / "use.c").write_text((USER / "use.c").read_text())
    said = cmake("-S", project, "-B", tmp_path / "build", f"-DCMAKE_PREFIX_PATH={installed}", fails=True)
    assert "requested version" in said


def test_the_folder_can_be_a_subdirectory(tmp_path: Path) -> None:
    cmake("-S", USER, "-B", tmp_path, f"-DGIVEWAY_SOURCE={CORE}")
    check_programs(tmp_path)


def test_a_caller_is_compiled_with_what_was_left_out(tmp_path: Path) -> None:
    options = ("-DGIVEWAY_WITH_CHANNELS=OFF", "-DGIVEWAY_WITH_ESCAPE=OFF", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON")
    cmake("-S", USER, "-B", tmp_path, f"-DGIVEWAY_SOURCE={CORE}", *options)
    commands = json.loads((tmp_path / "compile_commands.json").read_text(encoding="utf-8"))
    of_caller = [one["command"].split() for one in commands if one["file"] == str(USER / "use.c")]
    assert len(of_caller) == 2
    for words in of_caller:
        assert {"-DGW_WITH_CHANNELS=0", "-DGW_WITH_ESCAPE=0"} <= set(words)


@pytest.mark.parametrize("flag", ["-DGW_WITH_CHANNELS=0", "-DGW_WITH_ESCAPE=0", "-DGW_REAL_DOUBLE=1"])
def test_flags_that_a_caller_would_not_get_are_refused(flag: str, tmp_path: Path) -> None:
    said = cmake("-S", CORE, "-B", tmp_path, f"-DCMAKE_C_FLAGS={flag}", fails=True)
    assert f"{flag[2:-2]} is not allowed" in said
