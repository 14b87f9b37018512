"""What a wheel or source archive has to be: names, record, size, licences, bill of materials, and its binaries.

`faults` reads the finished file only; it trusts nothing of what wrote it.
"""

from __future__ import annotations

import base64
import csv
import email
import hashlib
import importlib
import io
import json
import re
import tarfile
import tomllib
import zipfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from release.parts import MODELS, PARTS, ROOT
from release.platforms import PLATFORMS, Platform

__all__ = ["faults", "repository_faults"]

binaries: Any = importlib.import_module("fmu.platforms.binaries")  # which mypy knows as platforms.binaries
WHEEL_BYTES = 8_000_000  # at most
NATIVE = "giveway/native"
THREADS = re.compile(r"libpthread\.so\.0")  # of glibc, which the batch library needs besides


def faults(path: Path) -> list[str]:
    """Everything that is wrong with a file of dist/."""
    if path.suffix == ".whl":
        with zipfile.ZipFile(path) as archive:
            return list(_wheel(path, archive))
    with tarfile.open(path) as archive:
        return list(_source(path, archive))


def _wheel(path: Path, archive: zipfile.ZipFile) -> Iterator[str]:
    version = str(tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"])
    tag = path.stem.rpartition("-")[2]
    platform = next((one for one in PLATFORMS if one.tag == tag), None)
    if platform is None or path.name != f"giveway-{version}-py3-none-{tag}.whl":
        yield "its name is no platform's"
        return
    if path.stat().st_size > WHEEL_BYTES:
        yield f"has {path.stat().st_size:,} bytes; allowed: at most {WHEEL_BYTES:,}"
    contents = {name: archive.read(name) for name in archive.namelist()}
    if len(contents) != len(archive.namelist()):
        yield "holds a file twice"
    folder = f"giveway-{version}.dist-info"
    yield from _record(contents, f"{folder}/RECORD")
    yield from _metadata(contents, folder, version, tag)
    yield from _bill(contents, f"{folder}/sboms/giveway.spdx.json", f"{folder}/RECORD")
    yield from _library(contents, platform)
    yield from _fmus(contents, platform)
    yield from (f"holds {name}" for name in contents if "__pycache__" in name or name.endswith((".pyc", ".partial")))


def _record(contents: Mapping[str, bytes], record: str) -> Iterator[str]:
    rows = list(csv.reader(io.StringIO(contents.get(record, b"").decode())))
    if {row[0] for row in rows} != set(contents):
        yield "RECORD does not list what is inside"
    for name, digest, size in rows:
        found = base64.urlsafe_b64encode(hashlib.sha256(contents.get(name, b"")).digest()).rstrip(b"=").decode()
        if name != record and (digest, size) != (f"sha256={found}", str(len(contents.get(name, b"")))):
            yield f"RECORD is wrong about {name}"


def _metadata(contents: Mapping[str, bytes], folder: str, version: str, tag: str) -> Iterator[str]:
    stated = email.message_from_bytes(contents.get(f"{folder}/METADATA", b""))
    if (stated["Name"], stated["Version"]) != ("giveway", version):
        yield f"METADATA is of {stated['Name']} {stated['Version']}"
    licences = {f"{folder}/licenses/{name}" for name in stated.get_all("License-File", [])}
    if licences != {name for name in contents if name.startswith(f"{folder}/licenses/")}:
        yield "METADATA names other licence files than there are"
    about = email.message_from_bytes(contents.get(f"{folder}/WHEEL", b""))
    if about.get_all("Tag") != [f"py3-none-{tag}"]:
        yield f"WHEEL has the tags {about.get_all('Tag')}"
    if b"giveway=giveway.cli:main" not in contents.get(f"{folder}/entry_points.txt", b"").replace(b" ", b""):
        yield "there is no command giveway"


def _bill(contents: Mapping[str, bytes], name: str, record: str) -> Iterator[str]:
    """Lists every file but itself and the RECORD, with the right checksum, and each part's licence text is there."""
    found: dict[str, Any] = json.loads(contents.get(name, b"{}"))
    listed = {file["fileName"].removeprefix("./"): file for file in found.get("files", [])}
    if set(listed) != set(contents) - {name, record}:
        yield "the bill of materials does not list what is inside"
    for path, file in listed.items():
        stated = {one["algorithm"]: one["checksumValue"] for one in file["checksums"]}
        if stated["SHA256"] != hashlib.sha256(contents.get(path, b"")).hexdigest():
            yield f"the bill of materials is wrong about {path}"
    texts = {Path(path).name for path in contents if ".dist-info/licenses/" in path}
    names = {package["name"] for package in found.get("packages", [])}
    here = [part for part in PARTS if part.name in names]
    yield from (f"the licence of {part.name} is missing" for part in here if part.file not in texts)


def _library(contents: Mapping[str, bytes], platform: Platform) -> Iterator[str]:
    """The batch library is of this platform and exports what its header declares."""
    libraries = {name for name in contents if Path(name).stem == "giveway_batch"}
    libraries = {name for name in libraries if Path(name).suffix in (".so", ".dll", ".dylib")}
    own = f"{NATIVE}/{platform.library}"
    if libraries != {own}:
        yield f"has the libraries {', '.join(sorted(libraries)) or 'none'}, not {own}"
        return
    header = contents[f"{NATIVE}/giveway_batch.h"].decode()
    wanted = set(re.findall(r"^GWB_API .*?(gwb_[a-z_]+)\(", header, re.MULTILINE))
    found = binaries.inspect(contents[own], platform.name, wanted, THREADS)
    yield from (f"{platform.library} {fault}" for fault in found["faults"])


def _fmus(contents: Mapping[str, bytes], platform: Platform) -> Iterator[str]:
    """Each FMU has a library for the platform."""
    for model in MODELS:
        for fmi in (2, 3):
            name = f"{NATIVE}/giveway_{model}_fmi{fmi}.fmu"
            with zipfile.ZipFile(io.BytesIO(contents[name])) as fmu:
                folders = {one.split("/")[1] for one in fmu.namelist() if one.startswith("binaries/")}
            known = {one for folder in folders for one in binaries.FMI2_FOLDERS.get(folder, [folder])}
            if platform.name not in known:
                yield f"{name} is not for {platform.name}"


def _source(path: Path, archive: tarfile.TarFile) -> Iterator[str]:
    top = path.name.removesuffix(".tar.gz")
    names = {name.removeprefix(f"{top}/") for name in archive.getnames()}
    wanted = ["PKG-INFO", "pyproject.toml", "CMakeLists.txt", "LICENSE", "vendor/sundials/LICENSE"]
    wanted += ["vendor/sundials/src/cvode/cvode.c", "vendor/pages/page_report.js", "c_core/src/gw_controller.c"]
    yield from (f"{name} is missing" for name in wanted if name not in names)
    yield from (f"holds {name}" for name in names if name.startswith((".ci", "build/", "out/", ".venv")))
    if not all(name.startswith(f"{top}/") for name in archive.getnames()):
        yield f"not everything is in {top}/"


def repository_faults() -> list[str]:
    """What every release asks for besides: one version, a changed CHANGELOG, every part named in THIRD_PARTY.md."""
    found = []
    version = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    if f"## {version}" not in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"):
        found.append(f"CHANGELOG.md has no section {version}")
    third = (ROOT / "THIRD_PARTY.md").read_text(encoding="utf-8")
    found += [f"THIRD_PARTY.md does not name {part.name}" for part in PARTS if part.name not in third]
    return found
