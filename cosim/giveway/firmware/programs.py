"""Builds the firmware's program for a serial line: for this computer, or for qemu's Cortex-M4F."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

from giveway.base.errors import FileError, GivewayError
from giveway.base.temporary import temporary_folder
from giveway.firmware.folder import program_files
from giveway.firmware.settings import Settings

__all__ = ["HOST", "QEMU", "build", "command_of"]

HOST, QEMU = "host", "qemu"
_PROGRAMS = {HOST: "host/serial", QEMU: "arm/serial.elf"}
_NEEDED = {
    HOST: {"make": "make", "cc": "gcc"},
    QEMU: {
        "make": "make",
        "arm-none-eabi-gcc": "gcc-arm-none-eabi libnewlib-arm-none-eabi",
        "qemu-system-arm": "qemu-system-arm",
    },
}


def build(settings: Settings, where: str) -> Path:
    """The program for ``where``, in a folder that goes with this process."""
    for tool, package in _NEEDED[where].items():
        if shutil.which(tool) is None:
            allowed = f"only with {tool} on the PATH (Debian: {package})"
            raise GivewayError("--controller", where, allowed)
    folder = temporary_folder()
    for name, content in program_files(settings).items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    program = folder / "build" / _PROGRAMS[where]
    command = [
        "make",
        "--silent",
        f"-j{os.cpu_count() or 1}",
        "-C",
        str(folder),
        "BUILD=build",
        f"build/{_PROGRAMS[where]}",
    ]
    made = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    if made.returncode != 0:
        said = [line for line in (made.stderr + made.stdout).splitlines() if "rror" in line] or ["make said nothing"]
        raise FileError(folder, f"the firmware cannot be compiled: {said[0]}")
    return program


def command_of(program: Path, where: str) -> list[str]:
    """What starts ``program`` with its line as standard input and output."""
    if where == HOST:
        return [str(program)]
    options = "-M mps2-an386 -display none -monitor none -serial stdio -kernel"
    return ["qemu-system-arm", *options.split(), str(program)]
