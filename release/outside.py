"""What other people's checkers say: twine of metadata and README as PyPI wants them, cffconvert of CITATION.cff,
spdx-tools of the bills of materials. `make release` installs them from release/requirements.lock."""

from __future__ import annotations

import subprocess
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path

from release import archives
from release.parts import ROOT
from release.wheel import BUILD

__all__ = ["faults"]

TOOLS = BUILD / "release" / "tools" / "bin"
SHOWN = 400  # characters of an answer: spdx-tools repeats itself for every file


def faults(written: Sequence[Path], citation: Path = ROOT / "CITATION.cff") -> list[str]:
    """Of the files that `make release` wrote, and of ``citation``."""
    found = _said("CITATION.cff", "cffconvert", "--validate", "--infile", citation)
    for path in written:
        if path.suffix in (".whl", ".gz"):
            found += _said(path.name, "twine", "check", "--strict", path)
        if path.name.endswith(".spdx.json"):
            found += _said(path.name, "pyspdxtools", "--infile", path)
        if path.suffix == ".whl":
            found += _bill_inside(path)
    return found


def _bill_inside(wheel: Path) -> list[str]:
    with zipfile.ZipFile(wheel) as archive, tempfile.TemporaryDirectory() as folder:
        (name,) = (one for one in archive.namelist() if one.endswith(".spdx.json"))
        archives.put(Path(folder) / "giveway.spdx.json", archive.read(name))
        return _said(f"{wheel.name}: {name}", "pyspdxtools", "--infile", Path(folder) / "giveway.spdx.json")


def _said(about: str, tool: str, *arguments: str | Path) -> list[str]:
    """Nothing, if the tool is content."""
    try:
        answer = subprocess.run([TOOLS / tool, *arguments], capture_output=True, text=True, check=False)
    except FileNotFoundError:
        return [f"{tool} is not there; `make build/release/tools-installed` installs it"]
    return [f"{about}: {tool}: {(answer.stdout + answer.stderr).strip()[:SHOWN]}"] if answer.returncode else []
