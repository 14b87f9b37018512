"""Every small fault that can be planted in c_core, in an order that does not depend on the machine."""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from verify.mutation.tokens import Token, is_type, matching, operand_start, tokenise
from verify.sources import core_files

__all__ = ["SEED", "Key", "Mutant", "every", "mutants_of", "shuffled"]

SEED = 1

RELATIONS = {
    "<": ("<=", ">="),
    "<=": ("<", ">"),
    ">": (">=", "<="),
    ">=": (">", "<"),
    "==": ("!=",),
    "!=": ("==",),
}
LOGIC = {"&&": ("||",), "||": ("&&",)}
ARITHMETIC = {
    "+": ("-",),
    "-": ("+",),
    "*": ("/",),
    "/": ("*",),
    "%": ("/",),
    "&": ("|",),
    "|": ("&",),
    "^": ("&",),
    "<<": (">>",),
    ">>": ("<<",),
}
CHANGES = {"+=": ("-=",), "-=": ("+=",), "*=": ("/=",), "/=": ("*=",), "++": ("--",), "--": ("++",)}
CONSTANTS = {
    "GW_ZERO": ("GW_ONE",),
    "GW_HALF": ("GW_ONE",),
    "GW_ONE": ("GW_ZERO", "GW_TWO"),
    "GW_TWO": ("GW_ONE",),
    "GW_PI": ("GW_ONE",),
    "true": ("false",),
    "false": ("true",),
}
# Each member of a group is replaced by any other member of it.
KINDS = (
    ("GW_STATUS_", "GW_STATUS_OK", "GW_STATUS_NULL_POINTER"),
    ("GW_MODE_", "GW_MODE_FAULT", "GW_MODE_TRACKING"),
    ("GW_FIELD_", "GW_FIELD_NONE", "GW_FIELD_CONTROLLER_PERIOD"),
)
NO_DELETION = {"if", "else", "for", "while", "do", "switch", "case", "default", "return", "goto"}
# GW_UNROLLED is a pragma.
BESIDE_STATEMENTS = {"{", "}", ";", "else", "do", "GW_UNROLLED"}
INTEGER = re.compile(r"(\d+)([uU]?)")


@dataclass(frozen=True, order=True)
class Key:
    """Identifies a mutant, also after lines above it were added or removed; ``nth`` of equal changes in the line."""

    file: str
    function: str
    line: str
    change: str
    nth: int


@dataclass(frozen=True)
class Mutant:
    """``text[start:end]`` of the file ``path`` replaced."""

    key: Key
    path: Path
    number: int  # of the line
    start: int
    end: int
    replacement: str

    def applied(self, text: str) -> str:
        return text[: self.start] + self.replacement + text[self.end :]

    def __str__(self) -> str:
        return f"{self.key.file}:{self.number}: {self.key.function}: {self.key.change}    {self.key.line}"


def every(root: Path) -> list[Mutant]:
    """Mutants of all sources and of the headers' inline functions; header macros are an interface that tests share."""
    return [mutant for path in core_files(root) for mutant in mutants_of(path)]


def shuffled(mutants: list[Mutant], seed: int, *, by_file: bool = True) -> list[Mutant]:
    """The same order for the same seed on every machine; what happens to one mutant does not move the others.

    Without ``by_file`` the order stays also when files are renamed.
    """

    def lot(mutant: Mutant) -> str:
        key = mutant.key
        words = (str(seed), *((key.file,) if by_file else ()), key.function, key.line, key.change, str(key.nth))
        return hashlib.sha256("\0".join(words).encode()).hexdigest()

    return sorted(mutants, key=lot)


def mutants_of(path: Path) -> list[Mutant]:
    text = path.read_text(encoding="utf-8")
    seen: Counter[tuple[str, str, str]] = Counter()
    found = []
    for run in tokenise(text):
        if path.suffix == ".h" and run[0].text != "{":
            continue
        returns = _type_returned(text, run[0])
        for start, end, replacement, name in sorted(_faults(text, run, returns)):
            number = text.count("\n", 0, start) + 1
            line = " ".join(text.splitlines()[number - 1].split())
            change = name or f"{text[start:end]} -> {replacement or 'nothing'}"
            function = run[0].function
            seen[function, line, change] += 1
            key = Key(path.name, function, line, change, seen[function, line, change])
            found.append(Mutant(key, path, number, start, end, replacement))
    return found


Fault = tuple[int, int, str, str]  # from, to, replacement, and its name if the replacement alone does not tell


def _type_returned(text: str, opening: Token) -> str:
    """The first words of the function whose body opens here."""
    head = re.search(rf"^([^\n#]*?)\b{opening.function}\([^;{{]*\)\s*\Z", text[: opening.start], re.MULTILINE)
    return head[1].split()[-1] if head and head[1].split() else ""


