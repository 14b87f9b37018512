"""Untrusted XML, read as a stream: no tree, no document type, no entities, no network, with limits."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from xml.parsers import expat

from giveway.fmu_tools.limits import LARGEST_ELEMENT_BYTES, MOST_LEVELS, Limits

__all__ = ["Budget", "XmlError", "XmlLimitError", "read_xml"]


DEPENDENCIES_PER_ELEMENT = 20


class XmlError(Exception):
    """The file is not acceptable XML; the text gives the reason and the line."""


class XmlLimitError(XmlError):
    """It exceeds the limits."""


@dataclass
class Budget:
    """The remaining budget; the XML files of one FMU share it."""

    limits: Limits
    read_bytes: int = 0
    elements: int = 0
    dependencies: int = 0

    def add_bytes(self, count: int) -> None:
        self.read_bytes += count
        if self.read_bytes > self.limits.xml_mb * 1e6:
            raise XmlLimitError(f"more than {self.limits.xml_mb:,g} MB of XML; --max-xml allows more")

    def add_element(self) -> None:
        self.elements += 1
        if self.elements > self.limits.xml_elements:
            raise XmlLimitError(f"more than {self.limits.xml_elements:,} XML elements; --max-elements allows more")

    def add_dependencies(self, count: int) -> None:
        """Dependencies in ModelStructure; each is a number in an attribute, so they are not elements."""
        self.dependencies += count
        most = DEPENDENCIES_PER_ELEMENT * self.limits.xml_elements
        if self.dependencies > most:
            raise XmlLimitError(f"more than {most:,} dependencies; --max-elements allows more")


Start = Callable[[str, dict[str, str], int], None]
"""(tag, attributes, line). A namespace precedes its tag, separated by a space."""


def read_xml(chunks: Iterable[bytes], budget: Budget, start: Start, end: Callable[[], None]) -> None:
    """Report the begin and end of every element; XmlError with the line where reading fails."""
    parser = expat.ParserCreate(namespace_separator=" ")
    level = fed = 0
    handing_out = False

    def line() -> str:
        return f"line {parser.CurrentLineNumber}"

    def begin(tag: str, attributes: dict[str, str]) -> None:
        nonlocal level, handing_out
        handing_out = True
        level += 1
        budget.add_element()
        if level > MOST_LEVELS:
            raise XmlError(f"{line()}: elements are more than {MOST_LEVELS} levels deep")
        start(tag, attributes, parser.CurrentLineNumber)
        handing_out = False

    def finish(_tag: str) -> None:
        nonlocal level, handing_out
        handing_out = True
        level -= 1
        end()
        handing_out = False

    def refuse(*_: object) -> None:
        raise XmlError(f"{line()}: has a document type (DOCTYPE): its entities could read other files, or never end")

    parser.StartElementHandler = begin
    parser.EndElementHandler = finish
    parser.StartDoctypeDeclHandler = refuse
    try:
        for chunk in chunks:
            budget.add_bytes(len(chunk))
            parser.Parse(chunk, False)
            fed += len(chunk)
            # The parser's buffer contains one unfinished tag or comment.
            if fed - max(0, parser.CurrentByteIndex) > LARGEST_ELEMENT_BYTES:
                raise XmlLimitError(f"{line()}: one element has over {LARGEST_ELEMENT_BYTES / 1e6:g} MB")
        parser.Parse(b"", True)
    except expat.ExpatError as error:
        raise XmlError(f"line {error.lineno}: {expat.ErrorString(error.code)}") from None
    except (LookupError, UnicodeError, ValueError) as error:  # an unknown encoding, or not a text encoding
        if handing_out:
            raise
        raise XmlError(f"{line()}: {error}") from None
