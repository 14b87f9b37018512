"""`giveway fmu check`: faults of an FMU, from the zip file to the libraries its binaries need.

`severity` explains the severities. `refusals` is the part that `giveway fmu run` and `info` use: findings that make a
file unsafe to unpack, or unreadable.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from giveway.base.errors import FileError
from giveway.fmu_tools.archive import Archive, ArchiveError, OverLimitError, shown
from giveway.fmu_tools.check import archive, binaries, description, documents, structure, unit_definitions
from giveway.fmu_tools.check.common import DESCRIPTION, Found, TestedFile
from giveway.fmu_tools.check.severity import Severity
from giveway.fmu_tools.description import Description, VersionError, read_description
from giveway.fmu_tools.limits import Limits
from giveway.fmu_tools.xml_files import Budget, XmlError, read_xml

__all__ = ["CHECKS", "Check", "Finding", "Severity", "check_fmu", "open_safely"]

MOST_OF_ONE_KIND = 50  # findings of one check and severity; the rest is counted
_FMI_XML = (DESCRIPTION, documents.BUILD_DESCRIPTION, documents.TERMINALS)


@dataclass(frozen=True)
class Finding:
    """One finding of a check.

    Attributes:
        check: its name, a key of `CHECKS`, or "limits", "XML" or "FMI version".
    """

    check: str
    severity: Severity
    text: str

    @property
    def fault(self) -> bool:
        return self.severity is Severity.FAULT

    def __str__(self) -> str:
        return f"{self.severity.value} [{self.check}] {self.text}"


@dataclass(frozen=True)
class Check:
    """One check.

    Attributes:
        needs_description: it is skipped without a readable model description.
        refuses: its faults make a file unsafe to unpack or impossible to run: `giveway fmu run` refuses it.
    """

    function: Callable[[TestedFile], Found]
    needs_description: bool = True
    refuses: bool = False

    def findings(self, name: str, file: TestedFile) -> Iterator[Finding]:
        """At most `MOST_OF_ONE_KIND` findings of each severity, and the number of the others."""
        count: Counter[Severity] = Counter()
        for severity, text in self.function(file):
            count[severity] += 1
            if count[severity] <= MOST_OF_ONE_KIND:
                yield Finding(name, severity, text)
        for severity, number in count.items():
            if number > MOST_OF_ONE_KIND:
                yield Finding(name, severity, f"and {number - MOST_OF_ONE_KIND:,} more of this kind")


def check_fmu(path: Path, limits: Limits | None = None) -> list[Finding]:
    """All findings of all checks; FileError if ``path`` cannot be opened at all."""
    try:
        opened = Archive(path, limits)
    except OverLimitError as error:
        return [Finding("limits", Severity.FAULT, f"{error.value}; {error.allowed}")]
    with opened:
        file, found = _read(opened)
        for name, check in CHECKS.items():
            if file.description is not None or not check.needs_description:
                found += check.findings(name, file)
        return found


def open_safely(path: Path, limits: Limits | None = None) -> tuple[Archive, Description]:
    """The FMU open for unpacking, and its model description.

    Raises FileError with the first reason why it is unsafe to unpack, or why its description cannot be read.
    """
    opened = Archive(path, limits)
    try:
        file, found = _read(opened)
        for name, check in CHECKS.items():
            if check.refuses:
                found += check.findings(name, file)
        faults = [finding for finding in found if finding.fault]
        if faults:
            others = f"; {len(faults) - 1} more" if len(faults) > 1 else ""
            hint = f"`giveway fmu check` says more{others}"
            raise FileError(path, f"is refused: {faults[0].text}", hint)
        assert file.description is not None
    except BaseException:
        opened.close()
        raise
    return opened, file.description


def _read(opened: Archive) -> tuple[TestedFile, list[Finding]]:
    """FMI's own XML files as a stream, and their faults. No entity is expanded and nothing is fetched."""
    file = TestedFile(opened)
    found: list[Finding] = []
    budget = Budget(opened.limits)
    sound = set()
    for name in (n for n in file.names if n in _FMI_XML or documents.is_manifest(n)):
        chunks = opened.chunks(opened.files[name])
        try:
            if name == DESCRIPTION:
                file.description = read_description(chunks, budget)
            else:
                read_xml(chunks, budget, lambda *_: None, lambda: None)
            sound.add(name)
        except VersionError as error:
            text = f"{shown(error.version)!r}; this checks FMI 2 and FMI 3"
            found.append(Finding("FMI version", Severity.FAULT, text))
        except XmlError as error:
            found.append(Finding("XML", Severity.FAULT, f"{shown(name)}: {shown(str(error), 400)}"))
        except ArchiveError as error:
            found.append(Finding("XML", Severity.FAULT, str(error.value)))
    file.sound = frozenset(sound)
    return file, found


CHECKS: Mapping[str, Check] = {
    "limits": Check(archive.limits, needs_description=False, refuses=True),
    "zip names": Check(archive.zip_names, needs_description=False, refuses=True),
    "links": Check(archive.links, needs_description=False, refuses=True),
    "zip method": Check(archive.zip_method, needs_description=False, refuses=True),
    "zip order": Check(archive.zip_order, needs_description=False),
    "layout": Check(archive.layout, needs_description=False, refuses=True),
    "numbers": Check(description.numbers),
    "schema": Check(documents.schema),
    "layered standards": Check(documents.manifests),
    "build description": Check(documents.build_description),
    "identity": Check(description.identity),
    "variable names": Check(description.variable_names),
    "names and references": Check(description.names_and_references),
    "start values": Check(description.start_values),
    "start presence": Check(description.start_presence),
    "units": Check(unit_definitions.units),
    "model structure": Check(structure.structure),
    "event indicators": Check(structure.event_indicators),
    "FMPy": Check(description.fmpy_validation),
    "platforms": Check(binaries.platforms),
    "machine": Check(binaries.machines),
    "exported symbols": Check(binaries.exports),
    "imported libraries": Check(binaries.imports),
    "unloading": Check(binaries.unloading),
}
"""By name; "XML" and "FMI version" come before them all."""
