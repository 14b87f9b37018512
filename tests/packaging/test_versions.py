"""The version stands in pyproject.toml. CMake reads it there; what has to stand alone repeats it."""

from __future__ import annotations

import ctypes
import re
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import giveway
import pytest

ROOT = Path(__file__).parents[2]
VERSION = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]


@pytest.mark.parametrize(
    ("file", "pattern"),
    [
        ("c_core/CMakeLists.txt", r"^project\(giveway_core VERSION ([\d.]+)"),  # also builds on its own
        ("modelica/GiveWay/package.mo", r'^    version="([\d.]+)"'),
        ("CITATION.cff", r"^version: (\S+)$"),
        ("CHANGELOG.md", r"^## ([\d.]+)"),
    ],
)
def test_a_file_repeats_the_version(file: str, pattern: str) -> None:
    stated = re.search(pattern, (ROOT / file).read_text(), re.MULTILINE)
    assert stated, f"{file} states no version"
    assert stated[1] == VERSION


def test_what_was_built_has_the_version() -> None:
    """Package, batch library and FMUs, by way of CMake."""
    assert giveway.__version__ == VERSION
    native = Path(giveway.__file__).parent / "native"
    library = ctypes.CDLL(str(native / "giveway_batch.so"))
    library.gwb_version.restype = ctypes.c_char_p
    assert library.gwb_version().decode() == VERSION
    fmus = list(native.glob("*.fmu"))
    assert len(fmus) == 8
    for path in fmus:
        with zipfile.ZipFile(path) as archive:
            description = ElementTree.fromstring(archive.read("modelDescription.xml"))
        assert description.get("version") == VERSION, path.name


def test_cmake_reads_the_version(tmp_path: Path) -> None:
    """The first lines of CMakeLists.txt, of another version."""
    stated = (ROOT / "CMakeLists.txt").read_text()
    (tmp_path / "CMakeLists.txt").write_text(
        stated[: stated.index("LANGUAGES C CXX)")] + 'LANGUAGES NONE)\nmessage(STATUS "is ${PROJECT_VERSION}")\n'
    )
    text = (ROOT / "pyproject.toml").read_text()
    (tmp_path / "pyproject.toml").write_text(text.replace(f'version = "{VERSION}"', 'version = "12.3.4"', 1))
    cmake = Path(sys.executable).with_name("cmake")
    said = subprocess.run([cmake, "-S", tmp_path, "-B", tmp_path / "build"], check=True, capture_output=True, text=True)
    assert "is 12.3.4\n" in said.stdout
