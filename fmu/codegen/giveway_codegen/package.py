"""Packs an FMU so that the same input always gives the same bytes."""

from __future__ import annotations

import zipfile
from pathlib import Path

__all__ = ["BINARY_FOLDERS", "write_fmu"]

BINARY_FOLDERS = {2: "linux64", 3: "x86_64-linux"}
_EPOCH = (1980, 1, 1, 0, 0, 0)  # the earliest time a zip file can hold


def write_fmu(fmi: int, generated: Path, binary: Path, licences: dict[str, Path], output: Path) -> None:
    """Write ``output`` from generated descriptions, a shared library and licence texts (name -> file)."""
    contents = {
        "modelDescription.xml": generated / f"fmi{fmi}" / "modelDescription.xml",
        "documentation/index.html": generated / "documentation" / "index.html",
        f"binaries/{BINARY_FOLDERS[fmi]}/{binary.name}": binary,
        **{f"documentation/licenses/{name}": path for name, path in licences.items()},
    }
    output.parent.mkdir(parents=True, exist_ok=True)
    temporary = output.with_suffix(".partial")
    with zipfile.ZipFile(temporary, "w") as archive:
        for name in sorted(contents):
            entry = zipfile.ZipInfo(name, _EPOCH)
            entry.create_system = 3  # Unix, whatever this runs on
            entry.external_attr = (0o100755 if name.startswith("binaries/") else 0o100644) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, contents[name].read_bytes(), compresslevel=9)
    temporary.replace(output)
