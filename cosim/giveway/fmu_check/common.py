"""What every check gets, and what it gives back."""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from giveway.fmu_description import Description, VariableEntry

__all__ = [
    "DESCRIPTION",
    "FAULT",
    "NOTE",
    "REALS",
    "UNREADABLE",
    "Found",
    "TestedFile",
    "effective",
    "number",
    "state_of",
]

DESCRIPTION = "modelDescription.xml"
REALS = ("Real", "Float32", "Float64")
FAULT, NOTE = True, False
UNREADABLE = (zipfile.BadZipFile, zlib.error, RuntimeError, NotImplementedError, EOFError)
"""What zipfile raises for a file that cannot be unpacked."""
Found = Iterator[tuple[bool, str]]
"""(fault or note, text)."""


@dataclass(frozen=True)
class TestedFile:
    """The FMU under test.

    Attributes:
        names: of its files; folders left out.
        documents: its XML files, by name.
        description: None if there is none that can be read.
        folder: for what has to be unpacked.
    """

    archive: zipfile.ZipFile
    names: tuple[str, ...]
    documents: Mapping[str, Any]
    description: Description | None
    folder: Path

    def read(self, name: str) -> bytes:
        """The content of a file; nothing if it cannot be unpacked, which the check of the zip file says."""
        try:
            return self.archive.read(name)
        except UNREADABLE:
            return b""

    def described(self) -> Description:
        assert self.description is not None
        return self.description


def number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def effective(description: Description, variable: VariableEntry, name: str) -> str:
    """An attribute of the variable, else of its declared type."""
    return variable.get(name) or description.types.get(variable.get("declaredType"), {}).get(name, "")


def state_of(description: Description, variable: VariableEntry) -> VariableEntry | None:
    """The state that ``variable`` is the derivative of."""
    key = variable.get("derivative")
    return next((v for v in description.variables if str(description.key(v)) == key), None) if key else None
