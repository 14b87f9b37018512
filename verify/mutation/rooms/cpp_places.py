"""Where small faults can be planted in C++: expressions found by libclang, each with its replacements.

Runs in the environment of verify/requirements.lock, which has libclang.
"""

from __future__ import annotations

import json
import re
import shlex
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from clang.cindex import Cursor, CursorKind, Index, StorageClass, TypeKind

from verify.mutation.mutants import ARITHMETIC, CHANGES, LOGIC, RELATIONS, Key, Mutant

__all__ = ["cpp_mutants"]

BINARY = RELATIONS | LOGIC | ARITHMETIC
FUNCTIONS = (
    CursorKind.FUNCTION_DECL,
    CursorKind.CXX_METHOD,
    CursorKind.CONSTRUCTOR,
    CursorKind.DESTRUCTOR,
    CursorKind.CONVERSION_FUNCTION,
    CursorKind.FUNCTION_TEMPLATE,
)
OPERATIONS = (CursorKind.BINARY_OPERATOR, CursorKind.COMPOUND_ASSIGNMENT_OPERATOR, CursorKind.CALL_EXPR)
NUMBER = re.compile(r"(?:\d[\d']*\.?[\d']*|\.\d+)(?:[eE][-+]?\d+)?[fFuUlLzZ]*")
COMPUTED_BY_COMPILER = re.compile(r"(?:static\s+)?constexpr\b")
STATEMENT_PARENTS = (CursorKind.COMPOUND_STMT, CursorKind.CASE_STMT, CursorKind.DEFAULT_STMT)
REAL = (TypeKind.FLOAT, TypeKind.DOUBLE, TypeKind.LONGDOUBLE)
WHOLE = (TypeKind.INT, TypeKind.UINT, TypeKind.LONG, TypeKind.ULONG, TypeKind.SHORT, TypeKind.USHORT)
GCC_HEADERS = "/usr/lib/gcc/x86_64-linux-gnu/*/include"  # stddef.h and similar headers, which libclang's wheel lacks

Fault = tuple[int, int, str, str]  # from, to, replacement, and its name


def cpp_mutants(root: Path, build: Path, folders: list[str]) -> list[Mutant]:
    """Places in the files of ``folders`` below ``root``, as seen by the translation units that ``build`` compiles."""
    faults: dict[Path, dict[Fault, str]] = {}
    seen: set[tuple[Path, int]] = set()
    index = Index.create()
    for source, arguments in _units(build):
        if any(source.is_relative_to(root / folder) for folder in folders):
            _collect(index.parse(str(source), arguments).cursor, root, folders, faults, seen)
    return [mutant for path in sorted(faults) for mutant in _mutants(root, path, faults[path])]


def _units(build: Path) -> Iterator[tuple[Path, list[str]]]:
    """Sources with the compiler arguments that matter to a parser."""
    headers = [f"-isystem{folder}" for folder in Path("/").glob(GCC_HEADERS.lstrip("/"))]
    for entry in json.loads((build / "compile_commands.json").read_text(encoding="utf-8")):
        words = shlex.split(entry["command"])
        kept = [word for word in words if word.startswith(("-I", "-D", "-std="))]
        systems = [f"-isystem{words[at + 1]}" for at, word in enumerate(words) if word == "-isystem"]
        yield Path(entry["file"]), [*kept, *systems, *headers]


def _collect(
    top: Cursor, root: Path, folders: list[str], faults: dict[Path, dict[Fault, str]], seen: set[tuple[Path, int]]
) -> None:
    """``seen``: functions already found in an earlier translation unit."""
    places: dict[str, Path | None] = {}
    for cursor in top.get_children():
        name = cursor.location.file.name if cursor.location.file else ""
        if name not in places:
            path = Path(name).resolve()
            places[name] = path if any(path.is_relative_to(root / folder) for folder in folders) else None
        if path_of_ours := places[name]:
            text = path_of_ours.read_bytes()
            for function in _functions(cursor):
                place = (path_of_ours, function.extent.start.offset)
                if place not in seen:
                    seen.add(place)
                    for fault in _of_function(function, text):
                        faults.setdefault(path_of_ours, {}).setdefault(fault, _name(function))


def _functions(cursor: Cursor) -> Iterator[Cursor]:
    if cursor.kind not in FUNCTIONS:
        for child in cursor.get_children():
            yield from _functions(child)
    elif cursor.is_definition():
        yield cursor


def _name(function: Cursor) -> str:
    name = str(function.spelling)
    return name if name.startswith("operator") else name.split("<")[0]


def _of_function(function: Cursor, text: bytes) -> Iterator[Fault]:
    for child in function.get_children():
        if child.kind == CursorKind.COMPOUND_STMT:
            yield from _of_node(child, text, function, None)


