"""The files of the variable tables as plain data, for `variables` and `robot_file`."""

from __future__ import annotations

import functools
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from giveway.base.errors import FileError

__all__ = ["entry_unit", "read_table_file", "robot_paths"]

SCHEMA_VERSION = 1


@functools.cache
def read_table_file(path: Path) -> Mapping[str, Any]:
    """The document of the variable table ``path``; FileError if it cannot be read."""
    try:
        document = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise FileError(path, f"cannot be read: {error}") from None
    if document.get("schema_version") != SCHEMA_VERSION:
        raise FileError(path, f"schema_version is {document.get('schema_version')}", f"need {SCHEMA_VERSION}")
    return document


def entry_unit(entry: Mapping[str, Any]) -> str:
    """The unit of a [[variable]]: "1" for reals without one, "" for integers and booleans."""
    return str(entry.get("unit", "1" if entry["type"] == "real" else ""))


def robot_paths(entry: Mapping[str, Any]) -> Iterator[str]:
    """The robot file's entry with the start values of a [[variable]], if any."""
    start = entry.get("start")
    for item in start if isinstance(start, list) else [start]:
        if isinstance(item, dict):
            yield item["robot"]
