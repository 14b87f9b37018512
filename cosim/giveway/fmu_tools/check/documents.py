"""XML files against their schemas, and the lists of source files against the files."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from giveway.fmu_tools.archive import shown
from giveway.fmu_tools.check.common import DESCRIPTION, FAULT, NOTE, Found, TestedFile

__all__ = ["BUILD_DESCRIPTION", "TERMINALS", "build_description", "is_manifest", "manifests", "schema"]

BUILD_DESCRIPTION = "sources/buildDescription.xml"
TERMINALS = "terminalsAndIcons/terminalsAndIcons.xml"
LARGEST_TREE_BYTES = 8_000_000  # of an XML file that is read as a tree, which takes up to twenty times as much memory
_SCHEMAS = {
    3: {
        DESCRIPTION: "fmi3ModelDescription.xsd",
        BUILD_DESCRIPTION: "fmi3BuildDescription.xsd",
        TERMINALS: "fmi3TerminalsAndIcons.xsd",
    },
    # FMI 2 has its own schema only for the description; for the other two 2.0.4 uses those of FMI 3.
    2: {DESCRIPTION: "fmi2ModelDescription.xsd"},
}
_CODE = (".c", ".cpp", ".cc", ".h", ".hpp", ".inc", ".inl")
_LAYERED = "{http://fmi-standard.org/fmi-ls-manifest}"
_LAYERED_ATTRIBUTES = ("fmi-ls-name", "fmi-ls-version", "fmi-ls-description")


def schema(file: TestedFile) -> Found:
    import fmpy
    from lxml import etree

    for name, schema in _SCHEMAS[file.described().version].items():
        if name not in file.sound:
            continue
        folder = Path(fmpy.__file__).parent / "schema" / ("fmi3" if schema.startswith("fmi3") else "fmi2")
        validator = etree.XMLSchema(etree.parse(str(folder / schema)))
        if file.archive.files[name].file_size > LARGEST_TREE_BYTES:
            yield from _against_schema_as_stream(file, name, validator)
            continue
        try:
            root = file.tree(name)
        except etree.XMLSyntaxError as error:  # libxml2's own limits: text of 10 MB and such
            yield FAULT, f"{name}: {error.msg}"
            continue
        if not validator.validate(root):
            for entry in validator.error_log:
                yield FAULT, f"{name}, line {entry.line}: {shown(entry.message, 400)}"


def _against_schema_as_stream(file: TestedFile, name: str, validator: Any) -> Found:
    """Without a tree; it finds the same faults, but no line numbers."""
    from lxml import etree

    parser = etree.XMLPullParser(events=("end",), schema=validator, resolve_entities=False, no_network=True)
    try:
        for chunk in file.archive.chunks(file.archive.files[name]):
            parser.feed(chunk)
            for _, element in parser.read_events():
                element.clear()
                while element.getprevious() is not None:
                    del element.getparent()[0]
        parser.close()
    except etree.XMLSyntaxError as error:
        log = error.error_log
        for entry in log if len(log) else (error,):
            yield FAULT, f"{name}: {shown(entry.message if len(log) else str(error), 400)}"


def is_manifest(name: str) -> bool:
    """Whether it is the manifest of a layered standard."""
    return re.fullmatch(r"extra/[^/]+/fmi-ls-manifest\.xml", name) is not None


def manifests(file: TestedFile) -> Found:
    """A layered standard's manifest has any root element; FMI 3 recommends three attributes of its own namespace."""
    from lxml import etree

    for name in file.names:
        if not is_manifest(name) or name not in file.sound or file.archive.files[name].file_size > LARGEST_TREE_BYTES:
            continue
        try:
            root = file.tree(name)
        except etree.XMLSyntaxError as error:
            yield FAULT, f"{shown(name)}: {error.msg}"
            continue
        for attribute in _LAYERED_ATTRIBUTES:
            if not root.get(_LAYERED + attribute, "").strip():
                yield NOTE, f"{shown(name)} has no {attribute}, which tools that do not know that standard would show"


def build_description(file: TestedFile) -> Found:
    """Listed source files exist, and existing source files are listed."""
    description = file.described()
    sources = {n.removeprefix("sources/") for n in file.names if n.startswith("sources/")}
    named: set[str] = set()
    if description.version == 2:
        for interface, files in description.source_files.items():
            named |= set(files)
            for name in files:
                if name not in sources:
                    yield FAULT, f"{interface} names the source file {shown(name)}, which is not in sources/"
    elif BUILD_DESCRIPTION in file.sound:
        identifiers = {a.get("modelIdentifier", "") for a in description.interfaces.values()}
        for configuration in _small_tree(file, BUILD_DESCRIPTION).iterfind("BuildConfiguration"):
            identifier = configuration.get("modelIdentifier")
            if identifier not in identifiers:
                yield FAULT, f"buildDescription.xml builds {identifier!r}, not {sorted(identifiers)}"
            for element in configuration.iterfind("SourceFileSet/SourceFile"):
                source = element.get("name", "")
                named.add(source)
                if source not in sources:
                    yield FAULT, f"buildDescription.xml names {shown(source)}, which is not in sources/"
    elif sources and BUILD_DESCRIPTION not in file.names:
        yield FAULT, "there is a folder sources/, but no sources/buildDescription.xml"
    compiled = {name for name in sources if name.endswith((".c", ".cpp", ".cc"))}
    if named:
        for name in sorted(compiled - named - _included(file, sources)):
            yield NOTE, f"sources/{shown(name)} is in no list of source files"
    elif compiled and description.version == 2:
        yield FAULT, "there are sources, but no interface names its source files"


def _small_tree(file: TestedFile, name: str) -> Any:
    """The file's tree, or one without children if it is too large for one."""
    from lxml import etree

    if file.archive.files[name].file_size <= LARGEST_TREE_BYTES:
        try:
            return file.tree(name)
        except etree.XMLSyntaxError:
            pass  # the check of schemas reports it
    return etree.Element("empty")


def _included(file: TestedFile, sources: set[str]) -> set[str]:
    """Files that a source file includes: they are compiled with it."""
    found: set[str] = set()
    for name in sources:
        path = f"sources/{name}"
        if name.endswith(_CODE) and file.archive.files[path].file_size <= LARGEST_TREE_BYTES:
            text = file.read(path).decode("utf-8", "replace")
            found |= set(re.findall(r'^[ \t]*#[ \t]*include[ \t]*"([^"\n]+)"', text, re.MULTILINE))
    return found
