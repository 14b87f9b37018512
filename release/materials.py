"""The FMUs for all platforms, each with its bill of materials, beside the wheels."""

from __future__ import annotations

import zipfile
from pathlib import Path

from release import archives, sbom, wheel
from release.parts import MODELS, Part, parts_of
from release.platforms import PLATFORMS

__all__ = ["fmu_document", "write_fmus"]


def fmu_document(path: Path) -> bytes:
    """The bill of materials of one of our FMUs."""
    model = path.stem.split("_")[1]
    with zipfile.ZipFile(path) as archive:
        contents = {name: archive.read(name) for name in archive.namelist()}
    parts = parts_of(tuple(one.name for one in PLATFORMS), model)
    holds: dict[str, list[Part]] = {
        name: [part for part in parts if _system(name) in part.libraries]
        for name in contents
        if name.startswith("binaries/")
    }
    return sbom.document(path.name, wheel.version(), contents, parts, holds)


def _system(name: str) -> str:
    return {".so": "linux", ".dll": "windows", ".dylib": "darwin"}[Path(name).suffix]


def write_fmus(folder: Path) -> list[Path]:
    written = []
    for model in MODELS:
        for fmi in (2, 3):
            source = wheel.BUILD / "fmus_all" / f"giveway_{model}_fmi{fmi}.fmu"
            target = folder / source.name
            archives.put(target, source.read_bytes())
            bill = target.with_suffix(".fmu.spdx.json")
            archives.put(bill, fmu_document(source))
            written += [target, bill]
    return written
