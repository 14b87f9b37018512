"""The robot file: every number of a robot with its unit, source, confidence and provenance."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from giveway.errors import FileError, nearest_names

__all__ = ["Entry", "Robot", "read_robot"]

SCHEMA_VERSION = 1


@dataclass(frozen=True)
class Entry:
    """How a value of a robot file is to be read.

    Attributes:
        text: value with unit.
        provenance: given, sourced, fitted or assumed; "" if the file does not say.
        source, note: in words; "" likewise.
    """

    text: str
    provenance: str
    source: str
    note: str


class Robot:
    """A robot file that has been read; values are addressed by their table path (``base.mass``)."""

    def __init__(self, path: Path, tables: dict[str, Any]) -> None:
        self.path = path
        self._entries: dict[str, dict[str, Any]] = {}
        self._collect("", tables)

    def _collect(self, prefix: str, table: dict[str, Any]) -> None:
        for key, entry in table.items():
            if not isinstance(entry, dict):
                continue
            name = f"{prefix}{key}"
            if "value" in entry:
                self._entries[name] = entry
            else:
                self._collect(f"{name}.", entry)

    def value(self, name: str, index: int = 0) -> float | int | bool:
        """The value at ``name`` in the unit its entry states; ``index`` selects from a list value."""
        if name not in self._entries:
            near = nearest_names(name, self._entries)
            hint = f"the file has {' and '.join(near)}" if near else "every value of the robot is needed"
            raise FileError(self.path, f"{name} is missing", hint)
        value = self._entries[name]["value"]
        if isinstance(value, list):
            value = value[index] if index < len(value) else 0.0  # a shorter list leaves the rest unused
        if not isinstance(value, int | float) or not math.isfinite(value):
            raise FileError(self.path, f"{name} = {value} is not a finite number")
        return value

    def entries(self) -> Iterator[tuple[str, Entry]]:
        """Every entry with its name, in the order of the file."""
        for name, entry in self._entries.items():
            value, unit = entry["value"], self.unit(name)
            values = ", ".join(f"{part:g}" for part in (value if isinstance(value, list) else [value]))
            words = (str(entry.get(key, "")) for key in ("provenance", "source", "note"))
            yield name, Entry(f"{values} {unit}" if unit not in ("", "1") else values, *words)

    def count(self, name: str) -> int:
        """Number of values at ``name``: the length of a list, 1 for a single number."""
        value = self._entries[name]["value"] if name in self._entries else self.value(name)
        return len(value) if isinstance(value, list) else 1

    def unit(self, name: str) -> str:
        """The unit that the entry ``name`` states ("" if it states none)."""
        return str(self._entries.get(name, {}).get("unit", ""))


def read_robot(path: Path) -> Robot:
    """Read and check a robot file; FileError names the file and what is wrong with it."""
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise FileError(path, "no such file", "give the path of a robot file (TOML)") from None
    except (OSError, UnicodeDecodeError) as error:
        raise FileError(path, f"cannot be read: {error}") from None
    except tomllib.TOMLDecodeError as error:
        raise FileError(path, f"is not TOML: {error}") from None
    found = tables.get("schema_version")
    if found != SCHEMA_VERSION:
        raise FileError(path, f"schema_version is {found}", f"this version reads {SCHEMA_VERSION}")
    return Robot(path, tables)
