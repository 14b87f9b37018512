"""What files may hold, from the shapes that check them: the JSON Schemas of `giveway schema`, as tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from giveway.schemas.documents import KINDS, document

from docs.markdown import paragraphs, table

__all__ = ["pages"]

INTRODUCTION = {
    "scenario": """`giveway run FILE` runs it, and `giveway new scenario FILE` writes a commented one. Points are on the
robot (base frame: x forward, y left, m), directions in the world (deg), all else in SI units.
""",
    "study": """`giveway sweep FILE` and `giveway optimise FILE` run it, and `giveway new study FILE` writes a commented
one. {doc}`/tutorials/choose_a_bumper` uses one.
""",
    "robot": """`--robot FILE` and `robot = "FILE"` take it, and `giveway robot new FILE` writes a commented one. Every
number is a table with `value`, `unit` and, if you like, `source`, `confidence`, `provenance` and `note`; units of the
same kind are converted.
""",
    "variables": """`fmu/models/*/variables.toml` of the repository, for those who change an FMU: the one source of its
variables. The code generator of the build refuses a wrong one with the entry and the key.
""",
    "summary": "`giveway demo` leaves it in its folder.\n",
}
EDITORS = """
A wrong file is refused with its line, the key and what is allowed, and nothing is run. `giveway schema {kind}` prints
the same as JSON Schema; with the line `#:schema {kind}.schema.json` at the top of a file, editors complete and
underline (Even Better TOML, taplo).
"""
MODELS = ("testbed", "controller")


def pages(root: Path) -> dict[str, str]:
    """A page per kind of file; the shapes are those of the installed package, not files below ``root``."""
    return {f"reference/files/{kind}.md": _page(kind) for kind in KINDS}


def _page(kind: str) -> str:
    schema = document(kind)
    text = f"# {kind.capitalize()} file\n\n{INTRODUCTION.get(kind, '')}"
    if kind not in ("variables", "summary"):
        text += EDITORS.format(kind=kind)
    return text + "".join(_sections("", schema))


def _sections(name: str, node: Mapping[str, Any]) -> Iterator[str]:
    """A section for each table of the file, the outer ones first."""
    only = _only_with(node)
    properties = {key: only.get(key, (value, ""))[0] for key, value in node.get("properties", {}).items()}
    required = set(node.get("required", ()))
    inner = {key: _table_of(value) for key, value in properties.items()}
    rows = [
        (f"`{key}`", _allowed(value, inner[key]), _words(value, key in required) + only.get(key, ("", ""))[1])
        for key, value in properties.items()
    ]
    if rows:
        title = f"`{name}`" if name else "Top"
        yield f"\n## {title}\n\n{table(('key', 'allowed', ''), rows)}"
    for key, value in properties.items():
        below = inner[key]
        if below is not None and key not in MODELS and not _is_quantity(below):
            path = f"{name.strip('[]')}.{key}" if name else key
            yield from _sections(f"[[{path}]]" if value.get("type") == "array" else f"[{path}]", below)


def _only_with(node: Mapping[str, Any]) -> dict[str, tuple[Mapping[str, Any], str]]:
    """Of a table whose keys depend on a word in it: what the other keys may be, and with which words."""
    found: dict[str, tuple[Mapping[str, Any], list[str]]] = {}
    deciding = ""
    cases = [one for one in node.get("allOf", ()) if any("const" in word for word in one["if"]["properties"].values())]
    for case in cases:
        ((deciding, word),) = case["if"]["properties"].items()
        for key, value in case["then"]["properties"].items():
            needed = " (needed)" if key in case["then"].get("required", ()) else ""
            found.setdefault(key, (value, []))[1].append(f"`{word['const']}`{needed}")
    found.pop(deciding, None)
    return {
        key: (value, "" if len(words) == len(cases) and "needed" not in str(words) else f"; with {', '.join(words)}")
        for key, (value, words) in found.items()
    }


def _table_of(node: Mapping[str, Any]) -> Mapping[str, Any] | None:
    """The table that a value is, or may be, or a list of them holds."""
    for one in (node, node.get("items"), *node.get("anyOf", ()), *node.get("oneOf", ())):
        if isinstance(one, Mapping) and one.get("properties"):
            return one
    return None


def _is_quantity(node: Mapping[str, Any]) -> bool:
    return {"value", "unit"} <= set(node["properties"])


def _words(node: Mapping[str, Any], required: bool) -> str:
    below = _table_of(node)
    words = node.get("description", "")
    if below is not None and _is_quantity(below) and not words:
        words = below["properties"]["unit"].get("description", "")
    return paragraphs(words) + ("; needed" if required and words else "needed" if required else "")


def _allowed(node: Mapping[str, Any], below: Mapping[str, Any] | None) -> str:
    """The allowed values in words."""
    choices = node.get("anyOf") or node.get("oneOf")
    if choices:
        return " or ".join(dict.fromkeys(text for one in choices if (text := _allowed(one, _table_of(one)))))
    if below is not None:
        if _is_quantity(below):
            return "a number with its unit"
        return "tables" if node.get("type") == "array" else "a table"
    if "const" in node:
        return f"`{node['const']}`"
    if "enum" in node:
        return ", ".join(f"`{one}`" for one in node["enum"])
    return _kind(node)


def _kind(node: Mapping[str, Any]) -> str:
    kind = node.get("type")
    if kind in ("number", "integer"):
        low, high = node.get("minimum", node.get("exclusiveMinimum")), node.get("maximum", node.get("exclusiveMaximum"))
        what = "a whole number" if kind == "integer" else "a number"
        if low is not None and high is not None:
            return f"{what} from {low:.10g} to {high:.10g}"
        return what if low is None else f"{what}, at least {low:.10g}"
    if kind == "array":
        items = node.get("items")
        return f"a list: {_allowed(items, None)}" if isinstance(items, Mapping) and items else "a list"
    return {"string": "a text", "boolean": "true or false", "object": "a table"}.get(str(kind), "")
