"""Exports, imports, dependencies and oldest system of an FMU's shared libraries, read from the files."""

from __future__ import annotations

import hashlib
import re
import struct
import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import lief

__all__ = ["FMI2_FOLDERS", "inspect", "inspected"]

lief.logging.disable()

GLIBC = (2, 17)
MACOS = [11, 0, 0]
# The C library of each system, by all its file names.
C_LIBRARIES = {
    "linux": re.compile(r"libc\.so\.6|libm\.so\.6|ld-linux-(x86-64|aarch64)\.so\.[12]"),
    "windows": re.compile(r"api-ms-win-crt-[a-z]+-l1-1-0\.dll|KERNEL32\.dll|ntdll\.dll", re.IGNORECASE),
    "darwin": re.compile(r"/usr/lib/libSystem\.B\.dylib"),
}
# Symbols that zig's linker exports from every macOS library for its own use.
LINKER_SYMBOLS = {"__dso_handle", "_mh_dylib_header"}
# A function registered with one of these is called at the end of the process or thread, when the importer may already
# have unloaded the library; our libraries need none. Windows' start files keep a table per library
# (_register_onexit_function) and run it when the library is unloaded.
AT_EXIT = {
    *("atexit", "on_exit", "at_quick_exit", "__cxa_atexit", "__cxa_at_quick_exit"),
    *("__cxa_thread_atexit", "__cxa_thread_atexit_impl", "_tlv_atexit"),
    *("_onexit", "_crt_atexit", "_crt_at_quick_exit", "__dllonexit"),
}
PROCESSORS = {
    "linux": {"x86_64": "X86_64", "aarch64": "AARCH64"},
    "windows": {"x86_64": "AMD64"},
    "darwin": {"x86_64": "X86_64", "aarch64": "ARM64"},
}
FMI2_FOLDERS = {
    "linux64": ["x86_64-linux"],
    "win64": ["x86_64-windows"],
    "darwin64": ["x86_64-darwin", "aarch64-darwin"],
}


def fmi_functions(headers: Path) -> set[str]:
    """The names that FMI 2 and 3 require as exports."""
    names: set[str] = set()
    for name in ("fmi2Functions.h", "fmi3Functions.h"):
        names |= set(re.findall(r"FMI[23]_Export\s+fmi[23]\w+TYPE\s+(fmi[23]\w+);", (headers / name).read_text()))
    return names


def _elf(binary: Any) -> dict[str, Any]:
    exported = {s.name for s in binary.dynamic_symbols if s.exported}
    imported = {s.name for s in binary.dynamic_symbols if s.imported}
    needed = [entry.name for entry in binary.dynamic_entries if entry.tag == lief.ELF.DynamicEntry.TAG.NEEDED]
    versions = [
        a.name for requirement in binary.symbols_version_requirement for a in requirement.get_auxiliary_symbols()
    ]
    newest = max(tuple(map(int, v.removeprefix("GLIBC_").split("."))) for v in versions if re.match(r"GLIBC_\d", v))
    faults = [] if newest <= GLIBC else [f"needs glibc {'.'.join(map(str, newest))}"]
    if any(note.type == lief.ELF.Note.TYPE.GNU_BUILD_ID for note in binary.notes):
        faults.append("has a build id")
    since = "glibc " + ".".join(map(str, newest))
    return {"exported": exported, "imported": imported, "needed": needed, "since": since, "faults": faults}


def _pe(binary: Any) -> dict[str, Any]:
    exported = {entry.name for entry in binary.get_export().entries}
    needed = [entry.name for entry in binary.imports]
    imported = {entry.name for library in binary.imports for entry in library.entries}
    major, minor = (
        binary.optional_header.major_operating_system_version,
        binary.optional_header.minor_operating_system_version,
    )
    since = f"Windows {major}.{minor}"
    return {"exported": exported, "imported": imported, "needed": needed, "since": since, "faults": []}


