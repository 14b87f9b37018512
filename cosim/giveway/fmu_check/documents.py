"""XML files against their schemas, and the lists of source files against the files."""

from __future__ import annotations

import re
from pathlib import Path

from giveway.fmu_check.common import DESCRIPTION, FAULT, NOTE, Found, TestedFile

__all__ = ["build_description", "schema"]


_SCHEMAS = {
    3: {
        DESCRIPTION: "fmi3ModelDescription.xsd",
        "sources/buildDescription.xml": "fmi3BuildDescription.xsd",
        "terminalsAndIcons/terminalsAndIcons.xml": "fmi3TerminalsAndIcons.xsd",
    },
    # FMI 2 has a schema of its own for the description alone; the other two came with 2.0.4 as FMI 3 has them.
    2: {DESCRIPTION: "fmi2ModelDescription.xsd"},
}


def schema(file: TestedFile) -> Found:
    import fmpy
    from lxml import etree

    version = file.described().version
    schemas = dict(_SCHEMAS[version])
    schemas |= {n: "fmi3LayeredStandardManifest.xsd" for n in file.names if n.endswith("/fmi-ls-manifest.xml")}
    for name, schema in schemas.items():
        if name not in file.documents:
            continue
        folder = Path(fmpy.__file__).parent / "schema" / ("fmi3" if schema.startswith("fmi3") else "fmi2")
        validator = etree.XMLSchema(etree.parse(str(folder / schema)))
        if not validator.validate(file.documents[name]):
            for error in validator.error_log:
                yield FAULT, f"{name}, line {error.line}: {error.message}"


def build_description(file: TestedFile) -> Found:
    """Source files that are named exist, and those that exist are named."""
    description = file.described()
    sources = {n.removeprefix("sources/") for n in file.names if n.startswith("sources/")}
    named: set[str] = set()
    if description.version == 2:
        for interface, files in description.source_files.items():
            named |= set(files)
            for name in files:
                if name not in sources:
                    yield FAULT, f"{interface} names the source file {name}, which is not in sources/"
    elif "sources/buildDescription.xml" in file.documents:
        identifiers = {a.get("modelIdentifier", "") for a in description.interfaces.values()}
        for configuration in file.documents["sources/buildDescription.xml"].iterfind("BuildConfiguration"):
            if configuration.get("modelIdentifier") not in identifiers:
                yield (
                    FAULT,
                    f"buildDescription.xml builds {configuration.get('modelIdentifier')!r}, not {sorted(identifiers)}",
                )
            for element in configuration.iterfind("SourceFileSet/SourceFile"):
                named.add(element.get("name", ""))
                if element.get("name") not in sources:
                    yield FAULT, f"buildDescription.xml names {element.get('name')}, which is not in sources/"
    elif sources:
        yield FAULT, "there is a folder sources/, but no sources/buildDescription.xml"
    compiled = {name for name in sources if name.endswith((".c", ".cpp", ".cc"))}
    if named:
        for name in sorted(compiled - named - _included(file, sources)):
            yield NOTE, f"sources/{name} is in no list of source files"
    elif compiled and description.version == 2:
        yield FAULT, "there are sources, but no interface names its source files"


def _included(file: TestedFile, sources: set[str]) -> set[str]:
    """Files that a source file includes: they are compiled with it."""
    found: set[str] = set()
    for name in sources:
        text = file.read(f"sources/{name}").decode("utf-8", "replace")
        found |= set(re.findall(r'^\s*#\s*include\s*"([^"]+)"', text, re.MULTILINE))
    return found
