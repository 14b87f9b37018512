"""`giveway fmu check`: what is wrong with an FMU, from the zip file down to the libraries its binaries need.

A finding is a fault (an importer may refuse the file, or read something else than was meant) or a note (legal, but
worth a look).
"""

from __future__ import annotations

import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from giveway.errors import FileError
from giveway.fmu_check import archive, binaries, description, documents, structure, units
from giveway.fmu_check.common import DESCRIPTION, UNREADABLE, Found, TestedFile
from giveway.fmu_description import read_description

__all__ = ["CHECKS", "Finding", "check_fmu"]


@dataclass(frozen=True)
class Finding:
    """One thing that a check found.

    Attributes:
        check: its name, a key of `CHECKS`.
        fault: else it is a note.
    """

    check: str
    fault: bool
    text: str

    def __str__(self) -> str:
        return f"{'fault' if self.fault else 'note'} [{self.check}] {self.text}"


def check_fmu(path: Path) -> list[Finding]:
    """All findings of all checks; FileError if ``path`` cannot be opened at all."""
    try:
        opened = zipfile.ZipFile(path)
    except (OSError, zipfile.BadZipFile) as error:
        raise FileError(path, f"is not a zip file that can be read: {error}", "give an .fmu file") from None
    with opened, TemporaryDirectory(prefix="giveway-check-") as folder:
        found: list[Finding] = []
        names = tuple(info.filename for info in opened.infolist() if not info.is_dir())
        parsed, broken = _parse(opened, names)
        found += [Finding("XML", True, text) for text in broken]
        described = None
        if DESCRIPTION in parsed:
            try:
                described = read_description(parsed[DESCRIPTION].getroot())
            except (AttributeError, TypeError, ValueError, IndexError) as error:
                found.append(Finding("XML", True, f"{DESCRIPTION} is not a model description: {error}"))
        if described is not None and described.version not in (2, 3):
            version = described.attributes.get("fmiVersion")
            found.append(Finding("FMI version", True, f"{version!r}; this checks FMI 2 and FMI 3"))
            described = None
        file = TestedFile(opened, names, parsed, described, Path(folder))
        for name, (check, needs_description) in CHECKS.items():
            if described is not None or not needs_description:
                found += [Finding(name, fault, text) for fault, text in check(file)]
        return found


def _parse(archive: zipfile.ZipFile, names: tuple[str, ...]) -> tuple[dict[str, Any], list[str]]:
    """Every XML file as a tree, and what cannot be parsed. No entity is expanded and nothing is fetched."""
    from lxml import etree

    parsed: dict[str, Any] = {}
    broken: list[str] = []
    for name in names:
        if not name.lower().endswith(".xml"):
            continue
        parser = etree.XMLParser(resolve_entities=False, no_network=True, huge_tree=False)
        try:
            parsed[name] = etree.ElementTree(etree.fromstring(archive.read(name), parser))
        except (etree.XMLSyntaxError, ValueError, *UNREADABLE) as error:
            broken.append(f"{name}: {error}")
    return parsed, broken


CHECKS: Mapping[str, tuple[Callable[[TestedFile], Found], bool]] = {
    "zip method": (archive.zip_method, False),
    "zip names": (archive.zip_names, False),
    "zip order": (archive.zip_order, False),
    "layout": (archive.layout, False),
    "schema": (documents.schema, True),
    "build description": (documents.build_description, True),
    "identity": (description.identity, True),
    "names and references": (description.names_and_references, True),
    "start values": (description.start_values, True),
    "start presence": (description.start_presence, True),
    "units": (units.units, True),
    "model structure": (structure.structure, True),
    "event indicators": (structure.event_indicators, True),
    "FMPy": (description.fmpy_validation, True),
    "platforms": (binaries.platforms, True),
    "machine": (binaries.machines, True),
    "exported symbols": (binaries.exports, True),
    "imported libraries": (binaries.imports, True),
    "unloading": (binaries.unloading, True),
}
"""Name -> check, and whether it needs a model description; "XML" and "FMI version" come before them all."""
