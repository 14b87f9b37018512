"""The files of `make wheels` and `make release`: the same bytes twice, and faults found."""

from __future__ import annotations

import ast
import json
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

from release import archives, check, outside, parts, sbom
from release.platforms import PLATFORMS

ROOT = Path(__file__).parents[2]
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


@pytest.mark.deep
def test_a_release_is_sound_and_reproducible(dist: list[Path], wheels: dict[str, Path]) -> None:
    """Checked by `make release`; what is written again has the same bytes."""
    assert wheels.keys() == {platform.tag for platform in PLATFORMS}
    before = {path.name: path.read_bytes() for path in dist}
    subprocess.run([sys.executable, "-m", "release", "all"], cwd=ROOT, check=True, capture_output=True)
    assert {path.name: path.read_bytes() for path in dist} == before


@pytest.mark.deep
def test_a_wheel_under_the_name_of_another_platform_is_not_sound(wheels: dict[str, Path], tmp_path: Path) -> None:
    wrong = tmp_path / wheels["manylinux_2_17_aarch64"].name
    shutil.copy(wheels["manylinux_2_17_x86_64"], wrong)
    found = "; ".join(check.faults(wrong))
    assert "WHEEL has the tags" in found
    assert "is for the processor" in found


@pytest.mark.deep
def test_other_peoples_checkers_see_faults(dist: list[Path], tmp_path: Path) -> None:
    """No title in CITATION.cff, no such licence in metadata, a bill of materials without a name."""
    assert dist
    untitled = tmp_path / "CITATION.cff"
    stated = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    untitled.write_text("".join(line for line in stated.splitlines(True) if not line.startswith("title:")))
    assert "title" in "; ".join(outside.faults([], untitled))
    bill = tmp_path / "giveway.spdx.json"
    bill.write_bytes(sbom.document("x.whl", "1.2.3", CONTENTS, [], {}))
    assert outside.faults([bill]) == []
    bill.write_text(bill.read_text().replace('"x.whl",', "[],", 1))
    assert "pyspdxtools" in "; ".join(outside.faults([bill]))
    (archive,) = (path for path in dist if path.suffix == ".gz")
    wrong = tmp_path / archive.name
    with tarfile.open(archive) as packed:
        found = {one.name: data.read() for one in packed.getmembers() if (data := packed.extractfile(one))}
    name = f"{archive.name.removesuffix('.tar.gz')}/PKG-INFO"
    found[name] = found[name].replace(b"text/markdown", b"text/nonsense")
    archives.write_tar(wrong, found)
    assert "twine" in "; ".join(outside.faults([wrong]))
