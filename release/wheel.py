"""One wheel: the Python package, with the native files of one platform.

The files come from the build trees (`make fmus ALL=1`, the platforms' batch libraries) and from CMake's own install
step, so that the wheel that a user builds from source has the same layout.
"""

from __future__ import annotations

import base64
import hashlib
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from release import archives, sbom
from release.parts import MODELS, ROOT, Part, parts_of
from release.platforms import PLATFORMS, Platform

__all__ = ["BUILD", "Compiled", "contents", "file_name", "gather", "metadata", "version", "write"]

BUILD = ROOT / "build"
_DELIVERED = "giveway/native"


def version() -> str:
    """From pyproject.toml."""
    return str(tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"])


Inputs = Mapping[str, bytes]


@dataclass(frozen=True)
class Compiled:
    """Where the compiled files of a wheel come from: the folder of the FMUs, and the batch library."""

    fmus: Path
    library: Path


def _of_all(platform: Platform) -> Compiled:
    """From the platforms' build trees."""
    return Compiled(BUILD / "fmus_all", BUILD / "platforms" / platform.name / "binaries" / platform.library)


def _python() -> dict[str, bytes]:
    package = ROOT / "cosim" / "giveway"
    native = package / "native"
    files = (path for path in package.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    return {
        path.relative_to(package.parent).as_posix(): path.read_bytes()
        for path in files
        if not path.is_relative_to(native)
    }


def _installed() -> dict[str, bytes]:
    """What CMake's install step puts beside the Python files, for this machine."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        command = [str(Path(sys.executable).with_name("cmake")), "--install", str(BUILD), "--component", "native"]
        subprocess.run([*command, "--prefix", name], check=True, stdout=subprocess.DEVNULL)
        return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def metadata() -> dict[str, bytes]:
    """METADATA and entry_points.txt, as the build backend writes them."""
    with tempfile.TemporaryDirectory() as name:
        code = "import sys, scikit_build_core.build as b; b.prepare_metadata_for_build_wheel(sys.argv[1])"
        subprocess.run([sys.executable, "-c", code, name], check=True, cwd=ROOT, stdout=subprocess.DEVNULL)
        (folder,) = Path(name).glob("*.dist-info")
        return {file: (folder / file).read_bytes() for file in ("METADATA", "entry_points.txt")}


def gather() -> dict[str, bytes]:
    """What all wheels have in common: name in the wheel -> bytes."""
    found = _python()
    own = {f"{_DELIVERED}/{platform.library}" for platform in PLATFORMS}
    for name, data in _installed().items():
        if name not in own and not name.endswith(".fmu"):
            found[name] = data
    folder = f"giveway-{version()}.dist-info"
    found.update({f"{folder}/{name}": data for name, data in metadata().items()})
    return found


def _fmus(folder: Path, platform: Platform) -> dict[str, bytes]:
    """The FMUs without the libraries of other platforms, with which a wheel would have 9 MB."""
    found = {}
    for model in MODELS:
        for fmi in (2, 3):
            name = f"giveway_{model}_fmi{fmi}.fmu"
            found[f"{_DELIVERED}/{name}"] = _for_one(folder / name, fmi, platform)
    return found


def _for_one(path: Path, fmi: int, platform: Platform) -> bytes:
    """The FMU with the libraries of one platform."""
    kept = (platform.name,) if fmi == 3 else platform.fmi2
    with tempfile.TemporaryDirectory() as name, zipfile.ZipFile(path) as archive:
        smaller = Path(name) / path.name
        with zipfile.ZipFile(smaller, "w") as written:
            for entry in archive.infolist():
                parts = entry.filename.split("/")
                if parts[0] != "binaries" or parts[1] in kept:
                    written.writestr(entry, archive.read(entry), compresslevel=9)
        return smaller.read_bytes()


def _parts(platform: Platform) -> tuple[list[Part], dict[str, list[Part]]]:
    """All parts of the wheel, and those of each file."""
    holds = {f"{_DELIVERED}/{platform.library}": parts_of((platform.name,))}
    holds[f"{_DELIVERED}/giveway_batch.wasm"] = parts_of(("wasm",))
    for model in MODELS:
        for fmi in (2, 3):
            holds[f"{_DELIVERED}/giveway_{model}_fmi{fmi}.fmu"] = parts_of((platform.name,), model)
    for page in ("report", "studio", "study"):
        holds[f"{_DELIVERED}/page_{page}.js"] = parts_of(("pages",))
    return list(dict.fromkeys(part for parts in holds.values() for part in parts)), holds


def _record(found: Mapping[str, bytes], name: str) -> bytes:
    lines = []
    for path in sorted(found):
        digest = base64.urlsafe_b64encode(hashlib.sha256(found[path]).digest()).rstrip(b"=").decode()
        lines.append(f"{path},sha256={digest},{len(found[path])}\n")
    return "".join([*lines, f"{name},,\n"]).encode()


def _licences(parts: Sequence[Part]) -> dict[str, bytes]:
    found = {name: (ROOT / name).read_bytes() for name in ("LICENSE", "THIRD_PARTY.md")}
    return found | {part.file: part.text().encode() for part in parts}


def contents(common: Inputs, platform: Platform, compiled: Compiled) -> dict[str, bytes]:
    """All files of the wheel but RECORD."""
    found = dict(common)
    found[f"{_DELIVERED}/{platform.library}"] = compiled.library.read_bytes()
    found |= _fmus(compiled.fmus, platform)
    parts, holds = _parts(platform)
    folder = f"giveway-{version()}.dist-info"
    licences = _licences(parts)
    headers, blank, text = found[f"{folder}/METADATA"].decode().partition("\n\n")
    lines = [line for line in headers.splitlines() if not line.startswith("License-File:")]
    lines += [f"License-File: {name}" for name in sorted(licences)]
    found[f"{folder}/METADATA"] = ("\n".join(lines) + blank + text).encode()
    found[f"{folder}/WHEEL"] = (
        f"Wheel-Version: 1.0\nGenerator: giveway-release\nRoot-Is-Purelib: false\nTag: py3-none-{platform.tag}\n"
    ).encode()
    found |= {f"{folder}/licenses/{name}": data for name, data in licences.items()}
    found[f"{folder}/sboms/giveway.spdx.json"] = sbom.document(file_name(platform), version(), found, parts, holds)
    return found


def file_name(platform: Platform) -> str:
    return f"giveway-{version()}-py3-none-{platform.tag}.whl"


def write(common: Inputs, platform: Platform, folder: Path, compiled: Compiled | None = None) -> Path:
    """Write the wheel of ``platform`` to ``folder``; ``compiled``: otherwise from the platforms' build trees."""
    found = contents(common, platform, compiled or _of_all(platform))
    record = f"giveway-{version()}.dist-info/RECORD"
    found[record] = _record(found, record)
    path = folder / file_name(platform)
    folder_of = f"giveway-{version()}.dist-info/"
    archives.write_zip(path, found, last=sorted(name for name in found if name.startswith(folder_of)))
    return path
