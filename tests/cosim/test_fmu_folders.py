"""Folders of libraries in FMUs of FMI 2, which names no processor but Intel's."""

from __future__ import annotations

import platform
import zipfile
from pathlib import Path

import fmpy
from giveway.base import native
from giveway.simulation.fmi2_library import fmi2_library
from giveway.simulation.fmu import Instance, open_fmu


def test_a_library_in_the_folder_that_fmi_3_names_is_found(tmp_path: Path) -> None:
    """As in the wheel for ARM64: there is no linux64, which FMPy looks for on every processor."""
    assert platform.machine() in fmpy.platform_tuple
    moved = tmp_path / "moved.fmu"
    with zipfile.ZipFile(native.fmu("controller", 2)) as given, zipfile.ZipFile(moved, "w") as written:
        for name in given.namelist():
            written.writestr(
                name.replace(f"binaries/{fmpy.platform}/", f"binaries/{fmpy.platform_tuple}/"), given.read(name)
            )
    file = open_fmu(moved)
    found = fmi2_library(file.folder, file.identifier)
    assert found is not None
    assert Path(found).parts[-2] == fmpy.platform_tuple
    with Instance(file, "moved"):
        pass


def test_elsewhere_it_is_the_usual_folder() -> None:
    file = open_fmu(native.fmu("controller", 2))
    assert fmi2_library(file.folder, file.identifier) is None
