"""Severity of findings: the definition of the three words."""

from __future__ import annotations

from enum import Enum

__all__ = ["Severity"]


class Severity(Enum):
    """From severe to harmless."""

    FAULT = "fault"
    """An importer may refuse the file or misread it."""
    WARNING = "warning"
    """Legal, but some importers or machines cannot handle it."""
    NOTE = "note"
    """Legal and usual, but worth a look."""
