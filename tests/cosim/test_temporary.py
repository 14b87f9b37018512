"""Unpacked FMUs do not pile up: they go at the end of the process, and a killed one's when the next begins."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

WORK = """
import sys
from giveway.base import native
from giveway.simulation.fmu import open_fmu
print(open_fmu(native.fmu("bumper", 3)).folder, flush=True)
sys.stdin.read()
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    path = tmp_path / "temporary"
    path.mkdir()
    return path


def unpacking(folder: Path) -> tuple[subprocess.Popen[str], Path]:
    """A process that has unpacked an FMU, and where; it ends when its input does."""
    process = subprocess.Popen(
        [sys.executable, "-c", WORK],
        env={**os.environ, "TMPDIR": str(folder)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    path = Path(process.stdout.readline().strip())
    assert path.parent == folder
    assert (path / "modelDescription.xml").is_file()
    return process, path


def test_what_a_killed_process_unpacked_goes_with_the_next(folder: Path) -> None:
    process, left = unpacking(folder)
    process.kill()
    process.communicate()
    assert left.is_dir()
    after, mine = unpacking(folder)
    assert list(folder.iterdir()) == [mine]
    after.communicate()
    assert list(folder.iterdir()) == []


def test_what_a_living_process_unpacked_stays(folder: Path) -> None:
    first, of_first = unpacking(folder)
    second, of_second = unpacking(folder)
    assert set(folder.iterdir()) == {of_first, of_second}
    second.communicate()
    assert list(folder.iterdir()) == [of_first]
    assert (of_first / "modelDescription.xml").is_file()
    first.communicate()
    assert list(folder.iterdir()) == []


def test_a_stranger_of_that_name_stays(folder: Path, tmp_path: Path) -> None:
    """A file, or a link to somebody's folder."""
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").write_text("...")
    (folder / "giveway-unpacked-file").write_text("...")
    (folder / "giveway-unpacked-link").symlink_to(tmp_path / "mine")
    process, _ = unpacking(folder)
    process.communicate()
    assert {path.name for path in folder.iterdir()} == {"giveway-unpacked-file", "giveway-unpacked-link"}
    assert (tmp_path / "mine" / "thesis.tex").is_file()
