"""Builds the FMUs of all platforms once more, in another folder and from nothing, and compares the files."""

from __future__ import annotations

import shutil
import subprocess
import time
from pathlib import Path

__all__ = ["build_again", "differing"]

# What the build reads of the repository.
_SOURCES = (
    *("CMakeLists.txt", "LICENSE"),
    *("c_core", "cmake", "examples/c_master", "fmu", "robots"),
)


def build_again(root: Path, folder: Path) -> float:
    """What ``make fmus ALL=1`` builds, in a copy of the repository ``root`` that is made in ``folder``; wall time in s.

    The FMUs are then in build/fmus_all of it. Only the Python environment with the compiler is shared; the compiler's
    cache is not.
    """
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for name in _SOURCES:
        source = root / name
        if source.is_dir():
            shutil.copytree(source, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy2(source, folder / name)
    tools, build = root / ".venv" / "bin", folder / "build"
    configure: list[str | Path] = ["-G", "Ninja", "-S", folder, "-B", build, f"-DPython3_EXECUTABLE={tools / 'python'}"]
    started = time.perf_counter()
    configure.append(f"-DCMAKE_MAKE_PROGRAM={tools / 'ninja'}")
    for arguments in (configure, ["--build", build, "--target", "fmus_all"]):
        answer = subprocess.run([tools / "cmake", *arguments], capture_output=True, text=True, check=False)
        if answer.returncode != 0:
            raise RuntimeError(f"the FMUs cannot be built in {folder}: {answer.stdout[-2000:]}{answer.stderr[-2000:]}")
    return time.perf_counter() - started


def differing(first: Path, second: Path) -> list[str]:
    """Names of the FMUs of two folders that are not the same bytes, or only in one of them."""
    names = {path.name for folder in (first, second) for path in folder.glob("*.fmu")}
    same = {
        name
        for name in names
        if (first / name).is_file()
        and (second / name).is_file()
        and (first / name).read_bytes() == (second / name).read_bytes()
    }
    return sorted(names - same)
