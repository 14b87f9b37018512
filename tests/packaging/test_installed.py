"""Wheels and source archive, installed as users do: away from the repository, with pip and what PyPI has."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tarfile
import tomllib
from pathlib import Path

import pytest
from bare_environment import Bare

ROOT = Path(__file__).parents[2]
COMPILERS = ("cc", "c++", "gcc", "g++", "as", "ld", "ar", "ranlib", "nm", "objcopy", "strip")
NO_NETWORK = dict.fromkeys(("http_proxy", "https_proxy", "all_proxy"), "http://127.0.0.1:9")  # where nobody listens


@pytest.mark.deep
@pytest.mark.parametrize("version", ["3.11", "3.12", "3.13"])
def test_a_bare_environment_runs_the_demonstration(wheels: dict[str, Path], version: str, tmp_path: Path) -> None:
    """Without compilers: PATH holds nothing but the environment. A missing interpreter is named."""
    command = ["bash", ROOT / "verify" / "python.sh", version]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stderr
    bare = Bare(tmp_path, found.stdout.strip())
    bare.install(wheels["manylinux_2_17_x86_64"])
    bare.demonstrate()
    bare.consult()
    bare.remove()


@pytest.mark.deep
def test_arm64_runs_the_demonstration_under_qemu(wheels: dict[str, Path], tmp_path: Path) -> None:
    """Debian's Python for ARM64, unpacked; pip of this machine fetches what is for ARM64."""
    folder = ROOT / "build" / "release" / "arm64"
    call("bash", ROOT / "fmu" / "platforms" / "system_packages.sh")
    call("bash", ROOT / "release" / "arm64_python.sh", folder)
    root = folder / "unpacked"
    installed = tmp_path / "installed"
    settings = {"HOME": str(tmp_path), "PYTHONPATH": str(installed), "PATH": os.defpath}

    def python(*arguments: object) -> str:
        qemu = shutil.which("qemu-aarch64")
        return call(qemu, "-L", root, root / "usr" / "bin" / "python3", *arguments, cwd=tmp_path, env=settings)

    says = "import os, platform, sys; print(*sys.version_info[:2], platform.machine(), os.confstr(%r))"
    major, minor, machine, _, libc = python("-c", says % "CS_GNU_LIBC_VERSION").split()
    assert machine == "aarch64"
    tags = [f"manylinux_2_{number}_aarch64" for number in range(17, int(libc.split(".")[1]) + 1)]
    platforms = [text for tag in ("manylinux2014_aarch64", *tags) for text in ("--platform", tag)]
    call(
        sys.executable, "-m", "pip", "install", "--quiet", "--no-compile", "--only-binary", ":all:", *platforms,
        "--implementation", "cp", "--python-version", f"{major}.{minor}", "--target", installed,
        wheels["manylinux_2_17_aarch64"],
    )  # fmt: skip
    assert "detection time" in python("-m", "giveway", "demo", "--out", "demo")
    assert (tmp_path / "demo" / "report.html").is_file()
    # Of the batch library, the FMUs of FMI 3 and those of FMI 2.
    assert python("-m", "giveway", "doctor").count("has the bits that it should have") == 3
    shutil.rmtree(installed)


@pytest.mark.deep
def test_the_source_archive_needs_a_compiler_and_pypi_alone(dist: list[Path], tmp_path: Path) -> None:
    """pip fetches what pyproject.toml asks for; then it builds without network, cargo, npm or anything else on PATH."""
    (archive,) = (path for path in dist if path.suffix == ".gz")
    with tarfile.open(archive) as packed:
        stated = packed.extractfile(f"{archive.name.removesuffix('.tar.gz')}/pyproject.toml")
        assert stated is not None
        asked = tomllib.loads(stated.read().decode())["build-system"]["requires"]
    bare = Bare(tmp_path, sys.executable)
    # scikit-build-core asks pip for these two where they are not on PATH.
    fetched = tmp_path / "fetched"
    how = ("--quiet", "--only-binary", ":all:", "--dest", fetched)
    bare.call(bare.programs / "pip", "download", *how, *asked, "cmake", "ninja")
    compilers = tmp_path / "compilers"
    compilers.mkdir()
    for name in COMPILERS:
        if found := shutil.which(name):
            (compilers / name).symlink_to(found)
    offline = {**bare.environment, **NO_NETWORK, "PATH": f"{bare.programs}:{compilers}"}
    call(
        bare.programs / "pip", "wheel", "--quiet", "--no-deps", "--no-index", "--find-links", fetched,
        "--wheel-dir", "built", archive, cwd=tmp_path, env=offline,
    )  # fmt: skip
    (wheel,) = (tmp_path / "built").glob("*.whl")
    bare.link_needed(wheel)
    bare.install(wheel, "--no-index")
    bare.demonstrate()
    bare.consult()
    bare.remove()
    shutil.rmtree(fetched)


def call(*command: object, cwd: Path = ROOT, env: dict[str, str] | None = None) -> str:
    """Standard output of a command that succeeds."""
    answer = subprocess.run(
        [str(one) for one in command], cwd=cwd, env=env, capture_output=True, text=True, check=False, timeout=3600
    )
    assert answer.returncode == 0, answer.stdout + answer.stderr
    return answer.stdout
