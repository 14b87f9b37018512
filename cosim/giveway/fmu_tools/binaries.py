"""Content of a shared library of Linux, Windows or macOS: machine, exports, libraries it needs (by LIEF).

The library may be damaged or malicious, so LIEF reads it in a separate process.
"""

from __future__ import annotations

import functools
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fmpy

from giveway.base.errors import FileError
from giveway.base.extras import extra
from giveway.fmu_tools.isolation import IsolatedError, isolated

__all__ = ["PLATFORMS", "Binary", "fmi_functions", "is_common", "is_of_the_system", "platform_here", "read_binary"]

LARGEST_BYTES = 100_000_000
READING_S, READING_MB = 8, 1000

# Folder under binaries/ of FMI 2 and 3: (machine, operating system, ending).
PLATFORMS = {
    2: {
        "linux64": ("x86_64", "linux", ".so"),
        "linux32": ("i686", "linux", ".so"),
        "win64": ("x86_64", "windows", ".dll"),
        "win32": ("i686", "windows", ".dll"),
        "darwin64": ("x86_64", "darwin", ".dylib"),
    },
    3: {
        f"{machine}-{system}": (machine, system, ending)
        for machine in ("x86_64", "aarch64", "i686")
        for system, ending in (("linux", ".so"), ("windows", ".dll"), ("darwin", ".dylib"))
    },
}
_MACHINES = {
    "X86_64": "x86_64",
    "AMD64": "x86_64",
    "I386": "i686",
    "X86": "i686",
    "AARCH64": "aarch64",
    "ARM64": "aarch64",
}
# Libraries on every machine with that system.
_SYSTEM_LIBRARIES = {
    "linux": re.compile(r"lib(c|m|dl|rt|pthread)\.so(\.\d+)*|ld-linux.*|linux-vdso.*"),
    "windows": re.compile(r"(kernel32|ntdll|msvcrt|ucrtbase|advapi32|user32)\.dll|api-ms-win-.*\.dll", re.IGNORECASE),
    "darwin": re.compile(r"/usr/lib/libSystem\.B\.dylib"),
}
# Runtimes of compilers: on nearly every machine that runs other programs.
_COMMON_LIBRARIES = {
    "linux": re.compile(r"lib(stdc\+\+|gcc_s|gomp|atomic)\.so(\.\d+)*"),
    "windows": re.compile(r"(msvcp|vcruntime|concrt)\d+(_\d+)?\.dll", re.IGNORECASE),
    "darwin": re.compile(r"/usr/lib/lib(c\+\+|c\+\+abi|objc)\..*dylib"),
}


@dataclass(frozen=True)
class Binary:
    """One shared library.

    Attributes:
        machines: "x86_64", "aarch64", "i686"; several in a universal file of macOS.
        exported: names of exported functions, without macOS's leading underscore.
        imported: names from other libraries; read for Linux only.
        needed: libraries it asks the loader for.
        newest_glibc: the newest version of the GNU C library that it asks for, such as (2, 17); None if there is none.
    """

    system: str
    machines: frozenset[str]
    exported: frozenset[str]
    needed: tuple[str, ...]
    newest_glibc: tuple[int, ...] | None
    imported: frozenset[str] = frozenset()


def read_binary(path: Path) -> Binary:
    """Read ``path``; FileError if it is not a shared library, is truncated, or too large to read."""
    size = path.stat().st_size
    if size > LARGEST_BYTES:
        raise FileError(path, f"has {size / 1e6:.0f} MB, too many to look into it")
    extra("lief", "fmu").logging.disable()  # loaded here, so that the reading process does not have to
    try:
        found = isolated(_read, path, READING_S, READING_MB)
    except IsolatedError as error:
        raise FileError(path, f"is damaged: reading it {error}") from None
    if isinstance(found, str):
        raise FileError(path, found)
    return found


