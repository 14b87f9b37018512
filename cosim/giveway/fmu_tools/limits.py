"""Limits for reading an FMU: a malicious file may try to fill memory, disk or time."""

from __future__ import annotations

from dataclasses import dataclass

from giveway.base.checks import finite, whole

__all__ = ["LARGEST_ELEMENT_BYTES", "MOST_LEVELS", "Limits"]

LARGEST_ELEMENT_BYTES = 4_000_000
"""Size of one XML tag with its attributes: a parser returns it only when it is complete."""
MOST_LEVELS = 100
"""Nesting depth of XML elements, and of folders in an archive."""


@dataclass(frozen=True)
class Limits:
    """Limits beyond which a file is refused; GivewayError for an invalid limit. The command line's options set them.

    Attributes:
        unpacked_mb: all files of the archive together, unpacked, in MB (1e6 bytes).
        entries: files and folders in the archive.
        xml_mb: FMI's own XML files together, unpacked, in MB.
        xml_elements: elements in them.
    """

    unpacked_mb: float = 1000.0
    entries: int = 10_000
    xml_mb: float = 64.0
    xml_elements: int = 200_000

    def __post_init__(self) -> None:
        finite("--max-unpacked", self.unpacked_mb, 0.001, 1e6, "MB")
        whole("--max-entries", self.entries, 1, 10_000_000)
        finite("--max-xml", self.xml_mb, 0.001, 1e5, "MB")
        whole("--max-elements", self.xml_elements, 1, 1_000_000_000)
