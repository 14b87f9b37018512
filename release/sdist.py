"""The source archive: the repository's files, and inside vendor/ what its build would fetch by cargo and npm."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

from release import archives, wheel
from release.parts import ROOT, sundials_folder

__all__ = ["contents", "write"]

# Tests and proofs need much more than the archive can hold.
LEFT_OUT = (".ci/", ".github/", "tests/", "verify/", "importers/", "bench/", "docs/")


def _files() -> list[str]:
    said = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return [name for name in said.split("\0") if name and not name.startswith(LEFT_OUT)]


def _sundials() -> dict[str, bytes]:
    """The sources that cmake/Sundials.cmake compiles, all headers, and the licence."""
    folder = sundials_folder()
    text = (ROOT / "cmake" / "Sundials.cmake").read_text(encoding="utf-8")
    (listed,) = re.findall(r"set\(_sundials_files\n(.*?)\)", text, re.DOTALL)
    modules = {Path(line.strip()).parent for line in listed.splitlines()}
    files = [folder / name for name in ("LICENSE", "NOTICE")]
    files += [path for path in (folder / "include").rglob("*") if path.is_file()]
    files += [path for module in modules for path in (folder / "src" / module).iterdir() if path.is_file()]
    return {f"vendor/sundials/{path.relative_to(folder).as_posix()}": path.read_bytes() for path in files}


def contents() -> dict[str, bytes]:
    found = {name: (ROOT / name).read_bytes() for name in _files()}
    found |= _sundials()
    for path in sorted((wheel.BUILD / "web" / "pages").iterdir()):
        found[f"vendor/pages/{path.name}"] = path.read_bytes()
    found["PKG-INFO"] = wheel.metadata()["METADATA"]
    return found


def write(folder: Path) -> Path:
    """Write giveway-VERSION.tar.gz to ``folder``."""
    top = f"giveway-{wheel.version()}"
    found = contents()
    programs = [f"{top}/{name}" for name in found if name.endswith(".sh")]
    path = folder / f"{top}.tar.gz"
    archives.write_tar(path, {f"{top}/{name}": data for name, data in found.items()}, programs)
    return path
