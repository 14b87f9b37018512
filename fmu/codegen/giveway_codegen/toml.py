"""Writes a table as TOML for the Python package, with shared entries filled in."""

from __future__ import annotations

import json
from typing import Any

__all__ = ["text"]


def text(document: dict[str, Any], comment: str) -> str:
    """A document of plain values, tables and lists of tables, without further nesting."""
    lines = [f"# {comment}", *_pairs({key: value for key, value in document.items() if not _is_table(value)})]
    for key, value in document.items():
        if isinstance(value, dict):
            lines += ["", f"[{key}]", *_pairs(value)]
        elif _is_table(value):
            for entry in value:
                lines += ["", f"[[{key}]]", *_pairs(entry)]
    return "\n".join(lines) + "\n"


def _is_table(value: Any) -> bool:
    return isinstance(value, dict) or (isinstance(value, list) and bool(value) and isinstance(value[0], dict))


def _pairs(values: dict[str, Any]) -> list[str]:
    return [f"{key} = {_value(value)}" for key, value in values.items()]


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(_pairs(value)) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(_value(item) for item in value) + "]"
    # Strings, numbers and booleans in JSON are also valid TOML.
    return json.dumps(value, ensure_ascii=False, allow_nan=False)
