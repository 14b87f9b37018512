"""The shared libraries: present, for the right machine, exporting FMI and needing only the C library."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from giveway.base.errors import FileError
from giveway.base.files import scratch_folder
from giveway.fmu_tools.archive import Archive, shown
from giveway.fmu_tools.check.common import FAULT, NOTE, Found, TestedFile

if TYPE_CHECKING:
    from giveway.fmu_tools.binaries import Binary

__all__ = ["binary_of", "exports", "imports", "machines", "needed_functions", "platforms", "unloading"]


def _binary_names(file: TestedFile) -> dict[str, list[str]]:
    """Files below binaries/PLATFORM/, by platform."""
    found: dict[str, list[str]] = {}
    for name in file.names:
        parts = name.split("/")
        if parts[0] == "binaries" and len(parts) > 2:
            found.setdefault(parts[1], []).append(name)
    return found


def platforms(file: TestedFile) -> Found:
    from giveway.fmu_tools.binaries import PLATFORMS

    description = file.described()
    found = _binary_names(file)
    identifiers = sorted({shown(a.get("modelIdentifier", "")) for a in description.interfaces.values()})
    if not found and not any(name.startswith("sources/") for name in file.names):
        yield FAULT, "there is neither a binary nor source code"
    known = PLATFORMS[description.version]
    for platform, names in found.items():
        if platform not in known:
            yield NOTE, f"binaries/{shown(platform)} is no platform that FMI {description.version} names"
            continue
        for identifier in identifiers:
            wanted = f"binaries/{platform}/{identifier}{known[platform][2]}"
            if wanted not in names:
                yield FAULT, f"{wanted} is missing: an importer looks for the model identifier"


def _each_binary(file: TestedFile) -> Iterator[tuple[str, str, Binary | FileError]]:
    """(name, platform, content) for the model's binary of every known platform."""
    from giveway.fmu_tools.binaries import PLATFORMS

    description = file.described()
    known = PLATFORMS[description.version]
    identifiers = {a.get("modelIdentifier", "") for a in description.interfaces.values()}
    for platform, names in _binary_names(file).items():
        for name in names:
            if platform in known and PurePosixPath(name).stem in identifiers and name.endswith(known[platform][2]):
                if name not in file.binaries:
                    file.binaries[name] = binary_of(file.archive, name)
                yield name, platform, file.binaries[name]


def binary_of(archive: Archive, name: str) -> Binary | FileError:
    """The content of one shared library of the FMU, or why it cannot be read."""
    from giveway.fmu_tools.binaries import read_binary

    with scratch_folder("giveway-check-") as folder:
        path = folder / "library"  # not the name, which may point anywhere
        try:
            with path.open("wb") as stream:
                for piece in archive.chunks(archive.files[name]):
                    stream.write(piece)
            return read_binary(path)
        except FileError as error:
            return error


def machines(file: TestedFile) -> Found:
    from giveway.fmu_tools.binaries import PLATFORMS

    known = PLATFORMS[file.described().version]
    for name, platform, binary in _each_binary(file):
        machine, system, _ = known[platform]
        if isinstance(binary, FileError):
            yield FAULT, f"{name} {binary.value}"
        elif binary.system != system or machine not in binary.machines:
            yield FAULT, f"{name} is for {binary.system} on {', '.join(sorted(binary.machines))}, not for {platform}"


def exports(file: TestedFile) -> Found:
    from giveway.fmu_tools.binaries import fmi_functions

    description = file.described()
    needed = needed_functions(description.version, description.interfaces)
    every = fmi_functions(2) | fmi_functions(3)
    for name, _, binary in _each_binary(file):
        if isinstance(binary, FileError):
            continue
        for function in sorted(needed - binary.exported):
            yield FAULT, f"{name} does not export {function}"
        strangers = sorted(s for s in binary.exported - every if not s.startswith(("_init", "_fini")))
        if strangers:
            some = shown(", ".join(strangers[:3]))
            yield (
                NOTE,
                f"{name} exports {len(strangers)} symbols that are not FMI's ({some}); another FMU's may clash",
            )


# Functions of one interface only; an FMU without the interface need not export them.
_ONLY_EXCHANGE = (
    "EnterContinuousTimeMode",
    "CompletedIntegratorStep",
    "SetTime",
    "SetContinuousStates",
    "GetDerivatives",
    "GetContinuousStateDerivatives",
    "GetEventIndicators",
    "GetContinuousStates",
    "GetNominalsOfContinuousStates",
    "GetNumberOfEventIndicators",
    "GetNumberOfContinuousStates",
    "NewDiscreteStates",
)
_ONLY_STEPPING = (
    "DoStep",
    "CancelStep",
    "GetStatus",
    "GetRealStatus",
    "GetIntegerStatus",
    "GetBooleanStatus",
    "GetStringStatus",
    "SetRealInputDerivatives",
    "GetRealOutputDerivatives",
    "GetOutputDerivatives",
    "EnterStepMode",
)


def needed_functions(version: int, interfaces: Collection[str]) -> frozenset[str]:
    """The functions that an importer may look up: in FMI 2 those of the interface, in FMI 3 all functions."""
    from giveway.fmu_tools.binaries import fmi_functions

    every = fmi_functions(version)
    if version == 3:
        return every
    needed = set(every)
    if "ModelExchange" not in interfaces:
        needed -= {f"fmi2{name}" for name in (*_ONLY_EXCHANGE, "EnterEventMode")}
    if "CoSimulation" not in interfaces:
        needed -= {f"fmi2{name}" for name in _ONLY_STEPPING}
    return frozenset(needed)


def imports(file: TestedFile) -> Found:
    from giveway.fmu_tools.binaries import is_common, is_of_the_system

    for name, platform, binary in _each_binary(file):
        if isinstance(binary, FileError):
            continue
        beside = {PurePosixPath(n).name for n in _binary_names(file)[platform]}
        for library in binary.needed:
            if is_of_the_system(binary.system, library) or PurePosixPath(library).name in beside:
                continue
            if is_common(binary.system, library):
                yield NOTE, f"{name} needs {library}: nearly every machine has it, but which version?"
            else:
                yield FAULT, f"{name} needs {shown(library)}, which not every machine has and the FMU does not bring"


def unloading(file: TestedFile) -> Found:
    """Destructors that Linux would call at the end of the process, after an importer has unloaded the library."""
    for name, _, binary in _each_binary(file):
        # The start files call __cxa_finalize when the library is unloaded, which runs them in time.
        if (
            not isinstance(binary, FileError)
            and "__cxa_atexit" in binary.imported
            and "__cxa_finalize" not in binary.imported
        ):
            yield (
                FAULT,
                f"{name} imports __cxa_atexit without __cxa_finalize: its destructors run at the end of the process, "
                "which crashes if an importer has unloaded it",
            )
