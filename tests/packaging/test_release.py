"""The wheels of `make wheels`: the same bytes twice, faults found, and a demonstration in a bare environment."""

from __future__ import annotations

import ast
import json
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from release import archives, check, parts, sbom

ROOT = Path(__file__).parents[2]
DIST = ROOT / "dist"
CONTENTS = {"b.txt": b"b" * 1000, "a/c.txt": b"c"}


def test_archives_have_the_same_bytes_twice(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the order of the contents; the time is the one that is asked for."""
    for write, name in ((archives.write_zip, "x.zip"), (archives.write_tar, "x.tar.gz")):
        found = []
        for turn, contents in enumerate((CONTENTS, dict(reversed(CONTENTS.items())))):
            write(tmp_path / str(turn) / name, contents)
            found.append((tmp_path / str(turn) / name).read_bytes())
        assert found[0] == found[1]
        monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
        write(tmp_path / name, CONTENTS)
        assert (tmp_path / name).read_bytes() != found[0]
        monkeypatch.delenv("SOURCE_DATE_EPOCH")


def test_the_time_is_that_of_the_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    archives.write_zip(tmp_path / "x.zip", CONTENTS, last=["b.txt"])
    with zipfile.ZipFile(tmp_path / "x.zip") as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(2023, 11, 14, 22, 13, 20)}
        assert archive.namelist() == ["a/c.txt", "b.txt"]


def test_every_part_has_a_licence_text_and_a_row_in_third_party() -> None:
    assert check.repository_faults() == []
    third = (ROOT / "THIRD_PARTY.md").read_text(encoding="utf-8")
    for part in parts.PARTS:
        row = next(line for line in third.splitlines() if line.startswith("|") and part.name in line.split("|")[1])
        assert part.licence.startswith("LicenseRef-") or part.licence in row, part.name
        assert len(part.text()) > 500, part.name
        assert part.origin().checksums


def test_a_bill_of_materials_lists_files_and_parts() -> None:
    inside = parts.parts_of(("x86_64-windows",))
    found = json.loads(sbom.document("x.whl", "1.2.3", CONTENTS, inside, {"b.txt": inside}))
    assert found["spdxVersion"] == "SPDX-2.3"
    names = {"giveway", "SUNDIALS", "zig", "libc++", "MinGW-w64", "musl"}
    assert {package["name"] for package in found["packages"]} == names
    identifiers = [found["SPDXID"], *(one["SPDXID"] for kind in ("packages", "files") for one in found[kind])]
    assert len(set(identifiers)) == len(identifiers)
    for one in found["relationships"]:
        assert {one["spdxElementId"], one["relatedSpdxElement"]} <= set(identifiers)
    (license_text,) = found["hasExtractedLicensingInfos"]
    assert license_text["licenseId"] == "LicenseRef-MinGW-w64"


def test_citation_names_the_paper() -> None:
    """What cff 1.2.0 demands, by hand."""
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    for key in ("cff-version: 1.2.0", "message:", "title:", "authors:", "doi: 10.1007/s10514-015-9464-x"):
        assert key in text


def test_the_package_can_be_imported_where_there_is_no_posix() -> None:
    """Windows has none of these modules, and nor macOS nor Windows has sched_getaffinity."""
    here = {"fcntl", "grp", "pwd", "resource", "termios"}
    for path in (ROOT / "cosim" / "giveway").rglob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        imported = {name.name for node in tree.body if isinstance(node, ast.Import) for name in node.names}
        imported |= {str(node.module) for node in tree.body if isinstance(node, ast.ImportFrom)}
        assert not imported & here, path
        assert path.name == "system.py" or "sched_getaffinity" not in path.read_text(encoding="utf-8"), path


@pytest.fixture(scope="module")
def wheels() -> list[Path]:
    """Made by `make wheels`; deep, because they are cross-compiled."""
    subprocess.run(["make", "wheels"], cwd=ROOT, check=True, capture_output=True, timeout=7200)
    return sorted(DIST.glob("giveway-*.whl"))


@pytest.mark.deep
def test_wheels_are_sound_reproducible_and_changed_ones_are_not(wheels: list[Path], tmp_path: Path) -> None:
    assert len(wheels) == 5
    before = {path.name: path.read_bytes() for path in wheels}
    assert [fault for path in wheels for fault in check.faults(path)] == []
    subprocess.run([sys.executable, "-m", "release", "wheels"], cwd=ROOT, check=True, capture_output=True)
    assert {path.name: path.read_bytes() for path in wheels} == before
    # One for ARM64 with the library of x86-64, and another under its name.
    names = {path.stem.rpartition("-")[2]: path for path in wheels}
    shutil.copy(names["manylinux_2_17_x86_64"], tmp_path / names["manylinux_2_17_aarch64"].name)
    found = "; ".join(check.faults(tmp_path / names["manylinux_2_17_aarch64"].name))
    assert "WHEEL has the tags" in found
    assert "is for the processor" in found


@pytest.mark.deep
def test_libraries_of_other_platforms_have_the_same_bits(wheels: list[Path]) -> None:
    """Under qemu and wine."""
    assert len(wheels) == 5
    subprocess.run(["bash", "fmu/platforms/system_packages.sh"], cwd=ROOT, check=True, capture_output=True)
    subprocess.run([sys.executable, "-m", "release.abroad"], cwd=ROOT, check=True, timeout=3600)


def interpreter(version: str) -> Path:
    """On PATH, or of pyenv; otherwise the test is skipped, and says which one is missing."""
    folders = sorted(Path.home().glob(f".pyenv/versions/{version}.*/bin"))
    for folder in (None, *folders):
        found = shutil.which(f"python{version}", path=folder and str(folder))
        if (
            found
            and subprocess.run([found, "-c", "import ensurepip"], check=False, capture_output=True).returncode == 0
        ):
            return Path(found)
    pytest.skip(f"no Python {version} on this machine")


@pytest.mark.deep
@pytest.mark.parametrize("version", ["3.11", "3.12", "3.13"])
def test_a_bare_environment_runs_the_demonstration(wheels: list[Path], version: str, tmp_path: Path) -> None:
    """Away from the repository, and without compilers: PATH holds nothing but the environment."""
    subprocess.run([interpreter(version), "-m", "venv", tmp_path / "bare"], check=True)
    programs = tmp_path / "bare" / "bin"
    (wheel,) = (path for path in wheels if "manylinux_2_17_x86_64" in path.name)
    environment = {"PATH": str(programs), "HOME": str(tmp_path)}
    environment |= {name: value for name, value in os.environ.items() if name.startswith(("PIP_", "SSL_", "REQUESTS_"))}

    def call(*command: object) -> str:
        answer = subprocess.run(
            [str(one) for one in command], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
        )
        assert answer.returncode == 0, answer.stdout + answer.stderr
        return answer.stdout

    call(programs / "pip", "install", "--quiet", "--only-binary", ":all:", wheel)
    assert "detection time" in call(programs / "giveway", "demo", "--out", "demo")
    assert (tmp_path / "demo" / "report.html").is_file()
    doctor = call(programs / "giveway", "doctor")
    assert "extra fmu" in doctor
    assert "has the bits that it should have" in doctor
