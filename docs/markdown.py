"""Small pieces of Markdown."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

__all__ = ["cell", "escaped", "paragraphs", "replaced", "table"]

_SPECIAL = re.compile(r"([\\`*_{}\[\]<>|$#~^])")


def escaped(text: str) -> str:
    """``text`` as it is, with no character that Markdown would take for itself."""
    return _SPECIAL.sub(r"\\\1", text)


def cell(text: str) -> str:
    """One cell of a table: on one line, and no bar ends it."""
    return " ".join(text.split()).replace("|", "\\|")


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of cells that are Markdown themselves."""
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(cell(one) for one in line)} |\n" for line in lines)


def replaced(page: str, begin: str, end: str, made: str) -> str:
    """``page`` with ``made`` in place of the lines from ``begin`` to ``end``, which it has itself; SystemExit if the
    page has no such lines."""
    before, found, rest = page.partition(begin)
    _, ended, after = rest.partition(end)
    if not found or not ended:
        raise SystemExit(f"the page has no lines {begin} and {end}")
    return before + made + after


def paragraphs(text: str) -> str:
    """Text of a comment or a help: paragraphs stay apart, `code` stays code, all else is shown as it is."""
    parts = re.split(r"(`[^`\n]+`)", text)
    return "".join(part if part.startswith("`") and len(part) > 2 else escaped(part) for part in parts)
