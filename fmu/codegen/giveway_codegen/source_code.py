"""An FMU's sources, which an importer compiles itself on any machine.

C++17 and C99 files in one list: all are also valid C++17, so an importer can use the stated language or the extension.
FMI's headers are not included; both standards leave them to the importer.
"""

from __future__ import annotations

from pathlib import Path
from xml.sax.saxutils import quoteattr

from .table import Table

__all__ = ["build_description", "entry", "source_names"]

_PREFIX = {
    # An importer that links the FMU statically needs unique names; one that makes a library of it does not.
    2: "",
    3: """// The prefix that FMI 3 wants of functions that are linked statically; who makes a shared library
// of these sources defines FMI3_OVERRIDE_FUNCTION_PREFIX.
#define FMI3_FUNCTION_PREFIX giveway_{name}_
""",
}


def entry(table: Table, fmi: int) -> str:
    """The file with FMI's functions."""
    return f"""// Generated for the sources of giveway_{table.name}: the functions of FMI {fmi}.
{_PREFIX[fmi].format(name=table.name)}#include "fmi{fmi}_shell.cpp"
"""


def source_names(table: Table, shipped: list[Path], fmi: int) -> list[str]:
    """The files to compile, of ``shipped`` and the generated ones, relative to the folder of the sources."""
    generated = [f"giveway_{table.name}_fmi{fmi}.cpp", f"{table.name}_fmu.cpp", f"{table.name}_variables.cpp"]
    included = {"fmi2_shell.cpp", "fmi3_shell.cpp"}
    files = [path.name for path in shipped if path.suffix in (".c", ".cpp") and path.name not in included]
    return sorted([*generated, *files])


def build_description(table: Table, shipped: list[Path]) -> str:
    """sources/buildDescription.xml of FMI 3."""
    name = f"giveway_{table.name}"
    unprefixed = f"Functions without the prefix {name}_, for a shared library"
    files = "\n".join(f"      <SourceFile name={quoteattr(file)}/>" for file in source_names(table, shipped, 3))
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiBuildDescription fmiVersion="3.0">
  <BuildConfiguration modelIdentifier="{name}" description="Any platform, without exceptions and RTTI">
    <SourceFileSet language="C++17" compilerOptions="-ffp-contract=off">
{files}
      <PreprocessorDefinition name="FMI3_OVERRIDE_FUNCTION_PREFIX" value="1" optional="true"
                              description="{unprefixed}"/>
      <IncludeDirectory name="."/>
    </SourceFileSet>
  </BuildConfiguration>
</fmiBuildDescription>
"""
