"""A Modelica file cut into its statements: enough of the grammar for the lint."""

from __future__ import annotations

import re
from dataclasses import dataclass

STRING = re.compile(r'"(?:[^"\\]|\\.)*"', re.DOTALL)
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
ANNOTATION = re.compile(r"\s*\bannotation\s*\(.*\)$", re.DOTALL)
SECTION = re.compile(r"\b(?:initial\s+)?(?:equation|algorithm)\b")
PREFIXES = (
    r"(?:(?:final|inner|outer|replaceable|redeclare|flow|stream|discrete|parameter|constant|input|output|each)\s+)*"
)
DECLARATION = re.compile(rf"({PREFIXES})([A-Za-z_][\w.]*)((?:\[[^\]]*\])?)\s+([A-Za-z_]\w*)\s*(.*)", re.DOTALL)
NOT_DECLARATIONS = (
    "extends",
    "import",
    "annotation",
    "replaceable model",
    "redeclare model",
    "end",
    "connect",
    "assert",
)


@dataclass(frozen=True)
class Declaration:
    """One component of a class.

    Attributes:
        rest: what follows the name: dimensions, modification, value, description.
        annotation: its own, or "".
    """

    prefixes: str
    type: str
    name: str
    rest: str
    description: str
    annotation: str


def cut(text: str) -> list[str]:
    """Statements of ``text``, split at semicolons outside strings and brackets; comments are gone."""
    found, depth, start, position = [], 0, 0, 0
    text = _without_comments(text)
    while position < len(text):
        string = STRING.match(text, position)
        if string:
            position = string.end()
            continue
        letter = text[position]
        depth += (letter in "([{") - (letter in ")]}")
        if letter == ";" and depth == 0:
            found.append(text[start:position].strip())
            start = position + 1
        position += 1
    return found


def _without_comments(text: str) -> str:
    pieces, last = [], 0
    for string in STRING.finditer(text):
        pieces += [COMMENT.sub("", text[last : string.start()]), string[0]]
        last = string.end()
    return "".join([*pieces, COMMENT.sub("", text[last:])])


def body(text: str, name: str) -> str:
    """What is between the head of class ``name`` with its description and its annotation."""
    head = re.search(rf"\b{name}\s+(?={STRING.pattern})", text)
    if head is None:
        return ""
    description = STRING.match(text, head.end())
    end = text.rfind(f"end {name};")
    return text[description.end() if description else head.end() : end]


def declarations(text: str, name: str) -> list[Declaration]:
    """Components of class ``name``, public and protected."""
    found = []
    in_equations = False
    for statement in cut(body(text, name)):
        bare = STRING.sub('""', statement)
        words = bare.removeprefix("protected").strip()
        section = SECTION.match(words)
        if section or in_equations:
            in_equations = not words.startswith(("annotation", "protected"))
            continue
        if words.startswith(NOT_DECLARATIONS) or not words:
            continue
        whole = statement.removeprefix("protected").strip()
        full = ANNOTATION.sub("", whole)
        parts = DECLARATION.match(full)
        if parts is None:
            continue
        strings = list(STRING.finditer(full))
        last = strings[-1] if strings else None
        described = last[0][1:-1] if last is not None and not full[last.end() :].strip() else ""
        found.append(Declaration(parts[1], parts[2], parts[4], parts[3] + parts[5], described, whole[len(full) :]))
    return found
