"""The line of a TOML text in which a name is set: tomllib does not tell, so beginnings of the text are parsed."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
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
    """The line (from 1) where ``name`` begins; if it is missing, that of its table; if that is missing, too, 1.

    Every beginning of the text that ends after a complete statement is valid TOML. The shortest one with the name ends
    with the statement that sets it; this statement begins one line after the next shorter beginning.
    """
    lines = text.splitlines(keepends=True)
    wanted = name
    while wanted:
        begin = _beginning(lines, wanted)
        if begin is not None:
            return begin
        wanted = _LAST_PART.sub("", wanted)
    return 1


def _beginning(lines: Sequence[str], wanted: str) -> int | None:
    """The line where ``wanted`` begins, found by bisection: once set, a name stays set. None if nothing sets it."""
    without, having = 0, len(lines)  # counts of lines
    if not _sets(lines, having, wanted):
        return None
    while True:
        middle = (without + having) // 2
        nearby = (*range(middle, having), *range(middle - 1, without, -1))
        for count in nearby:  # a beginning that ends within a multi-line value is not TOML, and tells nothing
            found = _sets(lines, count, wanted) if count > without else None
            if found is not None:
                break
        else:
            return without + 1
        if found:
            having = count
        else:
            without = count


def _sets(lines: Sequence[str], count: int, wanted: str) -> bool | None:
    """Whether the first ``count`` lines set ``wanted``; None if they are not valid TOML."""
    try:
        document = tomllib.loads("".join(lines[:count]))
    except tomllib.TOMLDecodeError:
        return None
    return any(found == wanted for found, _ in flatten(document))
