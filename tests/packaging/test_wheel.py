"""The wheel, built from the tree, works in an empty environment outside the repository."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import sysconfig
import venv
import zipfile
from pathlib import Path

import pytest

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
def environment(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An empty virtual environment with the wheel and its requirements, at the locked versions."""
    folder = tmp_path_factory.mktemp("environment")
    venv.create(folder, with_pip=True)
    pins = re.findall(r"^[\w.-]+==[^\\\n]+", (ROOT / "requirements.lock").read_text(), re.MULTILINE)
    constraints = folder / "constraints.txt"
    constraints.write_text("\n".join(pins))
    run(folder / "bin" / "pip", "install", "--quiet", "--constraint", constraints, wheel, cwd=folder)
    return folder


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


def test_its_files_run_an_experiment_away_from_the_repository(wheel: Path, tmp_path: Path) -> None:
    """Unpacked, with the packages that are installed here; the next test installs everything by pip."""
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(tmp_path / "unpacked")
    folders = [str(tmp_path / "unpacked"), sysconfig.get_path("purelib")]
    # -S: what is installed in place, from the repository, is not found.
    start = f"import sys; sys.path[:0] = {folders}; import giveway.cli; print(giveway.__file__); giveway.cli.main()"
    options = ("--bumper", "magnetic", "--duration", "0.3", "--out", "run")
    origin, *_ = run(sys.executable, "-S", "-c", start, "run", "motionless", *options, cwd=tmp_path).splitlines()
    assert Path(origin).is_relative_to(tmp_path / "unpacked")
    assert (tmp_path / "run" / "traces.parquet").is_file()


@pytest.mark.deep
def test_it_runs_an_experiment_away_from_the_repository(environment: Path, tmp_path: Path) -> None:
    origin = run(environment / "bin" / "python", "-c", "import giveway; print(giveway.__file__)", cwd=tmp_path)
    assert Path(origin.strip()).is_relative_to(environment)
    run(environment / "bin" / "giveway", "run", "motionless", "--bumper", "magnetic", "--out", "run", cwd=tmp_path)
    manifest = json.loads((tmp_path / "run" / "manifest.json").read_text())
    assert manifest["schema_version"] == 1
    assert (tmp_path / "run" / "traces.parquet").is_file()
