"""One version everywhere it is written down."""

import re
import tomllib
from pathlib import Path

import giveway

ROOT = Path(__file__).parents[2]


def first(pattern: str, file: str) -> str:
    match = re.search(pattern, (ROOT / file).read_text(), re.MULTILINE)
    assert match, f"{file} states no version"
    return match[1]


def test_every_file_states_the_same_version() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    stated = {
        "CMakeLists.txt": first(r"^project\(giveway VERSION ([\d.]+)", "CMakeLists.txt"),
        "c_core/CMakeLists.txt": first(r"^project\(giveway_core VERSION ([\d.]+)", "c_core/CMakeLists.txt"),
        "CITATION.cff": first(r"^version: (\S+)$", "CITATION.cff"),
        "CHANGELOG.md": first(r"^## ([\d.]+)", "CHANGELOG.md"),
        "giveway.__version__": giveway.__version__,
    }
    assert stated == dict.fromkeys(stated, project)