def _of_node(node: Cursor, text: bytes, function: Cursor, parent: Cursor | None) -> Iterator[Fault]:
    start, end = node.extent.start.offset, node.extent.end.offset
    children = list(node.get_children())
    own = text[start:end].decode(errors="replace")
    if node.kind == CursorKind.VAR_DECL and COMPUTED_BY_COMPILER.match(own):
        return  # no mutant can be chosen at run time there
    if node.kind in OPERATIONS and len(children) >= 2:
        yield from _other_operation(text, start, end, children)
    elif node.kind == CursorKind.UNARY_OPERATOR and own[:1] in "-!" and not own.startswith("--"):
        yield start, end, own[1:].strip() or own, f"{own[0]} -> nothing"
    elif node.kind in (CursorKind.INTEGER_LITERAL, CursorKind.FLOATING_LITERAL) and NUMBER.fullmatch(own):
        yield from _other_number(start, end, own)
    elif node.kind == CursorKind.CXX_BOOL_LITERAL_EXPR and own in ("true", "false"):
        other = "false" if own == "true" else "true"
        yield start, end, other, f"{own} -> {other}"
    elif node.kind == CursorKind.DECL_REF_EXPR and _is_constant(node.referenced) and re.fullmatch(r"[\w:]+", own):
        yield start, end, f"(1.01 * {own})", f"{own} -> (1.01 * {own})"
    elif node.kind in (CursorKind.IF_STMT, CursorKind.WHILE_STMT, CursorKind.CONDITIONAL_OPERATOR) and children:
        yield from _negated(text, children[0])
    elif node.kind == CursorKind.RETURN_STMT and children:
        yield from _returned(text, function, children[0])
    if parent is not None and parent.kind in STATEMENT_PARENTS and node.kind.is_expression():
        yield start, end, "void()", "statement left out"
    for child in children:
        yield from _of_node(child, text, function, node)


def _other_operation(text: bytes, start: int, end: int, children: list[Cursor]) -> Iterator[Fault]:
    left, right = children[0].extent.end.offset, children[-1].extent.start.offset
    sign = text[left:right].decode(errors="replace").strip()
    first, last = text[start:left].decode(errors="replace"), text[right:end].decode(errors="replace")
    for other in BINARY.get(sign, ()):
        yield start, end, f"{first} {other} {last}", f"{sign} -> {other}"
    for other in CHANGES.get(sign, ()):
        yield start, end, f"{first} {other} {last}", f"{sign} -> {other}"


def _other_number(start: int, end: int, own: str) -> Iterator[Fault]:
    plain = own.replace("'", "").rstrip("fFuUlLzZ")
    if "." not in plain and "e" not in plain.lower():
        suffix = own[len(own.rstrip("uUlLzZ")) :]
        for other in (int(plain) - 1, int(plain) + 1):
            if other >= 0:
                yield start, end, f"{other}{suffix}", f"{own} -> {other}{suffix}"
    elif float(plain) == 0.0:
        yield start, end, "1.0", f"{own} -> 1.0"
    else:
        yield start, end, f"(1.01 * {own})", f"{own} -> (1.01 * {own})"
        yield start, end, f"(-{own})", f"{own} -> (-{own})"


def _is_constant(declared: Cursor | None) -> bool:
    """A named number that the compiler computes: each use of it can be replaced at run time."""
    if declared is None or declared.kind != CursorKind.VAR_DECL or declared.type.get_canonical().kind not in REAL:
        return False
    is_global = declared.semantic_parent.kind not in FUNCTIONS or declared.storage_class == StorageClass.STATIC
    return declared.type.is_const_qualified() and is_global


def _negated(text: bytes, condition: Cursor) -> Iterator[Fault]:
    """Empty where another fault is the same: a single relation reversed, a `!` left out."""
    if not condition.kind.is_expression():
        return
    start, end = condition.extent.start.offset, condition.extent.end.offset
    own = text[start:end].decode(errors="replace")
    if own.startswith("!") or (len(re.findall(r"[=!<>]=|<|>", own)) == 1 and not re.search(r"&&|\|\|", own)):
        return
    yield start, end, f"!({own})", "condition negated"


def _returned(text: bytes, function: Cursor, value: Cursor) -> Iterator[Fault]:
    kind = function.result_type.get_canonical().kind
    start, end = value.extent.start.offset, value.extent.end.offset
    own = text[start:end].decode(errors="replace")
    if not own or own in ("true", "false"):
        return
    if kind == TypeKind.BOOL:
        yield start, end, f"!({own})", "result negated"
    elif kind in REAL:
        yield start, end, f"-({own})", "result negated"
    elif kind in WHOLE:
        yield start, end, f"({own}) + 1", "result one more"


def _mutants(root: Path, path: Path, faults: dict[Fault, str]) -> list[Mutant]:
    text = path.read_bytes()
    lines = text.decode().splitlines()
    seen: Counter[tuple[str, str, str]] = Counter()
    found = []
    for (start, end, replacement, change), function in sorted(faults.items()):
        number = text.count(b"\n", 0, start) + 1
        line = " ".join(lines[number - 1].split())
        change = " ".join(change.split())
        seen[function, line, change] += 1
        key = Key(path.relative_to(root).as_posix(), function, line, change, seen[function, line, change])
        found.append(Mutant(key, path, number, start, end, replacement))
    return found
