"""Which line of a TOML text a name is set in: tomllib does not say, but it can be asked, line by line."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from typing import Any

__all__ = ["flatten", "line_of"]

_LAST_PART = re.compile(r"(^|\.)[^.\[\]]*$|\[\d+\]$")


def flatten(document: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Every name and value, tables included: ``plan``, ``plan.speed``, ``push[0].force``, as messages name them."""
    for key, value in document.items():
        name = f"{prefix}{key}"
        yield name, value
        if isinstance(value, Mapping):
            yield from flatten(value, f"{name}.")
        elif isinstance(value, list):
            for index, entry in enumerate(value):
                yield f"{name}[{index}]", entry
                if isinstance(entry, Mapping):
                    yield from flatten(entry, f"{name}[{index}].")


def line_of(text: str, name: str) -> int:
    """The line (from 1) where ``name`` begins; of its table if it is not there; 1 if that is not there either.

    A beginning of the text that ends after a whole statement is TOML, too: the first one that has the name ends with
    the statement that sets it, and the line after the one before that is where that statement begins.
    """
    lines = text.splitlines(keepends=True)
    wanted = name
    while wanted:
        begin = 1
        for count in range(1, len(lines) + 1):
            try:
                document = tomllib.loads("".join(lines[:count]))
            except tomllib.TOMLDecodeError:
                continue  # in the middle of a value of several lines
            if any(found == wanted for found, _ in flatten(document)):
                return begin
            begin = count + 1
        wanted = _LAST_PART.sub("", wanted)
    return 1
