"""An FMU's sources: what an importer compiles itself, on whatever machine it has.

C++17 and C99 files in one list: all are valid C++17 too, so an importer can go by the language or by the extension. The
headers of FMI are not among them; both standards leave them to the importer.
"""

from __future__ import annotations

from pathlib import Path
from xml.sax.saxutils import quoteattr

from .table import Table

__all__ = ["build_description", "entry", "source_names"]

_PREFIX = {
    # An importer that links the FMU statically needs names of its own; one that makes a library of it does not.
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
    """What has to be compiled, of ``shipped`` and the generated files, relative to the folder of the sources."""
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