def _read(path: Path) -> Binary | str:
    """Its content, or its fault."""
    import lief

    size = path.stat().st_size
    if lief.is_elf(str(path)):
        elf = lief.ELF.parse(str(path))
        if elf is None:
            return DAMAGED
        header = elf.header
        end = max(
            header.section_header_offset + header.numberof_sections * header.section_header_size,
            *(s.file_offset + s.physical_size for s in elf.segments),
        )
        if end > size:
            return cut_short(end, size)
        versions = [s.symbol_version for s in elf.dynamic_symbols if s.imported and s.symbol_version is not None]
        auxiliary = [v.symbol_version_auxiliary for v in versions if v.has_auxiliary_version]
        names = [str(a.name) for a in auxiliary if a is not None]
        numbers = [
            tuple(int(n) for n in found[1].split(".")) for v in names if (found := re.match(r"GLIBC_([\d.]+)", v))
        ]
        return Binary(
            "linux",
            frozenset({_machine(elf.header.machine_type)}),
            frozenset(str(s.name) for s in elf.exported_symbols),
            tuple(str(name) for name in elf.libraries),
            max(numbers, default=None),
            frozenset(str(s.name) for s in elf.imported_symbols),
        )
    if lief.is_pe(str(path)):
        pe = lief.PE.parse(str(path))
        if pe is None:
            return DAMAGED
        end = max((s.pointerto_raw_data + s.sizeof_raw_data for s in pe.sections), default=0)
        if end > size:
            return cut_short(end, size)
        exported = frozenset(str(f.name) for f in pe.exported_functions)
        needed = tuple(str(imported.name) for imported in pe.imports)
        return Binary("windows", frozenset({_machine(pe.header.machine)}), exported, needed, None)
    if lief.is_macho(str(path)):
        fat = lief.MachO.parse(str(path))
        if fat is None or fat.size == 0:
            return DAMAGED
        slices = [fat.at(index) for index in range(fat.size)]
        end = max(
            (part.fat_offset + s.file_offset + s.file_size for part in slices if part for s in part.segments), default=0
        )
        if end > size:
            return cut_short(end, size)
        return Binary(
            "darwin",
            frozenset(_machine(part.header.cpu_type) for part in slices if part is not None),
            frozenset.intersection(
                *(frozenset(str(s.name).removeprefix("_") for s in p.exported_symbols) for p in slices if p)
            ),
            tuple(sorted({str(lib.name) for part in slices if part for lib in _loaded(part)})),
            None,
        )
    return "is no shared library of Linux, Windows or macOS"


DAMAGED = "is damaged: it begins like a shared library, but cannot be read as one"


def cut_short(needed: int, size: int) -> str:
    return f"is cut short: it has {size} bytes, and its parts end at byte {needed}"


def _loaded(macho: Any) -> list[Any]:
    """The libraries of a Mach-O file, except its own name, which is listed among them."""
    import lief

    own = lief.MachO.LoadCommand.TYPE.ID_DYLIB
    return [library for library in macho.libraries if library.command != own]


def _machine(value: object) -> str:
    name = str(value).rpartition(".")[2]
    return _MACHINES.get(name, name)


def is_of_the_system(system: str, library: str) -> bool:
    """Whether every machine with that operating system has ``library``."""
    return _SYSTEM_LIBRARIES[system].fullmatch(library) is not None


def is_common(system: str, library: str) -> bool:
    """Whether nearly every machine with that operating system has ``library``: the runtime of a usual compiler."""
    return _COMMON_LIBRARIES[system].fullmatch(library) is not None


def platform_here(version: int) -> str:
    """The folder below binaries/ that this machine loads from."""
    if version == 2:
        return str(fmpy.platform)
    return str(fmpy.platform_tuple)


@functools.cache
def fmi_functions(version: int) -> frozenset[str]:
    """Every function of that FMI version, from the headers that FMPy carries."""
    header = Path(fmpy.__file__).parent / "c-code" / f"fmi{version}Functions.h"
    pattern = rf"FMI{version}_Export\s+fmi{version}\w+TYPE\s+(fmi{version}\w+);"
    return frozenset(re.findall(pattern, header.read_text(encoding="utf-8")))
