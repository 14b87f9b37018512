"""Builds the FMUs of all platforms again, from scratch in another folder, and compares the files."""

from __future__ import annotations

import shutil
import subprocess
import time
from pathlib import Path

__all__ = ["build_again", "differing"]

# The files of the repository that the build reads.
_SOURCES = (
    *("CMakeLists.txt", "LICENSE"),
    *("c_core", "cmake", "examples/c_master", "fmu", "robots"),
)


def build_again(root: Path, folder: Path) -> float:
    """Run ``make fmus ALL=1`` in a copy of the repository ``root`` made in ``folder``; returns the wall time in s.

    The FMUs are then in its build/fmus_all. The Python environment with the compiler is shared, the compiler's cache is
    not.
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
    """Names of the FMUs that differ between two folders, or are only in one of them."""
    names = {path.name for folder in (first, second) for path in folder.glob("*.fmu")}
    same = {
        name
        for name in names
        if (first / name).is_file()
        and (second / name).is_file()
        and (first / name).read_bytes() == (second / name).read_bytes()
    }
    return sorted(names - same)