def _macho(binary: Any) -> dict[str, Any]:
    exported = {s.name.removeprefix("_") for s in binary.exported_symbols} - LINKER_SYMBOLS
    imported = {s.name.removeprefix("_") for s in binary.imported_symbols}
    needed = [library.name for library in binary.libraries if library.command == lief.MachO.LoadCommand.TYPE.LOAD_DYLIB]
    oldest = list(binary.build_version.minos)
    faults = [] if oldest == MACOS else [f"needs macOS {oldest[0]}.{oldest[1]}"]
    own = [c.name for c in binary.commands if c.command == lief.MachO.LoadCommand.TYPE.ID_DYLIB]
    if not own or not own[0].startswith("@rpath/"):
        faults.append(f"its own name is {own}")
    signed = binary.has_code_signature
    if binary.header.cpu_type == lief.MachO.Header.CPU_TYPE.ARM64 and not signed:
        faults.append("is not signed, which Apple silicon demands")
    since = f"macOS {oldest[0]}.{oldest[1]}"
    return {"exported": exported, "imported": imported, "needed": needed, "since": since, "faults": faults}


def inspect(data: bytes, platform: str, wanted: set[str], besides: re.Pattern[str] | None = None) -> dict[str, Any]:
    """Figures and faults of one library that claims to be for ``platform``.

    ``wanted``: what it exports; ``besides``: what else than the C library it may need.
    """
    machine, system = platform.split("-")
    reader = {"linux": (lief.ELF, _elf), "windows": (lief.PE, _pe), "darwin": (lief.MachO, _macho)}[system]
    binary = reader[0].parse(data)
    if system == "darwin" and binary is not None:
        binary = binary.at(0)
    if binary is None:
        return {
            "since": "",
            "needed": [],
            "exports": 0,
            "bytes": len(data),
            "sha256": "",
            "faults": [f"is no library for {system}"],
        }
    found = reader[1](binary)
    faults: list[str] = found["faults"]
    header = binary.header
    processor = (
        getattr(header, "machine_type", None) or getattr(header, "machine", None) or getattr(header, "cpu_type", None)
    )
    if str(processor).split(".")[-1] != PROCESSORS[system][machine]:
        faults.append(f"is for the processor {processor}")
    if found["exported"] != wanted:
        odd = sorted(found["exported"] ^ wanted)
        faults.append(f"exports {len(found['exported'])} functions, not the {len(wanted)} wanted: {', '.join(odd[:3])}")
    late = sorted(found["imported"] & AT_EXIT)
    if late:
        faults.append(f"registers code for the end of the process ({', '.join(late)}), when the library may be gone")
    foreign = [name for name in found["needed"] if not C_LIBRARIES[system].fullmatch(name)]
    foreign = [name for name in foreign if besides is None or not besides.fullmatch(name)]
    if foreign:
        faults.append(f"needs {', '.join(foreign)}")
    return {
        "since": found["since"],
        "needed": found["needed"],
        "exports": len(found["exported"]),
        "bytes": len(data),
        "sha256": hashlib.sha256(data).hexdigest(),
        "faults": faults,
    }


def _slices(data: bytes) -> list[bytes]:
    """The images of a universal binary."""
    magic, count = struct.unpack_from(">II", data)
    if magic != 0xCAFEBABE:
        return [data]
    tables = [struct.unpack_from(">IIIII", data, 8 + 20 * i) for i in range(count)]
    return [data[offset : offset + size] for _, _, offset, size, _ in tables]


def _libraries(fmu: Path) -> dict[str, bytes]:
    """Folder below ``binaries`` -> the library in it."""
    with zipfile.ZipFile(fmu) as archive:
        names = [name for name in archive.namelist() if name.startswith("binaries/")]
        return {name.split("/")[1]: archive.read(name) for name in names}


def inspected(fmus: Sequence[Path], headers: Path) -> Iterator[dict[str, Any]]:
    """For every library: FMU, folder, platform, figures and faults. ``headers``: folder of FMI's headers."""
    wanted = fmi_functions(headers)
    for path in fmus:
        for folder, data in _libraries(path).items():
            platforms = FMI2_FOLDERS.get(folder, [folder])
            images = _slices(data)
            for platform, image in zip(platforms, images, strict=True):
                found = inspect(image, platform, wanted)
                yield {"fmu": path.name, "folder": folder, "platform": platform, **found}
