"""The library of an FMU of FMI 2 on processors that FMI 2 has no folder for."""

from __future__ import annotations

from pathlib import Path

__all__ = ["fmi2_library"]


def fmi2_library(unpacked: Path, identifier: str) -> str | None:
    """Path of the library for this machine in a folder named as by FMI 3, ``binaries/aarch64-linux``; None: FMPy's own.

    FMI 2 names no processor but Intel's, and FMPy takes ``linux64`` on all of them.
    """
    import fmpy

    path = unpacked / "binaries" / str(fmpy.platform_tuple) / f"{identifier}{fmpy.sharedLibraryExtension}"
    return str(path.resolve()) if path.is_file() else None
