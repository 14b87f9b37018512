"""The C library's sources, which the package has inside the controller's FMU."""

from __future__ import annotations

import zipfile

from giveway.base import native
from giveway.base.errors import FileError

__all__ = ["core_files"]

SOURCES = "sources/"  # of the controller's FMU, which was compiled from them


def core_files() -> dict[str, bytes]:
    """Path, from c_core/ on, to content."""
    path = native.fmu("controller", 3)
    try:
        with zipfile.ZipFile(path) as fmu:
            names = [name.removeprefix(SOURCES) for name in fmu.namelist() if name.startswith(SOURCES)]
            found = {_place(name): fmu.read(SOURCES + name) for name in names if _place(name)}
    except (OSError, zipfile.BadZipFile) as error:
        raise FileError(path, f"is not a usable FMU: {error}") from None
    if not found:
        raise FileError(path, "has no sources of the C library")
    return found


def _place(name: str) -> str:
    """Where a file of the FMU's sources belongs; "" for those that are not the C library's."""
    if name.startswith("giveway/"):
        return f"c_core/include/{name}"
    return f"c_core/src/{name}" if name.startswith("gw_") and name.endswith(".c") else ""
