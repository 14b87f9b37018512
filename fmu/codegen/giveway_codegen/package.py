"""Packs an FMU so that the same input always gives the same bytes."""

from __future__ import annotations

import zipfile
from pathlib import Path

from .errors import TableError
from .universal import universal_binary

__all__ = ["PLATFORMS", "write_fmu"]

# FMI 3's platform tuples, and the folders of the binary in an FMI 2 FMU. FMI 2 has its own names for x86 only and uses
# the tuples for the rest (2.0.5); importers on Apple silicon look for either name, so darwin64 holds a binary for both
# processors.
PLATFORMS = {
    "x86_64-linux": ("linux64",),
    "aarch64-linux": ("aarch64-linux",),
    "x86_64-windows": ("win64",),
    "x86_64-darwin": ("darwin64",),
    "aarch64-darwin": ("darwin64", "aarch64-darwin"),
}
_LICENCES, _ENTRY = "documentation/licenses", "license.txt"
_EPOCH = (1980, 1, 1, 0, 0, 0)  # the earliest time a zip file can hold


def _binaries(fmi: int, files: dict[str, Path]) -> dict[str, bytes]:
    """Name inside the FMU -> bytes, from platform tuple -> shared library."""
    parts: dict[str, list[bytes]] = {}
    for platform, path in files.items():
        if platform not in PLATFORMS:
            raise TableError(f"--binary: platform: {platform!r}, but must be one of {', '.join(PLATFORMS)}")
        for folder in (platform,) if fmi == 3 else PLATFORMS[platform]:
            parts.setdefault(f"binaries/{folder}/{path.name}", []).append(path.read_bytes())
    return {name: images[0] if len(images) == 1 else universal_binary(images) for name, images in parts.items()}


def write_fmu(fmi: int, generated: Path, binaries: dict[str, Path], licences: dict[str, Path], output: Path) -> None:
    """Write ``output`` from generated files, shared libraries (platform -> file) and licence texts (name -> file).

    ``generated`` has the files of both versions in ``common/`` and the others in ``fmi2/`` and ``fmi3/``, in the layout
    of the FMU.
    """
    contents = _binaries(fmi, binaries)
    for folder in (generated / "common", generated / f"fmi{fmi}"):
        for path in folder.rglob("*"):
            if path.is_file():
                contents[path.relative_to(folder).as_posix()] = path.read_bytes()
    for name, path in licences.items():
        contents[f"{_LICENCES}/{name}"] = path.read_bytes()
    others = sorted(set(licences) - {_ENTRY})
    if others:  # the entry point names the rest
        contents[f"{_LICENCES}/{_ENTRY}"] += (
            "\nThe binaries also contain work of others; their licences are beside this file:\n"
            + "".join(f"    {name}\n" for name in others)
        ).encode()
    output.parent.mkdir(parents=True, exist_ok=True)
    temporary = output.with_suffix(".partial")
    with zipfile.ZipFile(temporary, "w") as archive:
        for name in sorted(contents):
            entry = zipfile.ZipInfo(name, _EPOCH)
            entry.create_system = 3  # Unix, on any build system
            entry.external_attr = (0o100755 if name.startswith("binaries/") else 0o100644) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, contents[name], compresslevel=9)
    temporary.replace(output)
