"""No function of c_core and fmu is longer than a page without a reason beside it.

The sources are formatted (`make lint`), so a definition begins on a line that ends in a brace and ends with a brace
under that line's beginning. A longer function says why in a comment directly above it: ``// Long because ...``.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

LONGEST = 60  # lines, from its name to its closing brace
REASON = re.compile(r"(//|/\*|\*) Long because \w")
_CONTROL = re.compile(r"\s*(\}\s*)?(if|else|for|while|switch|do|namespace|class|struct|union|enum|case|return)\b")
_END_OF_HEAD = re.compile(
    r"[;{}]\s*(//.*|/\*.*\*/)?$|^\s*(#|//|/\*|\*|template <.*>$|(public|private|protected):)|^\s*$"
)


def functions(text: str) -> Iterator[tuple[int, int]]:
    """First and last line of every function, counted from 0."""
    lines = text.splitlines()
    row = 0
    while row < len(lines):
        last = _function_from(lines, row)
        if last is not None:
            first = row
            while first > 0 and not _END_OF_HEAD.search(lines[first - 1]):
                first -= 1
            yield first, last
            row = last
        row += 1


def _function_from(lines: list[str], row: int) -> int | None:
    """The last line of the function whose head ends on this one."""
    line = lines[row]
    if not line.endswith("{"):
        return None
    first = row
    while first > 0 and not _END_OF_HEAD.search(lines[first - 1]):
        first -= 1
    head = " ".join(lines[first : row + 1])
    if "(" not in head or _CONTROL.match(head) or re.search(r"= \{$|\[[^\]]*\]( ?\(.*\))?( ->.*)? \{$", head):
        return None
    indent = re.match(r" *", lines[first])
    closing = f"{indent.group() if indent else ''}}}"
    return next((i for i in range(row + 1, len(lines)) if lines[i].rstrip("; ") == closing), None)


def too_long(text: str) -> list[tuple[int, int]]:
    """Line (from 1) and length of each function that is too long and does not say why."""
    lines = text.splitlines()
    found = []
    for first, last in functions(text):
        above = first - 1
        while above >= 0 and lines[above].lstrip().startswith("template"):
            above -= 1
        comment = []
        while above >= 0 and re.match(r"\s*(//|/\*|\*)", lines[above]):
            comment.append(lines[above])
            above -= 1
        if last - first + 1 > LONGEST and not any(REASON.search(line) for line in comment):
            found.append((first + 1, last - first + 1))
    return found


def sources() -> list[Path]:
    files = [path for room in ("c_core", "fmu") for path in sorted((ROOT / room).rglob("*"))]
    return [path for path in files if path.suffix in (".c", ".h", ".cpp", ".hpp")]


def test_no_function_is_longer_than_a_page_without_a_reason() -> None:
    found = {str(path.relative_to(ROOT)): too_long(path.read_text(encoding="utf-8")) for path in sources()}
    assert {path: places for path, places in found.items() if places} == {}


def test_the_functions_are_seen() -> None:
    # As many as there are, roughly: a formatter that breaks lines otherwise must not hide them.
    assert sum(len(list(functions(path.read_text(encoding="utf-8")))) for path in sources()) > 800


HEADS = {
    "a function": "int step(int a) {",
    "over two lines": "static int step(const int *values,\n                int count) {",
    "a template": "template <class T>\nT step(T a) {",
    "a method": "struct Stepper {\n    [[nodiscard]] int step() const override {",
    "a constructor": "struct Stepper {\n    explicit Stepper(int a) : a_(a) {",
    "an entry point": 'extern "C" int step(void) {',
}


@pytest.mark.parametrize("case", HEADS)
def test_a_long_function_is_found(case: str) -> None:
    head = HEADS[case]
    indent = "    " if "struct" in head else ""
    first = 2 if "struct" in head or "template" in head else 1
    rows = head.count("\n") + (1 if first == 1 else 0)
    for longer in (0, 1):
        body = f"{indent}    a();\n" * (LONGEST - 1 - rows + longer)
        text = f"{head}\n{body}{indent}}}\n"
        assert too_long(text) == ([(first, LONGEST + 1)] if longer else [])
    reason = f"{indent}// Long because every line calls a().\n"
    begin = 0 if "template" in head else text.splitlines(keepends=True)[: first - 1]
    before = "".join(begin) if begin else ""
    assert too_long(before + reason + text[len(before) :]) == []
