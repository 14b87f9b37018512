"""Small FMUs to try importers with: a model description by hand, and a library of functions that do nothing."""

from __future__ import annotations

import functools
import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterable, Mapping
from pathlib import Path

from giveway.fmu_tools.binaries import PLATFORMS, fmi_functions, platform_here

EPOCH = (1980, 1, 1, 0, 0, 0)
DESCRIPTION = "modelDescription.xml"
NAME = "stub"
Entry = tuple[zipfile.ZipInfo, bytes]

VARIABLES_3 = """
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    <Float64 name="u" valueReference="1" causality="input" variability="continuous" start="0.0" unit="N"/>
    <Boolean name="on" valueReference="2" causality="input" start="false"/>
    <Int32 name="steps" valueReference="3" causality="output"/>
    <Float64 name="y" valueReference="4" causality="output" variability="continuous" unit="N"/>
    <Float64 name="z" valueReference="5" causality="local" variability="continuous"/>"""
STRUCTURE_3 = """
    <Output valueReference="3" dependencies=""/>
    <Output valueReference="4" dependencies="1"/>
    <InitialUnknown valueReference="3" dependencies=""/>
    <InitialUnknown valueReference="4" dependencies="1"/>"""
CO_SIMULATION = f'<CoSimulation modelIdentifier="{NAME}" canHandleVariableCommunicationStepSize="true"/>'


def description_3(
    interfaces: str = CO_SIMULATION,
    experiment: str = 'startTime="0.0" stopTime="1.0" stepSize="0.1"',
    variables: str = VARIABLES_3,
    structure: str = STRUCTURE_3,
) -> str:
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="{NAME}" instantiationToken="t">
  {interfaces}
  <UnitDefinitions><Unit name="N"><BaseUnit kg="1" m="1" s="-2"/></Unit></UnitDefinitions>
  <DefaultExperiment {experiment}/>
  <ModelVariables>{variables}
  </ModelVariables>
  <ModelStructure>{structure}
  </ModelStructure>
</fmiModelDescription>
"""


def description_2() -> str:
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="{NAME}" guid="g">
  <CoSimulation modelIdentifier="{NAME}" canHandleVariableCommunicationStepSize="true"/>
  <DefaultExperiment stopTime="1.0" stepSize="0.1"/>
  <ModelVariables>
    <ScalarVariable name="y" valueReference="1" causality="output"><Real/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="1" dependencies=""/></Outputs>
    <InitialUnknowns><Unknown index="1" dependencies=""/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""


@functools.cache
def library(
    version: int = 3,
    bodies: tuple[tuple[str, str], ...] = (),
    extra: str = "",
    signatures: tuple[tuple[str, str], ...] = (),
) -> bytes:
    """A shared library with every FMI function; those in ``bodies`` do what is said, the others nothing.

    ``signatures`` replaces "NAME(void)" for those that look at their arguments.
    """
    special = dict(bodies)
    lines = [
        "#include <signal.h>\n#include <stdio.h>\n#include <stdlib.h>\n#include <unistd.h>\nstatic int instance;",
        extra,
    ]
    for name in sorted(fmi_functions(version)):
        pointer = "Instantiate" in name
        usual = "return &instance;" if pointer else 'return "0";' if "GetVersion" in name else "return 0;"
        kind = "void *" if pointer else "const char *" if "Get" in name and usual.endswith('"0";') else "int "
        arguments = "void *a, double b, double c" if name.endswith("DoStep") else "void"
        if name == "fmi3GetFloat64":
            arguments = "void *c, const unsigned *vr, size_t n, double *value, size_t m"
        lines.append(f"{kind}{name}({arguments}) {{ {special.get(name, usual)} }}")
    with tempfile.TemporaryDirectory() as folder:
        source, built = Path(folder) / "stub.c", Path(folder) / "stub.so"
        text = "\n".join(lines)
        for old, new in signatures:
            text = text.replace(old, new)
        source.write_text(text)
        subprocess.run(["cc", "-shared", "-fPIC", "-w", "-o", built, source], check=True)
        return built.read_bytes()


def binary_name(version: int = 3) -> str:
    platform = platform_here(version)
    return f"binaries/{platform}/{NAME}{PLATFORMS[version][platform][2]}"


def files(version: int = 3, description: str | None = None, binary: bytes | None = None) -> dict[str, bytes]:
    """What is in a healthy one."""
    text = description or (description_3() if version == 3 else description_2())
    return {
        DESCRIPTION: text.encode(),
        binary_name(version): library(version) if binary is None else binary,
        "documentation/index.html": b"<html></html>",
    }


def entry(name: str, content: bytes = b"x", mode: int = 0) -> Entry:
    info = zipfile.ZipInfo(name, EPOCH)
    info.compress_type = zipfile.ZIP_DEFLATED
    info.external_attr = mode << 16
    return info, content


def pack(path: Path, content: Mapping[str, bytes], more: Iterable[Entry] = ()) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for info, data in [*(entry(name, content[name]) for name in sorted(content)), *more]:
            archive.writestr(info, data)
    return path


def patch_directory(path: Path, name: str, offset: int, value: bytes) -> None:
    """Write ``value`` into the directory's record of ``name``, ``offset`` bytes after its beginning."""
    data = bytearray(path.read_bytes())
    at = data.rindex(name.encode()) - 46
    assert data[at : at + 4] == b"PK\x01\x02"
    data[at + offset : at + offset + len(value)] = value
    path.write_bytes(data)


def own_temporary_folder(parent: Path) -> tuple[Path, dict[str, str]]:
    """A folder for temporary files, and an environment in which it is used."""
    folder = parent / "temporary"
    folder.mkdir()
    return folder, {**os.environ, "TMPDIR": str(folder)}


def command() -> str:
    found = shutil.which("giveway", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    assert found is not None
    return found
