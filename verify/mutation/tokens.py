"""The tokens of a C file, with what encloses each: enough structure to plant faults in c_core's plain style."""

from __future__ import annotations

import re
from dataclasses import dataclass

__all__ = ["Token", "is_type", "matching", "tokenise"]

PATTERN = re.compile(
    r"""(?P<space>\s+|/\*.*?\*/|//[^\n]*|\\\n)
      | (?P<directive>^[ \t]*\#(?:\\\n|/\*.*?\*/|[^\n])*)
      | (?P<string>"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*')
      | (?P<name>[A-Za-z_]\w*)
      | (?P<number>\.?\d(?:[eEpP][+-]|[\w.])*)
      | (?P<mark>->|\+\+|--|<<=|>>=|&&|\|\||[-+*/%&|^<>=!]=|<<|>>|.)
    """,
    re.VERBOSE | re.DOTALL | re.MULTILINE,
)
DEFINE = re.compile(r"[ \t]*#[ \t]*define[ \t]+\w+[ \t]+")
OPENING = {"(": ")", "[": "]", "{": "}"}
TYPE_WORDS = {"bool", "char", "const", "double", "float", "int", "static", "struct", "enum", "unsigned", "void"}


@dataclass(frozen=True)
class Token:
    """``function``: the function whose body contains the token; empty at file scope; in a #define the macro's name."""

    kind: str
    text: str
    start: int
    function: str = ""

    @property
    def end(self) -> int:
        return self.start + len(self.text)


def tokenise(text: str) -> list[list[Token]]:
    """Runs of tokens in which faults can be planted: the bodies of functions, initialisers at file scope, and the
    values of macros."""
    flat: list[Token] = []
    runs: list[list[Token]] = []
    for match in PATTERN.finditer(text):
        kind = str(match.lastgroup)
        if kind == "directive":
            define = DEFINE.match(match[0])
            if define:
                runs.append(_values(text, match.start() + define.end(), match.end(), define[0].split()[1]))
        elif kind != "space":
            flat.append(Token(kind, match[0], match.start()))
    runs.extend(_bodies(flat))
    return sorted((run for run in runs if run), key=lambda run: run[0].start)


def _values(text: str, start: int, end: int, name: str) -> list[Token]:
    return [
        Token(str(match.lastgroup), match[0], match.start(), name)
        for match in PATTERN.finditer(text, start, end)
        if match.lastgroup != "space"
    ]


def _bodies(flat: list[Token]) -> list[list[Token]]:
    found = []
    at = 0
    while at < len(flat):
        token = flat[at]
        if token.text in "([":
            at = matching(flat, at)
        elif token.text == "{":
            end = matching(flat, at)
            before = flat[at - 1].text
            if before == ")":
                name = flat[_opening(flat, at - 1) - 1].text
                found.append([Token(t.kind, t.text, t.start, name) for t in flat[at : end + 1]])
            elif before == "=":
                found.append(flat[at : end + 1])
            at = at if flat[at - 1].kind == "string" else end  # extern "C" encloses functions
        at += 1
    return found


def matching(tokens: list[Token], at: int) -> int:
    """Where the bracket that opens at ``at`` closes."""
    depth = 0
    for place in range(at, len(tokens)):
        if tokens[place].text in OPENING:
            depth += 1
        elif tokens[place].text in OPENING.values():
            depth -= 1
            if depth == 0:
                return place
    raise ValueError(f"a bracket opens at offset {tokens[at].start} and never closes")


def _opening(tokens: list[Token], at: int) -> int:
    """Where the bracket that closes at ``at`` opened."""
    depth = 0
    for place in range(at, -1, -1):
        if tokens[place].text in OPENING.values():
            depth += 1
        elif tokens[place].text in OPENING:
            depth -= 1
            if depth == 0:
                return place
    raise ValueError(f"a bracket closes at offset {tokens[at].start} and never opened")


def is_type(word: str) -> bool:
    return word.endswith("_t") or word in TYPE_WORDS


def operand_start(tokens: list[Token], at: int) -> int:
    """Where the operand that ends at ``at`` starts: a bracketed one, or a name with members, indices and calls."""
    while True:
        if tokens[at].text in ")]":
            at = _opening(tokens, at)
            before = tokens[at - 1]
            if before.kind != "name" or before.text in ("return", "if", "while") or tokens[at].text not in "([":
                return at
            at -= 1
            continue
        if tokens[at - 1].text in ("->", "."):
            at -= 2
            continue
        return at
