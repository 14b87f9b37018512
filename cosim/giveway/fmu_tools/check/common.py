"""Input and output of every check."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

from giveway.fmu_tools.archive import Archive, ArchiveError
from giveway.fmu_tools.check.severity import Severity
from giveway.fmu_tools.description import REALS, Description, VariableEntry, effective

if TYPE_CHECKING:
    from giveway.base.errors import FileError
    from giveway.fmu_tools.binaries import Binary

__all__ = [
    "DESCRIPTION",
    "FAULT",
    "NOTE",
    "REALS",
    "WARNING",
    "Found",
    "TestedFile",
    "effective",
    "number",
]

DESCRIPTION = "modelDescription.xml"
FAULT, WARNING, NOTE = Severity.FAULT, Severity.WARNING, Severity.NOTE
Found = Iterator[tuple[Severity, str]]
"""(how bad, text)."""


@dataclass
class TestedFile:
    """The FMU under test.

    Attributes:
        description: None if there is none that can be read.
        sound: FMI's own XML files that were read as a stream without complaint.
    """

    archive: Archive
    description: Description | None = None
    sound: frozenset[str] = frozenset()
    binaries: dict[str, Binary | FileError] = field(default_factory=dict)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Of its files; folders left out."""
        return tuple(self.archive.files)

    def read(self, name: str) -> bytes:
        """The content of a file; empty if it cannot be unpacked, which the check of the zip file reports."""
        try:
            return self.archive.read(name)
        except ArchiveError:
            return b""

    def tree(self, name: str) -> Any:
        """The root of a sound XML file; the caller makes sure that it is small."""
        from lxml import etree

        return etree.fromstring(self.read(name), etree.XMLParser(resolve_entities=False, no_network=True))

    def described(self) -> Description:
        assert self.description is not None
        return self.description

    @cached_property
    def by_key(self) -> dict[int, VariableEntry]:
        """Variable by its key in ModelStructure."""
        description = self.described()
        return {description.key(v): v for v in description.variables}

    def state_of(self, variable: VariableEntry) -> VariableEntry | None:
        """The state that ``variable`` is the derivative of."""
        key = variable.get("derivative")
        return self.by_key.get(int(key)) if key.isascii() and key.isdigit() and len(key) < 20 else None


def number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None
