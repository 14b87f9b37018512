"""The wheel, built from the tree, works in an empty environment outside the repository."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import IO

import pytest
from bare_environment import Bare

from release import check
from release.platforms import PLATFORMS
from release.wheel import BUILD, Compiled, gather, write

ROOT = Path(__file__).parents[2]
NATIVE = {
    *(
        f"giveway_{model}_fmi{version}.fmu"
        for model in ("controller", "testbed", "drivetrain", "bumper")
        for version in (2, 3)
    ),
    "bumper.variables.toml",
    "controller.variables.toml",
    "drivetrain.variables.toml",
    "giveway_batch.h",
    "giveway_batch.js",
    "giveway_batch.so",
    "giveway_batch.sundials.txt",
    "giveway_batch.wasm",
    "giveway_batch.wasm.musl.txt",
    "giveway_batch.wasm.wasi.txt",
    "giveway_batch.wasm.zig.txt",
    "page_report.css",
    "page_report.js",
    "page_studio.css",
    "page_studio.js",
    "page_study.css",
    "page_study.js",
    "testbed.variables.toml",
    *(path.name for path in (ROOT / "robots").glob("*.toml")),
}


def run(*command: object, cwd: Path) -> str:
    """Standard output; nothing of this process' Python or giveway settings reaches the command."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "GIVEWAY", "VIRTUAL_ENV"))}
    result = subprocess.run(
        list(map(str, command)), cwd=cwd, env=environment, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Built in the build tree, so that nothing is compiled twice."""
    folder = tmp_path_factory.mktemp("wheel")
    run(
        sys.executable, "-m", "pip", "wheel", "--quiet", "--no-build-isolation", "--no-deps",
        "--config-settings", "build-dir=build", "--wheel-dir", folder, ROOT, cwd=ROOT,
    )  # fmt: skip
    (path,) = folder.glob("*.whl")
    return path


@pytest.fixture(scope="module")
def released(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """As `make wheels` writes it for Linux on x86-64, but with the batch library that was compiled for the tests."""
    folder = tmp_path_factory.mktemp("released")
    compiled = Compiled(BUILD / "fmus", BUILD / "batch" / "giveway_batch.so")
    return write(gather(), PLATFORMS[0], folder, compiled)


def test_the_wheel_holds_the_native_parts_and_is_for_linux_and_any_python(wheel: Path) -> None:
    assert re.fullmatch(r"giveway-\d+\.\d+\.\d+-py3-none-\w*linux\w*_x86_64\.whl", wheel.name)
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
    assert {Path(name).name for name in names if name.startswith("giveway/native/")} == NATIVE
    c_files = ROOT / "cosim" / "giveway" / "firmware" / "c"
    fixed = [path.relative_to(c_files.parents[2]).as_posix() for path in c_files.rglob("*") if path.is_file()]
    assert len(fixed) > 10
    assert set(fixed) <= set(names)
    assert not [name for name in names if "__pycache__" in name or name.startswith(("tests/", "cosim/", "build/"))]


def test_its_fmus_hold_the_libraries_that_are_tested_and_shipped_for_all_platforms(wheel: Path) -> None:
    """One build tree makes the library of a platform; `make platforms` holds those of `make fmus ALL=1` against it."""
    for model in ("controller", "testbed", "drivetrain", "bumper"):
        library = f"giveway_{model}.so"
        built = (ROOT / "build" / "platforms" / "x86_64-linux" / "binaries" / library).read_bytes()
        for version, folder in ((2, "linux64"), (3, "x86_64-linux")):
            with zipfile.ZipFile(wheel) as archive:
                fmu = archive.open(f"giveway/native/giveway_{model}_fmi{version}.fmu")
                with zipfile.ZipFile(fmu) as packed:
                    assert packed.read(f"binaries/{folder}/{library}") == built


def files(wheel: Path | IO[bytes], within: str = "") -> dict[str, bytes]:
    """What it installs, less what tells about it; FMUs as what is in them, for they are compressed differently."""
    found: dict[str, bytes] = {}
    with zipfile.ZipFile(wheel) as archive:
        for name in archive.namelist():
            if name.endswith(".fmu"):
                found |= files(archive.open(name), f"{name}/")
            elif ".dist-info/" not in name:
                found[within + name] = archive.read(name)
    return found


def test_what_is_released_installs_the_same_files(wheel: Path, released: Path) -> None:
    """So what is told of one wheel is true of the other."""
    assert files(released) == files(wheel)


def test_released_files_are_sound_but_for_the_library_of_this_machine(released: Path) -> None:
    """The library of the tests asks for the machine's own C library; `make wheels` compiles for an older one."""
    found = check.faults(released)
    assert [fault for fault in found if not fault.startswith("giveway_batch.so ")] == []


def test_it_runs_the_demonstration_in_a_bare_environment(released: Path, tmp_path: Path) -> None:
    """Installed by pip, which finds what it needs linked there; tests/packaging/test_release.py downloads it."""
    bare = Bare(tmp_path, sys.executable)
    bare.link_needed(released)
    bare.install(released, "--no-index")
    bare.demonstrate()
    bare.consult()
