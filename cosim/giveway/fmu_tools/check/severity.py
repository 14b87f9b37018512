"""How bad a finding is: the one place that says what the three words mean."""

from __future__ import annotations

from enum import Enum

__all__ = ["Severity"]


class Severity(Enum):
    """From bad to harmless."""

    FAULT = "fault"
    """An importer may refuse the file, or read something else than was meant."""
    WARNING = "warning"
    """Legal, but there are importers or machines that cannot take it."""
    NOTE = "note"
    """Legal and usual, and worth a look."""