def _faults(text: str, run: list[Token], returns: str) -> Iterator[Fault]:
    for at, token in enumerate(run):
        yield from _replaced(run, at)
        if token.kind == "number":
            yield from _other_number(token, has_sign=run[at - 1].text == "-")
        if token.text in ("if", "while") and run[at + 1].text == "(":
            yield from _negated(text, run, at + 1)
        if token.text == "?":
            yield from _negated(text, run, operand_start(run, at - 1), at)
        if token.text == "return":
            yield from _returned(text, run, at, returns)
    if run[0].text == "{" and run[0].function:
        yield from _deleted(run)


def _replaced(run: list[Token], at: int) -> Iterator[Fault]:
    token = run[at]
    others: tuple[str, ...] = ()
    if token.text in RELATIONS or token.text in LOGIC or token.text in CHANGES:
        others = (RELATIONS | LOGIC | CHANGES)[token.text]
    elif token.text in ARITHMETIC and token.kind == "mark":
        if _is_binary(run, at):
            others = ARITHMETIC[token.text]
        elif token.text == "-":
            others = ("",)
    elif token.text in "!~" and token.kind == "mark":
        others = ("",)
    elif token.text in CONSTANTS:
        others = CONSTANTS[token.text]
    elif token.kind == "name":
        others = tuple(_other_of_a_kind(token.text))
    for other in others:
        yield token.start, token.end, other, ""


def _other_of_a_kind(name: str) -> Iterator[str]:
    for prefix, usual, instead in KINDS:
        if name.startswith(prefix):
            yield instead if name == usual else usual


def _is_binary(run: list[Token], at: int) -> bool:
    """Whether it is binary: no sign, no dereference or address, no star of a pointer's declaration."""
    before = run[at - 1]
    if at == 0 or is_type(before.text):
        return False
    if before.text == ")":
        inside = run[operand_start(run, at - 1) + 1 : at - 1]
        return not all(is_type(token.text) or token.text == "*" for token in inside)  # no cast
    return before.text == "]" or (before.kind in ("name", "number") and before.text not in ("return", "case"))


def _other_number(token: Token, *, has_sign: bool) -> Iterator[Fault]:
    if match := INTEGER.fullmatch(token.text):
        value = int(match[1])
        for other in (value - 1, value + 1):
            if other >= 0:
                yield token.start, token.end, f"{other}{match[2]}", ""
    elif not token.text.startswith("0x") and float(token.text.rstrip("fF")) == 0.0:
        yield token.start, token.end, "1.0", ""
    elif not token.text.startswith("0x"):
        yield token.start, token.end, f"(1.01 * {token.text})", ""
        if not has_sign:  # otherwise its sign is left out
            yield token.start, token.end, f"(-{token.text})", ""


def _negated(text: str, run: list[Token], at: int, stop: int | None = None) -> Iterator[Fault]:
    """Empty where another fault is the same: a single relation reversed, a `!` left out."""
    end = matching(run, at) if stop is None else stop - 1
    inside = [token for token in run[at : end + 1] if token.text not in ("(", ")")]
    relations = sum(token.text in RELATIONS for token in inside)
    logic = sum(token.text in LOGIC for token in inside)
    if logic == 0 and (relations == 1 or inside[0].text == "!"):
        return
    condition = text[run[at].start : run[end].end]
    negated = f"!({condition})" if stop is not None else f"(!{condition})"
    yield run[at].start, run[end].end, negated, "condition negated"


def _returned(text: str, run: list[Token], at: int, returns: str) -> Iterator[Fault]:
    end = next(place for place in range(at, len(run)) if run[place].text == ";")
    if end == at + 1:
        return
    value = text[run[at + 1].start : run[end - 1].end]
    other = {
        "bool": f"!({value})",
        "gw_real_t": f"-({value})",
        "gw_status_t": f"(({value}) == GW_STATUS_OK) ? GW_STATUS_NULL_POINTER : GW_STATUS_OK",
    }.get(returns)
    if other:
        yield run[at + 1].start, run[end - 1].end, other, "result negated"


def _deleted(run: list[Token]) -> Iterator[Fault]:
    """Assignments, calls and breaks left out."""
    at = 0
    while at < len(run) - 1:
        token = run[at]
        if token.text in ("if", "for", "while", "switch"):
            at = matching(run, at + 1) + 1
        elif token.text in ("case", "default"):
            while run[at].text != ":":
                at += 1
            at += 1
        elif token.text in BESIDE_STATEMENTS:
            at += 1
        else:
            end = at
            while run[end].text != ";":
                end = matching(run, end) + 1 if run[end].text in "([{" else end + 1
            is_declaration = is_type(token.text)
            if not is_declaration and token.text not in NO_DELETION:
                yield token.start, run[end - 1].end, "", "statement left out"
            at = end + 1
